// A payload that is a body, hung on the risers of a mesh.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// How the rest of the parachute lies.
enum class Hang {
    as_made,    ///< lines straight, the body along x, y and z
    drawn_out,  ///< the same along Mesh::axis, and stretched by Mesh::line_stretch
    packed      ///< shorter than its risers: the pack lies on the body
};

/// From one point below all risers to a place for each on the body, whose centre of mass takes the payload's
/// node. Risers keep the length that they have, straight to their attachments, and all above moves along the
/// axis as far as that asks for, and across it to above the attachments of a body that has turned already.
/// Risers of an imported body end where its file says; those of a scene's shape go, in the order of their
/// azimuths, to the attachments nearest to where their lines lead, whatever the order of the mesh. Throws
/// SceneError at payload.body.size where risers do not reach, at payload.body.shape where their number does
/// not fit.
void attach_payload(const Scene& scene, Mesh& mesh, Hang hang);

/// Directions of the body's own x, y and z in the world, as it hangs along `axis`.
Eigen::Matrix3d frame_along(const Vec3& axis);

/// Directions at the start: as the release says, otherwise along `axis`.
Eigen::Matrix3d frame_at_start(const Release& release, const Vec3& axis);

}  // namespace twinchute::fullsim
