// The command that runs the suites of validation.
#pragma once

#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// `twinchute validate`. The fidelities outlive the command.
Command validate_command(std::vector<const Fidelity*> fidelities);

}  // namespace twinchute::compare
