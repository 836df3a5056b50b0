// The demo as it is shipped against three times its elements in each direction, as `twinchute ladder` has
// them. About half a minute.
#include <gtest/gtest.h>

#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

TEST(DemoMeshLong, IsWithinAPerCentOfThreeTimesTheElements) {
    // The whole canopy as it is shipped, one sector of the finest. Found: 0.2 % of the peak, 0.3 % of the
    // filling time, 0.4 % of the time to the peak, 2e-5 of the descent rate.
    const Scene demo = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    Scene fine = demo;
    fine.full.symmetry = Symmetry::sector;
    MeshCounts& mesh = fine.full.mesh;
    for (int* count : {&mesh.gore_columns, &mesh.gore_rows, &mesh.line_elements, &mesh.riser_elements})
        *count *= 3;
    const RunRecord shipped = test::run_full(demo), finest = test::run_full(fine);
    ASSERT_EQ(shipped.status.code, StatusCode::completed) << shipped.status.detail;
    ASSERT_EQ(finest.status.code, StatusCode::completed) << finest.status.detail;
    for (const char* key : {"peak_force_N", "filling_time_s", "time_to_peak_force_s", "descent_rate_m_s"})
        EXPECT_NEAR(*shipped.metric(key), *finest.metric(key), 0.01 * *finest.metric(key)) << key;
}

}  // namespace
}  // namespace twinchute
