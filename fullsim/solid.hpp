// A solid of tetrahedra, and the rigid body that it amounts to.
#pragma once

#include <array>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Corners [m], in the order in which the volume is positive.
using Tetrahedron = std::array<Vec3, 4>;
using Solid = std::vector<Tetrahedron>;

/// Around its centre; edges along the axes [m]. Five tetrahedra.
Solid make_box(double x, double y, double z);
/// A prism of `sides` sides on the circle, around its centre, upright along z; diameter and height [m].
/// Volume and inertia of the circle's cylinder are missed by O(1/sides^2).
Solid make_cylinder(double diameter, double height, int sides);
/// What a scene describes; 96 sides of a cylinder miss its inertia by 0.2 % at equal mass.
Solid make_solid(const PayloadBody& body);

/// A rigid body at its centre of mass.
struct Lumped {
    double volume = 0.0;                                ///< [m^3]
    Vec3 centre = Vec3::Zero();                         ///< of mass [m]
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre [kg m^2]
};

/// Of a homogeneous solid of that mass [kg]: sums of the exact integrals over tetrahedra, of which that of
/// x_i x_j is V/20 (sum of corners' x_i x_j + sum x_i sum x_j), e.g. Tonon 2004, J. Math. Stat. 1, 8.
Lumped lump(const Solid& solid, double mass);

}  // namespace twinchute::fullsim
