// `twinchute stability`: stiff and extreme cases, one verdict each.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

Command stability_command(const Fidelity& full, const Fidelity& rom);

}  // namespace twinchute::compare
