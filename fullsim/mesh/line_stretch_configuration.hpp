// The shapes in which an imported parachute starts.
#pragma once

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

/// As make_gore_mesh: drawn out along `axis` (payload to apex), the canopy folded to a mouth of mouth_area
/// [m^2], all stretched so as to carry `load` [N]. Only canopies that lie flat in their file fold without
/// strain, along seams at equal angles; where they do not, and inflated is false, throws SceneError at
/// parachute.deploy.by.
/// inflated: a canopy that does not lie flat has the shape of the file, without load.
Mesh line_stretch_configuration(const ImportedMesh& imported, const Scene& scene, const Vec3& axis,
                                double mouth_area, double load, bool inflated);

}  // namespace twinchute::fullsim
