// The stability matrix as terminal table, CSV, Markdown and JSON.
#pragma once

#include <string>

#include "compare/stability.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {

/// "31 stable, 2 refused, 0 silently wrong; 33 cells".
std::string stability_summary(const StabilityMatrix& matrix);

std::string stability_terminal(const StabilityMatrix& matrix, const Style& style);
std::string stability_csv(const StabilityMatrix& matrix);
/// `command`: what made it, for the reader who wants to repeat it.
std::string stability_markdown(const StabilityMatrix& matrix, const Provenance& provenance,
                               const std::string& command);
std::string stability_json(const StabilityMatrix& matrix, const Provenance& provenance);

}  // namespace twinchute::compare
