// Changes of stage of a simulation: snatch, disreefing, and the ramp from springs to finite elements.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/initial_state.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/aero_reference.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double taut_lines = 0.8;       // share of line elements in tension at snatch (paper, 5.2)
constexpr double taut_risers = 0.05;     // riser load at snatch over the payload's weight
constexpr int steps_between_looks = 10;  // at the reefing line of a filling that is predicted
constexpr double cut_line = 10.0;        // length of a reefing line that no longer holds, over pi D0
// Duration of the ramp over D0/v, where the scene gives none.
constexpr double ramp_share = 0.15 / time_scale_of_c9;

}  // namespace

bool Simulation::lines_are_taut() const {
    const double weight = scene_.payload.mass * scene_.environment.gravity;
    if (state_.riser_force.norm() <= taut_risers * weight) return false;
    const State& s = synchronised();
    const auto taut = std::ranges::count_if(lines_, [&](const Cable& c) {
        const Lanes d = s.node[c.node[1]].x - s.node[c.node[0]].x;
        return sum3(d * d) > c.rest_length * c.rest_length;
    });
    return static_cast<double>(taut) >= taut_lines * static_cast<double>(lines_.size());
}

std::optional<RunStatus> Simulation::refused_opening(const Inflation& inflation, double speed) const {
    if (inflow_ && inflation.initial_time < inflation.filling_time) return {};
    return twinchute::refused_opening(inflation, speed);
}

void Simulation::open_as(const Inflation& inflation) {
    inflation_ = inflation;
    state_.phase = first_phase(scene_, inflation_);
}

std::optional<RunStatus> Simulation::snatch(const std::optional<Inflation>& given) {
    const Vec3 airspeed = state_.sums.system_velocity - state_.air.wind;
    const Inflation inflation =
        given ? *given : inflation_from(scene_, state_.time, airspeed.norm(), state_.air.density);
    if (auto refused = refused_opening(inflation, airspeed.norm())) return refused;
    open_as(inflation);
    if (!mesh_.static_line.cables.empty()) let_static_line_go();
    lines_ = {};
    fullsim::start_anew(synchronised());
    // The air that the canopy holds from now on is at its speed: booked as work of the added mass.
    const double before = kinetic_energy(synchronised(), constants_);
    state_.stage = stages_of(scene_)[1];
    state_.added_mass = added_mass_after(0.0).value;
    state_.energy.added_mass += kinetic_energy(state_, constants_) - before;
    change_stage(state_.stage);
    return std::nullopt;
}

void Simulation::let_static_line_go() {
    double carried_off = static_line_kinetic_energy(synchronised(), constants_);
    std::erase_if(structure_, [&](const auto& model) {
        if (model->block() != Block::static_line) return false;
        carried_off += model->energy(state_);
        return true;
    });
    state_.energy.external_work -= carried_off;
    drop_static_line();
}

void Simulation::drop_static_line() {
    mesh_.static_line = {};
    constants_.static_line_mass = {};
    const auto left = static_cast<std::size_t>(mesh_.first_static_line_node());
    state_.node.resize(left);
    state_.v_half.resize(left);
}

/// Equal lengths round the mouth; a line that is cut is one that never comes taut.
void Simulation::set_reefing_line(std::size_t stage) {
    const Parachute& chute = scene_.parachutes.front();
    const double length = stage == chute.reefing.size() ? cut_line * pi * chute.nominal_diameter
                                                        : reefing_line_length(chute, stage);
    reefing_stage_ = stage;
    for (const std::size_t c : mesh_.reefing_line)
        mesh_.cables[c].rest_length = length / static_cast<double>(mesh_.reefing_line.size());
}

bool Simulation::reefing_line_is_taut() const {
    const State& s = synchronised();
    double length = 0.0, line = 0.0;
    for (const std::size_t c : mesh_.reefing_line) {
        const Cable& cable = mesh_.cables[c];
        length += to_vec3(s.node[cable.node[1]].x - s.node[cable.node[0]].x).norm();
        line += cable.rest_length;
    }
    return length >= line;
}

bool Simulation::has_filled() const {
    if (!inflow_ || state_.phase != Phase::filling || std::isfinite(inflation_.filling_time)) return false;
    const bool wide = state_.air.signed_area >= inflow_->full_area();
    if (!is_reefed()) return wide;
    // A line that is taut lets the canopy have no more than the volume it has come to.
    if (!wide && (state_.inflow.swept > 0.0 || state_.step % steps_between_looks != 0)) return false;
    return reefing_line_is_taut() ? state_.inflow.swept <= 0.0 : wide;
}

void Simulation::end_filling() {
    inflation_.filling_time = state_.time - inflation_.snatch;
    state_.inflow.has_been_full = !is_reefed() || !reefing_line_is_taut();
    full_at_ = state_.inflow.has_been_full ? std::min(full_at_, state_.time) : infinity;
}

void Simulation::disreef(const Inflation& inflation, std::size_t stage) {
    const double before = elastic_energy(synchronised(), structure_);
    set_reefing_line(stage);
    layout_ = make_layout_(scene_, mesh_, constants_);
    build_blocks();
    state_.energy.ramp += elastic_energy(state_, structure_) - before;
    inflation_ = inflation;
    state_.phase = Phase::filling;
    steps_.refresh(state_, step_inputs());
    evaluate_forces();
}

bool Simulation::mouth_is_open() const {
    const double steady = 2.0 * steady_radius(scene_.parachutes.front());
    return state_.air.signed_area >= scene_.full.switch_area_ratio * 0.25 * pi * steady * steady;
}

void Simulation::begin_ramp() {
    ramp_start_ = state_.time;
    ramp_time_ = ramp_time();
    ramp_energy_ = 0.0;
    change_stage(Stage::ramp);
}

void Simulation::end_ramp() {
    grow_ramp();
    state_.fe_weight = 1.0;  // to the last bit
    change_stage(Stage::flight);
}

double Simulation::time_scale() const {
    const Parachute& chute = scene_.parachutes.front();
    const double weight = constants_.system_mass * scene_.environment.gravity;
    const double speed = std::sqrt(2.0 * weight / (state_.air.density * chute.drag_area));
    return chute.nominal_diameter / speed;
}

double Simulation::ramp_time() const {
    return scene_.full.ramp_time.value_or(ramp_share * time_scale());
}

double Simulation::ramp_end() const {
    return state_.stage == Stage::ramp ? ramp_start_ + ramp_time_ : infinity;
}

/// Sets the stiffness of the finite elements at system().time, w = (t/T)^3, and books the energy that its
/// growth under strain has brought in since the last step.
void Simulation::grow_ramp() {
    State& s = state_;
    const double share = std::min(1.0, (s.time - ramp_start_) / ramp_time_);
    const double weight = share * share * share, before = s.fe_weight;
    const double energy = layout_->membrane_energy(s);
    s.energy.ramp += 0.5 * (weight - before) * (ramp_energy_ + energy);
    s.fe_weight = weight;
    ramp_energy_ = energy;
}

/// Builds the blocks of another stage. Energy stored in springs or elements that end is taken out of the
/// ledger.
void Simulation::change_stage(Stage stage) {
    State& s = state_;
    const double before = elastic_energy(synchronised(), structure_);
    s.stage = stage;
    s.folded = false;
    build_blocks();
    s.energy.ramp += elastic_energy(s, structure_) - before;
    steps_.refresh(state_, step_inputs());
    evaluate_forces();
}

}  // namespace twinchute::fullsim
