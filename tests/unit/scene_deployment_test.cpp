// Deployments in a scene: every kind read, written and overridden; histories of an extraction
// force.
#include <gtest/gtest.h>

#include "lib/scene/deployment.hpp"
#include "lib/scene/soundings.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

std::string deployed(const std::string& by) {
    return edited(good_scene, "by = \"line-stretch\"", by);
}

class SceneDeployment : public testing::Test {
protected:
    SceneDeployment() { here_.write("pull.csv", "force,time\nlbf,ms\n100,0\n200,250\n0,500\n"); }
    Scene read(const std::string& text) const { return read_scene_text(text, "test.toml", here_.path()); }
    ScratchDir here_;
};

TEST_F(SceneDeployment, StaticLine) {
    const Deployment d =
        read(deployed("by = \"static-line\", length = \"40 ft\", anchor = \"fixed\"")).parachutes[0].deploy;
    EXPECT_EQ(d.by, DeployBy::static_line);
    EXPECT_NEAR(d.static_line_length, 12.192, 1e-12);
    EXPECT_FALSE(d.anchor_moves);
    EXPECT_TRUE(d.starts_packed());
    EXPECT_EQ(d.pack_drag_area, 0.0);
    EXPECT_EQ(d.pack_ratio, 0.01);  // defaults
    EXPECT_EQ(d.drag_coefficient, 0.1);
    EXPECT_EQ(d.deployment_resistance, 2.0);
    EXPECT_TRUE(read(deployed("by = \"static-line\", length = 3")).parachutes[0].deploy.anchor_moves);
}

TEST_F(SceneDeployment, FreeAndInflated) {
    const Deployment d = read(deployed("by = \"free\", pack_drag_area = \"0.2 m^2\", pitch = \"30 deg\""))
                             .parachutes[0]
                             .deploy;
    EXPECT_EQ(d.by, DeployBy::free);
    EXPECT_EQ(d.pack_drag_area, 0.2);
    EXPECT_NEAR(d.pitch, 0.5235987755982988, 1e-15);
    const Deployment open = read(deployed("by = \"inflated\"")).parachutes[0].deploy;
    EXPECT_FALSE(open.starts_packed());
    EXPECT_EQ(open.pack_ratio, 0.0);  // what is not of its kind stays zero
}

TEST_F(SceneDeployment, ExtractionByAForceOrATable) {
    const Deployment held =
        read(deployed("by = \"extraction\", force = \"2 kN\", duration = 0.5")).parachutes[0].deploy;
    EXPECT_EQ(held.extraction.at(0.0), 2000.0);
    EXPECT_EQ(held.extraction.at(0.5), 2000.0);
    EXPECT_EQ(held.extraction.at(0.6), 0.0);
    EXPECT_TRUE(held.extraction_on_apex);
    const Deployment table =
        read(deployed("by = \"extraction\", force_table = \"pull.csv\", load = \"distributed\""))
            .parachutes[0]
            .deploy;
    EXPECT_FALSE(table.extraction_on_apex);
    EXPECT_NEAR(table.extraction.at(0.125), 150.0 * 4.4482216152605, 1e-9);
    EXPECT_NEAR(table.extraction.at(0.375), 100.0 * 4.4482216152605, 1e-9);
}

TEST_F(SceneDeployment, IsWrittenAndReadBack) {
    for (const char* by :
         {"by = \"line-stretch\"", "by = \"inflated\"", "by = \"free\"",
          "by = \"free\", pack_drag_area = 0.3", "by = \"static-line\", length = 12.2",
          "by = \"static-line\", length = 0.1, anchor = \"fixed\", pitch = -1",
          "by = \"extraction\", force = 700, load = \"distributed\", deployment_resistance = 0",
          "by = \"extraction\", force_table = \"pull.csv\", duration = 0.3, pack_ratio = 0.2"}) {
        const Scene scene = read(deployed(by));
        const std::string text = write_scene(scene);
        EXPECT_TRUE(same_scene(scene, read(text))) << text;
        EXPECT_EQ(write_scene(read(text)), text);
    }
}

TEST_F(SceneDeployment, RetiredNamesAreReadWithAWarning) {
    const Scene now =
        read(deployed("by = \"static-line\", length = 12.2, anchor = \"fixed\", "
                      "compressive_stiffness_ratio = 1e-4, deployment_resistance = 3"));
    EXPECT_TRUE(now.warnings.empty());
    const Scene scene =
        read(deployed("by = \"static-line\", length = 12.2, far_end = \"fixed\", "
                      "fold_repulsion = 1e-4, fold_resistance = 3"));
    EXPECT_TRUE(same_scene(scene, now));
    EXPECT_NE(find_input(scene, "parachute.deploy.anchor"), nullptr);
    EXPECT_EQ(find_input(scene, "parachute.deploy.far_end"), nullptr);
    ASSERT_EQ(scene.warnings.size(), 3u);
    EXPECT_EQ(scene.warnings[0].what, "key 'parachute.deploy.far_end' is now 'parachute.deploy.anchor'");
    EXPECT_EQ(scene.warnings[0].why, "line 13 of test.toml");
    EXPECT_EQ(scene.warnings[1].what,
              "key 'parachute.deploy.fold_repulsion' is now 'parachute.deploy.compressive_stiffness_ratio'");
}

TEST_F(SceneDeployment, RetiredNamesMayOverrideAndBeOverridden) {
    const std::string old = deployed("by = \"free\", fold_resistance = 3");
    const auto resistances = [&](const std::string& text, const std::vector<std::string>& overrides) {
        std::vector<double> all;
        for (const Scene& scene : read_scenes_text(text, "test.toml", here_.path(), overrides))
            for (const Parachute& chute : scene.parachutes)
                all.push_back(chute.deploy.deployment_resistance);
        return all;
    };
    EXPECT_EQ(resistances(old, {"parachute.deploy.deployment_resistance=4"}), std::vector{4.0});
    EXPECT_EQ(resistances(old, {"parachute.deploy.fold_resistance=5"}), std::vector{5.0});
    EXPECT_EQ(resistances(old + "[[case]]\nname = \"a\"\nset = { \"parachute.deploy.fold_resistance\" = 6 }\n"
                                "[[case]]\nname = \"b\"\n",
                          {}),
              (std::vector{6.0, 3.0}));
    const Scene set = read_text(deployed("by = \"free\""), {"parachute.deploy.fold_resistance=5"});
    ASSERT_EQ(set.warnings.size(), 1u);
    EXPECT_EQ(set.warnings[0].why, "--set");
    // Each parachute warns once, whichever of several it is.
    const std::string second =
        "[[parachute]]\nname = \"second\"\ndesign = \"usaf-c9\"\n"
        "deploy = { by = \"free\", fold_resistance = 7, when = { time = 2 } }\n"
        "fill_time = { model = \"fill-constant\", n = 4.0 }\n";
    const std::string two = edited(edited(old, "[[parachute]]\n", "[[parachute]]\nname = \"first\"\n"),
                                   "[aerodynamics]", second + "[aerodynamics]");
    EXPECT_EQ(resistances(two, {"parachute.second.deploy.fold_resistance=8"}), (std::vector{3.0, 8.0}));
    EXPECT_EQ(read(two).warnings.size(), 2u);
}

TEST_F(SceneDeployment, AnotherKindInACaseDropsWhatGoesWithTheFirst) {
    const std::string text =
        deployed("by = \"static-line\", length = 12.2, anchor = \"fixed\", pitch = 0.5") +
        "[[case]]\nname = \"crane\"\n"
        "[[case]]\nname = \"free\"\nset = { \"parachute.deploy.by\" = \"free\", "
        "\"parachute.deploy.pack_drag_area\" = 0.2 }\n"
        "[[case]]\nname = \"drawn\"\nset = { \"parachute.deploy\" = { by = \"extraction\", force = 500 } }\n"
        "[[case]]\nname = \"stretched\"\nset = { \"parachute.deploy.by\" = \"line-stretch\" }\n";
    const auto scenes = read_scenes_text(text, "test.toml", here_.path());
    ASSERT_EQ(scenes.size(), 4u);
    EXPECT_EQ(scenes[0].parachutes[0].deploy.static_line_length, 12.2);
    EXPECT_EQ(scenes[1].parachutes[0].deploy.by, DeployBy::free);
    EXPECT_EQ(scenes[1].parachutes[0].deploy.static_line_length, 0.0);
    EXPECT_EQ(scenes[1].parachutes[0].deploy.pitch, 0.5);  // goes with both
    EXPECT_EQ(find_input(scenes[1], "parachute.deploy.length"), nullptr);
    EXPECT_EQ(scenes[2].parachutes[0].deploy.extraction.at(1.0), 500.0);
    EXPECT_EQ(scenes[3].parachutes[0].deploy, Deployment{});
    // From the command line just the same.
    EXPECT_EQ(read_text(deployed("by = \"static-line\", length = 12.2"), {"parachute.deploy.by=inflated"})
                  .parachutes[0]
                  .deploy.by,
              DeployBy::inflated);
}

TEST_F(SceneDeployment, PackedAndInflatedStartsMayBeAtRest) {
    const std::string at_rest =
        edited(good_scene, "speed = \"21 m/s\"\npath_angle = \"90 deg\"", "speed = 0");
    for (const char* by : {"by = \"inflated\"", "by = \"free\"", "by = \"static-line\", length = 12"})
        EXPECT_NO_THROW(read(edited(at_rest, "by = \"line-stretch\"", by))) << by;
    EXPECT_THROW(read(at_rest), SceneError);
}

TEST_F(SceneDeployment, AnOpenCanopyNeedsNoFillingTime) {
    const std::string open = edited(edited(good_scene, "\"line-stretch\"", "\"inflated\""),
                                    "fill_time = { model = \"fill-constant\", n = 4.0 }\n", "");
    EXPECT_EQ(complaint(open), "");
    const Scene scene = read_text(open);
    EXPECT_EQ(find_input(scene, "parachute.fill_time.n"), nullptr);
    // It may stand there all the same, and the way back has what was given.
    EXPECT_EQ(complaint(edited(good_scene, "\"line-stretch\"", "\"inflated\"")), "");
    EXPECT_EQ(read_text(write_scene(scene)).parachutes[0].fill_time.n, scene.parachutes[0].fill_time.n);
    // Whatever fills needs it.
    const std::string fills = edited(good_scene, "fill_time = { model = \"fill-constant\", n = 4.0 }\n", "");
    EXPECT_NE(complaint(fills).find("parachute.fill_time.n: is missing"), std::string::npos)
        << complaint(fills);
}

TEST(ForceHistory, IsLinearBetweenItsPointsAndNothingBeyond) {
    const ForceHistory force{"", {0.5, 1.0, 3.0}, {100.0, 300.0, 0.0}, 2.0};
    EXPECT_EQ(force.at(0.4), 0.0);
    EXPECT_EQ(force.at(0.5), 100.0);
    EXPECT_EQ(force.at(0.75), 200.0);
    EXPECT_EQ(force.at(1.0), 300.0);
    EXPECT_EQ(force.at(2.0), 150.0);  // to the end of the duration, included
    EXPECT_EQ(force.at(2.1), 0.0);
    EXPECT_EQ(ForceHistory{}.at(0.0), 0.0);
}

TEST(ForceTable, MistakesHaveTheirPlace) {
    const struct {
        const char *text, *begins, *says;
    } bad_ones[] = {
        {"time,pull\ns,N\n0,1\n1,2\n", "f.csv:1:6: ", "pull"},
        {"time\ns\n0\n1\n", "f.csv:1:1: ", "the column 'force' is missing"},
        {"time,force\ns,kg\n0,1\n1,2\n", "f.csv:2:3: ", "expected N"},
        {"time,force\ns,N\n-0.1,1\n1,2\n", "f.csv:3:1: ", "out of range"},
        {"time,force\ns,N\n0,-1\n1,2\n", "f.csv:3:3: ", "out of range"},
        {"time,force\ns,N\n0,1\n0,2\n", "f.csv:4:1: ", ""},
        {"time,force\ns,N\n0,1\n", "f.csv:", ""},
        {"time,force\ns,N\n0,1\n1,nan\n", "f.csv:4:3: ", ""},
    };
    for (const auto& bad : bad_ones) {
        try {
            read_force_table(bad.text, "f.csv", "f.csv", 1.0);
            ADD_FAILURE() << "was read: " << bad.text;
        } catch (const SceneError& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with(bad.begins)) << what;
            EXPECT_NE(what.find(bad.says), std::string::npos) << what;
        }
    }
}

}  // namespace
}  // namespace twinchute::test
