#include "fullsim/storage/gore_batched/gore_elements.hpp"

#include <unordered_map>

#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {

std::vector<MembraneElement> gore_membranes(const Gores& gores, const MembraneLaw& law) {
    std::vector<MembraneElement> elements;
    elements.reserve(gores.triangles.size());
    for (const GoreTriangle& t : gores.triangles)
        elements.push_back({{t.node[0], t.node[1], t.node[2]},
                            1.0 / t.a,
                            1.0 / t.c,
                            t.b / t.a,
                            0.5 * t.a * t.c,
                            law.viscosity * element_length({{}, 0, t.a, t.b, t.c})});
    return elements;
}

std::vector<SpringElement> gore_springs(const Gores& gores, const Fabric& fabric,
                                        const FullSettings& settings, double deployment_resistance) {
    std::vector<SpringElement> elements;
    for (const GoreEdge& e : gores.edges) {
        const SpringConstants k = fabric_spring_constants(fabric, e, settings.bulk_viscosity, settings.beta);
        elements.push_back({{e.node[0], e.node[1]},
                            k.inverse_length,
                            k.stiffness,
                            k.hardening,
                            k.dashpot,
                            fold_force(fabric, e, deployment_resistance)});
    }
    return elements;
}

std::vector<CableElement> gore_cables(const std::vector<GoreCable>& cables, bool (*which)(CableKind),
                                      const Mesh& mesh, const FullSettings& settings) {
    std::vector<CableElement> elements;
    for (const GoreCable& c : cables) {
        if (!which(c.kind)) continue;
        const Cable as_in_mesh{{c.node[0], c.node[1]}, c.rest_length, c.strands, c.kind};
        const CableConstants k = cable_constants(mesh, as_in_mesh, settings.bulk_viscosity, settings.beta);
        elements.push_back({{c.node[0], c.node[1]}, 1.0 / c.rest_length, k.stiffness, k.dashpot});
    }
    return elements;
}

std::vector<ContactElement> gore_contact_pairs(const Gores& gores, const Mesh& mesh) {
    std::unordered_map<NodeIndex, LocalNode> local;
    for (LocalNode n = 0; n < gores.own; ++n)
        local.emplace(gores.node[n], n);
    for (std::size_t k = 0; k < gores.neighbour.size(); ++k)
        local.emplace(gores.node[gores.own + gores.neighbour[k]], gores.own + static_cast<LocalNode>(k));
    std::vector<ContactElement> elements;
    for (const auto& [node, stiffness] : local_contacts(mesh, 1, local))
        elements.push_back({{node[0], node[1]}, stiffness});
    return elements;
}

}  // namespace twinchute::fullsim
