// The pictures of a report.
#pragma once

#include <string>
#include <string_view>

#include "compare/report/sides.hpp"

namespace twinchute::compare {

/// Opening force against time, over the opening: it ends at twice the time of the last peak or full open.
/// `test`: what a test measured, or null.
std::string force_svg(const PageSides& sides, const DropTestHistories* test = nullptr);

/// Speed of the payload against time, over the whole run.
std::string speed_svg(const PageSides& sides, const DropTestHistories* test = nullptr);

/// A channel of all sides against time since release, over the opening as force_svg.
std::string history_svg(const PageSides& sides, const DropTestHistories* test, std::string_view channel);

}  // namespace twinchute::compare
