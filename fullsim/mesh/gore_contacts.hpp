// Which nodes of neighbouring gores may not pass each other.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "fullsim/mesh/gores.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// Two nodes of a row that keep their order around the axis of the canopy: the second one has the larger
/// azimuth, counted as the mesh counts gores.
template <class Node>
struct ContactPair {
    std::array<Node, 2> node;
    double stiffness;  ///< K [N/m] of what holds them apart once they would pass
};

/// Of a generated mesh, gore after gore, the same number in each: in every row a gore's two seams, and every
/// node between them with either. So the cloth of a gore stays between the half planes of its seams, where it
/// meets that of the next gore. K: a quarter of the fabric's E t, shared by the pairs that end at a seam on
/// one side. A canopy's pressure strains fabric by a per cent at most, so that nodes pass each other by a few
/// per cent of a gore's width, and twice or half of it changes nothing (docs/theory/full-model.md).
std::vector<ContactPair<NodeIndex>> gore_contacts(const Mesh& mesh);

/// Those of the first gores, in local nodes: `local` has all nodes of these gores and those of the seam after
/// them.
std::vector<ContactPair<LocalNode>> local_contacts(const Mesh& mesh, int gores,
                                                   const std::unordered_map<NodeIndex, LocalNode>& local);

}  // namespace twinchute::fullsim
