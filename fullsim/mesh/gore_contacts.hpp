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

/// Contact pairs of a generated mesh, gore after gore, the same number in each: in every row a gore's two
/// seams, and every node between them with either. The fabric of a gore thereby stays between the half planes
/// of its seams, where it meets that of the next gore. K: a quarter of the fabric's E t, shared by the pairs
/// that end at a seam on one side. A canopy's pressure strains fabric by a per cent at most. Nodes therefore
/// pass each other by a few per cent of a gore's width, and twice or half of K changes nothing
/// (docs/theory/full-model.md).
///
/// visit(pair) for each.
template <class Visit>
void for_each_contact(const Mesh& mesh, Visit&& visit) {
    constexpr double stiffness_share = 0.25;  // of E t
    const Fabric& fabric = mesh.stiffest_fabric();
    const double modulus = fabric.youngs_modulus * fabric.thickness;
    const std::size_t gores = mesh.seam_rings.front().size();
    for (std::size_t gore = 0; gore < gores; ++gore)
        for (const auto& seams : mesh.seam_rings) {
            // A row's nodes are numbered around, the first seam first.
            const int columns = seams[1] - seams[0];
            const NodeIndex seam = seams[gore], next = seams[(gore + 1) % gores];
            const double stiffness = stiffness_share * modulus / columns;
            visit(ContactPair<NodeIndex>{{seam, next}, stiffness});
            for (int column = 1; column < columns; ++column) {
                visit(ContactPair<NodeIndex>{{seam, seam + column}, stiffness});
                visit(ContactPair<NodeIndex>{{seam + column, next}, stiffness});
            }
        }
}

/// All of them.
std::vector<ContactPair<NodeIndex>> gore_contacts(const Mesh& mesh);

/// Contact pairs of the first gores, in local nodes: `local` has all nodes of these gores and those of the
/// seam after them.
std::vector<ContactPair<LocalNode>> local_contacts(const Mesh& mesh, int gores,
                                                   const std::unordered_map<NodeIndex, LocalNode>& local);

}  // namespace twinchute::fullsim
