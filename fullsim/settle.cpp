// The shape that an open canopy begins with, by dynamic relaxation.
#include <algorithm>
#include <optional>
#include <utility>

#include "fullsim/attitude.hpp"
#include "fullsim/initial_state.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/aero_reference.hpp"
#include "fullsim/time/energy.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

// Times over that in which air passes by, D0/v.
constexpr double damping = 20.0;        // of what is faster than a canopy breathes
constexpr double between_looks = 0.02;  // shorter than a canopy breathes, longer than lines ring
constexpr double longest = 8.0;         // it takes 1 to 4
constexpr double settled_share = 3e-4;  // of kinetic to elastic energy: forces have 1 % to go at most
constexpr double hardly_loaded = 2.0;   // over that of the steady canopy: three fourths of its load will come

/// Straight down through still air at the airspeed of the release, and damped.
Scene upright(Scene scene, double unit) {
    scene.release.speed = release_airspeed(scene).norm();
    scene.release.path_angle = 0.5 * pi;
    scene.release.attitude.reset();
    scene.environment.wind.reset();
    scene.full.alpha = std::max(scene.full.alpha, damping / unit);
    return scene;
}

}  // namespace

void Simulation::settle(const std::function<bool()>& stop) {
    const double speed = release_airspeed(scene_).norm();
    if (speed < smallest_airspeed) return;  // no load
    const double passing = scene_.parachutes.front().nominal_diameter / speed,
                 unit = std::min(passing, time_scale());
    const Scene falling = upright(scene_, unit);
    Simulation copy(falling, make_layout_, blocks_);
    copy.held_airspeed_ = copy.state_.air.airspeed * copy.state_.air.direction;
    settled_ = false;
    const auto settled = copy.relax(unit, stop);
    if (!settled) return;
    settled_ = *settled || passing > hardly_loaded * time_scale();
    const Eigen::Matrix3d turn =
        frame_along(trailing_direction(scene_)) * frame_along(trailing_direction(falling)).transpose();
    take_shape_of(copy, Eigen::Quaterniond(turn));
    lean(turn_);
    element_steps_ += copy.element_steps_;
    clock_.add(copy.clock_);
}

void Simulation::turn_to(const Eigen::Quaterniond& turn) {
    lean(turn * std::exchange(turn_, turn).conjugate());
}

Vec3 Simulation::pivot() const {
    return to_vec3(state_.node[mesh_.attachments.size() == 1 ? mesh_.first_attachment() : mesh_.payload()].x);
}

/// Turns the parachute about its pivot, before the first step.
void Simulation::lean(const Eigen::Quaterniond& turn) {
    State& s = state_;
    const Vec3 about = pivot();
    for (NodeIndex i = 0; i < mesh_.payload(); ++i)
        s.node[i].x = to_lanes(about + turn * (to_vec3(s.node[i].x) - about));
    begin_with_shape();
}

/// All comes to rest where its kinetic energy is largest, until that is small. Whether it is within the
/// longest time; nothing where a fault or `stop` has ended it.
std::optional<bool> Simulation::relax(double unit, const std::function<bool()>& stop) {
    const double end = state_.time + longest * unit;
    double next_look = state_.time, last = 0.0;
    while (state_.time < end) {
        evaluate_forces();
        step_to(infinity);
        if (checked_ && (fault_ || stop())) return std::nullopt;
        if (state_.time < next_look) continue;
        next_look += between_looks * unit;
        const EnergiesAndStrains levels = layout_->levels(state_);
        const double kinetic = levels.kinetic + turning() - mean_kinetic();
        if (std::exchange(last, kinetic) <= kinetic) continue;
        last = 0.0;
        come_to_rest();
        if (kinetic < settled_share * levels.elastic) return true;
    }
    return false;
}

/// [J] of parachute, payload and added mass with the velocity of all of them together.
double Simulation::mean_kinetic() const {
    const Vec3 momentum = constants_.system_mass * state_.sums.system_velocity +
                          state_.added_mass * state_.sums.canopy_area_velocity;
    return 0.5 * momentum.squaredNorm() / (constants_.system_mass + state_.added_mass);
}

/// As at the release, but for the shape: place and velocity, and a new ledger.
void Simulation::come_to_rest() {
    State& s = synchronised();
    const Release& release = scene_.release;
    const Lanes velocity = to_lanes(velocity_over_ground(release)),
                shift = to_lanes(Vec3(release.east, release.north, release.altitude)) - payload().x;
    for (std::size_t i = 0; i < s.node.size(); ++i) {
        if (static_cast<NodeIndex>(i) == mesh_.dummy()) continue;
        s.node[i].x += shift;
        s.node[i].v = velocity;
    }
    if (s.body) s.body->momentum = Vec3::Zero();
    fullsim::start_anew(s);
    layout_->begin(s, structure_, loads_, body_.get());
    update_sums(s, constants_);
    s.energy = {};
    s.energy.kinetic_start = kinetic_energy(s, constants_);
    begin_shape();
}

/// Takes shape and added mass of a simulation of the same mesh, turned about the payload; lean begins with
/// them.
void Simulation::take_shape_of(const Simulation& settled, const Eigen::Quaterniond& turn) {
    const State& from = settled.synchronised();
    State& s = state_;
    const Vec3 here = to_vec3(payload().x), there = to_vec3(settled.payload().x);
    for (std::size_t i = 0; i < s.node.size(); ++i)
        if (static_cast<NodeIndex>(i) != mesh_.dummy())
            s.node[i].x = to_lanes(here + turn * (to_vec3(from.node[i].x) - there));
    if (s.body && scene_.release.attitude) {  // the parachute goes to where this body has its attachments
        body_->place(s);
        const Lanes shift = to_lanes(riser_end() - here - turn * (settled.riser_end() - there));
        for (NodeIndex i = 0; i < mesh_.payload(); ++i)
            s.node[i].x += shift;
    } else if (s.body) {
        s.body->attitude = attitude_of(turn * turn_of(from.body->attitude));
    }
    const double before = kinetic_energy(s, constants_);
    s.added_mass = from.added_mass;
    s.energy.kinetic_start += kinetic_energy(s, constants_) - before;
}

/// Layout, sums, air and ledger begin with the nodes of the state.
void Simulation::begin_with_shape() {
    layout_->begin(state_, structure_, loads_, body_.get());
    update_sums(state_, constants_);
    update_air(state_, scene_.environment, mesh_.payload(), constants_.system_mass, 0.0);
    begin_shape();
}

}  // namespace twinchute::fullsim
