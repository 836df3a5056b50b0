// Suspension lines, risers and tapes: one cable (see membrane.hpp for the template and its guard).
#if defined(TWINCHUTE_LAWS_CABLE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_CABLE
#undef TWINCHUTE_LAWS_CABLE
#else
#define TWINCHUTE_LAWS_CABLE
#endif

#include "fullsim/laws/span.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// Force of a cable on its first end; its second end takes the opposite.
template <class T, class T3>
struct CablePull {
    T3 force;      // [N]
    T spring;      // [N] elastic tension, below zero where slack
    T dissipated;  // [W]
};

/// T = max(0, EA (l - l0)/l0 + (beta E/l0 + b1 rho c1) A dl/dt): it pulls and never pushes (paper, Eqs 2 and
/// 3). From end to end d [m], w [m/s]; 1/l0 [1/m], EA [N], dashpot [N s/m].
template <class T, class T3>
HWY_INLINE CablePull<T, T3> cable_pull(T inverse_length, T stiffness, T dashpot, T3 d, T3 w) {
    const auto span = span_of(d, w);
    const T zero = like(span.square, 0.0);
    const T spring = stiffness * span.strain(inverse_length);
    const T tension = larger(spring + dashpot * span.elongation_rate, zero);
    // Whatever differs from the conservative tension dissipates, also where it is cut at zero.
    return {(tension * span.inverse) * span.d, spring,
            (tension - larger(spring, zero)) * span.elongation_rate};
}

/// [J] over EA l0.
template <class T>
HWY_INLINE T cable_energy(T strain) {
    const T taut = larger(strain, like(strain, 0.0));
    return 0.5 * (taut * taut);
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
