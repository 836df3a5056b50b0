// Rings of nodes across the seams of an imported canopy.
#pragma once

#include <vector>

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

/// Mesh::seam_rings, from vent to skirt, where radial tapes lead up from every line in as many steps; empty
/// where they do not.
std::vector<std::vector<NodeIndex>> seam_rings_of(const Mesh& mesh, const std::vector<ImportedLine>& lines);

}  // namespace twinchute::fullsim
