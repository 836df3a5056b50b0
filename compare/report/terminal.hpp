// The comparison for reading on a terminal.
#pragma once

#include <string>

#include "compare/gap.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {

/// One table, the verdict, one line of cost, what each side left out, warnings.
std::string terminal_text(const Comparison& comparison, const Style& style);

}  // namespace twinchute::compare
