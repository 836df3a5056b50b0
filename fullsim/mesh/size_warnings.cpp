#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

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
