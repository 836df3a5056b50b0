// Loops over pairs of nodes of neighbouring gores (see membrane.hpp for views and the guard).
#if defined(TWINCHUTE_ELEMENTS_CONTACT) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_ELEMENTS_CONTACT
#undef TWINCHUTE_ELEMENTS_CONTACT
#else
#define TWINCHUTE_ELEMENTS_CONTACT
#endif

#include "fullsim/elements/passes.hpp"
#include "fullsim/laws/contact.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

template <class View>
HWY_INLINE ElementSums contact_forces(const View& view, const ContactPass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const T3 centre = View::all3(pass.centre), axis = View::all3(pass.direction);
    const T zero = View::all(0.0);
    T3 by_arm{zero, zero, zero}, by_turning = by_arm;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto pair = part.element(k);
            T3 first, d;
            pair.arm_and_distance(centre, first, d);
            const auto arm = contact_arm(zero, axis, first, d);
            if (View::skips && !any(arm.behind > zero)) continue;  // all in order
            const auto push = contact_push(pair.stiffness(), axis, arm);
            pair.push_apart(push.apart, push.half_of_middle);
            by_arm += part.live(View::all(2.0)) * push.half_of_middle;
            by_turning += part.live(View::all(1.0)) * push.by_turning;
        }
    }
    ElementSums sums;
    sums.by_arm = {sum(by_arm.x), sum(by_arm.y), sum(by_arm.z)};
    sums.by_turning = {sum(by_turning.x), sum(by_turning.y), sum(by_turning.z)};
    return sums;
}

template <class View>
HWY_INLINE EnergyAndStrain contact_levels(const View& view, const ContactPass& pass) {
    using T = typename View::T;
    using T3 = typename View::T3;
    const T3 centre = View::all3(pass.centre), axis = View::all3(pass.direction);
    const T zero = View::all(0.0);
    T energy = zero;
    for (int p = view.first(); p < view.last(); ++p) {
        const auto part = view.part(p);
        for (std::size_t k = 0; k < part.size(); ++k) {
            const auto pair = part.element(k);
            T3 first, d;
            pair.arm_and_distance(centre, first, d);
            energy +=
                part.live(contact_push(pair.stiffness(), axis, contact_arm(zero, axis, first, d)).energy);
        }
    }
    return {sum(energy), 0.0};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
