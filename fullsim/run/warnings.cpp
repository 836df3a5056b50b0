// Warnings of the full model about a run that has ended.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/run/results.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/validity.hpp"

namespace twinchute::fullsim {
namespace {

/// Share of the steady projected area that has to come soon before filled_share, or the filling time is
/// sensitive to how the last of the area settles.
constexpr double nearly_filled = 0.95;
constexpr double far_diameter = 0.15;     // of D_p/D0, between what the scene says and the mesh settles at
constexpr double sound_area = 0.9;        // signed over positive area below which gores lie inside out
constexpr double early_peak = 0.25;       // drag area over the steady one below which a peak is the snatch's
constexpr double sound_drag_area = 0.98;  // over (C_D S)_0, of an open canopy whose filling is predicted
constexpr double largest_over_inflation = 1.3;  // radius over the steady one
constexpr double sound_penetration = 0.1;       // of an edge, of a node behind fabric that it touches
constexpr double ringing = 1.02;  // raw over filtered peak force; a sound opening has 1.00 to 1.01

/// [m^2] at a time [s] of the opening: as prescribed, or as it was.
double drag_area_at(const RunView& run, double time) {
    const Inflation& inflation = run.simulation().inflation();
    if (!run.parachute().filling.is_predicted())
        return inflation.steady_drag_area * inflation.drag_area_ratio(inflation.phase_at(time), time).value;
    const auto& rows = run.observer.rows();
    const auto row = std::ranges::lower_bound(rows, time, {}, &HistoryRow::time);
    return row == rows.end() ? rows.back().drag_area : row->drag_area;
}

}  // namespace

Inflation without_lag(const RunView& run) {
    Inflation inflation = run.simulation().inflation();
    if (const auto& lag = run.canopies.scene(run.last_to_open()).parachutes.front().lag; !lag.empty()) {
        inflation.initial_time -= lag.front();
        inflation.filling_time -= lag.front();
    }
    return inflation;
}

namespace {

/// [-] of the drag at the peak: more is the bounce of the snatch. Shipped scenes that ring have 2.3 and more,
/// others 1.9 at most.
constexpr double ringing_pull = 2.0;

/// A payload that climbs or comes to rest in the air falls past its canopy: lines go slack, the canopy turns
/// inside out, and what pulls then is a second snatch. Looked for once the canopy is half open.
void warn_of_overtaking(const RunView& run, RunRecord& record) {
    constexpr double slack = 0.02,
                     longest = 0.25;     // [-] of the weight; of the time that one D0 takes at last
    constexpr double inside_out = -0.2;  // [-] signed over projected area
    const Parachute& chute = run.parachute();
    const double weight = run.scene.payload.mass * run.scene.environment.gravity,
                 area = chute.count * chute.cluster_drag_ratio * chute.drag_area;
    if (run.scene.parachutes.size() > 1) return;
    double slack_from = -1.0, slack_for = 0.0, least = 1.0;
    bool half_open = false;
    for (const HistoryRow& row : run.observer.rows()) {
        half_open = half_open || row.drag_area >= 0.5 * area;
        if (!half_open) continue;
        if (row.projected_area > 0.0) least = std::min(least, row.signed_area / row.projected_area);
        if (row.force > slack * weight) {
            slack_from = -1.0;
            continue;
        }
        if (slack_from < 0.0) slack_from = row.time;
        const double steady = std::sqrt(2.0 * weight / (row.density * area));
        if (row.time - slack_from > longest * chute.nominal_diameter / steady)
            slack_for = std::max(slack_for, row.time - slack_from);
    }
    const auto warn = [&](std::string what) {
        record.warnings.push_back(
            {std::move(what),
             "the payload overtook its canopy: forces after that are of another snatch, "
             "the peak force perhaps",
             "look at the history, and deploy where the payload does not come to rest"});
    };
    if (slack_for > 0.0)
        warn(fmt::format("the lines were slack for {:.2g} s under an open canopy", slack_for));
    if (least < inside_out)
        warn(fmt::format("the canopy turned inside out: signed over projected area was {:.2f}", least));
}

}  // namespace

void add_warnings(const RunView& run, std::optional<double> steady_area, RunRecord& record) {
    const Parachute& chute = run.parachute();
    const auto warn = [&](std::string what, std::string why, std::string suggestion) {
        record.warnings.push_back({std::move(what), std::move(why), std::move(suggestion)});
    };
    const bool opened = run.snatched(), flight_too = !run.canopies.is_staged();
    if (opened && flight_too && !run.inflated() && !run.sequence)
        add_opening_warnings(record, run.scene, run.parachute(), without_lag(run), run.snatch_altitude(),
                             run.snatch_speed(), run.snatch_density());
    if (flight_too) add_scene_warnings(record, run.scene);
    if (!opened && flight_too)
        warn("no snatch", "the lines never came taut: nothing drew the parachute out far enough",
             "give it line drag, a static line, an extraction force, or more height");
    if (run.packed() && opened && !run.sequence && record.metric("peak_force_N")) {
        const Inflation& inflation = run.simulation().inflation();
        const double time = run.largest_peak().time;
        if (const double ratio = drag_area_at(run, time) / inflation.steady_drag_area; ratio < early_peak)
            warn(
                fmt::format("the peak force comes {:.3g} s after snatch, at {:.0f} % of the steady drag area",
                            time - inflation.snatch, 100.0 * ratio),
                "the snatch still rings: payload and canopy bounce on the lines, and little but the fabric "
                "damps it",
                "take it for a snatch force, or give full.alpha a value");
    }
    if (run.packed() && opened && run.sequence && record.metric("peak_force_N")) {
        const Observer::Peak& peak = run.largest_peak();
        const auto& rows = run.observer.rows();
        const auto row = std::ranges::lower_bound(rows, peak.time, {}, &HistoryRow::time);
        if (row != rows.end() && peak.value > ringing_pull * row->dynamic_pressure * row->drag_area)
            warn(fmt::format("the peak force, at {:.3g} s, is {:.1f} times the drag of that moment",
                             peak.time, peak.value / (row->dynamic_pressure * row->drag_area)),
                 "the snatch still rings: payload and canopy bounce on the lines, and little but the fabric "
                 "damps it",
                 "take it for a snatch force, or give full.alpha a value");
    }
    if (!run.has_settled())
        warn("the open canopy had not settled into its shape when it was released",
             "dynamic relaxation did not come to rest: fabric and lines ring as they take their load",
             "take no load from the start of this run");
    if (const double filtered = run.largest_peak().value, raw = run.observer.raw_peak().value;
        filtered > 0.0 && raw > ringing * filtered && run.simulation().steps().most_subcycles() > 1)
        warn(fmt::format(
                 "the raw peak force is {:.1f} % above the filtered one, lines took up to {} subcycles",
                 100.0 * (raw / filtered - 1.0), run.simulation().steps().most_subcycles()),
             "where a step of the canopy is half a period of the lines they may ring "
             "(docs/theory/full-model.md)",
             "compare with full.line_substeps = 1; the filtered peak is the one that counts");
    // Mass damping damps breathing as well, with all other motion.
    const bool damped =
        run.scene.aerodynamics.breathing_damping.value_or(0.0) > 0.0 || run.scene.full.alpha > 0.0;
    if (opened && !run.inflated() && !damped)
        warn("nothing damps the canopy's breathing",
             "fabric rings on as it fills, and the riser with it: forces are up to half above those of the "
             "drag (docs/theory/full-model.md)",
             "give aerodynamics.breathing_damping, e.g. { k = 0.5 }");
    if (opened && flight_too) warn_of_overtaking(run, record);
    if (run.findings.switched_late)
        warn(chute.reefing.empty() ? "finite elements took over at full open only"
                                   : "finite elements took over once a stage was full only",
             fmt::format("the mouth never reached {:g} of the steady projected area",
                         run.scene.full.switch_area_ratio),
             "look at the shape; a smaller full.switch_area_ratio hands over earlier");
    const double meshed = run.simulation().mesh().parachute_mass();
    if (std::abs(meshed - run.stated_mass) > 0.02 * run.stated_mass)
        warn(fmt::format("the mesh weighs {:.3f} kg, parachute.mass says {:.3f} kg", meshed, run.stated_mass),
             "the full model takes its mass from fabric, tapes and lines",
             "correct parachute.mass, or the materials");
    for (const auto& [key, of_what] : {std::pair{"line_strength_margin", "suspension lines"},
                                       {"cord_strength_margin", ""},  // its note says which
                                       {"membrane_strength_margin_p90", "a tenth of the fabric"}})
        if (const Metric* margin = record.find_metric(key); margin && margin->value < 0.0)
            warn(fmt::format("{} would have broken: {} is {:.2f}",
                             *of_what ? of_what : margin->note.substr(0, margin->note.find(':')), key,
                             margin->value),
                 "the model goes on, elastic as before: what follows could not have happened",
                 "take what is stronger, or load it less");
    if (!run.simulation().mesh().other_fabrics.empty())
        warn("the largest stress of the fabric has no margin of strength",
             "panels have fabrics of their own, and which of them it was in is not known",
             record.metric("membrane_strength_margin_p90")
                 ? "take membrane_strength_margin_p90, which holds each against its own strength"
                 : "give each fabric its strength: membrane_strength_margin_p90 holds each against its own");
    if (auto warning = stand_in(chute)) record.warnings.push_back(std::move(*warning));
    if (auto warning = smeared_slots(chute)) record.warnings.push_back(std::move(*warning));
    if (!run.simulation().mesh().gaps.empty()) record.warnings.push_back(open_gaps(chute));
    if (auto warning = open_corners(chute)) record.warnings.push_back(std::move(*warning));
    if (auto warning = open_middle(chute)) record.warnings.push_back(std::move(*warning));
    if (std::ranges::count(run.simulation().mesh().cables, CableKind::vent_line, &Cable::kind) > 0 &&
        run.scene.aerodynamics.line_drag)
        warn("vent lines have no drag", "aerodynamics.line_drag acts on suspension lines alone",
             "their drag is part of parachute.drag_area where tests gave it");
    if (chute.mesh)
        std::ranges::copy(size_warnings(import_mesh(run.scene), run.scene),
                          std::back_inserter(record.warnings));
    if (const auto ratio = record.metric("projected_diameter_ratio");
        ratio && !has_open_middle(chute) &&
        std::abs(*ratio - chute.projected_diameter_ratio) > far_diameter * chute.projected_diameter_ratio)
        warn(
            fmt::format("the canopy settles at {:.3g} of D0, parachute.projected_diameter_ratio says {:.3g}",
                        *ratio, chute.projected_diameter_ratio),
            "reefing lines, the mouth at line stretch and the added mass of the reduced-order model go by it",
            "correct it, or look at the shape");
    if (const auto sound = record.metric("signed_area_ratio"); sound && *sound < sound_area)
        warn(fmt::format("signed over positive canopy area is {:.2f}", *sound),
             run.scene.full.contact == Contact::none
                 ? "gores are folded inside out; fabric passes through fabric here"
                 : "gores are folded inside out; contact keeps neighbours in order, not a canopy from "
                   "turning over",
             run.scene.full.contact == Contact::none && !chute.mesh && !(cross_arm_ratio(chute) > 0.0)
                 ? "look at the shape before trusting the loads; full.contact = \"gores\" keeps neighbours "
                   "in order"
                 : "look at the shape before trusting the loads");
    const auto penetration = [](const SystemState& s) {
        return static_cast<double>(s.contact.passed) + s.contact.deepest;
    };
    if (const SelfContactState& contact = run.worst(penetration).system().contact;
        contact.passed > 0 || contact.deepest > sound_penetration)
        warn(fmt::format("nodes went through fabric that they had touched: {} were let go, the deepest was "
                         "{:.2f} of an edge behind it",
                         contact.passed, contact.deepest),
             "self-contact is a penalty, and fabric folded to slivers has no side to be kept on",
             "take loads for those of a canopy whose fabric still passes through itself here and there");
    if (const auto filled = record.metric("filling_time_s")) {
        const double snatch = run.findings.snatch;
        const auto nearly = run.observer.first_time_of_area(nearly_filled * *steady_area);
        if (nearly && *nearly - snatch < 0.9 * *filled)
            warn(fmt::format("{:g} % of the steady area is reached at {:.3g} s, {:g} % at {:.3g} s",
                             100.0 * nearly_filled, *nearly - snatch, 100.0 * filled_share, *filled),
                 "the canopy creeps into its shape: the filling time is sensitive to the area threshold",
                 "compare filling times of such a canopy with a wide tolerance");
    }
    if (run.parachute().filling.is_predicted() && steady_area) {
        if (const double growth = std::sqrt(run.observer.largest_area() / *steady_area);
            growth > largest_over_inflation)
            warn(fmt::format("the canopy over-inflates to {:.2f} of its steady radius", growth),
                 fmt::format("no test shows more than {:g}", largest_over_inflation),
                 "treat the force after full open as an upper bound");
        const double told = run.simulation().inflation().steady_drag_area;
        if (const double has = run.observer.mean(&HistoryRow::drag_area, shape_average);
            has < sound_drag_area * told)
            warn(fmt::format("the open canopy drags with {:.4g} of its {:.4g} m^2", has, told),
                 "its fabric and openings let out more than its mouth takes in at this speed",
                 "check permeability and geometric_porosity; such a canopy would not have that drag area");
    }
    if (run.findings.met_payload && !run.fell_in())
        warn(fmt::format("the payload went through its canopy at t = {:.4g} s", *run.findings.met_payload),
             "it came within a tenth of D0 of the middle of the fabric, and nothing keeps one from the other",
             "do not trust what comes after; release it on a flatter path, or deploy it later");
    const Simulation& capped =
        run.worst([](const SystemState& s) { return static_cast<double>(s.capped_steps); });
    if (capped.system().capped_steps > 0)
        warn(fmt::format("the canopy pressure was capped in {:.1f} % of the steps",
                         100.0 * static_cast<double>(capped.system().capped_steps) /
                             static_cast<double>(capped.own_steps())),
             "the projected area was too small for the prescribed drag; the rest acted as residual drag",
             "give the canopy a larger initial_drag_area_ratio if this matters");
    if (opened && flight_too && !run.findings.descent_altitude)
        warn_of_unsteady_descent(record, run.scene, run.findings.last_window);
    if (record.status.code != StatusCode::completed || !opened) return;
    if (steady_area) return;
    const bool was_cut = !run.canopies.is_out(run.first);
    if (was_cut && run.simulation().system().time < run.full_open()) return;  // warn_of_sequence
    warn("no filling time and no steady shape",
         fmt::format("{} less than {:g} s after full open", was_cut ? "it was cut" : "the run ended",
                     shape_average),
         was_cut ? "cut it later, where that matters"
                 : "set stop.time later, or stop.at = \"steady-descent\"");
}

}  // namespace twinchute::fullsim
