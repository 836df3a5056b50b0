// Two synthetic records for tests of comparison and report: curves of plausible shape, no solver.
#pragma once

#include <cmath>
#include <string>

#include "compare/gap.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::compare {

/// A record whose force is a bump with its peak `peak` [N] at `peak_time` [s].
inline RunRecord synthetic_record(const std::string& fidelity, double peak, double peak_time, double wall) {
    RunRecord record;
    record.scene = {"C-9 inflation at 21 m/s", "data/scenes/c9-inflation.toml", std::string(64, 'a')};
    record.fidelity = fidelity;
    record.status = {StatusCode::completed, "steady descent at 6.000 s"};
    record.inputs = {{"payload.mass", 152.4, "kg", InputOrigin::given, ""},
                     {"parachute.fill_time.n", 4.0, "", InputOrigin::given, "an assumption"},
                     {"parachute.drag_area_law", std::string("ludtke"), "", InputOrigin::fallback, ""}};
    record.add_metric("snatch_speed_m_s", 21, MetricKind::input, "the release speed");
    record.add_metric("filling_time_s", peak_time + 0.1);
    record.add_metric("peak_force_N", peak);
    record.add_metric("time_to_peak_force_s", peak_time);
    record.add_metric("descent_rate_m_s", 7.7);
    record.energy = EnergyLedger{-20000, 120, 60000, -90000, 2500, 300, 0.0012};
    record.cost.wall_s = wall;
    record.cost.cpu_s = wall;
    record.cost.steps = 1000;
    record.cost.rhs_calls = 4000;
    record.cost.dt_min_s = 1e-5;
    record.cost.dt_max_s = 2e-4;
    record.events = {
        {"snatch", 0, 300, 21}, {"peak-force", peak_time, 270, 18}, {"full-open", peak_time + 0.1, 268, 16}};
    Channel time{"time", "s", {}}, force{"force", "N", {}}, speed{"speed", "m/s", {}};
    const double bump = peak - 1490 * (1 - std::exp(-peak_time));
    for (int i = 0; i <= 6000; ++i) {
        const double t = i * 1e-3, x = (t - peak_time) / (0.35 * peak_time);
        time.values.push_back(t);
        force.values.push_back(1490 * (1 - std::exp(-t)) + bump * std::exp(-x * x));
        speed.values.push_back(7.7 + 13.3 / (1 + std::exp(6 * (t - peak_time))));
    }
    record.channels = {time, force, speed};
    record.provenance = {"0.1.0",     "0123456789ab", "GNU 12.2.0",           "-O3",
                         "x86-64-v3", "A CPU",        "2026-01-02T03:04:05Z", 1};
    return record;
}

inline Comparison synthetic_comparison(const std::map<std::string, Tolerance>& tolerances = {}) {
    Comparison comparison;
    comparison.reference = synthetic_record("full", 5000, 1.50, 12.0);
    comparison.candidate = synthetic_record("rom", 4800, 1.45, 4e-4);
    comparison.candidate.energy->elastic = 0;
    comparison.reference.cost.element_steps = 130'000'000;
    comparison.reference.cost.ns_per_element_step = 88;
    comparison.reference.left_out = {{"payload drag", "no payload.drag_area in the scene"}};
    comparison.reference.warnings = {{"the mesh weighs 5.4 kg, the design 5.19 kg",
                                      "they differ by more than 2 %", "check parachute.mass"}};
    comparison.reference_title = "explicit finite elements";
    comparison.candidate_title = "reduced-order model";
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, tolerances);
    return comparison;
}

}  // namespace twinchute::compare
