#include "fullsim/mesh/mesh.hpp"

#include <numeric>

namespace twinchute::fullsim {

std::string_view cable_kind_name(CableKind kind) {
    constexpr std::array<std::string_view, 6> names{"radial tape", "skirt band", "vent band",
                                                    "line",        "riser",      "static line"};
    return names[static_cast<std::size_t>(kind)];
}

double Mesh::parachute_mass() const {
    double total = 0.0;
    for (const Triangle& t : triangles)
        total += fabric.density * fabric.thickness * t.area();
    for (const Cable& c : cables)
        total += cord(c.kind).linear_density() * c.strands * c.rest_length;
    return total;
}

double Mesh::fabric_area() const {
    return std::accumulate(triangles.begin(), triangles.end(), 0.0,
                           [](double sum, const Triangle& t) { return sum + t.area(); });
}

void lump_masses(Mesh& mesh, double payload_mass) {
    mesh.mass.assign(mesh.position.size(), 0.0);
    mesh.tributary_area.assign(mesh.position.size(), 0.0);
    for (const Triangle& t : mesh.triangles)
        for (const NodeIndex i : t.node) {
            mesh.tributary_area[i] += t.area() / 3.0;
            mesh.mass[i] += mesh.fabric.density * mesh.fabric.thickness * t.area() / 3.0;
        }
    for (const Cable& c : mesh.cables)
        for (const NodeIndex i : c.node)
            mesh.mass[i] += 0.5 * mesh.cord(c.kind).linear_density() * c.strands * c.rest_length;
    mesh.mass[mesh.payload()] += payload_mass;
}

}  // namespace twinchute::fullsim
