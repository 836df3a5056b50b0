#include "fullsim/forces/self_contact_kernels.hpp"

#include <algorithm>

#include "fullsim/storage/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/forces/self_contact_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// A pair that pushes has more numbers than registers: a second one would go to memory and back.
#define TWINCHUTE_INTERLEAVED 0
#include "fullsim/storage/simd/expected_places.hpp"
#include "fullsim/storage/simd/records.hpp"
#include "fullsim/storage/simd/vec.hpp"

#include "fullsim/laws/node_over_triangle.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

using namespace self_contact;  // NOLINT(google-build-using-namespace): the kernels' own words

using Place = PlaceOverTriangle<Vec, Vec3s>;

/// A bit for each lane.
HWY_INLINE std::uint32_t bits_of(Mask mask) {
    std::uint32_t bits = 0;
    for (int k = 0; k < unroll_factor; ++k) {
        std::uint8_t some[8] = {};
        hn::StoreMaskBits(tag, mask.raw[k], some);
        bits |= (some[0] & ((1U << lanes_of_register) - 1U)) << (k * lanes_of_register);
    }
    return bits;
}
HWY_INLINE Mask operator&(Mask a, Mask b) {
    Mask both;
    for (int k = 0; k < unroll_factor; ++k)
        both.raw[k] = hn::And(a.raw[k], b.raw[k]);
    return both;
}
HWY_INLINE Mask operator|(Mask a, Mask b) {
    Mask either;
    for (int k = 0; k < unroll_factor; ++k)
        either.raw[k] = hn::Or(a.raw[k], b.raw[k]);
    return either;
}
HWY_INLINE Mask operator!(Mask a) {
    Mask other;
    for (int k = 0; k < unroll_factor; ++k)
        other.raw[k] = hn::Not(a.raw[k]);
    return other;
}
HWY_INLINE Vec magnitude(Vec a) {
    return larger(a, -a);
}

class Group {
public:
    HWY_INLINE Group(const double* record, const Pairs& pairs, std::size_t group)
        : record_(record),
          node_(pairs.node + group * 4 * lanes_of_all),
          number_(pairs.number + group * pair_numbers * lanes_of_all) {}

    HWY_INLINE Vec number(PairNumber which) const { return load_anywhere(number_ + which * lanes_of_all); }
    HWY_INLINE FromCorner<Vec3s> places() const {
        return {distance_between(record_, corner(0), corner(1)),
                distance_between(record_, corner(0), corner(2)), distance_between(record_, corner(0), node_)};
    }
    /// Places and velocities.
    HWY_INLINE FromCorner<Motion> motions() const {
        return {between(record_, corner(0), corner(1)), between(record_, corner(0), corner(2)),
                between(record_, corner(0), node_)};
    }
    /// On the node and on the corners, of the lanes in `pushing`.
    HWY_INLINE void add_forces(double* force, const PushOfPair<Vec, Vec3s>& f, std::uint32_t pushing) const {
        add(force, node_, f.on_node, pushing);
        for (int i = 0; i < 3; ++i)
            add(force, corner(i), f.on_corner[i], pushing);
    }

private:
    HWY_INLINE const RowOffset* corner(int i) const { return node_ + (1 + i) * lanes_of_all; }
    static HWY_INLINE void add(double* force, const RowOffset* node, const Vec3s& f, std::uint32_t pushing) {
        for_each_row(f, [=](int lane, Row row) TWINCHUTE_INLINED {
            if (!(pushing >> lane & 1U)) return;
            double* at = row_at(force, node[lane]);
            store_row(load_row(at) + row, at);
        });
    }

    const double* record_;
    const RowOffset* node_;
    const double* number_;
};

HWY_INLINE Vec longest_edge_squared(const FromCorner<Vec3s>& x) {
    const Vec3s across = x.edge2 - x.edge1;
    return larger(larger(dot(x.edge1, x.edge1), dot(x.edge2, x.edge2)), dot(across, across));
}

Pushed push(const double* record, double* force, Pairs pairs, const Law& law, std::uint32_t* attention) {
    const Vec zero = all(0.0);
    Vec dissipated = zero, deepest = zero;
    for (std::size_t g = 0; g < pairs.groups; ++g) {
        const Group group(record, pairs, g);
        const FromCorner<Motion> m = group.motions();
        const FromCorner<Vec3s> x{m.edge1.x, m.edge2.x, m.arm.x}, v{m.edge1.v, m.edge2.v, m.arm.v};
        const Vec longest = longest_edge_squared(x);
        Place at;
        find_place(x, at);
        const Vec side = group.number(kept_side), thickness = group.number(kept_thickness),
                  most = group.number(most_thickness);
        // Over a sliver, which may have no area, nothing below is a number; no comparison holds then.
        const Mask full = at.twice_area > group.number(fullness) * longest, over = at.window > zero;
        const Mask decided = side * side > zero, open = full & over;
        const Vec gap = side * at.gap, overlap = thickness - gap;
        const Mask pushes = open & decided & (overlap > zero);
        const Vec thickest = smaller(most, thickness_now * square_root(longest));
        const Mask apart = magnitude(at.gap) > touching * thickest;
        const Mask grows = (overlap <= zero) & (smaller(thickest, gap) > thickness);
        attention[g] = bits_of((decided & !open) | (open & !decided & apart) | (open & decided & grows));
        if (!any(pushes)) continue;
        const std::uint32_t pushing = bits_of(pushes);
        PushOfPair<Vec, Vec3s> f;
        push_pair(law.stiffness, law.friction, group.number(slow_viscosity), at, side, overlap, v, f);
        dissipated += select(pushes, f.dissipated, zero);
        deepest = larger(select(pushes & (at.window > all(0.5)), -gap / most, zero), deepest);
        group.add_forces(force, f, pushing);
    }
    return {sum(dissipated), greatest(deepest)};
}

void measure(const double* record, Pairs pairs, double* distance, double* gap) {
    const Vec zero = all(0.0);
    for (std::size_t g = 0; g < pairs.groups; ++g) {
        const Group group(record, pairs, g);
        const FromCorner<Vec3s> x = group.places();
        Place at;
        find_place(x, at);
        Vec aside = zero;
        for (int i = 0; i < 3; ++i)
            aside = larger(
                (-half_width_of_window - at.share[i]) * inverse_root(dot(at.gradient[i], at.gradient[i])),
                aside);
        const Mask full = at.twice_area > group.number(fullness) * longest_edge_squared(x);
        const Vec away = square_root(at.gap * at.gap + aside * aside);
        for (int k = 0; k < unroll_factor; ++k) {
            const std::size_t to = g * lanes_of_all + k * lanes_of_register;
            hn::StoreU(hn::IfThenElseZero(full.raw[k], away.raw[k]), tag, distance + to);
            hn::StoreU(hn::IfThenElseZero(full.raw[k], at.gap.raw[k]), tag, gap + to);
        }
    }
}

double farthest(const double* record, const double* before, std::size_t count, std::size_t last,
                const LinearMotion& motion) {
    const ExpectedPlaces expected(motion);
    Vec most = all(0.0), witness = most;
    for (std::size_t i = 0; i < count; i += lanes_of_all) {
        const Vec3s now = vectors_of([=](int lane) TWINCHUTE_INLINED {
            return load_row(record + 8 * std::min(i + static_cast<std::size_t>(lane), last));
        });
        const Vec3s then{load_anywhere(before + i), load_anywhere(before + count + i),
                         load_anywhere(before + 2 * count + i)};
        const Vec3s strayed = load_anywhere(before + 3 * count + i) * (now - expected.of(then));
        const Vec squared = dot(strayed, strayed);
        most = larger(squared, most);
        witness += squared;
    }
    return nan_greatest(most, sum(witness));
}

}  // namespace

self_contact::Kernels self_contact_kernels_here() {
    return {instruction_set_name(HWY_TARGET), lanes_of_all, push, measure, farthest};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twinchute::fullsim::self_contact {

std::span<const Kernels> all_kernels() {
    static const std::vector<Kernels> sets =
        TWINCHUTE_SETS_OF_THIS_MACHINE(Kernels, self_contact_kernels_here);
    return sets;
}

}  // namespace twinchute::fullsim::self_contact
#endif
