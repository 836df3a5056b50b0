// One parachute and the next: whose the peak is, who waits, what goes on while a pack leaves, what a cut
// leaves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using namespace test;

/// Drogue and main of data/, with these keys in place of theirs.
Scene drogue_then_main(const std::vector<std::string>& keys) {
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-drogue.toml", keys);
}

bool says(const RunRecord& record, std::string_view what) {
    return std::ranges::any_of(record.warnings, [&](const Warning& warning) {
        return (warning.what + ": " + warning.why).find(what) != std::string::npos;
    });
}

TEST(NextParachute, AParachuteThatFillsAsTheNextPullsHasNoPeak) {
    // The largest force of all risers comes later, while the next pulls, and would be called the first one's.
    const auto of_drogue = [](const char* deploys, RunRecord (*run)(const Scene&)) {
        return run(drogue_then_main(
                       {fmt::format("parachute.main.deploy={{by='line-stretch',when={{time={}}}}}", deploys),
                        "parachute.drogue.cut={time=3}", "stop.at='full-open'"}))
            .metric("drogue_peak_force_N");
    };
    for (auto* run : {+[](const Scene& scene) { return run_rom(scene); },
                      +[](const Scene& scene) { return run_full(scene); }}) {
        EXPECT_FALSE(of_drogue("0.6", run));  // 0.1 s after the drogue, which is full 0.2 s after that
        EXPECT_GT(of_drogue("2", run).value_or(0.0), 2000.0);
    }
}

// One that is drawn out by itself snatches; the next one, from line stretch, does not.
TEST(NextParachute, ASnatchIsThatOfTheParachuteFromThePack) {
    const Scene scene = drogue_then_main(
        {"parachute.drogue.deploy={by='mortar',muzzle_speed='15 m/s',when={time=0.2}}", "stop.time=4",
         "parachute.main.deploy={by='line-stretch',when={time=3}}", "parachute.drogue.cut={time=3}"});
    for (const RunRecord& record : {run_rom(scene), run_full(scene)}) {
        EXPECT_TRUE(record.metric("drogue_snatch_force_N")) << record.fidelity << record.status.detail;
        EXPECT_FALSE(record.metric("main_snatch_force_N")) << record.fidelity;
    }
}

// The main opens and fills while the drogue's pack is still drawn out: each has the peak of its own.
TEST(NextParachute, AParachuteThatOpensWhileAPackIsDrawnOutKeepsItsPeak) {
    const Scene scene = drogue_then_main(
        {"parachute.drogue.deploy={by='free',pack_drag_area=0.02,when={at='release'}}",
         "parachute.main.deploy={by='line-stretch',when={time=0.1}}", "parachute.main.fill_time={time=0.3}",
         "parachute.drogue.cut={time=9}", "stop.time=6"});
    const RunRecord record = run_full(scene);
    const auto largest = [&](const char* channel) {
        const Channel* force = record.find_channel(channel);
        return force ? std::ranges::max(force->values) : 0.0;
    };
    ASSERT_LT(record.find_event("main.line-stretch")->time, record.find_event("drogue.snatch")->time);
    const double whole = largest("force");
    ASSERT_TRUE(record.metric("main_peak_force_N"));
    EXPECT_NEAR(*record.metric("main_peak_force_N") / whole, 1.0, 0.05);
    EXPECT_LT(record.metric("drogue_peak_force_N").value_or(0.0), 0.9 * whole);
}

TEST(NextParachute, APackThatWaitsForAnotherSaysSo) {
    const RunRecord record = run_rom(
        drogue_then_main({"parachute.main.deploy.when={time=0.5}",
                          "parachute.drogue.deploy={by='pilot',pilot_drag_area=0.05,when={time=0.5}}"}));
    ASSERT_NE(record.find_event("main.snatch"), nullptr);
    EXPECT_TRUE(says(record, "main left its pack")) << record.status.detail;
    EXPECT_FALSE(says(run_rom(drogue_then_main({})), "left its pack"));
}

TEST(NextParachute, APredictedFillingIsNotFollowedWhileAPackLeaves) {
    const std::vector<std::string> keys{"parachute.drogue.filling='predicted'",
                                        "parachute.drogue.cut={time=20}"};
    const auto with_main_at = [&](const char* time) {
        std::vector<std::string> all = keys;
        all.push_back(fmt::format("parachute.main.deploy.when={{time={}}}", time));
        return run_rom(drogue_then_main(all));
    };
    const RunRecord early = with_main_at("0.55"), later = with_main_at("5");
    EXPECT_EQ(early.status.code, StatusCode::refused);
    EXPECT_NE(early.status.detail.find("drogue still fills while main leaves its pack"), std::string::npos);
    EXPECT_EQ(later.status.code, StatusCode::completed) << later.status.detail;
}

TEST(NextParachute, AirJoinsWithItsMomentumWhileAPackLeaves) {
    // A pack of 10 g without drag, thrown back at 1 m/s on lines of 20 m while the drogue fills, changes the
    // payload by its mass: 1e-4. Without the momentum of the air the peak of the drogue is a fifth lower.
    const auto peak = [](const char* main_at, const char* momentum) {
        return run_rom(drogue_then_main(
                           {fmt::format("aerodynamics.added_mass.momentum='{}'", momentum),
                            "parachute.drogue.cut={time=20}", "parachute.drogue.drag_area=6",
                            "parachute.drogue.nominal_diameter=3.2", "parachute.drogue.vent_diameter=0.3",
                            "parachute.main.mass=0.01", "parachute.main.line_length=20",
                            "parachute.main.deploy.pack_drag_area=0.00001",
                            "parachute.main.deploy.by='mortar'", "parachute.main.deploy.muzzle_speed=1",
                            fmt::format("parachute.main.deploy.when={{time={}}}", main_at)}))
            .metric("drogue_peak_force_N")
            .value_or(0.0);
    };
    EXPECT_NEAR(peak("0.55", "accreting") / peak("5", "accreting"), 1.0, 2e-3);
    EXPECT_LT(peak("0.55", "inertia-only") / peak("0.55", "accreting"), 0.95);
}

TEST(NextParachute, ACutThatLeavesNothingDoesNotHoldUpTheDescent) {
    // Let go on the ground, or never: until then it falls as without.
    const auto rate = [](const std::vector<std::string>& keys) {
        const RunRecord record =
            run_rom(read_text(edited(good_scene, "time = \"6 s\"", "time = \"20 s\""), keys));
        EXPECT_NE(record.find_event("steady-descent"), nullptr);
        return record.metric("descent_rate_m_s").value_or(0.0);
    };
    const double without = rate({});
    EXPECT_GT(without, 7.0);
    // Steps end at other times: within the tolerance of the method, 1e-6.
    EXPECT_NEAR(rate({"parachute.cut={height=0}"}) / without, 1.0, 1e-6);
    EXPECT_NEAR(rate({"parachute.cut={time=3000}"}) / without, 1.0, 1e-6);
    // The first of two that is still to be cut does: the rate is to be that of what lands.
    const RunRecord both =
        run_rom(drogue_then_main({"parachute.drogue.cut={time=40}", "parachute.main.deploy.when={time=3}"}));
    ASSERT_NE(both.find_event("steady-descent"), nullptr);
    EXPECT_GE(both.find_event("steady-descent")->time, 40.0);
}

}  // namespace
}  // namespace twinchute
