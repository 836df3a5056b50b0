#include "fullsim/gores/kernels.hpp"

#include <cmath>

#include "fullsim/lanes/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/gores/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/forces/cable_kernel.hpp"
#include "fullsim/forces/contact_kernel.hpp"
#include "fullsim/forces/membrane_kernel.hpp"
#include "fullsim/lanes/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

HWY_INLINE Vec3s splat3(const std::array<double, 3>& a) {
    return {all(a[0]), all(a[1]), all(a[2])};
}
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

/// Where there is a gore: a lane without one sees no neighbour.
HWY_INLINE Vec of_gores(const Block& block, Vec a) {
    return select(block.live > all(0.0), a, all(0.0));
}

template <bool structure, bool pressure>
FabricSums membrane_pass(const GoreFrame& frame, const MembranePass& pass) {
    const Vec3s e = splat3(pass.direction);
    const Vec zero = all(0.0), third = all(1.0 / 3.0), radial = all(pass.radial_pressure / 3.0);
    Vec positive = zero, all_area = zero, dissipated = zero, largest = zero;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_positive = zero, block_area = zero, block_dissipated = zero, block_largest = zero;
        for (const MembraneElement& m : pass.elements) {
            const std::int32_t n0 = m.node[0], n1 = m.node[1], n2 = m.node[2];
            const Vec3s x0 = block.position(n0);
            const Vec3s e1 = block.position(n1) - x0, e2 = block.position(n2) - x0;
            if constexpr (structure) {
                const Vec3s v0 = block.velocity(n0);
                const Vec3s w1 = block.velocity(n1) - v0, w2 = block.velocity(n2) - v0;
                const auto pulls =
                    membrane_pulls(pass.law, all(m.inverse_a), all(m.inverse_c), all(m.b_over_a),
                                   all(pass.weight * m.area), all(m.viscosity), e1, e2, w1, w2);
                block_dissipated += pulls.dissipated;
                block_largest = larger(pulls.stress, block_largest);
                add3(pulls.on_first, block.force + n0 * block.stride);
                take3(pulls.on_second, block.force + n1 * block.stride);
                take3(pulls.on_third, block.force + n2 * block.stride);
            }
            if constexpr (pressure) {
                // A third of A_p e_r + phi (A - (A.e_r) e_r) to each corner; what it is per area comes later.
                const Vec3s area = 0.5 * cross(e1, e2);
                const Vec along = dot(area, e);
                const Vec swept = larger(along, zero);
                block_positive += swept;
                block_area += along;
                const Vec3s corner = (third * swept - radial * along) * e + radial * area;
                add3(corner, block.push + n0 * block.stride);
                add3(corner, block.push + n1 * block.stride);
                add3(corner, block.push + n2 * block.stride);
            }
        }
        positive += block.live * block_positive;
        all_area += block.live * block_area;
        dissipated += block.live * block_dissipated;
        largest = larger(of_gores(block, block_largest), largest);
    }
    const double lost = sum(dissipated);
    return {sum(positive), sum(all_area), lost, greatest_or_none(largest, lost)};
}

/// Green strain of a triangle.
HWY_INLINE SymmetricTensor<Vec> strain_of(const Block& block, const MembraneElement& m) {
    const Vec3s x0 = block.position(m.node[0]);
    const Vec3s e1 = block.position(m.node[1]) - x0, e2 = block.position(m.node[2]) - x0;
    const Vec3s f1 = m.inverse_a * e1, f2 = m.inverse_c * (e2 - m.b_over_a * e1);
    return {0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0), 0.5 * dot(f1, f2)};
}

/// Of a span: lengths over unstrained ones, less 1.
HWY_INLINE Vec strain_of(const Block& block, std::int32_t n0, std::int32_t n1, double inverse_length) {
    const Vec3s d = block.position(n1) - block.position(n0);
    const Vec square = dot(d, d) + 1e-18;
    return square * inverse_root(square) * all(inverse_length) - 1.0;
}

/// Sums and maxima of elements, lane by lane.
struct LaneLevels {
    Vec energy, strain;

    HWY_INLINE ElementLevels of_all_lanes() const { return {sum(energy), greatest(strain)}; }
};

HWY_INLINE LaneLevels no_levels() {
    return {all(0.0), all(0.0)};
}

/// Of spans, which may be folded.
HWY_INLINE LaneLevels levels_of_folded() {
    return {all(0.0), all(-1.0)};
}
HWY_INLINE Vec larger_of_gores(const Block& block, Vec strain, Vec largest) {
    return larger(select(block.live > all(0.0), strain, all(-1.0)), largest);
}

ElementLevels membrane_levels(const GoreFrame& frame, const MembranePass& pass) {
    LaneLevels levels = no_levels();
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (const MembraneElement& m : pass.elements) {
            const auto p = principal(strain_of(block, m));
            levels.energy += of_gores(block, all(m.area) * relaxed_energy(pass.law, p));
            // In this order, here and below: a strain that is not a number must not hide the others.
            levels.strain = larger(of_gores(block, p.first()), levels.strain);
        }
    }
    return levels.of_all_lanes();
}

/// Adds stiffness and damping to the row sums of a node of the frame's.
HWY_INLINE void add_rows(const GoreFrame& frame, const GoreFrame& rows, int block, std::int32_t node,
                         Vec stiffness, Vec damping) {
    double* at = rows.x + rows.at(block, node < rows.own ? node : node - frame.own + rows.own);
    store(load(at) + stiffness, at);
    store(load(at + rows.lanes) + damping, at + rows.lanes);
}

void membrane_rows(const GoreFrame& frame, const MembranePass& pass, std::span<const WeighedRows> unstrained,
                   const GoreFrame& rows) {
    const Vec weight = all(pass.weight);
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (std::size_t e = 0; e < pass.elements.size(); ++e) {
            const MembraneElement& m = pass.elements[e];
            const Vec stretch = larger(principal(strain_of(block, m)).first(), all(0.0));
            // As Membrane::add_row_sums.
            const Vec stiffening = weight * (1.0 + 3.0 * stretch),
                      lengthening = weight * (1.0 + 2.0 * stretch);
            for (int k = 0; k < 3; ++k)
                add_rows(frame, rows, b, m.node[k], stiffening * all(unstrained[e].stiffness[k]),
                         lengthening * all(unstrained[e].damping[k]));
        }
    }
}

void spring_rows(const GoreFrame& frame, const SpringPass& pass,
                 std::span<const std::array<double, 2>> columns, const GoreFrame& rows) {
    const Vec zero = all(0.0), full = all(full_hardening_strain);
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (std::size_t e = 0; e < pass.elements.size(); ++e) {
            const SpringElement& s = pass.elements[e];
            const Vec strain = strain_of(block, s.node[0], s.node[1], s.inverse_length);
            const Vec low = smaller(larger(strain, zero), full);
            Vec stiffness = zero, damping = zero;
            if (pass.springs && pass.folded) {
                stiffness = all(pass.repulsion * (s.stiffness * s.inverse_length));
            } else if (pass.springs) {
                stiffness = all(s.stiffness * s.inverse_length) * (1.0 + all(2.0 * s.growth) * low);
                damping = all(s.dashpot);
            }
            if (pass.folds) damping += all(s.fold_force / pass.full_speed);
            for (int end = 0; end < 2; ++end)
                add_rows(frame, rows, b, s.node[end], all(columns[e][end]) * stiffness,
                         all(columns[e][end]) * damping);
        }
    }
}

double stable_step(const GoreFrame& rows, std::span<const double> inverse_inertia,
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
            shortest = smaller(all(2.0) / (square_root(c * c + k) + c + 1e-300), shortest);
        }
    }
    return least(shortest);
}

FabricSums cloth_drag(const GoreFrame& frame, const MembranePass& pass, double factor,
                      const std::array<double, 3>& wind) {
    const Vec3s air = splat3(wind);
    const Vec zero = all(0.0), third = all(1.0 / 3.0), share = all(factor / 3.0);
    Vec across = zero;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_across = zero;
        for (const MembraneElement& m : pass.elements) {
            const std::int32_t n0 = m.node[0], n1 = m.node[1], n2 = m.node[2];
            const Vec3s x0 = block.position(n0);
            const Vec3s area = 0.5 * cross(block.position(n1) - x0, block.position(n2) - x0);
            const Vec3s velocity =
                air - third * (block.velocity(n0) + block.velocity(n1) + block.velocity(n2));
            const Vec flow = dot(area, velocity);  // |A.e| V
            const Vec swept = larger(flow, -flow);
            block_across += swept * inverse_root(dot(velocity, velocity) + 1e-18);
            const Vec3s corner = (share * swept) * velocity;
            add3(corner, block.aero + n0 * block.stride);
            add3(corner, block.aero + n1 * block.stride);
            add3(corner, block.aero + n2 * block.stride);
        }
        across += block.live * block_across;
    }
    return {sum(across), 0.0, 0.0};
}

/// From one node to another.
struct Span {
    Vec3s d;                           // [m]
    Vec square, inverse, lengthening;  // of the length [m^2], [1/m]; its rate [m/s]
};

HWY_INLINE Span span_of(const Block& block, std::int32_t n0, std::int32_t n1) {
    Span span;
    span.d = block.position(n1) - block.position(n0);
    const Vec3s w = block.velocity(n1) - block.velocity(n0);
    span.square = dot(span.d, span.d) + 1e-18;  // keeps a span of no length from being 0/0
    span.inverse = inverse_root(span.square);
    span.lengthening = dot(span.d, w) * span.inverse;
    return span;
}

template <bool with_springs, bool with_folds>
double spring_pass(const GoreFrame& frame, const SpringPass& pass) {
    const Vec zero = all(0.0), one = all(1.0), full = all(full_hardening_strain);
    const Vec repulsion = all(pass.repulsion), inverse_full_speed = all(1.0 / pass.full_speed);
    Vec dissipated = zero;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_dissipated = zero;
        for (const SpringElement& s : pass.elements) {
            const std::int32_t n0 = s.node[0], n1 = s.node[1];
            const auto [d, square, inverse, lengthening] = span_of(block, n0, n1);
            const Vec strain = square * inverse * all(s.inverse_length) - one;
            Vec tension = zero;
            if constexpr (with_springs) {
                const Vec low = select(strain < full, strain, full);
                const Vec stiffness = all(s.stiffness);
                const Vec pull = stiffness * (strain + all(s.growth) * low * (low + 2.0 * (strain - low)));
                const Vec push = repulsion * stiffness * strain;
                const Mask taut = strain > zero;
                const Vec spring = select(taut, pull, push);
                tension = select(taut, larger(pull + all(s.dashpot) * lengthening, zero), push);
                block_dissipated += (tension - spring) * lengthening;
            }
            if constexpr (with_folds) {
                const Vec growing = larger(lengthening, zero);
                const Vec speed_share = growing * inverse_full_speed;
                const Vec folded = select(strain < zero, all(s.fold_force), zero);
                const Vec hold = folded * select(speed_share < one, speed_share, one);
                block_dissipated += hold * growing;
                tension += hold;
            }
            const Vec3s force = (tension * inverse) * d;
            add3(force, block.force + n0 * block.stride);
            take3(force, block.force + n1 * block.stride);
        }
        dissipated += block.live * block_dissipated;
    }
    return sum(dissipated);
}

double springs(const GoreFrame& frame, const SpringPass& pass) {
    if (pass.springs && pass.folds) return spring_pass<true, true>(frame, pass);
    return pass.springs ? spring_pass<true, false>(frame, pass) : spring_pass<false, true>(frame, pass);
}

FabricSums cables(const GoreFrame& frame, std::span<const CableElement> elements) {
    Vec dissipated = all(0.0), largest = dissipated;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_dissipated = all(0.0), block_largest = block_dissipated;
        for (const CableElement& c : elements) {
            const std::int32_t n0 = c.node[0], n1 = c.node[1];
            const CablePull pull =
                cable_pull(all(c.inverse_length), all(c.stiffness), all(c.dashpot),
                           block.position(n1) - block.position(n0), block.velocity(n1) - block.velocity(n0));
            block_dissipated += pull.dissipated;
            block_largest = larger(pull.spring, block_largest);
            add3(pull.force, block.force + n0 * block.stride);
            take3(pull.force, block.force + n1 * block.stride);
        }
        dissipated += block.live * block_dissipated;
        largest = larger(of_gores(block, block_largest), largest);
    }
    const double lost = sum(dissipated);
    return {0.0, 0.0, lost, greatest_or_none(largest, lost)};
}

/// The same pair of nodes of all gores.
HWY_INLINE ContactArm<Vec, Vec3s> arm_of(const Block& block, const ContactElement& pair, Vec3s centre,
                                         Vec3s axis) {
    const Vec3s x0 = block.position(pair.node[0]), x1 = block.position(pair.node[1]);
    return contact_arm(all(0.0), axis, x0 - centre, x1 - x0);
}

FabricSums contacts(const GoreFrame& frame, const ContactPass& pass) {
    const Vec3s centre = splat3(pass.centre), axis = splat3(pass.direction);
    const Vec zero = all(0.0);
    Vec3s by_arm{zero, zero, zero}, by_turning = by_arm;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (const ContactElement& pair : pass.pairs) {
            const auto arm = arm_of(block, pair, centre, axis);
            if (!any(arm.behind > zero)) continue;
            const auto push = contact_push(all(pair.stiffness), axis, arm);
            const Vec3s half = push.half_of_middle;
            add3(push.apart - half, block.force + pair.node[0] * block.stride);
            take3(push.apart + half, block.force + pair.node[1] * block.stride);
            by_arm += (2.0 * block.live) * half;
            by_turning += block.live * push.by_turning;
        }
    }
    FabricSums sums;
    sums.by_arm = sum3s(by_arm);
    sums.by_turning = sum3s(by_turning);
    return sums;
}

ElementLevels contact_levels(const GoreFrame& frame, const ContactPass& pass) {
    const Vec3s centre = splat3(pass.centre), axis = splat3(pass.direction);
    Vec energy = all(0.0);
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (const ContactElement& pair : pass.pairs)
            energy += block.live *
                      contact_push(all(pair.stiffness), axis, arm_of(block, pair, centre, axis)).energy;
    }
    return {sum(energy), 0.0};
}

ElementLevels spring_levels(const GoreFrame& frame, const SpringPass& pass) {
    const Vec zero = all(0.0), full = all(full_hardening_strain), repulsion = all(pass.repulsion);
    LaneLevels levels = levels_of_folded();
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (const SpringElement& s : pass.elements) {
            const Vec strain = of_gores(block, strain_of(block, s.node[0], s.node[1], s.inverse_length));
            const Vec low = smaller(strain, full), high = strain - low;
            const Vec half_square = 0.5 * (strain * strain);
            const Vec pulled = half_square + all(s.growth) * low * (low * low * (1.0 / 3.0) + high * strain);
            levels.energy +=
                all(s.stiffness / s.inverse_length) * select(strain > zero, pulled, repulsion * half_square);
            levels.strain = larger_of_gores(block, strain, levels.strain);
        }
    }
    return levels.of_all_lanes();
}

ElementLevels cable_levels(const GoreFrame& frame, std::span<const CableElement> elements) {
    LaneLevels levels = levels_of_folded();
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        for (const CableElement& c : elements) {
            const Vec strain = of_gores(block, strain_of(block, c.node[0], c.node[1], c.inverse_length));
            const Vec pulled = larger(strain, all(0.0));
            levels.energy += all(0.5 * c.stiffness / c.inverse_length) * (pulled * pulled);
            levels.strain = larger_of_gores(block, strain, levels.strain);
        }
    }
    return levels.of_all_lanes();
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

/// What is known of a line's node while elements are gone through one after the other: an element finds one
/// of its nodes in registers, and each node is written once.
struct LineNode {
    Vec3s x, v;
    Vec3s pull, aero;  // by elements so far
};

HWY_INLINE LineNode line_node(const Block& block, std::int32_t node) {
    const Vec3s none{all(0.0), all(0.0), all(0.0)};
    return {block.position(node), block.velocity(node), none, none};
}

template <bool pulls, bool drags>
FabricSums line_pass(const GoreFrame& frame, LineElements lines, const LineAir& air) {
    const CylinderDrag drag(*air.coefficient, air.diameter, air.density, air.viscosity);
    const Vec3s wind = splat3(air.wind);
    const Vec half = all(0.5);
    Vec dissipated = all(0.0), largest = dissipated;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        Vec block_dissipated = all(0.0), block_largest = block_dissipated;
        // The skirt's, then those of the line's own nodes.
        double *pull_at = block.pull, *aero_at = block.skirt_aero;
        LineNode here = line_node(block, lines.front().node[0]);
        for (const CableElement& c : lines) {
            LineNode next = line_node(block, c.node[1]);
            const Vec3s d = next.x - here.x;
            if constexpr (pulls) {
                const CablePull pull =
                    cable_pull(all(c.inverse_length), all(c.stiffness), all(c.dashpot), d, next.v - here.v);
                block_dissipated += pull.dissipated;
                block_largest = larger(pull.spring, block_largest);
                here.pull += pull.force;
                next.pull = next.pull - pull.force;
            }
            if constexpr (drags) {
                const Vec3s end = drag.on_end(d, wind - half * (here.v + next.v));
                here.aero += end;
                next.aero = end;
            }
            store3(here.pull, pull_at);
            store3(here.aero, aero_at);
            pull_at = block.force + c.node[1] * block.stride;
            aero_at = block.aero + c.node[1] * block.stride;
            here = next;
        }
        store3(here.pull, pull_at);
        store3(here.aero, aero_at);
        dissipated += block.live * block_dissipated;
        largest = larger(of_gores(block, block_largest), largest);
    }
    const double lost = sum(dissipated);
    return {0.0, 0.0, lost, greatest_or_none(largest, lost)};
}

/// The last lane of a block that has a gore, and the block in which the next gore is.
HWY_INLINE int last_lane(const GoreFrame& frame, int block) {
    const int left = frame.gores - block * frame.lanes;
    return (left < frame.lanes ? left : frame.lanes) - 1;
}

void give_back(const GoreFrame& rows, std::span<const std::int32_t> neighbour) {
    for (int b = rows.first; b < rows.last; ++b) {
        const int before = b > 0 ? b - 1 : rows.blocks - 1, last_before = last_lane(rows, before);
        for (std::size_t k = 0; k < neighbour.size(); ++k) {
            double* own = rows.x + rows.at(b, neighbour[k]);
            const int image_node = rows.own + static_cast<int>(k);
            const double* image = rows.x + rows.at(b, image_node);
            const double* image_before = rows.x + rows.at(before, image_node);
            for (int c = 0; c < 2; ++c, own += rows.lanes, image += rows.lanes, image_before += rows.lanes) {
                store(load(own) + one_up(load(image)), own);
                own[0] += image_before[last_before];
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

/// What nodes on lines do in a step: move with it, or take its impulse alone.
enum class Pulled { none, together, apart };

/// What the gore before has added to the image of a node; leaves nothing there.
HWY_INLINE Vec3s taken_from_image(double* image) {
    const Vec3s added = one_up(load3(image));
    store3({all(0.0), all(0.0), all(0.0)}, image);
    return added;
}

/// A node as the gore before sees it.
HWY_INLINE void show(const Block& block, std::int32_t image, Vec3s x, Vec3s v) {
    const std::size_t there = image * block.stride;
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
    const Vec3s flag = splat3(step.flag);
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
            const std::int32_t image = step.image[n];
            if (step.pushed) {
                Vec3s push = load3(block.push + at);
                store3(none, block.push + at);
                if (image >= 0) push += taken_from_image(block.push + image * block.stride);
                aero += pressure * push + share * flag;
            }
            if (image >= 0) {
                force += taken_from_image(block.force + image * block.stride);
                if (with_aero && step.image_aero) aero += taken_from_image(block.aero + image * block.stride);
            }
            if (step.breathing > 0.0) {
                const Vec3s relative = load3(block.v + at) - splat3(step.breathing_mean);
                const Vec3s resistance = (share * all(step.breathing)) * relative;
                force = force - resistance;
                sums.dissipated += dot(resistance, relative);
            }
            if (step.accretion > 0.0) {
                const Vec3s v = load3(block.v + at);
                const Vec3s joining = (share * all(step.accretion)) * (splat3(step.wind) - v);
                force += joining;
                sums.accretion_power += dot(joining, v);
            }
            if (node.extraction > 0.0) {
                const Vec3s pull = (live * all(node.extraction)) * splat3(step.extraction);
                force += pull;
                sums.external_power += dot(pull, load3(block.v + at));
            }
        }
        Vec3s pull = none;
        if constexpr (pulled != Pulled::none) pull = on_line ? force : load3(block.pull);
        if constexpr (pulled == Pulled::together && !on_line) force += pull;
        if constexpr (pulled == Pulled::apart && on_line) force = none;
        if (step.alpha > 0.0) {
            const Vec3s relative = load3(block.v + at) - splat3(step.mean);
            const Vec3s resistance = (all(step.alpha) * mass) * relative;
            force = force - resistance;
            sums.dissipated += dot(resistance, relative);
        }
        Vec3s total = force + aero;
        total.z = total.z - mass * gravity;
        if (canopy && step.leaned_on) total += mass * splat3(step.lean);
        const Vec3s acceleration = all(step.inverse_inertia[n]) * total;
        const Vec3s before = load3(block.v_half + n * block.half_stride);
        const Vec3s after = before + kick * acceleration;
        Vec3s middle = half * (before + after);  // velocity at t, exact for the energy balance
        if constexpr (pulled == Pulled::apart)
            middle += (half * all(step.first_kick) * all(step.inverse_inertia[n])) * pull;
        sums.momentum += mass * middle.z;
        if (step.weighs) {
            Vec3s change = all(step.last_dt) * acceleration;
            if constexpr (pulled == Pulled::apart)
                change += all(step.last_line_dt * step.inverse_inertia[n]) * pull;
            Vec3s booked = aero;
            booked.z = booked.z - mass * gravity;
            sums.kinetic += (live * all(1.0 / step.inverse_inertia[n])) * dot(before, before + change) +
                            (live * all(step.last_dt)) * dot(booked, middle - before);
        }
        store3(after, block.v_half + n * block.half_stride);
        if constexpr (canopy || with_aero) sums.drag_power += live * dot(aero, middle);
        if constexpr (canopy) sums.share_square += share * dot(middle, middle);
        if constexpr (pulled == Pulled::apart) {
            store3(acceleration, aero_at);
            continue;
        }
        const Vec3s x = load3(block.x + at) + dt * after;
        const Vec3s now = after + half_dt * acceleration;
        store3(x, block.x + at);
        store3(now, block.v + at);
        if constexpr (canopy)
            if (const std::int32_t image = step.image[n]; image >= 0) show(block, image, x, now);
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
HWY_INLINE void move_pulled(const Block& block, const GoreSubstep& substep, std::int32_t n, Vec3s x,
                            Vec3s pull, LaneSums& sums) {
    const Vec kick = all(substep.step.kick) * block.live, dt = all(substep.step.dt) * block.live;
    const std::size_t at = n * block.stride;
    const Vec3s acceleration = all(substep.inverse_inertia[n]) * pull;
    const Vec3s after = load3(block.v_half + n * block.half_stride) + kick * acceleration;
    x += dt * after;
    Vec3s now = after + (0.5 * dt) * acceleration;
    store3(after, block.v_half + n * block.half_stride);
    store3(x, block.x + at);
    if constexpr (last_of_step) {
        now += (all(substep.half_step) * block.live) * load3(canopy ? block.skirt_aero : block.aero + at);
        const Vec mass = all(substep.nodes[n].mass) * block.live;
        sums.position += mass * x;
        sums.velocity += mass * now;
        if constexpr (canopy) {
            sums.area_velocity += all(substep.nodes[n].share) * block.live * now;
            show(block, substep.skirt_image, x, now);
        }
    }
    store3(now, block.v + at);
}

template <bool last_of_step>
HWY_INLINE void move_lines(const Block& block, const GoreSubstep& substep, LaneSums& canopy, LaneSums& line) {
    const std::int32_t skirt = substep.lines.front().node[0], first = substep.lines.front().node[1];
    move_pulled<true, last_of_step>(block, substep, skirt, block.position(skirt), load3(block.pull), canopy);
    for (std::int32_t n = first; n < static_cast<std::int32_t>(substep.nodes.size()); ++n)
        move_pulled<false, last_of_step>(block, substep, n, block.position(n),
                                         load3(block.force + n * block.stride), line);
}

/// Lines and, one element behind, the nodes that they pull on.
template <bool last_of_step>
HWY_INLINE void pull_and_move_lines(const Block& block, const GoreSubstep& substep, LaneSums& canopy,
                                    LaneSums& line, Vec& largest) {
    LineNode here = line_node(block, substep.lines.front().node[0]);
    bool on_skirt = true;
    Vec block_dissipated = all(0.0), block_largest = block_dissipated;
    for (const CableElement& c : substep.lines) {
        LineNode next = line_node(block, c.node[1]);
        const CablePull pull = cable_pull(all(c.inverse_length), all(c.stiffness), all(c.dashpot),
                                          next.x - here.x, next.v - here.v);
        block_dissipated += pull.dissipated;
        block_largest = larger(pull.spring, block_largest);
        next.pull = next.pull - pull.force;
        here.pull += pull.force;
        if (on_skirt)
            move_pulled<true, last_of_step>(block, substep, c.node[0], here.x, here.pull, canopy);
        else
            move_pulled<false, last_of_step>(block, substep, c.node[0], here.x, here.pull, line);
        on_skirt = false;
        here = next;
    }
    store3(here.pull, block.force + substep.lines.back().node[1] * block.stride);
    line.dissipated += block.live * block_dissipated;
    largest = larger(of_gores(block, block_largest), largest);
}

template <bool last_of_step>
GoreSums substep_pass(const GoreFrame& frame, const GoreSubstep& substep) {
    const Vec zero = all(0.0);
    const Vec3s none{zero, zero, zero};
    LaneSums canopy{none, none, none, zero, zero, zero, zero, zero, zero, zero}, line = canopy;
    Vec largest = zero;
    for (int b = frame.first; b < frame.last; ++b) {
        const Block block(frame, b);
        if (substep.pulled)
            move_lines<last_of_step>(block, substep, canopy, line);
        else
            pull_and_move_lines<last_of_step>(block, substep, canopy, line, largest);
    }
    GoreSums sums;
    sums.dissipated = sum(line.dissipated);
    sums.largest_tension = greatest_or_none(largest, sums.dissipated);
    if constexpr (last_of_step) {
        sums.canopy_position = sum3s(canopy.position);
        sums.canopy_velocity = sum3s(canopy.velocity);
        sums.line_position = sum3s(line.position);
        sums.line_velocity = sum3s(line.velocity);
        sums.area_velocity = sum3s(canopy.area_velocity);
    }
    return sums;
}

GoreSums substep(const GoreFrame& frame, const GoreSubstep& substep) {
    return substep.half_step > 0.0 ? substep_pass<true>(frame, substep) : substep_pass<false>(frame, substep);
}

}  // namespace

GoreKernels gore_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes_of_all,
            membrane_pass<true, false>,
            membrane_pass<true, true>,
            membrane_pass<false, true>,
            membrane_levels,
            spring_levels,
            cable_levels,
            kinetic_energy,
            cloth_drag,
            springs,
            cables,
            contacts,
            contact_levels,
            line_pass<true, false>,
            line_pass<false, true>,
            line_pass<true, true>,
            membrane_rows,
            spring_rows,
            stable_step,
            advance,
            substep,
            give_back};
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
