// `twinchute plan` as a script sees it: standard output alone, nothing on the disk, exit codes as promised.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

using nlohmann::json;
using test::Ended;
using test::Process;
using Words = std::vector<std::string>;

const std::string demo = TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml";
const std::string crane_drop = TWINCHUTE_SOURCE_DIR "/data/scenes/paper/crane-drop.toml";

class SystemPlan : public testing::Test {
protected:
    Ended plan(Words words) {
        words.insert(words.begin(), {TWINCHUTE_PROGRAM, "plan"});
        return Process(words, here_.path()).wait();
    }
    json plan_json(Words words) {
        words.emplace_back("--json");
        const Ended ended = plan(words);
        EXPECT_EQ(ended.code, 0) << ended.err;
        return json::parse(ended.out);
    }
    bool nothing_written() const { return tree_of(here_.path()).empty(); }

    ScratchDir here_;
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
    const Words free{TWINCHUTE_SOURCE_DIR "/data/scenes/paper/free-2000m.toml", "--set",
                     "parachute.deploy.pack_drag_area=0"};
    const json all = plan_json(free);
    EXPECT_EQ(all["plans"][0]["lacks"], json::array({"parachute.deploy.pack_drag_area"}));
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
}  // namespace twinchute
