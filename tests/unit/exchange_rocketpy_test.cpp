// RocketPy's parachutes, read and written. The flight in data/import/ is written by hand in RocketPy's keys.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/cli/command.hpp"
#include "lib/exchange/export_command.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "rom/fidelity.hpp"

namespace twinchute::test {
namespace {

using namespace twinchute::exchange;

const std::string example_flight = TWINCHUTE_SOURCE_DIR "/data/import/rocketpy-flight.rpy";

Scene rocketpy_scene(const ImportedScene& made) {
    EXPECT_EQ(missing_values(made), std::vector<std::string>{});
    return read_scene_text(scene_text(made, "f.rpy", ""), "t.toml", ".");
}

TEST(RocketPy, TakesTheParachutesOfAFlight) {
    const ImportedScene made = read_rocketpy(read_text_file(example_flight), "f.rpy", {});
    const Scene scene = rocketpy_scene(made);
    ASSERT_EQ(scene.parachutes.size(), 2u);
    const Parachute &main = scene.parachutes[0], &drogue = scene.parachutes[1];
    EXPECT_NEAR(main.drag_area, 8.0, 1e-12);
    EXPECT_NEAR(drogue.drag_area, 0.9, 1e-12);
    EXPECT_NEAR(scene.payload.mass + main.mass + drogue.mass, 15.0, 1e-4);  // rocket and empty motor
    EXPECT_EQ(drogue.deploy_when->kind, Trigger::Kind::apogee);
    EXPECT_NEAR(drogue.deploy_when->delay, 0.3, 1e-12);
    // Its trigger is code; it met it at 50 s, 600 m above sea level and 500 m above ground.
    EXPECT_EQ(main.deploy_when->kind, Trigger::Kind::altitude);
    EXPECT_NEAR(main.deploy_when->value, 600.0, 1e-9);
    EXPECT_NEAR(main.deploy_when->delay, 1.2, 1e-12);
    ASSERT_TRUE(drogue.cut);  // RocketPy flies on with the newest parachute alone
    EXPECT_EQ(drogue.cut->of, "main");
    EXPECT_FALSE(main.cut);
    EXPECT_NEAR(scene.release.altitude, 900.0, 1e-9);
    EXPECT_NEAR(scene.release.speed, 10.0, 1e-9);                    // 6 m/s east, 8 m/s north
    EXPECT_NEAR(scene.release.heading, std::atan2(6.0, 8.0), 1e-6);  // six digits are written
    EXPECT_NEAR(scene.environment.wind->levels.front().velocity.x(), 3.0, 1e-9);
    EXPECT_NEAR(scene.environment.gravity, 9.8 - 0.003 * 0.1, 1e-6);  // linear between its levels
    EXPECT_NEAR(made.stated_landing_speed.value(), 5.479, 1e-12);
}

TEST(RocketPy, ParametersAloneNeedMassAndHeight) {
    const std::string one =
        R"({"name": "Main", "cd_s": 10.0, "trigger": 800, "sampling_rate": 105, "lag": 1.5,
                                "noise": [0, 8.3, 0.5], "radius": 1.5})";
    ImportedScene made = read_rocketpy(one, "p.json", {});
    // Nothing opens at apogee: how fast it falls until 800 m is not known either.
    ASSERT_EQ(missing_values(made).size(), 3u);
    set_keys(made, {"payload.mass=15 kg", "release.height=3 km", "payload.drag_area=0.02 m^2"});
    const Scene scene = rocketpy_scene(made);
    EXPECT_NEAR(scene.parachutes[0].deploy_when->value, 800.0, 1e-12);
    const std::string two =
        "[" + one + ", {\"name\": \"Drogue\", \"cd_s\": 1.0, \"trigger\": \"Apogee\", \"lag\": 0}]";
    made = read_rocketpy(two, "p.json", {});
    EXPECT_EQ(missing_values(made).size(), 2u);
    EXPECT_EQ(read_rocketpy(two, "p.json", {{"Drogue"}, ""}).tables.size(), 6u);  // one parachute
    const std::string code = R"({"name": "Main", "cd_s": 10.0, "trigger": "80049500"})";
    // The order of parachutes whose triggers are code is not known: none is cut.
    const ImportedScene both = read_rocketpy("[" + code + "," + one + "]", "p.json", {});
    for (const ImportedTable& table : both.tables)
        EXPECT_TRUE(
            std::ranges::none_of(table.keys, [](const ImportedKey& key) { return key.key == "cut"; }));
    const auto missing = missing_values(read_rocketpy(code, "p.json", {}));
    EXPECT_TRUE(std::ranges::any_of(
        missing, [](const std::string& m) { return m.starts_with("parachute.deploy.when"); }));
}

TEST(RocketPy, RefusesWhatItCannotRead) {
    for (const auto& [json, message] :
         {std::pair<std::string, std::string>{"{", "not JSON"},
          {"[1e999]", "too large"},
          {"{}", "has no parachutes"},
          {"[]", "has no parachutes"},
          {R"([{"cd_s": "x", "trigger": 1}])", "parachutes[0].cd_s: '\"x\"' is not taken"},
          {R"([{"cd_s": -1, "trigger": 1}])", "is not taken"},
          {R"([{"cd_s": NaN, "trigger": 1}])", "is not taken"},
          {R"([{"cd_s": 1}])", "trigger: is missing"},
          {R"([{"cd_s": 1, "trigger": []}])", "is not understood"},
          {R"([{"cd_s": 1, "trigger": 1, "lag": -1}])", "lag"},
          {R"({"rocket": {"parachutes": [{"cd_s": 1, "trigger": 1}]}, "solution": [[1, 2]]})",
           "solution[0]: is no state"}}) {
        try {
            read_rocketpy(json, "p.json", {});
            ADD_FAILURE() << json;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    }
}

TEST(RocketPy, WrittenParachutesHaveTheScenesDragAreaTriggerAndLag) {
    const Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/rocket-dual-deploy.toml");
    twinchute::Run run;
    const RunRecord record = rom::rom_fidelity().run(scene, run);
    const std::string text = rocketpy_text(scene, record);
    const auto has = [&](const std::string& what) { return text.find(what) != std::string::npos; };
    EXPECT_TRUE(has(fmt::format("cd_s={:.6g},", scene.parachutes[0].drag_area))) << text;
    EXPECT_TRUE(has(fmt::format("cd_s={:.6g},", scene.parachutes[1].drag_area)));
    EXPECT_TRUE(has("trigger=\"apogee\","));
    EXPECT_TRUE(has("trigger=213.36,"));  // 700 ft
    // RocketPy's lag ends where the canopy is full: half a second and the filling.
    EXPECT_TRUE(has(fmt::format("lag={:.6g},", 0.5 + record.metric("main_filling_time_s").value()))) << text;
    EXPECT_TRUE(has("RocketPy then drops it, this scene keeps both"));
    EXPECT_THROW(rocketpy_text(read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/sonde.toml"), record),
                 UsageError);
}

TEST(RocketPy, AClusterIsOneParachuteThere) {
    const Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/rocket-dual-deploy.toml",
                                   {"parachute.main.count=3", "parachute.main.cluster_drag_ratio=0.9"});
    const std::string text = rocketpy_text(scene, {});
    EXPECT_NE(text.find(fmt::format("cd_s={:.6g},", 2.7 * scene.parachutes[1].drag_area)), std::string::npos)
        << text;
    EXPECT_NE(text.find("left out: filling time"), std::string::npos);  // of a record without one
}

}  // namespace
}  // namespace twinchute::test
