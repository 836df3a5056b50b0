#include "fullsim/run/run_fullsim.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/run/checkpoint_clock.hpp"
#include "fullsim/run/fields.hpp"
#include "fullsim/run/findings.hpp"
#include "fullsim/run/frames.hpp"
#include "fullsim/run/plan.hpp"
#include "fullsim/run/results.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/filling_bracket.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int steps_between_falls = 10;  // samples of the fall: some ten a bounce, of lines that are short
constexpr int steps_between_reports = 500;
// How long lines have to stay taut, since flailing ones do not, over the time that a wave takes along them:
// 2 ms of a C-9's line (7.31 m of 462 kg/m^3 and 0.97 GPa).
const double taut_hold = 2e-3 / (7.31 * std::sqrt(462.0 / 9.7e8));
// Frames of a report: a deployment lasts tenths of a second to some seconds, breathing as long as filling.
constexpr FrameStretch deployment_frames{0.02, 20}, descent_frames{0.1, 16};
constexpr std::size_t opening_frames = 48;
constexpr double opening_and_breathing = 2.0;   // filling times, from snatch
constexpr double expected_fill_constant = 8.0;  // of a filling that is predicted, for frames alone
// A canopy squids that has grown by less than this share of its area over so many diameters of travel.
constexpr double least_growth = 0.01, squid_travel = 5.0;
constexpr double least_drag_area = 0.5;  // over (C_D S)_0, of a canopy that is still open at the end

/// Runs of the same scene before this one, of longer steps: their energy did not add up.
struct Attempts {
    static constexpr int most = 2;

    int count = 0;
    double wall = 0.0, cpu = 0.0;  ///< [s]
    std::string ending = {};       ///< of the last one

    void add(const RunStatus& status, const CheckpointClock& clock) {
        ++count;
        wall += clock.wall();
        cpu += clock.cpu();
        ending = status.detail;
    }
    void serialize(Archive& archive) {
        archive.whole("attempts", count, 0, most);
        archive.number("attempts", wall);
        archive.number("attempts", cpu);
        archive.text("attempts", ending);
    }
};

class FullRun {
public:
    /// The parachute weighs what its mesh does; `stated_mass`: what the scene says of it [kg].
    FullRun(const Scene& scene, double stated_mass, Run& run, const Attempts& before)
        : before_(before),
          scene_(scene),
          run_(run),
          record_(begin_record(scene, "full")),
          simulation_(scene,
                      [threads = run.threads, any = run.force_unstructured](const Scene& s, const Mesh& mesh,
                                                                            const NodeConstants& constants) {
                          return any ? make_unstructured_layout(s, mesh, constants)
                                     : make_layout(s, mesh, constants, threads);
                      }),
          observer_(simulation_.mesh(), scene.environment.gravity, scene.full.output_rate,
                    simulation_.sectors()),
          view_{scene, stated_mass, simulation_, observer_, found_, sequence_},
          fall_(scene.environment),
          fields_(simulation_.mesh(), scene.full.fields_rate, run.fields),
          frames_(simulation_.mesh(), static_cast<bool>(run.frames), simulation_.sectors()),
          stop_time_(scene.stop.kind == Trigger::Kind::time ? scene.stop.value + scene.stop.delay
                                                            : longest_flight),
          clock_(run, scene.full.checkpoint_interval) {
        if (!scene.parachutes.front().reefing.empty()) {
            sequence_.emplace(scene);
            sequence_->release(flight_state());
        }
        if (view_.packed()) {
            found_.snatch = infinity;
            observer_.count_peak_from(infinity);
            frames_.begin(0.0, deployment_frames);
        } else if (view_.inflated()) {
            begin_descent_frames();
        } else {
            begin_opening_frames();
        }
    }

    void fly() {
        begin();
        while (!ended_) {
            // Right after a check no frame of the fields waits for the next one.
            if (system().step % Simulation::steps_between_checks == 1) save_if_due();
            simulation_.evaluate_forces();
            observe();
            look_for_events();
            // An end between two checks must not hide what the next one would have found.
            if (ended_ && !is_numerical_failure(record_.status.code)) check_end();
            if (ended_) break;
            simulation_.step_to(next_stop());
            if (simulation_.was_checked()) check();
        }
    }
    const RunStatus& status() const { return record_.status; }
    const CheckpointClock& clock() const { return clock_; }

    /// Once, after fly().
    RunRecord finish() {
        // The rest of the fall begins where this ends, not at the last row before.
        if (!scene_.then.empty() && record_.status.code == StatusCode::completed)
            observer_.observe_end(simulation_.synchronised_state());
        observer_.finish();
        note_squid();
        fields_.accept();
        frames_.accept();
        if (run_.frames) run_.frames(frames_.finish());
        const Layout& layout = simulation_.layout();
        record_.provenance.instruction_set = fmt::format("{}, {}", layout.instruction_set(), layout.name());
        record_.provenance.threads = layout.threads();
        fill_cost();
        // The end of the run is steady, too, or its last window says that it is not.
        if (const auto last = judge_fall()) {
            found_.last_window = last;
            if (found_.descent && last->is_steady()) found_.descent = last;
        }
        if (went_through_itself(view_)) found_.descent.reset();
        fill_results(view_, record_);
        note_attempts();
        return std::move(record_);
    }

private:
    const SystemState& system() const { return simulation_.system(); }

    void begin() {
        if (!run_.checkpoints.from.empty()) return go_on_from(run_.checkpoints.from);
        add_event(view_.packed() ? "release" : view_.inflated() ? "full-open" : "line-stretch");
        if (!view_.packed()) met(view_.inflated() ? Trigger::Kind::full_open : Trigger::Kind::line_stretch);
    }

    void observe() {
        const double now = system().time;
        observer_.observe(system(), simulation_.payload_force());
        if (observer_.row_is_due(now)) observer_.add_row(simulation_.synchronised_state());
        if (fields_.frame_is_due(now)) fields_.observe(simulation_.synchronised_state());
        if (now >= descent_frames_from_) begin_descent_frames();
        if (frames_.frame_is_due(now)) frames_.observe(simulation_.synchronised_state());
    }

    const Deployment& deploy() const { return scene_.parachutes.front().deploy; }
    FlightState flight_state() const {
        const NodeRecord& payload = simulation_.payload();
        return {system().time, payload.x[2], payload.v[2],
                (system().sums.system_velocity - system().air.wind).norm(), system().air.density};
    }

    void end(StatusCode code, std::string detail) {
        record_.status = {code, std::move(detail)};
        ended_ = true;
    }

    void add_event(const char* name, double time, const Vec3& position, const Vec3& velocity) {
        record_.events.push_back({name, time, position.z(), velocity.norm()});
    }

    void add_event(const char* name) {
        const NodeRecord& payload = simulation_.payload();
        add_event(name, system().time, to_vec3(payload.x), to_vec3(payload.v));
    }

    /// Next time [s] that no step may cross.
    double next_stop() const {
        const double deployed = system().stage == Stage::deployment
                                    ? std::min({hold_end_, longest_deployment, next_load_change()})
                                    : std::min(simulation_.inflation().end_of(system().phase),
                                               simulation_.inflation().next_kink());
        const double cut = sequence_ ? sequence_->next_time() : infinity;
        return std::min({deployed, cut, simulation_.ramp_end(), stop_time_, event_stop_});
    }

    /// The next time at which the extraction force is not smooth.
    double next_load_change() const {
        const ForceHistory& force = deploy().extraction;
        double next = force.duration > system().time ? force.duration : infinity;
        for (const double t : force.time)
            if (t > system().time) next = std::min(next, t);
        return force.time.empty() ? infinity : next;
    }

    /// Ends the run and drops all that came after the last check that found nothing wrong.
    void fail(const RunStatus& fault) {
        observer_.forget();
        record_.events.resize(sound_events_);
        fields_.forget();
        frames_.forget();
        end(fault.code, fault.detail);
    }

    void check() {
        if (const auto& fault = simulation_.fault()) return fail(*fault);
        observer_.accept();
        sound_events_ = record_.events.size();
        fields_.accept();
        frames_.accept();
        tell_watchers();
        if (clock_.may_stop()) return end(StatusCode::interrupted, "stopped on request");
        // Checks follow the step whose number they divide.
        if (run_.progress && system().step % steps_between_reports == 1) report_progress();
    }

    void check_end() {
        if (const auto fault = simulation_.find_fault()) {
            found_.landing_time.reset();
            fail(*fault);
        }
    }

    /// Rows and shapes that have come since it was called last.
    void tell_watchers() {
        if (run_.rows) {
            const std::span<const HistoryRow> rows = observer_.final_rows();
            for (; told_rows_ < rows.size(); ++told_rows_)
                run_.rows({rows[told_rows_].time, rows[told_rows_].force, rows[told_rows_].velocity.norm()});
        }
        if (!run_.frames_so_far) return;
        const ShapeFrames& shape = frames_.so_far();
        if (shape.empty() || shape.frames.back().time <= told_frame_) return;
        told_frame_ = shape.frames.back().time;
        run_.frames_so_far(shape);
    }

    void report_progress() { run_.progress({stage_name(), system().time, expected_share(), resumed_at()}); }
    std::optional<double> resumed_at() const {
        if (record_.cost.resumed_at.empty()) return {};
        return record_.cost.resumed_at.back();
    }

    void save_if_due() {
        if (!clock_.is_due()) return;
        Archive archive;
        serialize(archive);
        clock_.save(archive.take());
    }

    void go_on_from(const std::string& saved) {
        Archive archive(saved, run_.checkpoints.file);
        serialize(archive);
        archive.end();
        record_.cost.resumed_at.push_back(system().time);
        if (run_.progress) report_progress();
    }

    void serialize(Archive& archive);

    void begin_opening_frames() {
        const Inflation& inflation = simulation_.inflation();
        const double filling = simulation_.predicts_filling()
                                   ? expected_fill_constant * scene_.parachutes.front().nominal_diameter /
                                         std::max(1.0, flight_state().airspeed)
                                   : inflation.end_of(Phase::filling) - inflation.snatch;
        const double lasts = opening_and_breathing * filling;
        frames_.begin(system().time, {lasts / opening_frames, opening_frames});
        descent_frames_from_ = system().time + lasts;
    }
    void begin_descent_frames() {
        frames_.begin(system().time, descent_frames);
        descent_frames_from_ = infinity;
    }
    std::string_view stage_name() const {
        if (system().stage == Stage::deployment) return "deployment";
        switch (system().phase) {
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

    /// A descent is usually steady four filling times after snatch; for the progress line only.
    double expected_share() const {
        if (scene_.stop.kind == Trigger::Kind::time) return std::min(0.99, system().time / stop_time_);
        if (system().stage == Stage::deployment) return 0.0;
        const Inflation& inflation = simulation_.inflation();
        return std::min(0.99, system().time / (inflation.snatch + 4.0 * inflation.filling_time + 2.0));
    }

    void look_for_events() {
        if (system().stage == Stage::deployment)
            look_for_snatch();
        else
            look_for_opening();
        if (!ended_) look_for_ground();
        if (!ended_) look_for_stop();
    }

    /// [s]
    double hold() const {
        const Parachute& chute = scene_.parachutes.front();
        return taut_hold * (chute.line_length * std::sqrt(chute.line.density / chute.line.youngs_modulus));
    }

    /// Lines count as taut once they have stayed so for a while; the end of that is the snatch.
    void look_for_snatch() {
        const double now = system().time;
        if (!simulation_.lines_are_taut()) {
            hold_end_ = infinity;
        } else if (hold_end_ == infinity) {
            hold_end_ = now + hold();
        }
        if (now < hold_end_) {
            if (now >= longest_deployment)
                end(StatusCode::time_limit,
                    fmt::format(
                        "the lines never came taut within {:g} s of release, check parachute.deploy and "
                        "payload.drag_area, or end the run before by stop.time",
                        longest_deployment));
            return;
        }
        found_.line_stretch_time = now - hold();
        found_.payload_snatch_speed =
            (to_vec3(simulation_.payload().v) - system().air.wind_at_payload).norm();
        const Vec3 airspeed = system().sums.system_velocity - system().air.wind;
        found_.snatch_speed = airspeed.norm();
        found_.snatch_path_angle = angle_below_horizon(airspeed);
        found_.snatch_density = system().air.density;
        if (const auto refused = simulation_.snatch()) return end(refused->code, refused->detail);
        if (sequence_) sequence_->snatched(0, flight_state());
        found_.snatch = now;
        add_event("snatch");
        begin_opening_frames();
        met(Trigger::Kind::line_stretch);
        observer_.count_peak_from(now + simulation_.inflation().initial_time);
    }

    void look_for_opening() {
        const double now = system().time;
        bool opens = false;
        if (simulation_.has_filled()) {
            simulation_.end_filling();
            if (sequence_) {
                sequence_->grown(0, {}, false, system().air.drag_area);
                sequence_->fills_up(0, now, !system().inflow.has_been_full);
            }
        }
        watch_growth();
        while (now >= simulation_.inflation().next_kink())
            simulation_.pass_kink();
        if (now >= simulation_.inflation().end_of(system().phase)) {
            opens = system().phase == Phase::filling;
            if (opens && !found_.stages.empty() && !found_.stages.back().full)
                found_.stages.back().full = now;
            if (system().phase != Phase::overshoot)
                add_event(!opens ? "end-of-initial-phase" : view_.reefed() ? "reefed-open" : "full-open");
            if (opens && !view_.reefed()) met(Trigger::Kind::full_open);
            // Drag area and phi are continuous here, only their rates jump: the forces just
            // evaluated are those of the phase that begins, too.
            simulation_.begin(simulation_.inflation().after(system().phase));
        }
        if (sequence_) look_for_disreef();
        if (system().stage == Stage::springs && (opens || simulation_.mouth_is_open())) {
            found_.switched_late = opens && !simulation_.mouth_is_open();
            simulation_.begin_ramp();
            add_event("switch");
        } else if (now >= simulation_.ramp_end()) {
            simulation_.end_ramp();
            add_event("finite-elements-alone");
        }
        look_at_fall();
        // Not before there is a shape to report.
        if (system().phase == Phase::open && !found_.descent_altitude &&
            now >= view_.drag_area_steady() + shape_average && falls_steadily()) {
            add_event("steady-descent");
            found_.descent = found_.last_window;
            found_.descent_altitude = simulation_.payload().x[2];
            if (scene_.stop.kind == Trigger::Kind::steady_descent ||
                scene_.stop.kind == Trigger::Kind::peak_force)
                event_stop_ = now + scene_.stop.delay;
        }
        if (scene_.stop.kind == Trigger::Kind::peak_force && event_stop_ == longest_flight &&
            now > view_.drag_area_steady() && observer_.filtered_force() < past_peak * observer_.peak().value)
            event_stop_ = now + scene_.stop.delay;
    }

    /// Whether a canopy whose filling is predicted still grows.
    void watch_growth() {
        if (!simulation_.predicts_filling() || system().phase == Phase::open) return;
        growth_.travelled += system().dt * system().air.airspeed;
        if (growth_.travelled < squid_travel * scene_.parachutes.front().nominal_diameter) return;
        const double area = system().air.projected_area;
        growth_ = {0.0, area, area < (1.0 + least_growth) * growth_.area};
    }
    /// A canopy that still squids at the end of a run has not opened, whatever ended it; nor has one that was
    /// full and fell in.
    void note_squid() {
        const StatusCode code = record_.status.code;
        if (!simulation_.predicts_filling() ||
            (code != StatusCode::completed && code != StatusCode::stopped_by_event &&
             code != StatusCode::time_limit))
            return;
        const bool open = system().phase == Phase::open;
        const bool fell_in = open && system().time >= view_.full_open() + shape_average &&
                             observer_.mean(&HistoryRow::drag_area, shape_average) <
                                 least_drag_area * simulation_.inflation().steady_drag_area;
        if (!fell_in && (open || !growth_.stands)) return;
        const auto critical = filling_canopy(scene_.parachutes.front()).critical_speed(system().air.density);
        const std::string opens =
            !critical ? "by the reduced-order balance it opens at any subsonic speed"
            : *critical == 0.0
                ? "by the reduced-order balance it opens at no speed"
                : fmt::format("by the reduced-order balance it opens below {:.4g} m/s", *critical);
        end(StatusCode::squids,
            fmt::format("{}: at {:.4g} m/s the canopy {} {:.3g} m^2 of projected area; {}; a larger "
                        "parachute.filling.initial_mouth fills it sooner",
                        record_.status.detail, system().air.airspeed,
                        fell_in ? "was full and fell in to" : "stands at", system().air.projected_area,
                        opens));
    }

    /// The canopies know when a line is cut; drag area and added mass go on from where they are.
    void look_for_disreef() {
        if (sequence_->waits_for_steady_descent() && system().phase == Phase::open && falls_steadily()) {
            add_event("steady-descent");
            sequence_->descends_steadily(flight_state());
        }
        for (const OpeningEvent& what : sequence_->advance(flight_state())) {
            if (what.kind != OpeningEvent::Kind::disreef) continue;
            const Canopy& canopy = sequence_->all().front();
            add_event("disreef");
            found_.stages.push_back({system().time});
            observer_.begin_stage(system().time);
            simulation_.disreef(canopy.inflation, canopy.stage);
            if (canopy.phase == Phase::initial) simulation_.begin(Phase::initial);
            begin_opening_frames();
        }
    }

    void note_attempts() {
        if (before_.count == 0) return;
        record_.cost.wall_s += before_.wall;
        record_.cost.cpu_s += before_.cpu;
        const double factor = scene_.full.time_step_factor;
        record_.warnings.push_back(
            {fmt::format("the run was repeated with half of its step, full.time_step_factor = {:g}", factor),
             fmt::format("at {:g} the energy did not add up: {}", 2.0 * factor, before_.ending),
             fmt::format(
                 "give the factor in the scene to spare the {:.2g} s before, or to keep a step as it is",
                 before_.wall)});
    }

    /// A sample of the fall, while the drag area is steady.
    void look_at_fall() {
        if (system().phase != Phase::open) return fall_.restart();
        if (system().step % steps_between_falls == 0) fall_.add(fall_now());
    }
    /// Judged now and then.
    bool falls_steadily() {
        if (system().step % Simulation::steps_between_checks != 0) return false;
        found_.last_window = judge_fall();
        return found_.last_window && found_.last_window->is_steady();
    }
    std::optional<DescentWindow> judge_fall() {
        auto window = fall_.judge(simulation_.payload().x[2]);
        if (window && window->is_steady()) window->turns = observer_.turns_since(window->from);
        return window;
    }
    FallSample fall_now() const {
        const SystemState& s = system();
        const double material = simulation_.constants().system_mass, gravity = scene_.environment.gravity;
        const Vec3 air = s.air.airspeed * s.air.direction;  // relative to the canopy
        const Vec3 arm = s.sums.canopy_position - to_vec3(simulation_.payload().x);
        const double length = arm.norm(), sink = air.z();
        FallSample now;
        now.time = s.time;
        now.density = s.air.density;
        now.sink = sink;
        now.airspeed = s.air.airspeed;
        now.updraft = s.air.wind.z();
        now.system_sink = -s.sums.system_velocity.z();
        now.air_sink = -s.sums.canopy_area_velocity.z();
        now.added_mass_ratio = s.added_mass / material;
        now.accretion = accretes_ ? s.accretion() / material : 0.0;
        now.growth = accretes_ ? s.added_mass_rate / material : 0.0;
        now.swing = air.squaredNorm() - sink * sink + 2.0 * gravity * (length - arm.z());
        now.period = 2.0 * pi * std::sqrt(length / gravity);
        now.across = {air.x(), air.y()};
        now.area = s.air.projected_area;
        return now;
    }

    /// Notes an event at which the scene may stop.
    void met(Trigger::Kind what) {
        if (scene_.stop.kind == what) event_stop_ = std::min(event_stop_, system().time + scene_.stop.delay);
    }

    void look_for_ground() {
        if (simulation_.payload().x[2] > scene_.environment.ground) return;
        add_event("ground");
        found_.landing_time = system().time;
        if (system().stage == Stage::deployment)
            return end(StatusCode::stopped_by_event, "ground reached before the lines came taut");
        return scene_.stop.kind == Trigger::Kind::ground
                   ? end(StatusCode::completed, "ground reached")
                   : end(StatusCode::stopped_by_event, "ground reached before the stop condition");
    }

    void look_for_stop() {
        const double now = system().time;
        if (scene_.stop.kind == Trigger::Kind::altitude && event_stop_ == longest_flight &&
            simulation_.payload().x[2] <= scene_.stop.value)
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

    void fill_cost() {
        Cost& cost = record_.cost;
        cost.wall_s = clock_.wall();
        cost.cpu_s = clock_.cpu();
        cost.steps = system().step;
        cost.rhs_calls = system().step;
        cost.dt_min_s = cost.steps > 0 ? simulation_.steps().dt_min() : 0.0;
        cost.dt_max_s = simulation_.steps().dt_max();
        cost.element_steps = simulation_.element_steps();
        if (cost.element_steps > 0)
            cost.ns_per_element_step = 1e9 * cost.wall_s / static_cast<double>(cost.element_steps);
        cost.blocks = simulation_.block_costs();
    }

    Attempts before_;
    const Scene& scene_;
    Run& run_;
    RunRecord record_;
    Simulation simulation_;
    Observer observer_;
    Findings found_;
    std::optional<OpeningSequence> sequence_;  // of a reefed parachute
    const RunView view_;
    SteadyDescent fall_;
    FieldRecorder fields_;
    FrameRecorder frames_;
    double descent_frames_from_ = infinity;  // [s]
    double stop_time_;
    double event_stop_ = longest_flight;
    bool ended_ = false;
    std::size_t told_rows_ = 0;  // to who watches
    double told_frame_ = -1.0;   // [s] the last shape
    /// Progress of a predicted filling: distance travelled [m] since a projected area [m^2], and whether that
    /// area stood still over the stretch before.
    struct Growth {
        double travelled = 0.0, area = 0.0;
        bool stands = false;
    } growth_;
    double hold_end_ = infinity;    // [s] at which lines that are taut now will have been so long enough
    std::size_t sound_events_ = 0;  // events up to the last check that found nothing wrong
    const bool accretes_ = scene_.aerodynamics.added_mass &&
                           scene_.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting;
    CheckpointClock clock_;
};

/// Saves or restores the run, without the parts that the constructor makes anew.
void FullRun::serialize(Archive& archive) {
    before_.serialize(archive);
    simulation_.serialize(archive);
    observer_.serialize(archive);
    fall_.serialize(archive);
    fields_.serialize(archive);
    frames_.serialize(archive);
    if (sequence_) sequence_->serialize(archive);
    archive.length("events", record_.events, 1'000'000);
    for (Event& event : record_.events) {
        auto& [name, time, altitude, speed] = event;
        archive.text("event", name);
        for (double* x : {&time, &altitude, &speed})
            archive.number("event", *x);
    }
    archive.whole("sound events", sound_events_, 0, record_.events.size());
    archive.flag("stands", growth_.stands);
    for (double* x : {&descent_frames_from_, &event_stop_, &hold_end_, &growth_.travelled, &growth_.area})
        archive.number("run", *x);
    found_.serialize(archive);
    clock_.serialize(archive);
    archive.numbers("resumed at", record_.cost.resumed_at);
}

/// Keys that need more than the one parachute of this model or another way out of its pack, and keys that its
/// structure needs.
std::vector<std::string> unsupported_keys(const Scene& scene) {
    if (scene.parachutes.size() > 1) return {"parachute." + scene.parachutes[1].name};
    const Parachute& chute = scene.parachutes.front();
    std::vector<std::string> keys;
    if (chute.count > 1) keys.emplace_back("parachute.count");
    if (chute.cluster_drag_ratio != 1.0) keys.emplace_back("parachute.cluster_drag_ratio");
    if (chute.deploy_when) keys.emplace_back("parachute.deploy.when");
    if (chute.deploy.by == DeployBy::pilot || chute.deploy.by == DeployBy::mortar)
        keys.emplace_back("parachute.deploy.by");
    if (chute.cut) keys.emplace_back("parachute.cut");
    if (chute.filling.is_predicted()) {
        // Wolf's momentum and the balance without inertia are reductions that a mesh does not make.
        if (chute.filling.model != find_filling("predicted")) keys.emplace_back("parachute.filling.model");
        // The balance of the air in the canopy knows mouth, fabric and a vent above them.
        if (open_gaps(chute) || has_open_middle(chute) || holds_vent_down(chute))
            keys.emplace_back("parachute.filling");
    }
    if (!lacks_canopy(chute).empty()) keys.emplace_back("parachute.type");
    if (keys.empty()) keys = missing_structure(chute);
    // Scenes that cannot start are refused before anything runs.
    if (keys.empty() && (chute.mesh || scene.payload.body || holds_vent_down(chute))) {
        Mesh mesh = unloaded_mesh(scene);
        if (scene.payload.body) attach_payload(scene, mesh, Hang::drawn_out);
    }
    return keys;
}

constexpr std::string_view step_key = "full.time_step_factor";

/// Where nobody chose the step.
bool may_step_shorter(const Scene& scene) {
    return std::ranges::any_of(scene.inputs, [&](const Input& input) {
        return input.key == step_key && input.origin == InputOrigin::fallback &&
               std::get<double>(input.value) == scene.full.time_step_factor;
    });
}

Scene with_shorter_steps(Scene scene, double factor) {
    scene.full.time_step_factor = factor;
    for (Input& input : scene.inputs)
        if (input.key == step_key) input.value = factor;
    return scene;
}

/// One run, or several. What impacts add to the energy is chance, and grows with the step: where it becomes
/// too much in a step that nobody has asked for, the scene is run again with half of it.
RunRecord fly(const Scene& scene, double stated_mass, Run run) {
    Attempts before;
    if (!run.checkpoints.from.empty()) {
        Archive archive(run.checkpoints.from, run.checkpoints.file);
        before.serialize(archive);
    }
    for (;;) {
        const Scene shorter =
            with_shorter_steps(scene, std::ldexp(scene.full.time_step_factor, -before.count));
        FullRun attempt(shorter, stated_mass, run, before);
        attempt.fly();
        const StatusCode code = attempt.status().code;
        const bool adds_up = code != StatusCode::energy_grew && code != StatusCode::solver_failed;
        if (adds_up || before.count == Attempts::most || !may_step_shorter(scene)) return attempt.finish();
        before.add(attempt.status(), attempt.clock());
        run.checkpoints.from.clear();
    }
}

/// A run past its peak force, for the bracket of a predicted filling.
RunRecord fly_to_peak(Scene scene, double stated_mass, const Run& run) {
    scene.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
    Run control;
    control.stop = run.stop;
    control.threads = run.threads;
    control.force_unstructured = run.force_unstructured;
    RunRecord record = fly(scene, stated_mass, control);
    if (const Event* full = record.find_event("full-open"), *begin = record.find_event("snatch"); full) {
        const double time = full->time - (begin ? begin->time : 0.0);
        record.add_metric("filling_time_s", time);
        record.add_metric("fill_constant",
                          time * record.metric("snatch_speed_m_s").value_or(release_airspeed(scene).norm()) /
                              scene.parachutes.front().nominal_diameter);
    }
    return record;
}

}  // namespace

RunRecord run_fullsim(const Scene& scene, Run& run) {
    const Scene meshed = weighed(scene);
    const double stated_mass = scene.parachutes.front().mass;
    RunRecord record = fly(meshed, stated_mass, run);
    const bool ended = record.status.code == StatusCode::completed ||
                       record.status.code == StatusCode::stopped_by_event ||
                       record.status.code == StatusCode::squids;
    if (ended) {
        const Event* snatch = record.find_event("snatch");
        const double altitude = snatch != nullptr ? snatch->altitude : scene.release.altitude;
        add_filling_bracket(record, meshed, scene.environment.atmosphere.at(altitude).density,
                            [&](const Scene& other) { return fly_to_peak(other, stated_mass, run); });
    }
    return record;
}

const Fidelity& full_fidelity() {
    static constexpr Fidelity row{
        "full", "full aeroelastic model", &run_fullsim, &unsupported_keys, true, true, &plan_full, true};
    return row;
}

}  // namespace twinchute::fullsim
