// Elements side by side: doubles in one or two of the processor's registers, with the operators that formulas
// need. Included once for every instruction set (see fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_LANES_VEC) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LANES_VEC
#undef TWINCHUTE_LANES_VEC
#else
#define TWINCHUTE_LANES_VEC
#endif

#include <array>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
inline constexpr Tag tag{};

/// Number of registers that are interleaved. A membrane is a long chain of operations that wait for each
/// other; the second register works while the first one waits. It takes the 32 registers of AVX-512, or
/// values that go to memory and back in between: who includes this defines TWINCHUTE_INTERLEAVED as 1 where
/// these are worth it anyway, as 0 where a loop has so many that they are not.
#ifndef TWINCHUTE_INTERLEAVED
#define TWINCHUTE_INTERLEAVED (HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86)
#endif
#if TWINCHUTE_INTERLEAVED
#define TWINCHUTE_WAYS two_ways
inline namespace two_ways {
inline constexpr int unroll_factor = 2;
}
#else
#define TWINCHUTE_WAYS one_way
inline namespace one_way {
inline constexpr int unroll_factor = 1;
}
#endif
inline namespace TWINCHUTE_WAYS {  // types of two names, in one program
inline constexpr int lanes_of_register = HWY_LANES(double) < 8 ? HWY_LANES(double) : 8;
inline constexpr int lanes_of_all = unroll_factor * lanes_of_register;

struct Vec {
    hn::Vec<Tag> raw[unroll_factor];
};
struct Mask {
    hn::Mask<Tag> raw[unroll_factor];
};

// One operation on each register.
#define TWINCHUTE_EACH(Result, expression)  \
    Result result;                          \
    for (int k = 0; k < unroll_factor; ++k) \
        result.raw[k] = (expression);       \
    return result

HWY_INLINE Vec all(double a) {
    TWINCHUTE_EACH(Vec, hn::Set(tag, a));
}
/// As that of Lanes.
HWY_INLINE Vec like(Vec, double a) {
    return all(a);
}
HWY_INLINE Vec operator+(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Add(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec operator-(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Sub(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec operator*(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Mul(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec operator/(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Div(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec operator+(Vec a, double b) {
    return a + all(b);
}
HWY_INLINE Vec operator-(Vec a, double b) {
    return a - all(b);
}
HWY_INLINE Vec operator+(double a, Vec b) {
    return all(a) + b;
}
HWY_INLINE Vec operator-(double a, Vec b) {
    return all(a) - b;
}
HWY_INLINE Vec operator*(double a, Vec b) {
    return all(a) * b;
}
HWY_INLINE Vec operator*(Vec a, double b) {
    return a * all(b);
}
HWY_INLINE Vec operator-(Vec a) {
    TWINCHUTE_EACH(Vec, hn::Neg(a.raw[k]));
}
HWY_INLINE void operator+=(Vec& a, Vec b) {
    a = a + b;
}

HWY_INLINE Mask operator>(Vec a, Vec b) {
    TWINCHUTE_EACH(Mask, hn::Gt(a.raw[k], b.raw[k]));
}
HWY_INLINE Mask operator<(Vec a, Vec b) {
    TWINCHUTE_EACH(Mask, hn::Lt(a.raw[k], b.raw[k]));
}
HWY_INLINE Mask operator<=(Vec a, Vec b) {
    TWINCHUTE_EACH(Mask, hn::Le(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec select(Mask which, Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::IfThenElse(which.raw[k], a.raw[k], b.raw[k]));
}
/// Whether it is so in some lane.
HWY_INLINE bool any(Mask which) {
    bool found = false;
    for (int k = 0; k < unroll_factor; ++k)
        found = found || !hn::AllFalse(tag, which.raw[k]);
    return found;
}
/// Larger or smaller of a pair, lane by lane; on x86 the second where the first is not a number.
HWY_INLINE Vec larger(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Max(a.raw[k], b.raw[k]));
}
HWY_INLINE Vec smaller(Vec a, Vec b) {
    TWINCHUTE_EACH(Vec, hn::Min(a.raw[k], b.raw[k]));
}

HWY_INLINE Vec square_root(Vec a) {
    TWINCHUTE_EACH(Vec, hn::Sqrt(a.raw[k]));
}

/// 1/sqrt(a) to the last bits but one, for normal a > 0. A root and a division take as long as all the rest
/// of a membrane: an estimate and two steps of Newton do not.
HWY_INLINE Vec inverse_root(Vec a) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    Vec first;
    for (int k = 0; k < unroll_factor; ++k)
        first.raw[k] = hn::Vec<Tag>{_mm512_rsqrt14_pd(a.raw[k].raw)};
    const Vec half = 0.5 * a;
    const Vec second = first * (1.5 - half * (first * first));
    return second * (1.5 - half * (second * second));
#else
    return all(1.0) / square_root(a);
#endif
}

HWY_INLINE double sum(Vec a) {
    double total = 0.0;
    for (int k = 0; k < unroll_factor; ++k)
        total += hn::GetLane(hn::SumOfLanes(tag, a.raw[k]));
    return total;
}
HWY_INLINE double least(Vec a) {
    double smallest = hn::GetLane(hn::MinOfLanes(tag, a.raw[0]));
    for (int k = 1; k < unroll_factor; ++k) {
        const double other = hn::GetLane(hn::MinOfLanes(tag, a.raw[k]));
        if (other < smallest) smallest = other;
    }
    return smallest;
}

HWY_INLINE double greatest(Vec a) {
    return -least(-a);
}

/// The greatest lane of a running maximum, in which numbers hide what is none; `witness`, a sum over the same
/// elements, cannot hide it.
HWY_INLINE double nan_greatest(Vec most, double witness) {
    return greatest(most) + 0.0 * witness;
}

/// Each lane gets the next one's number, the last 0.
HWY_INLINE Vec one_down(Vec a) {
    constexpr int last = lanes_of_register - 1;
    alignas(64) std::int64_t from[lanes_of_register];
    for (int i = 0; i <= last; ++i)
        from[i] = i < last ? i + 1 : 0;
    const auto order = hn::SetTableIndices(tag, from);
    Vec turned, result;
    for (int k = 0; k < unroll_factor; ++k)
        turned.raw[k] = hn::TableLookupLanes(a.raw[k], order);
    for (int k = 0; k < unroll_factor; ++k)
        result.raw[k] =
            hn::IfThenElse(hn::FirstN(tag, last), turned.raw[k],
                           k + 1 < unroll_factor ? turned.raw[(k + 1) % unroll_factor] : hn::Zero(tag));
    return result;
}
/// Each lane gets the number of the one before, the first 0.
HWY_INLINE Vec one_up(Vec a) {
    constexpr int last = lanes_of_register - 1;
    alignas(64) std::int64_t from[lanes_of_register];
    for (int i = 0; i <= last; ++i)
        from[i] = i > 0 ? i - 1 : last;
    const auto order = hn::SetTableIndices(tag, from);
    Vec turned, result;
    for (int k = 0; k < unroll_factor; ++k)
        turned.raw[k] = hn::TableLookupLanes(a.raw[k], order);
    for (int k = 0; k < unroll_factor; ++k)
        result.raw[k] = hn::IfThenElse(
            hn::FirstN(tag, 1), k > 0 ? turned.raw[(k + unroll_factor - 1) % unroll_factor] : hn::Zero(tag),
            turned.raw[k]);
    return result;
}

struct Vec3s {
    Vec x, y, z;
};
HWY_INLINE Vec3s operator+(Vec3s a, Vec3s b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Vec3s operator-(Vec3s a, Vec3s b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Vec3s operator*(Vec s, Vec3s a) {
    return {s * a.x, s * a.y, s * a.z};
}
HWY_INLINE Vec3s operator*(double s, Vec3s a) {
    return all(s) * a;
}
HWY_INLINE Vec3s one_down(Vec3s a) {
    return {one_down(a.x), one_down(a.y), one_down(a.z)};
}
HWY_INLINE Vec3s one_up(Vec3s a) {
    return {one_up(a.x), one_up(a.y), one_up(a.z)};
}
HWY_INLINE Vec dot(Vec3s a, Vec3s b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Power of a force at a velocity, as that of Lanes.
HWY_INLINE Vec work(Vec3s force, Vec3s velocity) {
    return dot(force, velocity);
}
HWY_INLINE Vec3s cross(Vec3s a, Vec3s b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE void operator+=(Vec3s& a, Vec3s b) {
    a = a + b;
}

HWY_INLINE Vec load(const double* from) {
    TWINCHUTE_EACH(Vec, hn::Load(tag, from + k * lanes_of_register));
}
HWY_INLINE Vec load_anywhere(const double* from) {
    TWINCHUTE_EACH(Vec, hn::LoadU(tag, from + k * lanes_of_register));
}
HWY_INLINE void store(Vec a, double* to) {
    for (int k = 0; k < unroll_factor; ++k)
        hn::Store(a.raw[k], tag, to + k * lanes_of_register);
}
HWY_INLINE Vec3s load3(const double* from) {
    return {load(from), load(from + lanes_of_all), load(from + 2 * lanes_of_all)};
}
HWY_INLINE void store3(Vec3s a, double* to) {
    store(a.x, to);
    store(a.y, to + lanes_of_all);
    store(a.z, to + 2 * lanes_of_all);
}
HWY_INLINE void scatter_add(Vec3s a, double* to) {
    store3(load3(to) + a, to);
}
HWY_INLINE void scatter_subtract(Vec3s a, double* from) {
    store3(load3(from) - a, from);
}

#undef TWINCHUTE_EACH

/// Common part of the views of elements side by side (see fullsim/elements/membrane.hpp).
struct SimdView {
    using T = Vec;
    using T3 = Vec3s;

    static HWY_INLINE Vec all(double a) { return HWY_NAMESPACE::all(a); }
    static HWY_INLINE Vec3s all3(const std::array<double, 3>& a) { return {all(a[0]), all(a[1]), all(a[2])}; }
};
}  // namespace TWINCHUTE_WAYS
#undef TWINCHUTE_WAYS

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
