// The edges of a canopy's triangles, as springs see them (paper, 2.1).
#pragma once

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// [-] strain up to which an edge's stiffness grows: fabric seldom stretches further (paper, 2.1).
inline constexpr double full_hardening_strain = 0.05;

/// [-] growth that keeps fabric below that strain at any load of an opening.
inline constexpr double largest_hardening = 10.0;

/// [m/s] elongation rate from which folded fabric resists fully; below, the force is less.
inline constexpr double full_fold_speed = 1.0;

/// Growth g of an edge that hardens by H: EA (e + g e^2) up to full_hardening_strain, of slope H beyond [-].
constexpr double hardening_coefficient(double hardening) {
    return (hardening - 1.0) / (2.0 * full_hardening_strain);
}

struct FabricEdge {
    std::array<NodeIndex, 2> node;
    double rest_length = 0.0;  ///< l0 [m]
    double section = 0.0;      ///< A_ij = t sum(A_T)/l0 over the triangles at the edge [m^2]
    double hardening = 1.0;    ///< H: stiffness at full_hardening_strain over the unstrained one [-]
};

/// Every edge once, by its nodes in rising order. An edge may harden as far as the nodes at its ends still
/// oscillate no faster than the fastest node of the unstrained mesh: that costs no time step.
std::vector<FabricEdge> fabric_edges(const Mesh& mesh);

}  // namespace twinchute::fullsim
