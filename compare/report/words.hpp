// Cells and sentences that the terminal, Markdown and JUnit have in common.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The value with its unit, or "-".
std::string value_text(const std::optional<SideValue>& side, std::string_view unit);

/// With a sign, and as many digits after the point as four digits of `size` have, two significant ones at
/// least: "+134", "-0.00032". "0" of what is zero beside `size` but for rounding.
std::string signed_text(double value, double size);

/// Reads reference less candidate, as all differences do that people read; relative ones are shares of the
/// reference. (gap.json and MetricGap have candidate less reference.) "+94.3 N (+1.9 %)", or "-" where there
/// is none.
std::string difference_text(const MetricGap& metric);

/// "full is 94.3 N (1.9 %) above rom": the same without a sign.
std::string difference_words(const MetricGap& metric, const Comparison& comparison);

/// Says once how differences are to be read: "Differences are full minus rom; per cents are shares of full."
std::string difference_legend(const Comparison& comparison);

/// Metrics without a tolerance in which the two are furthest apart, the largest first, `most` at most: from 1
/// % on, no inputs of both, and none that repeats the gap of another one in another unit.
std::vector<const MetricGap*> largest_unjudged(const FidelityGap& gap, std::size_t most = 5);

/// Gaps of judged metrics that are not within, else of the one that is closest to its tolerance; a sentence
/// each. Empty where nothing is judged.
std::vector<std::string> judged_words(const Comparison& comparison);

/// As tolerance_text, in the units chosen.
std::string shown_tolerance(const Tolerance& tolerance, std::string_view unit);

/// "of the scene", "from the command line", "by default".
std::string_view origin_text(ToleranceOrigin origin);

/// "input", "result", "mixed", or "-".
std::string standing_text(const std::optional<SideValue>& side);

/// Why a metric is not within: values, difference and tolerance in one sentence.
std::string failure_text(const MetricGap& metric, const Comparison& comparison);

std::string failure_text(const HistoryGap& history);

/// "+1.2 %" of a share, or "3.4 %" without sign; two significant digits below 0.1 %, "0 %" of rounding.
std::string share_text(double share, bool with_sign);

/// Scores against the test, candidate first as in every table.
std::vector<TestScore> scores_of_test(const Comparison& comparison);

/// How many times longer, in two digits: wall times have no more.
std::string ratio_text(double ratio);

/// "rom 410 us (132 steps), full 12.3 s (14803 steps, 88 ns per element-step), ratio 30000".
std::string cost_line(const Comparison& comparison);

}  // namespace twinchute::compare
