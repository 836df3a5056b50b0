#include "fullsim/run_fullsim.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "fullsim/fidelity.hpp"
#include "fullsim/fields.hpp"
#include "fullsim/frames.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/observer.hpp"
#include "fullsim/parts.hpp"
#include "fullsim/plan.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "lib/solve/shortfall.hpp"
#include "lib/solve/steady_descent.hpp"
#include "lib/solve/stopwatch.hpp"
#include "lib/solve/validity.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int steps_between_falls = 10;  // samples of the fall: some ten a bounce, of lines that are short
constexpr int steps_between_reports = 500;
constexpr double shape_average = 2.0;  // [s]: the shape settles later than the speed
// Of the steady projected area: a filled canopy (docs/theory/filling-time.md), and what has to come soon
// before it, or the filling time hangs on how the last of the area settles.
constexpr double filled_share = 0.98;
constexpr double nearly_filled = 0.95;
constexpr double sound_area = 0.9;   // signed over positive area below which gores lie inside out
constexpr double early_peak = 0.25;  // drag area over the steady one below which a peak is the snatch's
constexpr double ringing = 1.02;     // raw over filtered peak force; a sound opening has 1.00 to 1.01
// How long lines have to stay taut, since flailing ones do not, over the time that a wave takes along them:
// 2 ms of a C-9's line (7.31 m of 462 kg/m^3 and 0.97 GPa).
const double taut_hold = 2e-3 / (7.31 * std::sqrt(462.0 / 9.7e8));
// Frames of a report: a deployment lasts tenths of a second to some seconds, breathing as long as filling.
constexpr FrameStretch deployment_frames{0.02, 20}, descent_frames{0.1, 16};
constexpr std::size_t opening_frames = 48;
constexpr double opening_and_breathing = 2.0;  // filling times, from snatch

class FullRun {
public:
    /// The parachute weighs what its mesh does; `stated_mass`: what the scene says of it [kg].
    FullRun(const Scene& scene, double stated_mass, Run& run)
        : scene_(scene),
          stated_mass_(stated_mass),
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
          fall_(scene.environment),
          fields_(simulation_.mesh(), scene.full.fields_rate, run.fields),
          frames_(simulation_.mesh(), static_cast<bool>(run.frames), simulation_.sectors()),
          stop_time_(scene.stop.kind == Trigger::Kind::time ? scene.stop.value + scene.stop.delay
                                                            : longest_flight) {
        if (!scene.parachutes.front().reefing.empty()) {
            sequence_.emplace(scene);
            sequence_->release(flight_state());
        }
        if (packed()) {
            snatch_ = infinity;
            observer_.count_peak_from(infinity);
        }
        if (packed())
            frames_.begin(0.0, deployment_frames);
        else if (inflated())
            begin_descent_frames();
        else
            begin_opening_frames();
    }

    RunRecord fly() {
        if (!run_.checkpoints.from.empty()) {
            go_on_from(run_.checkpoints.from);
        } else {
            add_event(packed() ? "release" : inflated() ? "full-open" : "line-stretch");
            if (!packed()) met(inflated() ? Trigger::Kind::full_open : Trigger::Kind::line_stretch);
        }
        while (!ended_) {
            // Right after a check no frame of the fields waits for the next one.
            if (state().step % Simulation::steps_between_checks == 1) save_if_due();
            simulation_.evaluate_forces();
            observer_.observe(observer_.row_is_due(state().time) ? simulation_.seams() : state());
            fields_.observe(fields_.frame_is_due(state().time) ? simulation_.state() : state());
            observe_frame();
            look_for_events();
            // An end between two checks must not hide what the next one would have found.
            if (ended_ && !is_numerical_failure(record_.status.code)) check_end();
            if (ended_) break;
            simulation_.step_to(next_stop());
            if (simulation_.was_checked()) check();
        }
        // The rest of the fall begins where this ends, not at the last row before.
        if (!scene_.then.empty() && record_.status.code == StatusCode::completed)
            observer_.observe_end(simulation_.seams());
        observer_.finish();
        fields_.accept();
        frames_.accept();
        if (run_.frames) run_.frames(frames_.finish());
        const Layout& layout = simulation_.layout();
        record_.provenance.instruction_set = fmt::format("{}, {}", layout.instruction_set(), layout.name());
        record_.provenance.threads = layout.threads();
        fill_cost();
        fill_results();
        return std::move(record_);
    }

private:
    /// What is asked here needs no node of canopy or lines.
    const State& state() const { return simulation_.outline(); }
    const Deployment& deploy() const { return scene_.parachutes.front().deploy; }
    bool packed() const { return deploy().starts_packed(); }
    bool inflated() const { return deploy().by == DeployBy::inflated; }
    /// [s] of the open canopy; infinite as long as it is reefed.
    double full_open() const { return reefed() ? infinity : simulation_.inflation().end_of(Phase::filling); }
    /// [s] from which on the drag area is steady; infinite as long as the canopy is reefed.
    double drag_area_steady() const {
        return reefed() ? infinity : simulation_.inflation().end_of(Phase::overshoot);
    }
    /// [s] where filling to the full area begins: a mouth that is held together does not keep all of the
    /// canopy from that.
    double last_stage(double snatch) const { return std::max(snatch, stages_.back().begin); }
    bool reefed() const { return simulation_.inflation().share < 1.0; }
    FlightState flight_state() const {
        const NodeRecord& payload = state().node[simulation_.mesh().payload()];
        return {state().time, payload.x[2], payload.v[2],
                (state().sums.system_velocity - state().air.wind).norm(), state().air.density};
    }

    void end(StatusCode code, std::string detail) {
        record_.status = {code, std::move(detail)};
        ended_ = true;
    }

    void add_event(const char* name, double time, const Vec3& position, const Vec3& velocity) {
        record_.events.push_back({name, time, position.z(), velocity.norm()});
    }

    void add_event(const char* name) {
        const NodeRecord& payload = state().node[simulation_.mesh().payload()];
        add_event(name, state().time, to_vec3(payload.x), to_vec3(payload.v));
    }

    /// What must not be stepped across next.
    double next_stop() const {
        const double deployed = state().stage == Stage::deployment
                                    ? std::min({hold_end_, longest_deployment, next_load_change()})
                                    : std::min(simulation_.inflation().end_of(state().phase),
                                               simulation_.inflation().next_kink());
        const double cut = sequence_ ? sequence_->next_time() : infinity;
        return std::min({deployed, cut, simulation_.ramp_end(), stop_time_, event_stop_});
    }

    /// The next time at which the extraction force is not smooth.
    double next_load_change() const {
        const ForceHistory& force = deploy().extraction;
        double next = force.duration > state().time ? force.duration : infinity;
        for (const double t : force.time)
            if (t > state().time) next = std::min(next, t);
        return force.time.empty() ? infinity : next;
    }

    void check() {
        if (const auto& fault = simulation_.fault()) {
            observer_.forget();
            record_.events.resize(sound_events_);
            fields_.forget();
            frames_.forget();
            return end(fault->code, fault->detail);
        }
        observer_.accept();
        sound_events_ = record_.events.size();
        fields_.accept();
        frames_.accept();
        // Not before a checkpoint of where it stopped, where there are any.
        if (run_.stop.stop_requested() && (saved_for_stop_ || !saves()))
            return end(StatusCode::interrupted, "stopped on request");
        if (run_.progress && state().step % steps_between_reports == 0)
            run_.progress({stage_name(), state().time, expected_share(), resumed_at()});
    }

    bool saves() const { return run_.checkpoints.save && scene_.full.checkpoint_interval > 0.0; }
    std::optional<double> resumed_at() const {
        if (record_.cost.resumed_at.empty()) return {};
        return record_.cost.resumed_at.back();
    }

    /// The clock decides when, and nothing of what follows.
    void save_if_due() {
        if (!saves()) return;
        const bool stops = run_.stop.stop_requested();
        if (!stops && watch_.wall() < next_save_) return;
        Archive archive;
        serialize(archive);
        run_.checkpoints.save(archive.take());
        saved_for_stop_ = stops;
        next_save_ = watch_.wall() + scene_.full.checkpoint_interval;
    }

    void go_on_from(const std::string& saved) {
        Archive archive(saved, run_.checkpoints.file);
        serialize(archive);
        archive.end();
        record_.cost.resumed_at.push_back(state().time);
        if (run_.progress) run_.progress({stage_name(), state().time, expected_share(), resumed_at()});
    }

    void serialize(Archive& archive);

    void check_end() {
        if (const auto fault = simulation_.find_fault()) {
            observer_.forget();
            record_.events.resize(sound_events_);
            fields_.forget();
            frames_.forget();
            landing_time_.reset();
            end(fault->code, fault->detail);
        }
    }

    void begin_opening_frames() {
        const Inflation& inflation = simulation_.inflation();
        const double lasts = opening_and_breathing * (inflation.end_of(Phase::filling) - inflation.snatch);
        frames_.begin(state().time, {lasts / opening_frames, opening_frames});
        descent_frames_from_ = state().time + lasts;
    }
    void begin_descent_frames() {
        frames_.begin(state().time, descent_frames);
        descent_frames_from_ = infinity;
    }
    void observe_frame() {
        if (state().time >= descent_frames_from_) begin_descent_frames();
        if (frames_.frame_is_due(state().time)) frames_.observe(simulation_.state());
    }

    std::string_view stage_name() const {
        if (state().stage == Stage::deployment) return "deployment";
        switch (state().phase) {
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
        if (scene_.stop.kind == Trigger::Kind::time) return std::min(0.99, state().time / stop_time_);
        if (state().stage == Stage::deployment) return 0.0;
        const Inflation& inflation = simulation_.inflation();
        return std::min(0.99, state().time / (inflation.snatch + 4.0 * inflation.filling_time + 2.0));
    }

    void look_for_events() {
        if (state().stage == Stage::deployment)
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
        const double now = state().time;
        if (!simulation_.lines_are_taut()) {
            hold_end_ = infinity;
        } else if (hold_end_ == infinity) {
            hold_end_ = now + hold();
        }
        if (now < hold_end_) {
            if (now >= longest_deployment)
                end(StatusCode::time_limit,
                    fmt::format("the lines never came taut within {:g} s of release", longest_deployment));
            return;
        }
        line_stretch_time_ = now - hold();
        payload_snatch_speed_ =
            (to_vec3(state().node[simulation_.mesh().payload()].v) - state().air.wind_at_payload).norm();
        const Vec3 airspeed = state().sums.system_velocity - state().air.wind;
        snatch_speed_ = airspeed.norm();
        snatch_path_angle_ = angle_below_horizon(airspeed);
        snatch_density_ = state().air.density;
        if (const auto refused = simulation_.snatch()) return end(refused->code, refused->detail);
        if (sequence_) sequence_->snatched(0, flight_state());
        snatch_ = now;
        add_event("snatch");
        begin_opening_frames();
        met(Trigger::Kind::line_stretch);
        observer_.count_peak_from(now + simulation_.inflation().initial_time);
    }

    void look_for_opening() {
        const double now = state().time;
        bool opens = false;
        while (now >= simulation_.inflation().next_kink())
            simulation_.pass_kink();
        if (now >= simulation_.inflation().end_of(state().phase)) {
            opens = state().phase == Phase::filling;
            if (opens && !stages_.empty() && !stages_.back().full) stages_.back().full = now;
            if (state().phase != Phase::overshoot)
                add_event(!opens ? "end-of-initial-phase" : reefed() ? "reefed-open" : "full-open");
            if (opens && !reefed()) met(Trigger::Kind::full_open);
            // Drag area and phi are continuous here, only their rates jump: the forces just
            // evaluated are those of the phase that begins, too.
            simulation_.begin(simulation_.inflation().after(state().phase));
        }
        if (sequence_) look_for_disreef();
        if (state().stage == Stage::springs && (opens || simulation_.mouth_is_open())) {
            switched_late_ = opens && !simulation_.mouth_is_open();
            simulation_.begin_ramp();
            add_event("switch");
        } else if (now >= simulation_.ramp_end()) {
            simulation_.end_ramp();
            add_event("finite-elements-alone");
        }
        look_at_fall();
        // Not before there is a shape to report.
        if (state().phase == Phase::open && !descent_altitude_ && now >= drag_area_steady() + shape_average &&
            falls_steadily()) {
            add_event("steady-descent");
            descent_ = last_window_;
            descent_altitude_ = state().node[simulation_.mesh().payload()].x[2];
            if (scene_.stop.kind == Trigger::Kind::steady_descent ||
                scene_.stop.kind == Trigger::Kind::peak_force)
                event_stop_ = now + scene_.stop.delay;
        }
        if (scene_.stop.kind == Trigger::Kind::peak_force && event_stop_ == longest_flight &&
            now > drag_area_steady() && observer_.filtered_force() < past_peak * observer_.peak().value)
            event_stop_ = now + scene_.stop.delay;
    }

    /// The canopies know when a line is cut; drag area and added mass go on from where they are.
    void look_for_disreef() {
        if (sequence_->waits_for_steady_descent() && state().phase == Phase::open && falls_steadily()) {
            add_event("steady-descent");
            sequence_->descends_steadily(flight_state());
        }
        for (const OpeningEvent& what : sequence_->advance(flight_state())) {
            if (what.kind != OpeningEvent::Kind::disreef) continue;
            const Canopy& canopy = sequence_->all().front();
            add_event("disreef");
            stages_.push_back({state().time});
            observer_.begin_stage(state().time);
            simulation_.disreef(canopy.inflation, canopy.stage);
            if (canopy.phase == Phase::initial) simulation_.begin(Phase::initial);
            begin_opening_frames();
        }
    }

    /// A sample of the fall, while the drag area is steady.
    void look_at_fall() {
        if (state().phase != Phase::open) return fall_.restart();
        if (state().step % steps_between_falls == 0) fall_.add(fall_now());
    }
    /// Judged now and then.
    bool falls_steadily() {
        if (state().step % Simulation::steps_between_checks != 0) return false;
        last_window_ = fall_.judge(state().node[simulation_.mesh().payload()].x[2]);
        return last_window_ && last_window_->is_steady();
    }
    FallSample fall_now() const {
        const State& s = state();
        const double material = simulation_.constants().system_mass, gravity = scene_.environment.gravity;
        const Vec3 air = s.air.airspeed * s.air.direction;  // relative to the canopy
        const Vec3 arm = s.sums.canopy_position - to_vec3(s.node[simulation_.mesh().payload()].x);
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
        now.accretion = accretes_ ? std::max(0.0, s.added_mass_rate) / material : 0.0;
        now.swing = air.squaredNorm() - sink * sink + 2.0 * gravity * (length - arm.z());
        now.period = 2.0 * pi * std::sqrt(length / gravity);
        return now;
    }

    /// What the scene may stop at happens now.
    void met(Trigger::Kind what) {
        if (scene_.stop.kind == what) event_stop_ = std::min(event_stop_, state().time + scene_.stop.delay);
    }

    void look_for_ground() {
        if (state().node[simulation_.mesh().payload()].x[2] > scene_.environment.ground) return;
        add_event("ground");
        landing_time_ = state().time;
        if (state().stage == Stage::deployment)
            return end(StatusCode::stopped_by_event, "ground reached before the lines came taut");
        return scene_.stop.kind == Trigger::Kind::ground
                   ? end(StatusCode::completed, "ground reached")
                   : end(StatusCode::stopped_by_event, "ground reached before the stop condition");
    }

    void look_for_stop() {
        const double now = state().time;
        if (scene_.stop.kind == Trigger::Kind::altitude && event_stop_ == longest_flight &&
            state().node[simulation_.mesh().payload()].x[2] <= scene_.stop.value)
            met(Trigger::Kind::altitude);
        if (now < std::min(stop_time_, event_stop_)) return;
        if (stop_time_ <= now && scene_.stop.kind != Trigger::Kind::time)
            end(StatusCode::time_limit,
                fmt::format("stop condition not met within {:g} s of flight", stop_time_));
        else
            end(StatusCode::completed, "stop condition met");
    }

    void fill_cost() {
        Cost& cost = record_.cost;
        cost.wall_s = wall_before_ + watch_.wall();
        cost.cpu_s = cpu_before_ + watch_.cpu();
        cost.steps = state().step;
        cost.rhs_calls = state().step;
        cost.dt_min_s = cost.steps > 0 ? simulation_.dt_min() : 0.0;
        cost.dt_max_s = simulation_.dt_max();
        cost.element_steps = simulation_.element_steps();
        if (cost.element_steps > 0)
            cost.ns_per_element_step = 1e9 * cost.wall_s / static_cast<double>(cost.element_steps);
        cost.blocks = simulation_.block_costs();
    }

    void fill_results();
    Observer::Peak largest_peak() const;
    ParachuteResult opening_in_stages(double snatch) const;
    void add_warnings();
    std::vector<NeverOpened> never_opened_here() const;
    Reached reached_at(double end, bool has_filling_time) const;

    const Scene& scene_;
    const double stated_mass_;  // [kg]
    Run& run_;
    RunRecord record_;
    Simulation simulation_;
    Observer observer_;
    SteadyDescent fall_;
    FieldRecorder fields_;
    FrameRecorder frames_;
    double descent_frames_from_ = infinity;  // [s]
    double stop_time_;
    double event_stop_ = longest_flight;
    bool ended_ = false;
    double hold_end_ = infinity;  // [s] at which lines that are taut now will have been so long enough
    bool switched_late_ = false;
    std::size_t sound_events_ = 0;  // events up to the last check that found nothing wrong
    std::optional<double> line_stretch_time_;
    double snatch_ = 0.0;  // [s]
    double snatch_speed_ = 0.0, snatch_path_angle_ = 0.0, payload_snatch_speed_ = 0.0, snatch_density_ = 0.0;
    std::optional<double> descent_altitude_, landing_time_, steady_area_;
    std::optional<DescentWindow> descent_, last_window_;  // found steady; judged last
    const bool accretes_ = scene_.aerodynamics.added_mass &&
                           scene_.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting;
    std::optional<OpeningSequence> sequence_;            // of a reefed parachute
    std::vector<ParachuteResult::Stage> stages_ = {{}};  // of its opening

    Stopwatch watch_;
    double wall_before_ = 0.0, cpu_before_ = 0.0;         // [s] of the runs that this one goes on from
    double next_save_ = scene_.full.checkpoint_interval;  // [s] of this one
    bool saved_for_stop_ = false;
};

void serialize_window(Archive& archive, std::optional<DescentWindow>& window) {
    bool is_there = window.has_value();
    archive.flag("window", is_there);
    if (!is_there) return window.reset();
    if (archive.reads()) window.emplace();
    auto& [from, to, rate, amplitude, drift, remaining] = *window;
    for (double* x : {&from, &to, &rate, &amplitude, &drift, &remaining})
        archive.number("window", *x);
}

/// What the constructor makes anew is not kept.
void FullRun::serialize(Archive& archive) {
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
    for (double* x : {&descent_frames_from_, &event_stop_, &hold_end_, &snatch_, &snatch_speed_,
                      &snatch_path_angle_, &payload_snatch_speed_, &snatch_density_})
        archive.number("run", *x);
    for (std::optional<double>* x : {&line_stretch_time_, &descent_altitude_, &landing_time_, &steady_area_})
        archive.number("run", *x);
    for (std::optional<DescentWindow>* window : {&descent_, &last_window_})
        serialize_window(archive, *window);
    archive.flag("switched late", switched_late_);
    archive.length("stages", stages_, 1000);
    for (ParachuteResult::Stage& stage : stages_) {
        auto& [begin, full, peak_force, peak_time] = stage;
        archive.number("begin", begin);
        archive.number("full", full);
        archive.number("peak force", peak_force);
        archive.number("peak time", peak_time);
    }
    double wall = wall_before_ + watch_.wall(), cpu = cpu_before_ + watch_.cpu();
    archive.number("wall time", wall);
    archive.number("processor time", cpu);
    archive.numbers("resumed at", record_.cost.resumed_at);
    if (archive.reads()) wall_before_ = wall, cpu_before_ = cpu;
}

Observer::Peak FullRun::largest_peak() const {
    Observer::Peak largest = observer_.peak();
    for (const Observer::Peak& peak : observer_.earlier_peaks())
        if (peak.value > largest.value) largest = peak;
    return largest;
}

ParachuteResult FullRun::opening_in_stages(double snatch) const {
    ParachuteResult opening;
    opening.snatch_time = snatch;
    opening.stages = stages_;
    opening.stages.front().begin = snatch;
    for (std::size_t i = 0; i < opening.stages.size(); ++i) {
        const auto& earlier = observer_.earlier_peaks();
        const Observer::Peak& peak = i < earlier.size() ? earlier[i] : observer_.peak();
        if (peak.value > 0.0) opening.stages[i].peak_force = peak.value;
        opening.stages[i].peak_time = peak.time;
    }
    return opening;
}

void FullRun::fill_results() {
    const auto& rows = observer_.rows();
    const Parachute& chute = scene_.parachutes.front();
    const double snatch = snatch_;
    const double filled = full_open();
    const HistoryRow& last = rows.back();

    OpeningResult result;
    result.snatched = !inflated() && std::isfinite(snatch);
    if (result.snatched) {
        result.line_stretch_time = line_stretch_time_;
        result.snatch_time = snatch;
        result.snatch_speed = packed() ? snatch_speed_ : release_airspeed(scene_).norm();
        result.snatch_path_angle =
            packed() ? snatch_path_angle_ : angle_below_horizon(release_airspeed(scene_));
        result.payload_snatch_speed = packed() ? payload_snatch_speed_ : result.snatch_speed;
        result.snatch_density = packed() ? snatch_density_ : rows.front().density;
    }
    if (last.time >= filled + shape_average) {
        steady_area_ = observer_.mean(&HistoryRow::projected_area, shape_average);
        if (!inflated()) {
            result.filling_time =
                observer_.first_time_of_area(filled_share * *steady_area_, last_stage(snatch));
            if (result.filling_time) *result.filling_time -= snatch;
        }
    }
    if (packed()) result.snatch_force = observer_.snatch_peak().value;
    const Observer::Peak peak = largest_peak();
    if (peak.value > 0.0) result.peak_force = peak.value;
    result.max_force = std::max(peak.value, observer_.snatch_peak().value);
    result.peak_time = peak.time;
    if (sequence_ && result.snatched) result.parachutes.push_back(opening_in_stages(snatch));
    if (last.time >= filled && !inflated()) result.impulse = observer_.impulse(snatch, filled);
    result.max_deceleration = observer_.largest_acceleration();
    result.descent = descent_;
    result.descent_altitude = descent_altitude_;
    // Of the end of the run, where it is steady there, too.
    if (const auto end = fall_.judge(state().node[simulation_.mesh().payload()].x[2])) {
        last_window_ = end;
        if (descent_ && end->is_steady()) result.descent = end;
    }
    result.landing_time = landing_time_;
    result.end_position = last.position;

    const Metric filling{
        "", 0.0, Standing::result,
        fmt::format("projected area first at {:g} % of its steady mean; prescribed drag area takes {:.4g} s",
                    100.0 * filled_share, simulation_.inflation().filling_time)};
    const Metric descent{"", 0.0, Standing::mixed,
                         "(C_D S)_0 and mass are inputs; the balance is the result"};
    add_opening_metrics(record_, scene_, result, filling, descent);
    if (result.peak_force)
        record_.add_metric("peak_force_raw_N", observer_.raw_peak().value, Standing::result,
                           "without the 5 ms average");
    const auto add_past_event = [&](const char* name, double time) {
        auto row = std::ranges::lower_bound(rows, time, {}, &HistoryRow::time);
        if (row == rows.end()) --row;
        add_event(name, time, row->position, row->velocity);
    };
    if (result.peak_force) add_past_event("peak-force", result.peak_time);
    if (result.filling_time) add_past_event("canopy-filled", snatch + *result.filling_time);
    std::ranges::stable_sort(record_.events, {}, &Event::time);
    if (steady_area_ && *steady_area_ > 0.0) {  // a canopy that fell in has no shape
        const double diameter = 2.0 * std::sqrt(*steady_area_ / pi);
        record_.add_metric("projected_diameter_ratio", diameter / chute.nominal_diameter, Standing::result,
                           "equal-area diameter over D0, mean of the last 2 s");
        record_.add_metric("seam_diameter_ratio",
                           observer_.mean(&HistoryRow::seam_diameter, shape_average) / chute.nominal_diameter,
                           Standing::result, "widest ring of seam nodes over D0");
        record_.add_metric("canopy_depth_ratio", observer_.mean(&HistoryRow::depth, shape_average) / diameter,
                           Standing::result, "vent to skirt over the equal-area diameter");
        record_.add_metric("signed_area_ratio",
                           observer_.mean(&HistoryRow::signed_area, shape_average) / *steady_area_,
                           Standing::result, "1 when no gore lies inside out");
    }
    record_.add_metric("max_line_tension_N", simulation_.largest_loads().line_tension, Standing::result,
                       "elastic, of all lines and steps");
    record_.add_metric("max_membrane_stress_N_m", simulation_.largest_loads().fabric_stress, Standing::result,
                       "first principal, elastic, of all triangles and steps");
    add_strength_margins(record_, chute);
    record_.energy = simulation_.ledger();
    record_.channels = observer_.channels();
    add_validity(record_, scene_, result);
    add_warnings();
    const Reached reached = reached_at(last.time, result.filling_time.has_value());
    note_never_opened(record_, scene_, never_opened_here(), reached);
    note_missing_metrics(record_, scene_, reached);
    record_.left_out = left_out_of(parts_of(scene_));
    if (const MassScaling& scaling = simulation_.mass_scaling(); scaling.nodes > 0)
        record_.left_out.push_back(
            {fmt::format("true mass of {} canopy nodes", scaling.nodes),
             fmt::format("full.mass_scaling adds {:.3g} kg, {:.2g} % of the canopy with its air, for steps "
                         "that may be "
                         "{:.1f} % longer before the air moves along",
                         scaling.mass, 100.0 * scaling.share, 100.0 * (scaling.longer - 1.0))});
}

std::vector<NeverOpened> FullRun::never_opened_here() const {
    if (sequence_) return never_opened(*sequence_);
    if (std::isfinite(snatch_)) return {};
    return {{0, 1, "it had begun to leave its pack and never came to snatch"}};
}

Reached FullRun::reached_at(double end, bool has_filling_time) const {
    Reached reached;
    reached.ground = landing_time_.has_value();
    reached.full_open = std::isfinite(snatch_) && end >= full_open();
    if (!reached.full_open || has_filling_time) return reached;
    reached.filling_cut_short = end < full_open() + shape_average;
    reached.no_filling_time =
        reached.filling_cut_short
            ? fmt::format("the run ended less than {:g} s after full open", shape_average)
            : fmt::format("the projected area never came to {:g} % of its steady mean", 100.0 * filled_share);
    return reached;
}

void FullRun::add_warnings() {
    const Parachute& chute = scene_.parachutes.front();
    const auto warn = [&](std::string what, std::string why, std::string suggestion) {
        record_.warnings.push_back({std::move(what), std::move(why), std::move(suggestion)});
    };
    const bool opened = std::isfinite(snatch_);
    if (opened && !inflated() && !sequence_)
        add_opening_warnings(record_, scene_, scene_.parachutes.front(), simulation_.inflation(),
                             packed() ? snatch_speed_ : release_airspeed(scene_).norm(),
                             packed() ? snatch_density_ : observer_.rows().front().density);
    add_scene_warnings(record_, scene_);
    if (!opened)
        warn("no snatch", "the lines never came taut: nothing drew the parachute out far enough",
             "give it line drag, a static line, an extraction force, or more height");
    if (packed() && opened && !sequence_ && record_.metric("peak_force_N")) {
        const Inflation& inflation = simulation_.inflation();
        const double time = largest_peak().time;
        if (const double ratio = inflation.drag_area_ratio(inflation.phase_at(time), time).value;
            ratio < early_peak)
            warn(
                fmt::format("the peak force comes {:.3g} s after snatch, at {:.0f} % of the steady drag area",
                            time - inflation.snatch, 100.0 * ratio),
                "the snatch still rings: payload and canopy bounce on the lines, and little but the cloth "
                "damps it",
                "take it for a snatch force, or give full.alpha a value");
    }
    if (const double filtered = largest_peak().value, raw = observer_.raw_peak().value;
        filtered > 0.0 && raw > ringing * filtered && simulation_.most_subcycles() > 1)
        warn(
            fmt::format("the raw peak force is {:.1f} % above the filtered one, lines took up to {} substeps",
                        100.0 * (raw / filtered - 1.0), simulation_.most_subcycles()),
            "where a step of the canopy is half a period of the lines they may ring "
            "(docs/theory/full-model.md)",
            "compare with full.line_substeps = 1; the filtered peak is the one that counts");
    if (switched_late_)
        warn("finite elements took over at full open only",
             fmt::format("the mouth never reached {:g} of the steady projected area",
                         scene_.full.switch_area_ratio),
             "look at the shape; a smaller full.switch_area_ratio hands over earlier");
    const double meshed = simulation_.mesh().parachute_mass();
    if (std::abs(meshed - stated_mass_) > 0.02 * stated_mass_)
        warn(fmt::format("the mesh weighs {:.3f} kg, parachute.mass says {:.3f} kg", meshed, stated_mass_),
             "the full model takes its mass from fabric, tapes and lines",
             "correct parachute.mass, or the materials");
    if (auto warning = stand_in(chute)) record_.warnings.push_back(std::move(*warning));
    if (chute.mesh)
        std::ranges::copy(size_warnings(import_mesh(scene_), scene_), std::back_inserter(record_.warnings));
    if (const auto sound = record_.metric("signed_area_ratio"); sound && *sound < sound_area)
        warn(fmt::format("signed over positive canopy area is {:.2f}", *sound),
             scene_.full.contact == Contact::none
                 ? "gores are folded inside out; fabric passes through fabric here"
                 : "gores are folded inside out; contact keeps neighbours in order, not a canopy from "
                   "turning over",
             scene_.full.contact == Contact::none && !chute.mesh
                 ? "look at the shape before trusting the loads; full.contact = \"gores\" keeps neighbours "
                   "in order"
                 : "look at the shape before trusting the loads");
    if (const auto filled = record_.metric("filling_time_s")) {
        const double snatch = snatch_;
        const auto nearly = observer_.first_time_of_area(nearly_filled * *steady_area_, last_stage(snatch));
        if (nearly && *nearly - snatch < 0.9 * *filled)
            warn(
                fmt::format("{:g} % of the steady area is reached at {:.3g} s, {:g} % at {:.3g} s",
                            100.0 * nearly_filled, *nearly - snatch, 100.0 * filled_share, *filled),
                "the canopy creeps into its shape, so that the filling time hangs on where one stops to look",
                "compare filling times of such a canopy with a wide tolerance");
    }
    if (state().capped_steps > 0)
        warn(
            fmt::format(
                "the canopy pressure was capped in {:.1f} % of the steps",
                100.0 * static_cast<double>(state().capped_steps) / static_cast<double>(state().step)),
            "the projected area was too small for the prescribed drag; the rest acted as drag of loose cloth",
            "give the canopy a larger initial_drag_area_ratio if this matters");
    if (opened && !descent_altitude_) warn_of_unsteady_descent(record_, scene_, last_window_);
    if (record_.status.code != StatusCode::completed || !opened) return;
    if (!steady_area_)
        warn("no filling time and no steady shape",
             fmt::format("the run ended less than {:g} s after full open", shape_average),
             "set stop.time later, or stop.at = \"steady-descent\"");
}

/// What takes more than the one parachute that this model has, or another way out of its pack; and what its
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
    if (!lacks_canopy(chute).empty()) keys.emplace_back("parachute.type");
    if (keys.empty()) keys = missing_structure(chute);
    // What cannot start is found before anything runs.
    if (keys.empty() && (chute.mesh || scene.payload.body)) {
        Mesh mesh = unloaded_mesh(scene);
        if (scene.payload.body) attach_payload(scene, mesh, Hang::drawn_out);
    }
    return keys;
}

}  // namespace

RunRecord run_fullsim(const Scene& scene, Run& run) {
    const Scene meshed = weighed(scene);
    return FullRun(meshed, scene.parachutes.front().mass, run).fly();
}

const Fidelity& full_fidelity() {
    static constexpr Fidelity row{
        "full", "full aeroelastic model", &run_fullsim, &unsupported_keys, true, true, &plan_full, true};
    return row;
}

}  // namespace twinchute::fullsim
