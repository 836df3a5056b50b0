// Parachutes torn out of their pack: random scenes, the same ones every time.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>
#include "lib/scene/read_scene.hpp"
#include "tests/support/random.hpp"

namespace twinchute::test {

/// The C-9 of the demo under an extraction force of 1 to 12 kN, at 20 to 60 m/s in any direction from level
/// to straight down, with 40 to 150 kg, each with noise of its own. Three of sixty strain some fabric by more
/// than half as they open, which would be another end: they are let to. The same number is the same scene.
inline Scene hard_extraction(std::size_t k, std::vector<std::string> overrides = {}) {
    Random random(1000 + k);
    const double force = random.number_in(1000.0, 12000.0), speed = random.number_in(20.0, 60.0),
                 mass = random.number_in(40.0, 150.0), angle = 90.0 * random.share();
    std::vector<std::string> all{
        "full.contact='none'",
        "release.height=3000",
        fmt::format("parachute.deploy={{by='extraction',force={:.0f},pack_drag_area=0.1}}", force),
        fmt::format("release.speed={:.1f}", speed),
        fmt::format("payload.mass={:.0f}", mass),
        fmt::format("release.path_angle='{:.0f} deg'", angle),
        "full.strain_limit=1",
        "full.noise.amplitude='0.1 mm'",
        fmt::format("full.noise.seed={}", 1 + random.below(1000))};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml", all);
}

}  // namespace twinchute::test
