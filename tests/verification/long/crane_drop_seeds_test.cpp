// The paper's crane drop over seeds, as it is shipped: medians, ranges, and what the two structures agree in.
// About two minutes; the tables of docs/theory/deployment.md come from here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

struct Seeds {
    std::vector<RunRecord> records;

    /// Sorted values of a metric.
    std::vector<double> of(const char* key) const {
        std::vector<double> values;
        for (const RunRecord& r : records)
            values.push_back(r.metric(key).value());
        std::ranges::sort(values);
        return values;
    }
    double median(const char* key) const { return of(key)[records.size() / 2]; }
};

Seeds run_seeds(int count, const std::vector<std::string>& overrides) {
    Seeds seeds;
    for (int seed = 1; seed <= count; ++seed) {
        std::vector<std::string> all = overrides;
        all.push_back("full.noise.seed=" + std::to_string(seed));
        seeds.records.push_back(test::run_full(
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/paper/crane-drop.toml", all)));
        const RunRecord& r = seeds.records.back();
        EXPECT_EQ(r.status.code, StatusCode::completed) << r.status.detail;
        EXPECT_LT(std::abs(r.energy->residual_fraction), 0.01);
        // 60 s on an idle core, with time for a loaded one.
        EXPECT_LT(r.cost.cpu_s, 120.0);
    }
    for (const char* key : {"line_stretch_time_s", "snatch_speed_m_s", "snatch_force_N", "peak_force_ratio",
                            "projected_diameter_ratio", "canopy_depth_ratio", "descent_rate_m_s"})
        if (seeds.records.front().metric(key)) {
            const auto v = seeds.of(key);
            test::report(key, v[v.size() / 2], v.front(), v.back());
        }
    return seeds;
}

TEST(CraneDropSeeds, OpenAsThePaperSays) {
    const Seeds seeds = run_seeds(7, {});
    EXPECT_NEAR(seeds.median("snatch_speed_m_s"), 21.0, 1.0);
    EXPECT_NEAR(seeds.median("projected_diameter_ratio"), 0.65, 0.03);
    EXPECT_NEAR(seeds.median("canopy_depth_ratio"), 0.45, 0.04);
    const RunRecord rom = test::run_rom(
        read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/paper/crane-drop.toml", {}));
    for (const char* key : {"line_stretch_time_s", "snatch_speed_m_s"})
        EXPECT_NEAR(rom.metric(key).value() / seeds.median(key), 1.0, 0.05) << key;
    // Both end a few metres above the sea: the same density to 1e-4.
    EXPECT_NEAR(seeds.median("descent_rate_m_s") / rom.metric("descent_rate_m_s").value(), 1.0, 0.005);
}

TEST(CraneDropSeeds, BothStructuresAgreeWithinTheirScatter) {
    // The ranges over seeds overlap, and the medians differ by less than the wider one; by 5 to 6 %, elements
    // being higher (docs/theory/deployment.md). That is one and a half standard deviations: of seven seeds
    // the ranges miss each other by accident now and then, of 24 they do not.
    constexpr int count = 24;
    const auto springs = run_seeds(count, {"stop.time=4.8"}).of("peak_force_ratio"),
               elements = run_seeds(count, {"stop.time=4.8", "full.structure='fe'"}).of("peak_force_ratio");
    EXPECT_LT(springs.front(), elements.back());
    EXPECT_LT(elements.front(), springs.back());
    EXPECT_NEAR(springs[count / 2], elements[count / 2],
                std::max(springs.back() - springs.front(), elements.back() - elements.front()));
}

}  // namespace
}  // namespace twinchute
