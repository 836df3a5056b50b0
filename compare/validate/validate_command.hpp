// The command that runs the suites of validation.
#pragma once

#include <vector>

#include "compare/validate/run_suite.hpp"
#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// `twinchute validate`. The fidelities outlive the command. `calibrate`: for cases that judge a drop by
/// others.
Command validate_command(std::vector<const Fidelity*> fidelities, Calibrator calibrate);

}  // namespace twinchute::compare
