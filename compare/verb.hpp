// `twinchute compare`: one scene, two fidelities, the gap between them.
#pragma once

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// Differences are candidate minus reference, tolerances a share of the reference. The rows must
/// outlive the verb.
Verb compare_verb(const Fidelity& reference, const Fidelity& candidate);

}  // namespace twinchute::compare
