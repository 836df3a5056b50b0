#include "fullsim/forces/registry.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/tetrahedra.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {
namespace {

const Deployment& deployment(const Scene& scene) {
    return scene.parachutes.front().deploy;
}

bool always(const Scene&, Stage) {
    return true;
}
std::string every_parachute(const Scene&) {
    return "every parachute has them";
}

/// Why there is no deployment; empty where there is one.
std::string no_deployment(const Scene& scene) {
    if (deployment(scene).starts_packed()) return {};
    return deployment(scene).by == DeployBy::inflated ? "the scene starts with the canopy open"
                                                      : "the scene starts at line stretch";
}
std::string structure(const Scene& scene) {
    return scene.full.structure == Structure::fe ? "full.structure is \"fe\""
                                                 : "full.structure is \"msd-fe\"";
}
std::string way_to_deploy(const Scene& scene) {
    return std::string("parachute.deploy.by is \"").append(deployment_name(deployment(scene).by)) + "\"";
}
/// Reason for a part of the deployment: why there is no deployment, or `otherwise`.
std::string deployed(const Scene& scene, const std::string& otherwise) {
    const std::string none = no_deployment(scene);
    return none.empty() ? otherwise : none;
}
/// Reason that an optional key gives.
std::string given(std::string_view key, bool is_given) {
    return std::string(key) + (is_given ? " is given" : " is absent");
}
std::string strength(std::string_view key, double value) {
    return std::string(key) + (value > 0.0 ? " is above zero" : " is zero");
}

constexpr std::array<ForceBlock, block_count> blocks{{
    {Block::membrane, "membrane", "paper, 2.2; relaxed energy after Pipkin 1986", true, true, true, true,
     false, false,
     [](const Scene& s, Stage stage) {
         return s.full.structure == Structure::fe || stage == Stage::ramp || stage == Stage::flight;
     },
     [](const Scene& s) {
         return deployment(s).starts_packed() ? structure(s) : "fabric carries the canopy";
     },
     [](const Scene& s, const Mesh& m) { return make_membrane(m, s.full.bulk_viscosity); }},
    {Block::fabric_springs, "fabric springs", "paper, 2.1, Eqs 2-3", true, true, true, true, false, false,
     [](const Scene& s, Stage stage) {
         return s.full.structure == Structure::msd_fe && stage != Stage::flight;
     },
     [](const Scene& s) { return deployed(s, structure(s)); },
     [](const Scene& s, const Mesh& m) {
         return make_fabric_springs(m, deployment(s).compressive_stiffness_ratio, s.full.bulk_viscosity,
                                    s.full.beta);
     }},
    {Block::tapes, "tapes", "paper, 2.2 and Eq. 3", true, true, true, true, false, false, &always,
     &every_parachute,
     [](const Scene& s, const Mesh& m) { return make_tapes(m, s.full.bulk_viscosity, s.full.beta); }},
    {Block::lines, "lines", "paper, 2.2 and Eq. 3", true, true, true, true, false, true, &always,
     &every_parachute,
     [](const Scene& s, const Mesh& m) { return make_lines(m, s.full.bulk_viscosity, s.full.beta); }},
    {Block::static_line, "static line", "paper, 5.2", true, true, true, true, false, false,
     [](const Scene& s, Stage stage) {
         return deployment(s).by == DeployBy::static_line && stage == Stage::deployment;
     },
     [](const Scene& s) { return deployed(s, way_to_deploy(s)); },
     [](const Scene& s, const Mesh& m) { return make_static_line(m, s.full.bulk_viscosity, s.full.beta); }},
    {Block::gore_contact, "gore contact", "not in the paper; docs/theory/full-model.md", true, true, true,
     false, false, false,
     [](const Scene& s, Stage stage) {
         return s.full.contact == Contact::gores && stage != Stage::deployment;
     },
     [](const Scene& s) {
         return std::string("full.contact is ") + (s.full.contact == Contact::gores ? "\"gores\""
                                                   : s.full.contact == Contact::self
                                                       ? "\"self\": all fabric, not only neighbouring gores"
                                                       : "\"none\": fabric passes through fabric");
     },
     [](const Scene&, const Mesh& m) { return make_gore_contact(m); }},
    {Block::self_contact, "self-contact", "not in the paper; docs/theory/full-model.md", true, true, true,
     true, false, false,
     [](const Scene& s, Stage stage) {
         return s.full.contact == Contact::self && stage != Stage::deployment;
     },
     [](const Scene& s) {
         return std::string("full.contact is ") + (s.full.contact == Contact::self ? "\"self\""
                                                   : s.full.contact == Contact::gores
                                                       ? "\"gores\": neighbouring gores alone"
                                                       : "\"none\": fabric passes through fabric");
     },
     [](const Scene& s, const Mesh& m) { return make_self_contact(m, s.full.contact_friction); }},
    {Block::payload_tetrahedra, "payload tetrahedra", "paper, 2.2; Bonet and Wood 2008, 6.4.3", true, true,
     true, true, false, false,
     [](const Scene& s, Stage) { return s.payload.body && s.payload.body->elasticity; },
     [](const Scene& s) {
         if (!s.payload.body) return given("payload.body", false);
         return s.payload.body->elasticity
                    ? given("payload.body.elasticity", true)
                    : std::string("payload.body.elasticity is absent: they are lumped into a rigid body");
     },
     [](const Scene& s, const Mesh& m) {
         return make_tetrahedra(m.body->solid, solid_law(s, *m.body), m.first_attachment());
     }},
    {Block::canopy_pressure, "canopy pressure", "paper, Eqs 11-12", false, false, true, false, false, false,
     [](const Scene&, Stage stage) { return stage != Stage::deployment; },
     [](const Scene&) { return std::string("air fills the canopy from snatch on"); },
     [](const Scene& s, const Mesh& m) {
         if (const auto inflow = InflowBalance::of(s, m)) return make_inflow_pressure(m, *inflow);
         return make_canopy_pressure(m, smallest_projected_area(s.parachutes.front()));
     }},
    {Block::fabric_drag, "fabric drag", "paper, 3.2.1, Eqs 11-12 with phi = 0", false, false, true, false,
     false, false,
     [](const Scene& s, Stage stage) {
         return stage == Stage::deployment && deployment(s).drag_coefficient > 0.0;
     },
     [](const Scene& s) {
         return deployed(s, strength("parachute.deploy.drag_coefficient", deployment(s).drag_coefficient));
     },
     [](const Scene& s, const Mesh& m) { return make_fabric_drag(m, fabric_drag_coefficient(s)); }},
    {Block::deployment_resistance, "deployment resistance", "paper, 5.2; docs/theory/deployment.md", false,
     true, true, true, false, false,
     [](const Scene& s, Stage stage) {
         return stage == Stage::deployment && deployment(s).deployment_resistance > 0.0;
     },
     [](const Scene& s) {
         return deployed(
             s, strength("parachute.deploy.deployment_resistance", deployment(s).deployment_resistance));
     },
     [](const Scene& s, const Mesh& m) {
         return make_deployment_resistance(m, deployment(s).deployment_resistance);
     }},
    {Block::extraction, "extraction", "paper, 2.1", false, false, false, false, true, false,
     [](const Scene& s, Stage stage) { return stage == Stage::deployment && deployment(s).is_extracted(); },
     [](const Scene& s) { return deployed(s, way_to_deploy(s)); },
     [](const Scene& s, const Mesh& m) { return make_extraction(m, deployment(s).extraction_on_apex); }},
    {Block::line_drag, "line drag", "paper, Eq. 10; Wieselsberger 1922", false, false, true, false, false,
     false, [](const Scene& s, Stage) { return s.aerodynamics.line_drag.has_value(); },
     [](const Scene& s) { return given("aerodynamics.line_drag", s.aerodynamics.line_drag.has_value()); },
     [](const Scene&, const Mesh& m) { return make_line_drag(m); }},
    {Block::breathing_damping, "breathing damping", "not in the paper; docs/theory/full-model.md", false,
     true, true, true, false, false,
     [](const Scene& s, Stage stage) {
         return s.aerodynamics.breathing_damping.has_value() && stage != Stage::deployment;
     },
     [](const Scene& s) {
         return given("aerodynamics.breathing_damping", s.aerodynamics.breathing_damping.has_value());
     },
     [](const Scene& s, const Mesh& m) {
         return make_breathing_damping(
             m, *s.aerodynamics.breathing_damping * (1.0 - slot_share(s.parachutes.front())));
     }},
    {Block::payload_drag, "payload drag", "paper, 3.1", false, false, true, false, false, false,
     [](const Scene& s, Stage) { return s.payload.drag_area.has_value(); },
     [](const Scene& s) { return given("payload.drag_area", s.payload.drag_area.has_value()); },
     [](const Scene& s, const Mesh& m) {
         const auto& table = s.payload.drag_area_table;
         return table && m.body ? make_attitude_drag(m, *table) : make_payload_drag(m, *s.payload.drag_area);
     }},
    {Block::accretion, "accretion", "momentum balance of the added mass", false, false, true, false, false,
     false,
     [](const Scene& s, Stage stage) {
         const auto& added = s.aerodynamics.added_mass;
         return added && added->momentum == AddedMassMomentum::accreting && stage != Stage::deployment;
     },
     [](const Scene& s) {
         const auto& added = s.aerodynamics.added_mass;
         if (!added) return given("aerodynamics.added_mass", false);
         return std::string("aerodynamics.added_mass.momentum is ") +
                (added->momentum == AddedMassMomentum::accreting ? "\"accreting\"" : "\"inertia-only\"");
     },
     [](const Scene&, const Mesh& m) { return make_accretion(m); }},
    {Block::mass_damping, "mass damping", "paper, Eq. 4", false, true, true, true, false, false,
     [](const Scene& s, Stage stage) {
         return s.full.alpha > 0.0 && (s.full.alpha_from_release || stage != Stage::deployment);
     },
     [](const Scene& s) { return strength("full.alpha", s.full.alpha); },
     [](const Scene& s, const Mesh& m) { return make_mass_damping(m, s.full.alpha); }},
}};

constexpr bool in_order_of_blocks() {
    for (int i = 0; i < block_count; ++i)
        if (blocks[i].block != static_cast<Block>(i)) return false;
    return true;
}
static_assert(in_order_of_blocks());

ForceModels make_blocks(const Scene& scene, const Mesh& mesh, Stage stage, bool structural,
                        std::span<const ForceBlock> from) {
    ForceModels models;
    for (const ForceBlock& block : from)
        if (block.structural == structural && block.needed(scene, stage))
            models.push_back(block.make(scene, mesh));
    return models;
}

}  // namespace

std::span<const ForceBlock> force_blocks() {
    return blocks;
}

const ForceBlock& force_block(Block block) {
    return blocks[static_cast<std::size_t>(block)];
}

std::string_view block_name(Block block) {
    return force_block(block).name;
}

std::vector<Stage> stages_of(const Scene& scene) {
    if (!deployment(scene).starts_packed()) return {Stage::flight};
    if (scene.full.structure == Structure::fe) return {Stage::deployment, Stage::flight};
    return {Stage::deployment, Stage::springs, Stage::ramp, Stage::flight};
}

std::vector<Stage> stages_with(const ForceBlock& block, const Scene& scene) {
    std::vector<Stage> stages = stages_of(scene);
    std::erase_if(stages, [&](Stage stage) { return !block.needed(scene, stage); });
    return stages;
}

ForceModels make_structure(const Scene& scene, const Mesh& mesh, Stage stage,
                           std::span<const ForceBlock> from) {
    return make_blocks(scene, mesh, stage, true, from);
}

ForceModels make_loads(const Scene& scene, const Mesh& mesh, Stage stage, std::span<const ForceBlock> from) {
    return make_blocks(scene, mesh, stage, false, from);
}

}  // namespace twinchute::fullsim
