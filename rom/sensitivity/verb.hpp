// The verb `rom`: a run of the reduced-order model, or with --sensitivity what its answers hang on.
#pragma once

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

/// `full`: to point to where this model lacks physics that a scene asks for.
Verb rom_verb(const Fidelity& full);

}  // namespace twinchute::rom
