// `twinchute plan`: what a scene needs, what it leaves out and why, and what its runs will cost.
#pragma once

#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// The cheapest fidelity first: its run tells the others when events will come.
Command plan_command(std::vector<const Fidelity*> fidelities);

}  // namespace twinchute
