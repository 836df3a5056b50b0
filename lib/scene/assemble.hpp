// From checked values to a Scene, and what has to fit together in it.
#pragma once

#include <filesystem>

#include "lib/scene/scene.hpp"
#include "lib/scene/values.hpp"

namespace twinchute {

/// The scene that the values describe, with the materials that they name (looked for from
/// `directory`). Everything but file and sha256 is filled in. Throws SceneError.
Scene assemble_scene(const Values& values, const std::filesystem::path& directory);

/// Refuses what no single key can show: a release below the ground, t_i >= t_f, ...
/// Throws SceneError at the key that is most likely wrong.
void check_scene(const Scene& scene, const Values& values);

/// Path of a design or material file. Throws SceneError at the key: not a name, or no such file.
std::filesystem::path data_file(std::string_view folder, const std::string& name, std::string_view key,
                                const SourcePlace& place, const std::filesystem::path& directory);

}  // namespace twinchute
