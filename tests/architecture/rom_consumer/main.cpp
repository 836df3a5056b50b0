#include <cstdio>

#include "lib/math/vec.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/fill_time.hpp"
#include "rom/fidelity.hpp"

int main() {
    using namespace twinchute;
    // The C-9 of data/scenes/c9-inflation.toml, straight down at 21 m/s in uniform air; SI throughout.
    Scene scene;
    scene.environment.atmosphere = {find_atmosphere("constant"), sea_level_density};
    scene.payload.mass = 152.4;
    scene.release = {300.0, 21.0, 0.5 * pi, 0.5 * pi};
    Parachute chute;
    chute.nominal_diameter = 8.53;
    chute.drag_area = 42.56;
    chute.mass = 5.19;
    chute.line_length = 7.31;
    chute.fill_time = {find_fill_time("fill-constant"), 4.0};
    chute.drag_area_law = find_drag_area_law("ludtke");
    chute.initial_drag_area_ratio = 0.04;
    scene.parachutes.push_back(chute);
    scene.stop = {Trigger::Kind::time, 6.0, 0.0};
    scene.rom = {"dormand-prince", 1e-8};

    Run run;  // no stop request, no progress reports
    const RunRecord record = rom::rom_fidelity().run(scene, run);
    std::printf("peak force %.0f N\n", record.metric("peak_force_N").value());
}
