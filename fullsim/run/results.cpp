#include "fullsim/run/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/run/parts.hpp"
#include "lib/record/metrics.hpp"
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

/// [-] of its nominal area, below which a canopy has stayed a bundle: it has no filling time.
constexpr double closed_area = 0.02;
bool has_opened(const RunView& run, double steady_area) {
    const double D0 = run.parachute().nominal_diameter;
    return steady_area > closed_area * 0.25 * pi * D0 * D0;
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
    if (steady_area && !run.inflated() && has_opened(run, *steady_area)) {
        result.filling_time = seen.first_time_of_area(filled_share * *steady_area);
        if (result.filling_time) *result.filling_time -= found.snatch;
    }
    if (run.packed()) result.snatch_force = seen.snatch_peak().value;
    const Observer::Peak peak = run.largest_peak();
    const bool fills = still_fills(run, status);
    if (peak.value > 0.0 && !fills) result.peak_force = peak.value;
    result.max_force = seen.largest_force();
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
void add_canopy_peaks(std::span<const RunView> each, OpeningResult& result) {
    const auto note = [&](const RunView& one, double time) {
        const Parachute& chute = one.canopies.scene_of_all(one.first).parachutes.front();
        const std::string who = chute.count == 1
                                    ? chute.name
                                    : fmt::format("canopy {} of {} {},", one.canopies.number(one.first) + 1,
                                                  chute.count, chute.name);
        return fmt::format("{} at t = {:.4g} s", who, time);
    };
    for (const RunView& one : each) {
        const Observer::Peak peak = one.largest_peak(), &snatch = one.observer.snatch_peak();
        const Observer::Peak& most = snatch.value > peak.value ? snatch : peak;
        if (result.peak_force && peak.value > 0.0 &&
            (!result.peak_canopy_force || peak.value > result.peak_canopy_force->force))
            result.peak_canopy_force = {peak.value, note(one, peak.time)};
        if (!result.max_canopy_force || most.value > result.max_canopy_force->force)
            result.max_canopy_force = {most.value, note(one, most.time)};
    }
}

/// Column of what `own` has seen, at the times of all rows: zero where it was not out.
std::vector<double> column_of(const std::vector<HistoryRow>& all, const Observer& own,
                              double HistoryRow::*column) {
    std::vector<double> values(all.size(), 0.0);
    const std::vector<HistoryRow>& rows = own.rows();
    for (std::size_t i = 0, k = 0; i < all.size() && k < rows.size(); ++i) {
        while (k < rows.size() && rows[k].time < all[i].time)
            ++k;
        if (k < rows.size() && rows[k].time == all[i].time) values[i] = rows[k].*column;
    }
    return values;
}

/// Adds force, drag area and projected area as `own` has seen them.
void add_channels(const std::string& head, const std::vector<HistoryRow>& all, const Observer& own,
                  RunRecord& record) {
    const auto add = [&](const char* name, const char* unit, double HistoryRow::*column) {
        record.channels.push_back({head + name, unit, column_of(all, own, column)});
    };
    add("force", "N", &HistoryRow::force);
    add("drag_area", "m^2", &HistoryRow::drag_area);
    add("projected_area", "m^2", &HistoryRow::projected_area);
}

/// Adds the largest force of any canopy in each row.
void add_largest_force(const std::vector<HistoryRow>& all, std::span<const RunView> each, RunRecord& record) {
    std::vector<double> largest(all.size(), 0.0);
    for (const RunView& one : each) {
        const std::vector<double> force = column_of(all, one.observer, &HistoryRow::force);
        for (std::size_t i = 0; i < all.size(); ++i)
            largest[i] = std::max(largest[i], force[i]);
    }
    record.channels.push_back({"canopy_force", "N", std::move(largest)});
}

/// Channels and metrics of each canopy of `run`: canopy_2_force, canopy_2_peak_force_N.
void add_canopies(const RunView& run, const std::vector<HistoryRow>& all, std::span<const RunView> each,
                  const std::string& head_of_all, RunRecord& record) {
    for (const RunView& one : each) {
        const std::string head = fmt::format("{}canopy_{}_", head_of_all, run.canopies.number(one.first) + 1);
        add_channels(head, all, one.observer, record);
        if (const Observer::Peak peak = one.largest_peak();
            peak.value > 0.0 && !still_fills(one, record.status))
            record.add_metric(head + "peak_force_N", peak.value, MetricKind::result,
                              fmt::format("of its riser, at t = {:.4g} s", peak.time));
        const auto steady = steady_area_of(one);
        if (!steady || one.inflated()) continue;
        if (const auto filled = one.observer.first_time_of_area(filled_share * *steady))
            record.add_metric(
                head + "filling_time_s", *filled - one.findings.snatch, MetricKind::result,
                fmt::format("projected area first at {:g} % of its steady mean", 100.0 * filled_share));
    }
    double force = 0.0, deepest = 0.0;
    for (const CanopyPlane& plane : run.canopies.planes()) {
        if (plane.first() - run.first >= run.count) continue;  // of another parachute
        force = std::max(force, plane.largest_force());
        deepest = std::max(deepest, plane.deepest());
    }
    record.add_metric(head_of_all + "max_canopy_contact_force_N", force, MetricKind::result,
                      force > 0.0 ? "between two canopies, along a plane" : "canopies never touched");
    if (force > 0.0)
        record.add_metric(head_of_all + "max_canopy_contact_depth_m", deepest, MetricKind::result,
                          "of fabric behind the plane along which two canopies touch");
}

/// Events that only a look back at the history shows.
void add_past_events(const Observer& observer, double snatch, const OpeningResult& result,
                     RunRecord& record) {
    const auto& rows = observer.rows();
    const auto add = [&](const char* name, double time) {
        auto after = std::ranges::lower_bound(rows, time, {}, &HistoryRow::time);
        if (after == rows.end()) --after;
        const auto before = after == rows.begin() ? after : after - 1;
        const double lasts = after->time - before->time,
                     share = lasts > 0.0 ? std::min(1.0, (time - before->time) / lasts) : 1.0;
        record.events.push_back({name, time, std::lerp(before->position.z(), after->position.z(), share),
                                 std::lerp(before->velocity.norm(), after->velocity.norm(), share)});
    };
    if (result.peak_force) add("peak-force", result.peak_time);
    if (result.filling_time) add("canopy-filled", snatch + *result.filling_time);
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

/// How much of a filling time is input.
Metric filling_metric(const RunView& run) {
    const Filling& choice = run.parachute().filling;
    const double lasts = run.simulation().inflation().filling_time;
    return {
        "", 0.0, MetricKind::result,
        choice.is_predicted()
            ? fmt::format(
                  "projected area first at {:g} % of its steady mean; predicted from an initial mouth "
                  "of {:g}",
                  100.0 * filled_share, choice.initial_mouth)
            : fmt::format(
                  "projected area first at {:g} % of its steady mean; prescribed drag area takes {:.4g} s",
                  100.0 * filled_share, lasts)};
}
Metric descent_metric() {
    return {"", 0.0, MetricKind::mixed, "(C_D S)_0 and mass are inputs; the balance is the result"};
}

/// Head of a parachute's own keys in a scene with stages of several.
std::string head_of(const RunView& run) {
    return run.canopies.is_staged() && run.canopies.is_of_several() ? metric_head(run.parachute().name) : "";
}

void add_initial_mouth(const RunView& run, RunRecord& record) {
    if (run.parachute().filling.is_predicted())
        record.add_metric(head_of(run) + "initial_mouth_ratio", run.parachute().filling.initial_mouth,
                          MetricKind::input, "area of the mouth at snatch over the steady projected area");
}

std::string factors_text(const StrengthFactors& factors) {
    return fmt::format("joint efficiency {:g}, design factor {:g}", factors.joint_efficiency,
                       factors.design_factor);
}

/// Largest tensions of tapes, bands, vent lines and the reefing line, and the least of their margins.
void add_cord_loads(const RunView& run, RunRecord& record) {
    const StrengthFactors& factors = run.parachute().strength;
    const CordTensions& most = run.observer.rows().back().tension;
    std::optional<double> least;
    std::string of_least;
    for (std::size_t k = 0; k < most.size(); ++k) {
        const CordGroup& group = cord_groups[k];
        if (!(most[k] > 0.0)) continue;
        record.add_metric(group.metric, most[k], MetricKind::result,
                          fmt::format("elastic, of each cord; the largest of {:g} looks a second",
                                      run.scene.full.row_rate()));
        const Cord& cord = run.simulation().mesh().cord(group.kind);
        if (!cord.strength) continue;
        const double margin = strength_margin(*cord.strength, factors, most[k]);
        if (least && margin >= *least) continue;
        least = margin;
        of_least = fmt::format("{}: {:.5g} N of {:.5g} N, {}", group.name, most[k], *cord.strength,
                               factors_text(factors));
    }
    if (least) record.add_metric("cord_strength_margin", *least, MetricKind::result, of_least);
}

/// Margins of lines, fabric and other cords where a largest load and a strength are known; absent otherwise.
void add_strength_margins(const RunView& run, RunRecord& record) {
    const Mesh& mesh = run.simulation().mesh();
    const StrengthFactors& factors = run.parachute().strength;
    const auto add = [&](const char* key, double margin, const std::string& of_what) {
        record.add_metric(key, margin, MetricKind::result,
                          fmt::format("{}, {}", of_what, factors_text(factors)));
    };
    const auto add_over = [&](const char* key, const char* load_key, const std::optional<double>& strength) {
        const std::optional<double> load = record.metric(load_key);
        if (strength && load && *load > 0.0)
            add(key, strength_margin(*strength, factors, *load),
                fmt::format("strength {:.5g} {}", *strength, split_metric_key(load_key).unit));
    };
    add_over("line_strength_margin", "max_line_tension_N", run.parachute().line.strength);
    if (mesh.other_fabrics.empty()) {  // otherwise which fabric the largest stress was in is not known
        add_over("membrane_strength_margin", "max_membrane_stress_N_m", mesh.fabric.strength);
        add_over("membrane_strength_margin_p90", "membrane_stress_p90_N_m", mesh.fabric.strength);
    }
    const HistoryRow& last = run.observer.rows().back();
    if (last.utilisation_p90 > 0.0)
        add("membrane_strength_margin_p90", strength_margin(1.0, factors, last.utilisation_p90),
            "each panel's stress over its fabric's strength");
    add_cord_loads(run, record);
}

/// Shape, largest loads and margins.
void add_structure(const RunView& run, std::optional<double> steady_area, RunRecord& record) {
    const LargestLoads most = run.canopies.largest_loads(run.first, run.count);
    if (steady_area && *steady_area > 0.0)  // a canopy that fell in has no shape
        add_shape(run, *steady_area, record);
    record.add_metric("max_line_tension_N", most.line_tension, MetricKind::result,
                      "elastic, of all lines and steps");
    if (most.fabric_stress > 0.0) {
        record.add_metric("max_membrane_stress_N_m", most.fabric_stress, MetricKind::result,
                          "first principal, elastic, of all triangles and steps; larger on finer meshes");
        record.add_metric(
            "membrane_stress_p90_N_m", run.observer.rows().back().stress_p90, MetricKind::result,
            fmt::format("10 % of the fabric's area is stressed higher; the largest of {:g} looks a "
                        "second, settles on finer meshes",
                        run.scene.full.row_rate()));
    } else {
        for (const char* key : {"max_membrane_stress_N_m", "membrane_stress_p90_N_m"})
            record.missing.push_back(
                {key, "no fabric was taut as finite elements", record.status.code == StatusCode::completed});
    }
    add_strength_margins(run, record);
}

void leave_out_air_between(const Scene& scene, RunRecord& record) {
    if (std::ranges::any_of(scene.parachutes, [](const Parachute& chute) { return chute.count > 1; }))
        record.left_out.push_back({"the air of one canopy around the others",
                                   "each meets the air as if it were alone: parachute.cluster_drag_ratio is "
                                   "all that a cluster takes off"});
}

void leave_out_masses(const RunView& run, RunRecord& record) {
    const MassScaling& scaling = run.simulation().mass_scaling();
    if (scaling.nodes == 0) return;
    record.left_out.push_back(
        {fmt::format("true mass of {} canopy nodes", scaling.nodes),
         fmt::format("full.mass_scaling adds {:.3g} kg, {:.2g} % of the canopy with its air, for steps "
                     "that may be {:.1f} % longer before the air moves along",
                     scaling.mass, 100.0 * scaling.share, 100.0 * (scaling.longer - 1.0))});
}

NeverOpened turned_through(const RunView& run) {
    return {0, 1,
            fmt::format("its skirt turns {:g} times on its way around: fabric has passed through fabric",
                        run.observer.rows().back().turns),
            "do not trust its loads; two or more elements across a gore come apart again, and another "
            "full.noise.seed may spare it",
            true};
}

NeverOpened fallen_into() {
    return {0, 1, "the payload fell into it, which contact between gores cannot model",
            "release it on a flatter path, or deploy it later", true};
}

std::vector<NeverOpened> unopened_of_one(const RunView& run) {
    if (run.fell_in()) return {fallen_into()};
    if (run.sequence) return never_opened(*run.sequence);
    if (run.parachute().filling.is_predicted() && run.snatched() && run.findings.landing_time &&
        !std::isfinite(run.full_open()))
        return {{0, 1, "it was still filling on the ground (parachute.filling.initial_mouth)"}};
    if (went_through_itself(run)) return {turned_through(run)};
    if (run.snatched()) return {};
    return {{0, 1, "it had begun to leave its pack and never came to snatch"}};
}

/// Canopies of a parachute that failed for one reason are told together.
void add_unopened(std::vector<NeverOpened>& all, NeverOpened one) {
    const auto same = std::ranges::find_if(all, [&](const NeverOpened& other) {
        return other.parachute == one.parachute && other.why == one.why;
    });
    if (same == all.end())
        all.push_back(std::move(one));
    else
        same->count += one.count;
}

std::vector<NeverOpened> unopened(std::span<const RunView> each) {
    std::vector<NeverOpened> all;
    for (const RunView& run : each)
        for (NeverOpened& one : unopened_of_one(run))
            add_unopened(all, std::move(one));
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
    const auto steady = steady_area_of(run);
    const bool closed = steady && !has_opened(run, *steady);
    reached.no_filling_time =
        reached.filling_cut_short
            ? fmt::format("the run ended less than {:g} s after full open", shape_average)
        : closed
            ? "the canopy stayed closed"
            : fmt::format("the projected area never came to {:g} % of its steady mean", 100.0 * filled_share);
    return reached;
}

/// Time [s] at which the projected area of a canopy is that of the steady one, but for filled_share.
std::optional<double> filled_at(const RunView& run) {
    const std::optional<double> steady = steady_area_of(run);
    if (!steady || !has_opened(run, *steady)) return {};
    return run.observer.first_time_of_area(filled_share * *steady);
}

/// Whether two canopies were out at once.
bool overlap(std::span<const RunView> each) {
    for (std::size_t k = 1; k < each.size(); ++k)
        for (std::size_t i = 0; i < k; ++i)
            if (each[i].observer.rows().back().time > each[k].observer.rows().front().time) return true;
    return false;
}

/// Peaks of the openings of several parachutes.
void note_peaks(const StagesView& run, std::span<const RunView> parachutes, OpeningResult& result) {
    note_largest_peak(result, [&](std::size_t index) { return run.sequence.is_growing(index); });
    // Filled is what the canopy is, not its drag area, which is told.
    for (ParachuteResult& opening : result.parachutes)
        for (const RunView& one : parachutes)
            if (one.parachute().name == run.scene.parachutes[opening.index].name && !one.inflated() &&
                one.parachute().reefing.empty())
                opening.stages.back().full = filled_at(one);
}

OpeningResult flight_of(const StagesView& run, std::span<const RunView> parachutes,
                        std::span<const RunView> each, const RunStatus& status) {
    const bool several = run.scene.parachutes.size() > 1;
    const HistoryRow& last = run.observer.rows().back();
    OpeningResult result;
    result.snatched = false;
    if (!several && !parachutes.empty()) {
        result = opening_of(parachutes.front(), status, steady_area_of(parachutes.front()));
    } else {
        result.parachutes = run.openings;
        for (const RunView& one : parachutes) {
            if (one.inflated() || !one.snatched()) continue;
            result.snatched = true;
            result.line_stretch_time = one.findings.line_stretch_time;
            result.snatch_time = one.findings.snatch;
            result.snatch_speed = one.snatch_speed();
            result.snatch_path_angle = one.packed() ? one.findings.snatch_path_angle
                                                    : angle_below_horizon(release_airspeed(one.scene));
            result.payload_snatch_speed =
                one.packed() ? one.findings.payload_snatch_speed : result.snatch_speed;
            result.snatch_density = one.snatch_density();
            break;
        }
        if (!parachutes.empty()) note_peaks(run, parachutes, result);
    }
    if (overlap(each)) add_canopy_peaks(each, result);
    result.max_force = run.observer.largest_force();
    for (const ParachuteResult& opening : run.openings)
        result.max_force = std::max(result.max_force, opening.snatch_force.value_or(0.0));
    result.max_deceleration = run.observer.largest_acceleration();
    result.descent = run.findings.descent;
    result.descent_altitude = run.findings.descent_altitude;
    result.landing_time = run.findings.landing_time;
    result.end_position = last.position;
    result.end_speed = last.velocity.norm();
    result.end_climb = last.velocity.z();
    return result;
}

/// Adds shape, largest loads, margins and warnings of one parachute, with the parachute's name where it is
/// one of several.
void add_parachute(const RunView& run, bool several, RunRecord& record) {
    const std::optional<double> steady_area = steady_area_of(run);
    RunRecord own;
    own.status = record.status;
    if (const Observer::Peak peak = run.largest_peak(); peak.value > 0.0 && !still_fills(run, record.status))
        own.add_metric("peak_force_N", peak.value);
    if (const auto filled = filled_at(run)) own.add_metric("filling_time_s", *filled - run.findings.snatch);
    add_structure(run, steady_area, own);
    add_warnings(run, steady_area, own);
    for (const Metric& metric : own.metrics)
        if (metric.key != "peak_force_N" && metric.key != "filling_time_s")
            record.add_metric(head_of(run) + metric.key, metric.value, metric.kind, metric.note);
    for (MissingMetric& missing : own.missing) {
        missing.metric = head_of(run) + missing.metric;
        record.missing.push_back(std::move(missing));
    }
    for (Warning& warning : own.warnings) {
        if (several) warning.what = run.parachute().name + ": " + warning.what;
        record.warnings.push_back(std::move(warning));
    }
}

/// The largest force of a snatch is no average: a pull of the lines lasts for milliseconds.
void note_snatch_is_largest(const Observer& seen, const OpeningResult& result, RunRecord& record) {
    const auto metric = std::ranges::find(record.metrics, "max_force_N", &Metric::key);
    if (metric != record.metrics.end() && result.max_force > seen.largest_peak().value &&
        result.max_force > 0.0 && metric->note.empty())
        metric->note = "of a snatch, without the 5 ms average of other forces";
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
    if (each.size() > 1) add_canopy_peaks(each, result);
    const Filling& choice = run.parachute().filling;
    const Metric filling = filling_metric(run);
    add_initial_mouth(run, record);
    add_opening_metrics(record, run.scene, result, filling, descent_metric());
    if (result.peak_force)
        record.add_metric("peak_force_raw_N", run.observer.raw_peak().value, MetricKind::result,
                          "without the 5 ms average");
    note_snatch_is_largest(run.observer, result, record);
    add_past_events(run.observer, run.findings.snatch, result, record);
    add_structure(run, steady_area, record);
    record.energy = run.canopies.ledger();
    record.channels = run.observer.channels();
    if (each.size() > 1) {
        add_largest_force(run.observer.rows(), each, record);
        add_canopies(run, run.observer.rows(), each, "", record);
    }
    add_drag_area_times(record, run.scene, result,
                        choice.is_predicted() ? MetricKind::result : MetricKind::input);
    add_reefed_drag_areas(record, run.scene, result);
    add_stage_descent_rates(record, run.scene, result);
    add_validity(record, run.scene, result);
    warn_of_first_force(record, run.scene, result);
    add_warnings(run, steady_area, record);
    const Reached reached = reached_by(run, result.filling_time.has_value());
    note_never_opened(record, run.scene, unopened(each), reached);
    note_missing_metrics(record, run.scene, reached);
    record.left_out = left_out_of(parts_of(run.scene));
    leave_out_air_between(run.scene, record);
    leave_out_masses(run, record);
}

void fill_results_of_stages(const StagesView& run, std::span<const RunView> parachutes,
                            std::span<const RunView> each, RunRecord& record) {
    const Scene& scene = run.scene;
    const bool several = scene.parachutes.size() > 1;
    OpeningResult result = flight_of(run, parachutes, each, record.status);
    const Metric filling = several || parachutes.empty() ? Metric{} : filling_metric(parachutes.front());
    for (const RunView& one : parachutes)
        add_initial_mouth(one, record);
    add_opening_metrics(record, scene, result, filling, descent_metric());
    if (result.peak_force)
        record.add_metric("peak_force_raw_N", run.observer.raw_peak().value, MetricKind::result,
                          "without the 5 ms average");
    note_snatch_is_largest(run.observer, result, record);
    add_past_events(run.observer, result.snatch_time, result, record);
    record.energy = run.canopies.ledger();
    record.channels = run.observer.channels();
    for (const RunView& one : parachutes) {
        if (several) add_channels(head_of(one), run.observer.rows(), one.observer, record);
        if (one.count > 1)
            add_canopies(one, run.observer.rows(), each.subspan(one.first, one.count), head_of(one), record);
    }
    if (overlap(each)) add_largest_force(run.observer.rows(), each, record);
    for (const RunView& one : parachutes)
        add_parachute(one, several, record);
    add_drag_area_times(record, scene, result, filling.kind);
    add_reefed_drag_areas(record, scene, result);
    result.parachutes = run.openings;  // a stage is full once its drag area is
    add_stage_descent_rates(record, scene, result);
    add_validity(record, scene, result);
    add_scene_warnings(record, scene);
    for (const RunView& one : parachutes)
        if (one.snatched() && !one.inflated() && one.parachute().reefing.empty())
            add_opening_warnings(record, scene, scene.parachutes[run.canopies.parachute(one.first)],
                                 without_lag(one), one.snatch_altitude(), one.snatch_speed(),
                                 one.snatch_density());
    std::vector<NeverOpened> unopened = never_opened(run.sequence);
    for (const std::size_t k : run.canopies.out())
        if (each[k].fell_in() || went_through_itself(each[k])) {
            NeverOpened one = each[k].fell_in() ? fallen_into() : turned_through(each[k]);
            one.parachute = run.canopies.parachute(k);
            add_unopened(unopened, std::move(one));
        }
    if (!each.empty() && !run.findings.descent_altitude)
        warn_of_unsteady_descent(record, scene, run.findings.last_window);
    Reached reached;
    reached.ground = run.findings.landing_time.has_value();
    reached.full_open = run.sequence.is_open() && !run.sequence.any_waits_to_leave();
    reached.filling = !run.sequence.is_open();
    if (!several && !parachutes.empty())
        reached = reached_by(parachutes.front(), result.filling_time.has_value());
    reached.ground = run.findings.landing_time.has_value();
    note_never_opened(record, scene, unopened, reached);
    warn_of_sequence(record, scene, run.sequence);
    note_missing_metrics(record, scene, reached);
    record.left_out = left_out_of(parts_of(scene));
    if (several) {
        record.left_out.push_back({"the air of one parachute around the others",
                                   "each meets the air as if it were alone, one in the wake of another too"});
        record.left_out.push_back({"contact of one parachute with another",
                                   "they pass through each other where one is drawn out past another"});
    }
    if (scene.payload.body)
        record.left_out.push_back({"the inertia of packs on the payload",
                                   "until they come out they weigh on its centre of mass and do not turn"});
    leave_out_air_between(scene, record);
    for (const RunView& one : parachutes)
        leave_out_masses(one, record);
}

}  // namespace twinchute::fullsim
