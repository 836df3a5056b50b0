// A scene without a single optional piece of physics, with force blocks chosen from all rows of the registry
// or from those alone that the scene has: left_out.py counts the instructions of either.
//   left_out all|own line-stretch|packed
#include <algorithm>
#include <cstdio>
#include <string_view>
#include <vector>

#include "fullsim/simulation.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::bench {

/// Builds and flies so many steps; [N] the riser force, so that both registries can be seen to give one
/// answer.
[[gnu::noinline]] double fly(const Scene& scene, std::span<const fullsim::ForceBlock> blocks, int steps) {
    fullsim::Simulation simulation(scene, fullsim::Simulation::layout_of_one_thread, blocks);
    for (int i = 0; i < steps; ++i) {
        simulation.evaluate_forces();
        simulation.step_to(1.0);
    }
    return simulation.system().riser_force.norm();
}

/// By name, and not by what the rows say of themselves: one that is always needed would stand in both
/// registries.
std::vector<std::string_view> of_a_bare_scene(bool packed) {
    if (packed) return {"fabric springs", "membrane", "tapes", "lines", "static line", "canopy pressure"};
    return {"membrane", "tapes", "lines", "canopy pressure"};
}

Scene bare(bool packed) {
    Scene scene = packed ? test::packed_c9(DeployBy::static_line) : test::c9_scene();
    // Few gores: valgrind takes fused multiply-adds one at a time.
    scene.parachutes.front().gores = 8;
    scene.full.mesh = {2, 6, 6, 2};
    scene.aerodynamics.added_mass.reset();
    scene.aerodynamics.line_drag.reset();
    scene.aerodynamics.breathing_damping.reset();
    scene.payload.drag_area.reset();
    scene.full.alpha = 0.0;
    scene.full.noise.reset();
    scene.parachutes.front().deploy.drag_coefficient = 0.0;
    scene.parachutes.front().deploy.deployment_resistance = 0.0;
    return scene;
}

}  // namespace twinchute::bench

int main(int argc, char** argv) {
    using namespace twinchute;
    if (argc != 3) return 2;
    const bool all = std::string_view(argv[1]) == "all";
    const bool packed = std::string_view(argv[2]) == "packed";
    const Scene scene = bench::bare(packed);
    std::vector<fullsim::ForceBlock> own;
    for (const fullsim::ForceBlock& block : fullsim::force_blocks())
        if (all || std::ranges::count(bench::of_a_bare_scene(packed), block.name) > 0) own.push_back(block);
    constexpr int steps = 200;
    std::printf("%zu rows, %.17g N\n", own.size(), bench::fly(scene, own, steps));
    return 0;
}
