// The gap as JSON, for scripts and for continuous integration.
#pragma once

#include <string>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The text of gap.json. A value that one side does not have is absent.
std::string gap_json(const Comparison& comparison);

}  // namespace twinchute::compare
