// The arithmetic of cloth as springs and folds, for elements side by side. Included once for every
// instruction set (see membrane_kernel.hpp for the guard).
#if defined(TWINCHUTE_LANES_EDGES) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LANES_EDGES
#undef TWINCHUTE_LANES_EDGES
#else
#define TWINCHUTE_LANES_EDGES
#endif

#include "fullsim/forces/spring.hpp"
#include "fullsim/lanes/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// From one node to another.
struct Span {
    Vec3s d;                           // [m]
    Vec square, inverse, lengthening;  // of the length [m^2], [1/m]; its rate [m/s]

    HWY_INLINE Vec strain(Vec inverse_rest_length) const {
        return square * inverse * inverse_rest_length - 1.0;
    }
};

/// Distance and relative velocity.
HWY_INLINE Span span_of(Vec3s d, Vec3s w) {
    Span span;
    span.d = d;
    span.square = dot(d, d) + 1e-18;  // keeps a span of no length from being 0/0
    span.inverse = inverse_root(span.square);
    span.lengthening = dot(d, w) * span.inverse;
    return span;
}

struct Tension {
    Vec tension, dissipated;  // [N], [W]
};

/// An edge of cloth: EA (e + growth e^2) up to the strain to which it hardens, linear beyond; folded it
/// repels a little, and without a dashpot.
HWY_INLINE Tension spring_tension(const Span& span, Vec strain, Vec stiffness, Vec growth, Vec dashpot,
                                  double repulsion) {
    const Vec zero = all(0.0), full = all(full_hardening_strain);
    const Vec low = select(strain < full, strain, full);
    const Vec pull = stiffness * (strain + growth * low * (low + 2.0 * (strain - low)));
    const Vec push = repulsion * stiffness * strain;
    const Mask taut = strain > zero;
    const Vec spring = select(taut, pull, push);
    const Vec tension = select(taut, larger(pull + dashpot * span.lengthening, zero), push);
    return {tension, (tension - spring) * span.lengthening};
}

/// Holds an edge while it is folded and lengthens.
HWY_INLINE Tension fold_tension(const Span& span, Vec strain, Vec fold_force) {
    const Vec zero = all(0.0), one = all(1.0);
    const Vec growing = larger(span.lengthening, zero);
    const Vec speed_share = growing * all(1.0 / full_fold_speed);
    const Vec folded = select(strain < zero, fold_force, zero);
    const Vec hold = folded * select(speed_share < one, speed_share, one);
    return {hold, hold * growing};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
