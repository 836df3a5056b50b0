// The edges of a canopy's triangles, as springs see them (paper, 2.1).
#pragma once

#include <cmath>

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// [-] strain up to which an edge's stiffness grows: fabric seldom stretches further (paper, 2.1).
inline constexpr double full_hardening_strain = 0.05;

/// [-] hardening that keeps fabric below that strain at any load of an opening.
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
    /// Its fabric. An edge between two is one of the first, with such a section that E A is that of both.
    int sheet = 0;
};

/// 1/l0 [1/m], EA [N], hardening coefficient [-], and (beta E/l0 + b1 rho c1) A [N s/m] with the wave speed
/// c1 = sqrt(E/rho) (paper, Eq. 3). Edge: FabricEdge, or one of a gore.
struct SpringConstants {
    double inverse_length, stiffness, hardening, dashpot;
};
template <class Edge>
SpringConstants fabric_spring_constants(const Fabric& fabric, const Edge& e, double bulk_viscosity,
                                        double beta) {
    const double modulus = fabric.youngs_modulus;
    const double impedance = bulk_viscosity * std::sqrt(modulus * fabric.density);
    return {1.0 / e.rest_length, modulus * e.section, hardening_coefficient(e.hardening),
            (beta * modulus / e.rest_length + impedance) * e.section};
}

/// [N] that holds an edge while it is folded. resistance: [N/m] of width.
template <class Edge>
double fold_force(const Fabric& fabric, const Edge& e, double resistance) {
    return resistance * e.section / fabric.thickness;
}

/// Every edge once, by its nodes in rising order. An edge may harden as far as the nodes at its ends still
/// oscillate no faster than the fastest node of the unstrained mesh: that costs no time step.
std::vector<FabricEdge> fabric_edges(const Mesh& mesh);

}  // namespace twinchute::fullsim
