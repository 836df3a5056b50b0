#include "fullsim/time/subcycling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fullsim/forces/registry.hpp"
#include "fullsim/time/node_mover.hpp"

namespace twinchute::fullsim {

LineWaves line_waves(const Mesh& mesh, const NodeConstants& constants, double line_length,
                     double bulk_viscosity, double beta) {
    constexpr double none = std::numeric_limits<double>::infinity();
    LineWaves line{0.0, none, none, none};
    for (const Cable& c : mesh.cables) {
        if (c.kind != CableKind::line) continue;
        const CableConstants of_element = cable_constants(mesh, c, bulk_viscosity, beta);
        line.stiffness = std::max(line.stiffness, of_element.stiffness / line_length);
        line.lag = std::min(line.lag, of_element.dashpot * c.rest_length / of_element.stiffness);
        for (const NodeIndex i : c.node) {
            if (!mesh.is_canopy(i)) continue;
            line.mass = std::min(line.mass, constants.mass[i]);
            line.share = std::min(line.share, constants.share[i]);
        }
    }
    return line;
}

double resonance_limit(const LineWaves& line, double added_mass, double canopy_bound) {
    if (line.stiffness == 0.0) return std::numeric_limits<double>::infinity();
    const double mass = line.mass + line.share * added_mass;
    constexpr double pi_to_5 = pi * pi * pi * pi * pi;
    const double fifth = pi_to_5 * line.lag * canopy_bound * canopy_bound * mass / (8.0 * line.stiffness);
    return 0.5 * std::pow(fifth, 0.2);
}

void advance_in_subcycles(State& state, const NodeConstants& c, double dt, int count, double next_added_mass,
                          SubcycledNodes& pulled, double damping, const LinePulls& lines, const Body* body) {
    NodeMover mover(state, c, dt);
    StepSums sums;
    Lanes share_square = splat(0.0);
    const auto is_canopy = [&](NodeIndex i) { return i < c.canopy_nodes; };
    const auto inertia = [&](NodeIndex i) { return c.mass[i] + c.share[i] * state.added_mass; };

    pulled.take_others(state);
    const double first_kick = subcycle(state, dt, count, 0).kick;
    std::size_t next = 0;
    for (NodeIndex i = 0; i < static_cast<NodeIndex>(c.mass.size()); ++i) {
        if (next < pulled.nodes().size() && pulled.nodes()[next] == i) {
            const Lanes middle =
                mover.kick_alone(i, pulled.others(next++), c.mass[i], inertia(i), first_kick, sums);
            share_square += c.share[i] * (middle * middle);
            continue;
        }
        const Lanes middle = mover.move(i, c.mass[i], inertia(i), sums);
        share_square += c.share[i] * (middle * middle);
        if (is_canopy(i))
            mover.add_canopy(i, c, sums);
        else
            mover.add_other(i, c.mass[i], sums);
    }
    sums.share_square = sum3(share_square);
    mover.move_static_line(c, sums);
    if (body) body->impulse(state, mover.kick());

    for (int k = 0; k < count; ++k) {
        if (k > 0) {
            damping = lines(state);
            state.in_subcycles.add(state.force[c.mass.size() - 1].value);
        }
        const Subcycle step = subcycle(state, dt, count, k);
        sums.line_damping += step.kick * damping;
        for (const NodeIndex i : pulled.nodes())
            mover.move_in_subcycle(i, inertia(i), step);
        if (body) body->move(state, step.kick, step.dt);
    }
    sums.line_damping_power = damping / count;
    for (const NodeIndex i : pulled.nodes()) {
        mover.end_subcycles(i);
        if (is_canopy(i))
            mover.add_canopy(i, c, sums);
        else
            mover.add_other(i, c.mass[i], sums);
    }
    if (body) body->finish(state, dt);
    finish_step(state, c, sums, mover.kick(), dt, dt / count, next_added_mass);
}

}  // namespace twinchute::fullsim
