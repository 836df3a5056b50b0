// Fabric as springs and dashpots along the edges of its triangles, and what holds it folded (paper, 2.1 and
// 5.2): one edge (see membrane.hpp for the template and its guard).
#if defined(TWINCHUTE_LAWS_FABRIC_SPRING) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_FABRIC_SPRING
#undef TWINCHUTE_LAWS_FABRIC_SPRING
#else
#define TWINCHUTE_LAWS_FABRIC_SPRING
#endif

#include "fullsim/forces/spring.hpp"
#include "fullsim/laws/span.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

template <class T>
struct Tension {
    T tension, dissipated;  // [N], [W]
};

/// EA (e + hardening e^2) up to the strain e_m to which an edge hardens, linear beyond. Folded fabric repels
/// a little, and without a dashpot: nothing of it is taut. repulsion: of folded fabric over EA [-].
template <class T, class S>
HWY_INLINE Tension<T> spring_tension(const S& span, T strain, T stiffness, T hardening, T dashpot,
                                     double repulsion) {
    const T zero = like(strain, 0.0), full = like(strain, full_hardening_strain);
    const T low = select(strain < full, strain, full);
    const T pull = stiffness * (strain + hardening * low * (low + 2.0 * (strain - low)));
    const T push = repulsion * stiffness * strain;
    const auto taut = strain > zero;
    const T spring = select(taut, pull, push);
    const T tension = select(taut, larger(pull + dashpot * span.elongation_rate, zero), push);
    return {tension, (tension - spring) * span.elongation_rate};
}

/// [J] over EA l0, of which that tension is the derivative.
template <class T>
HWY_INLINE T spring_energy(T strain, T hardening, double repulsion) {
    const T low = smaller(strain, like(strain, full_hardening_strain)), high = strain - low;
    const T half_square = 0.5 * (strain * strain);
    const T pulled = half_square + hardening * low * (low * low * (1.0 / 3.0) + high * strain);
    return select(strain > like(strain, 0.0), pulled, repulsion * half_square);
}

/// [-] tangent stiffness over EA/l0. Any edge may come taut any time, unless all are folded.
template <class T>
HWY_INLINE T spring_tangent(T strain, T hardening) {
    const T low = smaller(larger(strain, like(strain, 0.0)), like(strain, full_hardening_strain));
    return 1.0 + 2.0 * hardening * low;
}

/// Holds a folded edge while it lengthens: in full from full_fold_speed on, in proportion below.
template <class T, class S>
HWY_INLINE Tension<T> fold_tension(const S& span, T strain, T fold_force) {
    const T zero = like(strain, 0.0), one = like(strain, 1.0);
    const T growing = larger(span.elongation_rate, zero);
    const T speed_share = growing * (1.0 / full_fold_speed);
    const T folded = select(strain < zero, fold_force, zero);
    const T hold = folded * select(speed_share < one, speed_share, one);
    return {hold, hold * growing};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
