// Does the energy add up? The figure that tells a good run from a plausible one.
#pragma once

#include "fullsim/forces/force_model.hpp"
#include "fullsim/time/central_difference.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

/// Kinetic energy of the static line alone [J]; zero where there is none.
double static_line_kinetic_energy(const State& state, const NodeConstants& constants);

/// 1/2 sum (m_i + M_a,i) v_i^2 [J] at state.time.
double kinetic_energy(const State& state, const NodeConstants& constants);

/// Stored energy of all blocks [J].
double elastic_energy(const State& state, const ForceModels& structure);

/// The balance from the start to state.time, when there is as much kinetic and elastic energy [J]:
///   kinetic + elastic = gravity work + drag work - damping + added mass + ramp + external work + residual.
/// Velocities are those extrapolated to state.time: where forces have just changed, `kinetic` is off by half
/// a step of what that changes in power.
EnergyLedger energy_ledger(const State& state, double kinetic, double elastic);

/// Energy balance at the beginning of the step that led to `state`, exactly as the central difference scheme
/// has it: the step was asked to weigh what moves (EnergyTotals). With b the velocity half a step before the
/// time and a the acceleration at it, forces linear in the positions conserve 1/2 m b (b + dt a) + elastic
/// energy to the last bit, however long the step. elastic, turning, added_mass: [J] stored in blocks, in the
/// rotation of a body and in the ledger then.
EnergyLedger ledger_before(const State& state, double elastic, double turning, double added_mass);

/// [J] What a residual is held against: the energy at the start with the works of gravity, drag and forces
/// from outside, in sum the most that they have been so far. Works swing back, and what has changed hands
/// has.
double energy_scale(EnergyTotals& totals);

/// Books up to state.time; the next step starts from positions and velocities of that time. For masses that
/// change at once: half a step's velocity of a light node is not that of a heavy one.
void start_anew(State& state);

/// The residual of a ledger [J]; positive when energy came from nowhere.
double residual(const EnergyLedger& ledger);

}  // namespace twinchute::fullsim
