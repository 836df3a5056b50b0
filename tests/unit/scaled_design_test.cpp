// A design that a scene gives another nominal diameter: the same shape in another size, as sizing makes it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "lib/scene/write_scene.hpp"
#include "rom/run_rom.hpp"
#include "rom/size/vary.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

constexpr double d = 8.53, factor = 12.0 / d;  // the C-9's D0 [m], and of one of 12 m over it

Scene of_12_m(std::vector<std::string> more = {}) {
    more.insert(more.begin(), "parachute.nominal_diameter=12");
    return read_text(good_scene, more);
}

/// [kg] as in Sizing.MassFollowsFabricTapesAndLines, of lines as long as given.
double mass_at(double diameter, double line, double riser) {
    const double cord = 462.0 * 0.25 * pi * 16e-6, vent = 0.1 * diameter;
    return 0.25 * pi * (diameter * diameter - vent * vent) * 0.0533 +
           cord * (28 * 0.5 * (diameter - vent) + pi * (diameter + vent) + 28 * (line + riser));
}

bool warns(const Scene& scene, const std::string& of) {
    for (const Warning& warning : scene.warnings)
        if ((warning.what + ": " + warning.why).find(of) != std::string::npos) return true;
    return false;
}

TEST(ScaledDesign, AnotherDiameterKeepsTheShape) {
    const Scene scene = of_12_m();
    const Parachute& p = scene.parachutes.front();
    EXPECT_EQ(p.nominal_diameter, 12.0);
    EXPECT_NEAR(p.drag_area, 42.56 * factor * factor, 1e-12);  // C_D0 stays: 0.7448
    EXPECT_NEAR(p.vent_diameter, 1.2, 1e-14);
    EXPECT_NEAR(p.line_length, 7.31 * factor, 1e-13);
    EXPECT_NEAR(p.riser_length, 1.22 * factor, 1e-14);
    EXPECT_NEAR(p.mass, 5.19 * mass_at(12.0, 7.31 * factor, 1.22 * factor) / mass_at(d, 7.31, 1.22), 1e-12);
    EXPECT_EQ(p.gores, 28);
    EXPECT_EQ(p.risers, 4);
    EXPECT_EQ(p.projected_diameter_ratio, 0.65);
    EXPECT_TRUE(warns(scene,
                      "design usaf-c9 of D0 = 8.53 m is scaled to 12 m: of the same shape: "
                      "vent_diameter, line_length, riser_length, drag_area, mass go along"));
    EXPECT_EQ(read_text(good_scene).parachutes.front().drag_area, 42.56);
}

TEST(ScaledDesign, DescendsAsItsAreaSays) {
    // sqrt(2 m g/(rho C_D S)), steady to 0.5 %; with the area of 8.53 m it was 7.72 m/s.
    const Scene scene = of_12_m({"stop.at=steady-descent"});
    twinchute::Run run;
    const RunRecord record = rom::run_rom(scene, run);
    const double weight = (152.4 + scene.parachutes.front().mass) * standard_gravity;
    const double expected = std::sqrt(2.0 * weight / (1.225 * 42.56 * factor * factor));
    ASSERT_TRUE(record.metric("descent_rate_m_s"));
    EXPECT_NEAR(*record.metric("descent_rate_m_s") / expected, 1.0, 0.005);
}

TEST(ScaledDesign, IsWhatSizingMakesOfIt) {
    const auto set = rom::find_vary("nominal_diameter")->set;
    Scene sized = read_text(good_scene);
    set(sized, 12.0);
    const Scene scene = of_12_m();
    EXPECT_EQ(scene.parachutes.front(), sized.parachutes.front());
    // From there on nothing is scaled twice: 24 m at once, or by way of 12 m.
    Scene by_way = scene, at_once = read_text(good_scene);
    set(by_way, 24.0);
    set(at_once, 24.0);
    EXPECT_NEAR(by_way.parachutes.front().drag_area / at_once.parachutes.front().drag_area, 1.0, 1e-14);
    EXPECT_NEAR(by_way.parachutes.front().mass / at_once.parachutes.front().mass, 1.0, 1e-14);
    EXPECT_NEAR(by_way.parachutes.front().line_length / at_once.parachutes.front().line_length, 1.0, 1e-14);
}

TEST(ScaledDesign, WhatTheSceneGivesStays) {
    const Scene scene = of_12_m({"parachute.drag_area=50", "parachute.line_length=10", "parachute.mass=9"});
    const Parachute& p = scene.parachutes.front();
    EXPECT_EQ(p.drag_area, 50.0);
    EXPECT_EQ(p.line_length, 10.0);
    EXPECT_EQ(p.mass, 9.0);
    EXPECT_NEAR(p.riser_length, 1.22 * factor, 1e-14);
    EXPECT_NEAR(of_12_m({"parachute.drag_coefficient=0.8"}).parachutes.front().drag_area,
                0.8 * 0.25 * pi * 144.0, 1e-12);
    // The mass is scaled from a canopy that the given lines fit, too: of 10 m over 12 m of D0.
    EXPECT_NEAR(of_12_m({"parachute.line_length=10"}).parachutes.front().mass,
                5.19 * mass_at(12.0, 10.0, 1.22 * factor) / mass_at(d, 10.0 / factor, 1.22), 1e-12);
}

TEST(ScaledDesign, TheRecordSaysWhatWasScaled) {
    const Scene scene = of_12_m({"parachute.mass=9"});
    const Input* area = find_input(scene, "parachute.drag_area");
    ASSERT_NE(area, nullptr);
    EXPECT_EQ(area->origin, InputOrigin::scaled);
    EXPECT_EQ(std::get<double>(area->value), scene.parachutes.front().drag_area);
    EXPECT_TRUE(area->source.starts_with("usaf-c9 at D0 = 8.53 m, scaled: the paper")) << area->source;
    EXPECT_EQ(find_input(scene, "parachute.nominal_diameter")->origin, InputOrigin::given);
    EXPECT_EQ(find_input(scene, "parachute.mass")->origin, InputOrigin::given);
    EXPECT_EQ(find_input(scene, "parachute.gores")->origin, InputOrigin::design);
    EXPECT_EQ(origin_name(InputOrigin::scaled), "scaled");
}

TEST(ScaledDesign, TheDesignsOwnDiameterChangesNothing) {
    const Scene scene = read_text(good_scene, {"parachute.nominal_diameter=8.53"});
    EXPECT_EQ(scene.parachutes.front(), read_text(good_scene).parachutes.front());
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(find_input(scene, "parachute.drag_area")->origin, InputOrigin::design);
}

TEST(ScaledDesign, WhereverTheDiameterIsGiven) {
    const Parachute expected = of_12_m().parachutes.front();
    ScratchDir here;
    here.write("below.toml", good_scene);
    const auto read = [&](const std::string& text) {
        return read_scenes_text(text, "test.toml", here.path()).back().parachutes.front();
    };
    EXPECT_EQ(
        read(edited(good_scene, "design = \"usaf-c9\"", "design = \"usaf-c9\"\nnominal_diameter = \"12 m\"")),
        expected);
    EXPECT_EQ(read("base = \"below.toml\"\n[[parachute]]\nnominal_diameter = 12\n"), expected);
    EXPECT_EQ(read("base = \"below.toml\"\n[[case]]\nname = \"12\"\n"
                   "set = { \"parachute.nominal_diameter\" = 12 }\n"),
              expected);
}

TEST(ScaledDesign, IsReadBackAsItIs) {
    const Scene scene = of_12_m();
    const Scene again = read_scene_text(write_scene(scene), "again.toml", TWINCHUTE_SOURCE_DIR "/data", {});
    EXPECT_TRUE(same_scene(scene, again));
    EXPECT_EQ(write_scene(again), write_scene(scene));
}

TEST(ScaledDesign, ACoefficientIsNotScaledTwice) {
    ScratchDir here;
    here.write("parachutes/mine.toml",
               "nominal_diameter = 5\ndrag_coefficient = 0.8\nmass = 2\nprojected_diameter_ratio = 0.65\n");
    const std::string text = edited(good_scene, "usaf-c9\"", "mine\"\nnominal_diameter = 10");
    const Parachute p = read_scene_text(text, "test.toml", here.path()).parachutes.front();
    EXPECT_NEAR(p.drag_area, 0.8 * 25.0 * pi, 1e-12);
    EXPECT_NEAR(p.mass, 8.0, 1e-14);  // without a structure by the nominal area
    here.write("parachutes/mine.toml", "nominal_diameter = \"0 m\"\ndrag_coefficient = 0.8\nmass = 2\n");
    try {
        read_scene_text(text, "test.toml", here.path());
        ADD_FAILURE() << "accepted a design without a size";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("mine.toml:1:20: nominal_diameter: is not a diameter"),
                  std::string::npos)
            << error.what();
    }
}

TEST(ScaledDesign, OneOfSeveralParachutes) {
    const std::string two = edited(good_scene, "design =", "name = \"first\"\ndesign =") +
                            "[[parachute]]\nname = \"second\"\ndesign = \"usaf-c9\"\n"
                            "deploy = { by = \"line-stretch\", when = { time = \"1 s\" } }\n"
                            "fill_time.n = 4\n";
    const Scene scene = read_text(two, {"parachute.second.nominal_diameter=12"});
    EXPECT_EQ(scene.parachutes.front().drag_area, 42.56);
    EXPECT_NEAR(scene.parachutes.back().drag_area, 42.56 * factor * factor, 1e-12);
    EXPECT_EQ(find_input(scene, "parachute.second.drag_area")->origin, InputOrigin::scaled);
}

TEST(ScaledDesign, ACoefficientBeyondItsTypeIsWarnedOf) {
    // 42.56 m^2 on 12 m is 0.376, on 8.53 m 0.745; Table 5-1 has 0.75 to 0.80, printed with two digits.
    const auto with = [&](const char* diameter) {
        return read_text(good_scene, {"parachute.type=flat-circular", "parachute.drag_area=42.56",
                                      std::string("parachute.nominal_diameter=") + diameter});
    };
    EXPECT_TRUE(
        warns(with("12"), "C_D0 = 0.376 of a flat circular canopy: drag area 42.56 m^2 on D0 = 12 m"));
    EXPECT_TRUE(warns(with("5"), "C_D0 = 2.17 of a flat circular canopy"));
    EXPECT_FALSE(warns(with("8.53"), "C_D0 ="));
    EXPECT_FALSE(warns(of_12_m({"parachute.type=flat-circular"}), "C_D0 ="));
}

}  // namespace
}  // namespace twinchute::test
