#include "fullsim/run/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/run/parts.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/shortfall.hpp"
#include "lib/solve/validity.hpp"

namespace twinchute::fullsim {
namespace {

/// Whether the canopy is neither full nor as full as its reefing line lets it be, and has not stopped to
/// grow.
bool still_fills(const RunView& run, const RunStatus& status) {
    return run.snatched() && !run.inflated() && status.code != StatusCode::squids &&
           run.observer.rows().back().time < run.full_open() && !run.findings.stages.back().full;
}

/// Opening of a reefed parachute, stage by stage.
ParachuteResult stages_of_opening(const RunView& run) {
    ParachuteResult opening;
    opening.snatch_time = run.findings.snatch;
    opening.stages = run.findings.stages;
    opening.stages.front().begin = run.findings.snatch;
    const auto& earlier = run.observer.earlier_peaks();
    for (std::size_t i = 0; i < opening.stages.size(); ++i) {
        const Observer::Peak& peak = i < earlier.size() ? earlier[i] : run.observer.peak();
        if (peak.value > 0.0) opening.stages[i].peak_force = peak.value;
        opening.stages[i].peak_time = peak.time;
    }
    return opening;
}

/// Mean projected area [m^2] of the open canopy at the end; none where the run has not seen enough of it.
std::optional<double> steady_area_of(const RunView& run) {
    if (run.observer.rows().back().time < run.full_open() + shape_average) return {};
    return run.observer.mean(&HistoryRow::projected_area, shape_average);
}

OpeningResult opening_of(const RunView& run, const RunStatus& status, std::optional<double> steady_area) {
    const Observer& seen = run.observer;
    const Findings& found = run.findings;
    const HistoryRow& last = seen.rows().back();
    OpeningResult result;
    result.snatched = !run.inflated() && run.snatched();
    if (result.snatched) {
        result.line_stretch_time = found.line_stretch_time;
        result.snatch_time = found.snatch;
        result.snatch_speed = run.snatch_speed();
        result.snatch_path_angle =
            run.packed() ? found.snatch_path_angle : angle_below_horizon(release_airspeed(run.scene));
        result.payload_snatch_speed = run.packed() ? found.payload_snatch_speed : result.snatch_speed;
        result.snatch_density = run.snatch_density();
    }
    if (steady_area && !run.inflated()) {
        result.filling_time = seen.first_time_of_area(filled_share * *steady_area, run.last_stage());
        if (result.filling_time) *result.filling_time -= found.snatch;
    }
    if (run.packed()) result.snatch_force = seen.snatch_peak().value;
    const Observer::Peak peak = run.largest_peak();
    const bool fills = still_fills(run, status);
    if (peak.value > 0.0 && !fills) result.peak_force = peak.value;
    result.max_force = std::max(peak.value, seen.snatch_peak().value);
    result.peak_time = peak.time;
    if (run.sequence && result.snatched) {
        result.parachutes.push_back(stages_of_opening(run));
        if (fills) result.parachutes.back().stages.back().peak_force.reset();
    }
    if (const double filled = run.full_open(); last.time >= filled && !run.inflated())
        result.impulse = seen.impulse(found.snatch, filled);
    result.max_deceleration = seen.largest_acceleration();
    result.descent = found.descent;
    result.descent_altitude = found.descent_altitude;
    result.landing_time = found.landing_time;
    result.end_position = last.position;
    result.end_speed = last.velocity.norm();
    result.end_climb = last.velocity.z();
    return result;
}

/// The largest force of any one canopy, while the peak force counts and over all of the run.
void add_canopy_peaks(const RunView& run, std::span<const RunView> each, OpeningResult& result) {
    const auto note = [&](std::size_t k, double time) {
        return fmt::format("canopy {} of {} {}, at t = {:.4g} s", k + 1, each.size(), run.parachute().name,
                           time);
    };
    for (std::size_t k = 0; k < each.size(); ++k) {
        const Observer::Peak peak = each[k].largest_peak(), &snatch = each[k].observer.snatch_peak();
        const Observer::Peak& most = snatch.value > peak.value ? snatch : peak;
        if (result.peak_force && peak.value > 0.0 &&
            (!result.peak_canopy_force || peak.value > result.peak_canopy_force->force))
            result.peak_canopy_force = {peak.value, note(k, peak.time)};
        if (!result.max_canopy_force || most.value > result.max_canopy_force->force)
            result.max_canopy_force = {most.value, note(k, most.time)};
    }
}

/// Channels and metrics of each canopy: canopy_2_force, canopy_2_peak_force_N.
void add_canopies(const RunView& run, std::span<const RunView> each, RunRecord& record) {
    Channel largest{"canopy_force", "N", {}};
    for (const HistoryRow& row : each.front().observer.rows())
        largest.values.push_back(row.force);
    for (std::size_t k = 1; k < each.size(); ++k)
        for (std::size_t i = 0; i < largest.values.size(); ++i)
            largest.values[i] = std::max(largest.values[i], each[k].observer.rows()[i].force);
    record.channels.push_back(std::move(largest));
    for (std::size_t k = 0; k < each.size(); ++k) {
        const RunView& one = each[k];
        const std::string head = fmt::format("canopy_{}_", k + 1);
        const auto channel = [&](const char* name, const char* unit, double HistoryRow::*column) {
            Channel c{head + name, unit, {}};
            for (const HistoryRow& row : one.observer.rows())
                c.values.push_back(row.*column);
            record.channels.push_back(std::move(c));
        };
        channel("force", "N", &HistoryRow::force);
        channel("drag_area", "m^2", &HistoryRow::drag_area);
        channel("projected_area", "m^2", &HistoryRow::projected_area);
        if (const Observer::Peak peak = one.largest_peak();
            peak.value > 0.0 && !still_fills(one, record.status))
            record.add_metric(head + "peak_force_N", peak.value, MetricKind::result,
                              fmt::format("of its riser, at t = {:.4g} s", peak.time));
        const auto steady = steady_area_of(one);
        if (!steady || one.inflated()) continue;
        if (const auto filled = one.observer.first_time_of_area(filled_share * *steady, one.last_stage()))
            record.add_metric(
                head + "filling_time_s", *filled - one.findings.snatch, MetricKind::result,
                fmt::format("projected area first at {:g} % of its steady mean", 100.0 * filled_share));
    }
    double force = 0.0, deepest = 0.0;
    for (const CanopyPlane& plane : run.canopies.planes()) {
        force = std::max(force, plane.largest_force());
        deepest = std::max(deepest, plane.deepest());
    }
    record.add_metric("max_canopy_contact_force_N", force, MetricKind::result,
                      force > 0.0 ? "between two canopies, along a plane" : "canopies never touched");
    if (force > 0.0)
        record.add_metric("max_canopy_contact_depth_m", deepest, MetricKind::result,
                          "of fabric behind the plane along which two canopies touch");
}

/// Events that only a look back at the history shows.
void add_past_events(const RunView& run, const OpeningResult& result, RunRecord& record) {
    const auto& rows = run.observer.rows();
    const auto add = [&](const char* name, double time) {
        auto row = std::ranges::lower_bound(rows, time, {}, &HistoryRow::time);
        if (row == rows.end()) --row;
        record.events.push_back({name, time, row->position.z(), row->velocity.norm()});
    };
    if (result.peak_force) add("peak-force", result.peak_time);
    if (result.filling_time) add("canopy-filled", run.findings.snatch + *result.filling_time);
    std::ranges::stable_sort(record.events, {}, &Event::time);
}

void add_shape(const RunView& run, double steady_area, RunRecord& record) {
    const double nominal = run.parachute().nominal_diameter,
                 diameter = 2.0 * std::sqrt(steady_area / run.parachute().count / pi);
    const auto mean = [&](double HistoryRow::*column) { return run.observer.mean(column, shape_average); };
    record.add_metric("projected_diameter_ratio", diameter / nominal, MetricKind::result,
                      "equal-area diameter over D0, mean of the last 2 s");
    record.add_metric("seam_diameter_ratio", mean(&HistoryRow::seam_diameter) / nominal, MetricKind::result,
                      "widest ring of seam nodes over D0");
    record.add_metric("canopy_depth_ratio", mean(&HistoryRow::depth) / diameter, MetricKind::result,
                      holds_vent_down(run.parachute()) ? "highest seams to skirt over the equal-area diameter"
                                                       : "vent to skirt over the equal-area diameter");
    record.add_metric("signed_area_ratio", mean(&HistoryRow::signed_area) / steady_area, MetricKind::result,
                      "1 when no gore lies inside out");
}

std::vector<NeverOpened> unopened_of_one(const RunView& run) {
    if (run.sequence) return never_opened(*run.sequence);
    if (run.parachute().filling.is_predicted() && run.snatched() && run.findings.landing_time &&
        !std::isfinite(run.full_open()))
        return {{0, 1, "it was still filling on the ground (parachute.filling.initial_mouth)"}};
    if (went_through_itself(run))
        return {{0, 1,
                 fmt::format("its skirt turns {:g} times on its way around: fabric has passed through fabric",
                             run.observer.rows().back().turns),
                 "do not trust its loads; two or more elements across a gore come apart again, and another "
                 "full.noise.seed may spare it",
                 true}};
    if (run.snatched()) return {};
    return {{0, 1, "it had begun to leave its pack and never came to snatch"}};
}

/// Canopies that failed, of a cluster those of one reason together.
std::vector<NeverOpened> unopened(std::span<const RunView> each) {
    std::vector<NeverOpened> all;
    for (const RunView& run : each)
        for (NeverOpened& one : unopened_of_one(run)) {
            const auto same = std::ranges::find(all, one.why, &NeverOpened::why);
            if (same == all.end())
                all.push_back(std::move(one));
            else
                same->count += one.count;
        }
    return all;
}

Reached reached_by(const RunView& run, bool has_filling_time) {
    const double end = run.observer.rows().back().time;
    Reached reached;
    reached.ground = run.findings.landing_time.has_value();
    reached.full_open = run.snatched() && end >= run.full_open();
    reached.filling = run.snatched() && !reached.full_open;
    if (!reached.full_open || has_filling_time) return reached;
    reached.filling_cut_short = end < run.full_open() + shape_average;
    reached.no_filling_time =
        reached.filling_cut_short
            ? fmt::format("the run ended less than {:g} s after full open", shape_average)
            : fmt::format("the projected area never came to {:g} % of its steady mean", 100.0 * filled_share);
    return reached;
}

}  // namespace

bool went_through_itself(const RunView& run) {
    return run.simulation().system().phase == Phase::open &&
           run.observer.rows().back().time >= run.full_open() + shape_average &&
           run.observer.crosses_itself(shape_average);
}

void fill_results(const RunView& run, std::span<const RunView> each, RunRecord& record) {
    const std::optional<double> steady_area = steady_area_of(run);
    OpeningResult result = opening_of(run, record.status, steady_area);
    if (each.size() > 1) add_canopy_peaks(run, each, result);
    const Filling& choice = run.parachute().filling;
    const double lasts = run.simulation().inflation().filling_time;
    const Metric filling{
        "", 0.0, MetricKind::result,
        choice.is_predicted()
            ? fmt::format(
                  "projected area first at {:g} % of its steady mean; predicted from an initial mouth "
                  "of {:g}",
                  100.0 * filled_share, choice.initial_mouth)
            : fmt::format(
                  "projected area first at {:g} % of its steady mean; prescribed drag area takes {:.4g} s",
                  100.0 * filled_share, lasts)};
    const Metric descent{"", 0.0, MetricKind::mixed,
                         "(C_D S)_0 and mass are inputs; the balance is the result"};
    if (choice.is_predicted())
        record.add_metric("initial_mouth_ratio", choice.initial_mouth, MetricKind::input,
                          "area of the mouth at snatch over the steady projected area");
    add_opening_metrics(record, run.scene, result, filling, descent);
    if (result.peak_force)
        record.add_metric("peak_force_raw_N", run.observer.raw_peak().value, MetricKind::result,
                          "without the 5 ms average");
    add_past_events(run, result, record);
    if (steady_area && *steady_area > 0.0)  // a canopy that fell in has no shape
        add_shape(run, *steady_area, record);
    record.add_metric("max_line_tension_N", run.canopies.largest_loads().line_tension, MetricKind::result,
                      "elastic, of all lines and steps");
    record.add_metric("max_membrane_stress_N_m", run.canopies.largest_loads().fabric_stress,
                      MetricKind::result,
                      "first principal, elastic, of all triangles and steps; larger on finer meshes");
    Parachute of_sheet = run.parachute();
    of_sheet.fabric = meshed_fabric(of_sheet);
    // Which fabric the largest stress was in is not known.
    if (!run.simulation().mesh().other_fabrics.empty()) of_sheet.fabric.strength.reset();
    add_strength_margins(record, of_sheet);
    record.energy = run.canopies.ledger();
    record.channels = run.observer.channels();
    if (each.size() > 1) add_canopies(run, each, record);
    add_drag_area_times(record, run.scene, result,
                        choice.is_predicted() ? MetricKind::result : MetricKind::input);
    add_reefed_drag_areas(record, run.scene, result);
    add_stage_descent_rates(record, run.scene, result);
    add_validity(record, run.scene, result);
    add_warnings(run, steady_area, record);
    const Reached reached = reached_by(run, result.filling_time.has_value());
    note_never_opened(record, run.scene, unopened(each), reached);
    note_missing_metrics(record, run.scene, reached);
    record.left_out = left_out_of(parts_of(run.scene));
    if (each.size() > 1)
        record.left_out.push_back({"the air of one canopy around the others",
                                   "each meets the air as if it were alone: parachute.cluster_drag_ratio is "
                                   "all that a cluster takes off"});
    if (const MassScaling& scaling = run.simulation().mass_scaling(); scaling.nodes > 0)
        record.left_out.push_back(
            {fmt::format("true mass of {} canopy nodes", scaling.nodes),
             fmt::format("full.mass_scaling adds {:.3g} kg, {:.2g} % of the canopy with its air, for steps "
                         "that may be {:.1f} % longer before the air moves along",
                         scaling.mass, 100.0 * scaling.share, 100.0 * (scaling.longer - 1.0))});
}

}  // namespace twinchute::fullsim
