// The C-9 line-stretch scene built in code, for tests that vary it.
#pragma once

#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::test {

/// Paper, 5.1 and 5.2, straight down at 21 m/s in uniform air of 1.225 kg/m^3, n = 4, no noise.
inline Scene c9_scene() {
    Scene scene;
    scene.name = "C-9 in a test";
    scene.environment.atmosphere = {find_atmosphere("constant"), 1.225};
    scene.environment.gravity = standard_gravity;
    scene.payload.mass = 152.4;
    scene.release = {300.0, 21.0, 0.5 * pi, 0.5 * pi};

    Parachute chute;
    chute.name = "C-9";
    chute.nominal_diameter = 8.53;
    chute.drag_area = 42.56;
    chute.projected_diameter_ratio = 0.65;
    chute.mass = 5.19;
    chute.gores = 28;
    chute.vent_diameter = 0.853;
    chute.line_length = 7.31;
    chute.riser_length = 1.22;
    chute.risers = 1;
    chute.fabric = {"fabric", 533.0, 4.3e8, 0.3, 1e-4};
    chute.line = {"cord", 462.0, 9.7e8, 4e-3};
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
    scene.full.bulk_viscosity = 0.06;
    scene.full.time_step_factor = 0.8;
    scene.full.strain_limit = 0.5;
    scene.full.output_rate = 200.0;
    return scene;
}

/// The crane drop of the paper, 5.2: released at rest, packed. With the noise of one seed; a coarse mesh
/// runs in two seconds.
inline Scene packed_c9(DeployBy by, bool coarse = true) {
    Scene scene = c9_scene();
    scene.environment.ground = -40.0;
    scene.release = {85.0, 0.0, 0.5 * pi, 0.5 * pi};
    Parachute& chute = scene.parachutes.front();
    chute.risers = 4;
    chute.deploy.by = by;
    if (by == DeployBy::static_line) chute.deploy.static_line_length = 12.2;
    chute.deploy.pack_ratio = 0.01;
    chute.deploy.drag_coefficient = 0.1;
    chute.deploy.fold_repulsion = 1e-5;
    chute.deploy.fold_resistance = 2.0;
    scene.full.noise = Noise{1e-4, 1};
    scene.full.structure = Structure::msd_fe;
    scene.full.switch_area_ratio = 0.12;
    scene.full.ramp_time = 0.15;
    if (coarse) scene.full.mesh = {2, 7, 10, 2};
    return scene;
}

}  // namespace twinchute::test
