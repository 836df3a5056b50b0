#include "fullsim/mesh/canopy_edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <map>

namespace twinchute::fullsim {
namespace {

/// Triangles of fabric and gaps, with their elements in the file.
struct Surface {
    std::vector<Triangle> triangles;
    std::vector<const GmshElement*> element;
};

Surface surface_of(const ImportFile& file, const Mesh& mesh) {
    Surface all{mesh.triangles, file.elements_of(group_canopy)};
    const auto& gaps = file.elements_of(group_gap);
    all.triangles.insert(all.triangles.end(), mesh.gaps.begin(), mesh.gaps.end());
    all.element.insert(all.element.end(), gaps.begin(), gaps.end());
    return all;
}

void require_one_piece(const ImportFile& file, const Surface& surface, int canopy_nodes) {
    boost::disjoint_sets_with_storage<> pieces(static_cast<std::size_t>(canopy_nodes));
    const auto piece_of = [&](NodeIndex i) { return pieces.find_set(static_cast<std::size_t>(i)); };
    for (const Triangle& t : surface.triangles)
        for (const NodeIndex i : t.node)
            pieces.union_set(static_cast<std::size_t>(i), static_cast<std::size_t>(t.node[0]));
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        if (piece_of(surface.triangles[t].node[0]) != piece_of(0))
            file.refuse(*surface.element[t], "belongs to a second piece of canopy",
                        "no triangles join it to the first",
                        "make one surface of the canopy; a gap in it is a surface of the group 'gap'");
}

}  // namespace

CanopyEdges::CanopyEdges(const ImportFile& file, const Mesh& mesh, std::span<const FileNode> in_file) {
    const Surface surface = surface_of(file, mesh);
    const auto& element = surface.element;
    struct Sides {
        int there = -1, back = -1;  // triangle that runs along it from the lower node, and to it
    };
    std::map<std::pair<NodeIndex, NodeIndex>, Sides> sides;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c) {
            const auto& node = surface.triangles[t].node;
            const NodeIndex a = node[c], b = node[(c + 1) % 3];
            Sides& s = sides[std::minmax(a, b)];
            int& mine = a < b ? s.there : s.back;
            if (mine >= 0)
                file.refuse(*element[t],
                            fmt::format("turns the other way round than triangle {}", element[mine]->tag),
                            "both run along their common edge in one direction; or three triangles share it",
                            "orient the surface alike everywhere");
            mine = static_cast<int>(t);
        }
    std::vector<NodeIndex> next(mesh.position.size(), -1);
    for (const auto& [edge, s] : sides) {
        all_.insert(edge);
        if (s.there >= 0 && s.back >= 0) continue;
        const auto alone = static_cast<std::size_t>(std::max(s.there, s.back));
        if (alone >= mesh.triangles.size())
            file.refuse(*element[alone], "is a gap at the edge of the canopy",
                        "a gap has fabric on both sides of it", "take it out of the group 'gap'");
        const auto [from, to] = s.there >= 0 ? edge : std::pair{edge.second, edge.first};
        if (next[from] >= 0)
            file.refuse(*element[alone],
                        fmt::format("touches another piece of canopy in node {} alone",
                                    file.node(in_file[static_cast<std::size_t>(from)]).tag),
                        "", "join the pieces along edges");
        next[from] = to;
    }
    require_one_piece(file, surface, mesh.canopy_nodes);
    loop_of_.assign(next.size(), -1);
    for (NodeIndex first = 0; first < mesh.canopy_nodes; ++first) {
        if (next[first] < 0 || loop_of_[first] >= 0) continue;
        std::vector<NodeIndex>& loop = loops_.emplace_back();
        for (NodeIndex i = first; loop_of_[i] < 0; i = next[i]) {
            loop_of_[i] = static_cast<int>(loops_.size()) - 1;
            loop.push_back(i);
        }
    }
}

bool CanopyEdges::on_loop(NodeIndex a, NodeIndex b, int loop) const {
    if (loop < 0 || loop_of(a) != loop || loop_of(b) != loop) return false;
    const std::vector<NodeIndex>& nodes = loops_[static_cast<std::size_t>(loop)];
    const auto at = std::ranges::find(nodes, a);
    const NodeIndex after = at + 1 == nodes.end() ? nodes.front() : *(at + 1);
    const NodeIndex before = at == nodes.begin() ? nodes.back() : *(at - 1);
    return b == after || b == before;
}

}  // namespace twinchute::fullsim
