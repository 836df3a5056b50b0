// Fabric: 3-node total-Lagrangian membrane, St. Venant-Kirchhoff in plane stress, that wrinkles
// instead of carrying compression (relaxed energy; paper, 2.2, and Pipkin 1986).
#pragma once

#include "fullsim/forces/gather.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// Constants of the fabric per unit of reference width.
struct MembraneLaw {
    double tension_modulus;  ///< E t [N/m]
    double plane_modulus;    ///< E t/(1 - nu^2) [N/m]
    double poisson;          ///< nu [-]
    double viscosity;        ///< b1 rho t c [N s/m^2]; times a length it is a bulk viscosity [N s/m]
};

/// With density and wave speed c = sqrt(E/(rho (1 - nu^2))).
MembraneLaw membrane_law(const Fabric& fabric, double bulk_viscosity);

/// Laws of all sheets of a mesh.
std::vector<MembraneLaw> membrane_laws(const Mesh& mesh, double bulk_viscosity);

enum class FabricState { taut, wrinkled, slack };

/// Green strain and second Piola-Kirchhoff stress resultant, components 11, 22, 12.
struct PlaneTensor {
    double xx, yy, xy;
};

struct Principal {
    double first, second;  ///< the larger first
};
Principal principal_values(const PlaneTensor& tensor);

/// Stress resultant [N/m] for a Green strain, with the tension-field state. The stress is the
/// derivative of membrane_energy; it vanishes when both principal strains are negative.
PlaneTensor membrane_stress(const MembraneLaw& law, const PlaneTensor& strain, FabricState* state = nullptr);

/// First principal values [N/m] of these triangles, at full stiffness.
std::vector<double> first_stresses(std::span<const Triangle> triangles, std::span<const MembraneLaw> laws,
                                   const State& state);

/// Relaxed energy per reference area [J/m^2].
double membrane_energy(const MembraneLaw& law, const PlaneTensor& strain);

/// Green strain of a triangle at its current corners [m].
PlaneTensor green_strain(const Triangle& triangle, const std::array<Vec3, 3>& corner);
PlaneTensor green_strain(const Triangle& triangle, const State& state);

/// [m] over which the bulk viscosity acts: the shortest height of the unstrained triangle.
double element_length(const Triangle& triangle);

/// Row sums of the unstrained triangle (Gershgorin), by corner. The gradient of a corner's shape function is
/// the opposite edge over twice the area, and the norm of the block of corners i and j is at most area *
/// modulus * |gradient_i| |gradient_j|: the product of two factors.
struct TriangleRows {
    std::array<double, 3> factor;  ///< by corner [sqrt(N/m)]
    double damping;                ///< of a row over its stiffness [s]

    /// [N/m] of the row of a corner, with the weights of all three.
    double stiffness(int corner, const std::array<double, 3>& weight) const {
        return factor[corner] * (factor[0] * weight[0] + factor[1] * weight[1] + factor[2] * weight[2]) /
               weight[corner];
    }
};
TriangleRows unstrained_rows(const MembraneLaw& law, const Triangle& triangle);

}  // namespace twinchute::fullsim
