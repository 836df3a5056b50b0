// The central difference scheme (paper, Eqs 8 and 9), and the sums that come with a pass over nodes.
#pragma once

#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// Constants of the node update.
struct NodeConstants {
    std::vector<double> mass;   ///< [kg] material, payload included
    std::vector<double> share;  ///< [-] of the added mass; zero outside the canopy
    NodeIndex canopy_nodes = 0;
    double canopy_mass = 0.0;              ///< [kg]
    double system_mass = 0.0;              ///< [kg]
    double gravity = 0.0;                  ///< [m/s^2]
    std::size_t attachments = 0;           ///< of risers on a body, which nothing accelerates here
    std::vector<double> static_line_mass;  ///< [kg] the anchor last, which keeps its velocity

    /// Index of its first node: after the dummy and the attachments.
    std::size_t first_static_line() const { return mass.size() + 1 + attachments; }
};

NodeConstants node_constants(const Mesh& mesh, double gravity);

/// Sums over nodes of one step, for reference velocities and the energy balance.
struct StepSums {
    Lanes canopy_position = splat(0.0), canopy_velocity = splat(0.0);  ///< after the step, times mass
    Lanes other_position = splat(0.0), other_velocity = splat(0.0);    ///< of what is not canopy
    Lanes area_velocity = splat(0.0);                                  ///< times share
    Lanes drag_power = splat(0.0), momentum = splat(0.0);  ///< by component, at the time of the forces
    double share_square = 0.0;                   ///< of share times speed squared, likewise [m^2/s^2]
    double kinetic = 0.0;                        ///< [J] likewise, where State.energy.weighs
    double line_damping = 0.0;                   ///< [J] by lines and risers in subcycles
    double line_damping_power = 0.0;             ///< [W] in the last of them, by its part of the step
    double outer_work = 0.0, outer_power = 0.0;  ///< [J], [W] of other parachutes on the payload

    StepSums& operator+=(const StepSums& other);
};

/// A step of lines and risers within one of the canopy.
struct Subcycle {
    double kick = 0.0;  ///< [s] from the middle of the one before to its own
    double dt = 0.0;    ///< [s]
};

/// Renews state.sums and books gravity, drag and damping work, and the work of the added mass's growth from
/// state.added_mass to `next_added_mass`. line_dt: [s] of the last subcycle.
void finish_step(State& state, const NodeConstants& constants, const StepSums& sums, double kick, double dt,
                 double line_dt, double next_added_mass);

/// All nodes from time t to t + dt with the forces in state.force and state.aero at t; adds to `sums`.
void move_all(State& state, const NodeConstants& constants, double dt, StepSums& sums);

/// All of move_all, and finish_step.
void advance(State& state, const NodeConstants& constants, double dt, double next_added_mass);

/// state.sums from the node records.
void update_sums(State& state, const NodeConstants& constants);

}  // namespace twinchute::fullsim
