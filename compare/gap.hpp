// How far two records are apart, metric by metric, and what each cost.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compare/attribution.hpp"
#include "compare/drop_test_histories.hpp"
#include "compare/histories.hpp"
#include "lib/cli/exit_code.hpp"
#include "lib/record/frames.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

enum class Verdict {
    within,
    exceeded,
    missing,      ///< a tolerance is asked for, and at least one side has no value
    not_reached,  ///< a side has no value since the scene's own stop came before; of tolerances by default
    not_judged    ///< no tolerance, or a run that broke off
};

/// "within", "exceeded", "missing", "not reached", "not judged".
std::string_view verdict_name(Verdict verdict);

/// Where a tolerance is from.
enum class ToleranceOrigin { scene, command_line, fallback };

/// "scene", "command line", "default".
std::string_view origin_name(ToleranceOrigin origin);

/// One side's value, or nothing when its physics was left out or the run did not get that far.
struct SideValue {
    double value = 0.0;
    MetricKind kind = MetricKind::result;
    std::string note;
};

struct MetricGap {
    const MetricRow* row = nullptr;
    std::optional<SideValue> reference, candidate;
    std::optional<double> difference;    ///< candidate - reference, in the row's unit
    std::optional<double> relative;      ///< difference over |reference|; absent when both are round-off
    std::optional<Tolerance> tolerance;  ///< scene or command line, else the row's
    ToleranceOrigin origin = ToleranceOrigin::fallback;  ///< of the tolerance, where there is one
    Verdict verdict = Verdict::not_judged;
    std::string note;  ///< e.g. that only one side has it; empty when there is nothing to say
};

/// A history that both sides have, or that a tolerance is asked for.
struct HistoryGap {
    const MetricRow* row = nullptr;
    std::vector<PhaseScore> phases;
    std::optional<double> score;         ///< judged_score of the phases
    std::optional<Tolerance> tolerance;  ///< where asked for; "10 %" and "0.1" are the same, of a norm
    ToleranceOrigin origin = ToleranceOrigin::scene;  ///< of the tolerance, where there is one
    Verdict verdict = Verdict::not_judged;
    std::string note;
};

struct FidelityGap {
    /// Metrics that at least one side has, or should have, or a tolerance is asked for.
    std::vector<MetricGap> metrics;
    std::vector<HistoryGap> histories;
    std::optional<double> cost_ratio;  ///< wall time of the reference over that of the candidate
};

/// The two records and what lies between them.
struct Comparison {
    RunRecord reference, candidate;
    ShapeFrames reference_frames, candidate_frames;  ///< empty where a model has no shape
    std::string reference_title, candidate_title;    ///< e.g. "reduced-order model"
    FidelityGap gap;
    std::optional<Attribution> attribution;  ///< where it was asked for
    std::optional<DropTestHistories> test;   ///< where one was given
};

/// `tolerances`: by metric name; they replace the default of a row. A relative one is a share of
/// |reference|; a difference exactly at the tolerance is within. `of_command_line`: those among them that the
/// scene does not ask for.
FidelityGap measure_gap(const RunRecord& reference, const RunRecord& candidate,
                        const std::map<std::string, Tolerance>& tolerances,
                        const std::set<std::string, std::less<>>& of_command_line = {});

/// A metric with a tolerance before and after calibration of the candidate.
struct CalibrationGap {
    const MetricRow* row = nullptr;
    double before = 0.0, after = 0.0, reference = 0.0;  ///< in the row's unit
    double gap_before = 0.0, gap_after = 0.0;           ///< [-] over |reference|
};

/// None where the candidate is not calibrated.
std::vector<CalibrationGap> calibration_gaps(const Comparison& comparison);

/// Verdict on one phase of a history, by its own L2; deployment is not judged.
Verdict phase_verdict(const HistoryGap& history, const PhaseScore& phase);

/// Verdict on all judged metrics and histories: exceeded if any is exceeded or missing, within if all are,
/// else not judged.
Verdict overall_verdict(const FidelityGap& gap);
/// Verdict of the gap, exceeded where a parachute never opened.
Verdict overall_verdict(const Comparison& comparison);

/// False for a run that broke off: what it says of a maximum or a time is not that maximum or time.
bool is_judged(const RunRecord& record);

/// Magnitude of a metric [`unit`] up to which it is zero but for rounding: a share of 1e-9 of the largest
/// value of that unit in the histories of the records, of 1 for numbers without a unit. A double holds
/// sixteen digits; neither the tolerance of an integrator nor sums over millions of steps leave fewer than
/// nine of them open to the order of operations. 0 where no history has the unit: nothing is known then.
double round_off_of(std::string_view unit, const RunRecord& one, const RunRecord& other);
/// (value - of)/|of|; nothing where `of` is zero, or both are up to `zero`.
std::optional<double> relative_difference(double value, double of, double zero);
/// Whether a difference is within a tolerance, a relative one being a share of |of|: exactly at it is within,
/// and so is what is up to `zero`, unless the tolerance is 0.
bool is_within(double difference, const Tolerance& tolerance, double of, double zero);

/// Interrupted before failed before exceeded.
ExitCode exit_code(const Comparison& comparison);

/// One line: "within tolerance in 3 of 3 judged metrics", or which ones are not, or that a run did not end.
std::string verdict_line(const Comparison& comparison);

}  // namespace twinchute::compare
