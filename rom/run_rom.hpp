// One run of the reduced-order model.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

/// From line stretch to the scene's stop condition: initial phase, filling, descent, each its own
/// stage that ends exactly at its time; steady descent and ground are roots.
/// One dimension for a vertical fall in still air, two for any other in still air, three with wind.
RunRecord run_rom(const Scene& scene, Run& run);

}  // namespace twinchute::rom
