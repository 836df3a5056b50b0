#include "rom/run_rom.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/record/metrics.hpp"
#include "lib/scene/calibration.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/filling_bracket.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/shortfall.hpp"
#include "lib/solve/stopwatch.hpp"
#include "lib/solve/validity.hpp"
#include "rom/batch.hpp"
#include "rom/deployment.hpp"
#include "rom/estimates.hpp"
#include "rom/fidelity.hpp"
#include "rom/flight.hpp"
#include "rom/plan.hpp"
#include "rom/rom_record.hpp"

namespace twinchute::rom {
namespace {

/// Runs a scene; what an opening is judged by goes to `openings.result`.
template <int dimensions>
RunStatus fly(const Scene& scene, RunContext& context, OpeningSequence& sequence, Openings& openings) {
    OpeningResult& result = openings.result;
    Motion<dimensions> motion = released<dimensions>(scene);
    double time = 0.0, separation = 0.0;
    result.snatch_speed = result.payload_snatch_speed = release_airspeed(scene).norm();
    result.snatch_density = scene.environment.atmosphere.at(motion.altitude()).density;
    result.snatched = false;
    sequence.release(flight_state_of<dimensions>(scene, time, motion));
    for (;;) {
        if (const auto leaving = sequence.leaves_pack()) {
            const Parachute& chute = scene.parachutes[*leaving];
            const Deployed<dimensions> deployed =
                deploy<dimensions>(scene, context, sequence, openings, time, motion);
            result.line_stretch_time = deployed.line_stretch_time;
            if (deployed.payload_landed) result.landing_time = context.observer.rows().back().time;
            if (deployed.line_stretch_time)
                add_snatch_forms(context.record, scene, chute, deployed.separation_speed, deployed.stretch);
            if (!deployed.locked) return deployed.status;
            motion = *deployed.locked;
            time = deployed.snatch_time;
            separation = deployed.separation;
            result.payload_snatch_speed = deployed.payload_speed;
            sequence.snatched(*leaving, flight_state_of<dimensions>(scene, time, motion));
        }
        const auto status = fly_on<dimensions>(scene, context, sequence, time, motion, separation, openings);
        if (status) return *status;
        time = context.observer.rows().back().time;
    }
}

/// Results of the whole run, from its observer.
void judge_flight(const Scene& scene, int dimensions, RunContext& context, Openings& openings) {
    openings.close();
    OpeningResult& result = openings.result;
    const Observer& observer = context.observer;
    const HistoryRow& last = observer.rows().back();
    RunRecord& record = context.record;
    if (!note_largest_peak(result, [&](std::size_t index) { return openings.is_growing(index); }))
        result.peak_canopy_force.reset();
    if (!result.parachutes.empty()) result.snatch_force = result.parachutes.front().snatch_force;
    if (result.peak_force) {
        record.events.push_back({"peak-force", result.peak_time, observer.altitude_at(result.peak_time),
                                 observer.speed_at(result.peak_time)});
        std::ranges::stable_sort(record.events, {}, &Event::time);
    }
    // Where one canopy pulls at a time they repeat the forces above.
    if (std::ranges::none_of(observer.rows(), [](const HistoryRow& r) { return r.canopies > 1; })) {
        result.peak_canopy_force.reset();
        result.max_canopy_force.reset();
    }
    if (result.filling_time)
        result.impulse =
            observer.impulse_between(result.snatch_time, result.snatch_time + *result.filling_time);
    result.max_deceleration = observer.largest_deceleration();
    result.end_position = place_of(last, scene, dimensions);
    result.end_speed = last.speed;
    result.end_climb = last.vertical_speed;
}

/// Source of the filling time, in words.
std::string filling_note(const Parachute& chute) {
    if (chute.filling.is_predicted())
        return fmt::format("predicted from an initial mouth of {:g}", chute.filling.initial_mouth);
    const FillTime& fill = chute.fill_time;
    if (!chute.reefing.empty()) return "prescribed stage by stage; when lines are cut is part of it";
    if (fill.model->name == "given") return "given in the scene";
    if (fill.table) return fmt::format("prescribed: n of {} and the snatch speed", fill.table->file);
    if (fill.balance) return "a balance of the mass of air in the canopy, from the snatch speed";
    if (fill.model->by_porosity)
        return fmt::format("prescribed: lambda_g = {:g} and the snatch speed", chute.geometric_porosity);
    return fmt::format("prescribed: n = {:g} and the snatch speed", fill.n);
}

void add_metrics(RunRecord& record, const Scene& scene, const OpeningResult& result) {
    const Parachute& chute = scene.parachutes.front();
    const bool predicted = chute.filling.is_predicted();
    const Metric filling{"", 0.0, predicted ? MetricKind::result : MetricKind::input, filling_note(chute)};
    const Metric descent{"", 0.0, MetricKind::mixed,
                         "(C_D S)_0 and mass are inputs; the balance is the result"};
    add_opening_metrics(record, scene, result, filling, descent);
    if (predicted && scene.parachutes.size() == 1)
        record.add_metric("initial_mouth_ratio", chute.filling.initial_mouth, MetricKind::input,
                          "area of the bulb at snatch over the steady one");
    if (!result.descent) warn_of_unsteady_descent(record, scene, result.last_window);
}

/// Whether the formulas of openings apply: one canopy that opens at once.
bool is_one_opening(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    return scene.parachutes.size() == 1 && chute.count == 1 && chute.reefing.empty();
}

FlightState end_of_flight(const Scene& scene, const HistoryRow& last) {
    const double density = scene.environment.atmosphere.at(last.altitude).density;
    return {last.time, last.altitude, last.vertical_speed, std::sqrt(2.0 * last.dynamic_pressure / density),
            density};
}

/// A canopy that still squids at the end of a run has not opened, whatever ended it.
void note_squids(RunRecord& record, const OpeningSequence& sequence, const FlightState& now) {
    const bool ended =
        record.status.code == StatusCode::completed || record.status.code == StatusCode::stopped_by_event;
    const auto squids =
        std::ranges::find_if(sequence.all(), [](const Canopy& c) { return c.fills_itself() && c.squids; });
    if (!ended || squids == sequence.all().end()) return;
    const auto critical = squids->filling->critical_speed(now.density);
    const std::string opens = !critical          ? "it would open at any subsonic speed from a wider mouth"
                              : *critical == 0.0 ? "it opens at no speed"
                                                 : fmt::format("it opens below {:.4g} m/s", *critical);
    record.status = {
        StatusCode::squids,
        fmt::format("{}: at {:.4g} m/s the fabric of '{}' lets out all that its mouth takes in; "
                    "{} in air of {:.4g} kg/m^3; a larger parachute.filling.initial_mouth or fabric that "
                    "lets less through opens at higher speeds",
                    record.status.detail, now.airspeed, squids->chute->name, opens, now.density)};
}

Reached reached_by(const Scene& scene, const RunContext& context, const OpeningSequence& sequence) {
    constexpr double on_ground = 1e-6;  // [m] to which a stop at the altitude of the ground is met
    const bool landed = context.record.find_event("ground") != nullptr ||
                        context.observer.rows().back().altitude - scene.environment.ground < on_ground;
    return {landed, sequence.unopened().empty() && sequence.is_open(), !sequence.is_open()};
}

/// The record of Run::samples.
template <int dimensions>
RunRecord sample_in(const Scene& scene, Run& run) {
    RunRecord record;
    record.fidelity = "rom";
    RunContext context(scene, run, record);
    context.observer.sample(run.samples);
    OpeningResult result;
    OpeningSequence sequence(scene);
    Openings openings(scene, context, sequence, result);
    record.status = fly<dimensions>(scene, context, sequence, openings);
    if (context.observer.rows().empty()) return record;  // refused before it began
    note_squids(record, sequence, end_of_flight(scene, context.observer.rows().back()));
    const std::vector<HistoryRow>& rows = context.observer.samples();
    add_channels(record, rows, scene, dimensions);
    Channel specific{"specific_force", "m/s^2", {}};
    for (const HistoryRow& row : rows)
        specific.values.push_back(row.specific_force);
    record.channels.push_back(std::move(specific));
    return record;
}

template <int dimensions>
RunRecord run_in(const Scene& scene, Run& run, bool with_bracket) {
    if (!run.samples.empty()) return sample_in<dimensions>(scene, run);
    RunRecord record = begin_record(scene, "rom");
    const Stopwatch watch;
    RunContext context(scene, run, record);
    OpeningResult result;
    OpeningSequence sequence(scene);
    Openings openings(scene, context, sequence, result);
    record.status = fly<dimensions>(scene, context, sequence, openings);
    if (context.observer.rows().empty()) return record;  // refused before it began
    judge_flight(scene, dimensions, context, openings);
    note_squids(record, sequence, end_of_flight(scene, context.observer.rows().back()));
    const Reached reached = reached_by(scene, context, sequence);
    record.cost.wall_s = watch.wall();
    record.cost.cpu_s = watch.cpu();
    add_metrics(record, scene, result);
    note_never_opened(record, scene, never_opened(sequence), reached);
    warn_of_sequence(record, scene, sequence);
    note_missing_metrics(record, scene, reached);
    if (is_one_opening(scene)) add_estimates(record, scene, result);
    add_channels(record, context.observer.rows(), scene, dimensions);
    add_drag_area_times(
        record, scene, result,
        scene.parachutes.front().filling.is_predicted() ? MetricKind::result : MetricKind::input);
    add_reefed_drag_areas(record, scene, result);
    add_stage_descent_rates(record, scene, result);
    add_validity(record, scene, result);
    record.left_out = left_out_of(parts_of(scene));
    add_scene_warnings(record, scene);
    warn_of_first_force(record, scene, result);
    if (with_bracket)
        add_filling_bracket(record, scene, result.snatch_density, [](const Scene& other) {
            Run alone;
            return run_in<dimensions>(other, alone, false);
        });
    return record;
}

/// Metrics of a run alone: no record of it, no estimates, no judgement of its inputs.
template <int dimensions>
RunStatus metrics_in(const Scene& scene, Run& run, std::span<const std::string> keys,
                     std::span<double> values) {
    std::ranges::fill(values, std::numeric_limits<double>::quiet_NaN());
    RunRecord record;
    RunContext context(scene, run, record);
    OpeningResult result;
    OpeningSequence sequence(scene);
    Openings openings(scene, context, sequence, result);
    record.status = fly<dimensions>(scene, context, sequence, openings);
    if (context.observer.rows().empty()) return record.status;
    judge_flight(scene, dimensions, context, openings);
    note_squids(record, sequence, end_of_flight(scene, context.observer.rows().back()));
    add_opening_metrics(record, scene, result, {}, {});
    note_never_opened(record, scene, never_opened(sequence), reached_by(scene, context, sequence));
    if (std::ranges::any_of(keys, needs_channels)) {
        add_channels(record, context.observer.rows(), scene, dimensions);
        add_drag_area_times(record, scene, result, MetricKind::result);
        add_reefed_drag_areas(record, scene, result);
        add_stage_descent_rates(record, scene, result);
        add_validity(record, scene, result);
    }
    const Parachute& chute = scene.parachutes.front();
    if (chute.filling.is_predicted() && scene.parachutes.size() == 1)
        record.add_metric("initial_mouth_ratio", chute.filling.initial_mouth, MetricKind::input, "");
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (const auto value = record.metric(keys[i])) values[i] = *value;
    return record.status;
}

/// A pack without drag falls beside its payload.
std::vector<std::string> unsupported_keys(const Scene& scene) {
    for (const Parachute& chute : scene.parachutes)
        if (chute.deploy.by == DeployBy::free && !(chute.deploy.pack_drag_area > 0.0))
            return {"parachute.deploy.pack_drag_area"};
    return {};
}

}  // namespace

namespace {

RunRecord run_plain(const Scene& scene, Run& run) {
    switch (dimensions_of(scene)) {
        case 1:
            return run_in<1>(scene, run, true);
        case 2:
            return run_in<2>(scene, run, true);
        default:
            return run_in<3>(scene, run, true);
    }
}

RunStatus plain_metrics(const Scene& scene, Run& run, std::span<const std::string> keys,
                        std::span<double> values) {
    switch (dimensions_of(scene)) {
        case 1:
            return metrics_in<1>(scene, run, keys, values);
        case 2:
            return metrics_in<2>(scene, run, keys, values);
        default:
            return metrics_in<3>(scene, run, keys, values);
    }
}

}  // namespace

RunRecord run_rom(const Scene& scene, Run& run) {
    if (!has_calibration(scene)) return run_plain(scene, run);
    RunRecord record = run_plain(calibrated(scene), run);
    if (!run.samples.empty()) return record;
    Run alone;
    const RunRecord without = run_plain(uncalibrated(scene), alone);
    record.uncalibrated = {calibrated_inputs(scene), {}};
    for (const MetricRow& row : metric_rows())
        if (const Metric* metric = without.find_metric(row.key))
            record.uncalibrated->metrics.push_back(*metric);
    return record;
}

RunStatus rom_metrics(const Scene& scene, Run& run, std::span<const std::string> keys,
                      std::span<double> values) {
    if (!has_calibration(scene)) return plain_metrics(scene, run, keys, values);
    return plain_metrics(calibrated(scene), run, keys, values);
}

const Fidelity& rom_fidelity() {
    static constexpr Fidelity row{.name = "rom",
                                  .title = "reduced-order model",
                                  .run = &run_rom,
                                  .unsupported_keys = &unsupported_keys,
                                  .plan = &plan_rom,
                                  .metrics = &rom_metrics,
                                  .batches = &batches,
                                  .metrics_of_batch = &batch_metrics,
                                  .batch = batch_lanes};
    return row;
}

}  // namespace twinchute::rom
