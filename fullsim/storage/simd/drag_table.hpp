// The cylinder's drag coefficient for elements side by side. Included once for every instruction set (see
// fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_LANES_DRAG_TABLE) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LANES_DRAG_TABLE
#undef TWINCHUTE_LANES_DRAG_TABLE
#else
#define TWINCHUTE_LANES_DRAG_TABLE
#endif

#include "fullsim/storage/simd/vec.hpp"
#include "lib/models/cylinder_drag.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// The table at as many points at once, all between its ends.
HWY_INLINE Vec between_ends(const CylinderDragTable& table, Vec reynolds) {
    const hn::RebindToSigned<Tag> whole;
    Vec result;
    for (int k = 0; k < unroll_factor; ++k) {
        const auto left = hn::ShiftRight<48>(hn::BitCast(whole, reynolds.raw[k]));
        const auto cell = hn::Sub(left, hn::Set(whole, CylinderDragTable::first_cell));
        const auto start = hn::BitCast(tag, hn::ShiftLeft<48>(left));
        const auto value = hn::GatherIndex(tag, table.values(), cell);
        const auto slope = hn::GatherIndex(tag, table.slopes(), cell);
        result.raw[k] = hn::Add(value, hn::Mul(hn::Sub(reynolds.raw[k], start), slope));
    }
    return result;
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
