// `twinchute calibrate`.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::study {

/// Exit code 0 where inputs are fitted, 1 where they are and the tests do not go with the model. `rom`: gives
/// samples.
Command calibrate_command(const Fidelity& rom);

}  // namespace twinchute::study
