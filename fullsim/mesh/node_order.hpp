// Order in which the nodes of an imported canopy are numbered. Forces gather them by elements: neighbours
// whose numbers lie far apart lie far apart in memory.
#pragma once

#include <vector>

#include "fullsim/mesh/import_file.hpp"

namespace twinchute::fullsim {

/// `nodes` of a canopy in the order of the file; or, where neighbours are more than an eighth of all numbers
/// apart in the mean of all edges (a third at random), by reverse Cuthill-McKee, if that brings them twice as
/// near.
std::vector<FileNode> canopy_order(const ImportFile& file, std::vector<FileNode> nodes);

}  // namespace twinchute::fullsim
