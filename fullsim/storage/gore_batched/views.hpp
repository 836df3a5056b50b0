// Views of the gore-batched layout: elements of gores, block by block, for the loops of fullsim/elements/.
// Included once for every instruction set, by kernels.cpp (see fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_GORE_BATCHED_VIEWS) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_GORE_BATCHED_VIEWS
#undef TWINCHUTE_GORE_BATCHED_VIEWS
#else
#define TWINCHUTE_GORE_BATCHED_VIEWS
#endif

#include <array>
#include <cstdint>
#include <span>

#include "fullsim/laws/membrane.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/simd/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

/// One block's nodes.
struct Block {
    double *x, *v, *v_half, *force, *aero, *push;
    double *pull, *skirt_aero;
    Vec live;
    std::size_t stride, half_stride;

    HWY_INLINE Block(const GoreFrame& f, int block) {
        const std::size_t at = f.at(block, 0);
        x = f.x + at, v = f.v + at, v_half = f.v_half + f.half_at(block, 0);
        force = f.force + at, aero = f.aero + at, push = f.push + at;
        pull = f.pull + static_cast<std::size_t>(block) * 3 * f.lanes;
        skirt_aero = f.skirt_aero + static_cast<std::size_t>(block) * f.skirt_stride;
        live = load(f.live + static_cast<std::size_t>(block) * f.lanes);
        stride = f.stride();
        half_stride = f.half_stride();
    }
    HWY_INLINE Vec3s position(std::int32_t node) const { return load3(x + node * stride); }
    HWY_INLINE Vec3s velocity(std::int32_t node) const { return load3(v + node * stride); }
};

/// A view of elements of a kind, the same in every gore. Element: made of a part and a number, from Row, the
/// constants, and a Context of its own.
template <class Element>
class GoreView : public SimdView {
public:
    using Flow = Vec3s;
    using Row = typename Element::Row;
    using Context = typename Element::Context;
    static constexpr bool skips = true;

    GoreView(const GoreFrame& frame, std::span<const Row> rows, Context context = {})
        : frame_(frame), rows_(rows), context_(context) {}

    HWY_INLINE int first() const { return frame_.first; }
    HWY_INLINE int last() const { return frame_.last; }
    HWY_INLINE Flow flow(const std::array<double, 3>& direction) const { return all3(direction); }

    struct Part {
        Block block;
        std::span<const Row> rows;
        const Context& context;
        int number;  // of the block

        HWY_INLINE std::size_t size() const { return rows.size(); }
        HWY_INLINE Element element(std::size_t k) const { return Element(*this, rows[k], k); }
        HWY_INLINE Vec live(Vec sum) const { return block.live * sum; }
        /// Where there is no gore, nothing is loaded, whatever is there.
        HWY_INLINE Vec live_load(Vec load) const { return select(block.live > all(0.0), load, all(0.0)); }
        HWY_INLINE void finish(std::size_t) const {}
        HWY_INLINE void close() const {}
    };
    HWY_INLINE Part part(int block) const { return {Block(frame_, block), rows_, context_, block}; }

private:
    const GoreFrame& frame_;
    std::span<const Row> rows_;
    Context context_;
};

struct Nothing {};

/// Adds stiffness and damping to the row sums of a node of the frame's.
struct RowSumsContext {
    const GoreFrame* frame = nullptr;
    const GoreFrame* rows = nullptr;

    HWY_INLINE void add(int block, std::int32_t node, Vec stiffness, Vec damping) const {
        double* at = rows->x + rows->at(block, node < rows->own ? node : node - frame->own + rows->own);
        store(load(at) + stiffness, at);
        store(load(at + rows->lanes) + damping, at + rows->lanes);
    }
};

template <int corners>
class GoreElement {
public:
    HWY_INLINE GoreElement(const Block& block, const std::array<std::int32_t, corners>& node)
        : block_(block) {
        for (int c = 0; c < corners; ++c)
            at_[c] = node[c] * block.stride;
    }
    HWY_INLINE Vec live(Vec a, double otherwise) const {
        return select(block_.live > all(0.0), a, all(otherwise));
    }
    HWY_INLINE void add_force(int corner, Vec3s force) const {
        scatter_add(force, block_.force + at_[corner]);
    }
    HWY_INLINE void subtract_force(int corner, Vec3s force) const {
        scatter_subtract(force, block_.force + at_[corner]);
    }

protected:
    HWY_INLINE Vec3s x(int corner) const { return load3(block_.x + at_[corner]); }
    HWY_INLINE Vec3s v(int corner) const { return load3(block_.v + at_[corner]); }

    const Block& block_;
    std::size_t at_[corners];
};

template <class OfRows>
class GoreTriangleElement : public GoreElement<3> {
public:
    using Row = MembraneElement;
    using Context = OfRows;

    template <class Part>
    HWY_INLINE GoreTriangleElement(const Part& part, const Row& row, std::size_t)
        : GoreElement(part.block, row.node), row_(row) {}

    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2) const {
        const Vec3s x0 = x(0);
        e1 = x(1) - x0, e2 = x(2) - x0;
    }
    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2, Vec3s& w1, Vec3s& w2) const {
        edges(e1, e2);
        const Vec3s v0 = v(0);
        w1 = v(1) - v0, w2 = v(2) - v0;
    }
    HWY_INLINE void edges_and_mean_velocity(Vec3s& e1, Vec3s& e2, Vec3s& mean) const {
        edges(e1, e2);
        mean = (1.0 / 3.0) * (v(0) + v(1) + v(2));
    }
    HWY_INLINE Vec3s first_velocity() const { return v(0); }
    HWY_INLINE Vec inverse_a() const { return all(row_.inverse_a); }
    HWY_INLINE Vec inverse_c() const { return all(row_.inverse_c); }
    HWY_INLINE Vec b_over_a() const { return all(row_.b_over_a); }
    HWY_INLINE Vec weighted_area(double weight) const { return all(weight * row_.area); }
    HWY_INLINE Vec viscosity() const { return all(row_.viscosity); }
    HWY_INLINE double half() const { return 0.5; }
    HWY_INLINE void pull(Vec3s first, Vec3s second, Vec3s third) const {
        add_force(0, first);
        subtract_force(1, second);
        subtract_force(2, third);
    }
    HWY_INLINE void add_push(Vec3s area) const { add_to_all(area, block_.push); }
    HWY_INLINE void add_drag(Vec3s force) const { add_to_all(force, block_.aero); }

protected:
    HWY_INLINE void add_to_all(Vec3s a, double* to) const {
        for (const std::size_t at : at_)
            scatter_add(a, to + at);
    }

    const Row& row_;
};
using GoreTriangleForces = GoreTriangleElement<Nothing>;

struct TriangleRowsContext : RowSumsContext {
    std::span<const WeighedRows> unstrained = {};
    double weight = 1.0;
};

class GoreTriangleRows : public GoreTriangleElement<TriangleRowsContext> {
public:
    template <class Part>
    HWY_INLINE GoreTriangleRows(const Part& part, const Row& row, std::size_t k)
        : GoreTriangleElement(part, row, k),
          sums_(part.context),
          unstrained_(part.context.unstrained[k]),
          number_(part.number) {}

    HWY_INLINE void add_rows(MembraneStiffening<Vec> by) const {
        const Vec stiffness = all(sums_.weight) * by.stiffness, damping = all(sums_.weight) * by.damping;
        for (int k = 0; k < 3; ++k)
            sums_.add(number_, row_.node[k], stiffness * all(unstrained_.stiffness[k]),
                      damping * all(unstrained_.damping[k]));
    }

private:
    const TriangleRowsContext& sums_;
    const WeighedRows& unstrained_;
    int number_;
};

/// From one node to another: cables, springs.
template <class OfRow, class OfRows>
class GoreSpanElement : public GoreElement<2> {
public:
    using Row = OfRow;
    using Context = OfRows;

    template <class Part>
    HWY_INLINE GoreSpanElement(const Part& part, const Row& row, std::size_t)
        : GoreElement(part.block, row.node), row_(row) {}

    HWY_INLINE Vec3s distance() const { return x(1) - x(0); }
    HWY_INLINE void ends(Vec3s& d, Vec3s& w) const { d = distance(), w = v(1) - v(0); }
    HWY_INLINE Vec inverse_length() const { return all(row_.inverse_length); }
    HWY_INLINE Vec stiffness() const { return all(row_.stiffness); }
    HWY_INLINE Vec stiffness_times_length() const { return all(row_.stiffness / row_.inverse_length); }
    HWY_INLINE Vec dashpot() const { return all(row_.dashpot); }
    HWY_INLINE Vec hardening() const { return all(row_.hardening); }
    HWY_INLINE Vec fold_force() const { return all(row_.fold_force); }
    HWY_INLINE Vec counted(Vec load) const { return load; }
    HWY_INLINE void pull_together(Vec3s force) const {
        add_force(0, force);
        subtract_force(1, force);
    }

protected:
    const Row& row_;
};
using GoreCableForces = GoreSpanElement<CableElement, Nothing>;
using GoreSpringForces = GoreSpanElement<SpringElement, Nothing>;

struct SpringRowsContext : RowSumsContext {
    std::span<const std::array<double, 2>> columns = {};
};

class GoreSpringRows : public GoreSpanElement<SpringElement, SpringRowsContext> {
public:
    template <class Part>
    HWY_INLINE GoreSpringRows(const Part& part, const Row& row, std::size_t k)
        : GoreSpanElement(part, row, k),
          sums_(part.context),
          columns_(part.context.columns[k]),
          number_(part.number) {}

    HWY_INLINE void add_rows(Vec stiffness, Vec damping) const {
        for (int end = 0; end < 2; ++end)
            sums_.add(number_, row_.node[end], all(columns_[end]) * stiffness, all(columns_[end]) * damping);
    }

private:
    const SpringRowsContext& sums_;
    const std::array<double, 2>& columns_;
    int number_;
};

/// A pair of nodes in contact, the same in every gore.
class GorePair : public GoreElement<2> {
public:
    using Row = ContactElement;
    using Context = Nothing;

    template <class Part>
    HWY_INLINE GorePair(const Part& part, const Row& row, std::size_t)
        : GoreElement(part.block, row.node), row_(row) {}

    HWY_INLINE Vec stiffness() const { return all(row_.stiffness); }
    HWY_INLINE void arm_and_distance(Vec3s centre, Vec3s& arm, Vec3s& d) const {
        const Vec3s x0 = x(0);
        arm = x0 - centre, d = x(1) - x0;
    }
    HWY_INLINE void push_apart(Vec3s apart, Vec3s half_of_middle) const {
        add_force(0, apart - half_of_middle);
        subtract_force(1, apart + half_of_middle);
    }

private:
    const Row& row_;
};

/// State of a line's node while its cables are gone through one after the other: a cable finds one of
/// its nodes in registers, and each node is handed over once.
struct LineNode {
    Vec3s x, v;
    Vec3s pull, aero;  // by elements so far
};

HWY_INLINE LineNode line_node(const Block& block, std::int32_t node) {
    const Vec3s none{all(0.0), all(0.0), all(0.0)};
    return {block.position(node), block.velocity(node), none, none};
}

/// The lines of all gores, as chains. Done: what becomes of a node that all its cables have pulled on.
template <class Done>
class LineView : public SimdView {
public:
    LineView(const GoreFrame& frame, LineElements lines, Done& done)
        : frame_(frame), lines_(lines), done_(done) {}

    HWY_INLINE int first() const { return frame_.first; }
    HWY_INLINE int last() const { return frame_.last; }

    class Part;
    struct Element {
        LineNode &here, &next;
        const CableElement& row;

        HWY_INLINE void ends(Vec3s& d, Vec3s& w) const { d = next.x - here.x, w = next.v - here.v; }
        HWY_INLINE Vec3s mean_velocity(Vec3s) const { return 0.5 * (here.v + next.v); }
        HWY_INLINE Vec inverse_length() const { return all(row.inverse_length); }
        HWY_INLINE Vec stiffness() const { return all(row.stiffness); }
        HWY_INLINE Vec dashpot() const { return all(row.dashpot); }
        HWY_INLINE Vec counted(Vec load) const { return load; }
        HWY_INLINE void pull_together(Vec3s force) const {
            here.pull += force;
            next.pull = next.pull - force;
        }
        HWY_INLINE void add_drag(Vec3s end) const {
            here.aero += end;
            next.aero = end;
        }
    };
    class Part {
    public:
        HWY_INLINE Part(const GoreFrame& frame, int number, LineElements lines, Done& done)
            : block_(frame, number),
              lines_(lines),
              done_(done),
              here_(line_node(block_, lines.front().node[0])) {}

        HWY_INLINE std::size_t size() const { return lines_.size(); }
        HWY_INLINE Element element(std::size_t k) {
            next_ = line_node(block_, lines_[k].node[1]);
            return {here_, next_, lines_[k]};
        }
        HWY_INLINE void finish(std::size_t k) {
            if (k == 0)
                done_.skirt(block_, lines_[k].node[0], here_);
            else
                done_.node(block_, lines_[k].node[0], here_);
            here_ = next_;
        }
        HWY_INLINE void close() { done_.last(block_, lines_.back().node[1], here_); }
        HWY_INLINE Vec live(Vec sum) const { return block_.live * sum; }
        HWY_INLINE Vec live_load(Vec load) const { return select(block_.live > all(0.0), load, all(0.0)); }

    private:
        Block block_;
        LineElements lines_;
        Done& done_;
        LineNode here_, next_;
    };
    HWY_INLINE Part part(int block) const { return Part(frame_, block, lines_, done_); }

private:
    const GoreFrame& frame_;
    LineElements lines_;
    Done& done_;
};

/// Sets what lines do to their nodes.
struct SetOnNodes {
    HWY_INLINE void skirt(const Block& block, std::int32_t, const LineNode& node) const {
        store3(node.pull, block.pull);
        store3(node.aero, block.skirt_aero);
    }
    HWY_INLINE void node(const Block& block, std::int32_t n, const LineNode& node) const {
        store3(node.pull, block.force + n * block.stride);
        store3(node.aero, block.aero + n * block.stride);
    }
    HWY_INLINE void last(const Block& block, std::int32_t n, const LineNode& node_) const {
        node(block, n, node_);
    }
};

}  // namespace
}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
