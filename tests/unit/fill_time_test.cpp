// Filling times by their references: filling_time.csv row by row, and Ludtke's balance of mass integrated.
#include "lib/models/fill_time.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/opening_tables.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using test::complaint;
using test::edited;
using test::good_scene;
using test::read_text;

constexpr double foot = 0.3048;  // [m]

/// A C-9 with its payload at 21 m/s.
constexpr FillTimeInputs c9{8.53, 21.0, 1.225, 152.4, 157.6, 9.80665, 42.56, 2.77};

FillTime ludtke() {
    FillTime fill{find_fill_time("ludtke")};
    fill.balance.emplace();
    return fill;
}

FillTimeInputs through(double permeability, FillTimeInputs in = c9) {
    in.permeability = permeability;
    return in;
}

TEST(FillingTimeCsv, KnackeFlatCircular) {
    // n D0/v^0.85 in feet and feet per second, n = 4 and 2.5 (low porosity); the constant in metres is
    // 1.19508 n, 0.3048^-0.15, by the file.
    for (const double n : {4.0, 2.5}) {
        const double seconds =
            FillTime{find_fill_time("knacke-0.85"), n}.seconds({28.0 * foot, 200.0 * foot});
        EXPECT_NEAR(seconds, n * 28.0 / std::pow(200.0, 0.85), 1e-12);
        EXPECT_NEAR(seconds, 1.19508 * n * 28.0 * foot / std::pow(200.0 * foot, 0.85), 1e-5);
    }
}

TEST(FillingTimeCsv, Cross) {
    // 8.7 D0/v^0.9: 1.5 s for a canopy of 20 ft at 200 ft/s says the file; 1.1261 in metres.
    const double seconds = FillTime{find_fill_time("knacke-0.9"), 8.7}.seconds({20.0 * foot, 200.0 * foot});
    EXPECT_NEAR(seconds, 1.5, 0.05);
    EXPECT_NEAR(seconds, 1.1261 * 8.7 * 20.0 * foot / std::pow(200.0 * foot, 0.9), 1e-4);
}

TEST(FillingTimeCsv, RingslotAndRibbonByDiameters) {
    EXPECT_NEAR((FillTime{find_fill_time("fill-constant"), 14.0}.seconds({10.0, 70.0})), 2.0, 1e-14);
    // 0.65 lambda_g D0/v, lambda_g = 20 %: 13 diameters.
    FillTimeInputs slotted{10.0, 65.0};
    slotted.geometric_porosity = 0.2;
    EXPECT_NEAR(FillTime{find_fill_time("ribbon")}.seconds(slotted), 2.0, 1e-12);
}

TEST(FillingTimeCsv, DensityExponent) {
    const FillTime plain{find_fill_time("fill-constant"), 4.0};
    const FillTime by_density{find_fill_time("fill-constant"), 4.0, 0.8};
    const FillTimeInputs high{8.53, 100.0, 0.643};
    EXPECT_NEAR(by_density.seconds(high) / plain.seconds(high), std::pow(0.643 / 1.225, 0.8), 1e-14);
}

/// Volume [m^3] that a canopy takes in over t_f while mouth, fabric and drag area grow with (t/t_f)^6 and
/// drag alone brakes, by the central difference scheme.
double taken_in(const FillTimeInputs& in, double t_f, double permeability) {
    constexpr int steps = 200000;
    const double mouth = pi * in.steady_radius * in.steady_radius;
    const double fabric = 0.25 * pi * in.nominal_diameter * in.nominal_diameter;
    const double dt = t_f / steps;
    double v = in.snatch_speed, volume = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double tau = (i + 0.5) / steps, open = std::pow(tau, 6);
        const auto braked = [&](double speed) {
            return -0.5 * in.density * in.drag_area * open * speed * speed / in.mass;
        };
        const double half = v + 0.5 * dt * braked(v);
        const double leak = permeability * std::sqrt(0.5 * in.density * half * half / permeability_pressure);
        volume += dt * open * (mouth * half - fabric * leak);
        v += dt * braked(half);
    }
    return volume;
}

TEST(FillingTimeCsv, LudtkeIsFullWhenItHasTakenInItsVolume) {
    // The balance of mass itself, integrated; second order in 200 000 steps leaves less than 1e-9.
    const double volume = 2.0 / 3.0 * pi * std::pow(c9.steady_radius, 3);
    for (const double permeability : {0.0, 0.5, 2.0}) {
        const double t_f = ludtke().seconds(through(permeability));
        EXPECT_NEAR(taken_in(c9, t_f, permeability) / volume, 1.0, 1e-8) << permeability;
    }
}

TEST(FillingTimeCsv, LudtkeOfAnInfiniteMass) {
    // 7 V_0/(v (A_M0 - A_S0 k sqrt(C_p rho/2))), the second row of the file; the next term is rho V_0
    // (C_D S)_0/(4 m A) = 1.6e-9 of it at 1e12 kg.
    FillTimeInputs heavy = c9;
    heavy.mass = 1e12;
    const double R = c9.steady_radius, fabric = 0.25 * pi * 8.53 * 8.53;
    const double k = 2.0 / std::sqrt(permeability_pressure);
    const double expected =
        7.0 * 2.0 / 3.0 * pi * R * R * R / (21.0 * (pi * R * R - fabric * k * std::sqrt(0.5 * 1.225)));
    EXPECT_NEAR(ludtke().seconds(through(2.0, heavy)) / expected, 1.0, 1e-8);
    FillTime given = ludtke();
    given.balance->volume = 10.0;
    given.balance->mouth_area = 5.0;
    EXPECT_NEAR(given.seconds(heavy), 7.0 * 10.0 / (21.0 * 5.0), 1e-8);
}

TEST(FillingTimeCsv, LudtkeNeverFillsAFabricThatLetsAllThrough) {
    EXPECT_TRUE(std::isinf(ludtke().seconds(through(100.0))));
}

TEST(FillTable, IsStraightBetweenPointsAndHoldsItsEnds) {
    FillTime fill{find_fill_time("table")};
    fill.table = FillTable{"t.csv", FillTable::By::froude_number, {5.0, 10.0}, {8.0, 4.0}};
    const auto at = [&](double froude) {
        FillTimeInputs in = c9;
        in.snatch_speed = std::sqrt(froude * in.gravity * in.nominal_diameter);
        return fill.seconds(in) * in.snatch_speed / in.nominal_diameter;
    };
    EXPECT_NEAR(at(7.5), 6.0, 1e-12);
    EXPECT_NEAR(at(1.0), 8.0, 1e-12);
    EXPECT_NEAR(at(50.0), 4.0, 1e-12);
    // By the mass ratio: 152.4/(1.225 8.53^3) = 0.2004480.
    fill.table = FillTable{"t.csv", FillTable::By::mass_ratio, {0.0, 0.400896}, {2.0, 10.0}};
    EXPECT_NEAR(fill.seconds(c9) * 21.0 / 8.53, 6.0, 1e-5);
}

TEST(FillTable, ThatIsNoneIsRefused) {
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            read_fill_table(text, "t.csv", "t.csv");
        } catch (const SceneError& error) {
            return error.what();
        }
        return {};
    };
    const auto expect = [&](const std::string& text, const std::string& why) {
        EXPECT_NE(refusal(text).find(why), std::string::npos) << refusal(text);
    };
    expect("speed,fill_constant\nm/s,1\n1,2\n3,4\n", "neither froude_number nor mass_ratio");
    expect("mass_ratio,froude_number,fill_constant\n1,1,1\n1,1,2\n2,2,4\n", "both");
    expect("mass_ratio\n1\n0.1\n0.2\n", "'fill_constant' is missing");
    expect("mass_ratio,fill_constant\n1,1\n0.2,4\n0.1,4\n", "does not rise");
    expect("mass_ratio,fill_constant\n1,1\n0.1,4\n0.2,0\n", "out of range");
}

std::string with_fill(const std::string& fill) {
    return edited(good_scene, "{ model = \"fill-constant\", n = 4.0 }", fill);
}

TEST(FillTable, IsReadFromItsFile) {
    ScratchDir here;
    here.write("n.csv", "froude_number,fill_constant\n1,1\n2,10\n20,6\n");
    const Scene scene = read_scene_text(with_fill("{ table = \"n.csv\" }"), "test.toml", here.path());
    const FillTime& fill = scene.parachutes.front().fill_time;
    EXPECT_EQ(fill.model->name, "table");
    EXPECT_EQ(fill.table, (FillTable{"n.csv", FillTable::By::froude_number, {2.0, 20.0}, {10.0, 6.0}}));
}

TEST(LudtkeFillTime, IsReadWithItsUnits) {
    const Scene scene = read_text(with_fill("{ volume = \"40 m^3\", pressure_coefficient = 1.7 }"));
    const auto& balance = scene.parachutes.front().fill_time.balance;
    ASSERT_TRUE(balance);
    EXPECT_EQ(balance->volume, 40.0);
    EXPECT_EQ(balance->pressure_coefficient, 1.7);
    EXPECT_FALSE(balance->mouth_area);
}

TEST(LudtkeFillTime, ThatNeverFillsIsRefused) {
    EXPECT_NE(complaint(with_fill("{ model = \"ludtke\" }\npermeability = \"50 m/s\""))
                  .find("a filling time of inf s"),
              std::string::npos);
}

// Permeability and porosity stood in tables of the models that use them.
TEST(RetiredKeys, OfPermeabilityAndPorosityAreThoseOfTheParachute) {
    const Scene leaky = read_text(with_fill("{ model = \"ludtke\", permeability = \"100 ft/min\" }"));
    EXPECT_NEAR(leaky.parachutes.front().permeability.value_or(0.0), 0.508, 1e-12);
    ASSERT_EQ(leaky.warnings.size(), 1u);
    EXPECT_EQ(leaky.warnings.front().what,
              "key 'parachute.fill_time.permeability' is now 'parachute.permeability'");
    const Scene slotted = read_text(with_fill("{ model = \"ribbon\", geometric_porosity = 0.2 }"));
    EXPECT_EQ(slotted.parachutes.front().geometric_porosity, 0.2);
    EXPECT_NE(complaint(with_fill("{ model = \"ribbon\" }")).find("parachute.geometric_porosity: is missing"),
              std::string::npos);
    const std::string porous = "{ model = \"porosity\", porosity = ";
    const Scene heavy = read_text(edited(good_scene, "{ model = \"hemisphere\" }", porous + "\"10 %\" }"));
    EXPECT_NEAR(heavy.parachutes.front().geometric_porosity, 0.1, 1e-15);
    EXPECT_NE(complaint(edited(good_scene, "{ model = \"hemisphere\" }", porous + "0.6 }"))
                  .find("parachute.geometric_porosity: 0.6 is above 0.5"),
              std::string::npos);
}

TEST(LudtkeFillTime, LeaksAsTheFabricUnlessTheParachuteSaysOtherwise) {
    Scene scene = read_text(with_fill("{ model = \"ludtke\" }"));
    Parachute& chute = scene.parachutes.front();
    const auto leak = [&] { return fill_inputs(scene, chute, 21.0, 1.225).permeability; };
    chute.fabric.permeability.reset();
    EXPECT_EQ(leak(), 0.0);
    chute.fabric.permeability = Permeability{0.0, permeability_pressure / 4.0};  // 2 m/s there
    EXPECT_DOUBLE_EQ(leak(), 2.0);
    chute.permeability = 0.7;
    EXPECT_EQ(leak(), 0.7);
}

}  // namespace
}  // namespace twinchute
