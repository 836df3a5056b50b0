#include "fullsim/time/node_mover.hpp"

namespace twinchute::fullsim {
namespace {

void store_sums(State& state, const NodeConstants& c, const StepSums& sums) {
    state.sums.canopy_position = to_vec3(sums.canopy_position) / c.canopy_mass;
    state.sums.canopy_velocity = to_vec3(sums.canopy_velocity) / c.canopy_mass;
    state.sums.system_position = to_vec3(sums.canopy_position + sums.other_position) / c.system_mass;
    state.sums.system_velocity = to_vec3(sums.canopy_velocity + sums.other_velocity) / c.system_mass;
    state.sums.canopy_area_velocity = to_vec3(sums.area_velocity);
}

}  // namespace

StepSums& StepSums::operator+=(const StepSums& other) {
    canopy_position += other.canopy_position;
    canopy_velocity += other.canopy_velocity;
    other_position += other.other_position;
    other_velocity += other.other_velocity;
    area_velocity += other.area_velocity;
    drag_power += other.drag_power;
    momentum += other.momentum;
    share_square += other.share_square;
    kinetic += other.kinetic;
    line_damping += other.line_damping;
    line_damping_power += other.line_damping_power;
    outer_work += other.outer_work;
    outer_power += other.outer_power;
    return *this;
}

NodeConstants node_constants(const Mesh& mesh, double gravity) {
    NodeConstants c;
    c.mass = mesh.mass;
    c.canopy_nodes = mesh.canopy_nodes;
    c.gravity = gravity;
    c.attachments = mesh.attachments.size();
    c.static_line_mass = mesh.static_line.mass;
    const double area = mesh.fabric_area();
    c.share.reserve(mesh.mass.size());
    for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
        c.share.push_back(mesh.is_canopy(i) ? mesh.tributary_area[i] / area : 0.0);
        c.system_mass += mesh.mass[i];
        if (mesh.is_canopy(i)) c.canopy_mass += mesh.mass[i];
    }
    return c;
}

void update_sums(State& state, const NodeConstants& c) {
    StepSums sums;
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        const bool canopy = static_cast<NodeIndex>(i) < c.canopy_nodes;
        (canopy ? sums.canopy_position : sums.other_position) += c.mass[i] * state.node[i].x;
        (canopy ? sums.canopy_velocity : sums.other_velocity) += c.mass[i] * state.node[i].v;
        sums.area_velocity += c.share[i] * state.node[i].v;
    }
    store_sums(state, c, sums);
}

TWINCHUTE_FOR_EACH_CPU void NodeMover::move_others(const std::vector<NodeIndex>& nodes,
                                                   const NodeConstants& c, StepSums& sums) {
    NodeMover mover = *this;  // a copy, which no store to a node can change
    StepSums of_these = sums;
    for (const NodeIndex i : nodes)
        mover.move_other(i, c.mass[i], of_these);
    sums = of_these;
}

TWINCHUTE_FOR_EACH_CPU void NodeMover::move_static_line(const NodeConstants& c, StepSums& sums) {
    if (c.static_line_mass.empty()) return;
    const std::size_t first = c.first_static_line(), last = first + c.static_line_mass.size() - 1;
    NodeMover mover = *this;  // as above
    StepSums of_these = sums;
    for (std::size_t i = first; i < last; ++i)
        mover.move(i, c.static_line_mass[i - first], c.static_line_mass[i - first], of_these);
    sums = of_these;
    NodeRecord& anchor = state_.node[last];
    state_.external_power -= sum3(force_[last].value * anchor.v);
    if (weighs_) sums.kinetic += 0.5 * c.static_line_mass.back() * sum3(anchor.v * anchor.v);
    anchor.x += dt_ * anchor.v;
    force_[last].value = splat(0.0);
}

TWINCHUTE_FOR_EACH_CPU void move_all(State& state, const NodeConstants& c, double dt,
                                     StepSums& sums_of_step) {
    NodeMover mover(state, c, dt);
    StepSums sums = sums_of_step;
    Lanes share_square = splat(0.0);
    for (NodeIndex i = 0; i < c.canopy_nodes; ++i) {
        const Lanes middle = mover.move(i, c.mass[i], c.mass[i] + c.share[i] * state.added_mass, sums);
        share_square += c.share[i] * (middle * middle);
        mover.add_canopy(i, c, sums);
    }
    sums.share_square = sum3(share_square);
    for (std::size_t i = c.canopy_nodes; i < c.mass.size(); ++i)
        mover.move_other(i, c.mass[i], sums);
    mover.move_static_line(c, sums);
    sums_of_step = sums;
}

void advance(State& state, const NodeConstants& c, double dt, double next_added_mass) {
    StepSums sums;
    move_all(state, c, dt, sums);
    finish_step(state, c, sums, 0.5 * (dt + state.dt), dt, dt, next_added_mass);
}

void finish_step(State& state, const NodeConstants& c, const StepSums& sums, double kick, double dt,
                 double line_dt, double next_added_mass) {
    store_sums(state, c, sums);
    EnergyTotals& totals = state.energy;
    totals.drag_power = sum3(sums.drag_power);
    totals.gravity_power = -c.gravity * sums.momentum[2];
    totals.damping_power = state.damping_power + sums.line_damping_power;
    totals.drag_work += kick * totals.drag_power;
    totals.gravity_work += kick * totals.gravity_power;
    totals.damping += kick * state.damping_power + sums.line_damping;
    totals.external_power = state.external_power + sums.outer_power;
    totals.external_work += kick * state.external_power + sums.outer_work;
    totals.air_loss_power = state.inflow.loss;
    totals.air_loss += kick * totals.air_loss_power;
    totals.kinetic = sums.kinetic;
    totals.added_mass +=
        kick * state.accretion_power + 0.5 * (next_added_mass - state.added_mass) * sums.share_square;
    state.added_mass = next_added_mass;
    state.damping_power = state.accretion_power = state.external_power = 0.0;
    state.dt = dt;
    state.line_dt = line_dt;
    ++state.step;
}

}  // namespace twinchute::fullsim
