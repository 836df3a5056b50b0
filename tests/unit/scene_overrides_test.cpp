// "key=value" from the command line, laid over the scene before anything is checked.
#include <gtest/gtest.h>

#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

TEST(Overrides, TomlAndBareValues) {
    for (const char* mass :
         {"payload.mass=150", "payload.mass=150.0", "payload.mass='150 kg'", "payload.mass=150 kg",
          "payload.mass = \"150000 g\"", "payload.mass={ value = \"150 kg\", source = \"a shell\" }"})
        EXPECT_DOUBLE_EQ(read_text(good_scene, {mass}).payload.mass, 150.0) << mass;
    EXPECT_EQ(read_text(good_scene, {"stop.at=ground"}).stop.kind, Trigger::Kind::ground);
    EXPECT_EQ(read_text(good_scene, {"name=C-9 #2"}).name, "C-9 #2");
}

TEST(Overrides, AParachuteWithoutANameHasThatOfTheDefault) {
    EXPECT_EQ(read_text(good_scene, {"parachute.main.mass=4"}).parachutes[0].mass, 4.0);
    EXPECT_NE(complaint(good_scene, {"parachute.drogue.mass=4"}).find("no parachute has that name"),
              std::string::npos);
    const std::string two = edited(good_scene, "[aerodynamics]\n", R"(name = "drogue"
cut = { after = "main.full-open" }
[[parachute]]
type = "flat-circular"
nominal_diameter = 20
mass = 5
deploy = { by = "line-stretch", when = { height = "150 m" } }
[aerodynamics]
)");
    const Scene scene = read_text(two, {"parachute.main.mass=6"});
    ASSERT_EQ(scene.parachutes.size(), 2u);
    EXPECT_EQ(scene.parachutes[1].name, "main");
    EXPECT_EQ(scene.parachutes[1].mass, 6.0);
    EXPECT_NE(scene.parachutes[0].mass, 6.0);
}

TEST(Overrides, AMessageNamesTheOptionThatStandsBeforeOne) {
    EXPECT_TRUE(complaint(good_scene, {"payload.mass=-1"}).starts_with("--set: payload.mass: "));
    EXPECT_TRUE(
        complaint(good_scene, {"--fields full.fields_rate=-1"}).starts_with("--fields: full.fields_rate: "));
    const Scene scene = read_text(good_scene, {"--fields full.fields_rate=5"});
    EXPECT_EQ(find_input(scene, "full.fields_rate")->source, "command line");
}

TEST(Overrides, LastOneWins) {
    EXPECT_EQ(read_text(good_scene, {"payload.mass=1", "payload.mass=2"}).payload.mass, 2.0);
}

TEST(Overrides, AreInputsThatWereGiven) {
    const Scene scene =
        read_text(good_scene, {"rom.rtol=1e-10", "parachute.mass={value=4,source=\"scale\"}"});
    EXPECT_EQ(find_input(scene, "rom.rtol")->origin, InputOrigin::given);
    EXPECT_EQ(find_input(scene, "parachute.mass")->origin, InputOrigin::given);
    EXPECT_EQ(find_input(scene, "rom.rtol")->source, "command line");
    EXPECT_EQ(find_input(scene, "parachute.mass")->source, "command line: scale");
    // Values of the scene, and defaults, do not name the command line.
    EXPECT_EQ(find_input(scene, "payload.mass")->source.find("command line"), std::string::npos);
    EXPECT_EQ(find_input(scene, "rom.method")->source.find("command line"), std::string::npos);
}

TEST(Overrides, TakeThePlaceOfTheOtherWayToSayIt) {
    EXPECT_EQ(read_text(good_scene, {"release.altitude=85 m"}).release.altitude, 85.0);
    EXPECT_EQ(read_text(good_scene, {"release.airspeed=30"}).release.speed, 30.0);
    EXPECT_EQ(read_text(good_scene, {"environment.atmosphere=us76"}).environment.atmosphere.model->name,
              "us76");
    EXPECT_EQ(read_text(good_scene, {"environment.atmosphere=us76", "environment.atmosphere.density=1"})
                  .environment.atmosphere.constant_density,
              1.0);
    const Scene given = read_text(good_scene, {"parachute.fill_time.time=2 s"});
    EXPECT_EQ(given.parachutes[0].fill_time.model->name, "given");
    EXPECT_EQ(given.parachutes[0].fill_time.given, 2.0);
    EXPECT_EQ(find_input(given, "parachute.fill_time.n"), nullptr);
    // D0 = 8.53 m: 0.75 pi/4 D0^2 = 42.86 m^2 (c9_paper_data: the conflict in the paper's own numbers)
    const Scene coefficient = read_text(good_scene, {"parachute.drag_coefficient=0.75"});
    EXPECT_NEAR(coefficient.parachutes[0].drag_area, 42.86, 0.005);
    EXPECT_EQ(find_input(coefficient, "parachute.drag_area"), nullptr);
}

TEST(Overrides, AddPhysicsByItsTable) {
    EXPECT_FALSE(read_text(good_scene).aerodynamics.line_drag);
    EXPECT_TRUE(read_text(good_scene, {"aerodynamics.line_drag={}"}).aerodynamics.line_drag);
    EXPECT_EQ(read_text(good_scene, {"full.noise.amplitude=0.1 mm"}).full.noise->amplitude, 1e-4);
}

TEST(Overrides, MistakesNameTheOption) {
    EXPECT_EQ(complaint(good_scene, {"payload.mas=3"}),
              "--set: payload.mas: unknown key, did you mean 'payload.mass'?");
    EXPECT_TRUE(
        complaint(good_scene, {"payload.mass=3 m"}).starts_with("--set: payload.mass: 'm' is the wrong"));
    EXPECT_TRUE(
        complaint(good_scene, {"parachute.risers=3"}).starts_with("--set: parachute.risers: 3 does not"));
    EXPECT_TRUE(
        complaint(good_scene, {"payload.mass='3"}).starts_with("--set: payload.mass: not valid TOML"));
    for (const char* nonsense :
         {"payload.mass", "=3", "payload.mass=", "a b=3", "payload.\"mass\"=3", "payload.mass=1\nname=\"x\""})
        EXPECT_NE(complaint(good_scene, {nonsense}).find("is not key=value"), std::string::npos) << nonsense;
}

}  // namespace
}  // namespace twinchute::test
