// The full model on the C-9 line-stretch scene: against the rigid reduced-order model where the two
// must agree, and against itself where nothing may change.
//
// With the breathing damped, the canopy's motion relative to its lines is small and the whole is
// nearly the rigid body of the reduced-order model: the strongest regression oracle there is.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using test::c9_scene;
using test::run_full;
using test::run_rom;

double peak_ratio(const Scene& scene) {
    return *run_full(scene).metric("peak_force_N") / *run_rom(scene).metric("peak_force_N");
}

/// To just after the peak at 1.54 s.
Scene to_the_peak() {
    Scene scene = c9_scene();
    scene.stop = {Trigger::Kind::time, 1.75, 0.0};
    return scene;
}

TEST(FullDemo, MeetsTheRomAndItsOwnSteadyState) {
    Scene scene = c9_scene();
    scene.stop.value = 8.0;  // steady at 7.0 s, and nearer then
    const RunRecord record = run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const RunRecord rom = run_rom(scene);
    EXPECT_NEAR(*record.metric("peak_force_N") / *rom.metric("peak_force_N"), 1.0, 0.02);
    // sqrt(2 m g/(rho C_D S)) with the mass that the mesh has.
    const double equilibrium = std::sqrt(2.0 * (152.4 + 5.19) * standard_gravity / (1.225 * 42.56));
    EXPECT_NEAR(*record.metric("descent_rate_m_s"), equilibrium, 0.003 * equilibrium);
    EXPECT_LT(std::abs(record.energy->residual_fraction), 0.005);
    EXPECT_GT(*record.metric("signed_area_ratio"), 0.95);
    // Isotensoid single-riser canopy: D_p/D0 = 0.6645 for L = 0.857 D0 (lines only), 0.6757 for D0; radial
    // pressure of 0.8 instead of 1 makes it narrower. The paper's simulation has 0.65 and 0.45.
    EXPECT_NEAR(*record.metric("projected_diameter_ratio"), 0.65, 0.03);
    EXPECT_NEAR(*record.metric("canopy_depth_ratio"), 0.45, 0.04);
}

TEST(FullDemo, MeetsTheRomWithoutAddedMassMoreClosely) {
    Scene scene = to_the_peak();
    scene.aerodynamics.added_mass.reset();
    EXPECT_NEAR(peak_ratio(scene), 1.0, 0.002);
}

class FullDemoSeeds : public testing::TestWithParam<int> {};

TEST_P(FullDemoSeeds, StaysNearTheRomUnderNoise) {
    Scene scene = to_the_peak();
    scene.full.noise = Noise{1e-4, static_cast<std::uint64_t>(GetParam())};
    EXPECT_NEAR(peak_ratio(scene), 1.0, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Five, FullDemoSeeds, testing::Range(1, 6));

TEST(FullDemo, PeakDoesNotDependOnTheMesh) {
    // 504, 1904 and 4368 triangles on a uniform mesh, lines refined along.
    for (const Grading grading : {Grading::uniform, Grading::graded}) {
        double peak[3] = {};
        int level = 0;
        for (MeshCounts counts : {MeshCounts{1, 9, 16, 3}, {2, 17, 31, 5}, {2, 39, 47, 8}}) {
            Scene scene = to_the_peak();
            counts.grading = grading;
            scene.full.mesh = counts;
            peak[level++] = *run_full(scene).metric("peak_force_N");
        }
        test::report("peak on three meshes [N]:", peak[0], peak[1], peak[2]);
        EXPECT_NEAR(peak[0] / peak[1], 1.0, 0.005) << grading_name(grading);
        EXPECT_NEAR(peak[2] / peak[1], 1.0, 0.005) << grading_name(grading);
    }
}

TEST(FullDemo, PeakDoesNotDependOnTheStep) {
    Scene scene = to_the_peak();
    const double whole = *run_full(scene).metric("peak_force_N");
    scene.full.time_step_factor *= 0.5;
    EXPECT_NEAR(*run_full(scene).metric("peak_force_N") / whole, 1.0, 0.005);
}

TEST(FullDemo, SameInputGivesSameBits) {
    Scene scene = c9_scene();
    scene.stop = {Trigger::Kind::time, 0.4, 0.0};
    scene.full.noise = Noise{1e-4, 3};
    const RunRecord first = run_full(scene), second = run_full(scene);
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (std::size_t i = 0; i < first.channels.size(); ++i)
        EXPECT_EQ(first.channels[i].values, second.channels[i].values) << first.channels[i].name;
    ASSERT_EQ(first.metrics.size(), second.metrics.size());
    for (std::size_t i = 0; i < first.metrics.size(); ++i)
        EXPECT_EQ(first.metrics[i].value, second.metrics[i].value) << first.metrics[i].key;
}

TEST(FullDemo, HeadingTurnsTheAnswerAndNothingElse) {
    // The world has no preferred azimuth: 37 degrees more heading rotate positions, to round-off
    // that 4000 steps amplify.
    Scene scene = c9_scene();
    scene.release.path_angle = 60.0 * pi / 180.0;
    scene.stop = {Trigger::Kind::time, 0.25, 0.0};
    const RunRecord east = run_full(scene);
    scene.release.heading += 37.0 * pi / 180.0;
    const RunRecord turned = run_full(scene);
    const auto end = [](const RunRecord& r, const char* name) { return r.find_channel(name)->values.back(); };
    EXPECT_NEAR(end(turned, "force_raw") / end(east, "force_raw"), 1.0, 1e-6);
    EXPECT_NEAR(end(turned, "altitude"), end(east, "altitude"), 1e-6);
    const double angle = std::atan2(end(east, "north"), end(east, "east")) -
                         std::atan2(end(turned, "north"), end(turned, "east"));
    EXPECT_NEAR(angle, 37.0 * pi / 180.0, 1e-6);
}

TEST(FullDemo, BounceDiesOutInALongDescent) {
    // Payload and canopy bounce against each other after the opening. With a reference velocity that
    // leaves the added mass out this grew to slack lines within 10 s.
    Scene scene = c9_scene();
    scene.full.mesh = {1, 9, 16, 3};
    scene.stop = {Trigger::Kind::time, 15.0, 0.0};
    const RunRecord record = run_full(scene);
    const auto& time = record.find_channel("time")->values;
    const auto& force = record.find_channel("force")->values;
    const double weight = 152.4 * standard_gravity;
    double early = 0.0, late = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] > 3.0 && time[i] < 4.0) early = std::max(early, std::abs(force[i] - weight));
        if (time[i] > 14.0) late = std::max(late, std::abs(force[i] - weight));
    }
    EXPECT_GT(early, 0.01 * weight);
    EXPECT_LT(late, 0.01 * weight);
}

TEST(FullDemo, ObliqueReleaseSwingsOutAndMeetsTheRom) {
    Scene scene = c9_scene();
    scene.release.path_angle = 60.0 * pi / 180.0;
    scene.stop = {Trigger::Kind::time, 16.0, 0.0};
    const RunRecord rom = run_rom(scene);
    const RunRecord record = run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_NEAR(*record.metric("peak_force_N") / *rom.metric("peak_force_N"), 1.0, 0.03);
    // The swing shows in the payload's horizontal speed once the release's own is gone, after 4 s: its
    // largest value in windows of 3 s, a little more than half a period (2.8 s), decays.
    const auto& time = record.find_channel("time")->values;
    const auto& speed = record.find_channel("speed")->values;
    const auto& down = record.find_channel("vertical_speed")->values;
    double largest[4] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] < 4.0 || time[i] >= 16.0) continue;
        double& window = largest[static_cast<int>((time[i] - 4.0) / 3.0)];
        window = std::max(window, std::sqrt(std::max(0.0, speed[i] * speed[i] - down[i] * down[i])));
    }
    for (int window = 1; window < 4; ++window)
        EXPECT_LT(largest[window], largest[window - 1]) << window;
    EXPECT_LT(largest[3], 0.5 * largest[0]);
}

}  // namespace
}  // namespace twinchute
