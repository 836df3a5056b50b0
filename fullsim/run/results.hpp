// The record of a full run that has ended: metrics, events found afterwards, warnings, what was left out.
#pragma once

#include <span>
#include <vector>

#include "fullsim/run/findings.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

/// [s] that the projected area is averaged over: the shape settles later than the speed.
inline constexpr double shape_average = 2.0;
/// Has been open for that long, with a skirt that crosses itself throughout.
bool went_through_itself(const RunView& run);
/// Share of the steady projected area at which a canopy is filled (docs/theory/filling-time.md).
inline constexpr double filled_share = 0.98;

/// Metrics, channels, ledger, warnings and left-out physics, into the record of a run with its status, events
/// and cost.
/// `each`: of the canopies, or the only one.
void fill_results(const RunView& run, std::span<const RunView> each, RunRecord& record);

/// A run of a scene with stages, as its results read it.
struct StagesView {
    const Scene& scene;
    const Cluster& canopies;
    const OpeningSequence& sequence;
    const Observer& observer;  ///< of all together
    const Findings& findings;  ///< of the flight
    std::vector<ParachuteResult> openings;
};
/// As fill_results, of the parachutes that have left their packs, and of each canopy of these.
void fill_results_of_stages(const StagesView& run, std::span<const RunView> parachutes,
                            std::span<const RunView> each, RunRecord& record);

/// The opening of a canopy that fills last, as it would be without its lag.
Inflation without_lag(const RunView& run);
/// Warnings of the full model; with stages of the canopy alone, not of the flight. steady_area: [m^2]
/// projected, where the run has seen it.
void add_warnings(const RunView& run, std::optional<double> steady_area, RunRecord& record);

}  // namespace twinchute::fullsim
