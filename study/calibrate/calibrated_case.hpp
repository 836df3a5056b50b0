// Cases of validation that judge one drop by others of the same canopy.
#pragma once

#include "compare/validate/run_suite.hpp"

namespace twinchute::study {

/// Calibrates with `rom`, which outlives it.
compare::Calibrator case_calibrator(const Fidelity& rom);

}  // namespace twinchute::study
