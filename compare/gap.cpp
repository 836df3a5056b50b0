#include "compare/gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace twinchute::compare {
namespace {

// 0.1 times a reference is not exact in binary: a difference of exactly the tolerance must not
// fail by the last bit.
constexpr double round_off = 1e-12;

/// Results of a whole fall, which the part before a hand-over has its share in.
constexpr std::array<std::string_view, 5> of_the_whole_fall{"flight_time_s", "landing_east_m",
                                                            "landing_north_m", "drift_m", "altitude_loss_m"};

/// Whether `record` has a metric from the fidelity of the other side alone, which flew its last part.
bool is_borrowed(const RunRecord& record, const RunRecord& other, std::string_view key) {
    const auto& made = record.handed_over;
    if (!made || std::ranges::count(of_the_whole_fall, key) > 0) return false;
    const bool by_the_other =
        made->to == other.fidelity || (other.handed_over && other.handed_over->to == made->to);
    return by_the_other && made->to != record.fidelity && std::ranges::count(made->metrics, key) > 0;
}

/// None where it is borrowed.
std::optional<SideValue> side_value(const RunRecord& record, const RunRecord& other, std::string_view key) {
    if (is_borrowed(record, other, key)) return {};
    const Metric* metric = record.find_metric(key);
    if (metric == nullptr || !std::isfinite(metric->value)) return {};
    return SideValue{metric->value, metric->kind, metric->note};
}

/// Why a record has no value of a metric that it should have; null where it says nothing of it.
const MissingMetric* missing_in(const RunRecord& record, std::string_view key) {
    const auto found = std::ranges::find(record.missing, key, &MissingMetric::metric);
    return found == record.missing.end() ? nullptr : &*found;
}

/// Whether it is no fault of a side that it has no value: it has one, or the scene stopped before, or handed
/// over to the other's fidelity.
bool is_excused(const std::optional<SideValue>& side, const MissingMetric* missing, bool borrowed) {
    return side || borrowed || (missing && missing->not_reached);
}

Verdict judge(const MetricGap& gap, bool excused, double zero) {
    if (!gap.tolerance) return Verdict::not_judged;
    // Whoever asks for a tolerance wants it held against something.
    if (!gap.difference)
        return excused && gap.origin == ToleranceOrigin::fallback ? Verdict::not_reached : Verdict::missing;
    return is_within(*gap.difference, *gap.tolerance, gap.reference->value, zero) ? Verdict::within
                                                                                  : Verdict::exceeded;
}

/// Why each of those that lack a metric does, where they say so.
std::string reasons(const MetricGap& gap, const RunRecord& reference, const RunRecord& candidate) {
    std::string text;
    const auto add = [&](const std::optional<SideValue>& side, const RunRecord& record,
                         const RunRecord& other) {
        if (side) return;
        const auto say = [&](const std::string& why) {
            text += fmt::format("{} {}: {}", text.empty() ? "," : ";", record.fidelity, why);
        };
        if (is_borrowed(record, other, gap.row->key))
            say(fmt::format("{} flew the rest from t = {:.4g} s on", record.handed_over->to,
                            record.handed_over->time));
        else if (const MissingMetric* missing = missing_in(record, gap.row->key))
            say(missing->why);
    };
    add(gap.candidate, candidate, reference);
    add(gap.reference, reference, candidate);
    return text;
}

std::string note_of(const MetricGap& gap, const RunRecord& reference, const RunRecord& candidate) {
    const auto why = [&] { return reasons(gap, reference, candidate); };
    if (!gap.reference && !gap.candidate) return "neither side has it" + why();
    if (!gap.reference) return fmt::format("only {} has it", candidate.fidelity) + why();
    if (!gap.candidate) return fmt::format("only {} has it", reference.fidelity) + why();
    if (gap.difference && !gap.relative && gap.reference->value != 0) return "zero but for rounding";
    if (gap.reference->kind == MetricKind::input && gap.candidate->kind == MetricKind::input) {
        return "an input of both: the difference says nothing about the models";
    }
    if (gap.reference->value == 0 && gap.tolerance && gap.tolerance->relative) {
        return "the reference is zero: a relative tolerance allows no difference";
    }
    return {};
}

/// Names of metrics, then of histories.
std::vector<std::string_view> names_of(const FidelityGap& gap, Verdict verdict) {
    std::vector<std::string_view> names;
    for (const MetricGap& metric : gap.metrics)
        if (metric.verdict == verdict) names.push_back(metric.row->name);
    for (const HistoryGap& history : gap.histories)
        if (history.verdict == verdict) names.push_back(history.row->name);
    return names;
}

std::string joined_names(const FidelityGap& gap, Verdict verdict) {
    return fmt::format("{}", fmt::join(names_of(gap, verdict), ", "));
}

std::size_t count(const FidelityGap& gap, Verdict verdict) {
    return names_of(gap, verdict).size();
}

Verdict held_against(double score, const Tolerance& tolerance) {
    return score <= tolerance.value * (1 + round_off) ? Verdict::within : Verdict::exceeded;
}

using Names = std::set<std::string, std::less<>>;

/// Origin of a tolerance that is asked for.
ToleranceOrigin origin_of(std::string_view name, const Names& of_command_line) {
    return of_command_line.contains(name) ? ToleranceOrigin::command_line : ToleranceOrigin::scene;
}

/// Rows of what either may have, and of anything else that has a tolerance.
std::vector<const MetricRow*> rows_of(const RunRecord& reference, const RunRecord& candidate,
                                      const std::map<std::string, Tolerance>& tolerances) {
    std::vector<const MetricRow*> rows = reference.rows_of_metrics();
    const auto add = [&](const MetricRow* row) {
        if (std::ranges::find(rows, row) == rows.end()) rows.push_back(row);
    };
    std::ranges::for_each(candidate.rows_of_metrics(), add);
    for (const auto& [name, tolerance] : tolerances)
        if (const MetricRow* row = find_metric_row(name)) add(row);
    return rows;
}

std::vector<HistoryGap> histories_of(const RunRecord& reference, const RunRecord& candidate,
                                     const std::map<std::string, Tolerance>& tolerances,
                                     const Names& of_command_line, bool both_ended) {
    std::vector<HistoryGap> histories;
    for (const MetricRow& row : history_rows()) {
        HistoryGap history;
        history.row = &row;
        history.phases = score_history(reference, candidate, row);
        history.score = judged_score(history.phases);
        if (const auto asked = tolerances.find(std::string(row.name)); asked != tolerances.end())
            history.tolerance = asked->second;
        history.origin = origin_of(row.name, of_command_line);
        if (history.phases.empty() && !history.tolerance) continue;
        if (!history.score) history.note = "the two have no common time of it from snatch on";
        if (history.tolerance && both_ended)
            history.verdict =
                history.score ? held_against(*history.score, *history.tolerance) : Verdict::missing;
        histories.push_back(std::move(history));
    }
    return histories;
}

}  // namespace

std::string_view verdict_name(Verdict verdict) {
    switch (verdict) {
        case Verdict::within:
            return "within";
        case Verdict::exceeded:
            return "exceeded";
        case Verdict::missing:
            return "missing";
        case Verdict::not_reached:
            return "not reached";
        case Verdict::not_judged:
            return "not judged";
    }
    return "unknown";
}

std::string_view origin_name(ToleranceOrigin origin) {
    switch (origin) {
        case ToleranceOrigin::scene:
            return "scene";
        case ToleranceOrigin::command_line:
            return "command line";
        case ToleranceOrigin::fallback:
            return "default";
    }
    return "unknown";
}

FidelityGap measure_gap(const RunRecord& reference, const RunRecord& candidate,
                        const std::map<std::string, Tolerance>& tolerances, const Names& of_command_line) {
    FidelityGap gap;
    const bool both_ended = is_judged(reference) && is_judged(candidate);
    for (const MetricRow* const which : rows_of(reference, candidate, tolerances)) {
        const MetricRow& row = *which;
        MetricGap metric;
        metric.row = &row;
        metric.reference = side_value(reference, candidate, row.key);
        metric.candidate = side_value(candidate, reference, row.key);
        const auto asked = tolerances.find(std::string(row.name));
        const MissingMetric *of_reference = missing_in(reference, row.key),
                            *of_candidate = missing_in(candidate, row.key);
        // A default tolerance on what the physics of neither side knows is no request; one that somebody
        // wrote down is.
        const bool known_to_lack = row.tolerance && (of_reference || of_candidate);
        const bool wanted =
            row.show == Show::always && (metric.reference || metric.candidate || known_to_lack);
        if (!wanted && asked == tolerances.end()) continue;
        metric.tolerance = asked == tolerances.end() ? row.tolerance : asked->second;
        if (asked != tolerances.end()) metric.origin = origin_of(row.name, of_command_line);
        const double zero = round_off_of(row.unit, reference, candidate);
        if (metric.reference && metric.candidate) {
            metric.difference = metric.candidate->value - metric.reference->value;
            metric.relative = relative_difference(metric.candidate->value, metric.reference->value, zero);
        }
        const bool excused =
            is_excused(metric.reference, of_reference, is_borrowed(reference, candidate, row.key)) &&
            is_excused(metric.candidate, of_candidate, is_borrowed(candidate, reference, row.key));
        metric.verdict = both_ended ? judge(metric, excused, zero) : Verdict::not_judged;
        metric.note = note_of(metric, reference, candidate);
        gap.metrics.push_back(std::move(metric));
    }
    gap.histories = histories_of(reference, candidate, tolerances, of_command_line, both_ended);
    if (reference.cost.wall_s > 0 && candidate.cost.wall_s > 0) {
        gap.cost_ratio = reference.cost.wall_s / candidate.cost.wall_s;
    }
    return gap;
}

std::vector<CalibrationGap> calibration_gaps(const Comparison& comparison) {
    std::vector<CalibrationGap> gaps;
    if (!comparison.candidate.uncalibrated) return gaps;
    const std::vector<Metric>& without = comparison.candidate.uncalibrated->metrics;
    for (const MetricGap& metric : comparison.gap.metrics) {
        const auto before = std::ranges::find(without, metric.row->key, &Metric::key);
        if (!metric.tolerance || !metric.relative || before == without.end()) continue;
        const double reference = metric.reference->value;
        gaps.push_back({metric.row, before->value, metric.candidate->value, reference,
                        (before->value - reference) / std::abs(reference), *metric.relative});
    }
    return gaps;
}

Verdict phase_verdict(const HistoryGap& history, const PhaseScore& phase) {
    if (history.verdict == Verdict::not_judged || phase.phase == HistoryPhase::deployment)
        return Verdict::not_judged;
    return held_against(phase.l2, *history.tolerance);
}

Verdict overall_verdict(const FidelityGap& gap) {
    if (count(gap, Verdict::exceeded) + count(gap, Verdict::missing) > 0) return Verdict::exceeded;
    return count(gap, Verdict::within) > 0 ? Verdict::within : Verdict::not_judged;
}

Verdict overall_verdict(const Comparison& comparison) {
    for (const RunRecord* side : {&comparison.reference, &comparison.candidate})
        if (failed_to_open(side->status.code)) return Verdict::exceeded;
    return overall_verdict(comparison.gap);
}

bool is_judged(const RunRecord& record) {
    const ExitCode code = twinchute::exit_code(record.status.code);
    return code == ExitCode::done || code == ExitCode::verdict;
}

double round_off_of(std::string_view unit, const RunRecord& one, const RunRecord& other) {
    constexpr double share = 1e-9;
    if (unit.empty()) return share;
    double largest = 0.0;
    for (const RunRecord* record : {&one, &other})
        for (const Channel& channel : record->channels) {
            if (channel.unit != unit) continue;
            for (const double value : channel.values)
                if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
        }
    return share * largest;
}

std::optional<double> relative_difference(double value, double of, double zero) {
    if (of == 0.0 || std::max(std::abs(value), std::abs(of)) <= zero) return {};
    return (value - of) / std::abs(of);
}

bool is_within(double difference, const Tolerance& tolerance, double of, double zero) {
    // A relative tolerance means nothing for values that are zero but for round-off; a tolerance of 0 asks
    // for the same bits.
    double allowed = tolerance.value;
    if (tolerance.relative && allowed > 0.0) allowed = std::max(allowed * std::abs(of), zero);
    return std::abs(difference) <= allowed * (1 + round_off);
}

ExitCode exit_code(const Comparison& comparison) {
    const ExitCode reference = twinchute::exit_code(comparison.reference.status.code);
    const ExitCode candidate = twinchute::exit_code(comparison.candidate.status.code);
    for (const ExitCode code : {ExitCode::interrupted, ExitCode::numerical, ExitCode::usage}) {
        if (reference == code || candidate == code) return code;
    }
    return overall_verdict(comparison) == Verdict::exceeded ? ExitCode::verdict : ExitCode::done;
}

std::string verdict_line(const Comparison& comparison) {
    std::string unopened;
    for (const RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        if (!is_judged(*side)) {
            return fmt::format("no verdict: {} ended as {}{}{}", side->fidelity,
                               status_name(side->status.code), side->status.detail.empty() ? "" : ": ",
                               side->status.detail);
        }
        if (failed_to_open(side->status.code))
            unopened += fmt::format("not opened in {}: {}; ", side->fidelity, side->status.detail);
    }
    const FidelityGap& gap = comparison.gap;
    const auto within = count(gap, Verdict::within);
    const auto exceeded = count(gap, Verdict::exceeded);
    const auto missing = count(gap, Verdict::missing);
    const auto not_reached = count(gap, Verdict::not_reached);
    const auto judged = within + exceeded + missing;
    const std::string rest = not_reached > 0 ? fmt::format(", {} not reached ({})", not_reached,
                                                           joined_names(gap, Verdict::not_reached))
                                             : "";
    if (judged == 0)
        return unopened + (not_reached > 0 ? "nothing was compared" + rest
                                           : "nothing judged: no metric has a tolerance");
    if (exceeded + missing == 0)
        return unopened + fmt::format("within tolerance: {} of {} judged metrics", within, judged) + rest;
    std::string line = unopened + "tolerance not met:";
    if (exceeded > 0)
        line += fmt::format(" {} exceeded ({})", exceeded, joined_names(gap, Verdict::exceeded));
    if (missing > 0) {
        line += fmt::format("{} {} missing ({})", exceeded > 0 ? "," : "", missing,
                            joined_names(gap, Verdict::missing));
    }
    return line + fmt::format(", {} of {} judged metrics within", within, judged) + rest;
}

}  // namespace twinchute::compare
