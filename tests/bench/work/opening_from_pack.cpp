// The crane drop from its pack: fabric as springs until it fills, or as finite elements all the way.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "lib/scene/read_scene.hpp"
#include "tests/bench/work/opening.hpp"

namespace twinchute::bench {
namespace {

/// A packed drop is chaotic, so that it takes several: their median, their range, and what one of them costs.
struct Spread {
    Measured median;
    Opening range;
};

struct Way {
    Structure structure;
    const char *word, *family;
};
constexpr Way ways[] = {{Structure::msd_fe, "msd-fe", "springs, then elements"},
                        {Structure::fe, "fe", "elements from the pack on"}};

Spread spread_of(Scene scene, int seeds) {
    std::vector<Opening> all;
    Measured sum;
    for (int seed = 1; seed <= seeds; ++seed) {
        scene.full.noise->seed = static_cast<std::uint64_t>(seed);
        const Measured one = run_opening(scene);
        all.push_back(one.opening);
        sum.evaluations += one.evaluations / seeds;
        sum.element_steps += one.element_steps / seeds;
        sum.seconds += one.seconds / seeds;
    }
    sum.opening = median_of(all);
    return {sum, range_of(all)};
}

}  // namespace

void study_opening_from_pack(const std::filesystem::path& directory, bool quick) {
    const Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/paper/crane-drop.toml");
    const std::vector<MeshCounts> meshes =
        quick ? std::vector<MeshCounts>{{1, 4, 4, 1}, {1, 6, 6, 2}}
              : std::vector<MeshCounts>{{1, 8, 16, 3}, {2, 17, 31, 5}, {3, 26, 46, 8}};
    const int seeds = quick ? 2 : 5;
    const auto spread_on = [&](const MeshCounts& mesh, Structure structure) {
        Scene other = scene;
        other.full.mesh = mesh;
        other.full.structure = structure;
        return spread_of(other, seeds);
    };
    const Spread truth = spread_on(meshes.back(), Structure::fe);
    Study study = opening_study(
        quick ? "opening-quick-pack" : "opening-pack",
        "Crane drop: springs and finite elements, from the pack",
        fmt::format("medians of {} seeds; against finite elements with {} across a gore and {} rows", seeds,
                    meshes.back().gore_columns, meshes.back().gore_rows),
        "range over these seeds", truth.range, truth.median.opening);
    for (const Way& way : ways) {
        Curve curve{way.word, way.family, {}};
        for (const MeshCounts& mesh : meshes) {
            if (way.structure == Structure::fe && &mesh == &meshes.back()) continue;  // the truth itself
            curve.samples.push_back(
                sample_of(fmt::format("{} across, {} rows", mesh.gore_columns, mesh.gore_rows),
                          spread_on(mesh, way.structure).median, truth.median.opening));
            say(curve);
        }
        study.curves.push_back(std::move(curve));
    }
    write(study, directory);
}

}  // namespace twinchute::bench
