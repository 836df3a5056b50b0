// The C-9 of data/scenes/c9-inflation.toml, for tests that vary it.
#pragma once

#include "lib/math/vec.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::test {

/// The shipped scene, but for what tests rely on: one riser, six seconds, lines without steps of their own, a
/// mesh of long standing; no contact, no checkpoints, no strengths to hold loads against. Everything else is
/// as in data/, the share 0.95 of the bound on the time step among it.
inline Scene c9_scene() {
    static const Scene shipped = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    Scene scene = shipped;
    scene.name = "C-9 in a test";
    scene.file.clear();
    scene.sha256.clear();
    scene.tolerances.clear();
    scene.inputs.clear();
    scene.warnings.clear();

    Parachute& chute = scene.parachutes.front();
    chute.name = "C-9";
    chute.risers = 1;
    chute.opening_force_coefficient.reset();
    chute.fabric.strength = {};
    for (Cord* cord : {&chute.line, &chute.tapes.radial, &chute.tapes.skirt, &chute.tapes.vent})
        cord->strength = {};
    scene.stop = {Trigger::Kind::time, 6.0, 0.0};
    scene.rom = {"dormand-prince", 1e-8};
    scene.full.mesh = {2, 17, 31, 5};
    scene.full.contact = Contact::none;
    scene.full.line_substeps = 1;
    scene.full.strain_limit = 0.5;
    scene.full.output_rate = 200.0;
    scene.full.checkpoint_interval = 0.0;
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
    chute.deploy.compressive_stiffness_ratio = 1e-5;
    chute.deploy.deployment_resistance = 2.0;
    scene.full.noise = Noise{1e-4, 1};
    scene.full.structure = Structure::msd_fe;
    scene.full.switch_area_ratio = 0.12;
    scene.full.ramp_time = 0.15;
    if (coarse) scene.full.mesh = {2, 7, 10, 2};
    return scene;
}

}  // namespace twinchute::test
