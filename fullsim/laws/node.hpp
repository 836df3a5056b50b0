// Update of one node in a step: damping, accretion and the half step of the central difference (leapfrog)
// scheme (paper, Eqs 4, 8 and 9). See membrane.hpp for the template and its guard; a velocity is x, y and z
// of one node or of several.
#if defined(TWINCHUTE_LAWS_NODE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_NODE
#undef TWINCHUTE_LAWS_NODE
#else
#define TWINCHUTE_LAWS_NODE
#endif

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// -c (v - v_mean): mass damping (paper, Eq. 4) and breathing damping. It takes power out of the motion and,
/// summed over the nodes of that mean, applies no net force. c [N s/m].
template <class S, class V, class P>
HWY_INLINE void resist(S c, V relative, V& force, P& dissipated) {
    const V resistance = c * relative;
    force = force - resistance;
    dissipated += work(resistance, relative);
}

/// Air that joins the canopy at `rate` [kg/s] is brought from the wind's velocity to the node's.
template <class S, class V, class P>
HWY_INLINE void accrete(S rate, V wind, V v, V& force, P& power) {
    const V joining = rate * (wind - v);
    force += joining;
    power += work(joining, v);
}

/// v^{n+1/2} = v^{n-1/2} + (dt^{n+1} + dt^n)/2 a^n (paper, Eq. 8). kick: that mean step [s].
template <class S, class V>
HWY_INLINE V kicked(V before, V acceleration, S kick) {
    return before + kick * acceleration;
}

/// v^n [m/s] from both half steps: exact for the energy balance.
template <class V>
HWY_INLINE V middle_of(V before, V after) {
    return 0.5 * (before + after);
}

/// Twice the kinetic energy that the leapfrog scheme keeps, m v^{n-1/2} (v^{n-1/2} + dt a), with what drag
/// and weight were booked half a step ahead of their power (ledger_before). change: dt a [m/s]; dt: of the
/// step before [s]; booked: drag and weight [N].
template <class S, class D, class V>
HWY_INLINE auto twice_kinetic(S inertia, V before, V change, D dt, V booked, V middle) {
    return inertia * work(before, before + change) + dt * work(booked, middle - before);
}

/// x^{n+1} = x^n + dt v^{n+1/2} (paper, Eq. 9), and v^{n+1} extrapolated by another half step of the same
/// acceleration. Returns v^{n+1}.
template <class S, class V>
HWY_INLINE V drift(V& x, V after, V acceleration, S dt, S half_dt) {
    x += dt * after;
    return after + half_dt * acceleration;
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
