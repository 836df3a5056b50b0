// How records and reports name the scene that they are of.
#pragma once

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// Its file without directories: those are of one machine, and the SHA-256 tells files of one name apart.
inline SceneId scene_id(const Scene& scene) {
    return {scene.name, scene.file.filename().string(), scene.sha256};
}

}  // namespace twinchute
