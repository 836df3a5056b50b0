#include "fullsim/run/full_run.hpp"

#include <cmath>
#include <utility>

#include "fullsim/run/results.hpp"
#include "lib/models/snatch.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int steps_between_falls = 10;  // samples of the fall: some ten a bounce, of lines that are short
constexpr int steps_between_reports = 500;

}  // namespace

FullRun::FullRun(const Scene& scene, std::span<const double> stated_masses, Run& run, const Attempts& before)
    : before_(before),
      scene_(scene),
      run_(run),
      record_(begin_record(scene, "full")),
      cluster_(
          scene,
          [threads = has_several_canopies(scene) ? 1 : run.threads, any = run.force_unstructured](
              const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
              return any ? make_unstructured_layout(s, mesh, constants, nullptr, threads)
                         : make_layout(s, mesh, constants, threads);
          },
          run.threads),
      stages_(has_stages(scene) ? std::make_unique<Stages>(scene) : nullptr),
      recorder_(scene, stated_masses, run, cluster_, stages_.get()),
      fall_(scene.environment),
      stop_time_(scene.stop.kind == Trigger::Kind::time ? scene.stop.value + scene.stop.delay
                                                        : longest_flight),
      clock_(run, scene.full.checkpoint_interval) {
    if (stages_) cluster_.watch(stages_->watch());
}

void FullRun::fly() {
    begin();
    while (!ended_) {
        // Right after a check no frame of the fields waits for the next one.
        if (cluster_.step() % Simulation::steps_between_checks == 1) save_if_due();
        if (!std::exchange(evaluated_, false)) cluster_.evaluate_forces();
        recorder_.observe();
        look_for_events();
        // An end between two checks must not hide what the next one would have found.
        if (ended_ && !is_numerical_failure(record_.status.code)) check_end();
        if (ended_) break;
        cluster_.step_to(next_stop());
        if (cluster_.was_checked()) check();
    }
}

RunRecord FullRun::finish() {
    recorder_.finish(!is_numerical_failure(record_.status.code));
    record_.events = recorder_.take_events();
    note_squid();
    if (cluster_.size() > 0) {
        const Layout& layout = std::as_const(cluster_)[0].layout();
        record_.provenance.instruction_set = fmt::format("{}, {}", layout.instruction_set(), layout.name());
        record_.provenance.threads = std::max(layout.threads(), cluster_.threads());
    }
    fill_cost();
    // The end of the run is steady, too, or its last window says that it is not.
    if (const auto last = judge_fall()) {
        found().last_window = last;
        if (found().descent && last->is_steady()) found().descent = last;
    }
    const std::vector<RunView> each = recorder_.canopy_views();
    if (stages_) {
        if (cluster_.out().empty()) {  // it lands by itself
            found().descent.reset();
            found().descent_altitude.reset();
        }
        for (const std::size_t k : cluster_.out())
            if (went_through_itself(each[k])) found().descent.reset();
        const std::vector<RunView> parachutes = recorder_.parachute_views();
        fill_results_of_stages({scene_, cluster_, stages_->sequence, observer(), found(),
                                stages_->openings(parachutes, observer())},
                               parachutes, each, record_);
    } else {
        if (went_through_itself(view())) found().descent.reset();
        fill_results(view(), each, record_);
    }
    recorder_.fill(record_);
    if (scene_.full.row_rate() > scene_.full.output_rate) thin_out(record_.channels, scene_.full.output_rate);
    note_attempts();
    return std::move(record_);
}

void FullRun::begin() {
    if (!run_.checkpoints.from.empty()) return go_on_from(run_.checkpoints.from);
    if (stages_) {
        recorder_.add_event("release");
        follow_sequence(false);
        begun_ = evaluated_ = true;
        if (ended_) recorder_.observe();  // a record has at least one row
        return;
    }
    settle(0);
    recorder_.add_event(view().packed() ? "release" : view().inflated() ? "full-open" : "line-stretch");
    if (!view().packed()) met(view().inflated() ? Trigger::Kind::full_open : Trigger::Kind::line_stretch);
}

/// Canopies of a parachute from its first on, where they come out open.
void FullRun::settle(std::size_t first) {
    if (recorder_[first].view().inflated()) cluster_.settle(first, [this] { return clock_.may_stop(); });
}

double FullRun::next_stop() const {
    double next = std::min(stop_time_, event_stop_);
    if (stages_) next = std::min(next, stages_->sequence.next_time());
    for (const std::size_t k : cluster_.out())
        next = std::min(next, recorder_[k].next_stop());
    return next;
}

void FullRun::fail(const RunStatus& fault) {
    recorder_.forget();
    end(fault.code, fault.detail);
}

void FullRun::check() {
    if (const auto fault = cluster_.fault()) return fail(*fault);
    recorder_.accept();
    recorder_.tell_watchers();
    if (clock_.may_stop()) return end(StatusCode::interrupted, "stopped on request");
    // Checks follow the step whose number they divide.
    if (run_.progress && cluster_.step() % steps_between_reports == 1) report_progress();
}

void FullRun::check_end() {
    if (const auto fault = cluster_.find_fault()) {
        found().landing_time.reset();
        fail(*fault);
    }
}

void FullRun::save_if_due() {
    if (!clock_.is_due()) return;
    Archive archive;
    serialize(archive);
    clock_.save(archive.take());
}

void FullRun::go_on_from(const std::string& saved) {
    Archive archive(saved, run_.checkpoints.file);
    serialize(archive);
    archive.end();
    record_.cost.resumed_at.push_back(cluster_.time());
    if (run_.progress) report_progress();
}

std::string_view FullRun::stage_name() const {
    if (cluster_.out().empty()) return "free flight";
    const SystemState& s = stages_ ? cluster_[cluster_.out().back()].system() : view().simulation().system();
    if (any_deploys()) return "deployment";
    switch (s.phase) {
        case Phase::initial:
            return "initial phase";
        case Phase::filling:
            return "filling";
        case Phase::overshoot:
            return "over-inflation";
        case Phase::open:
            break;
    }
    return "descent";
}

bool FullRun::all_open() const {
    return !cluster_.out().empty() && std::ranges::all_of(cluster_.out(), [&](std::size_t k) {
        return recorder_[k].system().phase == Phase::open;
    });
}

double FullRun::drag_area_steady() const {
    if (!stages_) return view().drag_area_steady();
    double steady = stages_->sequence.is_settled() ? 0.0 : infinity;
    for (const std::size_t k : cluster_.out())
        steady = std::max(steady, recorder_[k].view().drag_area_steady());
    return steady;
}

double FullRun::expected_share() const {
    if (scene_.stop.kind == Trigger::Kind::time) return std::min(0.99, cluster_.time() / stop_time_);
    if (scene_.stop.kind == Trigger::Kind::ground || scene_.stop.kind == Trigger::Kind::altitude) {
        const double end =
            scene_.stop.kind == Trigger::Kind::ground ? scene_.environment.ground : scene_.stop.value;
        const double fall = scene_.release.altitude - end,
                     fallen = scene_.release.altitude - cluster_.payload().position.z();
        return fall > 0.0 ? std::clamp(fallen / fall, 0.0, 0.99) : 0.0;
    }
    if (stages_ || any_deploys()) return 0.0;
    const Inflation& inflation = view().simulation().inflation();
    return std::min(0.99, cluster_.time() / (inflation.snatch + 4.0 * inflation.filling_time + 2.0));
}

void FullRun::look_for_events() {
    const bool waits = stages_ ? stages_->sequence.waits_for_steady_descent() && all_open()
                               : std::ranges::any_of(cluster_.out(), [&](std::size_t k) {
                                     return recorder_[k].waits_for_steady_descent();
                                 });
    const bool steady = waits && falls_steadily();
    for (const std::size_t k : cluster_.out()) {
        CanopyRun& canopy = recorder_[k];
        for (const char* name : canopy.look(steady))
            happened(k, name);
        if (canopy.ending() && !ended_) end(canopy.ending()->code, canopy.ending()->detail);
    }
    if (stages_ && !ended_) follow_sequence(steady);
    if (!ended_ && !any_deploys()) look_for_descent();
    if (!ended_) look_for_recontact();
    if (!ended_) look_for_ground();
    if (!ended_) look_for_stop();
}

void FullRun::follow_sequence(bool falls_steadily) {
    OpeningSequence& sequence = stages_->sequence;
    const FlightState now = stages_->flight_state(cluster_.payload());
    if (falls_steadily) {
        recorder_.add_event("steady-descent");
        sequence.descends_steadily(now);
    }
    const std::vector<OpeningEvent> events = sequence.advance(now);
    for (const std::size_t k : cluster_.out())
        while (recorder_[k].found().stages.size() <= recorder_[k].stage())
            recorder_[k].disreef();
    for (const OpeningEvent& what : events) {
        const auto own = canopy_of(what.index);
        if (what.kind == OpeningEvent::Kind::snatch && !own) leave_pack(what.index);
        if (what.kind == OpeningEvent::Kind::disreef) disreef(*own);
        if (what.kind == OpeningEvent::Kind::cut) cut(*own);
        if (what.kind == OpeningEvent::Kind::full_open && sequence.is_filled()) met(Trigger::Kind::full_open);
        if (ended_) return;
    }
    if (const auto leaves = sequence.leaves_pack(); leaves && !canopy_of(*leaves)) leave_pack(*leaves);
}

std::optional<std::size_t> FullRun::canopy_of(std::size_t parachute) const {
    for (std::size_t k = 0; k < cluster_.size(); ++k)
        if (cluster_.parachute(k) == parachute) return k;
    return {};
}

void FullRun::leave_pack(std::size_t parachute) {
    std::size_t joined = 0;
    try {
        joined = cluster_.join(parachute, stages_->carried_mass());
    } catch (const SceneError& error) {  // only its speed here shows it
        return end(StatusCode::refused,
                   fmt::format("{}: {}", scene_.parachutes[parachute].name, error.what()));
    }
    recorder_.add_canopies();
    settle(joined);
    recorder_.weigh_payload();
    fall_.restart();
    if (begun_) recorder_.observe_parachute(joined);  // nobody else does at this instant
    const RunView& joins = recorder_.parachute(joined);
    if (joins.packed()) {
        recorder_.add_event(parachute, "release");
        stages_->leaves_pack(cluster_.time(), observer());
        return recorder_.begin_deployment_frames();
    }
    if (!joins.inflated()) {
        recorder_.add_event(parachute, "line-stretch");
        for (const std::size_t k : recorder_.canopies_with(joined)) {
            cluster_[k].open_as(
                stages_->sequence.all()[stages_->first_canopy(parachute) + cluster_.number(k)].inflation);
            if (const auto refused = cluster_[k].refused_opening(
                    cluster_[k].inflation(), stages_->flight_state(cluster_.payload()).airspeed))
                return end(refused->code, refused->detail);
        }
    } else {
        recorder_.add_event(parachute, "full-open");
    }
    opens(joined);
}

void FullRun::opens(std::size_t k) {
    stages_->opens(cluster_.parachute(k), recorder_.parachute(k), recorder_.initial_phase(k), cluster_.time(),
                   observer());
    if (recorder_.parachute(k).inflated())
        recorder_.begin_descent_frames();
    else
        recorder_.begin_opening_frames();
    if (!stages_->sequence.any_waits_to_leave()) met(Trigger::Kind::line_stretch);
}

void FullRun::disreef(std::size_t k) {
    const std::size_t parachute = cluster_.parachute(k);
    recorder_.add_event(parachute, "disreef");
    stages_->disreefs(parachute, cluster_.time(), observer());
    recorder_.disreefed(k);
    fall_.restart();
}

void FullRun::cut(std::size_t first) {
    // Nothing looks at it any more after this.
    for (const std::size_t k : recorder_.canopies_with(first))
        if (const auto fault = cluster_[k].find_fault()) return fail(*fault);
    recorder_.observe_cut(first);
    recorder_.add_event(cluster_.parachute(first), "cut");
    cluster_.leave(first);
    recorder_.weigh_payload();
    fall_.restart();
}

void FullRun::happened(std::size_t k, const char* name) {
    if (!recorder_.happened(k, name)) return;
    const std::string_view what = name;
    if (what == "snatch") {
        if (stages_) return opens(k);
        recorder_.begin_opening_frames();
        met(Trigger::Kind::line_stretch);
    }
    if (what == "full-open" && !stages_) met(Trigger::Kind::full_open);  // with stages their sequence knows
}

void FullRun::look_for_descent() {
    const double now = cluster_.time();
    look_at_fall();
    // Not before there is a shape to report.
    if (all_open() && !found().descent_altitude && now >= drag_area_steady() + shape_average &&
        falls_steadily()) {
        recorder_.add_event("steady-descent");
        found().descent = found().last_window;
        found().descent_altitude = cluster_.payload().position.z();
        if (scene_.stop.kind == Trigger::Kind::steady_descent ||
            scene_.stop.kind == Trigger::Kind::peak_force)
            event_stop_ = now + scene_.stop.delay;
    }
    if (scene_.stop.kind == Trigger::Kind::peak_force && event_stop_ == longest_flight &&
        now > drag_area_steady() && is_past_peak())
        event_stop_ = now + scene_.stop.delay;
}

bool FullRun::is_past_peak() {
    const double now = cluster_.time();
    if (!(observer().filtered_force() < past_peak * observer().peak().value)) {
        below_peak_since_ = infinity;
        return false;
    }
    below_peak_since_ = std::min(below_peak_since_, now);
    double bounce = 0.0;
    for (const std::size_t k : cluster_.out()) {
        const Simulation& canopy = cluster_[k];
        const double air = canopy.constants().canopy_mass + canopy.system().added_mass;
        const double mass = reduced_mass(scene_.payload.mass, air);
        bounce =
            std::max(bounce, 2.0 * pi * std::sqrt(mass / line_stiffness(recorder_[k].view().parachute())));
    }
    return now - below_peak_since_ >= bounce;
}

void FullRun::look_for_recontact() {
    constexpr double near = 0.1;  // of D0, from the middle of the fabric
    for (const std::size_t k : cluster_.out()) {
        if (recorder_[k].deploys()) continue;
        const Vec3 apart = cluster_[k].system().sums.canopy_position - to_vec3(cluster_[k].payload().x);
        if (apart.norm() >= near * recorder_[k].view().parachute().nominal_diameter) continue;
        std::optional<double>& met = recorder_[k].found().met_payload;
        if (!met) met = cluster_.time();
        if (scene_.full.contact != Contact::gores) continue;  // others go on, with a warning
        return end(StatusCode::stopped_by_event,
                   fmt::format("the payload and its canopy met at t = {:.4g} s", cluster_.time()));
    }
}

void FullRun::note_squid() {
    const StatusCode code = record_.status.code;
    if (code != StatusCode::completed && code != StatusCode::stopped_by_event &&
        code != StatusCode::time_limit)
        return;
    for (const std::size_t k : cluster_.out())
        if (const auto why = recorder_[k].squids())
            return end(StatusCode::squids,
                       fmt::format("{}: {}{}{}", record_.status.detail, cluster_.name_of(k),
                                   cluster_.name_of(k).empty() ? "" : ": ", *why));
}

void FullRun::note_attempts() {
    if (before_.count == 0) return;
    record_.cost.wall_s += before_.wall;
    record_.cost.cpu_s += before_.cpu;
    const double factor = scene_.full.time_step_factor;
    record_.warnings.push_back(
        {fmt::format("the run was repeated with half of its step, full.time_step_factor = {:g}", factor),
         fmt::format("at {:g} the energy did not add up: {}", 2.0 * factor, before_.ending),
         fmt::format("give the factor in the scene to spare the {:.2g} s before, or to keep a step as it is",
                     before_.wall)});
}

bool FullRun::falls_steadily() {
    if (cluster_.step() % Simulation::steps_between_checks != 0) return false;
    found().last_window = judge_fall();
    return found().last_window && found().last_window->is_steady();
}

std::optional<DescentWindow> FullRun::judge_fall() {
    auto window = fall_.judge(cluster_.payload().position.z());
    if (window && window->is_steady()) window->turns = observer().turns_since(window->from);
    return window;
}

FallSample FullRun::fall_now() const {
    const double gravity = scene_.environment.gravity;
    const auto count = static_cast<double>(cluster_.out().size());
    FallSample now;
    Vec3 air = Vec3::Zero(), arm = Vec3::Zero();
    for (const std::size_t k : cluster_.out()) {
        const Simulation& canopy = cluster_[k];
        const SystemState& s = canopy.system();
        const double material = canopy.constants().system_mass;
        air += s.air.airspeed * s.air.direction / count;  // relative to the canopy
        arm += (s.sums.canopy_position - to_vec3(canopy.payload().x)) / count;
        now.density += s.air.density / count;
        now.airspeed += s.air.airspeed / count;
        now.updraft += s.air.wind.z() / count;
        now.system_sink -= s.sums.system_velocity.z() / count;
        now.air_sink -= s.sums.canopy_area_velocity.z() / count;
        now.added_mass_ratio += s.added_mass / material / count;
        now.accretion += accretes_ ? s.accretion() / material / count : 0.0;
        now.growth += accretes_ ? s.added_mass_rate / material / count : 0.0;
        now.area += s.air.projected_area / count;
    }
    const double length = arm.norm(), sink = air.z();
    now.time = cluster_.time();
    now.sink = sink;
    now.swing = air.squaredNorm() - sink * sink + 2.0 * gravity * (length - arm.z());
    now.period = 2.0 * pi * std::sqrt(length / gravity);
    now.across = {air.x(), air.y()};
    return now;
}

void FullRun::look_for_ground() {
    if (cluster_.payload().position.z() > scene_.environment.ground) return;
    recorder_.add_event("ground");
    found().landing_time = cluster_.time();
    if (any_deploys()) return end(StatusCode::stopped_by_event, "ground reached before the lines came taut");
    return scene_.stop.kind == Trigger::Kind::ground
               ? end(StatusCode::completed, "ground reached")
               : end(StatusCode::stopped_by_event, "ground reached before the stop condition");
}

void FullRun::look_for_stop() {
    const double now = cluster_.time();
    if (scene_.stop.kind == Trigger::Kind::altitude && event_stop_ == longest_flight &&
        cluster_.payload().position.z() <= scene_.stop.value)
        met(Trigger::Kind::altitude);
    if (now < std::min(stop_time_, event_stop_)) return;
    if (stop_time_ <= now && scene_.stop.kind != Trigger::Kind::time)
        end(StatusCode::time_limit,
            fmt::format("stop condition not met within {:g} s of flight, stop at what comes sooner, e.g. "
                        "stop.time or stop.altitude",
                        stop_time_));
    else
        end(StatusCode::completed, "stop condition met");
}

void FullRun::fill_cost() {
    Cost& cost = record_.cost;
    cost.wall_s = clock_.wall();
    cost.cpu_s = clock_.cpu();
    cost.steps = cluster_.all_steps();
    cost.rhs_calls = cost.steps;
    for (std::size_t k = 0; k < cluster_.size() && cost.steps > 0; ++k) {
        const StepControl& steps = cluster_[k].steps();
        cost.dt_min_s = k == 0 ? steps.dt_min() : std::min(cost.dt_min_s, steps.dt_min());
        cost.dt_max_s = std::max(cost.dt_max_s, steps.dt_max());
    }
    cost.element_steps = cluster_.element_steps();
    if (cost.element_steps > 0)
        cost.ns_per_element_step = 1e9 * cost.wall_s / static_cast<double>(cost.element_steps);
    cost.blocks = cluster_.block_costs();
}

void FullRun::look_at_fall() {
    if (!all_open()) return fall_.restart();
    if (cluster_.step() % steps_between_falls == 0) fall_.add(fall_now());
}

void FullRun::serialize(Archive& archive) {
    before_.serialize(archive);
    cluster_.serialize(archive);
    if (stages_) stages_->serialize(archive);
    recorder_.serialize(archive);
    begun_ = true;
    fall_.serialize(archive);
    for (double* x : {&event_stop_, &below_peak_since_})
        archive.number("run", *x);
    clock_.serialize(archive);
    archive.numbers("resumed at", record_.cost.resumed_at);
}

}  // namespace twinchute::fullsim
