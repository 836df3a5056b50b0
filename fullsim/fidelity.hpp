// The full model as a row for whoever runs or compares models.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {

/// Explicit finite-element canopy and lines under empirical aerodynamics; named "full".
const Fidelity& full_fidelity();

}  // namespace twinchute::fullsim
