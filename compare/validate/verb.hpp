// The verb that runs the suites of validation.
#pragma once

#include <vector>

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// `twinchute validate`. The fidelities outlive the verb.
Verb validate_verb(std::vector<const Fidelity*> fidelities);

}  // namespace twinchute::compare
