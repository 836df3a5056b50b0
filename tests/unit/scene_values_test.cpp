// A scene as it is read: values in SI, defaults from the table of keys, and where each came from.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <locale>
#include <map>
#include <set>

#include "lib/math/sha256.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/keys.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

const std::string scenes = TWINCHUTE_SOURCE_DIR "/data/scenes/";

TEST(SceneValues, ShippedSceneHasTheNumbersOfThePaper) {
    const Scene s = read_scene(scenes + "c9-inflation.toml");
    // The paper, 5.1 and 5.2; exact, since every one is a round number in its unit.
    EXPECT_EQ(s.environment.atmosphere.constant_density, 1.225);
    EXPECT_EQ(s.environment.atmosphere.model->name, "constant");
    EXPECT_EQ(s.environment.gravity, 9.80665);
    EXPECT_EQ(s.payload.mass, 152.4);
    EXPECT_FALSE(s.payload.drag_area);
    EXPECT_EQ(s.release.altitude, 300.0);
    EXPECT_EQ(s.release.speed, 21.0);
    EXPECT_DOUBLE_EQ(s.release.path_angle, pi / 2);
    EXPECT_DOUBLE_EQ(s.release.heading, pi / 2);
    ASSERT_EQ(s.parachutes.size(), 1u);
    const Parachute& p = s.parachutes[0];
    EXPECT_EQ(p.name, "USAF C-9");
    EXPECT_EQ(p.nominal_diameter, 8.53);
    EXPECT_EQ(p.drag_area, 42.56);
    EXPECT_EQ(p.projected_diameter_ratio, 0.65);
    EXPECT_EQ(p.mass, 5.19);
    EXPECT_EQ(p.gores, 28);
    EXPECT_EQ(p.vent_diameter, 0.853);
    EXPECT_EQ(p.line_length, 7.31);
    EXPECT_EQ(p.riser_length, 1.22);
    EXPECT_EQ(p.risers, 4);
    EXPECT_EQ(p.fabric.density, 533.0);
    EXPECT_EQ(p.fabric.youngs_modulus, 4.3e8);
    EXPECT_EQ(p.fabric.thickness, 1e-4);
    EXPECT_EQ(p.line.density, 462.0);
    EXPECT_EQ(p.line.youngs_modulus, 9.7e8);
    EXPECT_EQ(p.line.diameter, 4e-3);
    EXPECT_EQ(p.tapes.radial.name, "mil-c-5040-type-ii");
    EXPECT_EQ(p.tapes.skirt.density, 462.0);
    EXPECT_EQ(p.tapes.vent.diameter, 4e-3);
    EXPECT_EQ(p.fill_time.model->name, "fill-constant");
    EXPECT_EQ(p.fill_time.n, 4.0);
    EXPECT_EQ(p.drag_area_law->name, "ludtke");
    EXPECT_EQ(p.initial_drag_area_ratio, 0.04);
    EXPECT_TRUE(p.initial_phase.transit);
    ASSERT_TRUE(s.aerodynamics.added_mass);
    EXPECT_EQ(s.aerodynamics.added_mass->model->name, "hemisphere");
    EXPECT_TRUE(s.aerodynamics.line_drag);
    EXPECT_EQ(s.aerodynamics.breathing_damping, 0.5);
    EXPECT_EQ(s.stop.kind, Trigger::Kind::steady_descent);
    EXPECT_EQ(s.file, scenes + "c9-inflation.toml");
    EXPECT_EQ(s.sha256, sha256_hex(read_text_file(s.file)));
}

TEST(SceneValues, ShippedVariants) {
    const Scene bare = read_scene(scenes + "c9-inflation-no-added-mass.toml");
    EXPECT_FALSE(bare.aerodynamics.added_mass);
    EXPECT_TRUE(bare.aerodynamics.breathing_damping);
    const Scene oblique = read_scene(scenes + "c9-inflation-oblique.toml");
    EXPECT_DOUBLE_EQ(oblique.release.path_angle, pi / 3);
    EXPECT_EQ(oblique.stop.kind, Trigger::Kind::steady_descent);
    EXPECT_TRUE(oblique.aerodynamics.added_mass);
}

TEST(SceneValues, EveryShippedSceneReads) {
    const auto names = data_names("scenes", TWINCHUTE_SOURCE_DIR "/data");
    EXPECT_GE(names.size(), 5u);
    for (const std::string& name : names)
        EXPECT_NO_THROW(read_scenes(scenes + name + ".toml")) << name;
}

TEST(SceneValues, ShippedSeriesIsTheDemoAtThreeSpeeds) {
    const auto series = read_scenes(scenes + "c9-inflation-speeds.toml");
    ASSERT_EQ(series.size(), 3u);
    for (const Scene& one : series) {
        const double froude = one.release.speed * one.release.speed / (9.80665 * 8.53);
        EXPECT_NEAR(froude, std::stod(one.case_name.substr(3)), 0.05) << one.case_name;
        EXPECT_EQ(one.payload.mass, 152.4);
    }
    EXPECT_TRUE(read_scene(scenes + "c9-drift.toml").warnings.empty());  // its wind covers the fall
}

TEST(SceneValues, EveryShippedDesignValueNamesItsSource) {
    int seen = 0;
    for (const Input& input : read_scene(scenes + "c9-inflation.toml").inputs) {
        if (input.origin != InputOrigin::design || input.key == "parachute.name") continue;
        EXPECT_NE(input.source, "") << input.key;
        ++seen;
    }
    EXPECT_GE(seen, 30);  // 14 of the design, 4 of the fabric, 3 of each of four cords
}

TEST(SceneValues, StrengthsComeWithMaterialsAndFactorsWithTheParachute) {
    const Parachute c9 = read_text(good_scene).parachutes.front();
    ASSERT_TRUE(c9.line.strength && c9.fabric.strength);
    EXPECT_DOUBLE_EQ(*c9.line.strength, 400 * 4.4482216152605);  // lbf, NIST SP 811
    EXPECT_DOUBLE_EQ(*c9.fabric.strength, 7355);                 // 750 kgf/m
    EXPECT_EQ(c9.strength, (StrengthFactors{1.0, 1.0}));
    const std::string factors = "[[parachute]]\njoint_efficiency = \"80 %\"\ndesign_factor = 1.5";
    EXPECT_EQ(read_text(edited(good_scene, "[[parachute]]", factors)).parachutes.front().strength,
              (StrengthFactors{0.8, 1.5}));
    for (const char* wrong : {"joint_efficiency = 0", "joint_efficiency = 1.01", "design_factor = 0.99"})
        EXPECT_NE(complaint(edited(good_scene, "[[parachute]]", std::string("[[parachute]]\n") + wrong)), "")
            << wrong;
}

TEST(SceneValues, AMaterialWithoutStrengthHasNone) {
    const ScratchDir scratch;
    scratch.write("materials/cord.toml",
                  "kind = \"cord\"\ndensity = 462\nyoungs_modulus = 9.7e8\ndiameter = 4e-3\n");
    const Scene scene = read_scene_text(edited(good_scene, "[[parachute]]", "[[parachute]]\nline = \"cord\""),
                                        "test.toml", scratch.path());
    EXPECT_EQ(scene.parachutes.front().line.strength, std::nullopt);
    EXPECT_EQ(find_input(scene, "parachute.line.strength"), nullptr);
    EXPECT_NE(find_input(scene, "parachute.tapes.skirt.strength"), nullptr);
}

TEST(SceneValues, HeightCountsFromTheGround) {
    const Scene s = read_text(good_scene, {"environment.ground=1200 m"});
    EXPECT_EQ(s.release.altitude, 1500.0);
    EXPECT_EQ(s.environment.ground, 1200.0);
}

TEST(SceneValues, NumbersAreSiAndStringsConvert) {
    // 1 lb = 0.45359237 kg and 1 ft = 0.3048 m by definition (NIST SP 811, B.8).
    const Scene s =
        read_text(good_scene, {"payload.mass=336 lbm", "release.height=1000 ft", "release.speed=70 fps",
                               "release.path_angle=1.0", "parachute.initial_drag_area_ratio=4 %"});
    EXPECT_DOUBLE_EQ(s.payload.mass, 336 * 0.45359237);
    EXPECT_DOUBLE_EQ(s.release.altitude, 304.8);
    EXPECT_DOUBLE_EQ(s.release.speed, 70 * 0.3048);
    EXPECT_EQ(s.release.path_angle, 1.0);
    EXPECT_DOUBLE_EQ(s.parachutes[0].initial_drag_area_ratio, 0.04);
}

TEST(SceneValues, InitialPhaseIsTransitOrATime) {
    for (const char* zero : {"parachute.initial_phase=0", "parachute.initial_phase=0 s"}) {
        const Scene s = read_text(good_scene, {zero});
        EXPECT_FALSE(s.parachutes[0].initial_phase.transit);
        EXPECT_EQ(s.parachutes[0].initial_phase.seconds, 0.0);
    }
    EXPECT_TRUE(
        read_text(good_scene, {"parachute.initial_phase=transit"}).parachutes[0].initial_phase.transit);
}

TEST(SceneValues, Tolerances) {
    const Scene s =
        read_text(good_scene,
                  {"compare.tolerance.peak_force=10%", "compare.tolerance.descent_rate=0.5 ft/s",
                   "compare.tolerance.max_deceleration=0.5 g0", "compare.tolerance.peak_force_ratio='0.1'"});
    ASSERT_EQ(s.tolerances.size(), 4u);
    EXPECT_TRUE(s.tolerances.at("peak_force").relative);
    EXPECT_DOUBLE_EQ(s.tolerances.at("peak_force").value, 0.1);
    EXPECT_FALSE(s.tolerances.at("descent_rate").relative);
    EXPECT_DOUBLE_EQ(s.tolerances.at("descent_rate").value, 0.1524);
    EXPECT_DOUBLE_EQ(s.tolerances.at("max_deceleration").value, 0.5);  // in g0, the metric's unit
    EXPECT_FALSE(s.tolerances.at("peak_force_ratio").relative);
    // UDUNITS-2 minds no case, and the blank at the end is none of the unit: shares, in any spelling.
    for (const char* share : {"5 Percent", "5 % ", "5 PERCENT", " 5%"}) {
        const auto read =
            read_text(good_scene, {fmt::format("compare.tolerance.peak_force_ratio='{}'", share)});
        EXPECT_TRUE(read.tolerances.at("peak_force_ratio").relative) << share;
        EXPECT_DOUBLE_EQ(read.tolerances.at("peak_force_ratio").value, 0.05) << share;
    }
    // g0 is an acceleration, not the 0th power of a gram.
    const auto deceleration = [](const char* text) {
        return fmt::format("compare.tolerance.max_deceleration='{}'", text);
    };
    EXPECT_NEAR(
        read_text(good_scene, {deceleration("9.80665 m/s^2")}).tolerances.at("max_deceleration").value, 1.0,
        1e-12);
    EXPECT_NE(complaint(good_scene, {deceleration("0.2 1")}), "");
}

TEST(SceneValues, DefaultsAreThoseOfTheTable) {
    // All optional tables present, so that every default is in effect.
    const Scene s = read_text(good_scene, {"aerodynamics.line_drag={}", "aerodynamics.breathing_damping={}",
                                           "full.noise.amplitude=0"});
    std::size_t seen = 0;
    for (const Key& key : scene_keys()) {
        const Input* input = find_input(s, key.path);
        if (key.need != KeyNeed::defaulted || !input || input->origin != InputOrigin::fallback) continue;
        ++seen;
        EXPECT_EQ(input->source, key.source) << key.path;
        if (const auto* number = std::get_if<double>(&input->value))
            EXPECT_EQ(*number, plain_number(key.fallback)) << key.path;
        else
            EXPECT_EQ(std::get<std::string>(input->value), key.fallback) << key.path;
    }
    EXPECT_GE(seen, 20u);
    // And the struct holds what the inputs say (defaults as the design notes of the models state them).
    EXPECT_EQ(s.environment.gravity, standard_gravity);
    EXPECT_EQ(s.environment.ground, 0.0);
    EXPECT_EQ(s.aerodynamics.radial_pressure, 0.8);
    EXPECT_EQ(s.aerodynamics.breathing_damping, 0.5);
    EXPECT_EQ(s.rom.method, "auto");
    EXPECT_EQ(s.rom.rtol, 1e-6);
    EXPECT_EQ(s.full.mesh.gore_columns, 2);
    EXPECT_EQ(s.full.mesh.gore_rows, 17);
    EXPECT_EQ(s.full.mesh.grading, Grading::graded);
    EXPECT_EQ(s.full.mesh.line_elements, 31);
    EXPECT_EQ(s.full.mesh.riser_elements, 5);
    EXPECT_EQ(s.full.alpha, 0.0);
    EXPECT_FALSE(s.full.alpha_from_release);
    EXPECT_EQ(s.full.bulk_viscosity, 0.06);
    EXPECT_EQ(s.full.time_step_factor, 0.95);
    EXPECT_EQ(s.full.line_substeps, 4);
    EXPECT_EQ(s.full.mass_scaling, 0.0);
    EXPECT_EQ(s.full.contact, Contact::none);
    EXPECT_EQ(s.full.strain_limit, 0.5);
    EXPECT_EQ(s.full.output_rate, 200.0);
    EXPECT_FALSE(s.full.fields_rate);
    EXPECT_EQ(s.full.noise->seed, 1u);
    EXPECT_EQ(s.stop.delay, 0.0);
}

TEST(SceneValues, AbsentTablesLeavePhysicsOut) {
    const Scene s = read_text(edited(good_scene, "added_mass = { model = \"hemisphere\" }", ""));
    EXPECT_FALSE(s.aerodynamics.added_mass);
    EXPECT_FALSE(s.aerodynamics.line_drag);
    EXPECT_FALSE(s.aerodynamics.breathing_damping);
    EXPECT_FALSE(s.full.noise);
    for (const Input& input : s.inputs) {
        EXPECT_FALSE(input.key.starts_with("aerodynamics.added_mass")) << input.key;
        EXPECT_FALSE(input.key.starts_with("full.noise")) << input.key;
    }
}

TEST(SceneInputs, SayWhereEachValueCameFrom) {
    const Scene s = read_text(
        edited(good_scene, "\"152.4 kg\"", "{ value = \"152.4 kg\", source = \"scales\", grade = \"B\" }"));
    const Input& mass = *find_input(s, "payload.mass");
    EXPECT_EQ(std::get<double>(mass.value), 152.4);
    EXPECT_EQ(mass.unit, "kg");
    EXPECT_EQ(mass.origin, InputOrigin::given);
    EXPECT_EQ(mass.source, "scales [grade B]");
    EXPECT_EQ(find_input(s, "parachute.nominal_diameter")->origin, InputOrigin::design);
    EXPECT_EQ(find_input(s, "parachute.line.diameter")->origin, InputOrigin::design);
    EXPECT_EQ(find_input(s, "environment.gravity")->origin, InputOrigin::fallback);
    EXPECT_EQ(std::get<std::string>(find_input(s, "environment.atmosphere.model")->value), "constant");
    EXPECT_EQ(find_input(s, "parachute.fill_time.n")->unit, "");  // dimensionless

    std::set<std::string> keys;
    for (const Input& input : s.inputs)
        EXPECT_TRUE(keys.insert(input.key).second) << input.key << " twice";
}

TEST(SceneInputs, TheSceneOverridesItsDesign) {
    const Scene s = read_text(edited(good_scene, "design = \"usaf-c9\"", "design = \"usaf-c9\"\nrisers = 1"));
    EXPECT_EQ(s.parachutes[0].risers, 1);
    EXPECT_EQ(find_input(s, "parachute.risers")->origin, InputOrigin::given);
    EXPECT_EQ(s.parachutes[0].gores, 28);
}

/// Writes 1.5 as "1,5" and 1000 as "1.000".
struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

TEST(SceneValues, LocaleChangesNothing) {
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
    const std::string overrides = "payload.mass=1500.5 kg";
    const Scene s = read_text(good_scene, {overrides, "environment.ground=0.25"});
    const std::string wrong = complaint(good_scene, {"payload.mass=-1500.5"});
    const std::string table = keys_table(keys_below(""));
    std::locale::global(before);
    EXPECT_EQ(s.payload.mass, 1500.5);
    EXPECT_EQ(s.environment.ground, 0.25);
    EXPECT_EQ(s.environment.gravity, 9.80665);
    EXPECT_NE(wrong.find("-1500.5 kg is out of range"), std::string::npos) << wrong;
    EXPECT_EQ(table, keys_table(keys_below("")));
}

}  // namespace
}  // namespace twinchute::test
