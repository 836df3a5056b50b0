// `twinchute report`: the report of a comparison again, from its records.
#pragma once

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// For the directories that compare_verb of the same two rows wrote. Nothing is run, the records stay as they
/// are. The rows must outlive the verb.
Verb report_verb(const Fidelity& reference, const Fidelity& candidate);

}  // namespace twinchute::compare
