// `twinchute compare`: one scene, two fidelities, the gap between them.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// Differences in gap.json are candidate minus reference, those that people read reference minus candidate;
/// tolerances are a share of the reference. The rows must outlive the command.
Command compare_command(const Fidelity& reference, const Fidelity& candidate);

}  // namespace twinchute::compare
