#include "fullsim/time/energy.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute::fullsim {

double static_line_kinetic_energy(const State& state, const NodeConstants& c) {
    double twice = 0.0;
    for (std::size_t k = 0; k < c.static_line_mass.size(); ++k) {
        const Lanes v = state.node[c.first_static_line() + k].v;
        twice += c.static_line_mass[k] * sum3(v * v);
    }
    return 0.5 * twice;
}

double kinetic_energy(const State& state, const NodeConstants& c) {
    double twice = 0.0;
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        const Lanes v = state.node[i].v;
        twice += (c.mass[i] + c.share[i] * state.added_mass) * sum3(v * v);
    }
    return 0.5 * twice + static_line_kinetic_energy(state, c);
}

double elastic_energy(const State& state, const ForceModels& structure) {
    double total = 0.0;
    for (const auto& block : structure)
        total += block->energy(state);
    return total;
}

double energy_scale(EnergyTotals& totals) {
    // At rest nothing has changed hands yet, and what does not add up is rounding.
    constexpr double energy_of_rounding = 1e-6;  // [J] more than elements at rest have from rounded positions
    const double now = energy_of_rounding + totals.kinetic_start + totals.elastic_start +
                       std::abs(totals.gravity_work) + std::abs(totals.drag_work) +
                       std::abs(totals.external_work);
    totals.changed_hands = std::max(totals.changed_hands, now);
    return totals.changed_hands;
}

void start_anew(State& state) {
    EnergyTotals& totals = state.energy;
    const double half = 0.5 * state.dt;
    totals.gravity_work += half * totals.gravity_power;
    totals.drag_work += half * totals.drag_power;
    totals.damping += half * totals.damping_power;
    totals.external_work += half * totals.external_power;
    totals.air_loss += half * totals.air_loss_power;
    state.dt = state.line_dt = 0.0;
    for (std::size_t i = 0; i < state.node.size(); ++i)
        state.v_half[i].value = state.node[i].v;
    if (state.body) state.body->half_momentum = state.body->momentum;
}

double residual(const EnergyLedger& e) {
    return e.kinetic + e.elastic -
           (e.gravity_work + e.drag_work - e.damping + e.added_mass + e.ramp + e.external_work);
}

namespace {

/// half: [s] from the middle of the last kick, up to which works are booked, to the time of the balance.
EnergyLedger balance(const EnergyTotals& totals, double half, double kinetic, double elastic) {
    EnergyLedger ledger;
    ledger.kinetic = kinetic - totals.kinetic_start;
    ledger.elastic = elastic - totals.elastic_start;
    ledger.gravity_work = totals.gravity_work + half * totals.gravity_power;
    ledger.drag_work = totals.drag_work + half * totals.drag_power;
    ledger.damping = totals.damping + half * totals.damping_power;
    ledger.added_mass = totals.added_mass;
    ledger.ramp = totals.ramp;
    ledger.external_work = totals.external_work + half * totals.external_power;
    ledger.air_loss = totals.air_loss + half * totals.air_loss_power;
    const double scale = std::abs(ledger.drag_work);
    ledger.residual_fraction = scale > 0.0 ? residual(ledger) / scale : 0.0;
    return ledger;
}

}  // namespace

EnergyLedger energy_ledger(const State& state, double kinetic, double elastic) {
    return balance(state.energy, 0.5 * state.dt, kinetic, elastic);
}

EnergyLedger ledger_before(const State& state, double elastic, double turning, double added_mass) {
    EnergyTotals totals = state.energy;
    totals.added_mass = added_mass;
    return balance(totals, -0.5 * state.dt, totals.kinetic + turning, elastic);
}

}  // namespace twinchute::fullsim
