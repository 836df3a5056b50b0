// As tests/verification/hand_over_test.cpp, on the meshes of the scenes and over two minutes of descent.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/solve/hand_over.hpp"
#include "rom/fidelity.hpp"

namespace twinchute {
namespace {

struct Falls {
    Scene scene;
    RunRecord whole, handed;
};

Falls fall(const char* file) {
    const std::array<const Fidelity*, 2> both{&rom::rom_fidelity(), &fullsim::full_fidelity()};
    const auto scene = [&](std::vector<std::string> more) {
        more.emplace_back("release.height='900 m'");
        return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + file, more);
    };
    const auto fly = [&](const Scene& one) {
        twinchute::Run run;  // not that of a test
        return run_scene(fullsim::full_fidelity(), one, run, both);
    };
    const Scene down = scene({"stop.at='ground'"});
    return {down, fly(down), fly(scene({"stop.at='steady-descent'", "stop.then='rom'"}))};
}

Vec3 landing(const RunRecord& record) {
    return {*record.metric("landing_east_m"), *record.metric("landing_north_m"), 0.0};
}

void say(const char* file, const Falls& falls) {
    std::printf("%s: %.3f s by full, %.3f s by both; drift %.2f m and %.2f m; steps %lld and %lld\n", file,
                *falls.whole.metric("flight_time_s"), *falls.handed.metric("flight_time_s"),
                landing(falls.whole).norm(), landing(falls.handed).norm(),
                static_cast<long long>(falls.whole.cost.steps),
                static_cast<long long>(falls.handed.cost.steps));
}

void expect_same_time(const Falls& falls) {
    ASSERT_EQ(falls.whole.status.code, StatusCode::completed) << falls.whole.status.detail;
    ASSERT_EQ(falls.handed.status.code, StatusCode::completed) << falls.handed.status.detail;
    // The promise to users; measured figures stand in docs/guide/long-runs.md.
    const double time = *falls.whole.metric("flight_time_s");
    EXPECT_NEAR(*falls.handed.metric("flight_time_s"), time, 0.005 * time);
}

TEST(LongHandOver, LandsWithinHalfAPerCentOfTheTimeAndOneOfTheDrift) {
    const Falls falls = fall("c9-crosswind.toml");
    say("c9-crosswind.toml", falls);
    expect_same_time(falls);
    const double drift = landing(falls.whole).norm();
    EXPECT_LT((landing(falls.handed) - landing(falls.whole)).norm(), 0.01 * drift);
}

TEST(LongHandOver, LandsThereInAWindThatGrowsWithHeight) {
    // Both models meet the wind where the canopy is, nine metres above the payload, which is worth 0.9 % of
    // the drift.
    const Falls falls = fall("c9-drift.toml");
    say("c9-drift.toml", falls);
    expect_same_time(falls);
    const double drift = landing(falls.whole).norm();
    EXPECT_LT((landing(falls.handed) - landing(falls.whole)).norm(), 0.01 * drift);
}

}  // namespace
}  // namespace twinchute
