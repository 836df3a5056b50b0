// The command `rom`: a run of the reduced-order model, or with --sensitivity what its answers hang on.
#pragma once

#include "lib/cli/fidelity_command.hpp"

namespace twinchute::rom {

/// `full`: to point to where this model lacks physics that a scene asks for.
Command rom_command(const Fidelity& full, RunReports reports);

}  // namespace twinchute::rom
