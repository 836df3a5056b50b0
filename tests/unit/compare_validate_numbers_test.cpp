// Statistics of a validation, and the quantities that it takes from histories: values worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "compare/validate/quantities.hpp"
#include "compare/validate/statistics.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::compare {
namespace {

/// Predicted over measured e^x, each comparison known to sigma.
Pair pair_of(double x, double sigma) {
    return {5.0 * std::exp(x), 5.0, sigma};
}

TEST(ValidateStatistics, BiasAndScatterAreThoseOfTheLogarithms) {
    // Logarithms 0.1, -0.1, 0.3: mean 0.1, s^2 = (0 + 0.04 + 0.04)/2 = 0.04. With sigma_E = 0.1:
    // sigma_M^2 = 0.04 - 0.01 = 0.03, bias = exp(0.1 + 0.015 - 0.005) = exp(0.11).
    const std::vector<Pair> pairs{pair_of(0.1, 0.1), pair_of(-0.1, 0.1), pair_of(0.3, 0.1)};
    const auto found = agreement(pairs);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->count, 3);
    EXPECT_NEAR(found->mean_log, 0.1, 1e-14);
    EXPECT_NEAR(found->spread, 0.2, 1e-14);
    EXPECT_NEAR(found->sigma_experiment, 0.1, 1e-14);
    EXPECT_FALSE(found->capped);
    EXPECT_NEAR(found->sigma_model, std::sqrt(0.03), 1e-14);
    EXPECT_NEAR(found->bias, std::exp(0.11), 1e-14);
}

TEST(ValidateStatistics, UncertaintiesOfTheExperimentAreSummedAsSquares) {
    // sqrt((0.05^2 + 0.05^2 + 0.1^2)/3) = sqrt(0.005)
    const std::vector<Pair> pairs{pair_of(0.1, 0.05), pair_of(-0.1, 0.05), pair_of(0.3, 0.1)};
    EXPECT_NEAR(agreement(pairs)->sigma_experiment, std::sqrt(0.005), 1e-14);
}

TEST(ValidateStatistics, AModelIsNotShownToBeBetterThanTheMeasurements) {
    // sigma_E^2 = 0.09 is more than s^2/2 = 0.02: both get 0.02, and the corrections of the bias cancel.
    const std::vector<Pair> pairs{pair_of(0.1, 0.3), pair_of(-0.1, 0.3), pair_of(0.3, 0.3)};
    const auto found = agreement(pairs);
    EXPECT_TRUE(found->capped);
    EXPECT_NEAR(found->sigma_experiment, 0.3, 1e-14);  // as stated
    EXPECT_NEAR(found->sigma_model, std::sqrt(0.02), 1e-14);
    EXPECT_NEAR(found->bias, std::exp(0.1), 1e-14);
}

TEST(ValidateStatistics, TooFewOrImpossiblePairsSayNothing) {
    EXPECT_FALSE(agreement(std::vector<Pair>{pair_of(0.1, 0.1), pair_of(0.2, 0.1)}));
    std::vector<Pair> pairs{pair_of(0.1, 0.1), pair_of(0.2, 0.1), pair_of(0.3, 0.1)};
    pairs[1].predicted = 0.0;
    EXPECT_FALSE(agreement(pairs));
    pairs[1].predicted = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(agreement(pairs));
    pairs[1] = {1.0, 1.0, std::numeric_limits<double>::infinity()};
    EXPECT_FALSE(agreement(pairs));
}

TEST(ValidateStatistics, MediansAndDeviations) {
    EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5);
    EXPECT_EQ(median({7.0}), 7.0);
    const std::vector<double> values{1.0, 2.0, 3.0, 4.0};  // sum of squares 5, over 3
    EXPECT_NEAR(standard_deviation(values), std::sqrt(5.0 / 3.0), 1e-14);
    EXPECT_EQ(standard_deviation(std::vector<double>{5.0}), 0.0);
}

TEST(ValidateStatistics, SamplesAreTheSameEveryTimeAndNormal) {
    const std::vector<double> z = normal_numbers(20000, 1);
    EXPECT_EQ(z, normal_numbers(20000, 1));
    EXPECT_NE(z.front(), normal_numbers(1, 2).front());
    // Mean and deviation of 20000 are known to 0.7 %; cut off at three the latter is 0.987 (four deviations
    // held).
    EXPECT_NEAR(std::accumulate(z.begin(), z.end(), 0.0) / 20000.0, 0.0, 0.03);
    EXPECT_NEAR(standard_deviation(z), 0.987, 0.02);
    for (const double one : z)
        EXPECT_LE(std::abs(one), 3.0);
}

TEST(ValidateQuantities, TheLargestMeanOfATriangle) {
    // Rises from 0 to 10 in 1 s and falls in 2 s. The best window of 0.5 s begins and ends on one level:
    // 3 (1 - L/10) = 0.5, L = 8.3333; its mean is (10 + L)/2 = 9.16667.
    const std::vector<double> time{0.0, 1.0, 3.0}, force{0.0, 10.0, 0.0};
    EXPECT_NEAR(largest_mean(time, force, 0.5).value(), 55.0 / 6.0, 1e-12);
    // Over all of it: the mean of a triangle.
    EXPECT_NEAR(largest_mean(time, force, 3.0).value(), 5.0, 1e-12);
    EXPECT_FALSE(largest_mean(time, force, 3.5));
}

TEST(ValidateQuantities, TheLargestMeanAcrossJumps) {
    // 4 for 0.05 s and 0 around it, both edges two points at one time: 4 x 0.05/0.1.
    const std::vector<double> time{0.0, 1.0, 1.0, 1.05, 1.05, 2.0}, force{0.0, 0.0, 4.0, 4.0, 0.0, 0.0};
    EXPECT_NEAR(largest_mean(time, force, 0.1).value(), 2.0, 1e-12);
    EXPECT_NEAR(largest_mean(time, force, 0.01).value(), 4.0, 1e-12);
}

/// A record with these channels.
RunRecord record_of(std::vector<Channel> channels) {
    RunRecord record;
    record.channels = std::move(channels);
    return record;
}

TEST(ValidateQuantities, WidthOfAPulse) {
    // Half height of a triangle is half its base; a mean over 1e-6 s moves that by less.
    const RunRecord record = record_of({{"time", "s", {0.0, 1.0, 3.0}}, {"force", "N", {0.0, 10.0, 0.0}}});
    EXPECT_NEAR(quantity_value("pulse_width", record, {}, {1e-6, 0, 0, 0}).value(), 1.5, 1e-5);
    // One that does not fall again has no width.
    const RunRecord rise = record_of({{"time", "s", {0.0, 1.0, 3.0}}, {"force", "N", {0.0, 10.0, 9.0}}});
    EXPECT_FALSE(quantity_value("pulse_width", rise, {}, {0.1, 0, 0, 0}));
}

TEST(ValidateQuantities, LoadIsForceOverWeight) {
    Scene scene = test::c9_scene();
    scene.payload.mass = 10.0;
    const RunRecord record =
        record_of({{"time", "s", {0.0, 1.0}}, {"force", "N", {2.0 * 98.0665, 2.0 * 98.0665}}});
    EXPECT_NEAR(quantity_value("mean_peak_load", record, scene, {0.1, 0, 0, 0}).value(), 2.0, 1e-12);
}

TEST(ValidateQuantities, FallsAreMeasuredAboveTheGround) {
    Scene scene = test::c9_scene();
    scene.environment.ground = 100.0;
    // 10 m/s for 10 s, then 5 m/s for 10 s: from 190 m to 125 m above the ground.
    const RunRecord record = record_of({{"time", "s", {0.0, 10.0, 10.0, 20.0}},
                                        {"altitude", "m", {300.0, 200.0, 200.0, 150.0}},
                                        {"vertical_speed", "m/s", {-10.0, -10.0, -5.0, -5.0}}});
    EXPECT_NEAR(quantity_value("fall_time", record, scene, {0.1, 0, 190.0, 75.0}).value(), 9.0 + 5.0, 1e-12);
    EXPECT_NEAR(quantity_value("fall_speed", record, scene, {0.1, 150.0, 0, 0}).value(), 10.0, 1e-12);
    EXPECT_NEAR(quantity_value("fall_speed", record, scene, {0.1, 75.0, 0, 0}).value(), 5.0, 1e-12);
    EXPECT_NEAR(quantity_value("fall_speed_ratio", record, scene, {0.1, 0, 150.0, 75.0}).value(), 2.0, 1e-12);
    EXPECT_FALSE(quantity_value("fall_time", record, scene, {0.1, 0, 190.0, 10.0}));
}

TEST(ValidateQuantities, EveryRowHasAUnitAndSaysNothingOfAnEmptyRecord) {
    for (const Quantity& quantity : quantities()) {
        EXPECT_FALSE(quantity_unit(quantity.name).empty()) << quantity.name;
        EXPECT_FALSE(quantity.of({}, {}, {})) << quantity.name;
        EXPECT_EQ(find_quantity(quantity.name), &quantity);
    }
    EXPECT_EQ(quantity_unit("peak_force"), "N");
    EXPECT_EQ(quantity_unit("peek_force"), "");
    EXPECT_EQ(quantity_words("mean_peak_load", {0.1, 0, 0, 0}), "mean peak load, 100 ms");
    EXPECT_EQ(quantity_words("fall_time", {0.1, 0, 400, 20}), "fall time, 400 to 20 m");
}

}  // namespace
}  // namespace twinchute::compare
