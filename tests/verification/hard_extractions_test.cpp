// Parachutes torn out of their pack, and mouths that begin closed: runs come to their end at the default
// step.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/hard_extractions.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

TEST(HardExtractions, CoarseOnesComeToTheirEnd) {
    for (const std::size_t k : {9, 28, 39}) {
        const RunRecord record = test::run_full(test::hard_extraction(
            k, {"full.mesh.gore_columns=2", "full.mesh.gore_rows=6", "full.mesh.line_elements=10"}));
        EXPECT_EQ(record.status.code, StatusCode::completed) << k << ": " << record.status.detail;
    }
}

TEST(HardExtractions, AFailureNamesStepElementAndRemedyAndNoLossIsCalledGrowth) {
    // Four times the step that is stable.
    const RunRecord record = test::run_full(test::hard_extraction(
        1, {"full.mesh.gore_columns=2", "full.mesh.gore_rows=6", "full.mesh.line_elements=10",
            "full.time_step_factor=2", "full.strain_limit=10"}));
    ASSERT_TRUE(is_numerical_failure(record.status.code));
    if (record.status.code == StatusCode::not_finite) return;
    const std::string& detail = record.status.detail;
    EXPECT_NE(detail.find("step"), std::string::npos) << detail;
    EXPECT_NE(detail.find("full.time_step_factor"), std::string::npos) << detail;
    EXPECT_EQ(record.status.code == StatusCode::energy_grew,
              detail.find("came from nowhere") != std::string::npos)
        << detail;
}

TEST(GoreContactRuns, AMouthThatBeginsClosedOpens) {
    for (const char* ratio : {"0", "1e-4"}) {
        const RunRecord record =
            test::run_full(read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                                      {std::string("parachute.initial_drag_area_ratio=") + ratio}));
        EXPECT_EQ(record.status.code, StatusCode::completed) << ratio << ": " << record.status.detail;
        EXPECT_LT(std::abs(record.energy->residual_fraction), 1e-3) << ratio;
    }
}

}  // namespace
}  // namespace twinchute
