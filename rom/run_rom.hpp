// One run of the reduced-order model.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

/// From line stretch to the scene's stop condition: initial phase, filling, descent, each its own
/// stage that ends exactly at its time; steady descent and ground are roots.
/// One dimension for a vertical fall, two otherwise (there is no wind to leave the plane).
RunRecord run_rom(const Scene& scene, Run& run);

}  // namespace twinchute::rom
