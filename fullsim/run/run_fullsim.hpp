// One run of the full aeroelastic model.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {

/// From line stretch to the scene's stop condition, with finite-element cables and membranes under
/// empirical aerodynamics (paper, sections 2 to 4).
RunRecord run_fullsim(const Scene& scene, Run& run);

}  // namespace twinchute::fullsim
