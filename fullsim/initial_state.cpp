#include "fullsim/initial_state.hpp"

#include <numeric>
#include <random>

#include "fullsim/mesh/start.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

/// Uniform in [-1, 1), the same on every platform (std::uniform_real_distribution is not).
double uniform(std::mt19937_64& generator) {
    return static_cast<double>(static_cast<std::int64_t>(generator())) * 0x1p-63;
}

/// The pack gets its speed relative to the payload, which recoils; momentum is conserved.
void eject_from_mortar(const Scene& scene, const Mesh& mesh, State& state) {
    const NodeIndex payload = mesh.payload();
    const double carried = mesh.mass[payload];
    const double all = std::accumulate(mesh.mass.begin(), mesh.mass.end(), 0.0);
    const Vec3 speed = scene.parachutes.front().deploy.muzzle_speed * trailing_direction(scene);
    for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
        const double share = i == payload ? -(all - carried) / all : carried / all;
        state.node[i].v += to_lanes(share * speed);
        state.v_half[i].value = state.node[i].v;
    }
}

}  // namespace

Phase first_phase(const Scene& scene, const Inflation& inflation) {
    if (scene.parachutes.front().deploy.by == DeployBy::inflated) return Phase::open;
    return inflation.initial_time > 0.0 ? Phase::initial : Phase::filling;
}

Inflation inflation_from(const Scene& scene, double snatch, double speed, double density) {
    const Parachute& chute = scene.parachutes.front();
    Inflation inflation = make_inflation(scene, chute, snatch, speed, density);
    if (!chute.lag.empty()) {
        inflation.initial_time += chute.lag.front();
        inflation.filling_time += chute.lag.front();
    }
    return inflation;
}

Inflation first_inflation(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    if (chute.deploy.by == DeployBy::inflated) return inflated(chute);
    if (chute.deploy.by == DeployBy::line_stretch)
        return inflation_from(scene, scene.release.time, release_airspeed(scene).norm(),
                              scene.environment.atmosphere.at(scene.release.altitude).density);
    Inflation inflation;
    inflation.snatch = infinity;
    return inflation;
}

Mesh first_mesh(const Scene& scene, const Inflation& inflation, MassScaling& scaling) {
    Mesh mesh = start_mesh(scene, inflation, first_phase(scene, inflation));
    if (const double share = scene.full.mass_scaling; share > 0.0) {
        const double rho = scene.environment.atmosphere.at(scene.release.altitude).density;
        const auto& added = scene.aerodynamics.added_mass;
        const Parachute& chute = scene.parachutes.front();
        const double radius = steady_radius(chute), porosity = chute.geometric_porosity;
        const double air = added ? added->mass(rho, {radius, 0.0}, {1.0, 0.0}, porosity).value : 0.0;
        scaling = scale_masses(scene, share, air, mesh);
    }
    return mesh;
}

Mesh turned(Mesh mesh, const Eigen::Quaterniond& by) {
    if (by.angularDistance(Eigen::Quaterniond::Identity()) == 0.0) return mesh;
    const Eigen::Matrix3d turn = by.toRotationMatrix();
    const Vec3 pivot = mesh.pivot(), payload = mesh.position[mesh.payload()];
    for (auto* positions : {&mesh.position, &mesh.static_line.position})
        for (Vec3& x : *positions)
            x = pivot + turn * (x - pivot);
    mesh.position[mesh.payload()] = payload;
    mesh.axis = turn * mesh.axis;
    return mesh;
}

State first_state(const Scene& scene, const Mesh& mesh) {
    State state;
    const StaticLine& tether = mesh.static_line;
    const std::size_t count =
        static_cast<std::size_t>(mesh.first_static_line_node()) + tether.position.size();
    state.node.resize(count);
    state.v_half.resize(count);
    const Release& release = scene.release;
    const Vec3 origin(release.east, release.north, release.altitude),
        velocity = velocity_over_ground(release);
    state.time = release.time;
    std::mt19937_64 generator(scene.full.noise ? scene.full.noise->seed : 0);
    for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
        Vec3 position = origin + mesh.position[i];
        if (scene.full.noise && mesh.is_canopy(i))
            for (int c = 0; c < 3; ++c)
                position[c] += scene.full.noise->amplitude * uniform(generator);
        state.node[i] = {to_lanes(position), to_lanes(velocity)};
        state.v_half[i].value = to_lanes(velocity);
    }
    const NodeIndex dummy = mesh.dummy();
    state.node[dummy] = {splat(0.0), splat(0.0)};
    state.v_half[dummy].value = splat(0.0);
    for (std::size_t k = 0; k < mesh.attachments.size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(mesh.first_attachment()) + k;
        state.node[i] = {to_lanes(origin + mesh.attachments[k]), to_lanes(velocity)};
        state.v_half[i].value = to_lanes(velocity);
    }
    for (std::size_t k = 0; k < tether.position.size(); ++k) {
        const std::size_t i = mesh.first_static_line_node() + k;
        const bool anchor = k + 1 == tether.position.size();
        const Vec3 v = anchor && !scene.parachutes.front().deploy.anchor_moves ? Vec3::Zero() : velocity;
        state.node[i] = {to_lanes(origin + tether.position[k]), to_lanes(v)};
        state.v_half[i].value = to_lanes(v);
    }
    state.air.direction = trailing_direction(scene);
    if (scene.parachutes.front().deploy.by == DeployBy::mortar) eject_from_mortar(scene, mesh, state);
    return state;
}

}  // namespace twinchute::fullsim
