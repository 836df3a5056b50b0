#include <cstdio>

#include "lib/scene/read_scene.hpp"
#include "rom/fidelity.hpp"

int main() {
    twinchute::Run run;  // no stop request, no progress reports
    const auto scene = twinchute::read_scene(DATA "/scenes/c9-inflation.toml", {"payload.mass='150 kg'"});
    const auto record = twinchute::rom::rom_fidelity().run(scene, run);
    std::printf("%s: peak force %.0f N\n", scene.name.c_str(), record.metric("peak_force_N").value());
}
