#include "fullsim/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "fullsim/mesh/start.hpp"
#include "fullsim/step/aero_reference.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double smallest_step = 1e-9;      // [s] below which nothing would ever finish
constexpr double largest_residual = 0.002;  // of the energy that changed hands; sound runs: 1e-5 to 1e-4
constexpr std::int64_t most_steps = 2'000'000'000;
constexpr double relaxation_time = 0.1;  // [s] of the added mass toward the open canopy's shape

Phase first_phase(const Inflation& inflation) {
    return inflation.initial_time > 0.0 ? Phase::initial : Phase::filling;
}

/// Uniform in [-1, 1), the same on every platform (std::uniform_real_distribution is not).
double uniform(std::mt19937_64& generator) {
    return static_cast<double>(static_cast<std::int64_t>(generator())) * 0x1p-63;
}

State initial_state(const Scene& scene, const Mesh& mesh) {
    State state;
    const auto count = static_cast<std::size_t>(mesh.node_count()) + 1;
    state.node.resize(count);
    state.v_half.resize(count);
    state.force.resize(count);
    state.aero.resize(count);
    const Vec3 origin(0.0, 0.0, scene.release.altitude), velocity = velocity_over_ground(scene.release);
    std::mt19937_64 generator(scene.full.noise ? scene.full.noise->seed : 0);
    for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
        Vec3 position = origin + mesh.position[i];
        if (scene.full.noise && mesh.is_canopy(i))
            for (int c = 0; c < 3; ++c)
                position[c] += scene.full.noise->amplitude * uniform(generator);
        state.node[i] = {to_lanes(position), to_lanes(velocity)};
        state.v_half[i].value = to_lanes(velocity);
    }
    state.node.back() = {splat(0.0), splat(0.0)};
    state.v_half.back().value = state.force.back().value = state.aero.back().value = splat(0.0);
    state.air.direction = trailing_direction(scene);
    return state;
}

}  // namespace

Simulation::Simulation(const Scene& scene)
    : scene_(scene),
      inflation_(make_inflation(scene.parachutes.front(), 0.0, release_airspeed(scene).norm(),
                                scene.environment.atmosphere.at(scene.release.altitude).density)),
      mesh_(start_mesh(scene, inflation_, first_phase(inflation_))),
      structure_(make_structure(scene, mesh_)),
      loads_(make_loads(scene, mesh_)),
      constants_(node_constants(mesh_, scene.environment.gravity)),
      state_(initial_state(scene, mesh_)),
      dt_min_(std::numeric_limits<double>::infinity()),
      largest_load_(structure_.size(), 0.0),
      block_seconds_(structure_.size() + loads_.size(), 0.0) {
    state_.phase = first_phase(inflation_);
    update_sums(state_, constants_);
    update_air(state_, scene.environment, mesh_.payload(), constants_.system_mass, 0.0);
    state_.added_mass = added_mass_after(0.0).value;
    state_.energy.kinetic_start = kinetic_energy(state_, constants_);
    state_.energy.elastic_start = elastic_energy(state_, structure_);
    refresh_step();
}

void Simulation::evaluate_forces() {
    State& s = state_;
    update_air(s, scene_.environment, mesh_.payload(), constants_.system_mass,
               air_mass_in_reference(s.added_mass, s.time - inflation_.end_of(Phase::filling)));
    s.air.drag_area = inflation_.steady_drag_area * inflation_.drag_area_ratio(s.phase, s.time).value;
    s.air.radial_pressure = scene_.aerodynamics.radial_pressure * inflation_.ramp(s.phase, s.time).value;

    s.added_mass_rate = added_mass_after(0.0).rate;

    // Timing every block in every step would cost more than some blocks do.
    const bool timed = s.step % steps_between_bounds == 0;
    std::size_t block = 0;
    const auto add = [&](const ForceModels& models) {
        for (const auto& model : models) {
            const auto start = timed ? Clock::now() : Clock::time_point{};
            model->add_forces(s);
            if (timed) block_seconds_[block] += std::chrono::duration<double>(Clock::now() - start).count();
            ++block;
        }
    };
    add(structure_);
    s.riser_force = to_vec3(s.force[mesh_.payload()].value);
    add(loads_);
    if (timed) ++sampled_steps_;
    if (s.air.pressure_capped) ++s.capped_steps;
}

ValueAndRate Simulation::added_mass_after(double dt) const {
    if (!scene_.aerodynamics.added_mass) return {};
    const AddedMassSpec& spec = *scene_.aerodynamics.added_mass;
    const double rho = state_.air.density;
    if (state_.phase != Phase::open)
        return inflation_.added_mass(spec, state_.phase, state_.time + dt, rho,
                                     steady_radius(scene_.parachutes.front()));
    // Once open, the air belongs to the shape that the canopy really has.
    const double radius = std::sqrt(state_.air.projected_area / pi);
    const double missing = spec.mass(rho, {radius, 0.0}, {1.0, 0.0}).value - state_.added_mass;
    const double gained = missing * -std::expm1(-dt / relaxation_time);
    return {state_.added_mass + gained, (missing - gained) / relaxation_time};
}

StableStep Simulation::bound() const {
    RowSums sums;
    sums.stiffness.assign(constants_.mass.size(), 0.0);
    sums.damping.assign(constants_.mass.size(), 0.0);
    for (const ForceModels* models : {&structure_, &loads_})
        for (const auto& model : *models)
            model->add_row_sums(state_, sums);
    std::vector<double> inertia = constants_.mass;
    for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
        inertia[i] += constants_.share[i] * state_.added_mass;
    return stable_step(sums, inertia);
}

void Simulation::refresh_step() {
    step_ = scene_.full.time_step_factor * bound().dt;
}

void Simulation::step_to(double end) {
    if (state_.step > 0 && state_.step % steps_between_bounds == 0) refresh_step();
    const double left = end - state_.time;
    const bool last = left <= step_;
    const double dt = last ? left : std::min(step_, 0.5 * left);
    advance(state_, constants_, dt, added_mass_after(dt).value);
    state_.time = last ? end : state_.time + dt;
    if (!last) dt_min_ = std::min(dt_min_, dt);
    dt_max_ = std::max(dt_max_, dt);
}

std::string Simulation::first_bad_node() const {
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i) {
        const Lanes both = state_.node[i].x + state_.node[i].v;
        if (std::isfinite(sum3(both))) continue;
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            if (std::ranges::count(mesh_.triangles[t].node, i))
                return fmt::format("node {}, fabric triangle {}", i, t);
        for (std::size_t c = 0; c < mesh_.cables.size(); ++c)
            if (std::ranges::count(mesh_.cables[c].node, i))
                return fmt::format("node {}, {} cable {}", i, cable_kind_name(mesh_.cables[c].kind), c);
    }
    return "the added mass";
}

std::optional<RunStatus> Simulation::find_fault() {
    const auto where = [&] { return fmt::format("at t = {:.6f} s, step {}", state_.time, state_.step); };
    // A sum, which a NaN cannot hide from; comparisons and maxima can lose it.
    const double everything = kinetic_energy(state_, constants_) + state_.sums.system_position.sum();
    if (!std::isfinite(everything))
        return RunStatus{
            StatusCode::not_finite,
            fmt::format("{} {}; the time step is probably above the stable one", first_bad_node(), where())};
    if (step_ < smallest_step)
        return RunStatus{StatusCode::step_too_small,
                         fmt::format("stable step {:.3g} s set by node {} {}", step_, bound().node, where())};
    std::vector<double> load(structure_.size());
    for (std::size_t i = 0; i < structure_.size(); ++i) {
        const Extreme most = structure_[i]->extreme(state_);
        if (most.strain > scene_.full.strain_limit)
            return RunStatus{StatusCode::strain_limit,
                             fmt::format("{} is strained by {:.1f} % (limit {:.1f} %) {}",
                                         structure_[i]->element_name(most.element), 100.0 * most.strain,
                                         100.0 * scene_.full.strain_limit, where())};
        load[i] = most.load;
    }
    const EnergyLedger e = ledger();
    const double scale = state_.energy.kinetic_start + std::abs(e.gravity_work) + std::abs(e.drag_work);
    // Written so that a NaN fails, too; energy that vanishes is as wrong as energy from nowhere.
    if (!(std::abs(residual(e)) <= largest_residual * scale))
        return RunStatus{StatusCode::energy_grew,
                         fmt::format("{:.3g} J of energy do not add up, {:.1f} % of what changed hands, {}",
                                     residual(e), 100.0 * residual(e) / scale, where())};
    if (state_.step >= most_steps)
        return RunStatus{StatusCode::step_limit,
                         fmt::format("{} steps are the most that a run may take, {}", most_steps, where())};
    for (std::size_t i = 0; i < structure_.size(); ++i)
        largest_load_[i] = std::max(largest_load_[i], load[i]);
    return std::nullopt;
}

double Simulation::largest_load(std::string_view block) const {
    for (std::size_t i = 0; i < structure_.size(); ++i)
        if (structure_[i]->name() == block) return largest_load_[i];
    return 0.0;
}

std::size_t Simulation::elements_per_step() const {
    std::size_t count = 0;
    for (const auto& model : structure_)
        count += model->elements();
    return count;
}

std::vector<BlockCost> Simulation::block_costs() const {
    const double scale =
        sampled_steps_ > 0 ? static_cast<double>(state_.step) / static_cast<double>(sampled_steps_) : 0.0;
    std::vector<BlockCost> costs;
    for (const ForceModels* models : {&structure_, &loads_})
        for (const auto& model : *models)
            costs.push_back({std::string(model->name()), scale * block_seconds_[costs.size()]});
    return costs;
}

}  // namespace twinchute::fullsim
