// A coarse C-9 and hand-made states, for tests of single force blocks.
#pragma once

#include <random>

#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/state.hpp"
#include "fullsim/time/central_difference.hpp"
#include "lib/scene/line_stretch.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::test {

/// 28 gores with few elements, lines of two cables, risers of one.
inline fullsim::Mesh coarse_c9(int columns = 2, int rows = 3, double load = 0.0,
                               Grading grading = Grading::graded) {
    const Scene scene = c9_scene();
    const Parachute& chute = scene.parachutes.front();
    return fullsim::make_gore_mesh(chute, {columns, rows, 2, 1, grading}, scene.payload.mass, Vec3::UnitZ(),
                                   mouth_area_at_line_stretch(chute), load);
}

/// Adds a static line of two cables, unstrained, above the apex.
inline void add_static_line(fullsim::Mesh& mesh) {
    using fullsim::CableKind;
    const auto& vent = mesh.seam_rings.front();
    Vec3 centre = Vec3::Zero();
    for (const auto i : vent)
        centre += mesh.position[i] / static_cast<double>(vent.size());
    const auto first = mesh.first_static_line_node();
    fullsim::StaticLine& line = mesh.static_line;
    for (int k = 0; k < 3; ++k)
        line.position.push_back(centre + (1.0 + k) * mesh.axis);
    line.mass = {0.05, 0.04, 0.0};
    for (const auto i : vent)
        line.cables.push_back(
            {{i, first}, (line.position[0] - mesh.position[i]).norm(), 1.0, CableKind::static_line});
    for (int k = 0; k < 2; ++k)
        line.cables.push_back({{first + k, first + k + 1}, 1.0, 7.0, CableKind::static_line});
}

/// Adds a deformable box around the payload's node, before any static line. No riser is tied to it.
inline void add_body(fullsim::Mesh& mesh) {
    fullsim::BodyMesh& body = mesh.body.emplace();
    body.solid = fullsim::make_box({0.6, 0.4, 0.9}, {2, 2, 2});
    body.lumped = fullsim::lump(fullsim::solid_of(body.solid), 88.0);
    body.deformable = true;
    mesh.attachments = body.attachments();
}

/// The mesh at its own positions, moving with `velocity`, in air of 1.225 kg/m^3 from below.
inline fullsim::State state_of(const fullsim::Mesh& mesh, const Vec3& velocity = Vec3::Zero()) {
    fullsim::State state;
    const auto dummy = static_cast<std::size_t>(mesh.dummy());
    std::vector<Vec3> after = mesh.attachments;
    after.insert(after.end(), mesh.static_line.position.begin(), mesh.static_line.position.end());
    const std::size_t count = dummy + 1 + after.size();
    state.node.resize(count, {splat(0.0), splat(0.0)});
    state.v_half.resize(count, {splat(0.0)});
    state.force.clear(count);
    state.aero.clear(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (i == dummy) continue;
        const Vec3& place = i < dummy ? mesh.position[i] : after[i - dummy - 1];
        state.node[i] = {fullsim::to_lanes(place), fullsim::to_lanes(velocity)};
        state.v_half[i].value = fullsim::to_lanes(velocity);
    }
    state.air.density = 1.225;
    state.air.viscosity = 1.79e-5;
    state.air.airspeed = 20.0;
    state.air.dynamic_pressure = 245.0;
    state.air.drag_area = 10.0;
    fullsim::update_sums(state, fullsim::node_constants(mesh, 0.0));
    return state;
}

/// Moves every node by up to `amplitude` [m] and [m/s]: some elements taut, some slack.
inline void shake(fullsim::State& state, double amplitude, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> step(-amplitude, amplitude);
    for (std::size_t i = 0; i + 1 < state.node.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            state.node[i].x[c] += step(generator);
            state.node[i].v[c] += step(generator);
        }
}

/// Opens the canopy: an affine image of the closed one, wide and flat, well stretched.
inline void stretch_open(fullsim::State& state, double across, double along) {
    for (auto& node : state.node)
        node.x *= Lanes{across, across, along, 0.0};
}

using fullsim::clear_forces;

inline Vec3 total(const fullsim::NodeForces& forces) {
    Lanes sum = splat(0.0);
    for (const auto& f : forces.held())
        sum += f.value;
    return fullsim::to_vec3(sum);
}

}  // namespace twinchute::test
