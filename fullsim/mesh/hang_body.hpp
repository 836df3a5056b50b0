// A payload that is a body, hung on the risers of a mesh.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// From one point below all risers to a place for each on the body, whose centre of mass takes the payload's
/// node. Risers keep the length that they have, straight to their places, and all above moves along the axis
/// as far as that asks for; of a pack, which is shorter than its risers, the pack lies on the body. Places
/// go to risers in the order of the mesh. Throws SceneError at payload.body.size where risers do not reach,
/// or are none.
void hang_body(const Scene& scene, Mesh& mesh);

}  // namespace twinchute::fullsim
