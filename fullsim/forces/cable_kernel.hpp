// The arithmetic of cables and of the air across them, for as many as the processor takes at once: compiled
// anew for every instruction set (see membrane_kernel.hpp for the guard).
#if defined(TWINCHUTE_CABLE_KERNEL) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_CABLE_KERNEL
#undef TWINCHUTE_CABLE_KERNEL
#else
#define TWINCHUTE_CABLE_KERNEL
#endif

#include <cmath>

#include "fullsim/lanes/vec.hpp"
#include "lib/models/cylinder_drag.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// What a cable does to its first end; its second end takes the opposite.
struct CablePull {
    Vec3s force;     // [N]
    Vec spring;      // [N] elastic tension, below zero where slack
    Vec dissipated;  // [W]
};

/// From end to end d [m], w [m/s]. Constants as CableConstants; it pulls, never pushes (paper, Eqs 2 and 3).
HWY_INLINE CablePull cable_pull(Vec inverse_length, Vec stiffness, Vec dashpot, Vec3s d, Vec3s w) {
    const Vec zero = all(0.0);
    const Vec square = dot(d, d) + 1e-18;  // keeps a cable of no length from being 0/0
    const Vec inverse = inverse_root(square);
    const Vec lengthening = dot(d, w) * inverse;
    const Vec spring = stiffness * (square * inverse * inverse_length - 1.0);
    const Vec tension = larger(spring + dashpot * lengthening, zero);
    return {(tension * inverse) * d, spring, (tension - larger(spring, zero)) * lengthening};
}

/// The table at as many points at once, all between its ends.
HWY_INLINE Vec between_ends(const CylinderDragTable& table, Vec reynolds) {
    const hn::RebindToSigned<Tag> whole;
    Vec result;
    for (int k = 0; k < ways; ++k) {
        const auto left = hn::ShiftRight<48>(hn::BitCast(whole, reynolds.raw[k]));
        const auto cell = hn::Sub(left, hn::Set(whole, CylinderDragTable::first_cell));
        const auto start = hn::BitCast(tag, hn::ShiftLeft<48>(left));
        const auto value = hn::GatherIndex(tag, table.values(), cell);
        const auto slope = hn::GatherIndex(tag, table.slopes(), cell);
        result.raw[k] = hn::Add(value, hn::Mul(hn::Sub(reynolds.raw[k], start), slope));
    }
    return result;
}

/// Drag of cylinders (paper, Eq. 10), half of it to each end.
class CylinderDrag {
public:
    /// diameter [m], density [kg/m^3], viscosity [Pa s]
    CylinderDrag(const CylinderDragTable& table, double diameter, double density, double viscosity)
        : table_(table),
          reynolds_per_speed_(density * diameter / viscosity),
          factor_(0.25 * density * diameter) {}

    /// [N] on either end: d [m] from end to end, v [m/s] of the air relative to the cable's middle.
    HWY_INLINE Vec3s on_end(Vec3s d, Vec3s v) const {
        const Vec square = dot(d, d) + 1e-18;
        const Vec inverse = inverse_root(square);
        const Vec3s across = v - (dot(v, d) * inverse * inverse) * d;
        // Below the table C_d Re is constant, so that C_d |V| is what it is at the table's foot.
        const Vec speed_square = dot(across, across) + 1e-60;
        const Vec speed = larger(speed_square * inverse_root(speed_square),
                                 all(CylinderDragTable::lowest / reynolds_per_speed_));
        // The product may round to below the table's foot, where nothing is.
        const Vec reynolds = smaller(larger(all(reynolds_per_speed_) * speed, all(CylinderDragTable::lowest)),
                                     all(std::nextafter(CylinderDragTable::highest, 0.0)));
        return (all(factor_) * square * inverse * speed * between_ends(table_, reynolds)) * across;
    }

private:
    const CylinderDragTable& table_;
    double reynolds_per_speed_, factor_;
};

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
