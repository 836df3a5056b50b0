// A state written into a checkpoint, and read back.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "fullsim/state.hpp"
#include "lib/record/keeper.hpp"

namespace twinchute::fullsim {

/// All of it. What is read back has as many nodes as the state has already.
void keep(Keeper& k, State& state);

void keep(Keeper& k, LargestLoads& loads);

/// SHA-256 of nodes, elements and materials of a mesh, but for what goes while it flies: the static line, and
/// how long a reefing line is.
std::string mesh_digest(const Mesh& mesh);

}  // namespace twinchute::fullsim
