#include "fullsim/sector/kernels.hpp"

#include <cmath>

#include "fullsim/lanes/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/sector/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/forces/cable_kernel.hpp"
#include "fullsim/forces/contact_kernel.hpp"
#include "fullsim/forces/membrane_kernel.hpp"
#include "fullsim/lanes/vec.hpp"

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
    for (int k = 0; k < ways; ++k)
        hn::StoreU(a.raw[k], tag, to + k * lanes_of_register);
}

/// Stretches hand in hand: work(the first of them, place of their constants).
template <class Stretch, class Work>
HWY_INLINE void for_stretches(const std::vector<Stretch>& stretches, Work&& work) {
    for (std::size_t k = 0; k < stretches.size(); k += ways)
        work(&stretches[k], static_cast<std::int32_t>(k * lanes_of_register));
}
/// What the corners of each have.
template <class Stretch>
HWY_INLINE Vec3s corner(const Components& from, const Stretch* s, int c) {
    Vec3s at;
    for (int k = 0; k < ways; ++k) {
        at.x.raw[k] = hn::LoadU(tag, from[0] + s[k].node[c]);
        at.y.raw[k] = hn::LoadU(tag, from[1] + s[k].node[c]);
        at.z.raw[k] = hn::LoadU(tag, from[2] + s[k].node[c]);
    }
    return at;
}
template <class Stretch>
HWY_INLINE void put_stream(Vec a, double* to, const Stretch* s, int which) {
    for (int k = 0; k < ways; ++k)
        hn::Store(a.raw[k], tag, to + s[k].stream[which]);
}
template <class Stretch>
HWY_INLINE void put_stream(Vec3s a, const Components& to, const Stretch* s, int which) {
    put_stream(a.x, to[0], s, which);
    put_stream(a.y, to[1], s, which);
    put_stream(a.z, to[2], s, which);
}

FabricSums triangles(const SectorFrame& f, const SectorPlan& plan, const MembraneLaw& law,
                     const SectorAir& air) {
    const Vec zero = all(0.0), up = all(air.direction);
    const Vec third = all(air.direction / 3.0), radial = all(air.radial_pressure / 3.0);
    const TriangleConstants& k = f.triangle;
    Vec positive = zero, all_area = zero, dissipated = zero, largest = zero;
    for_stretches(plan.triangles, [&](const TriangleStretch* s, std::int32_t at) HWY_ATTR {
        const Vec3s x0 = corner(f.x, s, 0), v0 = corner(f.v, s, 0);
        const Vec3s e1 = corner(f.x, s, 1) - x0, e2 = corner(f.x, s, 2) - x0;
        const Vec3s w1 = corner(f.v, s, 1) - v0, w2 = corner(f.v, s, 2) - v0;
        const auto pulls =
            membrane_pulls(law, load(k.inverse_a + at), load(k.inverse_c + at), load(k.b_over_a + at),
                           load(k.area + at), load(k.viscosity + at), e1, e2, w1, w2);
        dissipated += pulls.dissipated;
        largest = larger(pulls.stress, largest);
        put_stream(pulls.on_first, f.stream, s, 0);
        put_stream(pulls.on_second, f.stream, s, 1);
        put_stream(pulls.on_third, f.stream, s, 2);
        // A third of A_p e_r + phi (A - (A.e_r) e_r) to each corner, e_r along the axis.
        const Vec3s area = load(k.half + at) * cross(e1, e2);
        const Vec along = area.z * up;
        const Vec swept = larger(along, zero);
        positive += swept;
        all_area += along;
        put_stream(Vec3s{radial * area.x, radial * area.y, third * swept}, f.stream, s, 3);
    });
    const double lost = sum(dissipated);
    return {sum(positive), sum(all_area), lost, greatest_or_none(largest, lost)};
}

FabricSums cables(const SectorFrame& f, const std::vector<CableStretch>& stretches,
                  const CableConstantsRow& k) {
    Vec dissipated = all(0.0), largest = dissipated;
    for_stretches(stretches, [&](const CableStretch* s, std::int32_t at) HWY_ATTR {
        const Vec3s d = corner(f.x, s, 1) - corner(f.x, s, 0);
        const Vec3s w = corner(f.v, s, 1) - corner(f.v, s, 0);
        const auto pull =
            cable_pull(load(k.inverse_length + at), load(k.stiffness + at), load(k.dashpot + at), d, w);
        dissipated += pull.dissipated;
        largest = larger(load(k.line + at) * pull.spring, largest);
        put_stream(pull.force, f.stream, s, 0);
    });
    const double lost = sum(dissipated);
    return {0.0, 0.0, lost, greatest_or_none(largest, lost)};
}

/// Where the axis is.
HWY_INLINE ContactPush<Vec, Vec3s> push_of(const SectorFrame& f, const ContactStretch* s, std::int32_t at,
                                           Vec3s axis) {
    const Vec3s x0 = corner(f.x, s, 0), x1 = corner(f.x, s, 1);
    // Places along the axis do not matter.
    const auto arm = contact_arm(all(0.0), axis, {x0.x, x0.y, all(0.0)}, x1 - x0);
    return contact_push(load(f.contact + at), axis, arm);
}

void contacts(const SectorFrame& f, const SectorPlan& plan, double upwards) {
    const Vec3s axis{all(0.0), all(0.0), all(upwards)};
    for_stretches(plan.contacts, [&](const ContactStretch* s, std::int32_t at) HWY_ATTR {
        const auto push = push_of(f, s, at, axis);
        put_stream(push.half_of_middle - push.apart, f.stream, s, 0);
        put_stream(push.half_of_middle + push.apart, f.stream, s, 1);
    });
}

ElementLevels contact_levels(const SectorFrame& f, const SectorPlan& plan, double upwards) {
    const Vec3s axis{all(0.0), all(0.0), all(upwards)};
    Vec energy = all(0.0);
    for_stretches(plan.contacts, [&](const ContactStretch* s, std::int32_t at)
                                     HWY_ATTR { energy += push_of(f, s, at, axis).energy; });
    return {sum(energy), 0.0};
}

void line_drag(const SectorFrame& f, const SectorPlan& plan, const CylinderDragTable& table, double diameter,
               double density, double viscosity) {
    const CylinderDrag drag(table, diameter, density, viscosity);
    for_stretches(plan.lines, [&](const CableStretch* s, std::int32_t at) HWY_ATTR {
        const Vec3s d = corner(f.x, s, 1) - corner(f.x, s, 0);
        const Vec3s v = -0.5 * (corner(f.v, s, 0) + corner(f.v, s, 1));
        put_stream(load(f.line + at) * drag.on_end(d, v), f.stream, s, 0);
    });
}

/// What loose elements do to nodes, one by one.
HWY_INLINE void carry(const Components& from, const Components& to, const std::vector<LoosePull>& pulls) {
    for (const LoosePull& p : pulls) {
        const std::size_t a = p.from, b = p.to;
        to[0][b] += p.sign * from[0][a];
        to[1][b] += p.sign * from[1][a];
        to[2][b] += p.sign * from[2][a];
    }
}

using Register = hn::Vec<Tag>;

/// x, y and z of a register of nodes, one of those hand in hand.
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
/// What loose elements have done to such a register, which is cleared.
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

/// On registers that go hand in hand.
HWY_INLINE ForcesOn forces_on(const SectorFrame& f, const SectorPlan& plan, const NodeSources* sources,
                              std::int32_t node) {
    ForcesOn forces;
    const std::int32_t* const from = plan.sources.data();
    for (int way = 0; way < ways; ++way) {
        const NodeSources& s = sources[way];
        const std::int32_t at = node + way * lanes_of_register;
        Sum3 pull = none(), push = none(), aero = none();
        if (s.extra) {
            pull = taken(f.pull, at);
            push = taken(f.push, at);
            aero = taken(f.aero, at);
        }
        for (std::int32_t k = s.plus; k < s.minus; ++k)
            pull.add(f.stream, from[k]);
        for (std::int32_t k = s.minus; k < s.push; ++k)
            pull.subtract(f.stream, from[k]);
        for (std::int32_t k = s.push; k < s.aero; ++k)
            push.add(f.stream, from[k]);
        for (std::int32_t k = s.aero; k < s.cord_plus; ++k)
            aero.add(f.stream, from[k]);
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
    for (int way = 0; way < ways; ++way) {
        const NodeSources& s = sources[way];
        Sum3 of_way = none();
        if (s.loose_cord) of_way = taken(f.cord_pull, node + way * lanes_of_register);
        for (std::int32_t k = s.cord_plus; k < s.cord_minus; ++k)
            of_way.add(f.stream, from[k]);
        for (std::int32_t k = s.cord_minus; k < s.end; ++k)
            of_way.subtract(f.stream, from[k]);
        of_way.go_to(pull, way);
    }
    return pull;
}
/// Whether a cord acts on one of them.
HWY_INLINE bool has_cord(const NodeSources* sources) {
    bool found = false;
    for (int way = 0; way < ways; ++way)
        found = found || sources[way].cord_plus < sources[way].end || sources[way].loose_cord;
    return found;
}

/// Registers of nodes hand in hand: work(the first's sources, the first node).
template <class Work>
HWY_INLINE void for_nodes(const std::vector<NodeSources>& sources, Work&& work) {
    for (std::size_t k = 0; k < sources.size(); k += ways)
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
    const SeamImages& images = plan.images;
    const Vec cosine = all(images.cosine), sine = all(images.sine);
    for (const Components* array : {&f.x, &f.v}) {
        const Components& a = *array;
        // The last register reaches over copies, which are renewed next.
        for (std::int32_t n = 0; n < images.nodes; n += lanes_of_all) {
            const Vec3s image = turned(anywhere3(a, images.seam + n), cosine, sine);
            put_anywhere(image.x, a[0] + images.image + n);
            put_anywhere(image.y, a[1] + images.image + n);
            put_anywhere(image.z, a[2] + images.image + n);
        }
    }
    renew(f, plan.copies);
    renew(f, plan.cord_copies);
}

SectorSums advance(const SectorFrame& f, const SectorPlan& plan, const SectorAdvance& step) {
    carry(f.stream, f.pull, plan.loose_triangles);
    carry(f.stream, f.pull, plan.loose_tapes);
    carry(f.stream, f.cord_pull, plan.loose_cords);
    carry(f.stream, f.pull, plan.loose_contacts);
    carry(f.stream, f.push, plan.loose_pushes);
    carry(f.stream, f.aero, plan.loose_lines);

    const Vec zero = all(0.0), half = all(0.5);
    const SeamImages& images = plan.images;
    const Vec cosine = all(images.cosine), back = all(-images.sine);
    for_nodes(images.sources, [&](const NodeSources* sources, std::int32_t n) HWY_ATTR {
        const ForcesOn on = forces_on(f, plan, sources, images.image + n);
        put3(turned(on.pull, cosine, back), f.stream, images.pull + n);
        put3(turned(on.push, cosine, back), f.stream, images.push + n);
    });

    const Vec kick = all(step.kick), dt = all(step.dt), half_dt = all(0.5 * step.dt);
    const Vec first_kick = all(step.first.kick), shorter = all(step.first.dt - step.dt),
              half_first = all(0.5 * step.first.dt), later = all(step.only ? 0.0 : 1.0);
    const Vec pressure = all(step.pressure), flag = all(step.flag), gravity = all(step.gravity);
    const Vec added_mass = all(step.added_mass);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    Vec drag_power = zero, momentum = zero, share_square = zero, dissipated = zero, accretion_power = zero;
    Vec twice_kinetic = zero;
    // Not by for_nodes: what it sums up would lie in memory.
    for (std::size_t r = 0; r < plan.own.size(); r += ways) {
        const NodeSources* const sources = &plan.own[r];
        const auto n = static_cast<std::int32_t>(r * lanes_of_register);
        const ForcesOn on = forces_on(f, plan, sources, n);
        const Vec mass = load(k.mass + n), share = load(k.share + n), canopy = load(k.canopy_mass + n);
        Vec3s aero = on.aero + pressure * on.push;
        aero.z += share * flag;
        Vec3s force = on.pull;
        const Vec3s v = aligned3(f.v, n);
        if (step.breathing > 0.0) {
            const Vec3s relative{v.x, v.y, v.z - all(step.breathing_mean)};
            const Vec3s resistance = (share * all(step.breathing)) * relative;
            force = force - resistance;
            dissipated += dot(resistance, relative);
        }
        if (step.accretion > 0.0) {
            const Vec3s resistance = (share * all(step.accretion)) * v;
            force = force - resistance;
            accretion_power += -dot(resistance, v);
        }
        if (step.alpha > 0.0) {
            const Vec3s relative{v.x, v.y, v.z - all(step.mean)};
            const Vec3s resistance = (mass * all(step.alpha)) * relative;
            force = force - resistance;
            dissipated += dot(resistance, relative);
        }
        Vec3s total = force + aero;
        total.z = total.z - mass * gravity;
        const Vec inverse = all(1.0) / (load(k.inertia + n) + share * added_mass);
        const Vec across = inverse * load(k.across + n), along = inverse * load(k.along + n);
        const Vec3s acceleration{across * total.x, across * total.y, along * total.z};
        const Vec3s before = aligned3(f.v_half, n);
        Vec3s after = before + kick * acceleration, now = half_dt * acceleration;
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
        const Vec3s middle = half * (before + after);  // velocity at t, exact for the energy balance
        if (step.weighs) {
            Vec3s booked = aero;
            booked.z = booked.z - mass * gravity;
            twice_kinetic += (mass + share * added_mass) * dot(before, before + change) +
                             all(step.last_dt) * dot(booked, middle - before);
        }
        const Vec3s x = aligned3(f.x, n) + time * after;
        now += after;
        put3(after, f.v_half, n);
        put3(x, f.x, n);
        put3(now, f.v, n);
        momentum += mass * middle.z;
        drag_power += dot(aero, middle);
        share_square += share * dot(middle, middle);
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
    sums.kinetic = 0.5 * sum(twice_kinetic);
    return sums;
}

SectorSums substep(const SectorFrame& f, const SectorPlan& plan, const SectorSubstep& substep) {
    renew(f, plan.cord_copies);
    const FabricSums of_cords = cables(f, plan.cords, f.cord);
    carry(f.stream, f.cord_pull, plan.loose_cords);
    const Vec zero = all(0.0), kick = all(substep.step.kick), dt = all(substep.step.dt),
              half_dt = all(0.5 * substep.step.dt), half_step = all(substep.half_step);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    for (const std::int32_t n : plan.on_cord) {
        const Vec on_cord = load(k.on_cord + n), elsewhere = 1.0 - on_cord;
        const Vec3s pull = cords_on(f, plan, &plan.own[n / lanes_of_register], n);
        const Vec inverse = load(f.inverse + n);
        const Vec across = inverse * load(k.across + n), along = inverse * load(k.along + n);
        const Vec3s acceleration{across * pull.x, across * pull.y, along * pull.z};
        const Vec3s after = aligned3(f.v_half, n) + kick * acceleration;
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
    if (!(substep.half_step > 0.0)) return sums;
    sums.canopy_position = sum(canopy_position);
    sums.canopy_velocity = sum(canopy_velocity);
    sums.other_position = sum(position) - sums.canopy_position;
    sums.other_velocity = sum(velocity) - sums.canopy_velocity;
    sums.area_velocity = sum(area_velocity);
    return sums;
}

/// As a triangle stands: its strain in its own plane.
HWY_INLINE SymmetricTensor<Vec> strain_of(const SectorFrame& f, const TriangleStretch* s, std::int32_t at) {
    const TriangleConstants& k = f.triangle;
    const Vec3s x0 = corner(f.x, s, 0), e1 = corner(f.x, s, 1) - x0, e2 = corner(f.x, s, 2) - x0;
    const Vec3s f1 = load(k.inverse_a + at) * e1;
    const Vec3s f2 = load(k.inverse_c + at) * (e2 - load(k.b_over_a + at) * e1);
    return {0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0), 0.5 * dot(f1, f2)};
}

SectorBounds stable_step(const SectorFrame& f, const SectorPlan& plan, double added_mass,
                         double damping_by_share, double damping_by_mass) {
    for_stretches(plan.triangles, [&](const TriangleStretch* s, std::int32_t at) HWY_ATTR {
        const Vec stretch = larger(principal(strain_of(f, s, at)).first(), all(0.0));
        // As Membrane::add_row_sums.
        const Vec stiffening = 1.0 + 3.0 * stretch, lengthening = 1.0 + 2.0 * stretch;
        for (int c = 0; c < 3; ++c) {
            put_stream(stiffening * load(f.triangle.stiffness[c] + at), f.row_stream[0], s, c);
            put_stream(lengthening * load(f.triangle.damping[c] + at), f.row_stream[1], s, c);
        }
    });
    for (int what = 0; what < 2; ++what)
        for (const LoosePull& p : plan.loose_triangles)
            f.row_extra[what][p.to] += f.row_stream[what][p.from];
    const auto rows_of = [&](const NodeSources* sources, int what, std::int32_t node) HWY_ATTR {
        Vec rows;
        for (int way = 0; way < ways; ++way) {
            const NodeSources& s = sources[way];
            Register row = hn::Zero(tag);
            if (s.extra) {
                double* const extra = f.row_extra[what] + node + way * lanes_of_register;
                row = hn::LoadU(tag, extra);
                hn::StoreU(hn::Zero(tag), tag, extra);
            }
            for (std::int32_t k = s.plus; k < s.push; ++k)
                row = hn::Add(row, hn::LoadU(tag, f.row_stream[what] + plan.sources[k]));
            rows.raw[way] = row;
        }
        return rows;
    };
    const SeamImages& images = plan.images;
    for_nodes(images.sources, [&](const NodeSources* sources, std::int32_t n) HWY_ATTR {
        for (int what = 0; what < 2; ++what)
            store(rows_of(sources, what, images.image + n), f.row_stream[what] + images.pull + n);
    });
    const NodeRows& k = f.node;
    const auto bound = [](Vec stiffness, Vec damping) HWY_ATTR {
        return all(2.0) / (square_root(damping * damping + stiffness) + damping + 1e-300);
    };
    Vec shortest = all(HUGE_VAL), of_canopy = shortest;
    for_nodes(plan.own, [&](const NodeSources* s, std::int32_t n) HWY_ATTR {
        const Vec mass = load(k.mass + n), share = load(k.share + n);
        const Vec inverse = load(k.along + n) / (load(k.inertia + n) + share * all(added_mass));
        const Vec stiffness = inverse * (rows_of(s, 0, n) + load(k.stiffness + n));
        const Vec damping = inverse * (rows_of(s, 1, n) + load(k.damping + n) +
                                       all(damping_by_share) * share + all(damping_by_mass) * mass);
        // In this order: a node without a number must not hide what the others say.
        of_canopy = smaller(bound(stiffness, damping), of_canopy);
        shortest = smaller(bound(stiffness + inverse * load(k.cord_stiffness + n),
                                 damping + inverse * load(k.cord_damping + n)),
                           shortest);
    });
    return {least(shortest), least(of_canopy)};
}

ElementLevels fabric_levels(const SectorFrame& f, const SectorPlan& plan, const MembraneLaw& law) {
    Vec energy = all(0.0), strain = all(0.0);
    for_stretches(plan.triangles, [&](const TriangleStretch* s, std::int32_t at) HWY_ATTR {
        const auto p = principal(strain_of(f, s, at));
        energy += load(f.triangle.area + at) * relaxed_energy(law, p);
        // A register that is filled up with no triangles shows no strain.
        strain = larger(2.0 * load(f.triangle.half + at) * p.first(), strain);
    });
    return {sum(energy), greatest(strain)};
}

ElementLevels cable_levels(const SectorFrame& f, const std::vector<CableStretch>& stretches,
                           const CableConstantsRow& k) {
    Vec energy = all(0.0), largest = all(-1.0);
    for_stretches(stretches, [&](const CableStretch* s, std::int32_t at) HWY_ATTR {
        const Vec3s d = corner(f.x, s, 1) - corner(f.x, s, 0);
        const Vec square = dot(d, d) + 1e-18;
        const Vec strain = square * inverse_root(square) * load(k.inverse_length + at) - 1.0;
        const Vec taut = larger(strain, all(0.0));
        energy += (0.5 * load(k.stiffness + at) * load(k.length + at)) * taut * taut;
        largest = larger(largest, strain);  // -1 where a register is filled up
    });
    return {sum(energy), greatest(largest)};
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
            ways,
            triangles,
            cables,
            contacts,
            contact_levels,
            line_drag,
            advance,
            substep,
            refresh,
            stable_step,
            fabric_levels,
            cable_levels,
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
