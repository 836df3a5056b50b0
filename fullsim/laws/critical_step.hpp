// The critical time step of one node (see membrane.hpp for the template and its guard).
#if defined(TWINCHUTE_LAWS_CRITICAL_STEP) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_CRITICAL_STEP
#undef TWINCHUTE_LAWS_CRITICAL_STEP
#else
#define TWINCHUTE_LAWS_CRITICAL_STEP
#endif

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// 2 (sqrt(C^2 + K m) - C)/K without cancellation, and right for K = 0 [s]: where the growth factor of the
/// central difference scheme, whose viscous forces see a velocity extrapolated over half a step, is -1. K, C:
/// Gershgorin row sums of stiffness [N/m] and damping [N s/m]; m [kg].
template <class T>
HWY_INLINE T critical_step(T stiffness, T damping, T mass) {
    return 2.0 * mass / (square_root(damping * damping + stiffness * mass) + damping);
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
