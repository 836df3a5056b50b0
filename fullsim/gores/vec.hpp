// As many doubles as the processor of this compilation works on at once, with the operators that formulas
// need. Included once for every instruction set (see membrane_kernel.hpp for the guard).
#if defined(TWINCHUTE_GORES_VEC) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_GORES_VEC
#undef TWINCHUTE_GORES_VEC
#else
#define TWINCHUTE_GORES_VEC
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
inline constexpr Tag tag{};

struct Vec {
    hn::Vec<Tag> raw;
};
struct Mask {
    hn::Mask<Tag> raw;
};

HWY_INLINE Vec all(double a) {
    return {hn::Set(tag, a)};
}
HWY_INLINE Vec operator+(Vec a, Vec b) {
    return {hn::Add(a.raw, b.raw)};
}
HWY_INLINE Vec operator-(Vec a, Vec b) {
    return {hn::Sub(a.raw, b.raw)};
}
HWY_INLINE Vec operator*(Vec a, Vec b) {
    return {hn::Mul(a.raw, b.raw)};
}
HWY_INLINE Vec operator/(Vec a, Vec b) {
    return {hn::Div(a.raw, b.raw)};
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
HWY_INLINE Vec operator-(Vec a) {
    return {hn::Neg(a.raw)};
}
HWY_INLINE void operator+=(Vec& a, Vec b) {
    a = a + b;
}

HWY_INLINE Mask operator>(Vec a, Vec b) {
    return {hn::Gt(a.raw, b.raw)};
}
HWY_INLINE Mask operator<(Vec a, Vec b) {
    return {hn::Lt(a.raw, b.raw)};
}
HWY_INLINE Mask operator<=(Vec a, Vec b) {
    return {hn::Le(a.raw, b.raw)};
}
HWY_INLINE Vec select(Mask which, Vec a, Vec b) {
    return {hn::IfThenElse(which.raw, a.raw, b.raw)};
}
/// Of a pair; on x86 the second where the first is not a number.
HWY_INLINE Vec larger(Vec a, Vec b) {
    return {hn::Max(a.raw, b.raw)};
}

HWY_INLINE Vec smaller(Vec a, Vec b) {
    return {hn::Min(a.raw, b.raw)};
}

/// 1/sqrt(a) to the last bits but one, for normal a > 0. A root and a division take as long as all the rest
/// of a membrane: an estimate and two steps of Newton do not.
HWY_INLINE Vec inverse_root(Vec a) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
    const Vec first{hn::Vec<Tag>{_mm512_rsqrt14_pd(a.raw.raw)}};
    const Vec half = 0.5 * a;
    const Vec second = first * (1.5 - half * (first * first));
    return second * (1.5 - half * (second * second));
#else
    return all(1.0) / Vec{hn::Sqrt(a.raw)};
#endif
}

HWY_INLINE Vec square_root(Vec a) {
    return {hn::Sqrt(a.raw)};
}

HWY_INLINE double sum(Vec a) {
    return hn::GetLane(hn::SumOfLanes(tag, a.raw));
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
HWY_INLINE Vec dot(Vec3s a, Vec3s b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vec3s cross(Vec3s a, Vec3s b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE void operator+=(Vec3s& a, Vec3s b) {
    a = a + b;
}

HWY_INLINE Vec load(const double* from) {
    return {hn::Load(tag, from)};
}
HWY_INLINE Vec load_anywhere(const double* from) {
    return {hn::LoadU(tag, from)};
}
HWY_INLINE void store(Vec a, double* to) {
    hn::Store(a.raw, tag, to);
}
HWY_INLINE Vec3s load3(const double* from) {
    return {load(from), load(from + hn::Lanes(tag)), load(from + 2 * hn::Lanes(tag))};
}
HWY_INLINE void store3(Vec3s a, double* to) {
    store(a.x, to);
    store(a.y, to + hn::Lanes(tag));
    store(a.z, to + 2 * hn::Lanes(tag));
}
HWY_INLINE void add3(Vec3s a, double* to) {
    store3(load3(to) + a, to);
}
HWY_INLINE void take3(Vec3s a, double* from) {
    store3(load3(from) - a, from);
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
