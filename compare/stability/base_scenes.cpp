#include "compare/stability/base_scenes.hpp"

#include "lib/math/vec.hpp"

namespace twinchute::compare {
namespace {

/// So little air, so weak a gravity that neither moves anything by as much as the tolerances; a scene has to
/// have both.
constexpr double no_density = 1e-15;  // [kg/m^3]
constexpr double no_gravity = 1e-12;  // [m/s^2]

}  // namespace

/// Numbers of the C-9: "Aeroelastic analysis of parachute deceleration systems with empirical aerodynamics",
/// 5.1 and 5.2, as in data/parachutes/usaf-c9.toml and data/materials, where each has its source. n = 4 and
/// eta = 0.2 are this toolkit's assumptions.
Scene c9_at_line_stretch() {
    Scene scene;
    scene.environment.atmosphere = {find_atmosphere("constant"), sea_level_density};
    scene.environment.gravity = standard_gravity;
    scene.payload.mass = 152.4;
    scene.release = {300.0, 21.0, 0.5 * pi, 0.5 * pi};

    Parachute chute;
    chute.name = "USAF C-9";
    chute.nominal_diameter = 8.53;
    chute.drag_area = 42.56;
    chute.projected_diameter_ratio = 0.65;
    chute.mass = 5.19;
    chute.gores = 28;
    chute.vent_diameter = 0.853;
    chute.line_length = 7.31;
    chute.riser_length = 1.22;
    chute.risers = 1;
    chute.fabric = {"mil-c-7020-c9", 533.0, 4.3e8, 0.3, 1e-4, 7355.0, Permeability{254.4, 37.6}};
    chute.line = {"mil-c-5040-type-ii", 462.0, 9.7e8, 4e-3, 400 * 4.4482216152605};
    chute.tapes = {chute.line, chute.line, chute.line};
    chute.fill_time = {find_fill_time("fill-constant"), 4.0, 0.0, 0.0};
    chute.drag_area_law = find_drag_area_law("ludtke");
    chute.initial_drag_area_ratio = 0.04;
    scene.parachutes.push_back(chute);

    scene.aerodynamics.added_mass = {find_added_mass("hemisphere"), AddedMassMomentum::inertia_only};
    scene.aerodynamics.line_drag.emplace();
    scene.aerodynamics.breathing_damping = 0.5;
    scene.aerodynamics.radial_pressure = 0.8;
    scene.stop = {Trigger::Kind::time, 6.0, 0.0};
    scene.rom = {"dormand-prince", 1e-8};
    scene.full.mesh = {2, 17, 31, 5};
    scene.full.structure = Structure::msd_fe;
    scene.full.switch_area_ratio = 0.12;
    scene.full.ramp_time = 0.15;
    scene.full.bulk_viscosity = 0.06;
    scene.full.time_step_factor = 0.95;
    scene.full.line_substeps = 4;
    scene.full.strain_limit = 0.5;
    scene.full.output_rate = 200.0;
    return scene;
}

Scene c9_of_closed_forms() {
    Scene scene = c9_at_line_stretch();
    scene.aerodynamics.added_mass.reset();
    scene.parachutes.front().initial_phase = {false, 0.0};
    return scene;
}

Scene c9_snatch_in_empty_space() {
    Scene scene = c9_at_line_stretch();
    scene.environment.atmosphere.constant_density = no_density;
    scene.environment.gravity = no_gravity;
    scene.environment.ground = -900.0;
    scene.release = {85.0, 20.0, 0.5 * pi, 0.5 * pi};
    Deployment& deploy = scene.parachutes.front().deploy;
    deploy.by = DeployBy::static_line;
    deploy.static_line_length = 12.2;
    deploy.anchor_moves = false;
    deploy.pack_ratio = 0.01;
    deploy.drag_coefficient = 0.1;
    deploy.compressive_stiffness_ratio = 1e-5;
    deploy.deployment_resistance = 2.0;
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
    return scene;
}

Scene c9_inflated() {
    Scene scene = c9_at_line_stretch();
    scene.aerodynamics.added_mass.reset();
    scene.release.speed = 0.0;
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    return scene;
}

Scene c9_coarse() {
    Scene scene = c9_at_line_stretch();
    scene.full.mesh = {1, 6, 6, 2};
    scene.stop = {Trigger::Kind::time, 2.4, 0.0};
    return scene;
}

Scene c9_that_fills_itself() {
    Scene scene = c9_coarse();
    Parachute& chute = scene.parachutes.front();
    chute.filling = {find_filling("predicted"), 0.02, 2.0, 0.02, 0.02};
    chute.fabric.permeability = Permeability{254.4, 37.6};  // MIL-C-7020 type III
    chute.fill_time = {};
    chute.drag_area_law = nullptr;
    chute.initial_drag_area_ratio = 0.0;
    scene.full.mesh = {2, 6, 6, 2};
    scene.full.contact = Contact::gores;
    return scene;
}

Scene c9_packed() {
    Scene scene = c9_snatch_in_empty_space();
    scene.environment.atmosphere.constant_density = sea_level_density;
    scene.environment.gravity = standard_gravity;
    scene.release.speed = 0.0;
    scene.full.mesh = {1, 6, 6, 2};
    scene.full.noise = Noise{1e-4, 1};
    scene.full.alpha = 5.0;
    scene.stop = {Trigger::Kind::time, 4.0, 0.0};
    return scene;
}

void stop_after(Scene& scene, double seconds) {
    scene.stop = {Trigger::Kind::time, seconds, 0.0};
}

}  // namespace twinchute::compare
