// `twinchute import`: a scene from another program's file.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::exchange {

/// `rom`: flies the imported scene once, to hold it against what the file states.
Command import_command(const Fidelity& rom);

}  // namespace twinchute::exchange
