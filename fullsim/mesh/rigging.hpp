// Lines and risers of generated meshes.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Adds a chain of equal cables along a straight line, from a node to the node `to` at `end`, and the nodes
/// between them.
void add_chain(Mesh& mesh, NodeIndex from, NodeIndex to, const Vec3& end, double length, int elements,
               CableKind kind, double strands);

/// Adds the links, the next nodes, at their place and a riser of so many strands from each to the payload,
/// the last node, at the origin.
void hang_risers(Mesh& mesh, const Parachute& chute, const MeshCounts& counts, const Vec3& link_place,
                 double strands);

}  // namespace twinchute::fullsim
