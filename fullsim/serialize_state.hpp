// A state written into a checkpoint, and read back.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"

namespace twinchute::fullsim {

/// Writes or reads the whole state; one that is read has to have as many nodes as `state`.
void serialize(Archive& archive, State& state);

void serialize(Archive& archive, LargestLoads& loads);

/// SHA-256 of nodes, elements and materials of a mesh, but for what goes while it flies: the static line, and
/// how long a reefing line is.
std::string mesh_digest(const Mesh& mesh);

}  // namespace twinchute::fullsim
