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

/// Registers of a run: work(e, place of their constants).
template <class Run, class Work>
HWY_INLINE void for_registers(const std::vector<Run>& runs, Work&& work) {
    for (const Run& run : runs)
        for (std::int32_t e = 0; e < run.elements; e += lanes_of_all)
            work(run, e, run.first + e);
}

FabricSums triangles(const SectorFrame& f, const SectorPlan& plan, const MembraneLaw& law,
                     const SectorAir& air) {
    const Vec zero = all(0.0), up = all(air.direction);
    const Vec third = all(air.direction / 3.0), radial = all(air.radial_pressure / 3.0);
    const TriangleConstants& k = f.triangle;
    Vec positive = zero, all_area = zero, dissipated = zero, largest = zero;
    for_registers(plan.triangles, [&](const TriangleRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const Vec3s x0 = anywhere3(f.x, run.node[0] + e), v0 = anywhere3(f.v, run.node[0] + e);
        const Vec3s e1 = anywhere3(f.x, run.node[1] + e) - x0, e2 = anywhere3(f.x, run.node[2] + e) - x0;
        const Vec3s w1 = anywhere3(f.v, run.node[1] + e) - v0, w2 = anywhere3(f.v, run.node[2] + e) - v0;
        const auto pulls =
            membrane_pulls(law, load(k.inverse_a + at), load(k.inverse_c + at), load(k.b_over_a + at),
                           load(k.area + at), load(k.viscosity + at), e1, e2, w1, w2);
        dissipated += pulls.dissipated;
        largest = larger(pulls.stress, largest);
        put3(pulls.on_first, f.stream, run.pull[0] + e);
        put3(pulls.on_second, f.stream, run.pull[1] + e);
        put3(pulls.on_third, f.stream, run.pull[2] + e);
        // A third of A_p e_r + phi (A - (A.e_r) e_r) to each corner, e_r along the axis.
        const Vec3s area = load(k.half + at) * cross(e1, e2);
        const Vec along = area.z * up;
        const Vec swept = larger(along, zero);
        positive += swept;
        all_area += along;
        put3({radial * area.x, radial * area.y, third * swept}, f.stream, run.push + e);
    });
    const double lost = sum(dissipated);
    return {sum(positive), sum(all_area), lost, greatest_or_none(largest, lost)};
}

FabricSums cables(const SectorFrame& f, const std::vector<CableRun>& runs) {
    const CableConstantsRow& k = f.cable;
    Vec dissipated = all(0.0), largest = dissipated;
    for_registers(runs, [&](const CableRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const Vec3s d = anywhere3(f.x, run.node[1] + e) - anywhere3(f.x, run.node[0] + e);
        const Vec3s w = anywhere3(f.v, run.node[1] + e) - anywhere3(f.v, run.node[0] + e);
        const auto pull =
            cable_pull(load(k.inverse_length + at), load(k.stiffness + at), load(k.dashpot + at), d, w);
        dissipated += pull.dissipated;
        largest = larger(load(k.line + at) * pull.spring, largest);
        put3(pull.force, f.stream, run.pull + e);
    });
    const double lost = sum(dissipated);
    return {0.0, 0.0, lost, greatest_or_none(largest, lost)};
}

/// Where the axis is.
HWY_INLINE ContactPush<Vec, Vec3s> push_of(const SectorFrame& f, const ContactRun& run, std::int32_t e,
                                           std::int32_t at, Vec3s axis) {
    const Vec3s x0 = anywhere3(f.x, run.node[0] + e), x1 = anywhere3(f.x, run.node[1] + e);
    // Places along the axis do not matter.
    return contact_push(load(f.contact + at), axis, {x0.x, x0.y, all(0.0)}, x1 - x0);
}

void contacts(const SectorFrame& f, const SectorPlan& plan, double upwards) {
    const Vec3s axis{all(0.0), all(0.0), all(upwards)};
    for_registers(plan.contacts, [&](const ContactRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const auto push = push_of(f, run, e, at, axis);
        put3(push.apart, f.stream, run.apart + e);
        put3(push.half_of_middle, f.stream, run.half + e);
    });
}

ElementLevels contact_levels(const SectorFrame& f, const SectorPlan& plan, double upwards) {
    const Vec3s axis{all(0.0), all(0.0), all(upwards)};
    Vec energy = all(0.0);
    for_registers(plan.contacts, [&](const ContactRun& run, std::int32_t e, std::int32_t at)
                                     HWY_ATTR { energy += push_of(f, run, e, at, axis).energy; });
    return {sum(energy), 0.0};
}

void line_drag(const SectorFrame& f, const SectorPlan& plan, const CylinderDragTable& table, double diameter,
               double density, double viscosity) {
    const CylinderDrag drag(table, diameter, density, viscosity);
    for_registers(plan.lines, [&](const CableRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const Vec3s d = anywhere3(f.x, run.node[1] + e) - anywhere3(f.x, run.node[0] + e);
        const Vec3s v = -0.5 * (anywhere3(f.v, run.node[0] + e) + anywhere3(f.v, run.node[1] + e));
        put3(load(f.line + at) * drag.on_end(d, v), f.stream, run.pull + e);
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

/// What they have done to a register of nodes, which is cleared.
HWY_INLINE Vec taken(double* from) {
    const Vec a = load_anywhere(from);
    put_anywhere(all(0.0), from);
    return a;
}
HWY_INLINE Vec3s taken3(const Components& from, std::int32_t at) {
    return {taken(from[0] + at), taken(from[1] + at), taken(from[2] + at)};
}

/// Forces on a register of nodes.
struct ForcesOn {
    Vec3s pull, push, aero;
};

HWY_INLINE ForcesOn forces_on(const SectorFrame& f, const SectorPlan& plan, const NodeSources& s,
                              std::int32_t node) {
    const Vec zero = all(0.0);
    ForcesOn forces{{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    if (s.extra) forces = {taken3(f.pull, node), taken3(f.push, node), taken3(f.aero, node)};
    const std::int32_t* const from = plan.sources.data();
    for (std::int32_t k = s.plus; k < s.minus; ++k)
        forces.pull += anywhere3(f.stream, from[k]);
    for (std::int32_t k = s.minus; k < s.push; ++k)
        forces.pull = forces.pull - anywhere3(f.stream, from[k]);
    for (std::int32_t k = s.push; k < s.aero; ++k)
        forces.push += anywhere3(f.stream, from[k]);
    for (std::int32_t k = s.aero; k < s.cord_plus; ++k)
        forces.aero += anywhere3(f.stream, from[k]);
    return forces;
}
HWY_INLINE Vec3s cords_on(const SectorFrame& f, const SectorPlan& plan, const NodeSources& s,
                          std::int32_t node) {
    const Vec zero = all(0.0);
    Vec3s pull = s.loose_cord ? taken3(f.cord_pull, node) : Vec3s{zero, zero, zero};
    const std::int32_t* const from = plan.sources.data();
    for (std::int32_t k = s.cord_plus; k < s.cord_minus; ++k)
        pull += anywhere3(f.stream, from[k]);
    for (std::int32_t k = s.cord_minus; k < s.end; ++k)
        pull = pull - anywhere3(f.stream, from[k]);
    return pull;
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
    std::int32_t n = 0;
    for (const NodeSources& sources : images.sources) {
        const ForcesOn on = forces_on(f, plan, sources, images.image + n);
        put3(turned(on.pull, cosine, back), f.stream, images.pull + n);
        put3(turned(on.push, cosine, back), f.stream, images.push + n);
        n += lanes_of_all;
    }

    const Vec kick = all(step.kick), dt = all(step.dt), half_dt = all(0.5 * step.dt);
    const Vec first_kick = all(step.first.kick), shorter = all(step.first.dt - step.dt),
              half_first = all(0.5 * step.first.dt), later = all(step.only ? 0.0 : 1.0);
    const Vec pressure = all(step.pressure), flag = all(step.flag), gravity = all(step.gravity);
    const Vec added_mass = all(step.added_mass);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    Vec drag_power = zero, momentum = zero, share_square = zero, dissipated = zero, accretion_power = zero;
    n = 0;
    for (const NodeSources& sources : plan.own) {
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
        if (sources.cord_plus < sources.end || sources.loose_cord) {
            const Vec on_cord = load(k.on_cord + n);
            const Vec3s pull = cords_on(f, plan, sources, n);
            const Vec3s by_cords{across * pull.x, across * pull.y, along * pull.z};
            over = over - later * on_cord;
            put3(on_cord * acceleration, f.slow, n);
            store(inverse, f.inverse + n);
            after += first_kick * by_cords;
            now = over * now + half_first * by_cords;
            time += on_cord * shorter;
        }
        const Vec3s middle = half * (before + after);  // velocity at t, exact for the energy balance
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
        n += lanes_of_all;
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
    return sums;
}

SectorSums substep(const SectorFrame& f, const SectorPlan& plan, const SectorSubstep& substep) {
    renew(f, plan.cord_copies);
    const FabricSums of_cords = cables(f, plan.cords);
    carry(f.stream, f.cord_pull, plan.loose_cords);
    const Vec zero = all(0.0), kick = all(substep.step.kick), dt = all(substep.step.dt),
              half_dt = all(0.5 * substep.step.dt), half_step = all(substep.half_step);
    const NodeRows& k = f.node;
    Vec canopy_position = zero, canopy_velocity = zero, position = zero, velocity = zero,
        area_velocity = zero;
    for (const std::int32_t place : plan.on_cord) {
        const std::int32_t n = place * lanes_of_all;
        const Vec on_cord = load(k.on_cord + n), elsewhere = 1.0 - on_cord;
        const Vec3s pull = cords_on(f, plan, plan.own[place], n);
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
HWY_INLINE SymmetricTensor<Vec> strain_of(const SectorFrame& f, const TriangleRun& run, std::int32_t e,
                                          std::int32_t at) {
    const TriangleConstants& k = f.triangle;
    const Vec3s x0 = anywhere3(f.x, run.node[0] + e);
    const Vec3s e1 = anywhere3(f.x, run.node[1] + e) - x0, e2 = anywhere3(f.x, run.node[2] + e) - x0;
    const Vec3s f1 = load(k.inverse_a + at) * e1;
    const Vec3s f2 = load(k.inverse_c + at) * (e2 - load(k.b_over_a + at) * e1);
    return {0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0), 0.5 * dot(f1, f2)};
}

SectorBounds stable_step(const SectorFrame& f, const SectorPlan& plan, double added_mass,
                         double damping_by_share, double damping_by_mass) {
    for_registers(plan.triangles, [&](const TriangleRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const Vec stretch = larger(principal(strain_of(f, run, e, at)).first(), all(0.0));
        // As Membrane::add_row_sums.
        const Vec stiffening = 1.0 + 3.0 * stretch, lengthening = 1.0 + 2.0 * stretch;
        for (int c = 0; c < 3; ++c) {
            store(stiffening * load(f.triangle.stiffness[c] + at), f.row_stream[0] + run.pull[c] + e);
            store(lengthening * load(f.triangle.damping[c] + at), f.row_stream[1] + run.pull[c] + e);
        }
    });
    for (int what = 0; what < 2; ++what)
        for (const LoosePull& p : plan.loose_triangles)
            f.row_extra[what][p.to] += f.row_stream[what][p.from];
    const auto rows_of = [&](const NodeSources& s, int what, std::int32_t node) HWY_ATTR {
        Vec row = s.extra ? taken(f.row_extra[what] + node) : all(0.0);
        for (std::int32_t k = s.plus; k < s.push; ++k)
            row += load_anywhere(f.row_stream[what] + plan.sources[k]);
        return row;
    };
    const SeamImages& images = plan.images;
    std::int32_t n = 0;
    for (const NodeSources& sources : images.sources) {
        for (int what = 0; what < 2; ++what)
            store(rows_of(sources, what, images.image + n), f.row_stream[what] + images.pull + n);
        n += lanes_of_all;
    }
    const NodeRows& k = f.node;
    const auto bound = [](Vec stiffness, Vec damping) HWY_ATTR {
        return all(2.0) / (square_root(damping * damping + stiffness) + damping + 1e-300);
    };
    Vec shortest = all(HUGE_VAL), of_canopy = shortest;
    n = 0;
    for (const NodeSources& s : plan.own) {
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
        n += lanes_of_all;
    }
    return {least(shortest), least(of_canopy)};
}

ElementLevels fabric_levels(const SectorFrame& f, const SectorPlan& plan, const MembraneLaw& law) {
    Vec energy = all(0.0), strain = all(0.0);
    for_registers(plan.triangles, [&](const TriangleRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const auto p = principal(strain_of(f, run, e, at));
        energy += load(f.triangle.area + at) * relaxed_energy(law, p);
        // A register that is filled up with no triangles shows no strain.
        strain = larger(2.0 * load(f.triangle.half + at) * p.first(), strain);
    });
    return {sum(energy), greatest(strain)};
}

ElementLevels cable_levels(const SectorFrame& f, const std::vector<CableRun>& runs) {
    const CableConstantsRow& k = f.cable;
    Vec energy = all(0.0), largest = all(-1.0);
    for_registers(runs, [&](const CableRun& run, std::int32_t e, std::int32_t at) HWY_ATTR {
        const Vec3s d = anywhere3(f.x, run.node[1] + e) - anywhere3(f.x, run.node[0] + e);
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
    for (std::size_t r = 0; r < plan.own.size(); ++r) {
        const auto n = static_cast<std::int32_t>(r * lanes_of_all);
        const Vec3s v = aligned3(f.v, n);
        twice += (load(f.node.mass + n) + load(f.node.share + n) * all(added_mass)) * dot(v, v);
    }
    return 0.5 * sum(twice);
}

}  // namespace

SectorKernels sector_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes_of_all,
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
