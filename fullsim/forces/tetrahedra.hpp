// A solid that gives way: 4-node total-Lagrangian tetrahedra of constant strain, of Saint Venant and
// Kirchhoff's material (paper, 2.2; e.g. Bonet and Wood 2008, Nonlinear Continuum Mechanics for Finite
// Element Analysis, 6.4.3), damped as the other elements are.
#pragma once

#include "fullsim/forces/force_model.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

struct SolidLaw {
    double lambda = 0.0, mu = 0.0;  ///< Lame's constants [Pa]
    double beta = 0.0;              ///< [s] stiffness-proportional damping (paper, Eq. 4)
    double viscosity = 0.0;         ///< b1 rho c [Pa s/m]; times a length a bulk viscosity (paper, Eq. 3)
};

/// With the speed of pressure waves, c = sqrt((lambda + 2 mu)/rho); density [kg/m^3].
SolidLaw solid_law(const Elasticity& elasticity, double density, double bulk_viscosity, double beta);
/// Law of a scene's payload, whose density follows from its mass.
SolidLaw solid_law(const Scene& scene, const BodyMesh& body);

/// Green strain E and second Piola-Kirchhoff stress, 2 mu E + lambda tr(E) 1.
Eigen::Matrix3d solid_stress(const SolidLaw& law, const Eigen::Matrix3d& strain);

/// Stress at rest is none where the solid's nodes are [m]. Its nodes are those of the state from first_node
/// on.
std::unique_ptr<const ForceModel> make_tetrahedra(const SolidMesh& solid, const SolidLaw& law,
                                                  NodeIndex first_node);

}  // namespace twinchute::fullsim
