// The stability matrix as terminal table, CSV, Markdown and JSON.
#pragma once

#include <string>
#include <vector>

#include "compare/stability.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {

/// "31 stable, 2 refused, ... of 40 cells", and which of them failed.
std::string stability_summary(const std::vector<StabilityCell>& cells);

std::string stability_terminal(const std::vector<StabilityCell>& cells, const Style& style);
std::string stability_csv(const std::vector<StabilityCell>& cells);
/// `command`: what made it, for the reader who wants to repeat it.
std::string stability_markdown(const std::vector<StabilityCell>& cells, const Provenance& provenance,
                               const std::string& command);
std::string stability_json(const std::vector<StabilityCell>& cells, const Provenance& provenance);

}  // namespace twinchute::compare
