#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

namespace {

/// Nodes of the canopy that lie on another, as copies of a surface that were never merged leave them.
std::vector<Vec3> coincident_nodes(const Mesh& mesh) {
    constexpr double micrometre = 1e-6;
    std::set<std::array<std::int64_t, 3>> places;
    std::vector<Vec3> found;
    for (const Vec3& x : std::span(mesh.position).first(static_cast<std::size_t>(mesh.canopy_nodes))) {
        const auto place = [&](int k) { return std::llround(x[k] / micrometre); };
        if (!places.insert({place(0), place(1), place(2)}).second) found.push_back(x);
    }
    return found;
}

}  // namespace

std::vector<Warning> size_warnings(const ImportedMesh& imported, const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    const auto total = [&](CableKind kind) {
        double length = 0.0;
        for (const Cable& c : imported.mesh.cables)
            if (c.kind == kind) length += c.rest_length;
        return length;
    };
    const double lines = static_cast<double>(imported.lines.size());
    double line_length = 0.0;
    for (const ImportedLine& line : imported.lines)
        line_length += line.length() / lines;
    double risers = 0.0;
    for (const Cable& c : imported.mesh.cables)
        risers += c.kind == CableKind::riser && std::ranges::count(c.node, imported.mesh.payload()) > 0;
    struct Size {
        const char* key;
        const char* unit;
        double said, meshed;
    };
    const auto diameter = [](double area) { return 2.0 * std::sqrt(area / pi); };
    const double riser_ends = std::max(1.0, risers);
    constexpr double noticeable = 0.005;  // of a size, between mesh and scene
    std::vector<Warning> warnings;
    if (const auto slit = coincident_nodes(imported.mesh); !slit.empty())
        warnings.push_back({fmt::format("{} node{} of the canopy lie{} on another, the first at "
                                        "({:.6g}, {:.6g}, {:.6g}) m",
                                        slit.size(), slit.size() > 1 ? "s" : "", slit.size() > 1 ? "" : "s",
                                        slit.front().x(), slit.front().y(), slit.front().z()),
                            "fabric is not joined there: a slit opens between them",
                            "merge duplicate nodes, unless the slit is meant"});
    for (const Size& s :
         {Size{"parachute.nominal_diameter", " m", chute.nominal_diameter, diameter(imported.nominal_area)},
          Size{"parachute.vent_diameter", " m", chute.vent_diameter, diameter(imported.vent_area)},
          Size{"parachute.gores", "", static_cast<double>(chute.gores), lines},
          Size{"parachute.line_length", " m", chute.line_length, line_length},
          Size{"parachute.riser_length", " m", chute.riser_length, total(CableKind::riser) / riser_ends}})
        if (s.said > 0.0 && std::abs(s.meshed - s.said) > noticeable * s.said)
            warnings.push_back(
                {fmt::format("{} says {:.4g}{}, the mesh has {:.4g}{}", s.key, s.said, s.unit, s.meshed,
                             s.unit),
                 "the full model takes its structure from parachute.mesh, the reduced-order model "
                 "and coefficients take what the scene says",
                 "correct the scene, or the mesh"});
    if (const std::size_t count = imported.payload.tetrahedron.size(); count > 0 && !imported.mesh.body)
        warnings.push_back({fmt::format("{} tetrahedra of the payload are left out", count),
                            scene.payload.body ? "payload.body says another shape"
                                               : "the payload is a point mass at the confluence",
                            "take them with payload.body.shape = \"mesh\", or out of the export"});
    return warnings;
}

}  // namespace twinchute::fullsim
