#include "fullsim/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fullsim/initial_state.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/serialize_state.hpp"
#include "fullsim/time/aero_reference.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

/// Time constant over D0/v of the added mass toward the open canopy's shape.
constexpr double relaxation = 0.1 / time_scale_of_c9;
/// Interval at which volume and mobility of a predicted filling are measured: a hundredth of it at most.
constexpr std::int64_t steps_between_measurements = 40;
/// Apparent over included mass of a canopy whose filling is predicted: 3/8 (docs/theory/filling.md).
constexpr double apparent_share = 0.375;

}  // namespace

Simulation::Simulation(const Scene& scene, const LayoutMaker& layout, std::span<const ForceBlock> blocks,
                       const Eigen::Quaterniond& turn)
    : scene_(scene),
      make_layout_(layout),
      blocks_(blocks),
      inflation_(first_inflation(scene)),
      mesh_(turned(first_mesh(scene, inflation_, mass_scaling_), turn)),
      inflow_(InflowBalance::of(scene, mesh_)),
      constants_(node_constants(mesh_, scene.environment.gravity)),
      body_(make_body(scene, mesh_)),
      state_(first_state(scene, mesh_)),
      layout_(make_layout_(scene, mesh_, constants_)),
      steps_(scene, mesh_, constants_),
      turn_(turn) {
    state_.phase = first_phase(scene, inflation_);
    if (body_) body_->start(state_, frame_at_start(scene.release, turn.conjugate() * mesh_.axis));
    if (scene.parachutes.front().deploy.starts_packed()) {
        state_.stage = stages_of(scene).front();
        state_.fe_weight = scene.full.structure == Structure::fe ? 1.0 : 0.0;
        std::ranges::copy_if(mesh_.cables, std::back_inserter(lines_),
                             [](const Cable& c) { return c.kind == CableKind::line; });
    }
    build_blocks();
    if (state_.stage == Stage::deployment) state_.folded = steps_.begin_deployment(state_, *layout_);
    update_sums(state_, constants_);
    update_air(state_, scene.environment, mesh_.payload(), constants_.system_mass, 0.0);
    const Parachute& chute = scene.parachutes.front();
    if (scene.aerodynamics.added_mass && state_.stage == Stage::flight)
        state_.added_mass =
            inflation_
                .added_mass(*scene.aerodynamics.added_mass, state_.phase, state_.time, state_.air.density,
                            steady_radius(chute), chute.geometric_porosity)
                .value;
    state_.energy.kinetic_start = kinetic_energy(state_, constants_);
    begin_shape();
}

void Simulation::begin_shape() {
    state_.energy.elastic_start = elastic_energy(state_, structure_);
    for (const auto& model : structure_)
        model->prepare(state_);
    steps_.refresh(state_, step_inputs());
}

State& Simulation::synchronised() const {
    if (stored_step_ != state_.step) layout_->store(state_);
    stored_step_ = state_.step;
    return state_;
}

void Simulation::build_blocks() {
    structure_ = make_structure(scene_, mesh_, state_.stage, blocks_);
    loads_ = make_loads(scene_, mesh_, state_.stage, blocks_);
    std::vector<std::string> names;
    for (const ForceModels* models : {&structure_, &loads_})
        for (const auto& model : *models)
            names.emplace_back(model->name());
    clock_.begin(names);
    layout_->begin(state_, structure_, loads_, body_.get());
    elements_ = layout_->elements(structure_);
}

// --- one step ------------------------------------------------------------------------------------

void Simulation::evaluate_forces() {
    renew_air();
    if (state_.stage == Stage::ramp) grow_ramp();
    clock_.begin_step(state_.step % StepControl::steps_between_bounds == 0);
    layout_->evaluate(state_, clock_);
    if (state_.air.pressure_capped) ++state_.capped_steps;
}

void Simulation::step_to(double end) {
    begin_step(choose_step(), end);
    layout_->move(state_);
    end_step();
}

ChosenStep Simulation::choose_step() {
    steps_.renew(state_, step_inputs());
    return steps_.chosen();
}

void Simulation::begin_step(const ChosenStep& chosen, double end) {
    next_ = steps_.take(chosen, state_.time, end);
    balance_ = begin_balance();
    state_.in_subcycles = {};
    layout_->begin_step(state_, next_.dt, next_.subcycles);
}

void Simulation::end_step() {
    layout_->end_step(state_, added_mass_after(next_.dt).value);
    state_.time = next_.end;
    state_.largest_added_mass = std::max(state_.largest_added_mass, state_.added_mass);
    state_.inflow.volume += next_.dt * state_.inflow.swept;
    state_.inflow.end_step(state_.air.pressure);
    element_steps_ +=
        static_cast<std::int64_t>(elements_.all + (next_.subcycles - 1) * elements_.in_subcycles);
    book_energy(balance_);
}

void Simulation::start_anew() {
    fullsim::start_anew(synchronised());
    layout_->begin(state_, structure_, loads_, body_.get());
    evaluate_forces();
}

void Simulation::begin_at(const Vec3& position, const PayloadPart& part, std::int64_t step) {
    NodeRecord& payload = state_.node[mesh_.payload()];
    payload.x = to_lanes(position);
    payload.v += to_lanes(part.velocity - velocity_over_ground(scene_.release));
    state_.v_half[mesh_.payload()].value = payload.v;
    state_.step = stored_step_ = first_step_ = step;
    if (body_) {
        make_body_of(part);
        turn_body(part);
        state_.energy.kinetic_start += turning();
        layout_->begin(state_, structure_, loads_, body_.get());
        begin_shape();
    }
    update_sums(state_, constants_);
}

void Simulation::make_body_of(const PayloadPart& part) {
    mesh_.body->lumped.inertia = part.moments.value().asDiagonal();
    body_ = make_body(scene_, mesh_);
}

void Simulation::turn_body(const PayloadPart& part) {
    state_.body = part.body;
    body_->place(state_);
}

void Simulation::weigh_payload(const PayloadPart& part) {
    mesh_.mass[mesh_.payload()] = part.node_mass;
    if (body_) make_body_of(part);
    constants_ = node_constants(mesh_, scene_.environment.gravity);
    update_sums(state_, constants_);
    steps_.weigh(constants_);
    layout_ = make_layout_(scene_, mesh_, constants_);
    build_blocks();
    steps_.refresh(state_, step_inputs());
}

void Simulation::bear(const PayloadPart& part) {
    fullsim::start_anew(synchronised());
    const double before = kinetic_energy(state_, constants_) + turning();
    const NodeIndex payload = mesh_.payload();
    state_.node[payload].v = state_.v_half[payload].value = to_lanes(part.velocity);
    weigh_payload(part);
    if (body_) turn_body(part);
    state_.energy.external_work += kinetic_energy(state_, constants_) + turning() - before;
    evaluate_forces();
}

void Simulation::follow_payload_of(const Simulation& other) {
    const NodeIndex here = mesh_.payload(), there = other.mesh_.payload();
    state_.node[here] = other.state_.node[there];
    state_.v_half[here] = other.state_.v_half[there];
    if (!body_) return;
    state_.body = other.state_.body;
    body_->place(state_);
}

Vec3 Simulation::riser_end() const {
    if (!body_) return to_vec3(payload().x);
    Vec3 sum = Vec3::Zero();
    const auto first = static_cast<std::size_t>(mesh_.first_attachment());
    for (std::size_t k = 0; k < mesh_.attachments.size(); ++k)
        sum += to_vec3(state_.node[first + k].x);
    return sum / static_cast<double>(mesh_.attachments.size());
}

void Simulation::meet_others(double frequency) {
    steps_.count_outer(frequency);
    steps_.refresh(state_, step_inputs());
}

PressedNodes Simulation::canopy_nodes() const {
    const auto count = static_cast<std::size_t>(mesh_.canopy_nodes);
    PressedNodes all = pressed();
    all.node = std::span(synchronised().node).first(count);
    all.mass = std::span(constants_.mass).first(count);
    return all;
}

PressedNodes Simulation::canopy_nodes(std::span<const NodeIndex> nodes, std::vector<NodeRecord>& record,
                                      std::vector<double>& mass) const {
    record.resize(nodes.size());
    layout_->read(state_, nodes, record);
    mass.clear();
    for (const NodeIndex i : nodes)
        mass.push_back(constants_.mass[i]);
    PressedNodes some = pressed();
    some.node = record;
    some.mass = mass;
    return some;
}

PressedNodes Simulation::pressed() const {
    return {{},
            {},
            steps_.outer_frequency() * steps_.outer_frequency(),
            to_lanes(state_.sums.canopy_position),
            constants_.canopy_mass,
            payload().x};
}

void Simulation::push_canopy(std::span<const NodeIndex> nodes, std::span<const NodeRecord> of,
                             std::span<const Lanes> force, Lanes on_all) {
    double power = to_vec3(on_all).dot(state_.sums.canopy_velocity);
    for (std::size_t k = 0; k < nodes.size(); ++k)
        power += sum3(force[k] * of[k].v);
    layout_->push(state_, nodes, force);
    layout_->accelerate(to_vec3(on_all) / constants_.canopy_mass);
    state_.external_power += power;
}

void Simulation::push_payload(Lanes force) {
    payload_load() += force;
    state_.external_power += sum3(force * payload().v);
}

Simulation::Balance Simulation::begin_balance() {
    Balance before;
    before.checked = checked_ = state_.step % steps_between_checks == 0;
    before.watched = steps_.watches_impacts(state_, checked_);
    state_.energy.weighs = before.checked || before.watched;
    before.time = state_.time;
    before.turning = turning();
    before.added_mass = state_.energy.added_mass;
    if (state_.energy.weighs) before.levels = layout_->levels(state_);
    return before;
}

void Simulation::book_energy(const Balance& before) {
    if (!before.checked && !before.watched) return;
    const EnergyLedger ledger =
        ledger_before(state_, before.levels.elastic, before.turning, before.added_mass);
    if (before.checked) fault_ = find_fault_in(before.levels, ledger, before.time, state_.step - 1);
    if (before.watched)
        steps_.watch_impacts(residual_share(ledger) / largest_residual, state_.energy.damping);
}

double Simulation::residual_share(const EnergyLedger& e) {
    return residual(e) / energy_scale(state_.energy);
}

void Simulation::renew_air() {
    State& s = state_;
    // A line that is cut and never was taut frees nothing: a canopy that has been full goes on.
    const double filled = std::min(full_at_, inflation_.end_of(Phase::filling));
    const double air_mass = air_mass_in_reference(s.added_mass, s.time - filled, time_scale());
    if (held_airspeed_)
        s.air.wind = s.air.wind_at_payload =
            *held_airspeed_ +
            reference_velocity(s.sums, to_vec3(payload().x), constants_.system_mass, air_mass);
    else
        update_air(s, scene_.environment, mesh_.payload(), constants_.system_mass, air_mass);
    if (s.stage == Stage::deployment) {
        s.air.extraction = extraction();
        return;
    }
    s.air.drag_area = inflation_.steady_drag_area;
    if (!inflow_) s.air.drag_area *= inflation_.drag_area_ratio(s.phase, s.time).value;
    if (const auto& table = scene_.parachutes.front().drag_area_mach_table)
        s.air.drag_area *= table->factor(
            s.air.airspeed / *scene_.environment.atmosphere.speed_of_sound(s.node[mesh_.payload()].x[2]));
    s.air.radial_pressure =
        inflow_ ? 1.0 : scene_.aerodynamics.radial_pressure * inflation_.ramp(s.phase, s.time).value;
    if (inflow_) {
        s.inflow.steady_drag_area = s.air.drag_area;
        if (s.step % steps_between_measurements == 0 || s.inflow.mobility == 0.0)
            inflow_->measure(synchronised(), constants_);
    }
    s.added_mass_rate = added_mass_after(0.0).rate;
}

/// A prescribed force straight behind, or the drag of a pilot chute that moves as the vent's seams do.
Vec3 Simulation::extraction() const {
    const Deployment& deploy = scene_.parachutes.front().deploy;
    if (deploy.by == DeployBy::extraction)
        return deploy.extraction.at(state_.time - scene_.release.time) * trailing_direction(scene_);
    if (deploy.by != DeployBy::pilot) return Vec3::Zero();
    const std::vector<NodeIndex>& vent = mesh_.seam_rings.front();
    std::vector<NodeRecord> seams(vent.size());
    if (stored_step_ == state_.step)
        std::ranges::transform(vent, seams.begin(), [this](NodeIndex i) { return state_.node[i]; });
    else
        layout_->read(state_, vent, seams);
    Vec3 airspeed = -state_.air.wind;
    for (const NodeRecord& seam : seams)
        airspeed += to_vec3(seam.v) / static_cast<double>(seams.size());
    return -0.5 * state_.air.density * deploy.pack_drag_area * airspeed.norm() * airspeed;
}

ValueAndRate Simulation::added_mass_after(double dt) const {
    if (!scene_.aerodynamics.added_mass || state_.stage == Stage::deployment) return {};
    const AddedMassSpec& spec = *scene_.aerodynamics.added_mass;
    const Parachute& chute = scene_.parachutes.front();
    const double rho = state_.air.density;
    const bool fills = inflow_ ? !state_.inflow.has_been_full : state_.phase != Phase::open || is_reefed();
    if (inflow_ && fills) {
        // Air inside brings its momentum to the drag itself; that around it has to be brought to speed.
        const InflowState& inflow = state_.inflow;
        const double volume = std::max(0.0, inflow.volume + dt * inflow.swept);
        return {(1.0 + apparent_share) * rho * volume, apparent_share * rho * inflow.swept};
    }
    if (fills || spec.open_radius == AddedMassRadius::drag_area)
        return inflation_.added_mass(spec, state_.phase, state_.time + dt, rho, steady_radius(chute),
                                     chute.geometric_porosity);
    // Once open, the air belongs to the shape that the canopy really has.
    const double radius = std::sqrt(state_.air.projected_area / pi);
    const double missing =
        spec.mass(rho, {radius, 0.0}, {1.0, 0.0}, chute.geometric_porosity).value - state_.added_mass;
    const double time = relaxation * time_scale();
    const double gained = missing * -std::expm1(-dt / time);
    return {state_.added_mass + gained, (missing - gained) / time};
}

// --- other integrators -----------------------------------------------------------------------------

std::vector<double> Simulation::unknowns() const {
    std::vector<double> y;
    y.reserve(6 * constants_.mass.size() + 1);
    const State& s = synchronised();
    for (std::size_t i = 0; i < constants_.mass.size(); ++i)
        for (const Lanes vector : {s.node[i].x, s.node[i].v})
            y.insert(y.end(), {vector[0], vector[1], vector[2]});
    y.push_back(s.added_mass);
    return y;
}

void Simulation::rates(double time, std::span<const double> unknowns, std::span<double> rates) {
    State& s = state_;
    stored_step_ = s.step;
    s.time = time;
    s.added_mass = unknowns.back();
    for (std::size_t i = 0; i < constants_.mass.size(); ++i) {
        const std::span<const double> y = unknowns.subspan(6 * i, 6);
        s.node[i] = {Lanes{y[0], y[1], y[2], 0.0}, Lanes{y[3], y[4], y[5], 0.0}};
    }
    update_sums(s, constants_);
    renew_air();
    clear_forces(s);
    for (const auto& model : structure_)
        model->add_forces(s);
    note_riser_force(s, mesh_.payload());
    for (const auto& model : loads_)
        model->add_forces(s);
    for (std::size_t i = 0; i < constants_.mass.size(); ++i) {
        const double inertia = constants_.mass[i] + constants_.share[i] * s.added_mass;
        Lanes a = (s.force[i].value + s.aero[i].value) / splat(inertia);
        a[2] -= constants_.gravity * constants_.mass[i] / inertia;
        const std::span<double> f = rates.subspan(6 * i, 6);
        for (int c = 0; c < 3; ++c) {
            f[c] = s.node[i].v[c];
            f[3 + c] = a[c];
        }
    }
    rates.back() = added_mass_after(0.0).rate;
}

CriticalStep Simulation::bound() const {
    PerronScaling weights;
    weights.begin(synchronised(), constants_, structure_, find_block(structure_, Block::lines));
    return critical_step(state_, constants_, structure_, loads_, weights.by_node());
}

ChosenStep Simulation::step_with(double added_mass, double fe_weight) {
    State state = synchronised();
    state.added_mass = added_mass;
    state.fe_weight = fe_weight;
    state.folded = false;
    return steps_.forecast(state, step_inputs());
}

std::vector<PlanArray> Simulation::arrays() const {
    std::vector<PlanArray> all;
    add_bytes(all, "node records",
              bytes_of(state_.node) + bytes_of(state_.v_half) + bytes_of(state_.force.held()) +
                  bytes_of(state_.aero.held()));
    add_bytes(all, "mesh",
              bytes_of(mesh_.position) + bytes_of(mesh_.mass) + bytes_of(mesh_.tributary_area) +
                  bytes_of(mesh_.triangles) + bytes_of(mesh_.cables));
    add_bytes(all, "node constants", bytes_of(constants_.mass) + bytes_of(constants_.share));
    const StaticLine& tether = mesh_.static_line;
    add_bytes(all, "static line",
              bytes_of(tether.position) + bytes_of(tether.mass) + bytes_of(tether.cables));
    for (const ForceModels* models : {&structure_, &loads_})
        for (const auto& model : *models)
            add_bytes(all, model->name(), model->bytes());
    for (const PlanArray& array : layout_->arrays())
        add_bytes(all, array.name, array.bytes);
    return all;
}

// --- checkpoints -------------------------------------------------------------------------------------

void Simulation::take_shape(bool tethered, std::size_t reefing_stage) {
    if (!tethered && !mesh_.static_line.cables.empty()) drop_static_line();
    if (state_.stage != Stage::deployment) lines_ = {};
    if (reefing_stage > 0) {
        set_reefing_line(reefing_stage);
        layout_ = make_layout_(scene_, mesh_, constants_);
    }
    build_blocks();
}

void Simulation::serialize(Archive& archive) {
    State& s = archive.reads() ? state_ : synchronised();
    archive.same("mesh", mesh_digest(mesh_), "is of another mesh");
    archive.same("layout", std::string(layout_->name()), "is of another layout of nodes and elements");
    archive.same("instruction set", fmt::format("{}, {}", layout_->instruction_set(), lane_instruction_set()),
                 "is of another instruction set");
    bool tethered = !mesh_.static_line.cables.empty();
    std::size_t reefing_stage = reefing_stage_;
    archive.choice("stage", s.stage, Stage::flight);
    archive.flag("static line", tethered);
    archive.whole("reefing stage", reefing_stage, 0, scene_.parachutes.front().reefing.size());
    clock_.serialize(archive);
    if (archive.reads()) take_shape(tethered, reefing_stage);
    fullsim::serialize(archive, s);
    stored_step_ = s.step;
    layout_->serialize(archive, s);
    const Parachute& chute = scene_.parachutes.front();
    twinchute::serialize(archive, inflation_, chute.drag_area_law,
                         chute.drag_area_table ? &*chute.drag_area_table : nullptr);
    for (double* x : {&ramp_start_, &ramp_time_, &ramp_energy_})
        archive.number("ramp", *x);
    archive.number("full at", full_at_);
    archive.flag("settled", settled_);
    steps_.serialize(archive);
    archive.whole("element steps", element_steps_, 0);
    archive.whole("first step", first_step_, 0);
    fullsim::serialize(archive, sound_loads_);
}

}  // namespace twinchute::fullsim
