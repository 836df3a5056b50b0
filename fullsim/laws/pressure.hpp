// Air on a triangle of fabric: pressure along e_r and across it (paper, Eqs 11 and 12), and
// drag until the canopy fills (paper, 3.2.1). See membrane.hpp for the template and its guard.
#if defined(TWINCHUTE_LAWS_PRESSURE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_PRESSURE
#undef TWINCHUTE_LAWS_PRESSURE
#else
#define TWINCHUTE_LAWS_PRESSURE
#endif

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

template <class T, class T3>
struct PushedArea {
    T3 on_corner;        // [m^2] force on each corner per pressure
    T projected, along;  // [m^2] of the triangle along e_r: where it faces the air, and signed
};

/// A third of A_p e_r + phi (A - (A.e_r) e_r) to each corner. area: A [m^2]; third, radial: 1/3 and phi/3.
template <class T, class T3>
HWY_INLINE PushedArea<T, T3> pushed_area(T3 area, T3 e, T third, T radial) {
    const T along = dot(area, e), projected = larger(along, like(along, 0.0));
    return {(third * projected - radial * along) * e + radial * area, projected, along};
}

/// e_r along z.
template <class T>
struct AxialFlow {
    T up;  // 1 or -1
};
template <class T, class T3>
HWY_INLINE PushedArea<T, T3> pushed_area(T3 area, AxialFlow<T> e, T third, T radial) {
    const T along = area.z * e.up, projected = larger(along, like(along, 0.0));
    return {{radial * area.x, radial * area.y, third * e.up * projected}, projected, along};
}

/// [m^2] of a triangle along e_r, signed.
template <class T3>
HWY_INLINE auto area_along(T3 area, T3 e) {
    return dot(area, e);
}
template <class T, class T3>
HWY_INLINE T area_along(T3 area, AxialFlow<T> e) {
    return area.z * e.up;
}

template <class T, class T3>
struct FabricDrag {
    T3 on_corner;  // [N]
    T across;      // [m^2] area that the air meets
};

/// 1/2 rho C_D |A.e| V^2 e, a third to each corner: V e the air's velocity relative to the triangle's mean
/// [m/s] (paper, 3.2.1; Eqs 11 and 12 with phi = 0). factor: 1/2 rho C_D/3 [kg/m^3].
template <class T, class T3>
HWY_INLINE FabricDrag<T, T3> fabric_drag(T3 area, T3 velocity, T factor) {
    const T flow = dot(area, velocity);  // |A.e| V
    const T swept = larger(flow, -flow);
    return {(factor * swept) * velocity, swept * inverse_root(dot(velocity, velocity) + 1e-18)};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
