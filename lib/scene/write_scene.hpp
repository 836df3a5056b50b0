// From a Scene back to the text of a scene file.
#pragma once

#include <string>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// The scene as TOML, every key written out, numbers in SI and to the last bit: read_scene_text makes an
/// equal scene of it (see same_scene) where it finds the same data. Materials and tables are written
/// by name; designs, bases and cases have been resolved.
std::string write_scene(const Scene& scene);

/// Equal in everything that a solver or a comparison sees: all but file, sha256, the name of the case, and
/// the lists of inputs and warnings, which say where values came from.
bool same_scene(const Scene& a, const Scene& b);

}  // namespace twinchute
