// How far two histories are apart: a difference of curves, scored apart for deployment, inflation and
// descent, of each parachute where several open in turn.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/metrics.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::compare {

/// Straight lines between points; time does not fall. Two points at one time are a jump: the first ends what
/// was, the second begins what follows.
struct Curve {
    std::vector<double> time, value;  ///< of one length, finite
};

/// The value just before and just after a time within the curve, linear between its points: where the curve
/// jumps, what was and what follows; elsewhere the same.
double value_before(const Curve& curve, double time);
double value_after(const Curve& curve, double time);

/// a - b over [from, to], on the union of both clocks, so that between its points it is exactly linear. Both
/// curves have to reach over the interval.
Curve difference(const Curve& a, const Curve& b, double from, double to);

/// The curve over [from, to] alone, with points at both ends.
Curve cut(const Curve& curve, double from, double to);

/// Square root of the integral of the squared value, exact for what is linear between points. Unit: value
/// sqrt(time).
double l2_norm(const Curve& curve);

/// Largest absolute value.
double infinity_norm(const Curve& curve);

enum class HistoryPhase { deployment, inflation, descent };

/// "deployment": before snatch; "inflation": from there until the reference's drag area is full; "descent":
/// the rest, until another parachute's deployment.
std::string_view phase_name(HistoryPhase phase);

/// All norms are shares of the reference's own, over the same interval.
struct PhaseScore {
    std::string parachute;  ///< whose; empty where the record does not tell several apart
    HistoryPhase phase;
    double from = 0.0, to = 0.0;  ///< [s] since its snatch; what both records have of the phase
    double maximum = 0.0;   ///< candidate's largest absolute value less the reference's, over the latter
    double l2 = 0.0;        ///< l2_norm of the difference over that of the reference
    double infinity = 0.0;  ///< infinity_norm of the difference over that of the reference
};

/// [s] in the clock of the channels when the lines are drawn out and the canopy begins to fill: snatch, or
/// the start of a run that begins there.
double snatch_of(const RunRecord& record);

/// A channel over [s] since release; nothing where it is missing, holds a value that is not finite, or its
/// time falls.
std::optional<Curve> curve_of(const RunRecord& record, std::string_view channel);

/// One score a phase of which both records have some time, in order, aligned at snatch: where the same
/// several parachutes come out in both, each at its own. Empty when a record lacks the channel, holds a value
/// that is not finite, or the reference is zero throughout. Deployment has none where the root mean
/// square of the reference is below a hundredth of its largest value: a ratio to what is not out yet says
/// nothing.
std::vector<PhaseScore> score_history(const RunRecord& reference, const RunRecord& candidate,
                                      const MetricRow& row);

/// The score that a tolerance is held against: the largest l2 of inflation and descent. Before snatch the
/// models do not mean the same by a force, so that deployment is shown and not judged.
std::optional<double> judged_score(std::span<const PhaseScore> phases);

}  // namespace twinchute::compare
