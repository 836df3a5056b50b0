// Contact of a node with a triangle of fabric: one pair. Plain numbers, no lanes: few pairs touch at a time,
// and which do changes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

/// Positions [m] or velocities [m/s] of a node and of the corners of a triangle.
struct NodeAndTriangle {
    Vec3 node;
    std::array<Vec3, 3> corner;
};

/// Where a node stands over a triangle: x = sum b_i x_i + g n.
struct OverTriangle {
    Vec3 edge1, edge2;             ///< [m] from corner 0 to 1 and 2
    Vec3 normal;                   ///< n, a unit vector
    double twice_area;             ///< [m^2]
    double gap;                    ///< g [m]
    std::array<double, 3> share;   ///< b, barycentric coordinates of the foot of the node
    std::array<Vec3, 3> gradient;  ///< [1/m] of b, in the plane
    double window;                 ///< w [-] share of the pair in the contact with the sheet
    Vec3 window_gradient;          ///< [1/m]
};

/// Half the width of the strip along an edge over which one triangle hands over to the next, in barycentric
/// coordinates.
inline constexpr double window_half_width = 0.15;

struct RampAndRate {
    double value, rate;
};
/// 0 below -width, 1 above width, a cubic between: r(b) + r(-b) = 1, so that on a flat sheet neighbours hand
/// a node over at the same force.
inline RampAndRate window_ramp(double b) {
    const double t = std::clamp(0.5 * (b / window_half_width + 1.0), 0.0, 1.0);
    return {t * t * (3.0 - 2.0 * t), 3.0 * t * (1.0 - t) / window_half_width};
}

/// Place over a triangle, which has an area.
inline OverTriangle over_triangle(const NodeAndTriangle& x) {
    OverTriangle at;
    at.edge1 = x.corner[1] - x.corner[0];
    at.edge2 = x.corner[2] - x.corner[0];
    const Vec3 arm = x.node - x.corner[0], area = at.edge1.cross(at.edge2);
    at.twice_area = area.norm();
    at.normal = area / at.twice_area;
    at.gap = at.normal.dot(arm);
    at.gradient[1] = at.edge2.cross(at.normal) / at.twice_area;
    at.gradient[2] = at.normal.cross(at.edge1) / at.twice_area;
    at.gradient[0] = -(at.gradient[1] + at.gradient[2]);
    at.share[1] = arm.dot(at.gradient[1]);
    at.share[2] = arm.dot(at.gradient[2]);
    at.share[0] = 1.0 - at.share[1] - at.share[2];
    std::array<RampAndRate, 3> ramp;
    for (int i = 0; i < 3; ++i)
        ramp[i] = window_ramp(at.share[i]);
    at.window = ramp[0].value * ramp[1].value * ramp[2].value;
    at.window_gradient = ramp[0].rate * ramp[1].value * ramp[2].value * at.gradient[0] +
                         ramp[0].value * ramp[1].rate * ramp[2].value * at.gradient[1] +
                         ramp[0].value * ramp[1].value * ramp[2].rate * at.gradient[2];
    return at;
}

/// Velocity [m/s] at which the foot of the node slides over the material of the triangle: sum db_i/dt x_i.
/// Zero in any motion of a rigid body.
inline Vec3 slip_of(const OverTriangle& at, const NodeAndTriangle& v) {
    const auto& b = at.share;
    const Vec3 relative = v.node - b[0] * v.corner[0] - b[1] * v.corner[1] - b[2] * v.corner[2];
    const Vec3 turning =
        ((v.corner[1] - v.corner[0]).cross(at.edge2) + at.edge1.cross(v.corner[2] - v.corner[0])) /
        at.twice_area;  // dn/dt and a part along n
    const Vec3 slip = relative - at.gap * turning;
    return slip - slip.dot(at.normal) * at.normal;
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

/// E = 1/2 k w d^2 of an overlap d > 0. The normal force is N = k w d, friction is
/// mu N u/sqrt(u^2 + (mu N/c)^2) against the slip u: Coulomb's where slip is fast, viscous with c where it is
/// slow, so that it never holds more than c. All forces are derivatives by what no motion of a rigid body
/// changes, g and b, and sum to no force and no moment.
inline SelfContactForce self_contact_force(const SelfContactLaw& law, const OverTriangle& at, int side,
                                           double overlap, const NodeAndTriangle& v) {
    SelfContactForce f;
    f.normal = law.stiffness * at.window * overlap;
    f.energy = 0.5 * f.normal * overlap;
    // Along the plane, on the node: what the window pulls, and friction.
    Vec3 along = -0.5 * law.stiffness * overlap * overlap * at.window_gradient;
    f.dissipated = 0.0;
    const double most = law.friction * f.normal;
    if (most > 0.0) {
        const Vec3 slip = slip_of(at, v);
        const double viscous = most * law.viscosity /
                               std::sqrt(law.viscosity * law.viscosity * slip.squaredNorm() + most * most);
        along -= viscous * slip;
        f.dissipated = viscous * slip.squaredNorm();
    }
    f.on.node = side * f.normal * at.normal + along;
    for (int i = 0; i < 3; ++i)
        f.on.corner[i] = -at.share[i] * f.on.node;
    // The foot also slides as the triangle turns under a node that is not in its plane.
    const double lever = at.gap / at.twice_area;
    const Vec3 on1 = lever * at.edge2.cross(along), on2 = lever * along.cross(at.edge1);
    f.on.corner[1] -= on1;
    f.on.corner[2] -= on2;
    f.on.corner[0] += on1 + on2;
    return f;
}

/// Bound [N/m] on the norm of the second derivative of E by the node's position, over the window: w <= 1, its
/// first and second derivative by b at most 1.5/(2 e) and 6/(4 e^2), e its half width. The other blocks are
/// at most this times the shares. overlap [m]; steepest: the largest gradient of b [1/m].
inline double self_contact_tangent(double stiffness, double overlap, double steepest) {
    const double turn = overlap * steepest, e = window_half_width;
    return stiffness * (1.0 + turn * (2.0 + 1.5 / e) + turn * turn * 1.5 / (e * e));
}

}  // namespace twinchute::fullsim
