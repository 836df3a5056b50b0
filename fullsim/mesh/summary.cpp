#include "fullsim/mesh/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::fullsim {

Vec3 bounding_size(const Mesh& mesh) {
    Vec3 low = mesh.position.front(), high = low;
    for (const Vec3& x : mesh.position) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    return high - low;
}

MeshSummary summarise(const Mesh& mesh) {
    MeshSummary s;
    s.nodes = mesh.node_count();
    s.triangles = mesh.triangles.size();
    s.fabric_area = mesh.fabric_area();
    s.gap_area = mesh.gap_area();
    s.fabric_mass = mesh.fabric_mass();
    s.total_mass = mesh.parachute_mass();
    s.smallest_edge = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles)
        s.smallest_edge = std::min({s.smallest_edge, t.a, std::hypot(t.b, t.c), std::hypot(t.b - t.a, t.c)});
    for (std::size_t i = 0; i < mesh.cables.size(); ++i) {
        const Cable& c = mesh.cables[i];
        const auto kind = static_cast<std::size_t>(c.kind);
        ++(std::ranges::binary_search(mesh.reefing_line, i) ? s.reefing_line : s.cables[kind]);
        s.cable_mass[kind] += mesh.cable_mass(i);
        s.smallest_edge = std::min(s.smallest_edge, c.rest_length);
    }
    return s;
}

}  // namespace twinchute::fullsim
