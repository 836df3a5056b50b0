// The arithmetic of contact between gores, written once as that of membranes is: for four pairs in Lanes, and
// for as many as the processor takes at once (see membrane_kernel.hpp for the guard).
#if defined(TWINCHUTE_CONTACT_KERNEL) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_CONTACT_KERNEL
#undef TWINCHUTE_CONTACT_KERNEL
#else
#define TWINCHUTE_CONTACT_KERNEL
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

/// What contact does to such a pair.
template <class T, class T3>
struct ContactPush {
    T3 apart;           ///< [N] added to the first node, taken from the second
    T3 half_of_middle;  ///< [N] taken from either: half of dE/dm
    T3 by_turning;      ///< [N m] dE/du, of the axis
    T energy;           ///< [J]
};

/// E = K s^2/2 for s < 0, with s the distance between both nodes around the axis: d.w/|w|, w = u x m across
/// both the axis u and the arm m from the axis to their middle, d from the first node to the second. Nodes
/// on opposite sides of the axis do not meet.
template <class T, class T3>
HWY_INLINE ContactPush<T, T3> contact_push(T stiffness, T3 axis, const ContactArm<T, T3>& arm) {
    const T zero = stiffness - stiffness;
    const T3 across = cross(axis, arm.d);
    const T square = dot(arm.w, arm.w) + 1e-30;
    const T share = select(4.0 * square > dot(across, across), arm.behind / square, zero);  // -s/|w|
    const T pull = stiffness * share;
    const T3 by_arm = (zero - pull) * (arm.d + share * arm.w);  // dE/dw
    return {(zero - pull) * arm.w, (zero + 0.5) * cross(by_arm, axis), cross(arm.middle, by_arm),
            0.5 * (pull * (share * square))};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
