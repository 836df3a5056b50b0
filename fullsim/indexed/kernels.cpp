#include "fullsim/indexed/kernels.hpp"

#include <algorithm>
#include <cmath>

#include "fullsim/lanes/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fullsim/indexed/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Measured: worth it with 16 registers, too.
#define TWINCHUTE_ALWAYS_TWO_WAYS
#include "fullsim/forces/cable_kernel.hpp"
#include "fullsim/forces/membrane_kernel.hpp"
#include "fullsim/lanes/edges.hpp"
#include "fullsim/lanes/records.hpp"
#include "fullsim/lanes/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {
namespace {

using namespace indexed;  // NOLINT(google-build-using-namespace): the kernels' own words

constexpr int lanes = lanes_of_all;
constexpr RowOffset row_bytes = 4 * sizeof(double);

HWY_INLINE Vec3s splat3(const std::array<double, 3>& a) {
    return {all(a[0]), all(a[1]), all(a[2])};
}

/// One group of elements.
template <int corners, int constants>
struct Group {
    const RowOffset* node;
    const double* constant;

    HWY_INLINE Group(Elements elements, std::size_t group)
        : node(elements.node + group * corners * lanes),
          constant(elements.constant + group * constants * lanes) {}
    HWY_INLINE const RowOffset* corner(int c) const { return node + c * lanes; }
    HWY_INLINE Vec operator[](int which) const { return load(constant + which * lanes); }
};
using Triangles = Group<3, membrane_constants>;
using Cables = Group<2, cable_constants>;
using Edges = Group<2, spring_constants>;

HWY_INLINE Vec3s velocity_of(Nodes nodes, const RowOffset* node) {
    return motion_of([=](int lane) TWINCHUTE_INLINED { return record_of(nodes.record, node[lane]); }).v;
}

template <bool structure, bool pressure>
FabricSums membrane_pass(Nodes nodes, Elements elements, const Fabric& fabric) {
    const Vec3s e = splat3(fabric.direction);
    const Vec zero = all(0.0), third = all(1.0 / 3.0), radial = all(fabric.radial_pressure / 3.0);
    const Vec weight = all(fabric.weight);
    Vec positive = zero, all_area = zero, dissipated = zero, largest = zero;
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Triangles g(elements, k);
        const Motion first = between(nodes.record, g.corner(0), g.corner(1));
        const Motion second = between(nodes.record, g.corner(0), g.corner(2));
        if constexpr (pressure) {
            // A third of A_p e_r + phi (A - (A.e_r) e_r) to each corner; what it is per area comes later.
            const Vec3s area = 0.5 * cross(first.x, second.x);
            const Vec along = dot(area, e);
            const Vec swept = larger(along, zero);
            positive += swept;
            all_area += along;
            const Vec3s corner = (third * swept - radial * along) * e + radial * area;
            for_each_row(corner, [&](int lane, Row row) TWINCHUTE_INLINED {
                for (int c = 0; c < 3; ++c) {
                    double* at = row_at(nodes.push, g.corner(c)[lane]);
                    store_row(load_row(at) + row, at);
                }
            });
        }
        if constexpr (structure) {
            const auto pulls = membrane_pulls(fabric.law, g[inverse_a], g[inverse_c], g[b_over_a],
                                              weight * g[reference_area], g[viscosity], first.x, second.x,
                                              first.v, second.v);
            dissipated += pulls.dissipated;
            largest = larger(pulls.stress, largest);
            add_rows(pulls.on_first, nodes.force, g.corner(0));
            take_rows(pulls.on_second, nodes.force, g.corner(1));
            take_rows(pulls.on_third, nodes.force, g.corner(2));
        }
    }
    const double lost = sum(dissipated);
    return {sum(positive), sum(all_area), lost, greatest_or_none(largest, lost)};
}

HWY_INLINE SymmetricTensor<Vec> strain_of(const Triangles& g, Vec3s e1, Vec3s e2) {
    const Vec3s f1 = g[inverse_a] * e1, f2 = g[inverse_c] * (e2 - g[b_over_a] * e1);
    return {0.5 * (dot(f1, f1) - 1.0), 0.5 * (dot(f2, f2) - 1.0), 0.5 * dot(f1, f2)};
}

double membrane_energy_pass(Nodes nodes, Elements elements, const MembraneLaw& law) {
    Vec energy = all(0.0);
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Triangles g(elements, k);
        const Vec3s e1 = between(nodes.record, g.corner(0), g.corner(1)).x;
        const Vec3s e2 = between(nodes.record, g.corner(0), g.corner(2)).x;
        energy += g[reference_area] * relaxed_energy(law, principal(strain_of(g, e1, e2)));
    }
    return sum(energy);
}

double cloth_drag(Nodes nodes, Elements elements, const Air& air, double coefficient) {
    const Vec3s wind = splat3(air.wind);
    const Vec zero = all(0.0), third = all(1.0 / 3.0), share = all(0.5 * air.density * coefficient / 3.0);
    Vec across = zero;
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Triangles g(elements, k);
        const Motion first = between(nodes.record, g.corner(0), g.corner(1));
        const Motion second = between(nodes.record, g.corner(0), g.corner(2));
        const Vec3s v0 = velocity_of(nodes, g.corner(0));
        const Vec3s area = 0.5 * cross(first.x, second.x);
        const Vec3s velocity = wind - (v0 + third * (first.v + second.v));
        const Vec flow = dot(area, velocity);  // |A.e| V
        const Vec swept = larger(flow, -flow);
        across += swept * inverse_root(dot(velocity, velocity) + 1e-18);
        for_each_row((share * swept) * velocity, [&](int lane, Row row) TWINCHUTE_INLINED {
            for (int c = 0; c < 3; ++c) {
                double* at = row_at(nodes.aero, g.corner(c)[lane]);
                store_row(load_row(at) + row, at);
            }
        });
    }
    return sum(across);
}

template <class Ends>
HWY_INLINE Span span_of(Nodes nodes, const Ends& g) {
    const Motion ends = between(nodes.record, g.corner(0), g.corner(1));
    return span_of(ends.x, ends.v);
}

template <class Ends>
HWY_INLINE void pull_together(Nodes nodes, const Ends& g, Vec3s force) {
    for_each_row(force, [&](int lane, Row row) TWINCHUTE_INLINED {
        double* const first = row_at(nodes.force, g.corner(0)[lane]);
        store_row(load_row(first) + row, first);
        double* const second = row_at(nodes.force, g.corner(1)[lane]);
        store_row(load_row(second) - row, second);
    });
}

template <bool with_springs, bool with_folds>
double spring_pass(Nodes nodes, Elements elements, const Springs& springs) {
    Vec dissipated = all(0.0);
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Edges g(elements, k);
        const Span span = span_of(nodes, g);
        const Vec strain = span.strain(g[inverse_length]);
        Vec tension = all(0.0);
        if constexpr (with_springs) {
            const Tension spring =
                spring_tension(span, strain, g[stiffness], g[growth], g[dashpot], springs.repulsion);
            tension = spring.tension;
            dissipated += spring.dissipated;
        }
        if constexpr (with_folds) {
            const Tension fold = fold_tension(span, strain, g[fold_force]);
            tension += fold.tension;
            dissipated += fold.dissipated;
        }
        pull_together(nodes, g, (tension * span.inverse) * span.d);
    }
    return sum(dissipated);
}

double spring_passes(Nodes nodes, Elements elements, const Springs& which) {
    if (which.springs && which.folds) return spring_pass<true, true>(nodes, elements, which);
    return which.springs ? spring_pass<true, false>(nodes, elements, which)
                         : spring_pass<false, true>(nodes, elements, which);
}

/// cylinder: where the air drags.
template <bool pull, bool drag>
HWY_INLINE CableSums cable_pass(Nodes nodes, Elements elements, const CylinderDrag* cylinder,
                                const Air& air) {
    const Vec3s wind = splat3(air.wind);
    Vec dissipated = all(0.0), largest = dissipated;
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Cables g(elements, k);
        const Motion ends = between(nodes.record, g.corner(0), g.corner(1));
        if constexpr (drag) {
            const Vec3s v0 = velocity_of(nodes, g.corner(0));
            // Half of the relative velocity leads to the mean.
            const Vec3s v = wind - (v0 + 0.5 * ends.v);
            for_each_row(cylinder->on_end(ends.x, v), [&](int lane, Row row) TWINCHUTE_INLINED {
                for (int c = 0; c < 2; ++c) {
                    double* at = row_at(nodes.aero, g.corner(c)[lane]);
                    store_row(load_row(at) + row, at);
                }
            });
        }
        if constexpr (pull) {
            const CablePull cable = cable_pull(g[inverse_length], g[stiffness], g[dashpot], ends.x, ends.v);
            dissipated += cable.dissipated;
            largest = larger(cable.spring, largest);
            pull_together(nodes, g, cable.force);
        }
    }
    const double lost = sum(dissipated);
    return {lost, greatest_or_none(largest, lost)};
}

CableSums cables(Nodes nodes, Elements elements) {
    return cable_pass<true, false>(nodes, elements, nullptr, {});
}
void line_drag(Nodes nodes, Elements elements, const CylinderDragTable& table, double diameter,
               const Air& air) {
    const CylinderDrag cylinder(table, diameter, air.density, air.viscosity);
    cable_pass<false, true>(nodes, elements, &cylinder, air);
}
CableSums cables_with_drag(Nodes nodes, Elements elements, const CylinderDragTable& table, double diameter,
                           const Air& air) {
    const CylinderDrag cylinder(table, diameter, air.density, air.viscosity);
    return cable_pass<true, true>(nodes, elements, &cylinder, air);
}

// --- bound on the step ------------------------------------------------------------------------

HWY_INLINE void add_to_rows(Rows rows, const RowOffset* node, Vec stiffness, Vec damping) {
    alignas(64) double k[lanes], c[lanes];
    store(stiffness, k);
    store(damping, c);
    for (int lane = 0; lane < lanes; ++lane) {
        rows.stiffness[node[lane] / row_bytes] += k[lane];
        rows.damping[node[lane] / row_bytes] += c[lane];
    }
}

HWY_INLINE Vec weights_of(Rows rows, const RowOffset* node) {
    alignas(64) double weight[lanes];
    for (int lane = 0; lane < lanes; ++lane)
        weight[lane] = rows.weight[node[lane] / row_bytes];
    return load(weight);
}

/// The same for both ends of elements that pull along a line, but for the weights.
template <class Ends>
HWY_INLINE void add_to_ends(Rows rows, const Ends& g, Vec stiffness, Vec damping) {
    const Vec first = weights_of(rows, g.corner(0)), second = weights_of(rows, g.corner(1));
    const Vec columns[2] = {1.0 + second / first, 1.0 + first / second};
    for (int end = 0; end < 2; ++end)
        add_to_rows(rows, g.corner(end), columns[end] * stiffness, columns[end] * damping);
}

void membrane_rows(Nodes nodes, Elements elements, const Fabric& fabric, Rows rows) {
    const Vec weight = all(fabric.weight);
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Triangles g(elements, k);
        const Vec3s e1 = between(nodes.record, g.corner(0), g.corner(1)).x;
        const Vec3s e2 = between(nodes.record, g.corner(0), g.corner(2)).x;
        const Vec stretch = larger(principal(strain_of(g, e1, e2)).first(), all(0.0));
        // As Membrane::add_row_sums and unstrained_rows.
        const Vec a = g[inverse_a], c = g[inverse_c], b = g[b_over_a] * c;
        const Vec gradient[3] = {square_root((b - c) * (b - c) + a * a), square_root(b * b + a * a), c};
        const Vec area = weight * g[reference_area];
        const Vec stiffness = fabric.law.plane_modulus * (area * (1.0 + 3.0 * stretch));
        const Vec damping = g[viscosity] * (area * (1.0 + 2.0 * stretch));
        Vec w[3], columns = all(0.0);
        for (int i = 0; i < 3; ++i) {
            w[i] = weights_of(rows, g.corner(i));
            columns += gradient[i] * w[i];
        }
        for (int i = 0; i < 3; ++i) {
            const Vec row = gradient[i] * columns / w[i];
            add_to_rows(rows, g.corner(i), row * stiffness, row * damping);
        }
    }
}

void spring_rows(Nodes nodes, Elements elements, const Springs& springs, bool folded, Rows rows) {
    const Vec zero = all(0.0), full = all(full_hardening_strain);
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Edges g(elements, k);
        const Vec strain = span_of(nodes, g).strain(g[inverse_length]);
        const Vec low = smaller(larger(strain, zero), full);
        Vec stiff = zero, damping = zero;
        if (springs.springs && folded) {
            stiff = springs.repulsion * g[stiffness] * g[inverse_length];
        } else if (springs.springs) {
            stiff = g[stiffness] * g[inverse_length] * (1.0 + 2.0 * g[growth] * low);
            damping = g[dashpot];
        }
        if (springs.folds) damping += all(1.0 / full_fold_speed) * g[fold_force];
        add_to_ends(rows, g, stiff, damping);
    }
}

/// Of slack cables, too, since they may pull tight any time.
void cable_rows(Elements elements, Rows rows) {
    for (std::size_t k = 0; k < elements.groups; ++k) {
        const Cables g(elements, k);
        add_to_ends(rows, g, g[stiffness] * g[inverse_length], g[dashpot]);
    }
}

double stable_step(Rows rows, const Bound& bound) {
    const std::size_t count = bound.mass.size();
    const Vec added = all(bound.added_mass), by_share = all(bound.by_share), by_mass = all(bound.by_mass);
    Vec shortest = all(HUGE_VAL);
    const auto look = [&](Vec k, Vec c, Vec mass, Vec share) TWINCHUTE_INLINED {
        const Vec m = mass + share * added;
        const Vec damping = c + by_share * share + by_mass * mass;
        // In this order: a node without a number must not hide what the others say.
        shortest = smaller(2.0 * m / (square_root(damping * damping + k * m) + damping), shortest);
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
HWY_INLINE std::array<double, 4> plain(Row row) {
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
    const Row none = row_of(0.0), half = row_of(0.5);
    const Row kick = row_of(step.kick), dt = row_of(step.dt), half_dt = row_of(0.5 * step.dt);
    const Row pressure = row_of(step.pressure), flag = row_from(step.flag);
    const Row fall = row_from({0.0, 0.0, -step.gravity, 0.0});
    const Row breathing_mean = row_from(step.breathing_mean), mean = row_from(step.mean);
    const Row wind = row_from(step.wind);
    // Copies, which no store to a node can change.
    const double *const masses = step.mass.data(), *const shares = step.share.data();
    double *const records = step.record, *const v_halves = step.v_half;
    const double added_mass = step.added_mass, breathing = step.breathing, accretion = step.accretion;
    const double alpha = step.alpha;
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
            aero += pressure * load_row(nodes.push + 4 * i) + share * flag;
            store_row(none, nodes.push + 4 * i);
            if (breathing > 0.0) {
                const Row relative = load_row(v_at) - breathing_mean;
                const Row resistance = (share * breathing) * relative;
                force = force - resistance;
                sums.dissipated += resistance * relative;
            }
            if (more && accretion > 0.0) {
                const Row v = load_row(v_at);
                const Row push = (share * accretion) * (wind - v);
                force += push;
                sums.accretion_power += push * v;
            }
        }
        if (more && alpha > 0.0) {
            const Row relative = load_row(v_at) - mean;
            const Row resistance = (alpha * mass) * relative;
            force = force - resistance;
            sums.dissipated += resistance * relative;
        }
        const Row m = row_of(mass);
        const Row acceleration = (1.0 / inertia) * (force + aero + m * fall);
        const Row before = load_row(v_half_at);
        const Row after = before + kick * acceleration;
        const Row middle = half * (before + after);  // velocity at t, exact for the energy balance
        sums.momentum += m * middle;
        if (step.weighs)
            sums.kinetic += inertia * (before * (before + step.last_dt * acceleration)) +
                            step.last_dt * ((aero + m * fall) * (middle - before));
        const Row x = load_row(x_at) + dt * after;
        const Row now = after + half_dt * acceleration;
        store_row(after, v_half_at);
        store_row(x, x_at);
        store_row(now, v_at);
        sums.position += m * x;
        sums.velocity += m * now;
        if constexpr (canopy || with_aero) sums.drag_power += aero * middle;
        if constexpr (canopy) {
            sums.share_square += share * (middle * middle);
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
    return {plain(canopy.position),
            plain(canopy.velocity),
            plain(other.position),
            plain(other.velocity),
            plain(canopy.area_velocity),
            plain(canopy.drag_power + other.drag_power),
            plain(canopy.momentum + other.momentum),
            plain(canopy.share_square),
            plain(canopy.dissipated + other.dissipated),
            plain(canopy.accretion_power),
            plain(canopy.kinetic + other.kinetic)};
}

Sums advance(Nodes nodes, const Advance& step) {
    return step.alpha > 0.0 || step.accretion > 0.0 ? advance_all<true>(nodes, step)
                                                    : advance_all<false>(nodes, step);
}

}  // namespace

indexed::Kernels indexed_kernels_here() {
    return {instruction_set_name(HWY_TARGET),
            lanes,
            membrane_pass<true, false>,
            membrane_pass<true, true>,
            membrane_pass<false, true>,
            membrane_energy_pass,
            cloth_drag,
            spring_passes,
            cables,
            line_drag,
            cables_with_drag,
            membrane_rows,
            spring_rows,
            cable_rows,
            stable_step,
            advance};
}

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twinchute::fullsim::indexed {

std::span<const Kernels> all_kernels() {
    static const std::vector<Kernels> sets = TWINCHUTE_SETS_OF_THIS_MACHINE(Kernels, indexed_kernels_here);
    return sets;
}

}  // namespace twinchute::fullsim::indexed
#endif
