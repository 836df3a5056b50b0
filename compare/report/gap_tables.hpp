// The tables of a comparison, built once for every format that shows them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/gap.hpp"
#include "compare/render/table.hpp"

namespace twinchute::compare {

/// The verdict with its severity, or "-".
Cell verdict_cell(Verdict verdict);

/// A row a metric: both values, their difference, tolerance and verdict.
Table metrics_table(const Comparison& comparison);
/// Notes of metrics and of their values, each once.
Table metric_notes_table(const Comparison& comparison);

/// A row a history: the L2 norm of the difference, by phase.
Table histories_table(const FidelityGap& gap);
/// A row a phase of a history, in every norm.
Table phases_table(const FidelityGap& gap);
/// A row a history that a test measured. The comparison has a test.
Table test_table(const Comparison& comparison);

/// Terms of the energy ledgers that are not zero on both sides; empty where neither side keeps one.
Table energy_table(const Comparison& comparison);
/// A row an event, in the order of EventPair.
Table events_table(const Comparison& comparison);
/// Physics that each side left out, and why.
/// Where the candidate is calibrated: the gap of metrics with a tolerance, before and after.
Table calibration_table(const Comparison& comparison);

/// Where filling is predicted: how far it hangs on the initial mouth.
Table filling_table(const Comparison& comparison);
Table left_out_table(const Comparison& comparison);
Table warnings_table(const Comparison& comparison);
Table inputs_table(const RunRecord& record);

/// The clock that both sides share: seconds since their snatch, or line stretch; else since release.
struct SharedClock {
    std::array<double, 2> zero{};  ///< [s] since release, candidate and reference
    bool from_snatch = false;
    std::string label() const { return from_snatch ? "time since snatch [s]" : "time since release [s]"; }
};
SharedClock shared_clock(const Comparison& comparison);

/// An event of one name on either side or both.
struct EventPair {
    std::string name;
    std::array<const Event*, 2> event{};  ///< candidate and reference; null where it did not happen
    double first = 0.0;                   ///< [s] of the shared clock; infinite where no time is finite
};
/// Each name once, in the order in which it first happens on either side.
std::vector<EventPair> event_pairs(const Comparison& comparison);

}  // namespace twinchute::compare
