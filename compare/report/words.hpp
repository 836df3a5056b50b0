// Cells and sentences that the terminal, Markdown and JUnit have in common.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The value with its unit, or "-".
std::string value_text(const std::optional<SideValue>& side, std::string_view unit);

/// "-94.3 N (-1.9 %)", or "-" where there is none.
std::string difference_text(const MetricGap& metric);

/// "of the scene", "from the command line", "by default".
std::string_view origin_text(ToleranceOrigin origin);

/// "input", "result", "mixed", or "-".
std::string standing_text(const std::optional<SideValue>& side);

/// Why a metric is not within: values, difference and tolerance in one sentence.
std::string failure_text(const MetricGap& metric, const Comparison& comparison);

std::string failure_text(const HistoryGap& history);

/// "+1.2 %" of a share, or "3.4 %" without sign.
std::string share_text(double share, bool with_sign);

/// Scores against the test, candidate first as in every table.
std::vector<TestScore> scores_of_test(const Comparison& comparison);

/// How many times longer, in two digits: wall times have no more.
std::string ratio_text(double ratio);

/// "rom 410 us (132 steps), full 12.3 s (14803 steps, 88 ns per element-step), ratio 30000".
std::string cost_line(const Comparison& comparison);

}  // namespace twinchute::compare
