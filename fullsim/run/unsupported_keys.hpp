// What a scene asks for that the full model lacks.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Keys of physics that this model lacks, and keys that its structure needs; those of one of several
/// parachutes with its name. Throws SceneError where canopies have no place as the scene begins.
std::vector<std::string> unsupported_keys(const Scene& scene);

}  // namespace twinchute::fullsim
