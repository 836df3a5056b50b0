#include "fullsim/mesh/import_file.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double flattest = 1e-9;  // area of a triangle over its longest edge squared

}  // namespace

ImportFile::ImportFile(const GmshMesh& mesh, const Scene& scene) : mesh_(mesh) {
    sort_by_group(!scene.parachutes.front().reefing.empty());
    for (const GmshElement& e : mesh.elements)
        check_element(e);
    check_duplicates();
}

void ImportFile::refuse(int line, std::string problem, std::string why, std::string hint) const {
    throw SceneError({mesh_.file, line, 1}, "", std::move(problem), std::move(why), std::move(hint));
}

void ImportFile::refuse(const GmshElement& e, std::string_view problem, std::string why,
                        std::string hint) const {
    refuse(e.line, fmt::format("{} {} {}", gmsh_shape(e.corners), e.tag, problem), std::move(why),
           std::move(hint));
}

void ImportFile::sort_by_group(bool reefed) {
    std::vector<std::string_view> known;
    for (const GmshGroupName& g : gmsh_groups)
        known.push_back(g.name);
    std::vector<std::size_t> row_of;  // of GmshMesh::groups
    for (const GmshGroup& g : mesh_.groups) {
        const auto row = std::ranges::find(gmsh_groups, g.name, &GmshGroupName::name);
        if (row == gmsh_groups.end())
            refuse(g.line, fmt::format("unknown group '{}'", g.name),
                   fmt::format("known: {}", fmt::join(known, ", ")),
                   nearest(g.name, known).empty() ? "leave it out of the export" : suggest(g.name, known));
        const bool solid = g.name == "payload" && g.dimension == 3;
        if (row->dimension != g.dimension && !solid)
            refuse(g.line, fmt::format("the group '{}' of dimension {}", g.name, g.dimension),
                   fmt::format("it has dimension {}", row->dimension), "put other elements into it");
        row_of.push_back(static_cast<std::size_t>(row - gmsh_groups.begin()));
    }
    for (const GmshElement& e : mesh_.elements)
        of_[row_of[e.group]].push_back(&e);
    const auto need = [&](GmshGroupIndex group, const char* why) {
        if (!of_[group].empty()) return;
        const bool named = std::ranges::count(row_of, static_cast<std::size_t>(group)) > 0;
        refuse(1,
               fmt::format("the group '{}' {}", gmsh_groups[group].name,
                           named ? "has no elements" : "is missing"),
               why, "name it with Physical ... in Gmsh");
    };
    need(group_canopy, "its triangles are the fabric");
    need(group_line, "its edges are the suspension lines");
    need(group_confluence, "its point is where the payload hangs");
    if (reefed) need(group_reefing, "parachute.reefing holds the mouth together with it");
}

void ImportFile::check_element(const GmshElement& e) const {
    const auto corners = static_cast<std::size_t>(e.corners);
    if (std::set<FileNode>(e.node.begin(), e.node.begin() + e.corners).size() < corners)
        refuse(e, "has the same node twice", "it has no size", "take it out");
    if (e.corners == 1) return;
    const Vec3 &p = position(e.node[0]), &q = position(e.node[1]);
    if (e.corners == 2) {
        if (p == q) refuse(e, "has no length", "both of its nodes lie at the same place", "take it out");
        return;
    }
    const Vec3 a = q - p, b = position(e.node[2]) - p;
    if (e.corners == 4) {
        const double six_volumes = a.cross(b).dot(position(e.node[3]) - p);
        if (!(six_volumes > 0.0))
            refuse(e, six_volumes < 0.0 ? "is inverted" : "has no volume",
                   fmt::format("its volume is {:.3g} m^3", six_volumes / 6.0), "mesh the payload anew");
        return;
    }
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    if (!(0.5 * a.cross(b).norm() > flattest * longest))
        refuse(e, "has no area", "its corners lie on a line", "mesh the canopy anew");
}

void ImportFile::check_duplicates() const {
    // By nodes; a reefing line may lie on a tape.
    using Nodes = std::array<FileNode, 4>;
    std::map<std::pair<bool, Nodes>, const GmshElement*> seen;
    for (const GmshElement& e : mesh_.elements) {
        if (e.corners == 1) continue;
        Nodes nodes{-1, -1, -1, -1};
        std::copy_n(e.node.begin(), e.corners, nodes.begin());
        std::ranges::sort(nodes);
        const bool reefing = mesh_.groups[e.group].name == gmsh_groups[group_reefing].name;
        const auto [other, is_new] = seen.emplace(std::pair{reefing, nodes}, &e);
        if (!is_new)
            refuse(e, fmt::format("lies on {} {}", gmsh_shape(e.corners), other->second->tag),
                   "both have the same nodes", "keep one of the two");
    }
}

}  // namespace twinchute::fullsim
