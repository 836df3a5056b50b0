#include "fullsim/mesh/seam_rings.hpp"

#include <map>
#include <utility>

namespace twinchute::fullsim {

std::vector<std::vector<NodeIndex>> seam_rings_of(const Mesh& mesh, const std::vector<ImportedLine>& lines) {
    std::map<NodeIndex, std::vector<NodeIndex>> along;
    for (const Cable& c : mesh.cables)
        if (c.kind == CableKind::radial) {
            along[c.node[0]].push_back(c.node[1]);
            along[c.node[1]].push_back(c.node[0]);
        }
    std::vector<std::vector<NodeIndex>> chains;
    for (const ImportedLine& line : lines) {
        std::vector<NodeIndex> chain{line.node.front()};
        for (NodeIndex before = -1;;) {
            const auto at = along.find(chain.back());
            if (at == along.end()) return {};
            std::vector<NodeIndex> ahead = at->second;
            std::erase(ahead, before);
            if (ahead.empty()) break;
            if (ahead.size() > 1 || chain.size() > along.size()) return {};
            before = chain.back();
            chain.push_back(ahead.front());
        }
        if (!chains.empty() && chain.size() != chains.front().size()) return {};
        chains.push_back(std::move(chain));
    }
    std::vector<std::vector<NodeIndex>> rings(chains.front().size());
    for (std::size_t r = 0; r < rings.size(); ++r)
        for (const auto& chain : chains)
            rings[r].push_back(chain[chain.size() - 1 - r]);
    return rings;
}

}  // namespace twinchute::fullsim
