// One sector in place of the whole canopy: the demo comes out the same where nothing but symmetry is assumed.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using test::run_full;

RunRecord fly(const std::string& risers, const std::string& symmetry) {
    return run_full(read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                               {"parachute.risers=" + risers, "full.symmetry='" + symmetry + "'"}));
}

class SectorDemo : public testing::TestWithParam<const char*> {};

TEST_P(SectorDemo, HasTheMetricsOfTheWholeCanopy) {
    const RunRecord whole = fly(GetParam(), "none"), sector = fly(GetParam(), "sector");
    ASSERT_EQ(sector.status.code, StatusCode::completed) << sector.status.detail;
    ASSERT_EQ(whole.metrics.size(), sector.metrics.size());
    for (std::size_t i = 0; i < whole.metrics.size(); ++i) {
        const Metric &w = whole.metrics[i], &s = sector.metrics[i];
        ASSERT_EQ(w.key, s.key);
        // Without noise rounding alone tells gores apart, and this opening is smooth: far less than 0.5 %.
        EXPECT_NEAR(w.value, s.value, 1e-4 * std::abs(w.value)) << w.key;
    }
    EXPECT_NEAR(whole.energy->drag_work, sector.energy->drag_work, 1e-4 * std::abs(whole.energy->drag_work));
    EXPECT_NEAR(whole.energy->elastic, sector.energy->elastic, 1e-3 * std::abs(whole.energy->elastic));
    // Lines take as many subcycles, and leave as little unbooked.
    EXPECT_NEAR(static_cast<double>(whole.cost.steps), static_cast<double>(sector.cost.steps),
                1e-3 * static_cast<double>(whole.cost.steps));
    EXPECT_NEAR(whole.energy->residual_fraction, sector.energy->residual_fraction, 1e-6);
}

TEST_P(SectorDemo, SaysWhatItIsAndWhatItLeavesOut) {
    const RunRecord record = run_full(read_scene(
        std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
        {std::string("parachute.risers=") + GetParam(), "full.symmetry='sector'", "stop.time='0.1 s'"}));
    const bool one = std::string(GetParam()) == "1";
    const std::string& how = record.provenance.instruction_set;
    EXPECT_NE(how.find(one ? ", one gore of 28, sector-batched" : ", 7 gores of 28, sector-batched"),
              std::string::npos)
        << how;
    // 69 triangles and 48 cables a gore (4 x 9, 34 a line), 5 cables a riser.
    EXPECT_EQ(record.cost.element_steps, record.cost.steps * (one ? 69 + 48 + 5 : 7 * (69 + 48) + 5));
    bool said = false;
    for (const LeftOut& left : record.left_out)
        said = said || (left.what == "folds that differ from gore to gore" &&
                        left.why.find("16 % of the peak") != std::string::npos);
    EXPECT_TRUE(said);
}

INSTANTIATE_TEST_SUITE_P(Risers, SectorDemo, testing::Values("1", "4"));

}  // namespace
}  // namespace twinchute
