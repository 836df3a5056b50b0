// A scene whose filling is predicted in place of prescribed.
#pragma once

#include "lib/scene/scene.hpp"

namespace twinchute::test {

inline Scene predicted(Scene scene, double initial_mouth = 0.005) {
    Parachute& chute = scene.parachutes.front();
    chute.filling = {find_filling("predicted"), initial_mouth, 2.0, initial_mouth, initial_mouth};
    chute.fabric.permeability = Permeability{254.4, 37.6};  // MIL-C-7020 type III
    chute.drag_area_law = nullptr;
    chute.drag_area_table.reset();
    chute.drag_area_exponent.reset();
    chute.initial_drag_area_ratio = 0.0;
    chute.initial_phase = {};
    chute.fill_time = {};
    return scene;
}

}  // namespace twinchute::test
