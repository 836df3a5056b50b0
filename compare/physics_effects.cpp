#include "compare/physics_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/assemble.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::compare {
namespace {

/// Stiffness of lines that stand for rigid ones. Ten times as stiff they stretch by a thousandth, and a run
/// costs at most twice as much; thirty times changes the peak of the demo by another 0.04 %
/// (docs/guide/gap.md).
constexpr double stiffer = 10.0;
/// k_b that stands for a canopy that does not breathe. None at all would leave nothing but breathing.
constexpr double stifled = 2.0;

const Parachute& chute(const Scene& scene) {
    return scene.parachutes.front();
}

/// One sector may stand for all where nothing makes sectors differ; the reader of scenes refuses the rest.
bool may_be_a_sector(const Scene& scene) {
    const Vec3 velocity = velocity_over_ground(scene.release);
    return scene.full.symmetry == Symmetry::none && !chute(scene).deploy.starts_packed() &&
           !scene.full.noise && !scene.environment.wind && velocity.z() <= 0.0 &&
           std::hypot(velocity.x(), velocity.y()) <= 1e-9 * velocity.norm();
}

bool has_initial_phase(const Scene& scene) {
    const InitialPhase& phase = chute(scene).initial_phase;
    return chute(scene).deploy.by != DeployBy::inflated && (phase.transit || phase.seconds > 0.0);
}

/// The release through the air stays what it was.
void still_air(Scene& scene) {
    scene.release = carried_by(-scene.environment.wind->at(scene.release.altitude), scene.release);
    scene.environment.wind.reset();
}

/// The filling of the demo, the same for both models.
void prescribe_filling(Scene& scene) {
    Parachute& parachute = scene.parachutes.front();
    parachute.filling = {};
    parachute.fill_time = {find_fill_time("fill-constant"), 4.0, 0.0, 0.0};
    parachute.drag_area_law = find_drag_area_law("ludtke");
    parachute.initial_drag_area_ratio = 0.04;
    parachute.initial_phase = {true, 0.0};
}

// clang-format off
constexpr std::array effects{
    PhysicsEffect{"line-elasticity", "Line elasticity", {}, "what the stretch of lines and risers does", false,
          [](const Scene&) { return true; },
          [](Scene& s) { s.parachutes.front().line.youngs_modulus *= stiffer; }, 2.0,
          Switching::alone, nullptr, "off: lines and risers ten times as stiff"},
    PhysicsEffect{"added-mass", "Added mass", "no added mass", "what the air that moves with the canopy does", true,
          [](const Scene& s) { return s.aerodynamics.added_mass.has_value(); },
          [](Scene& s) { s.aerodynamics.added_mass.reset(); }, 1.0, Switching::alone},
    PhysicsEffect{"payload-drag", "Payload drag", "no payload drag", "what the payload's own drag does", true,
          [](const Scene& s) { return s.payload.drag_area.has_value(); },
          [](Scene& s) { s.payload.drag_area.reset(); }, 1.0, Switching::alone},
    PhysicsEffect{"line-drag", "Line drag", "no line drag", "what the drag of the suspension lines does", false,
          [](const Scene& s) { return s.aerodynamics.line_drag.has_value(); },
          [](Scene& s) { s.aerodynamics.line_drag.reset(); }, 1.0, Switching::alone},
    PhysicsEffect{"wind", "Wind", {}, "what the wind does", true,
          [](const Scene& s) { return s.environment.wind.has_value(); }, still_air, 1.0,
          Switching::alone, nullptr, "off: still air, the same release through it"},
    PhysicsEffect{"initial-phase", "Initial phase", {}, "what the pause between snatch and filling does", true,
          has_initial_phase,
          [](Scene& s) { s.parachutes.front().initial_phase = {false, 0.0}; }, 1.0,
          Switching::alone, nullptr, "off: the drag area grows from the snatch on"},
    PhysicsEffect{"breathing", "Breathing", "no breathing damping", "what the air's resistance to fluttering fabric does", false,
          [](const Scene& s) { return s.aerodynamics.breathing_damping.has_value(); },
          [](Scene& s) { s.aerodynamics.breathing_damping.reset(); }, 1.0, Switching::alone,
          [](Scene& s) { s.aerodynamics.breathing_damping = stifled; }, "off: stifled, k_b = 2"},
    // Never switched in an attribution: what effects do to fabric that passes through fabric is no part of a gap.
    PhysicsEffect{"gore-contact", "Gore contact", "no gore contact", "what it does that gores do not pass through each other", false,
          [](const Scene& s) { return s.full.contact == Contact::gores; },
          [](Scene& s) { s.full.contact = Contact::none; }},
    PhysicsEffect{"noise", "Noise", "no noise", "what the disturbance of the canopy at the start does", false,
          [](const Scene& s) { return s.full.noise.has_value(); },
          [](Scene& s) { s.full.noise.reset(); }, 1.0, Switching::alone},
    PhysicsEffect{"mass-damping", "Mass damping", "no mass damping", "what alpha does", false,
          [](const Scene& s) { return s.full.alpha > 0.0; },
          [](Scene& s) { s.full.alpha = 0.0; }, 1.0, Switching::alone},
    PhysicsEffect{"stiffness-damping", "Stiffness damping", "no stiffness damping", "what beta does", false,
          [](const Scene& s) { return s.full.beta > 0.0; },
          [](Scene& s) { s.full.beta = 0.0; }},
    PhysicsEffect{"bulk-viscosity", "Bulk viscosity", "no bulk viscosity", "what the damping of waves along cables does", false,
          [](const Scene& s) { return s.full.bulk_viscosity > 0.0; },
          [](Scene& s) { s.full.bulk_viscosity = 0.0; }},
    PhysicsEffect{"springs", "Springs", "no springs", "finite elements from the pack on", false,
          [](const Scene& s) { return s.full.structure == Structure::msd_fe && chute(s).deploy.starts_packed(); },
          [](Scene& s) { s.full.structure = Structure::fe; }, 8.0},
    PhysicsEffect{"sectors", "Sectors", "one sector", "what it costs and saves that all sectors fold alike", false,
          may_be_a_sector,
          [](Scene& s) { s.full.symmetry = Symmetry::sector; }},
    PhysicsEffect{"own-shape", "Own shape", {}, "what the canopy's own shape does", false,
          [](const Scene& s) { return !chute(s).filling.is_predicted() && (chute(s).deploy.by != DeployBy::inflated || s.aerodynamics.added_mass.has_value()); },
          [](Scene& s) { if (s.aerodynamics.added_mass) s.aerodynamics.added_mass->open_radius = AddedMassRadius::drag_area; },
          1.0, Switching::last, nullptr, "off: filling time and open canopy's added mass as prescribed"},
    // A predicted filling includes what the shape does to it.
    PhysicsEffect{"filling", "Filling", {}, "what it does that each model predicts the filling from its own shape", true,
          [](const Scene& s) { return chute(s).filling.is_predicted(); }, prescribe_filling, 1.0,
          Switching::last, nullptr, "off: both are told n = 4 and Ludtke's law"},
};
// clang-format on

}  // namespace

std::span<const PhysicsEffect> physics_effects() {
    return effects;
}

const PhysicsEffect* find_physics_effect(std::string_view name) {
    const auto row = std::ranges::find(effects, name, &PhysicsEffect::name);
    return row == effects.end() ? nullptr : &*row;
}

void silence(const PhysicsEffect& effect, Scene& scene) {
    (effect.silence ? effect.silence : effect.remove)(scene);
}

}  // namespace twinchute::compare
