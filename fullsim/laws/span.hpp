// The distance between two nodes and its rate, which cables and fabric springs act along (see membrane.hpp
// for the template and its guard).
#if defined(TWINCHUTE_LAWS_SPAN) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LAWS_SPAN
#undef TWINCHUTE_LAWS_SPAN
#else
#define TWINCHUTE_LAWS_SPAN
#endif

#include <hwy/highway.h>

#include "lib/math/lanes.hpp"
#include "lib/math/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

template <class T, class T3>
struct Span {
    T3 d;                                // [m] from the first node to the second
    T square, inverse, elongation_rate;  // of the length [m^2], [1/m]; its rate [m/s]

    /// Engineering strain (l - l0)/l0, from 1/l0 [1/m].
    HWY_INLINE T strain(T inverse_rest_length) const { return square * inverse * inverse_rest_length - 1.0; }
};

/// d [m] and relative velocity w [m/s] of the second node.
template <class T3>
HWY_INLINE auto span_of(T3 d, T3 w) {
    using T = decltype(dot(d, d));
    Span<T, T3> span;
    span.d = d;
    span.square = dot(d, d) + 1e-18;  // keeps a span of no length from being 0/0
    span.inverse = inverse_root(span.square);
    span.elongation_rate = dot(d, w) * span.inverse;
    return span;
}

/// Where rates do not matter.
template <class T, class T3>
HWY_INLINE T span_strain(T inverse_rest_length, T3 d) {
    const T square = dot(d, d) + 1e-18;
    return square * inverse_root(square) * inverse_rest_length - 1.0;
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
