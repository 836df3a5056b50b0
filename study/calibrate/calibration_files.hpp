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

/// Whether it is the reduced-order model's calibration to runs of another one, which a table carries: values
/// in the scene would be told to both.
bool is_of_records(const std::vector<DropTest>& tests);

/// parachute.calibration of tests that are all records: factors on the scene's inputs at the conditions of
/// each. Adds notes of what it does not carry. Throws UsageError where nothing is left for it.
std::string calibration_table(Calibration& calibration, const SceneWith& scene_with,
                              const std::vector<DropTest>& tests);
inline constexpr const char* calibration_table_name = "calibration.csv";

/// A scene on the calibrated one as its base, with the values found or the table that carries them.
/// `directory`: where it will lie.
std::string calibrated_scene(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests, const std::filesystem::path& directory);

}  // namespace twinchute::study
