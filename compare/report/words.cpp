#include "compare/report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

constexpr double rounding = 1e-9;  // [-] of what it comes from: nothing but for rounding

/// Number of digits after the point with which a value has `significant` ones.
int places_for(double value, int significant) {
    const std::string rounded = fmt::format("{:.{}e}", std::abs(value), significant - 1);  // 0.0998 is 0.10
    return significant - 1 - std::stoi(rounded.substr(rounded.find('e') + 1));
}

/// How much of its tolerance a gap uses; 0 of none.
double used(const MetricGap& metric) {
    if (!metric.difference || !metric.tolerance) return 0.0;
    const double allowed =
        metric.tolerance->value * (metric.tolerance->relative ? std::abs(metric.reference->value) : 1.0);
    return allowed > 0.0 ? std::abs(*metric.difference) / allowed : 0.0;
}

}  // namespace

std::string value_text(const std::optional<SideValue>& side, std::string_view unit) {
    return side ? with_unit(side->value, unit) : "-";
}

std::string signed_text(double value, double size) {
    if (!std::isfinite(value)) return readable(value);
    if (value == 0.0 || std::abs(value) <= rounding * std::abs(size)) return "0";
    const int decimals = std::max(size == 0.0 ? 0 : places_for(size, 4), places_for(value, 2));
    return fmt::format("{:+.{}f}", value, std::clamp(decimals, 0, 15));
}

std::string difference_text(const MetricGap& metric) {
    if (!metric.difference) return "-";
    const double larger = std::max(std::abs(metric.reference->value), std::abs(metric.candidate->value));
    const double factor = shown_factor(metric.row->unit);
    std::string text =
        signed_text(-*metric.difference * factor, larger * factor) + spaced_unit(metric.row->unit);
    if (metric.relative) text += fmt::format(" ({})", share_text(-*metric.relative, true));
    return text;
}

std::string difference_words(const MetricGap& metric, const Comparison& comparison) {
    const std::string& candidate = comparison.candidate.fidelity;
    const std::string& reference = comparison.reference.fidelity;
    if (!metric.difference) return metric.note;
    if (!metric.relative && metric.reference->value != 0) return metric.note;
    const double larger = std::max(std::abs(metric.reference->value), std::abs(metric.candidate->value));
    if (std::abs(*metric.difference) <= rounding * larger)
        return fmt::format("{} and {} say the same", candidate, reference);
    const double factor = shown_factor(metric.row->unit);
    std::string text = fmt::format("{} is {}{}", reference,
                                   signed_text(-*metric.difference * factor, larger * factor).substr(1),
                                   spaced_unit(metric.row->unit));
    if (metric.relative) text += fmt::format(" ({})", share_text(std::abs(*metric.relative), false));
    return text + (*metric.difference < 0 ? " above " : " below ") + candidate;
}

std::string difference_legend(const Comparison& comparison) {
    return fmt::format("Differences are {0} minus {1}; per cents are shares of {0}.",
                       comparison.reference.fidelity, comparison.candidate.fidelity);
}

std::vector<const MetricGap*> largest_unjudged(const FidelityGap& gap, std::size_t most) {
    constexpr double worth_saying = 0.01;
    std::vector<const MetricGap*> list;
    for (const MetricGap& metric : gap.metrics) {
        const bool of_inputs = metric.reference && metric.candidate &&
                               metric.reference->kind == MetricKind::input &&
                               metric.candidate->kind == MetricKind::input;
        // Shares of a coordinate say nothing; the drift tells of the landing point.
        const bool coordinate = metric.row->name == "landing_east" || metric.row->name == "landing_north";
        if (!metric.relative || metric.tolerance || of_inputs || coordinate ||
            !(std::abs(*metric.relative) >= worth_saying))
            continue;
        // A force over a weight, say: one gap, told once.
        const auto repeats = [&](const MetricGap& other) {
            return &other != &metric && other.relative &&
                   std::abs(*other.relative - *metric.relative) <= rounding &&
                   (other.tolerance || &other < &metric);
        };
        if (std::ranges::none_of(gap.metrics, repeats)) list.push_back(&metric);
    }
    std::ranges::stable_sort(list, std::greater<>(),
                             [](const MetricGap* metric) { return std::abs(*metric->relative); });
    if (list.size() > most) list.resize(most);
    return list;
}

std::vector<std::string> judged_words(const Comparison& comparison) {
    std::vector<std::string> words;
    const MetricGap* closest = nullptr;
    for (const MetricGap& metric : comparison.gap.metrics) {
        if (metric.verdict == Verdict::exceeded || metric.verdict == Verdict::missing)
            words.push_back(failure_text(metric, comparison));
        if (metric.verdict == Verdict::within && (closest == nullptr || used(metric) > used(*closest)))
            closest = &metric;
    }
    for (const HistoryGap& history : comparison.gap.histories)
        if (history.verdict == Verdict::exceeded || history.verdict == Verdict::missing)
            words.push_back(failure_text(history));
    if (words.empty() && closest != nullptr)
        words.push_back(fmt::format(
            "{}: {}, tolerance {} ({})", closest->row->title, difference_words(*closest, comparison),
            shown_tolerance(*closest->tolerance, closest->row->unit), origin_text(closest->origin)));
    return words;
}

std::string shown_tolerance(const Tolerance& tolerance, std::string_view unit) {
    if (tolerance.relative) return tolerance_text(tolerance, unit);
    return tolerance_text({shown(tolerance.value, unit).value, false}, shown_unit(unit));
}

std::string_view origin_text(ToleranceOrigin origin) {
    switch (origin) {
        case ToleranceOrigin::scene:
            return "of the scene";
        case ToleranceOrigin::command_line:
            return "from the command line";
        case ToleranceOrigin::fallback:
            return "by default";
    }
    return "";
}

std::string standing_text(const std::optional<SideValue>& side) {
    return side ? std::string(metric_kind_name(side->kind)) : "-";
}

std::string failure_text(const MetricGap& metric, const Comparison& comparison) {
    const std::string tolerance =
        metric.tolerance ? fmt::format("{} ({})", shown_tolerance(*metric.tolerance, metric.row->unit),
                                       origin_text(metric.origin))
                         : "none";
    if (metric.verdict == Verdict::missing) {
        return fmt::format("{}: {}, so that the tolerance of {} cannot be judged", metric.row->title,
                           metric.note, tolerance);
    }
    return fmt::format("{}: {} {}, {} {}: {}, tolerance {}", metric.row->title, comparison.reference.fidelity,
                       value_text(metric.reference, metric.row->unit), comparison.candidate.fidelity,
                       value_text(metric.candidate, metric.row->unit), difference_words(metric, comparison),
                       tolerance);
}

std::string failure_text(const HistoryGap& history) {
    const std::string tolerance =
        history.tolerance
            ? fmt::format("{} ({})", share_text(history.tolerance->value, false), origin_text(history.origin))
            : "none";
    if (!history.score)
        return fmt::format("{} over time: {}, so that the tolerance of {} cannot be judged",
                           history.row->title, history.note, tolerance);
    return fmt::format("{} over time: relative L2 norm of the difference {}, tolerance {}",
                       history.row->title, share_text(*history.score, false), tolerance);
}

std::string share_text(double share, bool with_sign) {
    const double size = 100 * std::abs(share);
    if (size <= 100 * rounding) return "0 %";
    const std::string text = fmt::format("{:.{}f}", size,
                                         size >= 1000  ? 0
                                         : size >= 0.1 ? 1
                                                       : std::min(places_for(size, 2), 12));
    return fmt::format("{}{} %", !with_sign ? "" : share < 0 ? "-" : "+", text);
}

std::vector<TestScore> scores_of_test(const Comparison& comparison) {
    return test_scores(*comparison.test, {&comparison.candidate, &comparison.reference});
}

std::string ratio_text(double ratio) {
    // Two runs of the same input differ by some per cent in time: more digits would be noise.
    if (!(std::isfinite(ratio) && ratio >= 100)) return readable(ratio, 2);
    const double unit = std::pow(10.0, std::floor(std::log10(ratio)) - 1);
    return fmt::format("{:.0f}", std::round(ratio / unit) * unit);
}

std::string cost_line(const Comparison& comparison) {
    std::string text;
    for (const RunRecord* side : {&comparison.candidate, &comparison.reference}) {
        const Cost& cost = side->cost;
        text += fmt::format("{} {} ({} steps", side->fidelity, time_text(cost.wall_s), cost.steps);
        if (cost.element_steps > 0)
            text += fmt::format(", {} ns per element-step", readable(cost.ns_per_element_step, 3));
        text += "), ";
    }
    if (!comparison.gap.cost_ratio) return text.substr(0, text.size() - 2);
    return text + "ratio " + ratio_text(*comparison.gap.cost_ratio);
}

}  // namespace twinchute::compare
