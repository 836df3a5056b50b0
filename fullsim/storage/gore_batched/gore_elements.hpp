// Constants of a gore's elements by kind, as the kernels read them.
#pragma once

#include <vector>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/forces/membrane.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Elements of a stage; kinds that do not act are empty.
struct GoreElements {
    MembraneLaw law;
    std::vector<MembraneElement> membrane;  ///< also where the air alone acts on the fabric
    std::vector<SpringElement> springs;     ///< with deployment resistance
    std::vector<CableElement> tapes, lines;
    std::vector<CableElement> cords;  ///< from the vent to a static line
    std::vector<ContactElement> contacts;
    ForceModels global;  ///< cables that belong to no gore
    bool membranes_act = false, springs_act = false;
};

std::vector<MembraneElement> gore_membranes(const Gores& gores, const MembraneLaw& law);
/// deployment_resistance: [N/m] of width.
std::vector<SpringElement> gore_springs(const Gores& gores, const Fabric& fabric,
                                        const FullSettings& settings, double deployment_resistance);
std::vector<CableElement> gore_cables(const std::vector<GoreCable>& cables, bool (*which)(CableKind),
                                      const Mesh& mesh, const FullSettings& settings);
std::vector<ContactElement> gore_contact_pairs(const Gores& gores, const Mesh& mesh);

}  // namespace twinchute::fullsim
