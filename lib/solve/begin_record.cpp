#include "lib/scene/scene_id.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

RunRecord begin_record(const Scene& scene, std::string_view fidelity) {
    RunRecord record;
    record.scene = scene_id(scene);
    record.inputs = scene.inputs;
    record.warnings = scene.warnings;
    record.fidelity = fidelity;
    record.provenance = current_provenance();
    return record;
}

}  // namespace twinchute
