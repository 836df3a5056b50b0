#include "compare/report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

std::string with_unit(double value, std::string_view unit) {
    return fmt::format("{}{}{}", readable(value), unit.empty() ? "" : " ", unit);
}

/// A difference deserves as many digits after the point as the larger of the values it comes from.
std::string signed_difference(double difference, double larger) {
    const int before = larger == 0 ? 1 : static_cast<int>(std::floor(std::log10(larger))) + 1;
    const std::string text = fmt::format("{:+.{}f}", difference, std::clamp(4 - before, 0, 12));
    return text.find_first_not_of("+-0.") == std::string::npos ? text.substr(1) : text;
}

}  // namespace

std::string value_text(const std::optional<SideValue>& side, std::string_view unit) {
    return side ? with_unit(side->value, unit) : "-";
}

std::string difference_text(const MetricGap& metric) {
    if (!metric.difference) return "-";
    const double larger = std::max(std::abs(metric.reference->value), std::abs(metric.candidate->value));
    std::string text = signed_difference(*metric.difference, larger);
    if (!metric.row->unit.empty()) text += fmt::format(" {}", metric.row->unit);
    if (metric.relative) text += fmt::format(" ({:+.1f} %)", 100 * *metric.relative);
    return text;
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
        metric.tolerance ? fmt::format("{} ({})", tolerance_text(*metric.tolerance, metric.row->unit),
                                       origin_text(metric.origin))
                         : "none";
    if (metric.verdict == Verdict::missing) {
        return fmt::format("{}: {}, so that the tolerance of {} cannot be judged", metric.row->title,
                           metric.note, tolerance);
    }
    return fmt::format("{}: {} {}, {} {}, difference {}, tolerance {}", metric.row->title,
                       comparison.reference.fidelity, value_text(metric.reference, metric.row->unit),
                       comparison.candidate.fidelity, value_text(metric.candidate, metric.row->unit),
                       difference_text(metric), tolerance);
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
    const std::string text = fmt::format("{:.{}f}", 100 * std::abs(share), std::abs(share) < 10 ? 1 : 0);
    const bool zero = text.find_first_not_of("0.") == std::string::npos;
    return fmt::format("{}{} %", !with_sign || zero ? "" : share < 0 ? "-" : "+", text);
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
