// Solids of tetrahedra, and the rigid body that one amounts to.
#pragma once

#include <array>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Corners [m], in the order in which the volume is positive.
using Tetrahedron = std::array<Vec3, 4>;
using Solid = std::vector<Tetrahedron>;

/// Tetrahedra that share their corners.
struct SolidMesh {
    std::vector<Vec3> node;                       ///< [m]
    std::vector<std::array<int, 4>> tetrahedron;  ///< nodes in the order in which the volume is positive

    bool operator==(const SolidMesh&) const = default;
};
Solid solid_of(const SolidMesh& mesh);

/// Around its centre; edges along the axes [m], so many cells along each. Six tetrahedra in a cell.
SolidMesh make_box(const Vec3& edges, const std::array<int, 3>& cells);
/// A prism of `sides` sides on the circle, around its centre, upright along z; diameter and height [m].
/// Volume and inertia of the circle's cylinder are missed by O(1/sides^2). Three tetrahedra in a wedge of a
/// layer; the middle of each layer is a node.
SolidMesh make_cylinder(double diameter, double height, int sides, int layers = 1);

/// Mesh of a scene's box or cylinder, with nodes where so many risers are attached. A cylinder has about 96
/// sides, which miss its inertia by 0.2 % at equal mass.
SolidMesh make_solid(const PayloadBody& body, int risers);
/// Mesh of few tetrahedra that are as long as wide, for a deformable body.
SolidMesh make_coarse_solid(const PayloadBody& body, int risers);

/// A rigid body at its centre of mass.
struct Lumped {
    double volume = 0.0;                                ///< [m^3]
    Vec3 centre = Vec3::Zero();                         ///< of mass [m]
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre [kg m^2]
};

/// Lumps a homogeneous solid of that mass [kg]: sums of the exact integrals over tetrahedra, of which that of
/// x_i x_j is V/20 (sum of corners' x_i x_j + sum x_i sum x_j), e.g. Tonon 2004, J. Math. Stat. 1, 8.
Lumped lump(const Solid& solid, double mass);

/// Masses [kg] of the nodes of a solid that together are `mass`, have their centre at the origin and the
/// inertia of `body`: of all such, those of least relative entropy to a quarter of each tetrahedron, which
/// are above zero. (A quarter each is off by O(h^2): three times the inertia for a box of one cell.) Empty
/// where the nodes cannot have that inertia.
std::vector<double> node_masses(const SolidMesh& solid, double mass, const Lumped& body);

}  // namespace twinchute::fullsim
