// Inputs that are fitted: by default, or as --vary asks for them, with their bounds.
#pragma once

#include <vector>

#include "study/calibrate/calibration.hpp"

namespace twinchute::study {

/// Unknowns of the scene's keys first, then a clock for each test that has an unknown one.
/// Throws UsageError: not a number of the scene, no bounds, nothing to fit.
std::vector<Unknown> unknowns_of(const Scene& scene, const std::vector<DropTest>& tests,
                                 const std::vector<Vary>& vary);

/// Values near the start, one for each key, to see what they do to a scene.
std::vector<double> probe_of(const std::vector<Unknown>& unknowns);

}  // namespace twinchute::study
