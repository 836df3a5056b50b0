// Contact of a node with a triangle of fabric: one pair, in plain numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fullsim/laws/node_over_triangle.hpp"
#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

inline constexpr double window_half_width = HWY_NAMESPACE::half_width_of_window;

/// Positions [m] or velocities [m/s] of a node and of the corners of a triangle.
struct NodeAndTriangle {
    Vec3 node;
    std::array<Vec3, 3> corner;

    HWY_NAMESPACE::FromCorner<Vec3> from_corner() const {
        return {corner[1] - corner[0], corner[2] - corner[0], node - corner[0]};
    }
};

using OverTriangle = HWY_NAMESPACE::PlaceOverTriangle<double, Vec3>;

/// Place over a triangle, which has an area. Inlined, so that callers pay for what they ask only.
[[gnu::always_inline]] inline OverTriangle over_triangle(const NodeAndTriangle& x) {
    OverTriangle at;
    HWY_NAMESPACE::find_place(x.from_corner(), at);
    return at;
}

struct SelfContactLaw {
    double stiffness;  ///< k [N/m]
    double friction;   ///< mu [-]
    double viscosity;  ///< c [N s/m] of friction where slip is slow
};

/// Forces [N] of a pair.
struct SelfContactForce {
    NodeAndTriangle on;
    double energy;      ///< [J]
    double normal;      ///< N [N]
    double dissipated;  ///< [W]
};

/// How far the node is within the thickness h, on its side s (1 or -1) of the normal [m]; above zero: they
/// push.
inline double overlap_of(const OverTriangle& at, int side, double thickness) {
    return thickness - side * at.gap;
}

/// [J] of an overlap d > 0: 1/2 k w d^2.
inline double self_contact_energy(double stiffness, const OverTriangle& at, double overlap) {
    return 0.5 * stiffness * at.window * overlap * overlap;
}

/// Forces at an overlap > 0, see push_pair.
inline SelfContactForce self_contact_force(const SelfContactLaw& law, const OverTriangle& at, int side,
                                           double overlap, const NodeAndTriangle& v) {
    HWY_NAMESPACE::PushOfPair<double, Vec3> push;
    HWY_NAMESPACE::push_pair(law.stiffness, law.friction, law.viscosity, at, static_cast<double>(side),
                             overlap, v.from_corner(), push);
    return {{push.on_node, push.on_corner},
            self_contact_energy(law.stiffness, at, overlap),
            push.normal,
            push.dissipated};
}

/// Bound [N/m] on the norm of the second derivative of E by the node's position, over the window: w <= 1, its
/// first and second derivative by b at most 1.5/(2 e) and 6/(4 e^2), e its half width. The other blocks are
/// at most this times the shares. overlap [m]; steepest: the largest gradient of b [1/m].
inline double self_contact_tangent(double stiffness, double overlap, double steepest) {
    const double turn = overlap * steepest, e = window_half_width;
    return stiffness * (1.0 + turn * (2.0 + 1.5 / e) + turn * turn * 1.5 / (e * e));
}

}  // namespace twinchute::fullsim
