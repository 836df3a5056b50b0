// Between nodes that lie anywhere and elements side by side: records of a node are loaded whole, and rows
// become columns in registers. A gather instruction for each component would take three times as long.
// Included once for every instruction set (see fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_LANES_RECORDS) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LANES_RECORDS
#undef TWINCHUTE_LANES_RECORDS
#else
#define TWINCHUTE_LANES_RECORDS
#endif

#include <cstdint>

#include "fullsim/storage/simd/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

/// After a lambda's parameters: it becomes part of the loop that it stands in.
#undef TWINCHUTE_INLINED
#define TWINCHUTE_INLINED HWY_ATTR __attribute__((always_inline))

// --- a row: x, y, z, 0 of one node ----------------------------------------------------------

using RowTag = hn::CappedTag<double, 4>;
inline constexpr RowTag row_tag{};
inline constexpr int lanes_of_part = HWY_LANES(double) < 4 ? HWY_LANES(double) : 4;
inline constexpr int parts = 4 / lanes_of_part;

struct Row {
    hn::Vec<RowTag> part[parts];
};

#define TWINCHUTE_EACH_PART(expression) \
    Row result;                         \
    for (int p = 0; p < parts; ++p)     \
        result.part[p] = (expression);  \
    return result

HWY_INLINE Row load_row(const double* from) {
    TWINCHUTE_EACH_PART(hn::Load(row_tag, from + p * lanes_of_part));
}
HWY_INLINE void store_row(Row a, double* to) {
    for (int p = 0; p < parts; ++p)
        hn::Store(a.part[p], row_tag, to + p * lanes_of_part);
}
HWY_INLINE Row row_of(double a) {
    TWINCHUTE_EACH_PART(hn::Set(row_tag, a));
}
HWY_INLINE Row operator+(Row a, Row b) {
    TWINCHUTE_EACH_PART(hn::Add(a.part[p], b.part[p]));
}
HWY_INLINE Row operator-(Row a, Row b) {
    TWINCHUTE_EACH_PART(hn::Sub(a.part[p], b.part[p]));
}
HWY_INLINE Row operator*(Row a, Row b) {
    TWINCHUTE_EACH_PART(hn::Mul(a.part[p], b.part[p]));
}
HWY_INLINE Row operator*(double s, Row a) {
    return row_of(s) * a;
}
HWY_INLINE void operator+=(Row& a, Row b) {
    a = a + b;
}

/// As that of Lanes.
HWY_INLINE Row work(Row force, Row velocity) {
    return force * velocity;
}

#undef TWINCHUTE_EACH_PART

// --- a record: the rows of position and velocity of one node ----------------------------------

#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
/// Both rows in one register.
struct Record {
    hn::Vec<Tag> both;
};
HWY_INLINE Record load_record(const double* from) {
    return {hn::Load(tag, from)};
}
HWY_INLINE Record operator-(Record a, Record b) {
    return {hn::Sub(a.both, b.both)};
}
#else
struct Record {
    Row x, v;
};
HWY_INLINE Record load_record(const double* from) {
    return {load_row(from), load_row(from + 4)};
}
HWY_INLINE Record operator-(Record a, Record b) {
    return {a.x - b.x, a.v - b.v};
}
#endif

/// Columns of as many records as a register has lanes.
struct Columns {
    hn::Vec<Tag> x, y, z, u, v, w;
};

#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
static_assert(lanes_of_register == 8);

// Blocks of 16 bytes by number, those of a first; what the instruction calls a shuffle of 128-bit lanes.
template <int first, int second, int third, int fourth>
HWY_INLINE hn::Vec<Tag> blocks(hn::Vec<Tag> a, hn::Vec<Tag> b) {
    return hn::Vec<Tag>{_mm512_shuffle_f64x2(a.raw, b.raw, first | second << 2 | third << 4 | fourth << 6)};
}

HWY_INLINE Columns columns_of(const Record (&r)[8]) {
    // [x x | z z | u u | w w] of two nodes each, and the same of [y y | ...].
    hn::Vec<Tag> even[4], odd[4];
    for (int k = 0; k < 4; ++k) {
        even[k] = hn::InterleaveLower(tag, r[2 * k].both, r[2 * k + 1].both);
        odd[k] = hn::InterleaveUpper(tag, r[2 * k].both, r[2 * k + 1].both);
    }
    // [x u x u] and [z w z w] of four nodes, by twos.
    const auto xu0 = blocks<0, 2, 0, 2>(even[0], even[1]), xu1 = blocks<0, 2, 0, 2>(even[2], even[3]);
    const auto zw0 = blocks<1, 3, 1, 3>(even[0], even[1]), zw1 = blocks<1, 3, 1, 3>(even[2], even[3]);
    const auto yv0 = blocks<0, 2, 0, 2>(odd[0], odd[1]), yv1 = blocks<0, 2, 0, 2>(odd[2], odd[3]);
    return {blocks<0, 2, 0, 2>(xu0, xu1), blocks<0, 2, 0, 2>(yv0, yv1), blocks<0, 2, 0, 2>(zw0, zw1),
            blocks<1, 3, 1, 3>(xu0, xu1), blocks<1, 3, 1, 3>(yv0, yv1), blocks<1, 3, 1, 3>(zw0, zw1)};
}

HWY_INLINE void columns_of_rows(const Row (&r)[8], hn::Vec<Tag>& x, hn::Vec<Tag>& y, hn::Vec<Tag>& z) {
    // Rows k and k + 4 in one register.
    __m512d two[4];
    for (int k = 0; k < 4; ++k)
        two[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(r[k].part[0].raw), r[k + 4].part[0].raw, 1);
    // [x x | z z] of nodes 0 and 1, of 4 and 5; those of the next ones; and [y y | ...].
    const __m512d even0 = _mm512_unpacklo_pd(two[0], two[1]), even1 = _mm512_unpacklo_pd(two[2], two[3]);
    const __m512d odd0 = _mm512_unpackhi_pd(two[0], two[1]), odd1 = _mm512_unpackhi_pd(two[2], two[3]);
    const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    const __m512i second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    x = hn::Vec<Tag>{_mm512_permutex2var_pd(even0, first, even1)};
    y = hn::Vec<Tag>{_mm512_permutex2var_pd(odd0, first, odd1)};
    z = hn::Vec<Tag>{_mm512_permutex2var_pd(even0, second, even1)};
}

/// x, y, z, 0 of each lane.
HWY_INLINE void rows_of(hn::Vec<Tag> x, hn::Vec<Tag> y, hn::Vec<Tag> z, Row (&row)[8]) {
    const __m512d even = _mm512_unpacklo_pd(x.raw, y.raw), odd = _mm512_unpackhi_pd(x.raw, y.raw);
    // Rows k and k + 2 in one register: 0 to 7 are of the pairs x, y, 8 to 15 of z; the last of each is zero.
    const auto two_rows = [&z](__m512d pairs, int first_pair, int first_z) {
        const __m512i from = _mm512_setr_epi64(first_pair, first_pair + 1, first_z, 0, first_pair + 2,
                                               first_pair + 3, first_z + 2, 0);
        return _mm512_maskz_permutex2var_pd(0x77, pairs, from, z.raw);
    };
    const __m512d r02 = two_rows(even, 0, 8), r46 = two_rows(even, 4, 12);
    const __m512d r13 = two_rows(odd, 0, 9), r57 = two_rows(odd, 4, 13);
    const __m512d of[4] = {r02, r13, r46, r57};
    for (int k = 0; k < 2; ++k)
        for (int m = 0; m < 2; ++m) {
            row[4 * k + m].part[0] = hn::Vec<RowTag>{_mm512_castpd512_pd256(of[2 * k + m])};
            row[4 * k + 2 + m].part[0] = hn::Vec<RowTag>{_mm512_extractf64x4_pd(of[2 * k + m], 1)};
        }
}
#else
#if HWY_TARGET == HWY_AVX2
HWY_INLINE void columns_of_rows(const Row (&r)[4], hn::Vec<Tag>& x, hn::Vec<Tag>& y, hn::Vec<Tag>& z) {
    // [x x | z z] of two nodes each, and [y y | ...].
    const auto even0 = hn::InterleaveLower(tag, r[0].part[0], r[1].part[0]);
    const auto even1 = hn::InterleaveLower(tag, r[2].part[0], r[3].part[0]);
    const auto odd0 = hn::InterleaveUpper(tag, r[0].part[0], r[1].part[0]);
    const auto odd1 = hn::InterleaveUpper(tag, r[2].part[0], r[3].part[0]);
    x = hn::ConcatLowerLower(tag, even1, even0);
    y = hn::ConcatLowerLower(tag, odd1, odd0);
    z = hn::ConcatUpperUpper(tag, even1, even0);
}
HWY_INLINE Columns columns_of(const Record (&r)[4]) {
    Columns columns;
    columns_of_rows({r[0].x, r[1].x, r[2].x, r[3].x}, columns.x, columns.y, columns.z);
    columns_of_rows({r[0].v, r[1].v, r[2].v, r[3].v}, columns.u, columns.v, columns.w);
    return columns;
}

/// x, y, z, 0 of each lane.
HWY_INLINE void rows_of(hn::Vec<Tag> x, hn::Vec<Tag> y, hn::Vec<Tag> z, Row (&row)[4]) {
    const auto zero = hn::Zero(tag);
    const auto even = hn::InterleaveLower(tag, x, y), even_z = hn::InterleaveLower(tag, z, zero);
    const auto odd = hn::InterleaveUpper(tag, x, y), odd_z = hn::InterleaveUpper(tag, z, zero);
    row[0].part[0] = hn::ConcatLowerLower(tag, even_z, even);
    row[1].part[0] = hn::ConcatLowerLower(tag, odd_z, odd);
    row[2].part[0] = hn::ConcatUpperUpper(tag, even_z, even);
    row[3].part[0] = hn::ConcatUpperUpper(tag, odd_z, odd);
}
#elif HWY_TARGET == HWY_SCALAR
HWY_INLINE void columns_of_rows(const Row (&r)[1], hn::Vec<Tag>& x, hn::Vec<Tag>& y, hn::Vec<Tag>& z) {
    x = r[0].part[0], y = r[0].part[1], z = r[0].part[2];
}
HWY_INLINE Columns columns_of(const Record (&r)[1]) {
    const Row &x = r[0].x, &v = r[0].v;
    return {x.part[0], x.part[1], x.part[2], v.part[0], v.part[1], v.part[2]};
}
HWY_INLINE void rows_of(hn::Vec<Tag> x, hn::Vec<Tag> y, hn::Vec<Tag> z, Row (&row)[1]) {
    row[0] = {{x, y, z, hn::Zero(tag)}};
}
#else
static_assert(lanes_of_register == 2);

HWY_INLINE void columns_of_rows(const Row (&r)[2], hn::Vec<Tag>& x, hn::Vec<Tag>& y, hn::Vec<Tag>& z) {
    x = hn::InterleaveLower(tag, r[0].part[0], r[1].part[0]);
    y = hn::InterleaveUpper(tag, r[0].part[0], r[1].part[0]);
    z = hn::InterleaveLower(tag, r[0].part[1], r[1].part[1]);
}
HWY_INLINE Columns columns_of(const Record (&r)[2]) {
    Columns columns;
    columns_of_rows({r[0].x, r[1].x}, columns.x, columns.y, columns.z);
    columns_of_rows({r[0].v, r[1].v}, columns.u, columns.v, columns.w);
    return columns;
}

/// x, y, z, 0 of each lane.
HWY_INLINE void rows_of(hn::Vec<Tag> x, hn::Vec<Tag> y, hn::Vec<Tag> z, Row (&row)[2]) {
    const auto zero = hn::Zero(tag);
    row[0].part[0] = hn::InterleaveLower(tag, x, y), row[0].part[1] = hn::InterleaveLower(tag, z, zero);
    row[1].part[0] = hn::InterleaveUpper(tag, x, y), row[1].part[1] = hn::InterleaveUpper(tag, z, zero);
}
#endif
#endif

// --- elements side by side ---------------------------------------------------------------------

/// Position and velocity, or what is made of two nodes'.
struct Motion {
    Vec3s x, v;
};

/// The compiler keeps in registers what no loop over registers indexes.
HWY_INLINE Vec joined(hn::Vec<Tag> first, hn::Vec<Tag> last) {
    Vec both;
    both.raw[0] = first;
    if constexpr (unroll_factor > 1) both.raw[unroll_factor - 1] = last;
    return both;
}

template <int first_lane, class RecordOf>
HWY_INLINE Columns columns_from(RecordOf&& record_of) {
    Record records[lanes_of_register];
    for (int lane = 0; lane < lanes_of_register; ++lane)
        records[lane] = record_of(first_lane + lane);
    return columns_of(records);
}

/// record_of(lane) for each lane, as columns.
template <class RecordOf>
HWY_INLINE Motion motion_of(RecordOf&& record_of) {
    static_assert(unroll_factor <= 2);
    const Columns a = columns_from<0>(record_of);
    const Columns b =
        unroll_factor > 1 ? columns_from<(unroll_factor - 1) * lanes_of_register>(record_of) : a;
    return {{joined(a.x, b.x), joined(a.y, b.y), joined(a.z, b.z)},
            {joined(a.u, b.u), joined(a.v, b.v), joined(a.w, b.w)}};
}

/// row_of(lane) for each lane, likewise.
template <class RowOf>
HWY_INLINE Vec3s vectors_of(RowOf&& row_of) {
    Vec3s all;
    for (int k = 0; k < unroll_factor; ++k) {
        Row rows[lanes_of_register];
        for (int lane = 0; lane < lanes_of_register; ++lane)
            rows[lane] = row_of(k * lanes_of_register + lane);
        columns_of_rows(rows, all.x.raw[k], all.y.raw[k], all.z.raw[k]);
    }
    return all;
}

/// Where a node's row begins [B], of 4 doubles; its record of 8 begins at twice that. Both are addressed
/// without arithmetic.
using RowOffset = std::int32_t;

HWY_INLINE Record record_of(const double* nodes, RowOffset node) {
    return load_record(reinterpret_cast<const double*>(reinterpret_cast<const char*>(nodes) +
                                                       static_cast<std::ptrdiff_t>(node) * 2));
}
/// Its halves.
HWY_INLINE Row position_of(const double* nodes, RowOffset node) {
    return load_row(reinterpret_cast<const double*>(reinterpret_cast<const char*>(nodes) +
                                                    static_cast<std::ptrdiff_t>(node) * 2));
}
HWY_INLINE Row velocity_of(const double* nodes, RowOffset node) {
    return position_of(nodes + 4, node);
}
HWY_INLINE double* row_at(double* rows, RowOffset node) {
    return reinterpret_cast<double*>(reinterpret_cast<char*>(rows) + node);
}

/// Motion of the second node of each lane relative to the first.
HWY_INLINE Motion between(const double* nodes, const RowOffset* first, const RowOffset* second) {
    return motion_of(
        [=](int lane) { return record_of(nodes, second[lane]) - record_of(nodes, first[lane]); });
}

/// Position of the second node of each lane relative to the first.
HWY_INLINE Vec3s distance_between(const double* nodes, const RowOffset* first, const RowOffset* second) {
    return vectors_of(
        [=](int lane) { return position_of(nodes, second[lane]) - position_of(nodes, first[lane]); });
}

/// each(lane, x y z 0) for each lane of a vector in turn.
template <class Each>
HWY_INLINE void for_each_row(Vec3s a, Each&& each) {
    Row rows[lanes_of_register];
    rows_of(a.x.raw[0], a.y.raw[0], a.z.raw[0], rows);
    for (int lane = 0; lane < lanes_of_register; ++lane)
        each(lane, rows[lane]);
    if constexpr (unroll_factor > 1) {
        constexpr int last = unroll_factor - 1;
        rows_of(a.x.raw[last], a.y.raw[last], a.z.raw[last], rows);
        for (int lane = 0; lane < lanes_of_register; ++lane)
            each(last * lanes_of_register + lane, rows[lane]);
    }
}

/// One element after the other: two of them may meet at a node.
HWY_INLINE void scatter_add(Vec3s a, double* rows, const RowOffset* node) {
    for_each_row(a, [=](int lane, Row row) TWINCHUTE_INLINED {
        double* at = row_at(rows, node[lane]);
        store_row(load_row(at) + row, at);
    });
}
HWY_INLINE void scatter_subtract(Vec3s a, double* rows, const RowOffset* node) {
    for_each_row(a, [=](int lane, Row row) TWINCHUTE_INLINED {
        double* at = row_at(rows, node[lane]);
        store_row(load_row(at) - row, at);
    });
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
