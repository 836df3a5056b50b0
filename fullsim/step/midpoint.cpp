#include "fullsim/step/midpoint.hpp"

namespace twinchute::fullsim {
namespace {

/// Sums over a range of nodes, in node order.
struct RangeSums {
    Lanes mass_position = splat(0.0), mass_velocity = splat(0.0);
    void add(double mass, const NodeRecord& node) {
        mass_position += mass * node.x;
        mass_velocity += mass * node.v;
    }
};

void store_sums(State& state, const NodeConstants& c, const RangeSums& canopy, const RangeSums& rest,
                Lanes area_velocity) {
    state.sums.canopy_position = to_vec3(canopy.mass_position) / c.canopy_mass;
    state.sums.canopy_velocity = to_vec3(canopy.mass_velocity) / c.canopy_mass;
    state.sums.system_position = to_vec3(canopy.mass_position + rest.mass_position) / c.system_mass;
    state.sums.system_velocity = to_vec3(canopy.mass_velocity + rest.mass_velocity) / c.system_mass;
    state.sums.canopy_area_velocity = to_vec3(area_velocity);
}

}  // namespace

NodeConstants node_constants(const Mesh& mesh, double gravity) {
    NodeConstants c;
    c.mass = mesh.mass;
    c.canopy_nodes = mesh.canopy_nodes;
    c.gravity = gravity;
    c.static_line_mass = mesh.static_line.mass;
    const double area = mesh.fabric_area();
    for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
        c.share.push_back(mesh.tributary_area[i] / area);
        c.system_mass += mesh.mass[i];
        if (mesh.is_canopy(i)) c.canopy_mass += mesh.mass[i];
    }
    return c;
}

void update_sums(State& state, const NodeConstants& c) {
    RangeSums canopy, rest;
    Lanes area_velocity = splat(0.0);
    for (std::size_t i = 0; i < c.mass.size(); ++i) {
        (static_cast<NodeIndex>(i) < c.canopy_nodes ? canopy : rest).add(c.mass[i], state.node[i]);
        area_velocity += c.share[i] * state.node[i].v;
    }
    store_sums(state, c, canopy, rest, area_velocity);
}

TWINCHUTE_FOR_EACH_CPU void advance(State& state, const NodeConstants& c, double dt, double next_added_mass) {
    const double kick = 0.5 * (dt + state.dt);
    const Lanes fall{0.0, 0.0, -c.gravity, 0.0};
    Lanes drag_power = splat(0.0), momentum = splat(0.0), share_square = splat(0.0);
    Lanes area_velocity = splat(0.0);

    const auto move = [&](std::size_t i, double mass, double inertia, RangeSums& sums)
        __attribute__((always_inline)) {
        NodeRecord& node = state.node[i];
        const Lanes aero = state.aero[i].value;
        const Lanes weight = mass * fall;
        const Lanes acceleration = (state.force[i].value + aero + weight) / splat(inertia);
        const Lanes before = state.v_half[i].value;
        const Lanes after = before + kick * acceleration;
        const Lanes middle = 0.5 * (before + after);  // velocity at t, exact for the energy balance
        drag_power += aero * middle;
        momentum += mass * middle;
        state.v_half[i].value = after;
        node.x += dt * after;
        node.v = after + (0.5 * dt) * acceleration;
        state.force[i].value = state.aero[i].value = splat(0.0);
        sums.add(mass, node);
        return middle;
    };

    RangeSums canopy, rest;
    for (NodeIndex i = 0; i < c.canopy_nodes; ++i) {
        const Lanes middle = move(i, c.mass[i], c.mass[i] + c.share[i] * state.added_mass, canopy);
        share_square += c.share[i] * (middle * middle);
        area_velocity += c.share[i] * state.node[i].v;
    }
    for (std::size_t i = c.canopy_nodes; i < c.mass.size(); ++i)
        move(i, c.mass[i], c.mass[i], rest);
    if (!c.static_line_mass.empty()) {
        RangeSums not_of_the_system;
        const std::size_t first = c.mass.size() + 1, count = c.static_line_mass.size();
        for (std::size_t k = 0; k + 1 < count; ++k)
            move(first + k, c.static_line_mass[k], c.static_line_mass[k], not_of_the_system);
        // The far end goes its own way; what it pulls is work from outside.
        NodeRecord& far_end = state.node[first + count - 1];
        state.external_power -= sum3(state.force[first + count - 1].value * far_end.v);
        far_end.x += dt * far_end.v;
        state.force[first + count - 1].value = splat(0.0);
    }
    store_sums(state, c, canopy, rest, area_velocity);

    EnergyBook& book = state.energy;
    book.drag_power = sum3(drag_power);
    book.gravity_power = -c.gravity * momentum[2];
    book.damping_power = state.damping_power;
    book.drag_work += kick * book.drag_power;
    book.gravity_work += kick * book.gravity_power;
    book.damping += kick * book.damping_power;
    book.external_power = state.external_power;
    book.external_work += kick * book.external_power;
    book.added_mass +=
        kick * state.accretion_power + 0.5 * (next_added_mass - state.added_mass) * sum3(share_square);
    state.added_mass = next_added_mass;
    state.damping_power = state.accretion_power = state.external_power = 0.0;
    state.dt = dt;
    ++state.step;
}

}  // namespace twinchute::fullsim
