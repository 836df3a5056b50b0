// The shapes in which an imported parachute starts.
#pragma once

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

/// Draws an imported parachute out along `axis` (payload to apex) as make_gore_mesh does: the canopy folded
/// to a mouth of mouth_area [m^2], all stretched so as to carry `load` [N]. Only a canopy that lies in its
/// file as its canopy_geometry is constructed folds without strain; any other one, unless inflated, throws
/// SceneError at parachute.deploy.by. inflated: a canopy that cannot be folded has the shape of the file,
/// without load.
Mesh line_stretch_configuration(const ImportedMesh& imported, const Scene& scene, const Vec3& axis,
                                double mouth_area, double load, bool inflated);

/// Draws a parachute out along `axis` with its canopy in a given shape: nodes [m], axes as in CanopyNodes.
/// Lines are straight as far as the shortest one allows.
Mesh drawn_out_with(const ImportedMesh& parachute, const std::vector<Vec3>& canopy, const Scene& scene,
                    const Vec3& axis, double load);

}  // namespace twinchute::fullsim
