#include "fullsim/mesh/mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace twinchute::fullsim {

Triangle laid_flat(const std::array<NodeIndex, 3>& node, const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const double a = e1.norm();
    return {node, 0, a, e1.dot(e2) / a, e1.cross(e2).norm() / a};
}

std::string_view cable_kind_name(CableKind kind) {
    constexpr std::array<std::string_view, 7> names{"radial tape", "skirt band",  "vent band", "line",
                                                    "riser",       "static line", "vent line"};
    return names[static_cast<std::size_t>(kind)];
}

std::vector<Vec3> BodyMesh::attachments() const {
    if (deformable) return solid.node;
    std::vector<Vec3> ends;
    for (const int i : end)
        ends.push_back(solid.node[static_cast<std::size_t>(i)]);
    return ends;
}

double Mesh::parachute_mass() const {
    double total = 0.0;
    for (const Triangle& t : triangles)
        total += fabric_of(t.sheet).density * fabric_of(t.sheet).thickness * t.area();
    for (std::size_t i = 0; i < cables.size(); ++i)
        total += cable_mass(i);
    return total;
}

double Mesh::cable_mass(std::size_t index) const {
    if (std::ranges::binary_search(reefing_line, index)) return 0.0;
    const Cable& c = cables[index];
    return cord(c.kind).linear_density() * c.strands * c.rest_length;
}

namespace {

double area_of(const std::vector<Triangle>& surface) {
    return std::accumulate(surface.begin(), surface.end(), 0.0,
                           [](double sum, const Triangle& t) { return sum + t.area(); });
}

}  // namespace

double Mesh::fabric_area() const {
    return area_of(triangles);
}

double Mesh::gap_area() const {
    return area_of(gaps);
}

double Mesh::fabric_mass() const {
    double total = 0.0;
    for (int sheet = 0; sheet < sheets(); ++sheet) {
        double area = 0.0;
        for (const Triangle& t : triangles)
            if (t.sheet == sheet) area += t.area();
        total += fabric_of(sheet).density * fabric_of(sheet).thickness * area;
    }
    return total;
}

const Fabric& Mesh::stiffest_fabric() const {
    const Fabric* most = &fabric;
    for (const Fabric& other : other_fabrics)
        if (other.youngs_modulus * other.thickness > most->youngs_modulus * most->thickness) most = &other;
    return *most;
}

int sheet_of(Mesh& mesh, const Fabric& fabric) {
    if (mesh.fabric == Fabric{}) mesh.fabric = fabric;
    for (int sheet = 0; sheet < mesh.sheets(); ++sheet)
        if (mesh.fabric_of(sheet) == fabric) return sheet;
    mesh.other_fabrics.push_back(fabric);
    return mesh.sheets() - 1;
}

void lump_masses(Mesh& mesh, double payload_mass) {
    mesh.mass.assign(mesh.position.size(), 0.0);
    mesh.tributary_area.assign(mesh.position.size(), 0.0);
    for (const Triangle& t : mesh.triangles)
        for (const NodeIndex i : t.node) {
            mesh.tributary_area[i] += t.area() / 3.0;
            mesh.mass[i] +=
                mesh.fabric_of(t.sheet).density * mesh.fabric_of(t.sheet).thickness * t.area() / 3.0;
        }
    for (std::size_t c = 0; c < mesh.cables.size(); ++c)
        for (const NodeIndex i : mesh.cables[c].node)
            mesh.mass[std::min(i, mesh.payload())] += 0.5 * mesh.cable_mass(c);
    mesh.mass[mesh.payload()] += payload_mass;
    // Fabric has no other nodes.
    mesh.tributary_area.resize(mesh.canopy_nodes);
    mesh.tributary_area.shrink_to_fit();
}

}  // namespace twinchute::fullsim
