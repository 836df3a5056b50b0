// The catalogue of canopy types, data/parachutes/types/, and what a type gives to a scene.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lib/models/canopy_type.hpp"
#include "lib/scene/document.hpp"

namespace twinchute {

/// The types in the data, sorted by name.
std::vector<std::string> canopy_type_names(const std::filesystem::path& scene_directory = {});

/// The type of that name. `key` at `place` asks for it; it is looked for beside `directory` first. Throws
/// SceneError: no such type, or its file is not one.
CanopyType read_canopy_type(const std::string& name, std::string_view key, const SourcePlace& place,
                            const std::filesystem::path& directory);

/// Puts what the type of `parachute.type` gives under a scene with its design: drag coefficient, C_x, D_p/D0
/// and n in the middle of their ranges, and the law of growth; with a drag area and no diameter also D0. What
/// the scene or the design gives wins, and a recollection (grade R) gives nothing. Throws SceneError.
void add_canopy_type(Document& document);

}  // namespace twinchute
