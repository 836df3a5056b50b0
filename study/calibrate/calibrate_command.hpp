// `twinchute calibrate`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/work.hpp"

namespace twinchute::study {

/// Exit code 0 where inputs are fitted, 1 where they are and the tests do not go with the model. `rom`: gives
/// samples.
Command calibrate_command(const Fidelity& rom);

/// Throws UsageError for a scene that cannot be calibrated.
void require_calibratable(const Scene& scene, const Fidelity& rom);

/// Calibrates `scene`, which `scene_with` gives, to tests. `directory`: where the calibrated scene would lie,
/// below whose base it is; nothing: no text of it is made, because the scene is in no file.
StudyWork calibration_work(SceneWith scene_with, Scene scene, std::vector<DropTest> tests,
                           const Fidelity& rom, std::vector<Vary> vary,
                           std::optional<std::filesystem::path> directory);

/// Writes the files of a calibration, all or none, and returns the text of calibration.json. Throws
/// WriteError.
std::string write_calibration(Calibration& calibration, const SceneWith& scene_with, const Scene& scene,
                              const std::vector<DropTest>& tests, const std::filesystem::path& directory);

}  // namespace twinchute::study
