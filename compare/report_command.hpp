// `twinchute report`: the report of a comparison again, from its records.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// For the directories that compare_command of the same two rows wrote. Nothing is run, the records stay as
/// they are. The rows must outlive the command.
Command report_command(const Fidelity& reference, const Fidelity& candidate);

}  // namespace twinchute::compare
