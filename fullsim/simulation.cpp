#include "fullsim/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "fullsim/mesh/start.hpp"
#include "fullsim/serialize_state.hpp"
#include "fullsim/time/aero_reference.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double smallest_step = 1e-9;      // [s] below which nothing would ever finish
constexpr double largest_residual = 0.002;  // of the energy that changed hands; sound runs: 1e-5 to 1e-4
constexpr double memory_of_rate = 0.8;      // from one bound to the next, of the fastest slap
constexpr double few_impacts = 0.4;         // of that, which impacts of a canopy drawn out may use
constexpr std::int64_t most_steps = 2'000'000'000;
// Times over D0/v: of the added mass toward the open canopy's shape, of the ramp where the scene gives none.
constexpr double relaxation = 0.1 / time_scale_of_c9, ramp_share = 0.15 / time_scale_of_c9;
constexpr double taut_lines = 0.8;    // share of line elements in tension at snatch (paper, 5.2)
constexpr double taut_risers = 0.05;  // riser load at snatch over the payload's weight
constexpr double cut_line = 10.0;     // length of a reefing line that no longer holds, over pi D0
constexpr double never = std::numeric_limits<double>::infinity();

Phase first_phase(const Scene& scene, const Inflation& inflation) {
    if (scene.parachutes.front().deploy.by == DeployBy::inflated) return Phase::open;
    return inflation.initial_time > 0.0 ? Phase::initial : Phase::filling;
}

/// A packed canopy's is made at snatch; until then none of it has a time.
Inflation first_inflation(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    if (chute.deploy.by == DeployBy::inflated) return inflated(chute);
    if (chute.deploy.by == DeployBy::line_stretch)
        return make_inflation(scene, chute, 0.0, release_airspeed(scene).norm(),
                              scene.environment.atmosphere.at(scene.release.altitude).density);
    Inflation inflation;
    inflation.snatch = never;
    return inflation;
}

/// Uniform in [-1, 1), the same on every platform (std::uniform_real_distribution is not).
double uniform(std::mt19937_64& generator) {
    return static_cast<double>(static_cast<std::int64_t>(generator())) * 0x1p-63;
}

Mesh make_mesh(const Scene& scene, const Inflation& inflation, MassScaling& scaling) {
    Mesh mesh = start_mesh(scene, inflation, first_phase(scene, inflation));
    if (const double share = scene.full.mass_scaling; share > 0.0) {
        const double rho = scene.environment.atmosphere.at(scene.release.altitude).density;
        const auto& added = scene.aerodynamics.added_mass;
        const double radius = steady_radius(scene.parachutes.front());
        scaling =
            scale_masses(scene, share, added ? added->mass(rho, {radius, 0.0}, {1.0, 0.0}).value : 0.0, mesh);
    }
    return mesh;
}

State initial_state(const Scene& scene, const Mesh& mesh) {
    State state;
    const StaticLine& tether = mesh.static_line;
    const std::size_t count =
        static_cast<std::size_t>(mesh.first_static_line_node()) + tether.position.size();
    state.node.resize(count);
    state.v_half.resize(count);
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
    const NodeIndex dummy = mesh.dummy();
    state.node[dummy] = {splat(0.0), splat(0.0)};
    state.v_half[dummy].value = splat(0.0);
    for (std::size_t k = 0; k < mesh.places.size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(mesh.first_place()) + k;
        state.node[i] = {to_lanes(origin + mesh.places[k]), to_lanes(velocity)};
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
    return state;
}

}  // namespace

Simulation::Simulation(const Scene& scene, const LayoutMaker& layout, std::span<const ForceBlock> blocks)
    : scene_(scene),
      make_layout_(layout),
      blocks_(blocks),
      inflation_(first_inflation(scene)),
      mesh_(make_mesh(scene, inflation_, mass_scaling_)),
      constants_(node_constants(mesh_, scene.environment.gravity)),
      body_(make_body(scene, mesh_)),
      state_(initial_state(scene, mesh_)),
      layout_(make_layout_(scene, mesh_, constants_)),
      dt_min_(never) {
    for (const Cable& c : mesh_.cables)
        if (std::max(c.node[0], c.node[1]) >= mesh_.first_place())
            riser_stiffness_ =
                std::max(riser_stiffness_, c.strands * mesh_.cord(c.kind).axial_stiffness() / c.rest_length);
    line_waves_ = line_waves(mesh_, constants_, scene.parachutes.front().line_length,
                             scene.full.bulk_viscosity, scene.full.beta);
    state_.phase = first_phase(scene, inflation_);
    if (body_) body_->start(state_, mesh_.axis);
    if (scene.parachutes.front().deploy.starts_packed()) {
        state_.stage = stages_of(scene).front();
        state_.fe_weight = scene.full.structure == Structure::fe ? 1.0 : 0.0;
        std::ranges::copy_if(mesh_.cables, std::back_inserter(lines_),
                             [](const Cable& c) { return c.kind == CableKind::line; });
    }
    build_blocks();
    if (state_.stage == Stage::deployment) {
        cloth_lengthens();
        state_.folded = scene.full.structure != Structure::fe && cloth_strain_ < nearly_taut;
        if (!state_.folded) impacts_.expect();
    }
    update_sums(state_, constants_);
    update_air(state_, scene.environment, mesh_.payload(), constants_.system_mass, 0.0);
    if (scene.aerodynamics.added_mass && state_.stage == Stage::flight)
        state_.added_mass = inflation_
                                .added_mass(*scene.aerodynamics.added_mass, state_.phase, state_.time,
                                            state_.air.density, steady_radius(scene.parachutes.front()))
                                .value;
    state_.energy.kinetic_start = kinetic_energy(state_, constants_);
    state_.energy.elastic_start = elastic_energy(state_, structure_);
    refresh_step();
}

State& Simulation::whole() const {
    if (lags_) layout_->store(state_);
    lags_ = false;
    return state_;
}

const State& Simulation::seams() const {
    if (lags_) layout_->store_seams(state_);
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
    layout_->begin(state_, structure_, loads_);
    elements_ = layout_->elements(structure_);
}

void Simulation::renew_air() {
    State& s = state_;
    update_air(s, scene_.environment, mesh_.payload(), constants_.system_mass,
               air_mass_in_reference(s.added_mass, s.time - inflation_.end_of(Phase::filling), time_scale()));
    if (s.stage != Stage::deployment) {
        s.air.drag_area = inflation_.steady_drag_area * inflation_.drag_area_ratio(s.phase, s.time).value;
        if (const auto& table = scene_.parachutes.front().drag_area_mach_table)
            s.air.drag_area *= table->factor(
                s.air.airspeed / *scene_.environment.atmosphere.speed_of_sound(s.node[mesh_.payload()].x[2]));
        s.air.radial_pressure = scene_.aerodynamics.radial_pressure * inflation_.ramp(s.phase, s.time).value;
        s.added_mass_rate = added_mass_after(0.0).rate;
    }
}

void Simulation::evaluate_forces() {
    State& s = state_;
    renew_air();
    if (s.stage == Stage::ramp) grow_ramp();

    clock_.begin_step(s.step % steps_between_bounds == 0);
    layout_->evaluate(s, clock_);
    if (body_) body_->gather(s, mesh_.payload(), mesh_.first_place());
    if (s.air.pressure_capped) ++s.capped_steps;
}

std::vector<double> Simulation::unknowns() const {
    std::vector<double> y;
    y.reserve(6 * constants_.mass.size() + 1);
    const State& s = whole();
    for (std::size_t i = 0; i < constants_.mass.size(); ++i)
        for (const Lanes vector : {s.node[i].x, s.node[i].v})
            y.insert(y.end(), {vector[0], vector[1], vector[2]});
    y.push_back(s.added_mass);
    return y;
}

void Simulation::rates(double time, std::span<const double> unknowns, std::span<double> rates) {
    State& s = state_;
    lags_ = false;
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
    s.riser_force = to_vec3(s.force[mesh_.payload()].value);
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

bool Simulation::lines_are_taut() const {
    const double weight = scene_.payload.mass * scene_.environment.gravity;
    if (state_.riser_force.norm() <= taut_risers * weight) return false;
    const State& s = whole();
    const auto taut = std::ranges::count_if(lines_, [&](const Cable& c) {
        const Lanes d = s.node[c.node[1]].x - s.node[c.node[0]].x;
        return sum3(d * d) > c.rest_length * c.rest_length;
    });
    return static_cast<double>(taut) >= taut_lines * static_cast<double>(lines_.size());
}

std::optional<RunStatus> Simulation::snatch() {
    const Vec3 airspeed = state_.sums.system_velocity - state_.air.wind;
    const Inflation inflation =
        make_inflation(scene_, scene_.parachutes.front(), state_.time, airspeed.norm(), state_.air.density);
    if (!(inflation.initial_time < inflation.filling_time) || !std::isfinite(inflation.filling_time))
        return RunStatus{StatusCode::refused,
                         fmt::format("a snatch at {:.4g} m/s gives an initial phase of {:.4g} s, not shorter "
                                     "than the filling time of {:.4g} s",
                                     airspeed.norm(), inflation.initial_time, inflation.filling_time)};
    inflation_ = inflation;
    state_.phase = first_phase(scene_, inflation_);
    if (!mesh_.static_line.cables.empty()) let_static_line_go();
    lines_ = {};
    start_anew(whole());
    // The air that the canopy holds from now on is at its speed: booked as work of the added mass.
    const double before = kinetic_energy(whole(), constants_);
    state_.stage = stages_of(scene_)[1];
    state_.added_mass = added_mass_after(0.0).value;
    state_.energy.added_mass += kinetic_energy(state_, constants_) - before;
    change_stage(state_.stage);
    return std::nullopt;
}

void Simulation::let_static_line_go() {
    double carried_off = static_line_kinetic_energy(whole(), constants_);
    std::erase_if(structure_, [&](const auto& model) {
        if (model->name() != "static line") return false;
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

/// The same round the mouth; a line that is cut is one that never comes taut.
void Simulation::set_reefing_line(std::size_t stage) {
    const Parachute& chute = scene_.parachutes.front();
    const double length = stage == chute.reefing.size() ? cut_line * pi * chute.nominal_diameter
                                                        : reefing_line_length(chute, stage);
    reefing_stage_ = stage;
    for (const std::size_t c : mesh_.reefing_line)
        mesh_.cables[c].rest_length = length / static_cast<double>(mesh_.reefing_line.size());
}

void Simulation::disreef(const Inflation& inflation, std::size_t stage) {
    const double before = elastic_energy(whole(), structure_);
    set_reefing_line(stage);
    layout_ = make_layout_(scene_, mesh_, constants_);
    build_blocks();
    state_.energy.ramp += elastic_energy(state_, structure_) - before;
    inflation_ = inflation;
    state_.phase = Phase::filling;
    refresh_step();
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
    return state_.stage == Stage::ramp ? ramp_start_ + ramp_time_ : never;
}

/// The stiffness of the finite elements at state().time, w = (t/T)^3, and the energy that its growth under
/// strain has brought in since the last step.
void Simulation::grow_ramp() {
    State& s = state_;
    const double share = std::min(1.0, (s.time - ramp_start_) / ramp_time_);
    const double weight = share * share * share, before = s.fe_weight;
    const double energy = layout_->membrane_energy(s);
    s.energy.ramp += 0.5 * (weight - before) * (ramp_energy_ + energy);
    s.fe_weight = weight;
    ramp_energy_ = energy;
}

/// New blocks from here on. What springs or elements that go held in store is taken out of the ledger.
void Simulation::change_stage(Stage stage) {
    State& s = state_;
    const double before = elastic_energy(whole(), structure_);
    s.stage = stage;
    s.folded = false;
    build_blocks();
    s.energy.ramp += elastic_energy(s, structure_) - before;
    refresh_step();
    evaluate_forces();
}

ValueAndRate Simulation::added_mass_after(double dt) const {
    if (!scene_.aerodynamics.added_mass || state_.stage == Stage::deployment) return {};
    const AddedMassSpec& spec = *scene_.aerodynamics.added_mass;
    const double rho = state_.air.density;
    const bool reefed = inflation_.share < 1.0;
    if (state_.phase != Phase::open || reefed || spec.open_radius == AddedMassRadius::drag_area)
        return inflation_.added_mass(spec, state_.phase, state_.time + dt, rho,
                                     steady_radius(scene_.parachutes.front()));
    // Once open, the air belongs to the shape that the canopy really has.
    const double radius = std::sqrt(state_.air.projected_area / pi);
    const double missing = spec.mass(rho, {radius, 0.0}, {1.0, 0.0}).value - state_.added_mass;
    const double time = relaxation * time_scale();
    const double gained = missing * -std::expm1(-dt / time);
    return {state_.added_mass + gained, (missing - gained) / time};
}

CriticalStep Simulation::bound() const {
    PerronScaling weights;
    const auto lines = std::ranges::find(structure_, "lines", &ForceModel::name);
    weights.begin(whole(), constants_, structure_, lines->get());
    return critical_step(state_, constants_, structure_, loads_, weights.by_node());
}

double Simulation::residual_share(const EnergyLedger& e) {
    return residual(e) / book_scale(state_.energy);
}

ChosenStep Simulation::choose_step(const State& state, double share) {
    const CriticalSteps stable = layout_->critical_steps(state);
    StepRules rules;
    rules.factor = scene_.full.time_step_factor;
    rules.slaps = chatters_in(state);
    rules.share = share;
    // In a pack that only falls lines are slack.
    if (!state.folded) rules.quiet = resonance_limit(line_waves_, state.added_mass, stable.canopy);
    // A body takes steps with the canopy, and so does what hangs on it.
    if (body_)
        rules.payload = body_->critical_step(state, structure_, mesh_.first_place(), riser_stiffness_);
    else
        rules.most_subcycles = scene_.full.line_substeps;
    return fullsim::choose_step(stable, rules);
}

void Simulation::refresh_step() {
    const ChosenStep chosen = choose_step(state_, impacts_count() ? impacts_.share() : 1.0);
    step_ = chosen.dt;
    if (state_.stage == Stage::deployment && !state_.folded) {
        const double rate = cloth_lengthens();
        cloth_rate_ = std::max(std::abs(rate), memory_of_rate * cloth_rate_);
        step_ = std::min({step_, step_to_first_impact(cloth_strain_, rate), step_in_impacts(cloth_rate_)});
    }
    subcycles_ = chosen.subcycles;
}

ChosenStep Simulation::step_with(double added_mass, double fe_weight) {
    State state = whole();
    state.added_mass = added_mass;
    state.fe_weight = fe_weight;
    state.folded = false;
    return choose_step(state, 1.0);
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

double Simulation::cloth_lengthens() {
    const double strain = layout_->cloth_strain(state_), since = state_.time - cloth_seen_;
    const double rate = since > 0.0 ? (strain - cloth_strain_) / since : 0.0;
    cloth_strain_ = strain;
    cloth_seen_ = state_.time;
    return rate;
}

void Simulation::look_at_folds() {
    if (!state_.folded) return;
    // Cloth that is torn out may lack more than that and be taut two steps later.
    const double rate = cloth_lengthens();
    if (cloth_strain_ < nearly_taut && cloth_strain_ + 2.0 * rate * state_.dt < 0.0) return;
    state_.folded = false;
    impacts_.expect();
    refresh_step();
}

void Simulation::step_to(double end) {
    look_at_folds();
    const bool due = state_.step > 0 && state_.step % steps_between_bounds == 0;
    if (due) refresh_step();
    const double left = end - state_.time;
    const bool last = left <= step_;
    const double dt = last ? left : std::min(step_, 0.5 * left);
    most_subcycles_ = std::max(most_subcycles_, subcycles_);
    const double kick = 0.5 * (dt + state_.dt);
    state_.in_subcycles = {};

    checked_ = state_.step % steps_between_checks == 0;
    const bool watched =
        impacts_count() && (checked_ || (state_.step % steps_between_looks == 0 && impacts_.alert()) ||
                            impacts_.is_due(state_.energy.damping, book_scale(state_.energy)));
    state_.energy.weighs = checked_ || watched;
    const EnergiesAndStrains levels = state_.energy.weighs ? layout_->levels(state_) : EnergiesAndStrains{};
    const double began = state_.time, turned = turning(), added_mass = state_.energy.added_mass;

    layout_->advance(state_, dt, subcycles_, added_mass_after(dt).value);
    if (body_) body_->advance(state_, mesh_.payload(), mesh_.first_place(), kick, dt);
    lags_ = true;
    element_steps_ += static_cast<std::int64_t>(elements_.all + (subcycles_ - 1) * elements_.in_subcycles);
    state_.time = last ? end : state_.time + dt;
    if (!last) dt_min_ = std::min(dt_min_, dt);
    dt_max_ = std::max(dt_max_, dt);

    if (!state_.energy.weighs) return;
    const EnergyLedger ledger = ledger_before(state_, levels.elastic, turned, added_mass);
    if (checked_) fault_ = find_fault_in(levels, ledger, began, state_.step - 1);
    if (watched) watch_impacts(ledger);
}

void Simulation::watch_impacts(const EnergyLedger& ledger) {
    // A canopy that never was in a pack has few impacts: its steps are others than those of the same canopy
    // seen from a moving frame only where its books are about to be full.
    const double tolerated = scene_.parachutes.front().deploy.starts_packed() ? 0.0 : few_impacts;
    const double before = impacts_.share();
    impacts_.look(residual_share(ledger) / largest_residual, state_.energy.damping, tolerated);
    // Longer ones with the next bound.
    step_ *= std::min(1.0, impacts_.share() / before);
}

void Simulation::take_shape(bool tethered, std::size_t reefing_stage) {
    if (!tethered && !mesh_.static_line.cables.empty()) drop_static_line();
    if (state_.stage != Stage::deployment) lines_ = {};
    if (reefing_stage > 0) {
        set_reefing_line(reefing_stage);
        layout_ = make_layout_(scene_, mesh_, constants_);
    }
    lags_ = false;
    build_blocks();
}

void Simulation::serialize(Archive& archive) {
    State& s = archive.reads() ? state_ : whole();
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
    layout_->serialize(archive, s);
    const Parachute& chute = scene_.parachutes.front();
    twinchute::serialize(archive, inflation_, chute.drag_area_law,
                         chute.drag_area_table ? &*chute.drag_area_table : nullptr);
    for (double* x : {&step_, &dt_min_, &dt_max_, &ramp_start_, &ramp_time_, &ramp_energy_})
        archive.number("step", *x);
    for (double* x : {&cloth_strain_, &cloth_seen_, &cloth_rate_})
        archive.number("cloth strain", *x);
    impacts_.serialize(archive);
    archive.whole("substeps", subcycles_, 1);
    archive.whole("most substeps", most_subcycles_, 1);
    archive.whole("element steps", element_steps_, 0);
    fullsim::serialize(archive, sound_loads_);
}

std::string Simulation::first_bad_node(const State& state) const {
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i) {
        const Lanes both = state.node[i].x + state.node[i].v;
        if (std::isfinite(sum3(both))) continue;
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            if (std::ranges::count(mesh_.triangles[t].node, i))
                return fmt::format("node {}, fabric triangle {}", i, t);
        for (std::size_t c = 0; c < mesh_.cables.size(); ++c)
            if (std::ranges::count(mesh_.cables[c].node, i))
                return fmt::format("node {}, {} cable {}", i, cable_kind_name(mesh_.cables[c].kind), c);
    }
    return std::isfinite(state.added_mass) ? "a load" : "the added mass";
}

std::string Simulation::hardest_hit() const {
    const State& s = whole();
    double most = -1.0;
    std::string name = "elements";
    for (const auto& model : structure_)
        if (const StrainExtremum extreme = model->extreme(s); extreme.strain > most) {
            most = extreme.strain;
            name =
                fmt::format("{}, strained by {:.1f} %", model->element_name(extreme.element), 100.0 * most);
        }
    return name;
}

std::optional<RunStatus> Simulation::find_fault() {
    const EnergiesAndStrains levels = layout_->levels(state_);
    return find_fault_in(levels, ledger_of(levels), state_.time, state_.step);
}

std::optional<RunStatus> Simulation::find_fault_in(const EnergiesAndStrains& levels, const EnergyLedger& e,
                                                   double time, std::int64_t step) {
    const auto where = [&] { return fmt::format("at t = {:.6f} s, step {}", time, step); };
    // A sum, which a NaN cannot hide from; comparisons and maxima can lose it.
    const double everything = levels.kinetic + state_.sums.system_position.sum() +
                              state_.largest.line_tension + state_.largest.fabric_stress;
    if (!std::isfinite(everything))
        return RunStatus{StatusCode::not_finite,
                         fmt::format("{} {}; the time step is probably above the stable one",
                                     first_bad_node(whole()), where())};
    if (step_ < smallest_step)
        return RunStatus{
            StatusCode::step_too_small,
            fmt::format("critical time step {:.3g} s set by node {} {}", step_, bound().node, where())};
    for (std::size_t i = 0; i < structure_.size(); ++i)
        if (const double strain = levels.strain[i]; strain > scene_.full.strain_limit)
            return RunStatus{
                StatusCode::strain_limit,
                fmt::format("{} is strained by {:.1f} % (limit {:.1f} %) {}: it would have torn; a lighter "
                            "payload, a slower release or a slower filling loads it less, "
                            "full.strain_limit lets it stretch further",
                            structure_[i]->element_name(structure_[i]->extreme(whole()).element),
                            100.0 * strain, 100.0 * scene_.full.strain_limit, where())};
    // Written so that a NaN fails, too; energy that vanishes is as wrong as energy from nowhere.
    const double share = residual_share(e);
    if (!(std::abs(share) <= largest_residual)) {
        const bool lost = share < 0.0;
        return RunStatus{
            lost ? StatusCode::solver_failed : StatusCode::energy_grew,
            fmt::format(
                "{:.3g} J of energy {}, {:.1f} % of what changed hands, {}: the step of {:.2g} s is too "
                "long for impacts of {}; a smaller full.time_step_factor (now {:g}) brings shorter ones",
                std::abs(residual(e)), lost ? "were lost" : "came from nowhere", 100.0 * std::abs(share),
                where(), step_, hardest_hit(), scene_.full.time_step_factor)};
    }
    if (step >= most_steps)
        return RunStatus{StatusCode::step_limit,
                         fmt::format("{} steps are the most that a run may take, {}", most_steps, where())};
    sound_loads_ = state_.largest;
    return std::nullopt;
}

}  // namespace twinchute::fullsim
