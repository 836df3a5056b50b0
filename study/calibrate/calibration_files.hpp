// A calibration for reading, for scripts, and as a scene to go on with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/cli/text.hpp"
#include "study/calibrate/calibration.hpp"

namespace twinchute::study {

std::string calibration_text(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests, const Style& style);

/// docs/schema/calibration.schema.json.
std::string calibration_json(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests);

/// A self-contained page: fit over data, residuals, marginals, bands.
std::string calibration_page(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests);

/// A scene on the calibrated one as its base, with the values found. `directory`: where it will lie.
std::string calibrated_scene(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests, const std::filesystem::path& directory);

}  // namespace twinchute::study
