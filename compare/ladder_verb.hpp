// `twinchute ladder`: error against run time for one scene, from closed forms to the finest mesh.
#pragma once

#include <vector>

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// The levels of these fidelities, the cheapest first. The rows must outlive the verb.
Verb ladder_verb(std::vector<const Fidelity*> fidelities);

}  // namespace twinchute::compare
