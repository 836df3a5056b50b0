// The axis around which gores keep their order, and what contact does to it.
#pragma once

#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

/// From the payload to the centre of mass of the canopy.
struct CanopyAxis {
    Vec3 canopy;     ///< [m] a point of it
    Vec3 direction;  ///< unit vector
    double length;   ///< [m]
};

/// Both places [m], not the same.
CanopyAxis canopy_axis(const Vec3& canopy, const Vec3& payload);

/// [N] What pairs of nodes push off on the axis: on all canopy nodes, by mass, and on the payload. Without it
/// contact would bring in force, moment and energy. Nothing in symmetric states.
struct AxisReaction {
    Vec3 canopy, payload;
};

/// Sums over pairs of the derivatives of their energy by arm and by direction of the axis [N], [N m]
/// (ContactPush).
AxisReaction axis_reaction(const CanopyAxis& axis, const Vec3& by_middle, const Vec3& by_turning);

/// Tangent of a pair's K [N/m], for row sums as of a spring: the blocks of its second derivative have norms
/// of at most 5/4 K in the node's own column and K in the other's, wherever both are around the axis.
inline double contact_tangent(double stiffness) {
    return 1.25 * stiffness;
}

}  // namespace twinchute::fullsim
