// Several parachutes, clusters, reefing and what they wait for: how a scene says it, and how it is refused.
#include <gtest/gtest.h>

#include "lib/scene/write_scene.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using namespace test;

const std::string reefed = edited(good_scene, "[aerodynamics]\n", R"(name = "main"
[[parachute.reefing]]
drag_area_ratio = 0.1
until = { at = "line-stretch", delay = "4 s" }
[[parachute.reefing]]
drag_area_ratio = 0.4
line_length = "9 m"
fill_time = { n = 6 }
until = { after = "main.line-stretch", delay = "8 s" }
[aerodynamics]
)");

/// The second parachute begins in line 19.
const std::string two = edited(good_scene, "[aerodynamics]\n", R"(name = "drogue"
cut = { after = "main.full-open", delay = "1 s" }
[[parachute]]
name = "main"
design = "usaf-c9"
deploy = { by = "line-stretch", when = { height = "150 m" } }
fill_time = { time = "2 s" }
[aerodynamics]
)");

TEST(SceneParachutes, ReefingIsAListOfStages) {
    const Parachute p = read_text(reefed).parachutes.front();
    ASSERT_EQ(p.reefing.size(), 2u);
    EXPECT_EQ(p.reefing[0].drag_area_ratio, 0.1);
    EXPECT_EQ(p.reefing[0].until, (Trigger{Trigger::Kind::line_stretch, 0.0, 4.0}));
    EXPECT_FALSE(p.reefing[0].line_length || p.reefing[0].fill_time);
    EXPECT_EQ(p.reefing[1].line_length, 9.0);
    EXPECT_EQ(p.reefing[1].fill_time->n, 6.0);
    EXPECT_EQ(p.reefing[1].until, (Trigger{Trigger::Kind::line_stretch, 0.0, 8.0}));  // by its own name
    EXPECT_NE(find_input(read_text(reefed), "parachute.reefing.2.fill_time.n"), nullptr);
}

TEST(SceneParachutes, ASceneThatIsWrittenReadsTheSame) {
    const std::string cluster =
        edited(good_scene, "design =", "count = 3\nlag = [0, \"0.4 s\", 1]\ndesign =");
    for (const std::string& text : {reefed, two, cluster}) {
        const Scene scene = read_text(text);
        EXPECT_TRUE(same_scene(scene, read_text(write_scene(scene)))) << write_scene(scene);
    }
}

TEST(SceneParachutes, WhatIsNoCircleIsRead) {
    // Each waits for the other, but for things that come one after the other.
    const std::string chain =
        edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.full-open\" }");
    EXPECT_EQ(complaint(chain), "");
    EXPECT_EQ(complaint(edited(chain, "cut = { after = \"main.full-open\", delay = \"1 s\" }",
                               "cut = { after = \"main.line-stretch\" }")),
              "");
    // Reefed until the other snatches, which waits for the reefed canopy's own snatch alone.
    EXPECT_EQ(
        complaint(edited(
            edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.line-stretch\" }"),
            "cut = { after = \"main.full-open\", delay = \"1 s\" }",
            "cut = { after = \"main.full-open\" }\nreefing = [ { drag_area_ratio = 0.3, until = { after "
            "= \"main.line-stretch\" } } ]")),
        "");
    // The last of its own stages opens the canopy that is then let go.
    EXPECT_EQ(
        complaint(edited(reefed, "name = \"main\"\n", "name = \"main\"\ncut = { at = \"full-open\" }\n")),
        "");
}

TEST(SceneParachutes, OverridesNameAMember) {
    EXPECT_EQ(read_text(reefed, {"parachute.reefing.2.drag_area_ratio=0.5"})
                  .parachutes[0]
                  .reefing[1]
                  .drag_area_ratio,
              0.5);
    EXPECT_EQ(read_text(two, {"parachute.drogue.mass=1 kg"}).parachutes[0].mass, 1.0);
    EXPECT_EQ(read_text(two, {"parachute.main.mass=2 kg"}).parachutes[1].mass, 2.0);
    EXPECT_EQ(read_text(two, {"parachute.2.mass=2 kg"}).parachutes[1].mass, 2.0);
    // Another condition takes the place of the one that was there.
    EXPECT_EQ(read_text(reefed, {"parachute.reefing.1.until.time=3 s"}).parachutes[0].reefing[0].until.kind,
              Trigger::Kind::time);
    // A key of a list without a number is of no member, however many there are.
    for (const std::string& scene : {reefed, good_scene}) {
        try {
            read_text(scene, {"parachute.reefing.drag_area_ratio=0.5"});
            ADD_FAILURE() << "read, and of no effect";
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find("parachute.reefing.1.drag_area_ratio"),
                      std::string::npos)
                << error.what();
        }
    }
    // A list as a whole takes the place of the list.
    const std::string list = R"(parachute.reefing=[{ drag_area_ratio = 0.2, until = { time = "3 s" } }])";
    EXPECT_EQ(read_text(reefed, {list}).parachutes[0].reefing.size(), 1u);
    const auto cases =
        read_scenes_text(two + "[[case]]\nname = \"a\"\nset = { \"parachute.main.mass\" = 3 }\n", "test.toml",
                         TWINCHUTE_SOURCE_DIR "/data", {});
    EXPECT_EQ(cases.front().parachutes[1].mass, 3.0);
}

TEST(SceneParachutes, InputsCarryTheNamesOfSeveral) {
    const Scene scene = read_text(two);
    EXPECT_NE(find_input(scene, "parachute.drogue.nominal_diameter"), nullptr);
    EXPECT_NE(find_input(scene, "parachute.main.fill_time.time"), nullptr);
    EXPECT_EQ(find_input(scene, "parachute.nominal_diameter"), nullptr);
    EXPECT_NE(find_input(read_text(good_scene), "parachute.nominal_diameter"), nullptr);
}

struct Wrong {
    const char* what;
    std::string text;
    std::vector<std::string> overrides;
    std::vector<const char*> says;
};

TEST(SceneParachutes, WhatDoesNotFitIsRefusedAtItsPlace) {
    const Wrong rows[] = {
        {"ratios that fall",
         edited(reefed, "drag_area_ratio = 0.4", "drag_area_ratio = 0.05"),
         {},
         {"test.toml:20", "reefing.2.drag_area_ratio", "0.05 does not rise", "0.1"}},
        {"below the initial one",
         edited(reefed, "drag_area_ratio = 0.1", "drag_area_ratio = 0.03"),
         {},
         {"test.toml:17", "initial_drag_area_ratio = 0.04"}},
        {"no condition",
         edited(reefed, "until = { at = \"line-stretch\", delay = \"4 s\" }\n", ""),
         {},
         {"reefing.1.until.at", "is missing"}},
        {"two conditions",
         edited(reefed, "at = \"line-stretch\",", "at = \"line-stretch\", time = 3,"),
         {},
         {"test.toml:18", "stands beside"}},
        {"an unknown key",
         edited(reefed, "line_length = \"9 m\"", "line_lenght = \"9 m\""),
         {},
         {"test.toml:21", "unknown key", "line_length"}},
        {"an unknown event",
         edited(reefed, "main.line-stretch", "main.stretch"),
         {},
         {"test.toml:23", "not an event"}},
        {"an unknown parachute",
         edited(reefed, "main.line-stretch", "mian.line-stretch"),
         {},
         {"test.toml:23", "there is no parachute 'mian'"}},
        {"a gap in the list",
         reefed,
         {"parachute.reefing.4.drag_area_ratio=0.5"},
         {"--set", "there is no member 4", "has 2"}},
        {"not a list",
         edited(good_scene, "[aerodynamics]\n", "reefing = 3\n[aerodynamics]\n"),
         {},
         {"test.toml:15", "where a list belongs", "[[parachute.reefing]]"}},
        {"whose key?", two, {"parachute.mass=3"}, {"--set", "several parachutes", "parachute.NAME.mass"}},
        {"an unknown name", two, {"parachute.mian.mass=3"}, {"--set", "no parachute has that name", "main"}},
        {"one name twice",
         edited(two, "name = \"main\"", "name = \"drogue\""),
         {},
         {"test.toml:18", "two parachutes are called 'drogue'"}},
        {"names with the same metrics",
         edited(two, "name = \"main\"", "name = \"Drogue\""),
         {},
         {"test.toml:18", "'drogue' and 'Drogue' have the same metrics, drogue_..."}},
        {"a key for a name",
         edited(two, "name = \"main\"", "name = \"mass\""),
         {},
         {"test.toml:18", "name of a key"}},
        {"waits for itself",
         edited(two, "when = { height = \"150 m\" }", "when = { at = \"full-open\" }"),
         {},
         {"test.toml:20", "cannot wait for its own"}},
        {"waits for its own cut",
         edited(two, "when = { height = \"150 m\" }",
                "when = { height = \"150 m\" } }\ncut = { after = \"main.cut\""),
         {},
         {"test.toml:21", "cannot wait for its own cut"}},
        {"sizes one that is not there",
         edited(two, "[stop]", "[size]\nparachute = \"mian\"\nmax_force = 1000\n[stop]"),
         {},
         {"size.parachute", "there is no parachute 'mian'"}},
        {"wait for each other",
         edited(edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.cut\" }"),
                "deploy = { by = \"line-stretch\" }",
                "deploy = { by = \"line-stretch\", when = { after = \"main.cut\" } }"),
         {},
         {"wait for each other"}},
        {"a circle of two",
         edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.cut\" }"),
         {},
         {"test.toml:16", "parachute.cut.after", "wait for each other",
          "drogue.cut waits for main.full-open, main.full-open for main.line-stretch,",
          "main.line-stretch for drogue.cut", "let one of them wait for"}},
        {"a circle through a reefing line",
         edited(edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.full-open\" }"),
                "cut = { after = \"main.full-open\", delay = \"1 s\" }",
                "reefing = [ { drag_area_ratio = 0.3, until = { after = \"main.line-stretch\" } } ]"),
         {},
         {"wait for each other",
          "drogue.reefing.1 waits for main.line-stretch, main.line-stretch for drogue.full-open, "
          "drogue.full-open for drogue.reefing.1"}},
        {"a circle of three",
         edited(edited(two, "when = { height = \"150 m\" }", "when = { after = \"pilot.cut\" }"),
                "[aerodynamics]\n",
                "[[parachute]]\nname = \"pilot\"\ndesign = \"usaf-c9\"\n"
                "deploy = { by = \"line-stretch\", when = { after = \"drogue.cut\" } }\n"
                "fill_time = { time = 1 }\ncut = { time = 9 }\n[aerodynamics]\n"),
         {},
         {"wait for each other", "pilot.cut for pilot.line-stretch", "drogue.cut waits for main.full-open"}},
        {"the cut of one that is never cut",
         edited(edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.cut\" }"),
                "cut = { after = \"main.full-open\", delay = \"1 s\" }\n", ""),
         {},
         {"test.toml:19", "parachute.deploy.when.after", "'drogue' is never cut",
          "give that parachute a cut"}},
        {"a reefing line that outlasts its parachute",
         edited(edited(two, "when = { height = \"150 m\" }", "when = { after = \"drogue.cut\" }"),
                "cut = { after = \"main.full-open\", delay = \"1 s\" }",
                "cut = { time = 5 }\n"
                "reefing = [ { drag_area_ratio = 0.3, until = { after = \"main.line-stretch\" } } ]"),
         {},
         {"reefing.1.until.after", "cut after the parachute itself", "main.line-stretch for drogue.cut"}},
        {"an altitude below the ground",
         edited(two, "when = { height = \"150 m\" }", "when = { altitude = \"-1 m\" }"),
         {},
         {"test.toml:20", "deploy.when.altitude", "lies below the ground"}},
        {"two leave at once",
         edited(edited(two, "by = \"line-stretch\", when = { height = \"150 m\" }",
                       "by = \"free\", pack_drag_area = 1"),
                "deploy = { by = \"line-stretch\" }", "deploy = { by = \"free\", pack_drag_area = 1 }"),
         {},
         {"two parachutes leave their packs"}},
        {"lags that do not fit",
         edited(good_scene, "design =", "count = 3\nlag = [0, 1]\ndesign ="),
         {},
         {"2 times for 3 parachutes"}},
    };
    for (const Wrong& row : rows) {
        const std::string why = complaint(row.text, row.overrides);
        EXPECT_NE(why, "") << row.what;
        for (const char* part : row.says)
            EXPECT_NE(why.find(part), std::string::npos) << row.what << ": " << part << " in\n" << why;
    }
}

}  // namespace
}  // namespace twinchute
