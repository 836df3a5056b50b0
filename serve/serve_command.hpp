// `twinchute serve`: a page to work in, on this machine alone.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::serve {

/// The rows must outlive the command.
Command serve_command(const Fidelity& full, const Fidelity& rom);

}  // namespace twinchute::serve
