// Contact of a node with a triangle of fabric: one pair (see membrane.hpp for the template and its guard).
#if defined(TWINCHUTE_LAWS_NODE_OVER_TRIANGLE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_NODE_OVER_TRIANGLE
#undef TWINCHUTE_LAWS_NODE_OVER_TRIANGLE
#else
#define TWINCHUTE_LAWS_NODE_OVER_TRIANGLE
#endif

#include <array>

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"
#include "lib/math/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// Half the width of the strip along an edge over which one triangle hands over to the next, in barycentric
/// coordinates.
inline constexpr double half_width_of_window = 0.15;

/// Places [m] or velocities [m/s] of the corners 1 and 2 and of the node relative to corner 0.
template <class T3>
struct FromCorner {
    T3 edge1, edge2, arm;
};

/// Where a node stands over a triangle: x = sum b_i x_i + g n.
template <class T, class T3>
struct PlaceOverTriangle {
    T3 edge1, edge2;             ///< [m] from corner 0 to 1 and 2
    T3 normal;                   ///< n, a unit vector
    T twice_area;                ///< [m^2]
    T inverse_area;              ///< [1/m^2] 1/twice_area
    T gap;                       ///< g [m]
    std::array<T, 3> share;      ///< b, barycentric coordinates of the foot of the node
    std::array<T3, 3> gradient;  ///< [1/m] of b, in the plane
    T window;                    ///< w [-] share of the pair in the contact with the sheet
    T3 window_gradient;          ///< [1/m]
};

template <class T>
struct RampAndRateOf {
    T value, rate;
};
/// 0 below -width, 1 above width, a cubic between: r(b) + r(-b) = 1, so that on a flat sheet neighbours hand
/// a node over at the same force.
template <class T>
HWY_INLINE RampAndRateOf<T> ramp_of_window(T b) {
    using twinchute::larger, twinchute::like, twinchute::smaller;
    const T t = smaller(larger((0.5 / half_width_of_window) * b + 0.5, like(b, 0.0)), like(b, 1.0));
    return {t * t * (3.0 - 2.0 * t), (3.0 / half_width_of_window) * (t * (1.0 - t))};
}

/// Place over a triangle, which has an area.
template <class T, class T3>
HWY_INLINE void find_place(const FromCorner<T3>& x, PlaceOverTriangle<T, T3>& at) {
    using twinchute::cross, twinchute::dot, twinchute::inverse_root;
    const T3 area = cross(x.edge1, x.edge2);
    const T squared = dot(area, area);
    at.edge1 = x.edge1;
    at.edge2 = x.edge2;
    at.inverse_area = inverse_root(squared);
    at.twice_area = squared * at.inverse_area;
    at.normal = at.inverse_area * area;
    at.gap = dot(at.normal, x.arm);
    at.gradient[1] = at.inverse_area * cross(x.edge2, at.normal);
    at.gradient[2] = at.inverse_area * cross(at.normal, x.edge1);
    at.gradient[0] = -1.0 * (at.gradient[1] + at.gradient[2]);
    at.share[1] = dot(x.arm, at.gradient[1]);
    at.share[2] = dot(x.arm, at.gradient[2]);
    at.share[0] = 1.0 - at.share[1] - at.share[2];
    const auto r0 = ramp_of_window(at.share[0]), r1 = ramp_of_window(at.share[1]),
               r2 = ramp_of_window(at.share[2]);
    at.window = r0.value * r1.value * r2.value;
    at.window_gradient = (r0.rate * r1.value * r2.value) * at.gradient[0] +
                         (r0.value * r1.rate * r2.value) * at.gradient[1] +
                         (r0.value * r1.value * r2.rate) * at.gradient[2];
}

/// Velocity [m/s] at which the foot of the node slides over the material of the triangle: sum db_i/dt x_i.
/// Zero in any motion of a rigid body.
template <class T, class T3>
HWY_INLINE T3 slip_over(const PlaceOverTriangle<T, T3>& at, const FromCorner<T3>& v) {
    using twinchute::cross, twinchute::dot;
    const T3 relative = v.arm - at.share[1] * v.edge1 - at.share[2] * v.edge2;
    const T3 turning = (at.gap * at.inverse_area) *
                       (cross(v.edge1, at.edge2) + cross(at.edge1, v.edge2));  // dn/dt and a part along n
    const T3 slip = relative - turning;
    return slip - dot(slip, at.normal) * at.normal;
}

/// Forces [N] of a pair.
template <class T, class T3>
struct PushOfPair {
    T3 on_node;
    std::array<T3, 3> on_corner;
    T normal;      ///< N [N]
    T dissipated;  ///< [W]
};

/// E = 1/2 k w d^2 of an overlap d > 0. The normal force is N = k w d, friction is
/// mu N u/sqrt(u^2 + (mu N/c)^2) against the slip u: Coulomb's where slip is fast, viscous with c where it is
/// slow, so that it never holds more than c. All forces are derivatives by what no motion of a rigid body
/// changes, g and b, and sum to no force and no moment. side: 1 or -1; stiffness k [N/m], viscosity c
/// [N s/m], friction mu [-].
template <class T, class T3>
HWY_INLINE void push_pair(double stiffness, double friction, T viscosity, const PlaceOverTriangle<T, T3>& at,
                          T side, T overlap, const FromCorner<T3>& v, PushOfPair<T, T3>& f) {
    using twinchute::cross, twinchute::dot, twinchute::inverse_root, twinchute::like;
    const T pull = stiffness * overlap;
    f.normal = at.window * pull;
    // Along the plane, on the node: what the window pulls, and friction.
    T3 along = (-0.5 * (pull * overlap)) * at.window_gradient;
    f.dissipated = like(overlap, 0.0);
    if (friction > 0.0) {
        const T most = friction * f.normal;
        const T3 slip = slip_over(at, v);
        const T speed_squared = dot(slip, slip);
        // Where nothing pushes the addend keeps zero from being divided by zero.
        const T viscous =
            (most * viscosity) * inverse_root(viscosity * viscosity * speed_squared + most * most + 1e-300);
        along = along - viscous * slip;
        f.dissipated = viscous * speed_squared;
    }
    f.on_node = (side * f.normal) * at.normal + along;
    // The foot also slides as the triangle turns under a node that is not in its plane.
    const T lever = at.gap * at.inverse_area;
    const T3 on1 = lever * cross(at.edge2, along), on2 = lever * cross(along, at.edge1);
    f.on_corner[0] = on1 + on2 - at.share[0] * f.on_node;
    f.on_corner[1] = -1.0 * (on1 + at.share[1] * f.on_node);
    f.on_corner[2] = -1.0 * (on2 + at.share[2] * f.on_node);
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
