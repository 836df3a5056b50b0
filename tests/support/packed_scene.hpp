// The C-9 of tests/support/c9_scene.hpp in its pack, for tests of deployments.
#pragma once

#include "tests/support/c9_scene.hpp"

namespace twinchute::test {

/// At rest 85 m above the sea, ground far below; no deployment chosen yet.
inline Scene packed_scene() {
    Scene scene = c9_scene();
    scene.environment.ground = -4000.0;
    scene.release = {85.0, 0.0, 0.5 * pi, 0.5 * pi};
    Deployment& deploy = scene.parachutes.front().deploy;
    deploy.pack_ratio = 0.01;
    deploy.drag_coefficient = 0.1;
    deploy.deployment_resistance = 2.0;
    return scene;
}

/// The paper's crane drop: a static line of 12.2 m whose anchor stands still.
inline Scene crane_drop() {
    Scene scene = packed_scene();
    Deployment& deploy = scene.parachutes.front().deploy;
    deploy.by = DeployBy::static_line;
    deploy.static_line_length = 12.2;
    deploy.anchor_moves = false;
    return scene;
}

inline Scene free_deployment(double pack_drag_area) {
    Scene scene = packed_scene();
    scene.parachutes.front().deploy.by = DeployBy::free;
    scene.parachutes.front().deploy.pack_drag_area = pack_drag_area;
    return scene;
}

/// By a force history [s], [N]; nothing after its last point.
inline Scene extraction(std::vector<double> time, std::vector<double> force) {
    Scene scene = packed_scene();
    Deployment& deploy = scene.parachutes.front().deploy;
    deploy.by = DeployBy::extraction;
    const double end = time.back();
    deploy.extraction = {"", std::move(time), std::move(force), end};
    return scene;
}

/// Air so thin, gravity so weak that neither moves anything.
inline void take_away_air(Scene& scene) {
    scene.environment.atmosphere.constant_density = 1e-15;
}
inline void take_away_gravity(Scene& scene) {
    scene.environment.gravity = 1e-12;
}

}  // namespace twinchute::test
