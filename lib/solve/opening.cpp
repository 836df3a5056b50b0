#include "lib/solve/opening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "lib/record/metrics.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute {

Vec3 heading_direction(const Release& release) {
    return {std::sin(release.heading), std::cos(release.heading), 0.0};
}

namespace {

/// (C_D S) over (C_D S)_0 at the end of a stage.
double share_of(const Parachute& chute, std::size_t stage) {
    return stage < chute.reefing.size() ? chute.reefing[stage].drag_area_ratio : 1.0;
}

/// How much of the filling is done at a share of the drag area.
double filled(const Parachute& chute, double share) {
    const double first = chute.initial_drag_area_ratio;
    return (share - first) / (1.0 - first);
}

/// A predicted filling has no law: its drag area stays where it is until a model says that it has grown.
ValueAndRate unchanged(double, double eta) {
    return {eta * eta, 0.0};
}
double unchanged_integral(double x, double eta) {
    return x * eta * eta;
}
constexpr DragAreaLaw no_law{"", "", unchanged, unchanged_integral};

/// An opening that begins with a drag area [m^2] and ends when OpeningSequence::fills_up() says so.
Inflation endless(const Parachute& chute, double begin, double initial_time, double drag_area) {
    Inflation inflation;
    inflation.snatch = begin;
    inflation.initial_time = initial_time;
    inflation.filling_time = infinity;
    inflation.steady_drag_area = chute.drag_area * chute.cluster_drag_ratio;
    inflation.eta = std::sqrt(drag_area / inflation.steady_drag_area);
    inflation.law = &no_law;
    return inflation;
}

/// [s] at a snatch of that speed.
double initial_phase_of(const Parachute& chute, double speed) {
    return chute.initial_phase.transit ? 0.5 * chute.nominal_diameter / speed : chute.initial_phase.seconds;
}

/// A stage from `share` of the open canopy's drag area on. A whole filling time has the initial phase in it,
/// whether this stage begins with one or not.
Inflation stage_of(const Scene& scene, const Parachute& chute, std::size_t stage, double share,
                   double initial_time, double speed, double density) {
    const bool reefed = stage < chute.reefing.size();
    const FillTime& fill =
        reefed && chute.reefing[stage].fill_time ? *chute.reefing[stage].fill_time : chute.fill_time;
    const double whole = fill.seconds(fill_inputs(scene, chute, speed, density));
    Inflation inflation;
    inflation.share = share_of(chute, stage);
    const double part = filled(chute, inflation.share) - filled(chute, share);
    // One that was told in seconds belongs to the snatch, and may be long for what comes later.
    const double transit =
        initial_time > 0.0 ? initial_time : std::min(initial_phase_of(chute, speed), 0.5 * whole);
    const bool is_whole = fill.given > 0.0 || (part == 1.0 && initial_time == transit);
    inflation.initial_time = initial_time;
    inflation.filling_time = is_whole ? whole : initial_time + (whole - transit) * std::sqrt(part);
    inflation.steady_drag_area = chute.drag_area * chute.cluster_drag_ratio * inflation.share;
    inflation.eta = std::sqrt(share / inflation.share);
    inflation.law = chute.drag_area_law;
    inflation.exponent = chute.drag_area_exponent.value_or(0.0);
    if (chute.drag_area_table) inflation.table = &*chute.drag_area_table;
    return inflation;
}

}  // namespace

std::optional<RunStatus> refused_opening(const Inflation& inflation, double speed) {
    const double filling = inflation.filling_time - inflation.initial_time;
    if (filling > 0.0 && filling <= longest_flight) return {};
    if (filling <= 0.0)
        return RunStatus{
            StatusCode::refused,
            fmt::format(
                "a snatch at {:.4g} m/s: the initial phase is not shorter than the filling time (t_i = "
                "{:.4g} s, t_f = {:.4g} s), shorten parachute.initial_phase or lengthen "
                "parachute.fill_time",
                speed, inflation.initial_time, inflation.filling_time)};
    return RunStatus{
        StatusCode::refused,
        fmt::format("a snatch at {:.4g} m/s: the canopy would fill for {:.4g} s, longer than any "
                    "flight, deploy it later, as by deploy.when.delay, or give "
                    "parachute.fill_time.time",
                    speed, inflation.filling_time)};
}

FillingCanopy filling_canopy(const Parachute& chute) {
    FillingSizes sizes;
    sizes.nominal_diameter = chute.nominal_diameter;
    sizes.line_length = chute.line_length + chute.riser_length;
    sizes.drag_area = chute.drag_area * chute.cluster_drag_ratio;
    sizes.fabric = chute.permeability ? permeability_at_half_inch(*chute.permeability)
                                      : chute.fabric.permeability.value_or(Permeability{});
    sizes.geometric_porosity = std::max(chute.geometric_porosity, gap_share(chute));
    return {chute.filling, sizes};
}

Inflation make_inflation(const Scene& scene, const Parachute& chute, double snatch, double speed,
                         double density, std::size_t stage) {
    if (chute.filling.is_predicted())
        return endless(chute, snatch, 0.5 * chute.nominal_diameter / speed,
                       chute.filling.initial_mouth * chute.drag_area * chute.cluster_drag_ratio);
    const double initial_time = initial_phase_of(chute, speed);
    Inflation inflation =
        stage_of(scene, chute, stage, chute.initial_drag_area_ratio, initial_time, speed, density);
    inflation.snatch = snatch;
    return inflation;
}

Inflation next_stage(const Scene& scene, const Parachute& chute, std::size_t stage, const Inflation& before,
                     Phase phase, double time, double speed, double density) {
    if (chute.filling.is_predicted())
        return endless(chute, time, 0.0, before.steady_drag_area * before.drag_area_ratio(phase, time).value);
    const double share = before.share * before.drag_area_ratio(phase, time).value;
    Inflation inflation = stage_of(scene, chute, stage, share, 0.0, speed, density);
    inflation.snatch = time;
    inflation.ramp_start = before.ramp(phase, time).value;
    return inflation;
}

Inflation inflated(const Parachute& chute) {
    Inflation inflation;
    inflation.steady_drag_area = chute.drag_area * chute.cluster_drag_ratio;
    inflation.eta = 1.0;
    inflation.law = chute.drag_area_law;
    inflation.exponent = chute.drag_area_exponent.value_or(0.0);
    return inflation;
}

bool note_largest_peak(OpeningResult& result, const std::function<bool(std::size_t)>& is_growing) {
    bool all_known = true;
    for (ParachuteResult& chute : result.parachutes) {
        if (is_growing(chute.index)) {
            all_known = false;
            if (!chute.stages.empty()) chute.stages.back().peak_force.reset();
        }
        for (const ParachuteResult::Stage& stage : chute.stages)
            if (stage.peak_force && (!result.peak_force || *stage.peak_force > *result.peak_force)) {
                result.peak_force = stage.peak_force;
                result.peak_time = stage.peak_time;
            }
    }
    if (!all_known) result.peak_force.reset();
    return all_known;
}

namespace {

/// Adds the metrics of each of several parachutes, and of each stage of a reefed one.
void add_parachute_metrics(const MetricSink& sink, const Scene& scene, const OpeningResult& r) {
    const bool several = scene.parachutes.size() > 1;
    for (const ParachuteResult& p : r.parachutes) {
        const Parachute& chute = scene.parachutes[p.index];
        const std::string head = metric_head(several ? chute.name : "");
        const auto add = [&](const std::string& key, double value) {
            sink(head + key, value, MetricKind::result, "");
        };
        const bool opens = chute.deploy.by != DeployBy::inflated;
        if (several && opens) {
            add("snatch_time_s", p.snatch_time);
            add("snatch_speed_m_s", p.snatch_speed);
            if (p.snatch_force) add("snatch_force_N", *p.snatch_force);
        }
        if (chute.reefing.empty()) {
            if (several && !p.stages.empty() && p.stages.back().peak_force)
                add("peak_force_N", *p.stages.back().peak_force);
            if (several && opens && !p.stages.empty() && p.stages.back().full)
                add("filling_time_s", *p.stages.back().full - p.stages.back().begin);
            continue;
        }
        for (std::size_t i = 0; i < p.stages.size(); ++i) {
            const std::string stage = fmt::format("stage_{}_", i + 1);
            if (p.stages[i].peak_force) add(stage + "peak_force_N", *p.stages[i].peak_force);
            if (p.stages[i].full) add(stage + "filling_time_s", *p.stages[i].full - p.stages[i].begin);
        }
    }
}

}  // namespace

namespace {
constexpr double smallest_path_angle = 0.01;  // [rad] below which v^2/sin(gamma) says nothing
}

void add_opening_metrics(const MetricSink& sink, const Scene& scene, const OpeningResult& r,
                         const Metric& filling, const Metric& descent) {
    const Parachute& chute = scene.parachutes.front();
    const bool packed = chute.deploy.starts_packed(), one = scene.parachutes.size() == 1;
    const bool in_flight = packed || chute.deploy_when;  // its snatch is a result
    const double weight = scene.payload.mass * scene.environment.gravity;
    const double area = chute.count * 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;  // of all
    const double pressure = 0.5 * r.snatch_density * r.snatch_speed * r.snatch_speed;
    const auto add = [&](const char* key, double value, MetricKind kind = MetricKind::result,
                         const char* note = "") { sink(key, value, kind, note); };

    if (r.line_stretch_time && one) add("line_stretch_time_s", *r.line_stretch_time);
    if (r.snatched && in_flight && one) {
        add("snatch_time_s", r.snatch_time);
        add("snatch_speed_m_s", r.snatch_speed);
        if (packed) add("payload_snatch_speed_m_s", r.payload_snatch_speed);
        if (r.snatch_force)
            add("snatch_force_N", *r.snatch_force, MetricKind::result, "until the end of the initial phase");
    } else if (r.snatched && one) {
        add("snatch_speed_m_s", r.snatch_speed, MetricKind::input, "line-stretch start: the release speed");
    }
    if (r.filling_time && one) sink("filling_time_s", *r.filling_time, filling.kind, filling.note);
    if (r.filling_time && one && r.snatched)
        sink("fill_constant", *r.filling_time * r.snatch_speed / chute.nominal_diameter, filling.kind,
             "t_f v_s/D0");
    const auto add_canopy_peak = [&](const char* key, const std::optional<CanopyPeak>& peak) {
        if (peak) sink(key, peak->force, MetricKind::result, peak->note);
    };
    if (r.peak_force) add("peak_force_N", *r.peak_force);
    add_canopy_peak("peak_canopy_force_N", r.peak_canopy_force);
    add("max_force_N", r.max_force);
    add_canopy_peak("max_canopy_force_N", r.max_canopy_force);
    if (r.peak_force) add("peak_force_ratio", *r.peak_force / weight);
    add("load_factor", r.max_force / weight);
    if (r.peak_force && r.snatched && one) {
        add("time_to_peak_force_s", r.peak_time - r.snatch_time);
        if (pressure > 0.0) add("opening_shock_coefficient", *r.peak_force / (pressure * area));
    }
    if (r.snatched && one) {
        const FillTimeInputs in = fill_inputs(scene, chute, r.snatch_speed, r.snatch_density);
        if (r.snatch_density > 0.0)  // a run that failed at once has met no air
            add("mass_ratio", in.mass_ratio(), MetricKind::input,
                chute.count == 1 ? "m_l/(rho D0^3) at snatch"
                                 : "m_l/(rho D0^3) at snatch, of each parachute's share of the payload");
        const MetricKind kind = in_flight ? MetricKind::result : MetricKind::input;
        add("froude_number", in.froude_number(), kind, "v_s^2/(g D0)");
        if (r.snatch_path_angle > smallest_path_angle)
            add("operational_froude_number", in.froude_number() / std::sin(r.snatch_path_angle), kind,
                "v_s^2/(g D0 sin gamma)");
    }
    if (r.impulse && one)
        add("impulse_N_s", *r.impulse, MetricKind::result,
            "of the opening force, from snatch until the drag area is full");
    add_parachute_metrics(sink, scene, r);
    add("max_deceleration_g", r.max_deceleration / standard_gravity);
    if (r.descent) {
        const DescentWindow& w = *r.descent;
        sink("descent_rate_m_s", w.rate, descent.kind,
             fmt::format("{}; mean from {:.4g} to {:.4g} s{}", descent.note, w.from, w.to,
                         w.amplitude < steady_descent_amplitude
                             ? ""
                             : fmt::format(", about which it swings by {:.2g} %", 100.0 * w.amplitude)));
        add("descent_rate_amplitude", w.amplitude, MetricKind::result,
            "half the range of v sqrt(rho) over that time, over its mean");
        add("descent_rate_remaining_change", w.remaining, MetricKind::result,
            "estimate of what the rate is still off, at equal density");
    }
    if (r.descent_altitude) {
        add("descent_altitude_m", *r.descent_altitude);
        add("altitude_loss_m", scene.release.altitude - *r.descent_altitude, MetricKind::result,
            "from release to steady descent");
    }
    if (r.landing_time) {
        add("flight_time_s", *r.landing_time);
        // A flight in a plane leaves a direction across it to rounding.
        const double rounding = 1e-12 * r.end_position.norm() + 1e-12 * std::abs(scene.release.altitude);
        const auto part = [&](double along) { return std::abs(along) > rounding ? along : 0.0; };
        add("landing_east_m", part(r.end_position.x()));
        add("landing_north_m", part(r.end_position.y()));
        add("landing_vertical_speed_m_s", -r.end_climb, MetricKind::result,
            "of the payload over ground, downward");
        add("landing_energy_J", 0.5 * scene.payload.mass * r.end_speed * r.end_speed, MetricKind::result,
            "1/2 m v^2 of the payload alone, v its whole velocity over ground, wind drift included");
        add("drift_m", std::hypot(part(r.end_position.x()), part(r.end_position.y())), MetricKind::result,
            "horizontal distance from release to landing");
    }
}

void add_opening_metrics(RunRecord& record, const Scene& scene, const OpeningResult& r, const Metric& filling,
                         const Metric& descent) {
    const auto to_record = [&](std::string_view key, double value, MetricKind kind, std::string_view note) {
        record.add_metric(std::string(key), value, kind, std::string(note));
    };
    add_opening_metrics(to_record, scene, r, filling, descent);
}

void warn_of_first_force(RunRecord& record, const Scene& scene, const OpeningResult& r) {
    const Event* begins = record.find_event("end-of-initial-phase");
    if (!begins) begins = record.find_event("line-stretch");
    const Parachute& chute = scene.parachutes.front();
    if (!begins || !r.peak_force || scene.parachutes.size() > 1 || chute.filling.is_predicted()) return;
    constexpr double window = 3e-3, little = 0.02;  // [s] of the full model's filter; [-] of the filling
    const double since = r.peak_time - begins->time;
    if (since > window || since > little * r.filling_time.value_or(window / little)) return;
    record.warnings.push_back(
        {"the peak force is that of the first instant of filling",
         fmt::format(
             "initial_drag_area_ratio = {:g} stands in the air at once, and the force falls from there: "
             "it says nothing of the filling",
             chute.initial_drag_area_ratio),
         "give parachute.initial_drag_area_ratio its source, or start from the pack"});
}

void add_drag_area_times(RunRecord& record, const Scene& scene, const OpeningResult& r, MetricKind kind) {
    const Channel *time = record.find_channel("time"), *area = record.find_channel("drag_area");
    const Parachute& chute = scene.parachutes.front();
    if (!r.snatched || scene.parachutes.size() > 1 || chute.drag_area_mach_table || !time || !area) return;
    const double steady = chute.count * chute.drag_area * chute.cluster_drag_ratio;
    std::size_t i = 0;
    while (i < time->values.size() && time->values[i] < r.snatch_time)
        ++i;
    for (const int percent : {15, 70, 98}) {
        const double wanted = 0.01 * percent * steady;
        while (i < time->values.size() && !(area->values[i] >= wanted))
            ++i;
        if (i == time->values.size()) return;
        double at = time->values[i];
        if (i > 0 && time->values[i - 1] >= r.snatch_time && area->values[i - 1] < wanted)
            at -= (area->values[i] - wanted) / (area->values[i] - area->values[i - 1]) *
                  (at - time->values[i - 1]);
        record.add_metric(fmt::format("time_to_{}_percent_drag_area_s", percent), at - r.snatch_time, kind,
                          kind == MetricKind::input ? "by fill_time and the law of growth" : "from snatch");
    }
}

namespace {

/// Altitude [m] and rate [m/s] upward of the payload, between rows of a record: cubic Hermite.
class Descent {
public:
    explicit Descent(const RunRecord& record)
        : time_(record.find_channel("time")),
          altitude_(record.find_channel("altitude")),
          climb_(record.find_channel("vertical_speed")) {}

    bool is_there() const { return time_ && altitude_ && climb_ && time_->values.size() > 1; }
    /// The row at or just before a time inside the record.
    std::size_t row_before(double t) const {
        const auto after = std::ranges::lower_bound(time_->values, t);
        const auto i = static_cast<std::size_t>(after - time_->values.begin());
        return std::clamp<std::size_t>(i, 1, time_->values.size() - 1) - 1;
    }
    double sink_at(double t) const {
        const std::size_t i = row_before(t);
        const double h = time_->values[i + 1] - time_->values[i];
        const double x = h > 0.0 ? (t - time_->values[i]) / h : 1.0;
        return -((1.0 - x) * climb_->values[i] + x * climb_->values[i + 1]);
    }
    double altitude_at(double t) const {
        const std::size_t i = row_before(t);
        const double h = time_->values[i + 1] - time_->values[i];
        if (!(h > 0.0)) return altitude_->values[i + 1];
        const double x = (t - time_->values[i]) / h, y = 1.0 - x;
        return y * y * (1.0 + 2.0 * x) * altitude_->values[i] +
               x * x * (1.0 + 2.0 * y) * altitude_->values[i + 1] +
               h * x * y * (y * climb_->values[i] - x * climb_->values[i + 1]);
    }

private:
    const Channel *time_, *altitude_, *climb_;
};

/// Time [s] of the first event after `full` that ends the stage of a parachute: another of its stages, its
/// cut, or another parachute's line stretch or snatch.
std::optional<double> end_of_stage(const RunRecord& record, double full) {
    for (const Event& event : record.events) {
        const std::string_view what = std::string_view(event.name).substr(event.name.rfind('.') + 1);
        const bool ends = what == "disreef" || what == "cut" || what == "line-stretch" || what == "snatch";
        if (ends && event.time >= full) return event.time;
    }
    return {};
}

/// Adds the mean rate at the end of a stage, and how far the halves of v/g differ, in which it becomes
/// steady; of a shorter stage at its pace.
void add_stage_rate(RunRecord& record, const Descent& descent, double gravity, const std::string& key,
                    double full, double end) {
    const double settling = std::abs(descent.sink_at(end)) / gravity, length = std::min(settling, end - full);
    const double from = end - length, middle = end - 0.5 * length;
    const double top = descent.altitude_at(from), half = descent.altitude_at(middle),
                 bottom = descent.altitude_at(end);
    const double rate = (top - bottom) / length;
    const double change = ((half - bottom) - (top - half)) / (0.5 * length) / rate * (settling / length);
    record.add_metric(
        key, rate, MetricKind::mixed,
        fmt::format(
            "mean over the last {:.3g} s of the stage, until t = {:.4g} s; {}", length, end,
            std::abs(change) < steady_descent_change
                ? std::string("steady")
                : fmt::format(
                      "not steady: {:+.2g} % from one half of {} to the other", 100.0 * change,
                      length < settling ? fmt::format("{:.3g} s at that pace", settling) : "that time")));
}

}  // namespace

void add_stage_descent_rates(RunRecord& record, const Scene& scene, const OpeningResult& r) {
    const Descent descent(record);
    const bool several = scene.parachutes.size() > 1;
    if (!descent.is_there()) return;
    const bool landed = r.landing_time.has_value();
    for (const ParachuteResult& p : r.parachutes) {
        const Parachute& chute = scene.parachutes[p.index];
        const bool is_last = p.index == r.parachutes.back().index;
        const std::string head = metric_head(several ? chute.name : "");
        const std::size_t stages = chute.reefing.size() + 1;
        for (std::size_t i = 0; i < stages; ++i) {
            if (is_last && i + 1 == stages) break;  // descent_rate_m_s
            const std::string key =
                head + (stages > 1 ? fmt::format("stage_{}_", i + 1) : "") + "descent_rate_m_s";
            const auto missing = [&](std::string why) {
                record.missing.push_back({key, std::move(why), record.status.code == StatusCode::completed});
            };
            if (i >= p.stages.size()) {
                missing(landed ? "the payload was on the ground before that stage began"
                               : "the run stopped before that stage began");
                continue;
            }
            const std::optional<double> full = p.stages[i].full;
            if (!full) {
                missing("the stage ended before its drag area was full");
                continue;
            }
            const std::optional<double> end = end_of_stage(record, *full);
            if (!end || !(*end > *full) || !(std::abs(descent.sink_at(*end)) > 0.0)) {
                missing(end      ? "the stage ended as its drag area was full"
                        : landed ? "the payload was on the ground before that stage ended"
                                 : "the run stopped before that stage ended");
                continue;
            }
            add_stage_rate(record, descent, scene.environment.gravity, key, *full, *end);
        }
    }
}

void add_reefed_drag_areas(RunRecord& record, const Scene& scene, const OpeningResult& r) {
    const Channel *time = record.find_channel("time"), *area = record.find_channel("drag_area");
    const Parachute& chute = scene.parachutes.front();
    if (!chute.filling.is_predicted() || scene.parachutes.size() > 1 || r.parachutes.empty() || !time ||
        !area)
        return;
    const auto& stages = r.parachutes.front().stages;
    for (std::size_t i = 0; i < std::min(stages.size(), chute.reefing.size()); ++i) {
        if (!stages[i].full) continue;
        const double end = i + 1 < stages.size() ? stages[i + 1].begin : time->values.back();
        const double from = 0.5 * (*stages[i].full + end);
        double sum = 0.0, span = 0.0;
        for (std::size_t k = 1; k < time->values.size(); ++k) {
            const double dt = time->values[k] - time->values[k - 1];
            if (time->values[k - 1] < from || time->values[k] > end) continue;
            sum += 0.5 * (area->values[k] + area->values[k - 1]) * dt;
            span += dt;
        }
        if (span > 0.0)
            record.add_metric(fmt::format("stage_{}_drag_area_m2", i + 1), sum / span, MetricKind::result,
                              "mean over the second half of the time that its line holds it");
    }
}

bool all_are_cut(const RunRecord& record, const Scene& scene) {
    return std::ranges::all_of(scene.parachutes, [&](const Parachute& p) {
        return record.find_event(scene.parachutes.size() > 1 ? p.name + ".cut" : "cut") != nullptr;
    });
}

void warn_of_unsteady_descent(RunRecord& record, const Scene& scene,
                              const std::optional<DescentWindow>& last) {
    using enum Trigger::Kind;
    const Trigger::Kind stop = scene.stop.kind;
    const bool ended_by_itself = record.status.code == StatusCode::completed ||
                                 record.status.code == StatusCode::stopped_by_event ||
                                 record.status.code == StatusCode::time_limit;
    if (!ended_by_itself || stop == full_open || stop == line_stretch || stop == peak_force) return;
    const bool has_landed = record.find_event("ground") != nullptr;
    if (has_landed && all_are_cut(record, scene)) return;  // warn_of_sequence says what that means
    const bool waits = last && last->is_steady();
    record.warnings.push_back({not_steady_within_run, unsteadiness_text(last),
                               waits        ? "check what that parachute waits for, or why it does not fill"
                               : has_landed ? "release higher, or lower environment.ground"
                                            : "stop later, or with stop.at = \"steady-descent\""});
}

namespace {

/// Filling constants of types were found in tests at 150 to 500 ft/s (Knacke, p. 5-43).
constexpr double slowest_test = 150.0 * 0.3048, fastest_test = 500.0 * 0.3048;

void warn_of_typical_filling(RunRecord& record, const Parachute& chute, double speed,
                             const std::string& whose) {
    const bool typical = chute.type && chute.type->fill_constant && chute.fill_time.model != nullptr &&
                         chute.fill_time.model->name == "fill-constant" &&
                         chute.fill_time.n == chute.type->fill_constant->middle();
    if (!typical || (speed >= slowest_test && speed <= fastest_test)) return;
    const bool slow = speed < slowest_test;
    record.warnings.push_back(
        {fmt::format("{}n = {:g} of {} canopies at {:.3g} m/s", whose, chute.fill_time.n, chute.type->title,
                     speed),
         slow ? "it was found between 45.7 and 152.4 m/s; five small canopies measured below that pulled "
                "about three times as hard as n = 8 says (docs/validation.md)"
              : "it was found between 45.7 and 152.4 m/s; above that no test says how the canopy opens",
         slow ? "give fill_time.n from tests of a canopy of this kind and size"
              : "open more slowly, or give fill_time.n from tests"});
}

void warn_of_fill_table(RunRecord& record, const Parachute& chute, const FillTimeInputs& in,
                        const std::string& whose) {
    if (!chute.fill_time.table || chute.fill_time.table->covers(in)) return;
    const FillTable& table = *chute.fill_time.table;
    const bool froude = table.by == FillTable::By::froude_number;
    record.warnings.push_back(
        {fmt::format("{}{} {:.3g} is beyond {}", whose, froude ? "Froude number" : "mass ratio",
                     table.abscissa(in), table.file),
         fmt::format("its points reach from {:g} to {:g}; the nearer end is held", table.at.front(),
                     table.at.back()),
         "add points to the table, or choose another fill_time.model"});
}

/// The scene says itself how its canopy over-inflates.
bool overshoots(const Parachute& chute) {
    return chute.drag_area_table && chute.drag_area_table->end() > 1.0;
}

/// [-] change of the snatch speed by gravity during filling, up to which it is one speed for all of it.
constexpr double steady_speed = 0.1;

/// [-] of the snatch speed that may be gained in the lead of a predicted filling.
constexpr double slow_lead = 0.3;

/// A canopy is opened by air that presses harder than it will at last, unless the scene says how long it
/// takes.
void warn_of_weak_snatch(RunRecord& record, const Scene& scene, const Parachute& chute,
                         const Inflation& inflation, double speed, double density, const std::string& whose) {
    if (chute.fill_time.given > 0.0) return;
    const double weight = (scene.payload.mass + chute.count * chute.mass) * scene.environment.gravity;
    const double area = chute.count * chute.cluster_drag_ratio * chute.drag_area;
    const double steady = std::sqrt(2.0 * weight / (density * area));
    if (speed >= steady) return;
    if (scene.environment.gravity * inflation.filling_time > steady_speed * speed) {
        record.warnings.push_back(
            {fmt::format("{}too slow to inflate: {:.3g} m/s at snatch", whose, speed),
             fmt::format(
                 "slower than the open canopy falls, {:.3g} m/s: n D0/v_s takes that speed for the whole "
                 "opening, and no test says how a canopy fills in it",
                 steady),
             "release faster or fall further before snatch, or give fill_time.time"});
        return;
    }
    // The speed hardly changes meanwhile: what lacks is air, as high up on the way to an apogee. Others than
    // the one that lands the payload need not carry it.
    if (&chute != &landing_parachute(scene)) return;
    record.warnings.push_back(
        {fmt::format("{}thin air: a dynamic pressure of {:.3g} Pa at snatch", whose,
                     0.5 * density * speed * speed),
         fmt::format("the open canopy carries its payload at {:.3g} Pa; no test says how a canopy fills in "
                     "less, or whether it does",
                     weight / area),
         "open lower, or give fill_time.time"});
}

/// Why a canopy is not the round one, closed above, whose balance of air predicts a filling; empty: it is.
std::string why_not_round(const Parachute& chute) {
    if (const auto corners = open_corners(chute)) return corners->why;
    if (has_open_middle(chute)) return fmt::format("{} canopies have an open middle", chute.type->title);
    if (holds_vent_down(chute)) return "lines hold its vent down";
    return lacks_canopy(chute);
}

void warn_of_round_filling(RunRecord& record, const Parachute& chute, const std::string& whose) {
    if (const std::string why = why_not_round(chute); !why.empty())
        record.warnings.push_back(
            {whose + "the filling that is predicted is that of a round canopy, closed above", why,
             "take filling time and peak force for such a canopy's, or tell the filling by fill_time"});
}

}  // namespace

void add_opening_warnings(RunRecord& record, const Scene& scene, const Parachute& chute,
                          const Inflation& inflation, double altitude, double speed, double density) {
    const std::string whose = scene.parachutes.size() > 1 ? chute.name + ": " : "";
    const FillTimeInputs in = fill_inputs(scene, chute, speed, density);
    const double mass_ratio = in.mass_ratio();
    if (mass_ratio > 1.0 && !overshoots(chute))
        record.warnings.push_back(
            {fmt::format("{}mass ratio {:.2f}", whose, mass_ratio),
             chute.filling.is_predicted()
                 ? "above 1 the drag area overshoots its steady value; the prediction ends at full open"
                 : "above 1 the drag area overshoots its steady value, which the drag-area law does not know",
             "treat the peak force as a lower bound"});
    // The others judge a filling time that was told.
    if (chute.filling.is_predicted()) {
        if (scene.environment.gravity * inflation.initial_time > slow_lead * speed)
            record.warnings.push_back(
                {fmt::format("{}too slow for a predicted filling: {:.3g} m/s at snatch", whose, speed),
                 fmt::format(
                     "the half diameter ahead of it takes {:.3g} s at that speed, in which the payload "
                     "falls faster",
                     inflation.initial_time),
                 "release faster or fall further before snatch, or prescribe the filling"});
        return warn_of_round_filling(record, chute, whose);
    }
    warn_of_weak_snatch(record, scene, chute, inflation, speed, density, whose);
    warn_of_fill_table(record, chute, in, whose);
    warn_of_typical_filling(record, chute, speed, whose);
    // By default its share follows from n alone, which is said beside n: there is nothing to correct.
    if (!chute.initial_phase.transit && chute.reefing.empty() &&
        inflation.initial_time > longest_initial_share * inflation.filling_time)
        record.warnings.push_back({fmt::format("{}initial phase is {:.0f} % of the filling time", whose,
                                               100.0 * inflation.initial_time / inflation.filling_time),
                                   "tests show at most 15 % (paper, 3.2.2)",
                                   "shorten parachute.initial_phase, or give a longer fill time"});
    const double height = altitude - scene.environment.ground;
    if (inflation.filling_time * speed > height)
        record.warnings.push_back(
            {fmt::format("{}the canopy fills over {:.3g} m, from {:.3g} m above ground", whose,
                         inflation.filling_time * speed, height),
             fmt::format("t_f = {:.3g} s at the snatch speed of {:.3g} m/s", inflation.filling_time, speed),
             "check fill_time, or open higher"});
}

void add_scene_warnings(RunRecord& record, const Scene& scene) {
    double mass = 0.0;
    for (const Parachute& chute : scene.parachutes)
        mass += chute.count * chute.mass;
    if (scene.payload.mass < mass)
        record.warnings.push_back({"payload lighter than its parachute",
                                   "the two-body picture of an opening assumes the opposite",
                                   "check payload.mass and parachute.mass"});
}

}  // namespace twinchute
