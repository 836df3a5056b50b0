// Scenes that start from another one, and series of cases.
#include <gtest/gtest.h>

#include "lib/scene/write_scene.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

std::string complaint_of(const std::filesystem::path& file, const std::vector<std::string>& overrides = {}) {
    try {
        read_scenes(file, overrides);
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

TEST(SceneBase, GivesWhatTheSceneDoesNot) {
    ScratchDir here;
    here.write("base.toml", good_scene);
    here.write("scene.toml", "base = \"base.toml\"\nname = \"heavy\"\npayload.mass = \"200 kg\"\n");
    const Scene base = read_scene(here / "base.toml"), scene = read_scene(here / "scene.toml");
    EXPECT_EQ(scene.name, "heavy");
    EXPECT_EQ(scene.payload.mass, 200.0);
    EXPECT_EQ(scene.file, here / "scene.toml");
    EXPECT_EQ(std::get<std::string>(find_input(scene, "base")->value), "base.toml");
    Scene like_base = scene;
    like_base.name = base.name;
    like_base.payload.mass = base.payload.mass;
    EXPECT_TRUE(same_scene(like_base, base));
}

TEST(SceneBase, IsThatOfTheFileWhereverTheSameTextWasReadBefore) {
    // Texts that come again are not parsed again: they are to stand for their own directory, and for the file
    // as it is now.
    ScratchDir here, there;
    here.write("base.toml", good_scene);
    there.write("base.toml", edited(good_scene, "152.4 kg", "99 kg"));
    const auto mass = [](const ScratchDir& directory) {
        return read_scene_text("base = \"base.toml\"\n", "scene.toml", directory.path()).payload.mass;
    };
    for (int repeated = 0; repeated < 3; ++repeated) {
        EXPECT_EQ(mass(here), 152.4);
        EXPECT_EQ(mass(there), 99.0);
    }
    here.write("base.toml", edited(good_scene, "152.4 kg", "77 kg"));
    EXPECT_EQ(mass(here), 77.0);
    EXPECT_EQ(mass(there), 99.0);
}

TEST(SceneBase, IsOverriddenTableByTableAndInTheOtherWayToSayIt) {
    ScratchDir here;
    here.write("base.toml", good_scene);
    here.write("scene.toml", R"(base = "base.toml"
[environment]
atmosphere = "us76"
[release]
altitude = "500 m"
[[parachute]]
risers = 1
[full.noise]
amplitude = "1 mm"
)");
    const Scene scene = read_scene(here / "scene.toml");
    EXPECT_EQ(scene.environment.atmosphere.model->name, "us76");
    EXPECT_EQ(scene.release.altitude, 500.0);
    EXPECT_EQ(scene.release.speed, 21.0);
    EXPECT_EQ(scene.parachutes[0].risers, 1);
    EXPECT_EQ(scene.parachutes[0].gores, 28);  // of the design that the base names
    EXPECT_EQ(scene.full.noise->amplitude, 1e-3);
    EXPECT_EQ(read_scene(here / "scene.toml", {"release.height=80 m"}).release.altitude, 80.0);  // --set wins
}

TEST(SceneBase, ChainsAndOtherDirectories) {
    ScratchDir here;
    here.write("a/base.toml", edited(good_scene, "usaf-c9", "mine"));
    here.write(
        "a/parachutes/mine.toml",
        edited(content_of(TWINCHUTE_SOURCE_DIR "/data/parachutes/usaf-c9.toml"), "\"8.53 m\"", "\"9 m\""));
    here.write("b/middle.toml", "base = \"../a/base.toml\"\npayload.mass = 100\nrom.rtol = 1e-9\n");
    here.write("scene.toml", "base = \"b/middle.toml\"\npayload.mass = 120\n");
    const Scene scene = read_scene(here / "scene.toml");
    EXPECT_EQ(scene.payload.mass, 120.0);
    EXPECT_EQ(scene.rom.rtol, 1e-9);
    EXPECT_EQ(scene.parachutes[0].nominal_diameter, 9.0);  // found beside the file that names it
}

TEST(SceneBase, MayBeAShippedScene) {
    ScratchDir here;
    here.write("scene.toml", "base = \"c9-inflation.toml\"\npayload.mass = 90\n");
    EXPECT_EQ(read_scene(here / "scene.toml").payload.mass, 90.0);
}

TEST(SceneBase, CirclesAreShown) {
    ScratchDir here;
    here.write("a.toml", "base = \"b.toml\"\n");
    here.write("b.toml", "\nbase = \"c.toml\"\n");
    here.write("c.toml", "base = \"a.toml\"\n");
    here.write("self.toml", "base = \"./self.toml\"\n");
    EXPECT_EQ(complaint_of(here / "a.toml"),
              (here / "c.toml").string() +
                  ":1:8: base: goes round in a circle (a.toml -> b.toml -> c.toml -> "
                  "a.toml), base a scene on one that does not lead back to it");
    EXPECT_NE(complaint_of(here / "self.toml").find("(self.toml -> self.toml)"), std::string::npos);
}

TEST(SceneBase, MistakesInItNameItsFile) {
    ScratchDir here;
    here.write("base.toml", edited(good_scene, "152.4 kg", "152.4 m"));
    here.write("scene.toml", "base = \"base.toml\"\n");
    EXPECT_TRUE(complaint_of(here / "scene.toml")
                    .starts_with((here / "base.toml").string() + ":6:8: payload.mass: 'm' is the wrong kind"))
        << complaint_of(here / "scene.toml");
    EXPECT_EQ(complaint_of(here / "scene.toml", {"payload.mass=3"}), "");  // what is overridden is not read
    EXPECT_TRUE(
        complaint_of(here / "scene.toml", {"base=x.toml"}).starts_with("--set: base: cannot be overridden"));
}

const std::string series = good_scene + R"([[case]]
name = "light"
set = { "payload.mass" = "80 kg", "release.altitude" = "60 m" }
[[case]]
name = "with-noise"
set = { full.noise.amplitude = "1 mm", "aerodynamics.line_drag" = {}, name = "noisy", "compare.tolerance.peak_force" = "5 %" }
[[case]]
name = "plain"
)";

std::vector<Scene> read_series(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return read_scenes_text(text, "test.toml", TWINCHUTE_SOURCE_DIR "/data", overrides);
}

TEST(SceneSeries, EveryCaseIsItsOwnScene) {
    const auto scenes = read_series(series);
    ASSERT_EQ(scenes.size(), 3u);
    EXPECT_EQ(scenes[0].case_name, "light");
    EXPECT_EQ(scenes[0].name, "test, light");
    EXPECT_EQ(scenes[0].payload.mass, 80.0);
    EXPECT_EQ(scenes[0].release.altitude, 60.0);
    EXPECT_EQ(scenes[1].case_name, "with-noise");
    EXPECT_EQ(scenes[1].name, "noisy");
    EXPECT_EQ(scenes[1].payload.mass, 152.4);
    EXPECT_EQ(scenes[1].full.noise->amplitude, 1e-3);
    EXPECT_TRUE(scenes[1].aerodynamics.line_drag);
    EXPECT_EQ(scenes[1].tolerances.at("peak_force").value, 0.05);
    EXPECT_FALSE(scenes[2].aerodynamics.line_drag);
    Scene plain = scenes[2];
    plain.name = "test";
    EXPECT_TRUE(same_scene(plain, read_text(good_scene)));
    for (const Scene& scene : scenes)
        EXPECT_EQ(scene.sha256, scenes[0].sha256);
}

TEST(SceneSeries, HasAnEnd) {
    std::string text = good_scene;
    for (int i = 0; i < 1001; ++i)
        text += "[[case]]\nname = \"c" + std::to_string(i) + "\"\n";
    try {
        read_series(text);
        FAIL() << "was read";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("more than 1000 cases"), std::string::npos) << error.what();
    }
}

TEST(SceneSeries, OverridesWinOverCases) {
    for (const Scene& scene : read_series(series, {"payload.mass=70"}))
        EXPECT_EQ(scene.payload.mass, 70.0);
    EXPECT_EQ(read_series(series, {"release.height=90 m"})[0].release.altitude, 90.0);
}

TEST(SceneSeries, AFileWithoutCasesIsOneScene) {
    const auto scenes = read_series(good_scene);
    ASSERT_EQ(scenes.size(), 1u);
    EXPECT_EQ(scenes[0].case_name, "");
    EXPECT_TRUE(same_scene(scenes[0], read_text(good_scene)));
}

TEST(SceneSeries, MistakesNameTheCase) {
    const auto what = [](const std::string& text,
                         const std::vector<std::string>& overrides = {}) -> std::string {
        try {
            read_series(text, overrides);
        } catch (const SceneError& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(what(edited(series, "\"60 m\"", "\"-60 m\"")),
              "test.toml:21:56: case 'light': release.altitude: the release is not above the ground "
              "(altitude -60 m, "
              "ground 0 m), raise the release or lower environment.ground");
    // A mistake that only one case has, made by an override.
    EXPECT_TRUE(what(series, {"environment.ground=70 m"}).starts_with("test.toml:21:56: case 'light': "));
}

TEST(SceneSeries, OfTheBaseHoldsUnlessTheSceneHasItsOwn) {
    ScratchDir here;
    here.write("base.toml", series);
    here.write("same.toml", "base = \"base.toml\"\nrom.rtol = 1e-9\n");
    here.write("own.toml",
               "base = \"base.toml\"\n[[case]]\nname = \"only\"\nset = { \"payload.mass\" = 50 }\n");
    EXPECT_EQ(read_scenes(here / "same.toml").size(), 3u);
    EXPECT_EQ(read_scenes(here / "same.toml")[0].rom.rtol, 1e-9);
    const auto own = read_scenes(here / "own.toml");
    ASSERT_EQ(own.size(), 1u);
    EXPECT_EQ(own[0].case_name, "only");
    EXPECT_EQ(own[0].payload.mass, 50.0);
}

}  // namespace
}  // namespace twinchute::test
