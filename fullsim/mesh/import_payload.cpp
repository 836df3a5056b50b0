#include "fullsim/mesh/import_payload.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <iterator>
#include <map>
#include <set>

namespace twinchute::fullsim {
namespace {

/// Its tetrahedra, in one piece that faces hold together.
void import_solid(const ImportFile& file, bool takes_body, ImportedPayload& payload) {
    std::map<FileNode, int> number;
    std::map<std::array<int, 3>, std::size_t> across;  // a face, and the first tetrahedron that has it
    std::vector<const GmshElement*> tetrahedra;
    std::ranges::copy_if(file.elements_of(group_payload), std::back_inserter(tetrahedra),
                         [](const GmshElement* e) { return e->corners == 4; });
    boost::disjoint_sets_with_storage<> pieces(tetrahedra.size());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        std::array<int, 4>& corner = payload.solid.tetrahedron.emplace_back();
        for (std::size_t c = 0; c < 4; ++c) {
            const FileNode i = tetrahedra[t]->node[c];
            const auto [at, is_new] = number.emplace(i, static_cast<int>(payload.solid.node.size()));
            if (is_new) {
                payload.solid.node.push_back(file.position(i));
                payload.solid_node.push_back(i);
            }
            corner[c] = at->second;
        }
        for (std::size_t left_out = 0; left_out < 4; ++left_out) {
            std::array<int, 3> face{};
            for (std::size_t c = 0, k = 0; c < 4; ++c)
                if (c != left_out) face[k++] = corner[c];
            std::ranges::sort(face);
            pieces.union_set(t, across.emplace(face, t).first->second);
        }
    }
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        if (pieces.find_set(t) != pieces.find_set(std::size_t{0}))
            file.refuse(*tetrahedra[t], "belongs to a second piece of the payload",
                        fmt::format("no faces join it to tetrahedron {}", tetrahedra.front()->tag),
                        "make one volume of the payload");
    if (takes_body && tetrahedra.empty())
        file.refuse(1, "the group 'payload' has no tetrahedra",
                    "payload.body.shape = \"mesh\" takes its body from it",
                    "mesh the payload as a volume, or give another shape");
}

/// The node where the payload hangs; of a body those where it does.
void find_confluences(const ImportFile& file, bool takes_body, ImportedPayload& payload) {
    const auto& points = file.elements_of(group_confluence);
    if (points.size() > 1 && !takes_body)
        file.refuse(
            *points[1], "is one more confluence", "the payload hangs at one point",
            "keep one of them; a body of tetrahedra, payload.body.shape = \"mesh\", may hang at several");
    std::set<FileNode> found;
    for (const GmshElement* e : points) {
        if (takes_body && std::ranges::count(payload.solid_node, e->node[0]) == 0)
            file.refuse(*e, "is a confluence off the payload",
                        fmt::format("node {} is on none of its tetrahedra", file.node(e->node[0]).tag),
                        "let risers end at nodes of the payload's mesh");
        found.insert(e->node[0]);
    }
    payload.confluences.assign(found.begin(), found.end());
    for (const FileNode i : found)
        payload.origin += file.position(i) / static_cast<double>(found.size());
    for (const GmshElement* e : file.elements_of(group_payload))
        if (e->corners == 1 && !found.contains(e->node[0]))
            file.refuse(*e, "is a payload away from the confluence", "the payload hangs at that point",
                        "put both on the same node");
    if (!takes_body) return;
    std::set<FileNode> tied;
    for (const GmshElement& e : file.elements())
        if (e.corners == 2) tied.insert(e.node.begin(), e.node.begin() + 2);
    for (const GmshElement* e : points)
        if (!tied.contains(e->node[0]))
            file.refuse(*e, "is a confluence that carries nothing", "neither riser nor line ends there",
                        "take it out, or tie a riser to it");
}

}  // namespace

ImportedPayload import_payload(const ImportFile& file, bool takes_body) {
    ImportedPayload payload;
    import_solid(file, takes_body, payload);
    find_confluences(file, takes_body, payload);
    for (Vec3& x : payload.solid.node)
        x -= payload.origin;
    return payload;
}

}  // namespace twinchute::fullsim
