// `twinchute ladder`: error against run time for one scene, from closed forms to the finest mesh.
#pragma once

#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// The levels of these fidelities, the cheapest first. The rows must outlive the command.
Command ladder_command(std::vector<const Fidelity*> fidelities);

}  // namespace twinchute::compare
