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

/// Of a pair whose second node lies behind the first.
template <class T, class T3>
struct ContactPush {
    T3 apart;           ///< [N] added to the first node, taken from the second
    T3 half_of_middle;  ///< [N] taken from either: half of dE/dm
    T3 by_turning;      ///< [N m] dE/du, of the axis
    T energy;           ///< [J]
    T behind;           ///< [m^2] above zero where they may be in contact
};

/// E = K s^2/2 for s < 0, with s the distance between both nodes around the axis: d.w/|w|, w = u x m across
/// both the axis u and the arm m from the axis to their middle, d from the first node to the second. Nodes
/// on opposite sides of the axis do not meet. first: arm of the first node, since differences of places are
/// exact and their sums are not.
template <class T, class T3>
HWY_INLINE ContactPush<T, T3> contact_push(T stiffness, T3 axis, T3 first, T3 d) {
    const T zero = stiffness - stiffness;
    const T3 middle = first + (zero + 0.5) * d;
    const T3 w = cross(axis, middle), across = cross(axis, d);
    const T square = dot(w, w) + 1e-30;
    const T behind = larger(zero - dot(d, w), zero);
    const T share = select(4.0 * square > dot(across, across), behind / square, zero);  // -s/|w|
    const T pull = stiffness * share;
    const T3 by_arm = (zero - pull) * (d + share * w);  // dE/dw
    return {(zero - pull) * w, (zero + 0.5) * cross(by_arm, axis), cross(middle, by_arm),
            0.5 * (pull * (share * square)), behind};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
