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

namespace {

double inertia(const State& state, const NodeConstants& c, NodeIndex i) {
    return c.mass[i] + c.share[i] * state.added_mass;
}

void add_moved(const NodeMover& mover, const NodeConstants& c, NodeIndex i, StepSums& sums) {
    if (i < c.canopy_nodes)
        mover.add_canopy(i, c, sums);
    else
        mover.add_other(i, c.mass[i], sums);
}

}  // namespace

void give_impulse(State& state, const NodeConstants& c, double dt, int count, SubcycledNodes& pulled,
                  const Body* body, StepSums& sums) {
    NodeMover mover(state, c, dt);
    Lanes share_square = splat(0.0);
    const double first_kick = subcycle(state, dt, count, 0).kick;
    std::size_t next = 0;
    for (NodeIndex i = 0; i < static_cast<NodeIndex>(c.mass.size()); ++i) {
        const bool apart = next < pulled.nodes().size() && pulled.nodes()[next] == i;
        const double m = inertia(state, c, i);
        const Lanes middle = apart
                                 ? mover.kick_alone(i, pulled.others(next++), c.mass[i], m, first_kick, sums)
                                 : mover.move(i, c.mass[i], m, sums);
        share_square += c.share[i] * (middle * middle);
        if (!apart) add_moved(mover, c, i, sums);
    }
    sums.share_square = sum3(share_square);
    mover.move_static_line(c, sums);
    if (body) body->impulse(state, mover.kick());
}

void drift_in_subcycle(State& state, const NodeConstants& c, const Subcycle& step,
                       const SubcycledNodes& pulled, double damping, const Body* body, StepSums& sums) {
    sums.line_damping += step.kick * damping;
    NodeMover mover(state, c, step.dt);
    for (const NodeIndex i : pulled.nodes())
        mover.move_in_subcycle(i, inertia(state, c, i), step);
    if (body) body->move(state, step.kick, step.dt);
}

void end_subcycles(State& state, const NodeConstants& c, double dt, int count, const SubcycledNodes& pulled,
                   double damping, const Body* body, StepSums& sums) {
    sums.line_damping_power = damping / count;
    NodeMover mover(state, c, dt);
    for (const NodeIndex i : pulled.nodes()) {
        mover.end_subcycles(i);
        add_moved(mover, c, i, sums);
    }
    if (body) body->finish(state, dt);
}

void advance_in_subcycles(State& state, const NodeConstants& c, double dt, int count, double next_added_mass,
                          SubcycledNodes& pulled, double damping, const LinePulls& lines, const Body* body) {
    StepSums sums;
    pulled.take_others(state);
    give_impulse(state, c, dt, count, pulled, body, sums);
    for (int k = 0; k < count; ++k) {
        if (k > 0) {
            damping = lines(state);
            state.in_subcycles.add(state.force[c.mass.size() - 1].value);
        }
        drift_in_subcycle(state, c, subcycle(state, dt, count, k), pulled, damping, body, sums);
    }
    end_subcycles(state, c, dt, count, pulled, damping, body, sums);
    finish_step(state, c, sums, 0.5 * (dt + state.dt), dt, dt / count, next_added_mass);
}

}  // namespace twinchute::fullsim
