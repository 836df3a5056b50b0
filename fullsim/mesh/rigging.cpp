#include "fullsim/mesh/rigging.hpp"

namespace twinchute::fullsim {

void add_chain(Mesh& mesh, NodeIndex from, NodeIndex to, const Vec3& end, double length, int elements,
               CableKind kind, double strands) {
    const Vec3 start = mesh.position[static_cast<std::size_t>(from)];
    for (int k = 1; k <= elements; ++k) {
        const NodeIndex next = k < elements ? mesh.node_count() : to;
        if (k < elements) mesh.position.push_back(start + (end - start) * k / static_cast<double>(elements));
        mesh.cables.push_back({{from, next}, length / elements, strands, kind});
        from = next;
    }
}

void hang_risers(Mesh& mesh, const Parachute& chute, const MeshCounts& counts, const Vec3& link_place,
                 double strands) {
    const NodeIndex first_link = mesh.node_count();
    mesh.position.insert(mesh.position.end(), static_cast<std::size_t>(chute.risers), link_place);
    // The payload is the last node: its number is known before it is placed.
    const NodeIndex payload = mesh.node_count() + chute.risers * (counts.riser_elements - 1);
    for (int r = 0; r < chute.risers; ++r)
        add_chain(mesh, first_link + r, payload, Vec3::Zero(), chute.riser_length, counts.riser_elements,
                  CableKind::riser, strands);
    mesh.position.push_back(Vec3::Zero());
}

}  // namespace twinchute::fullsim
