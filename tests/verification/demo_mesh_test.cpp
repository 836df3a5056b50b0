// The demo as it is shipped has the answers of its finest mesh, to 1 % in every headline metric.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

TEST(DemoMesh, HasTheAnswersOfTheFinestToAPerCent) {
    // Three times the elements in each direction, 12 x 27 a gore and 102 a line (DemoMeshLong makes them
    // anew): 4966.8 N, 1.5024 s, 1.5394 s, 7.7057 m/s. With 8 x 34, 12 x 34 and 12 x 51 elements, whose first
    // row is shorter: 4965 to 4970 N, 1.507 to 1.508 s, 1.539 to 1.545 s. As shipped it is 0.2, 0.3 and 0.4 %
    // from the first, what is asked is the bound that the scene promises. Without contact the three
    // are 3.5, 4.8 and 0.3 % off on this mesh, with two elements across 0.8, 1.8 and 1.9 %. One sector is the
    // whole canopy (SectorDemo).
    const RunRecord record = test::run_full(
        read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml", {"full.symmetry='sector'"}));
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    for (const auto& [key, finest] : {std::pair{"peak_force_N", 4966.8},
                                      {"filling_time_s", 1.5024},
                                      {"time_to_peak_force_s", 1.5394},
                                      {"descent_rate_m_s", 7.7057}})
        EXPECT_NEAR(*record.metric(key), finest, 0.01 * finest) << key;
}

}  // namespace
}  // namespace twinchute
