// Digest of a scene: two scenes with the same digest make the same runs.
#pragma once

#include <string>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// SHA-256 of everything that a run sees of a scene: each key with its effective value, materials, and the
/// rows of tables of air, wind and force. Unlike Scene::sha256, that of a file, it knows what --set, bases
/// and data files did. When checkpoints are made, tolerances and limits of sizing are no part of it.
std::string scene_digest(const Scene& scene);

}  // namespace twinchute
