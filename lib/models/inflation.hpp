// The prescribed part of an opening, the same for every fidelity: when which phase begins, and
// drag area, radial-pressure ramp and added mass against time (paper, 3.2.2, 3.2.3 and 3.3).
#pragma once

#include <optional>

#include "lib/models/added_mass.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/record/archive.hpp"

namespace twinchute {

/// Phases after snatch. They are separate functions of time: a solver stops at each boundary
/// and goes on in the next phase, so that none is ever stepped across.
enum class Phase {
    initial,    ///< t_s to t_s + t_i: constant drag area
    filling,    ///< t_s + t_i to t_s + t_f: the drag-area law
    overshoot,  ///< from t_s + t_f on while the canopy over-inflates, by a table of growth that says so
    open        ///< after that: constant drag area
};

struct Inflation {
    double snatch = 0.0;            ///< t_s [s] since release
    double initial_time = 0.0;      ///< t_i [s], 0 <= t_i < t_f
    double filling_time = 0.0;      ///< t_f [s]
    double steady_drag_area = 0.0;  ///< (C_D S)_0 [m^2]
    double eta = 0.0;               ///< sqrt((C_D S)_i/(C_D S)_0) [-] (paper, Eq. 15)
    const DragAreaLaw* law = nullptr;
    // Stage of a reefed opening; the members above are then the stage's own.
    double share = 1.0;       ///< drag area that it ends with over (C_D S)_0 of the open canopy [-]
    double ramp_start = 0.0;  ///< phi' at its beginning [-]
    const DragAreaTable* table = nullptr;  ///< in place of the law; the parachute's
    std::size_t piece = 0;                 ///< of the table, between two of its kinks: where time stands
    double exponent = 0.0;                 ///< of a power in place of the law [-]; 0: none

    DragAreaGrowth growth() const { return {law, eta, table, exponent}; }

    /// [s] since release at which a phase ends; infinite for Phase::open.
    double end_of(Phase phase) const;
    /// [s] since release at which the rate of the drag area jumps next, within filling or overshoot; infinite
    /// where it is smooth. A solver stops there, too, and goes on with the next piece.
    double next_kink() const;
    /// The phase that begins where `phase` ends.
    Phase after(Phase phase) const;
    /// The phase at `time` [s]; at the end of one the next.
    Phase phase_at(double time) const;

    /// (C_D S)_t/(C_D S)_0 [-] and its rate [1/s] (paper, Eq. 14, on t - (t_s + t_i)).
    ValueAndRate drag_area_ratio(Phase phase, double time) const;

    /// Linear from 0, or from where the stage before has come to, at t_s to 1 at t_s + t_f: phi'(t), and
    /// phi(t)/phi(t_f) of Eq. 12.
    ValueAndRate ramp(Phase phase, double time) const;

    /// Added mass [kg] and rate [kg/s] at density rho, R_c = steady_radius sqrt((C_D S)_t/(C_D S)_0) with the
    /// radius and drag area of the open canopy. porosity: open over total area [-].
    ValueAndRate added_mass(const AddedMassSpec& spec, Phase phase, double time, double rho,
                            double steady_radius, double porosity) const;
};

/// Into a checkpoint and back; `law` and `table`: its parachute's, of which it has one or none.
void serialize(Archive& archive, Inflation& inflation, const DragAreaLaw* law, const DragAreaTable* table);

}  // namespace twinchute
