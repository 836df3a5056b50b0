// The rows of the stability matrix, by fidelity.
#pragma once

#include <span>
#include <vector>

#include "compare/stability.hpp"

namespace twinchute::compare {

std::vector<StabilityCase> rom_cases();
std::vector<StabilityCase> full_cases();

}  // namespace twinchute::compare
