// Contact between gores: one pair of nodes (see membrane.hpp for the template and its guard).
#if defined(TWINCHUTE_LAWS_CONTACT) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_CONTACT
#undef TWINCHUTE_LAWS_CONTACT
#else
#define TWINCHUTE_LAWS_CONTACT
#endif

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// How a pair stands around the axis.
template <class T, class T3>
struct ContactArm {
    T3 d;       ///< [m] from the first node to the second
    T3 middle;  ///< [m] between both, from a point of the axis
    T3 w;       ///< [m] u x middle
    T behind;   ///< [m^2] above zero where the second node lies behind the first
};

/// axis: u. first: arm of the first node, since differences of places are exact and their sums are not.
template <class T, class T3>
HWY_INLINE ContactArm<T, T3> contact_arm(T zero, T3 axis, T3 first, T3 d) {
    const T3 middle = first + (zero + 0.5) * d, w = cross(axis, middle);
    return {d, middle, w, larger(zero - dot(d, w), zero)};
}

/// Contact forces on such a pair, and their energy.
template <class T, class T3>
struct ContactPush {
    T3 apart;           ///< [N] added to the first node, taken from the second
    T3 half_of_middle;  ///< [N] taken from either: half of dE/dm
    T3 by_turning;      ///< [N m] dE/du, of the axis
    T energy;           ///< [J]
};

/// E = K b^2/(2 (w^2 + p^2)) for b > 0, with b = -d.w twice the area between the axis and both nodes in the
/// wrong order, w = u x m across both the axis u and the arm m from the axis to their middle, p the part of
/// d, from the first node to the second, across the axis. Where both are near to each other that is K s^2/2,
/// s = b/|w| how far the second lies behind the first. Around the whole axis, and through it, E and its
/// derivative are continuous: where nodes are on opposite sides of the axis, or either is on it, both vanish.
template <class T, class T3>
HWY_INLINE ContactPush<T, T3> contact_push(T stiffness, T3 axis, const ContactArm<T, T3>& arm) {
    const T zero = stiffness - stiffness, along = dot(axis, arm.d);
    const T3 across = arm.d - along * axis;
    const T share = arm.behind / (dot(arm.w, arm.w) + dot(across, across) + 1e-30);
    const T pull = stiffness * share;
    const T3 by_arm = (zero - pull) * (arm.d + share * arm.w);  // dE/dw
    return {(zero - pull) * (arm.w + share * across), (zero + 0.5) * cross(by_arm, axis),
            cross(arm.middle, by_arm) + (pull * share * along) * arm.d, 0.5 * (pull * arm.behind)};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
