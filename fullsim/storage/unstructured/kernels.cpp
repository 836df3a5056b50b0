#include "fullsim/storage/unstructured/kernels.hpp"

#include <algorithm>
#include <cmath>

#include "fullsim/storage/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/storage/unstructured/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Measured: worth it with 16 registers, too.
#define TWINCHUTE_INTERLEAVED 1
#include "fullsim/storage/simd/drag_table.hpp"
#include "fullsim/storage/simd/records.hpp"
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

using namespace unstructured;  // NOLINT(google-build-using-namespace): the kernels' own words

constexpr int lanes = lanes_of_all;
constexpr RowOffset row_bytes = 4 * sizeof(double);

// --- views: elements in groups, whose nodes lie anywhere (see fullsim/elements/membrane.hpp) --------

/// A view of elements of a kind. Element: made of nodes, a group's node offsets and constants, and a Context
/// of its own.
template <class Element>
class GroupView : public SimdView {
public:
    using Flow = Vec3s;
    using Context = typename Element::Context;
    static constexpr bool skips = true;

    GroupView(Nodes nodes, Elements elements, Context context = {}) : part_{nodes, elements, context} {}

    HWY_INLINE int first() const { return 0; }
    HWY_INLINE int last() const { return 1; }
    HWY_INLINE Flow flow(const std::array<double, 3>& direction) const { return all3(direction); }

    struct Part {
        Nodes nodes;
        Elements elements;
        Context context;

        HWY_INLINE std::size_t size() const { return elements.groups; }
        HWY_INLINE Element element(std::size_t k) const {
            return Element(nodes, elements.node + k * Element::corner_lanes,
                           elements.constant + k * Element::constants * lanes, context);
        }
        HWY_INLINE Vec live(Vec sum) const { return sum; }
        HWY_INLINE Vec live_load(Vec load) const { return load; }
        HWY_INLINE void finish(std::size_t) const {}
        HWY_INLINE void close() const {}
    };
    HWY_INLINE Part part(int) const { return part_; }

private:
    Part part_;
};

struct Nothing {};

/// As many elements side by side as the kernels take.
template <int corner_count, int constant_count, class OfContext>
class GroupElement {
public:
    static constexpr int corners = corner_count, corner_lanes = corners * lanes, constants = constant_count;
    using Context = OfContext;

    HWY_INLINE GroupElement(Nodes nodes, const RowOffset* node, const double* constant, Context context)
        : nodes_(nodes), node_(node), constant_(constant), context_(context) {}

    HWY_INLINE Vec live(Vec a, double) const { return a; }
    HWY_INLINE void add_force(int c, Vec3s force) const { scatter_add(force, nodes_.force, corner(c)); }
    HWY_INLINE void subtract_force(int c, Vec3s force) const {
        scatter_subtract(force, nodes_.force, corner(c));
    }

protected:
    HWY_INLINE const RowOffset* corner(int c) const { return node_ + c * lanes; }
    HWY_INLINE Vec constant(int which) const { return load(constant_ + which * lanes); }
    /// Position and velocity of corner c relative to the first.
    HWY_INLINE Motion to_corner(int c) const { return between(nodes_.record, corner(0), corner(c)); }
    HWY_INLINE Vec3s first_position() const {
        return vectors_of([this](int lane)
                              TWINCHUTE_INLINED { return position_of(nodes_.record, node_[lane]); });
    }
    HWY_INLINE Vec3s first_velocity() const {
        return vectors_of([this](int lane)
                              TWINCHUTE_INLINED { return velocity_of(nodes_.record, node_[lane]); });
    }
    HWY_INLINE void add_to_all(Vec3s a, double* rows) const {
        for_each_row(a, [&](int lane, Row row) TWINCHUTE_INLINED {
            for (int c = 0; c < corners; ++c) {
                double* at = row_at(rows, corner(c)[lane]);
                store_row(load_row(at) + row, at);
            }
        });
    }
    HWY_INLINE Vec weights(Rows rows, int c) const {
        alignas(64) double weight[lanes];
        for (int lane = 0; lane < lanes; ++lane)
            weight[lane] = rows.weight[corner(c)[lane] / row_bytes];
        return load(weight);
    }
    HWY_INLINE void add_to_rows(Rows rows, int at_corner, Vec stiffness, Vec damping) const {
        alignas(64) double k[lanes], c[lanes];
        store(stiffness, k);
        store(damping, c);
        for (int lane = 0; lane < lanes; ++lane) {
            rows.stiffness[corner(at_corner)[lane] / row_bytes] += k[lane];
            rows.damping[corner(at_corner)[lane] / row_bytes] += c[lane];
        }
    }

    Nodes nodes_;
    const RowOffset* node_;
    const double* constant_;
    Context context_;
};

/// Two triangles of corners 0, 1, 2 and 0, 2, 3 side by side in two registers: as many quads as one has
/// lanes.
template <class OfContext>
class TriangleGroup {
public:
    static constexpr int corner_lanes = 4 * lanes_of_register, constants = membrane_constants;
    using Context = OfContext;

    HWY_INLINE TriangleGroup(Nodes nodes, const RowOffset* node, const double* constant,
                             const OfContext& context)
        : nodes_(nodes), node_(node), constant_(constant), context_(context) {}

    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2, Vec3s& w1, Vec3s& w2) const {
        const Columns one = to_corner(1), two = to_corner(2), three = to_corner(3);
        e1 = {joined(one.x, two.x), joined(one.y, two.y), joined(one.z, two.z)};
        e2 = {joined(two.x, three.x), joined(two.y, three.y), joined(two.z, three.z)};
        w1 = {joined(one.u, two.u), joined(one.v, two.v), joined(one.w, two.w)};
        w2 = {joined(two.u, three.u), joined(two.v, three.v), joined(two.w, three.w)};
    }
    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2) const {
        Vec3s w1, w2;
        edges(e1, e2, w1, w2);
    }
    HWY_INLINE void edges_and_mean_velocity(Vec3s& e1, Vec3s& e2, Vec3s& mean) const {
        Vec3s w1, w2;
        edges(e1, e2, w1, w2);
        mean = first_velocity() + (1.0 / 3.0) * (w1 + w2);
    }
    HWY_INLINE Vec3s first_velocity() const {
        Row rows[lanes_of_register];
        for (int lane = 0; lane < lanes_of_register; ++lane)
            rows[lane] = velocity_of(nodes_.record, node_[lane]);
        Part3 v;
        columns_of_rows(rows, v.x, v.y, v.z);
        return {joined(v.x, v.x), joined(v.y, v.y), joined(v.z, v.z)};
    }
    HWY_INLINE Vec live(Vec a, double) const { return a; }
    HWY_INLINE Vec inverse_a() const { return constant(unstructured::inverse_a); }
    HWY_INLINE Vec inverse_c() const { return constant(unstructured::inverse_c); }
    HWY_INLINE Vec b_over_a() const { return constant(unstructured::b_over_a); }
    HWY_INLINE Vec weighted_area(double weight) const { return weight * constant(reference_area); }
    HWY_INLINE Vec viscosity() const { return constant(unstructured::viscosity); }
    HWY_INLINE double half() const { return 0.5; }
    HWY_INLINE void pull(Vec3s first, Vec3s second, Vec3s third) const {
        add(0, part(first, 0) + part(first, 1), nodes_.force);
        subtract(1, part(second, 0), nodes_.force);
        subtract(2, part(third, 0) + part(second, 1), nodes_.force);
        subtract(3, part(third, 1), nodes_.force);
    }
    HWY_INLINE void add_push(Vec3s area) const { add_to_all(area, nodes_.push); }
    HWY_INLINE void add_drag(Vec3s force) const { add_to_all(force, nodes_.aero); }

protected:
    struct Part3 {
        hn::Vec<Tag> x, y, z;
        HWY_INLINE friend Part3 operator+(Part3 a, Part3 b) {
            return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
        }
    };
    HWY_INLINE static Part3 part(Vec3s a, int k) { return {a.x.raw[k], a.y.raw[k], a.z.raw[k]}; }
    HWY_INLINE const RowOffset* corner(int c) const { return node_ + c * lanes_of_register; }
    HWY_INLINE Vec constant(int which) const { return load(constant_ + which * lanes); }
    HWY_INLINE Columns to_corner(int c) const {
        return columns_from<0>([this, c](int lane) TWINCHUTE_INLINED {
            return record_of(nodes_.record, corner(c)[lane]) - record_of(nodes_.record, node_[lane]);
        });
    }
    HWY_INLINE void add(int c, Part3 a, double* rows) const {
        Row row[lanes_of_register];
        rows_of(a.x, a.y, a.z, row);
        for (int lane = 0; lane < lanes_of_register; ++lane) {
            double* at = row_at(rows, corner(c)[lane]);
            store_row(load_row(at) + row[lane], at);
        }
    }
    HWY_INLINE void subtract(int c, Part3 a, double* rows) const {
        Row row[lanes_of_register];
        rows_of(a.x, a.y, a.z, row);
        for (int lane = 0; lane < lanes_of_register; ++lane) {
            double* at = row_at(rows, corner(c)[lane]);
            store_row(load_row(at) - row[lane], at);
        }
    }
    HWY_INLINE void add_to_all(Vec3s a, double* rows) const {
        const Part3 first = part(a, 0), second = part(a, 1), both = first + second;
        add(0, both, rows);
        add(1, first, rows);
        add(2, both, rows);
        add(3, second, rows);
    }

    Nodes nodes_;
    const RowOffset* node_;
    const double* constant_;
    Context context_;
};

struct TriangleRowsContext {
    Rows rows;
    double plane_modulus, weight;
};

class TriangleRowsGroup : public TriangleGroup<TriangleRowsContext> {
public:
    HWY_INLINE TriangleRowsGroup(Nodes nodes, const RowOffset* node, const double* constant,
                                 const TriangleRowsContext& context)
        : TriangleGroup(nodes, node, constant, context) {}

    /// As unstrained_rows, with the weights of the corners.
    HWY_INLINE void add_rows(MembraneStiffening<Vec> by) const {
        const Vec a = inverse_a(), c = inverse_c(), b = b_over_a() * c;
        const Vec gradient[3] = {square_root((b - c) * (b - c) + a * a), square_root(b * b + a * a), c};
        const Vec area = weighted_area(context_.weight);
        const Vec stiffness = context_.plane_modulus * (area * by.stiffness);
        const Vec damping = viscosity() * (area * by.damping);
        Vec w[3], columns = all(0.0);
        for (int i = 0; i < 3; ++i) {
            w[i] = weights(i);
            columns += gradient[i] * w[i];
        }
        for (int i = 0; i < 3; ++i) {
            const Vec row = gradient[i] * columns / w[i];
            add_to_rows(i, row * stiffness, row * damping);
        }
    }

private:
    /// Row of corner c of triangle lane.
    HWY_INLINE RowOffset corner_of(int c, int lane) const {
        const bool second = lane >= lanes_of_register;
        return corner(second && c > 0 ? c + 1 : c)[second ? lane - lanes_of_register : lane];
    }
    HWY_INLINE Vec weights(int c) const {
        alignas(64) double weight[lanes];
        for (int lane = 0; lane < lanes; ++lane)
            weight[lane] = context_.rows.weight[corner_of(c, lane) / row_bytes];
        return load(weight);
    }
    HWY_INLINE void add_to_rows(int at_corner, Vec stiffness, Vec damping) const {
        alignas(64) double k[lanes], c[lanes];
        store(stiffness, k);
        store(damping, c);
        for (int lane = 0; lane < lanes; ++lane) {
            context_.rows.stiffness[corner_of(at_corner, lane) / row_bytes] += k[lane];
            context_.rows.damping[corner_of(at_corner, lane) / row_bytes] += c[lane];
        }
    }
};

/// From one node to another: cables, springs.
template <int constant_count, class OfContext>
class SpanGroup : public GroupElement<2, constant_count, OfContext> {
    using Base = GroupElement<2, constant_count, OfContext>;

public:
    HWY_INLINE SpanGroup(Nodes nodes, const RowOffset* node, const double* constant, const OfContext& context)
        : Base(nodes, node, constant, context) {}

    HWY_INLINE Vec3s distance() const {
        return distance_between(this->nodes_.record, this->corner(0), this->corner(1));
    }
    HWY_INLINE void ends(Vec3s& d, Vec3s& w) const {
        const Motion motion = this->to_corner(1);
        d = motion.x, w = motion.v;
    }
    /// Half of the relative velocity leads to the mean.
    HWY_INLINE Vec3s mean_velocity(Vec3s w) const { return this->first_velocity() + 0.5 * w; }
    HWY_INLINE Vec inverse_length() const { return this->constant(unstructured::inverse_length); }
    HWY_INLINE Vec stiffness() const { return this->constant(unstructured::stiffness); }
    HWY_INLINE Vec dashpot() const { return this->constant(unstructured::dashpot); }
    HWY_INLINE Vec hardening() const { return this->constant(unstructured::hardening); }
    HWY_INLINE Vec fold_force() const { return this->constant(unstructured::fold_force); }
    HWY_INLINE Vec counted(Vec load) const { return load; }
    HWY_INLINE void pull_together(Vec3s force) const {
        for_each_row(force, [&](int lane, Row row) TWINCHUTE_INLINED {
            double* const first = row_at(this->nodes_.force, this->corner(0)[lane]);
            store_row(load_row(first) + row, first);
            double* const second = row_at(this->nodes_.force, this->corner(1)[lane]);
            store_row(load_row(second) - row, second);
        });
    }
    HWY_INLINE void add_drag(Vec3s end) const { this->add_to_all(end, this->nodes_.aero); }
};

/// Both ends have the same rows, but for the weights.
template <int constant_count>
class SpanRowsGroup : public SpanGroup<constant_count, Rows> {
public:
    HWY_INLINE SpanRowsGroup(Nodes nodes, const RowOffset* node, const double* constant, const Rows& context)
        : SpanGroup<constant_count, Rows>(nodes, node, constant, context) {}

    HWY_INLINE void add_rows(Vec stiffness, Vec damping) const {
        const Vec first = this->weights(this->context_, 0), second = this->weights(this->context_, 1);
        const Vec columns[2] = {1.0 + second / first, 1.0 + first / second};
        for (int end = 0; end < 2; ++end)
            this->add_to_rows(this->context_, end, columns[end] * stiffness, columns[end] * damping);
    }
};

class PairGroup : public GroupElement<2, pair_constants, Nothing> {
public:
    HWY_INLINE PairGroup(Nodes nodes, const RowOffset* node, const double* constant, const Nothing& context)
        : GroupElement(nodes, node, constant, context) {}

    HWY_INLINE Vec stiffness() const { return constant(pair_stiffness); }
    HWY_INLINE void arm_and_distance(Vec3s centre, Vec3s& arm, Vec3s& d) const {
        arm = first_position() - centre;
        d = distance_between(nodes_.record, corner(0), corner(1));
    }
    HWY_INLINE void push_apart(Vec3s apart, Vec3s half_of_middle) const {
        add_force(0, apart - half_of_middle);
        subtract_force(1, apart + half_of_middle);
    }
};

// --- loops ---------------------------------------------------------------------------------------

using Triangles = GroupView<TriangleGroup<Nothing>>;
using Cables = GroupView<SpanGroup<cable_constants, Nothing>>;
using Edges = GroupView<SpanGroup<spring_constants, Nothing>>;

template <bool structure, AirOnFabric air>
ElementSums membranes(Nodes nodes, Elements elements, const MembranePass& pass) {
    return membrane_forces<structure, air>(Triangles(nodes, elements), pass);
}
EnergyAndStrain levels_of_membranes(Nodes nodes, Elements elements, const MembranePass& pass) {
    return membrane_levels(Triangles(nodes, elements), pass);
}
ElementSums fabric_drags(Nodes nodes, Elements elements, const FabricDragPass& pass) {
    return fabric_drag_forces(Triangles(nodes, elements), pass);
}
ElementSums springs(Nodes nodes, Elements elements, const SpringPass& pass) {
    return spring_forces(Edges(nodes, elements), pass);
}
ElementSums cables(Nodes nodes, Elements elements) {
    return cable_forces(Cables(nodes, elements));
}
template <bool pulls>
ElementSums cables_in_air(Nodes nodes, Elements elements, const LineAir& air) {
    return cable_forces_in<pulls>(Cables(nodes, elements), air);
}
ElementSums contacts(Nodes nodes, Elements elements, const ContactPass& pass) {
    return contact_forces(GroupView<PairGroup>(nodes, elements), pass);
}

void rows_of_membranes(Nodes nodes, Elements elements, const MembranePass& pass, Rows rows) {
    membrane_rows(GroupView<TriangleRowsGroup>(nodes, elements, {rows, pass.law.plane_modulus, pass.weight}));
}
void rows_of_springs(Nodes nodes, Elements elements, const SpringPass& pass, Rows rows) {
    spring_rows(GroupView<SpanRowsGroup<spring_constants>>(nodes, elements, rows), pass);
}
void rows_of_cables(Elements elements, Rows rows) {
    cable_rows(GroupView<SpanRowsGroup<cable_constants>>({}, elements, rows));
}

double critical_step(Rows rows, const Bound& bound) {
    const std::size_t count = bound.mass.size();
    const Vec added = all(bound.added_mass), by_share = all(bound.by_share), by_mass = all(bound.by_mass);
    Vec shortest = all(HUGE_VAL);
    const auto look = [&](Vec k, Vec c, Vec mass, Vec share) TWINCHUTE_INLINED {
        const Vec m = mass + share * added;
        const Vec damping = c + by_share * share + by_mass * mass;
        // In this order: a node without a number must not hide what the others say.
        shortest = smaller(critical_step(k, damping, m), shortest);
    };
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
        look(load_anywhere(rows.stiffness + i), load_anywhere(rows.damping + i),
             load_anywhere(bound.mass.data() + i), load_anywhere(bound.share.data() + i));
    for (; i < count; ++i)
        look(all(rows.stiffness[i]), all(rows.damping[i]), all(bound.mass[i]), all(bound.share[i]));
    return least(shortest);
}

// --- node update --------------------------------------------------------------------------------

HWY_INLINE Row row_from(const std::array<double, 4>& a) {
    Row row;
    for (int p = 0; p < parts; ++p)
        row.part[p] = hn::LoadU(row_tag, a.data() + p * lanes_of_part);
    return row;
}
HWY_INLINE std::array<double, 4> to_array(Row row) {
    std::array<double, 4> a;
    for (int p = 0; p < parts; ++p)
        hn::StoreU(row.part[p], row_tag, a.data() + p * lanes_of_part);
    return a;
}

/// Sums of a step over nodes of a kind.
struct RowSums4 {
    Row position, velocity, area_velocity, drag_power, momentum, share_square, dissipated, accretion_power;
    Row kinetic;  // twice
};

/// Nodes from first to last. Templates, so that what nodes have not costs nothing in the loop; `more`: mass
/// damping or accretion acts.
template <bool canopy, bool with_aero, bool more>
HWY_INLINE void move_nodes(Nodes nodes, const Advance& step, std::size_t first, std::size_t last,
                           RowSums4& all_sums) {
    RowSums4 sums = all_sums;
    const Row none = row_of(0.0);
    const Row kick = row_of(step.kick), dt = row_of(step.dt), half_dt = row_of(0.5 * step.dt);
    const Row pressure = row_of(step.pressure), on_fabric = row_from(step.on_fabric);
    const Row fall = row_from({0.0, 0.0, -step.gravity, 0.0}), contact = row_from(step.contact);
    const Row canopy_mean = row_from(step.canopy_mean), system_mean = row_from(step.system_mean);
    const Row wind = row_from(step.wind);
    // Copies, which no store to a node can change.
    const double *const masses = step.mass.data(), *const shares = step.share.data();
    double *const records = step.record, *const v_halves = step.v_half;
    const double added_mass = step.added_mass, breathing = step.breathing, accretion = step.accretion;
    const double mass_damping = step.mass_damping;
    for (std::size_t i = first; i < last; ++i) {
        const double mass = masses[i];
        double* const x_at = records + 8 * i;
        double* const v_at = x_at + 4;
        double* const v_half_at = v_halves + 4 * i;
        Row force = load_row(nodes.force + 4 * i), aero = none;
        store_row(none, nodes.force + 4 * i);
        if constexpr (with_aero) {
            aero = load_row(nodes.aero + 4 * i);
            store_row(none, nodes.aero + 4 * i);
        }
        double share = 0.0, inertia = mass;
        if constexpr (canopy) {
            share = shares[i];
            inertia += share * added_mass;
            force += mass * contact;
            aero += pressure * load_row(nodes.push + 4 * i) + share * on_fabric;
            store_row(none, nodes.push + 4 * i);
            if (breathing > 0.0)
                resist(share * breathing, load_row(v_at) - canopy_mean, force, sums.dissipated);
            if (more && accretion > 0.0)
                accrete(share * accretion, wind, load_row(v_at), force, sums.accretion_power);
        }
        if (more && mass_damping > 0.0)
            resist(mass_damping * mass, load_row(v_at) - system_mean, force, sums.dissipated);
        const Row m = row_of(mass);
        const Row acceleration = (1.0 / inertia) * (force + aero + m * fall);
        const Row before = load_row(v_half_at), after = kicked(before, acceleration, kick);
        const Row middle = middle_of(before, after);
        sums.momentum += m * middle;
        if (step.weighs)
            sums.kinetic += twice_kinetic(inertia, before, step.last_dt * acceleration, step.last_dt,
                                          aero + m * fall, middle);
        Row x = load_row(x_at);
        const Row now = drift(x, after, acceleration, dt, half_dt);
        store_row(after, v_half_at);
        store_row(x, x_at);
        store_row(now, v_at);
        sums.position += m * x;
        sums.velocity += m * now;
        if constexpr (canopy || with_aero) sums.drag_power += work(aero, middle);
        if constexpr (canopy) {
            sums.share_square += share * work(middle, middle);
            sums.area_velocity += share * now;
        }
    }
    all_sums = sums;
}

template <bool more>
Sums advance_all(Nodes nodes, const Advance& step) {
    const Row none = row_of(0.0);
    const RowSums4 nothing{none, none, none, none, none, none, none, none, none};
    RowSums4 canopy = nothing, other = nothing;
    const std::size_t aero = std::clamp(step.first_aero, step.first, step.last);
    const std::size_t end_of_canopy = std::clamp(step.canopy, step.first, step.last);
    move_nodes<true, false, more>(nodes, step, step.first, aero, canopy);
    move_nodes<true, true, more>(nodes, step, aero, end_of_canopy, canopy);
    move_nodes<false, true, more>(nodes, step, end_of_canopy, step.last, other);
    return {to_array(canopy.position),
            to_array(canopy.velocity),
            to_array(other.position),
            to_array(other.velocity),
            to_array(canopy.area_velocity),
            to_array(canopy.drag_power + other.drag_power),
            to_array(canopy.momentum + other.momentum),
            to_array(canopy.share_square),
            to_array(canopy.dissipated + other.dissipated),
            to_array(canopy.accretion_power),
            to_array(canopy.kinetic + other.kinetic)};
}

Sums advance(Nodes nodes, const Advance& step) {
    return step.mass_damping > 0.0 || step.accretion > 0.0 ? advance_all<true>(nodes, step)
                                                           : advance_all<false>(nodes, step);
}

Sums kick(Nodes nodes, const Advance& step, const Subcycled& list, double first_kick, double last_line_dt) {
    const Row none = row_of(0.0), by_all = row_of(step.kick), by_pull = row_of(first_kick);
    const Row fall = row_from({0.0, 0.0, -step.gravity, 0.0}), system_mean = row_from(step.system_mean);
    RowSums4 sums{none, none, none, none, none, none, none, none, none};
    for (std::size_t k = 0; k < list.node.size(); ++k) {
        const auto i = static_cast<std::size_t>(list.node[k]);
        const double mass = step.mass[i];
        const Row m = row_of(mass), inverse = row_of(list.inverse_inertia[k]);
        const Row aero = load_row(nodes.aero + 4 * i), pull = load_row(nodes.force + 4 * i);
        Row force = load_row(list.others + 4 * k);
        if (step.mass_damping > 0.0)
            resist(step.mass_damping * mass, load_row(list.record + 8 * i + 4) - system_mean, force,
                   sums.dissipated);
        const Row acceleration = inverse * (force + aero + m * fall), by_lines = inverse * pull;
        const Row before = load_row(list.v_half + 4 * i), after = kicked(before, acceleration, by_all);
        const Row middle = middle_of(before, after + by_pull * by_lines);
        sums.drag_power += work(aero, middle);
        sums.momentum += m * middle;
        if (step.weighs)
            sums.kinetic += twice_kinetic(mass, before, step.last_dt * acceleration + last_line_dt * by_lines,
                                          step.last_dt, aero + m * fall, middle);
        store_row(after, list.v_half + 4 * i);
        store_row(acceleration, nodes.aero + 4 * i);
    }
    Sums of{};
    of.drag_power = to_array(sums.drag_power);
    of.momentum = to_array(sums.momentum);
    of.dissipated = to_array(sums.dissipated);
    of.kinetic = to_array(sums.kinetic);
    return of;
}

void subcycle(Nodes nodes, const Subcycled& list, double kick, double dt) {
    const Row none = row_of(0.0), by_pull = row_of(kick), whole = row_of(dt), half = row_of(0.5 * dt);
    for (std::size_t k = 0; k < list.node.size(); ++k) {
        const auto i = static_cast<std::size_t>(list.node[k]);
        double *const force = nodes.force + 4 * i, *const v_half = list.v_half + 4 * i,
                      *const record = list.record + 8 * i;
        const Row acceleration = list.inverse_inertia[k] * load_row(force);
        const Row after = kicked(load_row(v_half), acceleration, by_pull);
        Row x = load_row(record);
        const Row now = drift(x, after, acceleration, whole, half);
        store_row(after, v_half);
        store_row(x, record);
        store_row(now, record + 4);
        store_row(none, force);
    }
}

Sums end_subcycles(Nodes nodes, const Subcycled& list, double dt, std::span<const double> mass) {
    const Row none = row_of(0.0), half = row_of(0.5 * dt);
    Row position = none, velocity = none;
    for (const std::int32_t node : list.node) {
        const auto i = static_cast<std::size_t>(node);
        double *const aero = nodes.aero + 4 * i, *const v = list.record + 8 * i + 4;
        const Row now = load_row(v) + half * load_row(aero), m = row_of(mass[i]);
        store_row(now, v);
        store_row(none, aero);
        position += m * load_row(list.record + 8 * i);
        velocity += m * now;
    }
    Sums of{};
    of.other_position = to_array(position);
    of.other_velocity = to_array(velocity);
    return of;
}

}  // namespace

unstructured::Kernels unstructured_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes,
            {membranes<true, AirOnFabric::none>, membranes<true, AirOnFabric::pushes>,
             membranes<true, AirOnFabric::fills>},
            {nullptr, membranes<false, AirOnFabric::pushes>, membranes<false, AirOnFabric::fills>},
            levels_of_membranes,
            fabric_drags,
            springs,
            cables,
            cables_in_air<false>,
            cables_in_air<true>,
            contacts,
            rows_of_membranes,
            rows_of_springs,
            rows_of_cables,
            critical_step,
            advance,
            kick,
            end_subcycles,
            subcycle};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twinchute::fullsim::unstructured {

std::span<const Kernels> all_kernels() {
    static const std::vector<Kernels> sets =
        TWINCHUTE_SETS_OF_THIS_MACHINE(Kernels, unstructured_kernels_here);
    return sets;
}

}  // namespace twinchute::fullsim::unstructured
#endif
