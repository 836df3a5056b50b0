// The comparison as a page: verdict first, then what it rests on.
#pragma once

#include <string>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The text of report.md; it shows force.svg and speed.svg that lie beside it.
std::string report_markdown(const Comparison& comparison);

}  // namespace twinchute::compare
