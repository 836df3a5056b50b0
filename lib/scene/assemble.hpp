// From checked values to a Scene, and what has to fit together in it.
#pragma once

#include <filesystem>

#include "lib/scene/line_stretch.hpp"
#include "lib/scene/scene.hpp"
#include "lib/scene/values.hpp"

namespace twinchute {

/// The scene that the values describe, with the materials and tables that they name. Everything but
/// file and sha256 is filled in. Throws SceneError.
Scene assemble_scene(const Values& values);

/// One more parachute of the scene, from values that hold its keys in place of the first one's.
void add_parachute(Scene& scene, const Values& values);

/// Renames the inputs where there are several parachutes: "parachute.mass" becomes "parachute.NAME.mass".
void name_inputs(std::vector<Input>& inputs, const std::string& name);

/// Refuses what no single key can show: a release below the ground, t_i >= t_f, parachutes that wait for each
/// other, ... `values`: those of each parachute, the first one's with the rest of the scene.
/// Throws SceneError at the key that is most likely wrong. What is odd, but not wrong, becomes a warning
/// of the scene.
void check_scene(Scene& scene, const std::vector<Values>& values);

/// The release over ground that is `through_air` in air that moves with `wind` [m/s].
Release carried_by(const Vec3& wind, const Release& through_air);

/// Path of a design or material file. Throws SceneError at the key: not a name, or no such file.
std::filesystem::path data_file(std::string_view folder, const std::string& name, std::string_view key,
                                const SourcePlace& place, const std::filesystem::path& directory);

}  // namespace twinchute
