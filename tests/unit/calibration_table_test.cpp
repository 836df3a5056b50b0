// Factors of a calibration between the runs that it was made from, and a scene that carries them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/calibration.hpp"
#include "lib/scene/scene_digest.hpp"
#include "lib/scene/write_scene.hpp"
#include "rom/run_rom.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

CalibrationTable table_of(const std::vector<DropConditions>& runs, const std::vector<double>& factors) {
    return {"c.csv", runs, {{"drag_area", factors}}};
}

TEST(CalibrationTable, OfOneRunIsItsFactorEverywhere) {
    const CalibrationTable table = table_of({{150, 20, 1.2}}, {1.07});
    for (const DropConditions& at : {DropConditions{150, 20, 1.2}, DropConditions{10, 90, 0.4}})
        EXPECT_NEAR(table.factor(0, at), 1.07, 1e-15);
    EXPECT_DOUBLE_EQ(table.range(0).first, 150.0);
    EXPECT_DOUBLE_EQ(table.range(0).second, 150.0);
}

// A product of powers lies in the family of curves: it comes back to rounding, also between the runs.
TEST(CalibrationTable, GivesPowersOfTheConditionsBack) {
    const auto factor = [](const DropConditions& at) {
        return 1.1 * std::pow(at.payload_mass, 0.3) * std::pow(at.airspeed, -0.2) * std::pow(at.density, 0.1);
    };
    std::vector<DropConditions> runs;
    std::vector<double> factors;
    for (const double mass : {100.0, 200.0})
        for (const double speed : {15.0, 30.0})
            for (const double density : {0.7, 1.2}) {
                runs.push_back({mass, speed, density});
                factors.push_back(factor(runs.back()));
            }
    const CalibrationTable table = table_of(runs, factors);
    const DropConditions inside{130, 22, 0.9};
    EXPECT_NEAR(table.factor(0, inside), factor(inside), 1e-12);
    EXPECT_NEAR(table.scatter(0), 0.0, 1e-14);
    // Beyond its ends it is what it is there.
    EXPECT_DOUBLE_EQ(table.factor(0, {900, 22, 0.9}), table.factor(0, {200, 22, 0.9}));
    EXPECT_DOUBLE_EQ(table.factor(0, {130, 22, 0.1}), table.factor(0, {130, 22, 0.7}));
}

// Runs of heavier payloads at higher speeds say nothing of a heavy payload at a low speed: 1 % between them
// must not become 15 % there, as the plane through the three would have it.
TEST(CalibrationTable, IsFlatWhereItsRunsLeaveItOpen) {
    const CalibrationTable table =
        table_of({{120, 18, 1.2}, {152.4, 21.5, 1.2}, {190, 26, 1.2}}, {1.00, 1.01, 1.00});
    EXPECT_NEAR(table.factor(0, {190, 18, 1.2}), 1.0033, 1e-3);
    EXPECT_NEAR(table.factor(0, {120, 26, 1.2}), 1.0033, 1e-3);
    EXPECT_GT(table.scatter(0), 0.004);
}

class CalibratedScene : public ::testing::Test {
protected:
    Scene read(const std::string& table) const {
        here_.write("c.csv", table);
        return read_scene_text(edited(good_scene, "fill_time =", "calibration = \"c.csv\"\nfill_time ="),
                               "test.toml", here_.path());
    }
    std::string refusal(const std::string& table) const {
        try {
            read(table);
        } catch (const SceneError& error) {
            return error.what();
        }
        return "accepted";
    }
    static constexpr const char* head =
        "run,payload_mass,airspeed,air_density,fill_time.n,drag_area\n"
        "1,kg,m/s,kg/m^3,1,1\n";
    ScratchDir here_;
};

// To the bit what a scene with these values gives: the factors are powers of two.
TEST_F(CalibratedScene, RunsAsIfItsValuesStoodThere) {
    const Scene scene = read(std::string(head) + "1,100,20,1.225,0.5,2\n");
    const Scene plain = uncalibrated(scene);
    Scene other = plain;
    other.parachutes.front().fill_time.n *= 0.5;
    other.parachutes.front().drag_area *= 2.0;
    twinchute::Run run;
    const RunRecord with = rom::run_rom(scene, run), without = rom::run_rom(plain, run),
                    wanted = rom::run_rom(other, run);
    EXPECT_EQ(*with.metric("peak_force_N"), *wanted.metric("peak_force_N"));
    ASSERT_TRUE(with.uncalibrated);
    const auto before = std::ranges::find(with.uncalibrated->metrics, "peak_force_N", &Metric::key);
    ASSERT_NE(before, with.uncalibrated->metrics.end());
    EXPECT_EQ(before->value, *without.metric("peak_force_N"));
    EXPECT_NE(before->value, *with.metric("peak_force_N"));
    EXPECT_FALSE(without.uncalibrated);
    EXPECT_EQ(with.find_input("parachute.drag_area")->origin, InputOrigin::calibrated);
    EXPECT_EQ(std::get<double>(with.find_input("parachute.drag_area")->value),
              2.0 * plain.parachutes.front().drag_area);
    EXPECT_NE(scene_digest(scene), scene_digest(plain));
}

TEST_F(CalibratedScene, WarnsOutsideOfItsRange) {
    const std::string table = std::string(head) + "1,1,20,1.225,1,1\n2,2,30,1.2,1,1\n";
    twinchute::Run run;
    const RunRecord record = rom::run_rom(read(table), run);
    EXPECT_TRUE(std::ranges::any_of(record.warnings, [](const Warning& w) {
        return w.what.find("payload mass") != std::string::npos &&
               w.what.find("outside of its calibration") != std::string::npos;
    }));
}

TEST_F(CalibratedScene, RefusesWhatDoesNotFit) {
    const auto expect = [&](const std::string& table, const std::string& words) {
        EXPECT_NE(refusal(table).find(words), std::string::npos) << refusal(table);
    };
    expect("run,payload_mass,airspeed,drag_area\n1,kg,m/s,1\n1,100,20,1\n", "'air_density' is missing");
    expect("run,payload_mass,airspeed,air_density\n1,kg,m/s,kg/m^3\n1,100,20,1.2\n", "no column of factors");
    expect(head, "too few lines of numbers");
    expect(std::string(head) + "1,100,20,1.2,1,-2\n", "c.csv:3:");
    const std::string conditions = "run,payload_mass,airspeed,air_density,", units = "1,kg,m/s,kg/m^3,1\n";
    expect(conditions + "filling.initial_mouth\n" + units + "1,100,20,1.2,1\n",
           "has factors on filling.initial_mouth");
    expect(conditions + "initial_drag_area_ratio\n" + units + "1,100,20,1.2,50\n",
           "makes initial_drag_area_ratio");
}

std::string with_uncertainty(const std::string& inputs, const std::string& covariance) {
    return std::string(good_scene) + "\n[uncertainty]\ninputs = " + inputs + "\ncovariance = " + covariance +
           "\n";
}

TEST(Uncertainty, StandsInASceneAndInWhatIsWrittenOfIt) {
    const Scene scene = read_text(
        with_uncertainty("[\"ln parachute.fill_time.n\", \"payload.mass\"]", "[0.01, -0.02, 0.25]"));
    ASSERT_TRUE(scene.uncertainty);
    EXPECT_EQ(scene.uncertainty->inputs,
              (std::vector<std::string>{"ln parachute.fill_time.n", "payload.mass"}));
    EXPECT_EQ(scene.uncertainty->covariance, (std::vector{0.01, -0.02, 0.25}));
    const Scene again = read_text(write_scene(scene));
    ASSERT_TRUE(again.uncertainty);
    EXPECT_EQ(again.uncertainty->inputs, scene.uncertainty->inputs);
    EXPECT_EQ(again.uncertainty->covariance, scene.uncertainty->covariance);
    // No run depends on it.
    EXPECT_EQ(scene_digest(scene), scene_digest(read_text(good_scene)));
    EXPECT_EQ(scene.inputs.size(), read_text(good_scene).inputs.size());
}

TEST(Uncertainty, ThatIsNoneIsRefused) {
    const auto expect = [](const std::string& inputs, const std::string& covariance,
                           const std::string& words) {
        try {
            read_text(with_uncertainty(inputs, covariance));
            ADD_FAILURE() << inputs << covariance;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    const std::string two = "[\"payload.mass\", \"parachute.drag_area\"]";
    expect("[\"payload.mas\"]", "[1]", "'payload.mas' is no number of a scene");
    expect("[\"full.noise.seed\"]", "[1]", "is no number of a scene");
    expect(two, "[1, 2]", "the lower triangle of 2 inputs has 3");
    expect(two, "[1, 2, 1]", "more than wholly correlated");
    expect(two, "[1, 0, -1]", "a variance is not positive");
    expect("[\"payload.mass\", \"payload.mass\"]", "[1, 0, 1]", "twice");
}

}  // namespace
}  // namespace twinchute::test
