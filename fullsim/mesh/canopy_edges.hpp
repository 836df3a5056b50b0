// Edges of an imported canopy: between triangles, and around skirt and openings.
#pragma once

#include <set>
#include <span>
#include <utility>
#include <vector>

#include "fullsim/mesh/import_file.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

class CanopyEdges {
public:
    /// mesh: its triangles, and those of its gaps, are those of the file, in the same order. in_file: node of
    /// the file by node of the mesh. Gaps join pieces of fabric to one surface. Throws SceneError: triangles
    /// that turn differently, pieces that do not share edges.
    CanopyEdges(const ImportFile& file, const Mesh& mesh, std::span<const FileNode> in_file);

    bool contains(NodeIndex a, NodeIndex b) const { return all_.contains(std::minmax(a, b)); }
    /// Closed chains of nodes around skirt and openings, in the direction of their triangles.
    const std::vector<std::vector<NodeIndex>>& loops() const { return loops_; }
    /// Index of the loop that a node is on; -1: none.
    int loop_of(NodeIndex i) const { return loop_of_[static_cast<std::size_t>(i)]; }
    /// Neighbours on a loop; false for an edge across a narrow strip of fabric.
    bool on_loop(NodeIndex a, NodeIndex b, int loop) const;

private:
    std::set<std::pair<NodeIndex, NodeIndex>> all_;  // the lower node first
    std::vector<std::vector<NodeIndex>> loops_;
    std::vector<int> loop_of_;
};

}  // namespace twinchute::fullsim
