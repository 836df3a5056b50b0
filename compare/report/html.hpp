// A comparison as one HTML page that needs nothing beside it: no network, no other file.
#pragma once

#include <string>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The text of report.html. It depends on nothing but the comparison, so that records give the same page
/// again.
std::string report_html(const Comparison& comparison);

}  // namespace twinchute::compare
