// A comparison as one HTML page that needs nothing beside it: no network, no other file.
#pragma once

#include <string>

#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"

namespace twinchute::compare {

/// The text of report.html. It depends on nothing but the comparison and the ladder that lies beside it, so
/// that their files give the same page again.
std::string report_html(const Comparison& comparison, const LadderBeside& beside = {});

}  // namespace twinchute::compare
