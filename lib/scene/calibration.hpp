// A scene as a calibrated model sees it: inputs of an opening times the factors of parachute.calibration.
#pragma once

#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute {

DropConditions drop_conditions(const Scene& scene);

/// The number that a key of calibrated_keys() stands for; null where the parachute does not use it. Of a drag
/// area what is stated, before corrections.
const double* calibrated_input(const Parachute& chute, std::string_view key);

/// The parachute with its inputs times the factors of its table, which it has. Corrections of its drag area
/// stay what they are.
Parachute calibrated(const Parachute& chute, const DropConditions& at);

/// Factors on inputs of the scene's parachutes at its own conditions.
std::vector<CalibratedInput> calibrated_inputs(const Scene& scene);

bool has_calibration(const Scene& scene);

/// The scene with calibrated parachutes and without their tables. Its `inputs` say so, and warnings where its
/// conditions lie outside of a table's.
Scene calibrated(const Scene& scene);

/// This scene as if nothing had been calibrated.
Scene uncalibrated(const Scene& scene);

}  // namespace twinchute
