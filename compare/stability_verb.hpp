// `twinchute stability`: stiff and extreme cases, one verdict each.
#pragma once

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

Verb stability_verb(const Fidelity& full, const Fidelity& rom);

}  // namespace twinchute::compare
