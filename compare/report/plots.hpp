// The pictures of a report.
#pragma once

#include <string>
#include <string_view>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// Opening force against time, over the opening: it ends at twice the time of the last peak or full open.
std::string force_svg(const Comparison& comparison);

/// Speed of the payload against time, over the whole run.
std::string speed_svg(const Comparison& comparison);

/// A channel of both sides against time since release, over the opening as force_svg.
std::string history_svg(const Comparison& comparison, std::string_view channel);

}  // namespace twinchute::compare
