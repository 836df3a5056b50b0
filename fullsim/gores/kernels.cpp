#include "fullsim/gores/kernels.hpp"

#include <cmath>

// Where a processor has AVX-512, its gains over AVX-512 with later additions are none here.
#define HWY_DISABLED_TARGETS (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/gores/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "fullsim/forces/membrane_kernel.hpp"
#include "fullsim/gores/vec.hpp"

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
    Vec live;
    std::size_t stride;

    HWY_INLINE Block(const GoreFrame& f, int block) {
        const std::size_t at = f.at(block, 0);
        x = f.x + at, v = f.v + at, v_half = f.v_half + at;
        force = f.force + at, aero = f.aero + at, push = f.push + at;
        live = load(f.live + static_cast<std::size_t>(block) * f.lanes);
        stride = f.stride();
    }
    HWY_INLINE Vec3s position(std::int32_t node) const { return load3(x + node * stride); }
    HWY_INLINE Vec3s velocity(std::int32_t node) const { return load3(v + node * stride); }
};

/// The table at as many points at once, all between its ends.
HWY_INLINE Vec table_value(const CylinderDragTable& table, Vec reynolds) {
    const hn::RebindToSigned<Tag> whole;
    Vec result;
    for (int k = 0; k < ways; ++k) {
        const auto left = hn::ShiftRight<48>(hn::BitCast(whole, reynolds.raw[k]));
        const auto cell = hn::Sub(left, hn::Set(whole, CylinderDragTable::first_cell));
        const auto start = hn::BitCast(tag, hn::ShiftLeft<48>(left));
        const auto value = hn::GatherIndex(tag, table.values(), cell);
        const auto slope = hn::GatherIndex(tag, table.slopes(), cell);
        result.raw[k] = hn::Add(value, hn::Mul(hn::Sub(reynolds.raw[k], start), slope));
    }
    return result;
}

template <bool structure, bool pressure>
FabricSums membrane_pass(const GoreFrame& frame, const MembranePass& pass) {
    const Vec3s e = splat3(pass.direction);
    const Vec zero = all(0.0), third = all(1.0 / 3.0), radial = all(pass.radial_pressure / 3.0);
    Vec positive = zero, all_area = zero, dissipated = zero;
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        Vec block_positive = zero, block_area = zero, block_dissipated = zero;
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
    }
    return {sum(positive), sum(all_area), sum(dissipated)};
}

double membrane_energy_pass(const GoreFrame& frame, const MembranePass& pass) {
    const Vec zero = all(0.0);
    Vec energy = zero;
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        Vec block_energy = zero;
        for (const MembraneElement& m : pass.elements) {
            const Vec3s x0 = block.position(m.node[0]);
            const Vec3s e1 = block.position(m.node[1]) - x0, e2 = block.position(m.node[2]) - x0;
            const Vec3s f1 = m.inverse_a * e1, f2 = m.inverse_c * (e2 - m.b_over_a * e1);
            const SymmetricTensor<Vec> strain{0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0),
                                              0.5 * dot(f1, f2)};
            block_energy += all(m.area) * relaxed_energy(pass.law, principal(strain));
        }
        energy += block.live * block_energy;
    }
    return sum(energy);
}

/// Adds stiffness and damping to a node's row sums.
HWY_INLINE void add_rows(const GoreFrame& rows, int block, std::int32_t node, Vec stiffness, Vec damping) {
    double* at = rows.x + rows.at(block, node);
    store(load(at) + stiffness, at);
    store(load(at + rows.lanes) + damping, at + rows.lanes);
}

void membrane_rows(const GoreFrame& frame, const MembranePass& pass, std::span<const TriangleRows> unstrained,
                   const GoreFrame& rows) {
    const Vec weight = all(pass.weight);
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        for (std::size_t e = 0; e < pass.elements.size(); ++e) {
            const MembraneElement& m = pass.elements[e];
            const Vec3s x0 = block.position(m.node[0]);
            const Vec3s e1 = block.position(m.node[1]) - x0, e2 = block.position(m.node[2]) - x0;
            const Vec3s f1 = m.inverse_a * e1, f2 = m.inverse_c * (e2 - m.b_over_a * e1);
            const SymmetricTensor<Vec> strain{0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0),
                                              0.5 * dot(f1, f2)};
            const Vec stretch = larger(principal(strain).first(), all(0.0));
            // As Membrane::add_row_sums.
            const Vec stiffening = weight * (1.0 + 3.0 * stretch),
                      lengthening = weight * (1.0 + 2.0 * stretch);
            for (int k = 0; k < 3; ++k)
                add_rows(rows, b, m.node[k], stiffening * all(unstrained[e].stiffness[k]),
                         lengthening * all(unstrained[e].damping[k]));
        }
    }
}

void spring_rows(const GoreFrame& frame, const SpringPass& pass, const GoreFrame& rows) {
    const Vec zero = all(0.0), full = all(full_hardening_strain);
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        for (const SpringElement& s : pass.elements) {
            const Vec3s d = block.position(s.node[1]) - block.position(s.node[0]);
            const Vec square = dot(d, d) + 1e-18;
            const Vec strain = square * inverse_root(square) * all(s.inverse_length) - 1.0;
            const Vec low = smaller(larger(strain, zero), full);
            Vec stiffness = zero, damping = zero;
            if (pass.springs) {
                stiffness = all(2.0 * s.stiffness * s.inverse_length) * (1.0 + all(2.0 * s.growth) * low);
                damping = all(2.0 * s.dashpot);
            }
            if (pass.folds) damping += all(2.0 * s.fold_force / pass.full_speed);
            for (const std::int32_t n : s.node)
                add_rows(rows, b, n, stiffness, damping);
        }
    }
}

double stable_step(const GoreFrame& rows, std::span<const double> inverse_inertia,
                   std::span<const double> node_damping) {
    Vec shortest = all(HUGE_VAL);
    for (int b = 0; b < rows.blocks; ++b) {
        // A lane without a gore has no stiffness here, hence no say.
        const Vec live = load(rows.live + static_cast<std::size_t>(b) * rows.lanes);
        for (int n = 0; n < rows.own; ++n) {
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
    for (int b = 0; b < frame.blocks; ++b) {
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
    for (int b = 0; b < frame.blocks; ++b) {
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

double cables(const GoreFrame& frame, std::span<const CableElement> elements) {
    const Vec zero = all(0.0), one = all(1.0);
    Vec dissipated = zero;
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        Vec block_dissipated = zero;
        for (const CableElement& c : elements) {
            const std::int32_t n0 = c.node[0], n1 = c.node[1];
            const auto [d, square, inverse, lengthening] = span_of(block, n0, n1);
            const Vec spring = all(c.stiffness) * (square * inverse * all(c.inverse_length) - one);
            const Vec tension = larger(spring + all(c.dashpot) * lengthening, zero);
            block_dissipated += (tension - larger(spring, zero)) * lengthening;
            const Vec3s pull = (tension * inverse) * d;
            add3(pull, block.force + n0 * block.stride);
            take3(pull, block.force + n1 * block.stride);
        }
        dissipated += block.live * block_dissipated;
    }
    return sum(dissipated);
}

void line_drag(const GoreFrame& frame, std::span<const Node2> elements, const CylinderDragTable& coefficient,
               double diameter, double density, double viscosity, const std::array<double, 3>& wind) {
    const Vec3s air = splat3(wind);
    const double reynolds_per_speed = density * diameter / viscosity;
    const Vec half = all(0.5), per_speed = all(reynolds_per_speed), factor = all(0.25 * density * diameter);
    const Vec lowest_speed = all(CylinderDragTable::lowest / reynolds_per_speed);
    const Vec highest = all(std::nextafter(CylinderDragTable::highest, 0.0));
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        for (const Node2& n : elements) {
            const Vec3s d = block.position(n[1]) - block.position(n[0]);
            const Vec3s v = air - half * (block.velocity(n[0]) + block.velocity(n[1]));
            const Vec square = dot(d, d) + 1e-18;
            const Vec inverse = inverse_root(square);
            const Vec3s across = v - (dot(v, d) * inverse * inverse) * d;
            const Vec speed_square = dot(across, across) + 1e-60;
            // Below the table C_d Re is constant, so that C_d |V| is what it is at the table's foot.
            const Vec speed = larger(speed_square * inverse_root(speed_square), lowest_speed);
            const Vec reynolds = smaller(per_speed * speed, highest);
            const Vec3s end =
                (factor * square * inverse * speed * table_value(coefficient, reynolds)) * across;
            add3(end, block.aero + n[0] * block.stride);
            add3(end, block.aero + n[1] * block.stride);
        }
    }
}

/// The last lane of a block that has a gore, and the block in which the next gore is.
HWY_INLINE int last_lane(const GoreFrame& frame, int block) {
    const int left = frame.gores - block * frame.lanes;
    return (left < frame.lanes ? left : frame.lanes) - 1;
}

void show_neighbours(const GoreFrame& frame, std::span<const std::int32_t> neighbour, double* array) {
    for (int b = 0; b < frame.blocks; ++b) {
        const int last = last_lane(frame, b), next = b + 1 < frame.blocks ? b + 1 : 0;
        for (std::size_t k = 0; k < neighbour.size(); ++k) {
            const double* own = array + frame.at(b, neighbour[k]);
            const double* own_of_next = array + frame.at(next, neighbour[k]);
            double* image = array + frame.at(b, frame.own + static_cast<int>(k));
            for (int c = 0; c < 3; ++c) {
                const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(c) * frame.lanes;
                store(load_anywhere(own + at + 1), image + at);
                image[at + last] = own_of_next[at];
            }
        }
    }
}

void give_back(const GoreFrame& frame, std::span<const std::int32_t> neighbour, double* array) {
    const Vec zero = all(0.0);
    for (int b = 0; b < frame.blocks; ++b) {
        const int before = b > 0 ? b - 1 : frame.blocks - 1, last_before = last_lane(frame, before);
        for (std::size_t k = 0; k < neighbour.size(); ++k) {
            double* own = array + frame.at(b, neighbour[k]);
            const int image_node = frame.own + static_cast<int>(k);
            const double* image = array + frame.at(b, image_node);
            const double* image_before = array + frame.at(before, image_node);
            for (int c = 0; c < 3; ++c) {
                const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(c) * frame.lanes;
                const double first = own[at] + image_before[at + last_before];
                store(load(own + at) + load_anywhere(image + at - 1), own + at);
                own[at] = first;
            }
        }
    }
    for (int b = 0; b < frame.blocks; ++b)
        for (std::size_t k = 0; k < neighbour.size(); ++k) {
            double* image = array + frame.at(b, frame.own + static_cast<int>(k));
            store3({zero, zero, zero}, image);
        }
}

/// Sums of a step over nodes of a kind, lane by lane.
struct LaneSums {
    Vec3s position, velocity, area_velocity;
    Vec drag_power, momentum, share_square, dissipated, accretion_power, external_power;
};

/// Nodes from first to last of a block. Templates, so that what a stage has not costs nothing in the loop.
template <bool canopy, bool with_aero>
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
        Vec3s aero = none, force = load3(block.force + at);
        store3(none, block.force + at);
        if constexpr (with_aero) {
            aero = load3(block.aero + at);
            store3(none, block.aero + at);
        }
        if constexpr (canopy) {
            aero += pressure * load3(block.push + at) + share * flag;
            store3(none, block.push + at);
            if (step.breathing > 0.0) {
                const Vec3s relative = load3(block.v + at) - splat3(step.breathing_mean);
                const Vec3s resistance = (share * all(step.breathing)) * relative;
                force = force - resistance;
                sums.dissipated += dot(resistance, relative);
            }
            if (step.accretion > 0.0) {
                const Vec3s v = load3(block.v + at);
                const Vec3s push = (share * all(step.accretion)) * (splat3(step.wind) - v);
                force += push;
                sums.accretion_power += dot(push, v);
            }
            if (node.extraction > 0.0) {
                const Vec3s pull = (live * all(node.extraction)) * splat3(step.extraction);
                force += pull;
                sums.external_power += dot(pull, load3(block.v + at));
            }
        }
        if (step.alpha > 0.0) {
            const Vec3s relative = load3(block.v + at) - splat3(step.mean);
            const Vec3s resistance = (all(step.alpha) * mass) * relative;
            force = force - resistance;
            sums.dissipated += dot(resistance, relative);
        }
        Vec3s total = force + aero;
        total.z = total.z - mass * gravity;
        const Vec3s acceleration = all(step.inverse_inertia[n]) * total;
        const Vec3s before = load3(block.v_half + at);
        const Vec3s after = before + kick * acceleration;
        const Vec3s middle = half * (before + after);  // velocity at t, exact for the energy balance
        sums.momentum += mass * middle.z;
        const Vec3s x = load3(block.x + at) + dt * after;
        const Vec3s now = after + half_dt * acceleration;
        store3(after, block.v_half + at);
        store3(x, block.x + at);
        store3(now, block.v + at);
        sums.position += mass * x;
        sums.velocity += mass * now;
        if constexpr (canopy || with_aero) sums.drag_power += live * dot(aero, middle);
        if constexpr (canopy) {
            sums.share_square += share * dot(middle, middle);
            sums.area_velocity += share * now;
        }
    }
}

GoreSums advance(const GoreFrame& frame, const GoreAdvance& step) {
    const Vec zero = all(0.0);
    const Vec3s none{zero, zero, zero};
    LaneSums canopy{none, none, none, zero, zero, zero, zero, zero, zero}, line = canopy;
    for (int b = 0; b < frame.blocks; ++b) {
        const Block block(frame, b);
        if (step.first_aero > 0) move_nodes<true, false>(block, step, 0, step.first_aero, canopy);
        move_nodes<true, true>(block, step, step.first_aero, frame.canopy, canopy);
        move_nodes<false, true>(block, step, frame.canopy, frame.own, line);
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
    return sums;
}

constexpr std::string_view instruction_set() {
#if HWY_TARGET == HWY_AVX3
    return "AVX-512";
#elif HWY_TARGET == HWY_AVX2
    return "AVX2";
#elif HWY_TARGET == HWY_SSE4
    return "SSE4";
#elif HWY_TARGET == HWY_NEON
    return "NEON";
#else
    return "generic";
#endif
}

GoreKernels kernels() {
    return {instruction_set(),
            lanes_of_all,
            membrane_pass<true, false>,
            membrane_pass<true, true>,
            membrane_pass<false, true>,
            membrane_energy_pass,
            cloth_drag,
            springs,
            cables,
            line_drag,
            membrane_rows,
            spring_rows,
            stable_step,
            advance,
            show_neighbours,
            give_back};
}

}  // namespace

GoreKernels gore_kernels_here() {
    return kernels();
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <vector>

namespace twinchute::fullsim {
namespace {

/// Highway is used for its headers alone: its own dispatch needs its library, and that times the processor's
/// clock for some milliseconds whenever a program starts.
std::vector<GoreKernels> kernels_of_this_machine() {
    std::vector<GoreKernels> found;
#if (HWY_TARGETS & HWY_AVX3) != 0
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl"))
        found.push_back(N_AVX3::gore_kernels_here());
#endif
#if (HWY_TARGETS & HWY_AVX2) != 0
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
        __builtin_cpu_supports("bmi2"))
        found.push_back(N_AVX2::gore_kernels_here());
#endif
#if (HWY_TARGETS & HWY_SSE4) != 0
    if (__builtin_cpu_supports("sse4.2")) found.push_back(N_SSE4::gore_kernels_here());
#endif
    // What everything here is compiled for.
    found.push_back(HWY_NAMESPACE::gore_kernels_here());
    return found;
}

}  // namespace

std::span<const GoreKernels> all_gore_kernels() {
    static const std::vector<GoreKernels> sets = kernels_of_this_machine();
    return sets;
}

const GoreKernels& gore_kernels() {
    return all_gore_kernels().front();
}

}  // namespace twinchute::fullsim
#endif
