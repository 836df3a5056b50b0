// Calibrations and campaigns that are asked for as text.
#pragma once

#include <filesystem>
#include <string>

#include "serve/runs.hpp"
#include "serve/scene_text.hpp"

namespace twinchute::serve {

/// A study, and its scene as it is without what varies.
struct AskedStudy {
    Scene scene;
    study::StudyWork work;
};

/// {"text", "set", "files": [{"name", "text"}, ...], "vary": ["KEY=LO..HI", ...]}: the scene, tests as they
/// are in files, and what is fitted. `place`: where the calibrated scene would be saved. Throws BadBody,
/// SceneError and UsageError.
AskedStudy asked_calibration(const std::string& body, const OpenedScene& opened, const Models& models,
                             const std::filesystem::path& place);

/// {"text", "set", "case", "campaign": TOML, "name"}: the scene, and a campaign's file, whose own scene is
/// left aside. Throws BadBody, SceneError and UsageError.
AskedStudy asked_campaign(const std::string& body, const OpenedScene& opened, const Models& models);

}  // namespace twinchute::serve
