// `twinchute plan` as a script sees it: standard output alone, nothing on the disk, exit codes as promised.
#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

const std::string demo = shipped_scene("c9-inflation");
const std::string crane_drop = shipped_scene("paper/crane-drop");

class SystemPlan : public ProgramTest {
protected:
    Ended plan(const Words& words) const { return ProgramTest::run(Words{"plan"} + words); }
    json plan_json(Words words) {
        words.emplace_back("--json");
        const Ended ended = plan(words);
        EXPECT_EQ(ended.code, 0) << ended.err;
        return json::parse(ended.out);
    }
};

bool has(const json& parts, const std::string& name) {
    return std::ranges::any_of(parts, [&](const json& part) { return part["name"] == name; });
}

TEST_F(SystemPlan, PrintsBothFidelitiesAndWritesNothing) {
    const Ended ended = plan({demo});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    for (const char* words : {"reduced-order model", "full aeroelastic model", "needed", "left out", "memory",
                              "cost", "line drag", "payload.drag_area is absent"})
        EXPECT_NE(ended.out.find(words), std::string::npos) << words;
    EXPECT_EQ(plan({demo, "--quiet"}).out, "");
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemPlan, OverridesMoveAPieceFromOneListToTheOther) {
    for (const bool given : {false, true}) {
        const json all = given ? plan_json({demo, "--set", "payload.drag_area=0.4"}) : plan_json({demo});
        ASSERT_EQ(all["plans"].size(), 2u);
        for (const json& one : all["plans"]) {
            EXPECT_EQ(has(one["needed"], "payload drag"), given) << one["fidelity"];
            EXPECT_EQ(has(one["left_out"], "payload drag"), !given) << one["fidelity"];
        }
        EXPECT_EQ(all["plans"][0]["fidelity"], "rom");
    }
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemPlan, StagesAreThoseOfTheRunAndAddUp) {
    const json full = plan_json({crane_drop, "--set", "full.mesh.gore_columns=1", "--set",
                                 "full.mesh.gore_rows=6", "--set", "full.mesh.line_elements=6"})["plans"][1];
    long long steps = 0;
    Words names;
    for (const json& stage : full["stages"]) {
        names.push_back(stage["name"]);
        steps += stage["steps"].get<long long>();
        EXPECT_GT(stage["wall_s"], 0.0);
    }
    EXPECT_EQ(names, (Words{"deployment", "springs", "ramp", "filling", "open canopy"}));
    EXPECT_NEAR(static_cast<double>(steps), full["steps"], 5.0);  // each is rounded
}

TEST_F(SystemPlan, AModelThatCannotRunTheSceneSaysSo) {
    const Words free{shipped_scene("paper/free-2000m"), "--set", "parachute.deploy.pack_drag_area=0"};
    const json all = plan_json(free);
    EXPECT_EQ(all["plans"][0]["unsupported_keys"], json::array({"parachute.deploy.pack_drag_area"}));
    EXPECT_FALSE(all["plans"][1].contains("wall_s"));
    EXPECT_GT(all["plans"][1]["stages"][0]["wall_per_step_s"], 0.0);
}

TEST_F(SystemPlan, ASeriesHasAPlanForEachCase) {
    EXPECT_EQ(plan_json({TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation-speeds.toml"}).size(), 3u);
}

TEST_F(SystemPlan, BadInputIsRefused) {
    here_.write("broken.toml", "schema = 1\nname = \"no parachute\"\n");
    const auto before = tree_of(here_.path());
    for (const Words& words : {Words{"broken.toml"}, Words{"missing.toml"}, Words{demo, "--threads", "none"},
                               Words{demo, "--out", "there"}}) {
        const Ended ended = plan(words);
        EXPECT_EQ(ended.code, 2) << words.back();
        EXPECT_EQ(ended.out, "");
        EXPECT_NE(ended.err, "");
    }
    EXPECT_EQ(tree_of(here_.path()), before);
}

}  // namespace
}  // namespace twinchute::test
