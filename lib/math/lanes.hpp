// Four doubles at once, by the compiler's vector extension: one arithmetic that compiles for any
// instruction set, and the same bits on each, since nothing is contracted or reassociated.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

/// Before a function with an inner loop over Lanes: compiled twice, for any x86-64 and for machines
/// with AVX2, and the right one is chosen when the program starts. The bits are the same in both.
/// Everything such a function calls has to be inlined to take part. (Not under a sanitizer, which is
/// not yet there when the choice is made.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__)
#define TWINCHUTE_FOR_EACH_CPU __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define TWINCHUTE_FOR_EACH_CPU
#endif

namespace twinchute {

inline constexpr int lane_count = 4;

/// Four elements side by side, or the x, y, z, 0 of one node.
using Lanes = double __attribute__((vector_size(lane_count * sizeof(double))));
/// Mask that a comparison of Lanes yields: all bits set where true.
using LaneMask = std::int64_t __attribute__((vector_size(lane_count * sizeof(std::int64_t))));

/// The instructions that functions marked TWINCHUTE_FOR_EACH_CPU run on here.
std::string_view lane_instruction_set();

inline Lanes splat(double a) {
    return Lanes{a, a, a, a};
}

/// A constant of the other's type: formulas that are templates say so what they compare with.
inline double like(double, double a) {
    return a;
}
inline Lanes like(Lanes, double a) {
    return splat(a);
}

inline double square_root(double a) {
    return std::sqrt(a);
}
inline Lanes square_root(Lanes a) {
    Lanes root;
    for (int k = 0; k < lane_count; ++k)
        root[k] = std::sqrt(a[k]);
    return root;
}

/// 1/sqrt(a), a > 0.
inline double inverse_root(double a) {
    return 1.0 / std::sqrt(a);
}
inline Lanes inverse_root(Lanes a) {
    return 1.0 / square_root(a);
}

/// a where true, else b.
inline double select(bool which, double a, double b) {
    return which ? a : b;
}
inline Lanes select(LaneMask which, Lanes a, Lanes b) {
    return which ? a : b;
}

/// The larger of each pair; b where a is not a number.
inline double larger(double a, double b) {
    return a > b ? a : b;
}
inline Lanes larger(Lanes a, Lanes b) {
    return a > b ? a : b;
}

/// The smaller of each pair; b where a is not a number.
inline double smaller(double a, double b) {
    return a < b ? a : b;
}
inline Lanes smaller(Lanes a, Lanes b) {
    return a < b ? a : b;
}

inline bool any(LaneMask which) {
    return (which[0] | which[1] | which[2] | which[3]) != 0;
}

/// Always in the same order: (0 + 2) + (1 + 3).
inline double sum(Lanes a) {
    return (a[0] + a[2]) + (a[1] + a[3]);
}
inline double greatest(Lanes a) {
    return larger(larger(a[0], a[1]), larger(a[2], a[3]));
}
/// The greatest lane of a running maximum, in which numbers hide what is none; `witness`, a sum over the same
/// elements, cannot hide it.
inline double nan_greatest(Lanes most, double witness) {
    return greatest(most) + 0.0 * witness;
}
inline double sum3(Lanes a) {
    return a[0] + a[1] + a[2];
}

/// Power of a force at a velocity, by component of one node.
inline Lanes work(Lanes force, Lanes velocity) {
    return force * velocity;
}

/// Lanes of the pair a, b by number: 0 to 3 are those of a, 4 to 7 those of b.
template <int... lane>
inline Lanes shuffled(Lanes a, Lanes b) {
#ifdef __clang__
    return __builtin_shufflevector(a, b, lane...);
#else
    return __builtin_shuffle(a, b, LaneMask{lane...});
#endif
}

/// Rows to columns: a, b, c, d hold one node each before, one component each after.
inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    const Lanes ab0 = shuffled<0, 4, 2, 6>(a, b);
    const Lanes ab1 = shuffled<1, 5, 3, 7>(a, b);
    const Lanes cd0 = shuffled<0, 4, 2, 6>(c, d);
    const Lanes cd1 = shuffled<1, 5, 3, 7>(c, d);
    a = shuffled<0, 1, 4, 5>(ab0, cd0);
    b = shuffled<0, 1, 4, 5>(ab1, cd1);
    c = shuffled<2, 3, 6, 7>(ab0, cd0);
    d = shuffled<2, 3, 6, 7>(ab1, cd1);
}

/// Three components of four vectors.
struct Lanes3 {
    Lanes x, y, z;
};

inline Lanes3 operator+(Lanes3 a, Lanes3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Lanes3 operator-(Lanes3 a, Lanes3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes3 operator*(Lanes s, Lanes3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline Lanes3 operator*(double s, Lanes3 a) {
    return splat(s) * a;
}
inline void operator+=(Lanes3& a, Lanes3 b) {
    a = a + b;
}
inline Lanes dot(Lanes3 a, Lanes3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Lanes3 cross(Lanes3 a, Lanes3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace twinchute
