#include "fullsim/forces/registry.hpp"

#include <array>

#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

bool always(const Scene&) {
    return true;
}

constexpr std::array<ForceBlock, 8> blocks{{
    {"membrane", "paper, 2.2; relaxed energy after Pipkin 1986", true, true, true, true, &always,
     [](const Scene& s, const Mesh& m) { return make_membrane(m, s.full.bulk_viscosity); }},
    {"cable", "paper, 2.2 and Eq. 3 (b1)", true, true, true, true, &always,
     [](const Scene& s, const Mesh& m) { return make_cable(m, s.full.bulk_viscosity); }},
    {"canopy pressure", "paper, Eqs 11-12", false, false, true, false, &always,
     [](const Scene& s, const Mesh& m) {
         return make_canopy_pressure(m, smallest_projected_area(s.parachutes.front()));
     }},
    {"line drag", "paper, Eq. 10; Wieselsberger 1922", false, false, true, false,
     [](const Scene& s) { return s.aerodynamics.line_drag.has_value(); },
     [](const Scene&, const Mesh& m) { return make_line_drag(m); }},
    {"breathing damping", "not in the paper; docs/theory/full-model.md", false, true, true, true,
     [](const Scene& s) { return s.aerodynamics.breathing_damping.has_value(); },
     [](const Scene& s, const Mesh& m) {
         return make_breathing_damping(m, *s.aerodynamics.breathing_damping);
     }},
    {"payload drag", "paper, 3.1", false, false, true, false,
     [](const Scene& s) { return s.payload.drag_area.has_value(); },
     [](const Scene& s, const Mesh& m) { return make_payload_drag(m, *s.payload.drag_area); }},
    {"accretion", "momentum balance of the added mass", false, false, true, false,
     [](const Scene& s) {
         const auto& added = s.aerodynamics.added_mass;
         return added && added->momentum == AddedMassMomentum::accreting;
     },
     [](const Scene&, const Mesh& m) { return make_accretion(m); }},
    {"mass damping", "paper, Eq. 4", false, true, true, true,
     [](const Scene& s) { return s.full.alpha > 0.0; },
     [](const Scene& s, const Mesh& m) { return make_mass_damping(m, s.full.alpha); }},
}};

ForceModels make_blocks(const Scene& scene, const Mesh& mesh, bool structural) {
    ForceModels models;
    for (const ForceBlock& block : blocks)
        if (block.structural == structural && block.needed(scene)) models.push_back(block.make(scene, mesh));
    return models;
}

}  // namespace

std::span<const ForceBlock> force_blocks() {
    return blocks;
}

ForceModels make_structure(const Scene& scene, const Mesh& mesh) {
    return make_blocks(scene, mesh, true);
}

ForceModels make_loads(const Scene& scene, const Mesh& mesh) {
    return make_blocks(scene, mesh, false);
}

}  // namespace twinchute::fullsim
