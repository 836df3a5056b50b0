#include "fullsim/storage/sector_batched/kernels.hpp"

#include <cmath>

#include "fullsim/storage/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/storage/sector_batched/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/storage/simd/drag_table.hpp"
#include "fullsim/storage/simd/vec.hpp"

#include "fullsim/elements/cable.hpp"
#include "fullsim/elements/contact.hpp"
#include "fullsim/elements/membrane.hpp"
#include "fullsim/laws/critical_step.hpp"
#include "fullsim/laws/node.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

HWY_INLINE Vec3s anywhere3(const Components& from, std::int32_t at) {
    return {load_anywhere(from[0] + at), load_anywhere(from[1] + at), load_anywhere(from[2] + at)};
}
HWY_INLINE Vec3s aligned3(const Components& from, std::int32_t at) {
    return {load(from[0] + at), load(from[1] + at), load(from[2] + at)};
}
HWY_INLINE void put3(Vec3s a, const Components& to, std::int32_t at) {
    store(a.x, to[0] + at);
    store(a.y, to[1] + at);
    store(a.z, to[2] + at);
}
HWY_INLINE void put_anywhere(Vec a, double* to) {
    for (int k = 0; k < unroll_factor; ++k)
        hn::StoreU(a.raw[k], tag, to + k * lanes_of_register);
}

// --- views: elements on rows of nodes (see fullsim/elements/membrane.hpp) -----------------------------

/// A view of batches of elements, as many of them interleaved as a vector has registers. Element: made of the
/// frame, the first batch, the place of its constants, and a Context of its own.
template <class Element>
class SectorView : public SimdView {
public:
    using Flow = AxialFlow<Vec>;
    using Context = typename Element::Context;
    using Batches = std::vector<typename Element::ElementBatch>;
    static constexpr bool skips = false;  // buffers are written every time

    SectorView(const SectorFrame& frame, const Batches& batches, Context context = {})
        : frame_(frame), batches_(batches), context_(context) {}

    HWY_INLINE int first() const { return 0; }
    HWY_INLINE int last() const { return 1; }
    HWY_INLINE Flow flow(const std::array<double, 3>& direction) const { return {all(direction[2])}; }

    struct Part {
        const SectorFrame& frame;
        const Batches& batches;
        Context context;

        HWY_INLINE std::size_t size() const { return (batches.size() + unroll_factor - 1) / unroll_factor; }
        HWY_INLINE Element element(std::size_t k) const {
            return Element(frame, &batches[k * unroll_factor],
                           static_cast<std::int32_t>(k * unroll_factor * lanes_of_register), context);
        }
        HWY_INLINE Vec live(Vec sum) const { return sum; }
        HWY_INLINE Vec live_load(Vec load) const { return load; }
        HWY_INLINE void finish(std::size_t) const {}
        HWY_INLINE void close() const {}
    };
    HWY_INLINE Part part(int) const { return {frame_, batches_, context_}; }

private:
    const SectorFrame& frame_;
    const Batches& batches_;
    Context context_;
};

template <class OfStretch, class OfContext>
class BatchElement {
public:
    using ElementBatch = OfStretch;
    using Context = OfContext;

    HWY_INLINE BatchElement(const SectorFrame& frame, const ElementBatch* batch, std::int32_t at,
                            Context context)
        : f_(frame), s_(batch), at_(at), context_(context) {}

protected:
    /// Values of a row at corner c of each element.
    HWY_INLINE Vec3s corner(const Components& from, int c) const {
        Vec3s at;
        for (int k = 0; k < unroll_factor; ++k) {
            at.x.raw[k] = hn::LoadU(tag, from[0] + s_[k].node[c]);
            at.y.raw[k] = hn::LoadU(tag, from[1] + s_[k].node[c]);
            at.z.raw[k] = hn::LoadU(tag, from[2] + s_[k].node[c]);
        }
        return at;
    }
    HWY_INLINE void put_force(Vec a, double* to, int which) const {
        for (int k = 0; k < unroll_factor; ++k)
            hn::Store(a.raw[k], tag, to + s_[k].element_force[which]);
    }
    HWY_INLINE void put_force(Vec3s a, int which) const {
        put_force(a.x, f_.element_force[0], which);
        put_force(a.y, f_.element_force[1], which);
        put_force(a.z, f_.element_force[2], which);
    }
    HWY_INLINE Vec constant(const double* row) const { return load(row + at_); }

    const SectorFrame& f_;
    const ElementBatch* s_;
    std::int32_t at_;
    Context context_;
};

struct Nothing {};

class SectorTriangle : public BatchElement<TriangleBatch, Nothing> {
public:
    HWY_INLINE SectorTriangle(const SectorFrame& frame, const ElementBatch* batch, std::int32_t at,
                              Context context)
        : BatchElement(frame, batch, at, context) {}

    /// Where a register is filled up there is no triangle.
    HWY_INLINE Vec live(Vec a, double) const { return 2.0 * half() * a; }
    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2) const {
        const Vec3s x0 = corner(f_.x, 0);
        e1 = corner(f_.x, 1) - x0, e2 = corner(f_.x, 2) - x0;
    }
    HWY_INLINE void edges(Vec3s& e1, Vec3s& e2, Vec3s& w1, Vec3s& w2) const {
        edges(e1, e2);
        const Vec3s v0 = corner(f_.v, 0);
        w1 = corner(f_.v, 1) - v0, w2 = corner(f_.v, 2) - v0;
    }
    HWY_INLINE Vec3s first_velocity() const { return corner(f_.v, 0); }
    HWY_INLINE Vec inverse_a() const { return constant(f_.triangle.inverse_a); }
    HWY_INLINE Vec inverse_c() const { return constant(f_.triangle.inverse_c); }
    HWY_INLINE Vec b_over_a() const { return constant(f_.triangle.b_over_a); }
    /// A sector has membranes alone: their weight is 1.
    HWY_INLINE Vec weighted_area(double) const { return constant(f_.triangle.area); }
    HWY_INLINE Vec viscosity() const { return constant(f_.triangle.viscosity); }
    HWY_INLINE Vec half() const { return constant(f_.triangle.half); }
    HWY_INLINE void pull(Vec3s first, Vec3s second, Vec3s third) const {
        put_force(first, 0);
        put_force(second, 1);
        put_force(third, 2);
    }
    HWY_INLINE void add_push(Vec3s area) const { put_force(area, 3); }
    HWY_INLINE void add_rows(MembraneStiffening<Vec> by) const {
        for (int c = 0; c < 3; ++c) {
            BatchElement::put_force(by.stiffness * constant(f_.triangle.stiffness[c]), f_.element_rows[0], c);
            BatchElement::put_force(by.damping * constant(f_.triangle.damping[c]), f_.element_rows[1], c);
        }
    }
};

class SectorCable : public BatchElement<CableBatch, const CableConstantsRow*> {
public:
    HWY_INLINE SectorCable(const SectorFrame& frame, const ElementBatch* batch, std::int32_t at,
                           Context context)
        : BatchElement(frame, batch, at, context) {}

    HWY_INLINE Vec live(Vec a, double) const { return a; }
    HWY_INLINE Vec3s distance() const { return corner(f_.x, 1) - corner(f_.x, 0); }
    HWY_INLINE void ends(Vec3s& d, Vec3s& w) const { d = distance(), w = corner(f_.v, 1) - corner(f_.v, 0); }
    HWY_INLINE Vec inverse_length() const { return constant(context_->inverse_length); }
    HWY_INLINE Vec stiffness() const { return constant(context_->stiffness); }
    HWY_INLINE Vec stiffness_times_length() const { return stiffness() * constant(context_->length); }
    HWY_INLINE Vec dashpot() const { return constant(context_->dashpot); }
    /// Tensions of suspension lines alone.
    HWY_INLINE Vec counted(Vec load) const { return constant(context_->line) * load; }
    HWY_INLINE void pull_together(Vec3s force) const { put_force(force, 0); }
};

class SectorLine : public BatchElement<CableBatch, Nothing> {
public:
    HWY_INLINE SectorLine(const SectorFrame& frame, const ElementBatch* batch, std::int32_t at,
                          Context context)
        : BatchElement(frame, batch, at, context) {}

    HWY_INLINE void ends(Vec3s& d, Vec3s& w) const {
        d = corner(f_.x, 1) - corner(f_.x, 0), w = corner(f_.v, 1) - corner(f_.v, 0);
    }
    HWY_INLINE Vec3s mean_velocity(Vec3s) const { return 0.5 * (corner(f_.v, 0) + corner(f_.v, 1)); }
    HWY_INLINE void add_drag(Vec3s end) const { put_force(constant(f_.line) * end, 0); }
};

/// The axis is where x and y are zero; places along it do not matter.
class SectorPair : public BatchElement<ContactBatch, Nothing> {
public:
    HWY_INLINE SectorPair(const SectorFrame& frame, const ElementBatch* batch, std::int32_t at,
                          Context context)
        : BatchElement(frame, batch, at, context) {}

    HWY_INLINE Vec stiffness() const { return constant(f_.contact); }
    HWY_INLINE void arm_and_distance(Vec3s, Vec3s& arm, Vec3s& d) const {
        const Vec3s x0 = corner(f_.x, 0);
        arm = {x0.x, x0.y, all(0.0)}, d = corner(f_.x, 1) - x0;
    }
    HWY_INLINE void push_apart(Vec3s apart, Vec3s half_of_middle) const {
        put_force(half_of_middle - apart, 0);
        put_force(half_of_middle + apart, 1);
    }
};

// --- loops ---------------------------------------------------------------------------------------------

template <AirOnFabric air>
ElementSums triangles(const SectorFrame& f, const SectorPlan& plan, const MembranePass& pass) {
    return membrane_forces<true, air>(SectorView<SectorTriangle>(f, plan.triangles), pass);
}
EnergyAndStrain levels_of_triangles(const SectorFrame& f, const SectorPlan& plan, const MembranePass& pass) {
    return membrane_levels(SectorView<SectorTriangle>(f, plan.triangles), pass);
}
ElementSums cables(const SectorFrame& f, const std::vector<CableBatch>& batches, const CableConstantsRow& k) {
    return cable_forces(SectorView<SectorCable>(f, batches, &k));
}
EnergyAndStrain levels_of_cables(const SectorFrame& f, const std::vector<CableBatch>& batches,
                                 const CableConstantsRow& k) {
    return cable_levels(SectorView<SectorCable>(f, batches, &k));
}
ElementSums line_drag(const SectorFrame& f, const SectorPlan& plan, const LineAir& air) {
    return cable_forces_in<false>(SectorView<SectorLine>(f, plan.lines), air);
}
ElementSums contacts(const SectorFrame& f, const SectorPlan& plan, const ContactPass& pass) {
    return contact_forces(SectorView<SectorPair>(f, plan.contacts), pass);
}
EnergyAndStrain levels_of_contacts(const SectorFrame& f, const SectorPlan& plan, const ContactPass& pass) {
    return contact_levels(SectorView<SectorPair>(f, plan.contacts), pass);
}

/// Adds the forces of remainder elements to their nodes, one by one.
HWY_INLINE void scatter_add_remainder(const Components& from, const Components& to,
                                      const std::vector<RemainderPull>& pulls) {
    for (const RemainderPull& p : pulls) {
        const std::size_t a = p.from, b = p.to;
        to[0][b] += p.sign * from[0][a];
        to[1][b] += p.sign * from[1][a];
        to[2][b] += p.sign * from[2][a];
    }
}

using Register = hn::Vec<Tag>;

/// x, y and z of a register of nodes, one of several interleaved ones.
struct Sum3 {
    Register x, y, z;

    HWY_INLINE void add(const Components& from, std::int32_t at) {
        x = hn::Add(x, hn::LoadU(tag, from[0] + at));
        y = hn::Add(y, hn::LoadU(tag, from[1] + at));
        z = hn::Add(z, hn::LoadU(tag, from[2] + at));
    }
    HWY_INLINE void subtract(const Components& from, std::int32_t at) {
        x = hn::Sub(x, hn::LoadU(tag, from[0] + at));
        y = hn::Sub(y, hn::LoadU(tag, from[1] + at));
        z = hn::Sub(z, hn::LoadU(tag, from[2] + at));
    }
    HWY_INLINE void go_to(Vec3s& all, int way) const {
        all.x.raw[way] = x;
        all.y.raw[way] = y;
        all.z.raw[way] = z;
    }
};
HWY_INLINE Sum3 none() {
    const Register zero = hn::Zero(tag);
    return {zero, zero, zero};
}
/// Forces of remainder elements on such a register, which is cleared.
HWY_INLINE Sum3 taken(const Components& from, std::int32_t at) {
    const Sum3 sum{hn::LoadU(tag, from[0] + at), hn::LoadU(tag, from[1] + at), hn::LoadU(tag, from[2] + at)};
    for (double* component : from)
        hn::StoreU(hn::Zero(tag), tag, component + at);
    return sum;
}

/// Forces on nodes.
struct ForcesOn {
    Vec3s pull, push, aero;
};

/// Forces on the nodes of interleaved registers.
HWY_INLINE ForcesOn forces_on(const SectorFrame& f, const SectorPlan& plan, const NodeSources* sources,
                              std::int32_t node) {
    ForcesOn forces;
    const std::int32_t* const from = plan.sources.data();
    for (int way = 0; way < unroll_factor; ++way) {
        const NodeSources& s = sources[way];
        const std::int32_t at = node + way * lanes_of_register;
        Sum3 pull = none(), push = none(), aero = none();
        if (s.extra) {
            pull = taken(f.pull, at);
            push = taken(f.push, at);
            aero = taken(f.aero, at);
        }
        for (std::int32_t k = s.plus; k < s.minus; ++k)
            pull.add(f.element_force, from[k]);
        for (std::int32_t k = s.minus; k < s.push; ++k)
            pull.subtract(f.element_force, from[k]);
        for (std::int32_t k = s.push; k < s.aero; ++k)
            push.add(f.element_force, from[k]);
        for (std::int32_t k = s.aero; k < s.cord_plus; ++k)
            aero.add(f.element_force, from[k]);
        pull.go_to(forces.pull, way);
        push.go_to(forces.push, way);
        aero.go_to(forces.aero, way);
    }
    return forces;
}
HWY_INLINE Vec3s cords_on(const SectorFrame& f, const SectorPlan& plan, const NodeSources* sources,
                          std::int32_t node) {
    Vec3s pull;
    const std::int32_t* const from = plan.sources.data();
    for (int way = 0; way < unroll_factor; ++way) {
        const NodeSources& s = sources[way];
        Sum3 of_way = none();
        if (s.remainder_cord) of_way = taken(f.cord_pull, node + way * lanes_of_register);
        for (std::int32_t k = s.cord_plus; k < s.cord_minus; ++k)
            of_way.add(f.element_force, from[k]);
        for (std::int32_t k = s.cord_minus; k < s.end; ++k)
            of_way.subtract(f.element_force, from[k]);
        of_way.go_to(pull, way);
    }
    return pull;
}
/// Whether a cord acts on one of them.
HWY_INLINE bool has_cord(const NodeSources* sources) {
    bool found = false;
    for (int way = 0; way < unroll_factor; ++way)
        found = found || sources[way].cord_plus < sources[way].end || sources[way].remainder_cord;
    return found;
}

/// Interleaved registers of nodes: work(the first's sources, the first node).
template <class Work>
HWY_INLINE void for_nodes(const std::vector<NodeSources>& sources, Work&& work) {
    for (std::size_t k = 0; k < sources.size(); k += unroll_factor)
        work(&sources[k], static_cast<std::int32_t>(k * lanes_of_register));
}

HWY_INLINE Vec3s turned(Vec3s a, Vec cosine, Vec sine) {
    return {cosine * a.x - sine * a.y, sine * a.x + cosine * a.y, a.z};
}

HWY_INLINE void renew(const SectorFrame& f, const std::vector<NodeCopy>& copies) {
    const Components x = f.x, v = f.v;
    for (const NodeCopy& copy : copies) {
        const std::size_t to = copy.copy, from = copy.node;
        x[0][to] = x[0][from];
        x[1][to] = x[1][from];
        x[2][to] = x[2][from];
        v[0][to] = v[0][from];
        v[1][to] = v[1][from];
        v[2][to] = v[2][from];
    }
}

void refresh(const SectorFrame& f, const SectorPlan& plan) {
    const SeamHalo& halo = plan.halo;
    const Vec cosine = all(halo.cosine), sine = all(halo.sine);
    for (const Components* array : {&f.x, &f.v}) {
        const Components& a = *array;
        // The last register reaches over copies, which are renewed next.
        for (std::int32_t n = 0; n < halo.nodes; n += lanes_of_all) {
            const Vec3s turned_node = turned(anywhere3(a, halo.seam + n), cosine, sine);
            put_anywhere(turned_node.x, a[0] + halo.first + n);
            put_anywhere(turned_node.y, a[1] + halo.first + n);
            put_anywhere(turned_node.z, a[2] + halo.first + n);
        }
    }
    renew(f, plan.copies);
    renew(f, plan.cord_copies);
}

SectorSums advance(const SectorFrame& f, const SectorPlan& plan, const SectorAdvance& step) {
    scatter_add_remainder(f.element_force, f.pull, plan.remainder_triangles);
    scatter_add_remainder(f.element_force, f.pull, plan.remainder_tapes);
    scatter_add_remainder(f.element_force, f.cord_pull, plan.remainder_cords);
    scatter_add_remainder(f.element_force, f.pull, plan.remainder_contacts);
    scatter_add_remainder(f.element_force, f.push, plan.remainder_pushes);
    scatter_add_remainder(f.element_force, f.aero, plan.remainder_lines);

    const Vec zero = all(0.0);
    const SeamHalo& halo = plan.halo;
    const Vec cosine = all(halo.cosine), back = all(-halo.sine);
    for_nodes(halo.sources, [&](const NodeSources* sources, std::int32_t n) HWY_ATTR {
        const ForcesOn on = forces_on(f, plan, sources, halo.first + n);
        put3(turned(on.pull, cosine, back), f.element_force, halo.pull + n);
        put3(turned(on.push, cosine, back), f.element_force, halo.push + n);
    });

    const Vec kick = all(step.kick), dt = all(step.dt), half_dt = all(0.5 * step.dt);
    const Vec first_kick = all(step.first.kick), shorter = all(step.first.dt - step.dt),
              half_first = all(0.5 * step.first.dt), later = all(step.only ? 0.0 : 1.0);
    const Vec pressure = all(step.pressure), on_fabric = all(step.on_fabric), gravity = all(step.gravity);
    const Vec added_mass = all(step.added_mass);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    Vec drag_power = zero, momentum = zero, share_square = zero, dissipated = zero, accretion_power = zero;
    Vec kinetic_twice = zero;
    // Not by for_nodes: what it sums up would lie in memory.
    for (std::size_t r = 0; r < plan.own.size(); r += unroll_factor) {
        const NodeSources* const sources = &plan.own[r];
        const auto n = static_cast<std::int32_t>(r * lanes_of_register);
        const ForcesOn on = forces_on(f, plan, sources, n);
        const Vec mass = load(k.mass + n), share = load(k.share + n), canopy = load(k.canopy_mass + n);
        Vec3s aero = on.aero + pressure * on.push;
        aero.z += share * on_fabric;
        Vec3s force = on.pull;
        const Vec3s v = aligned3(f.v, n);
        if (step.breathing > 0.0)
            resist(share * all(step.breathing), Vec3s{v.x, v.y, v.z - all(step.canopy_mean)}, force,
                   dissipated);
        if (step.accretion > 0.0)
            accrete(share * all(step.accretion), Vec3s{zero, zero, zero}, v, force, accretion_power);
        if (step.mass_damping > 0.0)
            resist(mass * all(step.mass_damping), Vec3s{v.x, v.y, v.z - all(step.system_mean)}, force,
                   dissipated);
        Vec3s total = force + aero;
        total.z = total.z - mass * gravity;
        const Vec inverse = all(1.0) / (load(k.inertia + n) + share * added_mass);
        const Vec across = inverse * load(k.across + n), along = inverse * load(k.along + n);
        const Vec3s acceleration{across * total.x, across * total.y, along * total.z};
        const Vec3s before = aligned3(f.v_half, n);
        Vec3s after = kicked(before, acceleration, kick), now = half_dt * acceleration;
        Vec time = dt, over = all(1.0);
        Vec3s change = all(step.last_dt) * acceleration;  // over the step that led here
        if (has_cord(sources)) {
            const Vec on_cord = load(k.on_cord + n);
            const Vec3s pull = cords_on(f, plan, sources, n);
            const Vec3s by_cords{across * pull.x, across * pull.y, along * pull.z};
            over = over - later * on_cord;
            put3(on_cord * acceleration, f.slow, n);
            store(inverse, f.inverse + n);
            after += first_kick * by_cords;
            now = over * now + half_first * by_cords;
            time += on_cord * shorter;
            change += all(step.last_line_dt) * by_cords;
        }
        const Vec3s middle = middle_of(before, after);
        if (step.weighs) {
            Vec3s booked = aero;
            booked.z = booked.z - mass * gravity;
            kinetic_twice +=
                twice_kinetic(mass + share * added_mass, before, change, all(step.last_dt), booked, middle);
        }
        const Vec3s x = aligned3(f.x, n) + time * after;
        now += after;
        put3(after, f.v_half, n);
        put3(x, f.x, n);
        put3(now, f.v, n);
        momentum += mass * middle.z;
        drag_power += work(aero, middle);
        share_square += share * work(middle, middle);
        canopy_position += over * canopy * x.z;
        canopy_velocity += over * canopy * now.z;
        position += over * mass * x.z;
        velocity += over * mass * now.z;
        area_velocity += over * share * now.z;
    }

    SectorSums sums;
    sums.canopy_position = sum(canopy_position);
    sums.canopy_velocity = sum(canopy_velocity);
    sums.other_position = sum(position) - sums.canopy_position;
    sums.other_velocity = sum(velocity) - sums.canopy_velocity;
    sums.area_velocity = sum(area_velocity);
    sums.drag_power = sum(drag_power);
    sums.momentum = sum(momentum);
    sums.share_square = sum(share_square);
    sums.dissipated = sum(dissipated);
    sums.accretion_power = sum(accretion_power);
    sums.kinetic = 0.5 * sum(kinetic_twice);
    return sums;
}

SectorSums subcycle(const SectorFrame& f, const SectorPlan& plan, const SectorSubcycle& subcycle) {
    renew(f, plan.cord_copies);
    const ElementSums of_cords = cables(f, plan.cords, f.cord);
    scatter_add_remainder(f.element_force, f.cord_pull, plan.remainder_cords);
    const Vec zero = all(0.0), kick = all(subcycle.step.kick), dt = all(subcycle.step.dt),
              half_dt = all(0.5 * subcycle.step.dt), half_step = all(subcycle.half_step);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    for (const std::int32_t n : plan.on_cord) {
        const Vec on_cord = load(k.on_cord + n), elsewhere = 1.0 - on_cord;
        const Vec3s pull = cords_on(f, plan, &plan.own[n / lanes_of_register], n);
        const Vec inverse = load(f.inverse + n);
        const Vec across = inverse * load(k.across + n), along = inverse * load(k.along + n);
        const Vec3s acceleration{across * pull.x, across * pull.y, along * pull.z};
        const Vec3s after = kicked(aligned3(f.v_half, n), acceleration, kick);
        const Vec3s x = aligned3(f.x, n) + (dt * on_cord) * after;
        const Vec3s now = on_cord * (after + half_dt * acceleration + half_step * aligned3(f.slow, n)) +
                          elsewhere * aligned3(f.v, n);
        put3(after, f.v_half, n);
        put3(x, f.x, n);
        put3(now, f.v, n);
        const Vec mass = on_cord * load(k.mass + n), canopy = on_cord * load(k.canopy_mass + n);
        canopy_position += canopy * x.z;
        canopy_velocity += canopy * now.z;
        position += mass * x.z;
        velocity += mass * now.z;
        area_velocity += on_cord * load(k.share + n) * now.z;
    }
    SectorSums sums;
    sums.dissipated = of_cords.dissipated;
    sums.largest_tension = of_cords.largest_load;
    if (!(subcycle.half_step > 0.0)) return sums;
    sums.canopy_position = sum(canopy_position);
    sums.canopy_velocity = sum(canopy_velocity);
    sums.other_position = sum(position) - sums.canopy_position;
    sums.other_velocity = sum(velocity) - sums.canopy_velocity;
    sums.area_velocity = sum(area_velocity);
    return sums;
}

SectorBounds critical_step(const SectorFrame& f, const SectorPlan& plan, double added_mass,
                           double damping_by_share, double damping_by_mass) {
    membrane_rows(SectorView<SectorTriangle>(f, plan.triangles));
    for (int what = 0; what < 2; ++what)
        for (const RemainderPull& p : plan.remainder_triangles)
            f.row_extra[what][p.to] += f.element_rows[what][p.from];
    const auto rows_of = [&](const NodeSources* sources, int what, std::int32_t node) HWY_ATTR {
        Vec rows;
        for (int way = 0; way < unroll_factor; ++way) {
            const NodeSources& s = sources[way];
            Register row = hn::Zero(tag);
            if (s.extra) {
                double* const extra = f.row_extra[what] + node + way * lanes_of_register;
                row = hn::LoadU(tag, extra);
                hn::StoreU(hn::Zero(tag), tag, extra);
            }
            for (std::int32_t k = s.plus; k < s.push; ++k)
                row = hn::Add(row, hn::LoadU(tag, f.element_rows[what] + plan.sources[k]));
            rows.raw[way] = row;
        }
        return rows;
    };
    const SeamHalo& halo = plan.halo;
    for_nodes(halo.sources, [&](const NodeSources* sources, std::int32_t n) HWY_ATTR {
        for (int what = 0; what < 2; ++what)
            store(rows_of(sources, what, halo.first + n), f.element_rows[what] + halo.pull + n);
    });
    const NodeRows& k = f.node;
    const Vec one = all(1.0);
    Vec shortest = all(HUGE_VAL), of_canopy = shortest;
    for_nodes(plan.own, [&](const NodeSources* s, std::int32_t n) HWY_ATTR {
        const Vec mass = load(k.mass + n), share = load(k.share + n);
        const Vec inverse = load(k.along + n) / (load(k.inertia + n) + share * all(added_mass));
        const Vec stiffness = inverse * (rows_of(s, 0, n) + load(k.stiffness + n));
        const Vec damping = inverse * (rows_of(s, 1, n) + load(k.damping + n) +
                                       all(damping_by_share) * share + all(damping_by_mass) * mass);
        // In this order: a node without a number must not hide what the others say.
        of_canopy = smaller(critical_step(stiffness, damping, one), of_canopy);
        shortest = smaller(critical_step(stiffness + inverse * load(k.cord_stiffness + n),
                                         damping + inverse * load(k.cord_damping + n), one),
                           shortest);
    });
    return {least(shortest), least(of_canopy)};
}

double kinetic(const SectorFrame& f, const SectorPlan& plan, double added_mass) {
    Vec twice = all(0.0);
    for_nodes(plan.own, [&](const NodeSources*, std::int32_t n) HWY_ATTR {
        const Vec3s v = aligned3(f.v, n);
        twice += (load(f.node.mass + n) + load(f.node.share + n) * all(added_mass)) * dot(v, v);
    });
    return 0.5 * sum(twice);
}

}  // namespace

SectorKernels sector_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes_of_register,
            unroll_factor,
            {nullptr, triangles<AirOnFabric::pushes>, triangles<AirOnFabric::fills>},
            cables,
            contacts,
            levels_of_contacts,
            line_drag,
            advance,
            subcycle,
            refresh,
            critical_step,
            levels_of_triangles,
            levels_of_cables,
            kinetic};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twinchute::fullsim {

std::span<const SectorKernels> all_sector_kernels() {
    static const std::vector<SectorKernels> sets =
        TWINCHUTE_SETS_OF_THIS_MACHINE(SectorKernels, sector_kernels_here);
    return sets;
}

const SectorKernels& sector_kernels() {
    return all_sector_kernels().front();
}

}  // namespace twinchute::fullsim
#endif
