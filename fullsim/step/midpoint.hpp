// The explicit midpoint rule (paper, Eqs 8 and 9), and the sums that come with a pass over nodes.
#pragma once

#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// What the node update needs that does not change.
struct NodeConstants {
    std::vector<double> mass;   ///< [kg] material, payload included
    std::vector<double> share;  ///< [-] of the added mass; zero outside the canopy
    NodeIndex canopy_nodes = 0;
    double canopy_mass = 0.0;              ///< [kg]
    double system_mass = 0.0;              ///< [kg]
    double gravity = 0.0;                  ///< [m/s^2]
    std::vector<double> static_line_mass;  ///< [kg] the far end last, which keeps its velocity
};

NodeConstants node_constants(const Mesh& mesh, double gravity);

/// From time t to t + dt with the forces in state.force and state.aero at t:
///   v^{n+1/2} = v^{n-1/2} + (dt^{n+1} + dt^n)/2 (f^n/m + g m_material/m),   x^{n+1} = x^n + dt^{n+1}
///   v^{n+1/2},
/// and v^{n+1} extrapolated by another half step of the same acceleration. Clears the force arrays,
/// renews state.sums, and books gravity, drag and damping work and the work of the added mass's
/// growth from state.added_mass to `next_added_mass`.
void advance(State& state, const NodeConstants& constants, double dt, double next_added_mass);

/// state.sums from the node records.
void update_sums(State& state, const NodeConstants& constants);

}  // namespace twinchute::fullsim
