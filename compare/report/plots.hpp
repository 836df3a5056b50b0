// The two pictures of a report.
#pragma once

#include <string>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// Opening force against time, over the opening: it ends at twice the time of the last peak or full open.
std::string force_svg(const Comparison& comparison);

/// Speed of the payload against time, over the whole run.
std::string speed_svg(const Comparison& comparison);

}  // namespace twinchute::compare
