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

#if HWY_TARGET != HWY_SCALAR
/// Cells of every second lane from `first` on, side by side.
template <int first, int lanes>
HWY_INLINE auto every_second_cell(const CylinderDragTable::Cell* cells, const std::int64_t* number) {
    if constexpr (lanes == 2) {
        return hn::Load(hn::CappedTag<double, 2>(), &cells[number[first]].value);
    } else {
        constexpr int half = lanes / 2;
        return hn::Combine(hn::CappedTag<double, lanes>(),
                           every_second_cell<first + half, half>(cells, number),
                           every_second_cell<first, half>(cells, number));
    }
}
#endif

/// The table at as many points at once, all between its ends. Value and slope of a cell are one load: to
/// gather them took half of the time of a line's drag.
HWY_INLINE Vec between_ends(const CylinderDragTable& table, Vec reynolds) {
    const hn::RebindToSigned<Tag> whole;
    Vec result;
    for (int k = 0; k < unroll_factor; ++k) {
        const auto left = hn::ShiftRight<48>(hn::BitCast(whole, reynolds.raw[k]));
        const auto start = hn::BitCast(tag, hn::ShiftLeft<48>(left));
        const auto cell = hn::Sub(left, hn::Set(whole, CylinderDragTable::first_cell));
#if HWY_TARGET == HWY_SCALAR
        const CylinderDragTable::Cell& at = table.cells()[hn::GetLane(cell)];
        const auto value = hn::Set(tag, at.value), slope = hn::Set(tag, at.slope);
#else
        alignas(64) std::int64_t number[lanes_of_register];
        hn::Store(cell, whole, number);
#ifdef __GNUC__
        __asm__("" : "+m"(number));  // GCC would rather take them out of the register one after the other
#endif
        const auto even = every_second_cell<0, lanes_of_register>(table.cells(), number);
        const auto odd = every_second_cell<1, lanes_of_register>(table.cells(), number);
        const auto value = hn::InterleaveLower(tag, even, odd), slope = hn::InterleaveUpper(tag, even, odd);
#endif
        result.raw[k] = hn::Add(value, hn::Mul(hn::Sub(reynolds.raw[k], start), slope));
    }
    return result;
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
