// Drag of a line element as a cylinder across the wind (paper, Eq. 10). See membrane.hpp for the template and
// its guard.
#if defined(TWINCHUTE_LAWS_CYLINDER_DRAG) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_CYLINDER_DRAG
#undef TWINCHUTE_LAWS_CYLINDER_DRAG
#else
#define TWINCHUTE_LAWS_CYLINDER_DRAG
#endif

#include <cmath>

#include <hwy/highway.h>

#include "lib/models/cylinder_drag.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// 1/2 rho d l C_d(Re) |V_t| V_t, half of it to each end: V_t is the air's velocity relative to the element's
/// middle, across its axis, and l its current length.
class CylinderDrag {
public:
    /// diameter [m], density [kg/m^3], viscosity [Pa s]
    CylinderDrag(const CylinderDragTable& table, double diameter, double density, double viscosity)
        : table_(table),
          reynolds_per_speed_(density * diameter / viscosity),
          factor_(0.25 * density * diameter) {}

    /// [N] on either end: d [m] from end to end, v [m/s] of the air relative to the cable's middle.
    template <class T3>
    HWY_INLINE T3 on_end(T3 d, T3 v) const {
        const auto square = dot(d, d) + 1e-18;
        const auto inverse = inverse_root(square);
        const T3 across = v - (dot(v, d) * inverse * inverse) * d;
        // Below the table C_d Re is constant, so that C_d |V| is what it is at the table's foot.
        const auto speed_square = dot(across, across) + 1e-60;
        const auto speed = larger(speed_square * inverse_root(speed_square),
                                  like(square, CylinderDragTable::lowest / reynolds_per_speed_));
        // The product may round to below the table's foot, where nothing is.
        const auto reynolds =
            smaller(larger(reynolds_per_speed_ * speed, like(square, CylinderDragTable::lowest)),
                    like(square, std::nextafter(CylinderDragTable::highest, 0.0)));
        return (factor_ * square * inverse * speed * between_ends(table_, reynolds)) * across;
    }

private:
    const CylinderDragTable& table_;
    double reynolds_per_speed_, factor_;
};

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
