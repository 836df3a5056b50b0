#include "fullsim/storage/gore_batched/kernels.hpp"

#include <cmath>

#include "fullsim/storage/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/storage/gore_batched/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/storage/simd/drag_table.hpp"
#include "fullsim/storage/simd/vec.hpp"

#include "fullsim/elements/cable.hpp"
#include "fullsim/elements/contact.hpp"
#include "fullsim/elements/fabric_spring.hpp"
#include "fullsim/elements/membrane.hpp"
#include "fullsim/laws/critical_step.hpp"
#include "fullsim/laws/node.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

HWY_INLINE std::array<double, 3> sum3s(Vec3s a) {
    return {sum(a.x), sum(a.y), sum(a.z)};
}

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

// --- views: elements of gores, block by block (see fullsim/elements/membrane.hpp) -----------------

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

// --- loops -------------------------------------------------------------------------------------------

using Membranes = GoreView<GoreTriangleForces>;
using Cables = GoreView<GoreCableForces>;
using Springs = GoreView<GoreSpringForces>;
using Pairs = GoreView<GorePair>;

template <bool structure, AirOnFabric air>
ElementSums membranes(const GoreFrame& frame, std::span<const MembraneElement> elements,
                      const MembranePass& pass) {
    return membrane_forces<structure, air>(Membranes(frame, elements), pass);
}
EnergyAndStrain levels_of_membranes(const GoreFrame& frame, std::span<const MembraneElement> elements,
                                    const MembranePass& pass) {
    return membrane_levels(Membranes(frame, elements), pass);
}
void rows_of_membranes(const GoreFrame& frame, std::span<const MembraneElement> elements,
                       std::span<const WeighedRows> unstrained, double weight, const GoreFrame& rows) {
    membrane_rows(GoreView<GoreTriangleRows>(frame, elements, {{&frame, &rows}, unstrained, weight}));
}
ElementSums fabric_drags(const GoreFrame& frame, std::span<const MembraneElement> elements,
                         const FabricDragPass& pass) {
    return fabric_drag_forces(Membranes(frame, elements), pass);
}

ElementSums springs(const GoreFrame& frame, std::span<const SpringElement> elements, const SpringPass& pass) {
    return spring_forces(Springs(frame, elements), pass);
}
EnergyAndStrain levels_of_springs(const GoreFrame& frame, std::span<const SpringElement> elements,
                                  const SpringPass& pass) {
    return spring_levels(Springs(frame, elements), pass);
}
void rows_of_springs(const GoreFrame& frame, std::span<const SpringElement> elements, const SpringPass& pass,
                     std::span<const std::array<double, 2>> columns, const GoreFrame& rows) {
    spring_rows(GoreView<GoreSpringRows>(frame, elements, {{&frame, &rows}, columns}), pass);
}

ElementSums cables(const GoreFrame& frame, std::span<const CableElement> elements) {
    return cable_forces(Cables(frame, elements));
}
EnergyAndStrain levels_of_cables(const GoreFrame& frame, std::span<const CableElement> elements) {
    return cable_levels(Cables(frame, elements));
}

template <bool pulls, bool drags>
ElementSums lines(const GoreFrame& frame, LineElements elements, const LineAir& air) {
    SetOnNodes set;
    const LineView view(frame, elements, set);
    if constexpr (drags)
        return cable_forces_in<pulls>(view, air);
    else
        return cable_forces(view);
}

ElementSums contacts(const GoreFrame& frame, std::span<const ContactElement> pairs, const ContactPass& pass) {
    return contact_forces(Pairs(frame, pairs), pass);
}
EnergyAndStrain levels_of_contacts(const GoreFrame& frame, std::span<const ContactElement> pairs,
                                   const ContactPass& pass) {
    return contact_levels(Pairs(frame, pairs), pass);
}

double critical_step(const GoreFrame& rows, std::span<const double> inverse_inertia,
                     std::span<const double> node_damping, int first, int last) {
    Vec shortest = all(HUGE_VAL);
    for (int b = rows.first; b < rows.last; ++b) {
        // A lane without a gore has no stiffness here, hence no say.
        const Vec live = load(rows.live + static_cast<std::size_t>(b) * rows.lanes);
        for (int n = first; n < last; ++n) {
            const double* at = rows.x + rows.at(b, n);
            const Vec inverse = all(inverse_inertia[n]) * live;
            const Vec k = load(at) * inverse;
            const Vec c = (load(at + rows.lanes) + all(node_damping[n])) * inverse;
            // In this order: a node without a number must not hide what the others say.
            shortest = smaller(critical_step(k, c, all(1.0)), shortest);
        }
    }
    return least(shortest);
}

double kinetic_energy(const GoreFrame& frame, std::span<const GoreNode> nodes, double added_mass) {
    Vec twice = all(0.0);
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_twice = all(0.0);
        for (int n = 0; n < frame.own; ++n) {
            const Vec3s v = block.velocity(n);
            block_twice += all(nodes[n].mass + nodes[n].share * added_mass) * dot(v, v);
        }
        twice += block.live * block_twice;
    }
    return 0.5 * sum(twice);
}

/// The last lane of a block that has a gore, and the block in which the next gore is.
HWY_INLINE int last_lane(const GoreFrame& frame, int block) {
    const int left = frame.gores - block * frame.lanes;
    return (left < frame.lanes ? left : frame.lanes) - 1;
}

void scatter_add_halo(const GoreFrame& rows, std::span<const std::int32_t> neighbour) {
    for (int b = rows.first; b < rows.last; ++b) {
        const int before = b > 0 ? b - 1 : rows.blocks - 1, last_before = last_lane(rows, before);
        for (std::size_t k = 0; k < neighbour.size(); ++k) {
            double* own = rows.x + rows.at(b, neighbour[k]);
            const int halo_node = rows.own + static_cast<int>(k);
            const double* halo = rows.x + rows.at(b, halo_node);
            const double* halo_before = rows.x + rows.at(before, halo_node);
            for (int c = 0; c < 2; ++c, own += rows.lanes, halo += rows.lanes, halo_before += rows.lanes) {
                store(load(own) + one_up(load(halo)), own);
                own[0] += halo_before[last_before];
            }
        }
    }
}

/// Sums of a step over nodes of a kind, lane by lane.
struct LaneSums {
    Vec3s position, velocity, area_velocity;
    Vec drag_power, momentum, share_square, dissipated, accretion_power, external_power;
    Vec kinetic;  // twice
};

/// Role of nodes on lines in a step: they move with it, or receive its impulse alone.
enum class Pulled { none, together, apart };

/// Forces that the gore before has added to a halo node, which is cleared.
HWY_INLINE Vec3s taken_from_halo(double* halo) {
    const Vec3s added = one_up(load3(halo));
    store3({all(0.0), all(0.0), all(0.0)}, halo);
    return added;
}

/// A node as the gore before sees it.
HWY_INLINE void show(const Block& block, std::int32_t halo, Vec3s x, Vec3s v) {
    const std::size_t there = halo * block.stride;
    store3(one_down(x), block.x + there);
    store3(one_down(v), block.v + there);
}

/// Nodes from first to last of a block. Templates, so that what a stage has not costs nothing in the loop.
template <bool canopy, bool with_aero, Pulled pulled>
HWY_INLINE void move_nodes(const Block& block, const GoreAdvance& step, int first, int last, LaneSums& sums) {
    const Vec zero = all(0.0), half = all(0.5), live = block.live;
    const Vec3s none{zero, zero, zero};
    // A lane without a gore stays where it is.
    const Vec kick = all(step.kick) * live, dt = all(step.dt) * live, half_dt = all(0.5 * step.dt) * live;
    const Vec pressure = all(step.pressure), gravity = all(step.gravity);
    const Vec3s residual_drag = SimdView::all3(step.residual_drag);
    for (int n = first; n < last; ++n) {
        const GoreNode& node = step.nodes[n];
        const std::size_t at = n * block.stride;
        const Vec mass = all(node.mass) * live, share = all(node.share) * live;
        constexpr bool on_line = !canopy;  // what acts there is set, not added to
        double* const aero_at = canopy && pulled != Pulled::none ? block.skirt_aero : block.aero + at;
        Vec3s aero = none, force = load3(block.force + at);
        if constexpr (with_aero) aero = load3(aero_at);
        if constexpr (canopy) {
            store3(none, block.force + at);
            if constexpr (with_aero) store3(none, aero_at);
            const std::int32_t halo = step.halo[n];
            if (step.pushed) {
                Vec3s push = load3(block.push + at);
                store3(none, block.push + at);
                if (halo >= 0) push += taken_from_halo(block.push + halo * block.stride);
                aero += pressure * push + share * residual_drag;
            }
            if (halo >= 0) {
                force += taken_from_halo(block.force + halo * block.stride);
                if (with_aero && step.halo_aero) aero += taken_from_halo(block.aero + halo * block.stride);
            }
            if (step.breathing > 0.0) {
                resist(share * all(step.breathing), load3(block.v + at) - SimdView::all3(step.breathing_mean),
                       force, sums.dissipated);
            }
            if (step.accretion > 0.0) {
                accrete(share * all(step.accretion), SimdView::all3(step.wind), load3(block.v + at), force,
                        sums.accretion_power);
            }
            if (node.extraction > 0.0) {
                const Vec3s pull = (live * all(node.extraction)) * SimdView::all3(step.extraction);
                force += pull;
                sums.external_power += dot(pull, load3(block.v + at));
            }
        }
        Vec3s pull = none;
        if constexpr (pulled != Pulled::none) pull = on_line ? force : load3(block.pull);
        if constexpr (pulled == Pulled::together && !on_line) force += pull;
        if constexpr (pulled == Pulled::apart && on_line) force = none;
        if (step.alpha > 0.0) {
            resist(all(step.alpha) * mass, load3(block.v + at) - SimdView::all3(step.mean), force,
                   sums.dissipated);
        }
        Vec3s total = force + aero;
        total.z = total.z - mass * gravity;
        if (canopy && step.has_contact_reaction) total += mass * SimdView::all3(step.contact_reaction);
        const Vec3s acceleration = all(step.inverse_inertia[n]) * total;
        const Vec3s before = load3(block.v_half + n * block.half_stride);
        const Vec3s after = kicked(before, acceleration, kick);
        Vec3s middle = middle_of(before, after);
        if constexpr (pulled == Pulled::apart)
            middle += (half * all(step.first_kick) * all(step.inverse_inertia[n])) * pull;
        sums.momentum += mass * middle.z;
        if (step.weighs) {
            Vec3s change = all(step.last_dt) * acceleration;
            if constexpr (pulled == Pulled::apart)
                change += all(step.last_line_dt * step.inverse_inertia[n]) * pull;
            Vec3s booked = aero;
            booked.z = booked.z - mass * gravity;
            sums.kinetic += twice_kinetic(live * all(1.0 / step.inverse_inertia[n]), before, change,
                                          live * all(step.last_dt), booked, middle);
        }
        store3(after, block.v_half + n * block.half_stride);
        if constexpr (canopy || with_aero) sums.drag_power += live * work(aero, middle);
        if constexpr (canopy) sums.share_square += share * work(middle, middle);
        if constexpr (pulled == Pulled::apart) {
            store3(acceleration, aero_at);
            continue;
        }
        Vec3s x = load3(block.x + at);
        const Vec3s now = drift(x, after, acceleration, dt, half_dt);
        store3(x, block.x + at);
        store3(now, block.v + at);
        if constexpr (canopy)
            if (const std::int32_t halo = step.halo[n]; halo >= 0) show(block, halo, x, now);
        sums.position += mass * x;
        sums.velocity += mass * now;
        if constexpr (canopy) sums.area_velocity += share * now;
    }
}

GoreSums advance(const GoreFrame& frame, const GoreAdvance& step) {
    const Vec zero = all(0.0);
    const Vec3s none{zero, zero, zero};
    LaneSums canopy{none, none, none, zero, zero, zero, zero, zero, zero, zero}, line = canopy;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        if (step.first_aero > 0)
            move_nodes<true, false, Pulled::none>(block, step, 0, step.first_aero, canopy);
        move_nodes<true, true, Pulled::none>(block, step, step.first_aero, step.first_pulled, canopy);
        if (step.together) {
            move_nodes<true, true, Pulled::together>(block, step, step.first_pulled, frame.canopy, canopy);
            move_nodes<false, true, Pulled::together>(block, step, frame.canopy, frame.own, line);
        } else {
            move_nodes<true, true, Pulled::apart>(block, step, step.first_pulled, frame.canopy, canopy);
            move_nodes<false, true, Pulled::apart>(block, step, frame.canopy, frame.own, line);
        }
    }
    GoreSums sums;
    sums.canopy_position = sum3s(canopy.position);
    sums.canopy_velocity = sum3s(canopy.velocity);
    sums.line_position = sum3s(line.position);
    sums.line_velocity = sum3s(line.velocity);
    sums.area_velocity = sum3s(canopy.area_velocity);
    sums.drag_power = sum(canopy.drag_power + line.drag_power);
    sums.momentum = sum(canopy.momentum + line.momentum);
    sums.share_square = sum(canopy.share_square);
    sums.dissipated = sum(canopy.dissipated + line.dissipated);
    sums.accretion_power = sum(canopy.accretion_power);
    sums.external_power = sum(canopy.external_power);
    sums.kinetic = 0.5 * sum(canopy.kinetic + line.kinetic);
    return sums;
}

/// A node under its line alone. `x`: where it is.
template <bool canopy, bool last_of_step>
HWY_INLINE void move_pulled(const Block& block, const GoreSubcycle& subcycle, std::int32_t n, Vec3s x,
                            Vec3s pull, LaneSums& sums) {
    const Vec kick = all(subcycle.step.kick) * block.live, dt = all(subcycle.step.dt) * block.live;
    const std::size_t at = n * block.stride;
    const Vec3s acceleration = all(subcycle.inverse_inertia[n]) * pull;
    const Vec3s after = kicked(load3(block.v_half + n * block.half_stride), acceleration, kick);
    Vec3s now = drift(x, after, acceleration, dt, 0.5 * dt);
    store3(after, block.v_half + n * block.half_stride);
    store3(x, block.x + at);
    if constexpr (last_of_step) {
        now += (all(subcycle.half_step) * block.live) * load3(canopy ? block.skirt_aero : block.aero + at);
        const Vec mass = all(subcycle.nodes[n].mass) * block.live;
        sums.position += mass * x;
        sums.velocity += mass * now;
        if constexpr (canopy) {
            sums.area_velocity += all(subcycle.nodes[n].share) * block.live * now;
            show(block, subcycle.skirt_halo, x, now);
        }
    }
    store3(now, block.v + at);
}

template <bool last_of_step>
HWY_INLINE void move_lines(const Block& block, const GoreSubcycle& subcycle, LaneSums& canopy,
                           LaneSums& line) {
    const std::int32_t skirt = subcycle.lines.front().node[0], first = subcycle.lines.front().node[1];
    move_pulled<true, last_of_step>(block, subcycle, skirt, block.position(skirt), load3(block.pull), canopy);
    for (std::int32_t n = first; n < static_cast<std::int32_t>(subcycle.nodes.size()); ++n)
        move_pulled<false, last_of_step>(block, subcycle, n, block.position(n),
                                         load3(block.force + n * block.stride), line);
}

/// Moves the nodes of lines as soon as their cables have pulled on them; the link's pull is only set.
template <bool last_of_step>
struct MoveNodes {
    const GoreSubcycle& subcycle;
    LaneSums &of_canopy, &of_lines;

    HWY_INLINE void skirt(const Block& block, std::int32_t n, const LineNode& node) const {
        move_pulled<true, last_of_step>(block, subcycle, n, node.x, node.pull, of_canopy);
    }
    HWY_INLINE void node(const Block& block, std::int32_t n, const LineNode& node) const {
        move_pulled<false, last_of_step>(block, subcycle, n, node.x, node.pull, of_lines);
    }
    HWY_INLINE void last(const Block& block, std::int32_t n, const LineNode& node) const {
        store3(node.pull, block.force + n * block.stride);
    }
};

template <bool last_of_step>
GoreSums subcycle_pass(const GoreFrame& frame, const GoreSubcycle& subcycle) {
    const Vec zero = all(0.0);
    const Vec3s none{zero, zero, zero};
    LaneSums canopy{none, none, none, zero, zero, zero, zero, zero, zero, zero}, line = canopy;
    GoreSums sums;
    if (subcycle.pulled) {
        for (int b = frame.first; b < frame.last; ++b)
            move_lines<last_of_step>(Block(frame, b), subcycle, canopy, line);
    } else {
        MoveNodes<last_of_step> move{subcycle, canopy, line};
        const ElementSums of_lines = cable_forces(LineView(frame, subcycle.lines, move));
        sums.dissipated = of_lines.dissipated;
        sums.largest_tension = of_lines.largest_load;
    }
    if constexpr (last_of_step) {
        sums.canopy_position = sum3s(canopy.position);
        sums.canopy_velocity = sum3s(canopy.velocity);
        sums.line_position = sum3s(line.position);
        sums.line_velocity = sum3s(line.velocity);
        sums.area_velocity = sum3s(canopy.area_velocity);
    }
    return sums;
}

GoreSums subcycle(const GoreFrame& frame, const GoreSubcycle& subcycle) {
    return subcycle.half_step > 0.0 ? subcycle_pass<true>(frame, subcycle)
                                    : subcycle_pass<false>(frame, subcycle);
}

}  // namespace

GoreKernels gore_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes_of_all,
            {membranes<true, AirOnFabric::none>, membranes<true, AirOnFabric::pushes>,
             membranes<true, AirOnFabric::fills>},
            {nullptr, membranes<false, AirOnFabric::pushes>, membranes<false, AirOnFabric::fills>},
            levels_of_membranes,
            levels_of_springs,
            levels_of_cables,
            kinetic_energy,
            fabric_drags,
            springs,
            cables,
            contacts,
            levels_of_contacts,
            lines<true, false>,
            lines<false, true>,
            lines<true, true>,
            rows_of_membranes,
            rows_of_springs,
            critical_step,
            advance,
            subcycle,
            scatter_add_halo};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twinchute::fullsim {

std::span<const GoreKernels> all_gore_kernels() {
    static const std::vector<GoreKernels> sets =
        TWINCHUTE_SETS_OF_THIS_MACHINE(GoreKernels, gore_kernels_here);
    return sets;
}

const GoreKernels& gore_kernels() {
    return all_gore_kernels().front();
}

}  // namespace twinchute::fullsim
#endif
