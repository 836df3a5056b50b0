#include "fullsim/storage/gore_batched/kernels.hpp"

#include <cmath>

#include "fullsim/storage/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/storage/gore_batched/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/storage/simd/drag_table.hpp"
#include "fullsim/storage/simd/expected_places.hpp"
#include "fullsim/storage/simd/vec.hpp"

#include "fullsim/storage/gore_batched/views.hpp"

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

double farthest(const GoreFrame& frame, const double* before, const LinearMotion& motion) {
    const ExpectedPlaces expected(motion);
    Vec most = all(0.0), witness = most;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        const double* then = before + static_cast<std::size_t>(b) * frame.own * 4 * lanes_of_all;
        for (int n = 0; n < frame.own; ++n, then += 4 * lanes_of_all) {
            const Vec3s x{load_anywhere(then), load_anywhere(then + lanes_of_all),
                          load_anywhere(then + 2 * lanes_of_all)};
            const Vec3s strayed =
                load_anywhere(then + 3 * lanes_of_all) * (block.position(n) - expected.of(x));
            const Vec squared = block.live * dot(strayed, strayed);
            most = larger(squared, most);
            witness += squared;
        }
    }
    return nan_greatest(most, sum(witness));
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
    const Vec3s on_fabric = SimdView::all3(step.on_fabric);
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
                aero += pressure * push + share * on_fabric;
            } else if (step.loads_fabric) {
                aero += share * on_fabric;
            }
            if (halo >= 0) {
                force += taken_from_halo(block.force + halo * block.stride);
                if (with_aero && step.halo_aero) aero += taken_from_halo(block.aero + halo * block.stride);
            }
            if (step.breathing > 0.0) {
                resist(share * all(step.breathing), load3(block.v + at) - SimdView::all3(step.canopy_mean),
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
        if (step.mass_damping > 0.0) {
            resist(all(step.mass_damping) * mass, load3(block.v + at) - SimdView::all3(step.system_mean),
                   force, sums.dissipated);
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
            farthest,
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
