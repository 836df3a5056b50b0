// Orders, extrapolations and fronts of synthetic sequences whose limits are known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "compare/convergence.hpp"

namespace twinchute::compare {
namespace {

TEST(CompareMonotone, IsOneWayAndStrict) {
    EXPECT_TRUE(is_monotone(std::array{1.0, 2.0, 2.5}));
    EXPECT_TRUE(is_monotone(std::array{3.0, 2.0, -1.0}));
    EXPECT_FALSE(is_monotone(std::array{1.0, 2.0, 1.5}));
    EXPECT_FALSE(is_monotone(std::array{1.0, 2.0, 2.0}));
    EXPECT_FALSE(is_monotone(std::array{1.0, 1.0, 2.0}));
    EXPECT_FALSE(is_monotone(std::array{1.0}));
    EXPECT_FALSE(is_monotone(std::array{1.0, 2.0, std::nan("")}));
    EXPECT_FALSE(is_monotone(std::array{1.0, std::numeric_limits<double>::infinity()}));
}

TEST(CompareRichardson, FindsTheLimitOfAPowerLawAtAnyRatios) {
    for (const double order : {1.0, 1.7, 2.0, 3.5}) {
        for (const double slope : {0.4, -0.4}) {
            for (const std::array<double, 3>& size :
                 {std::array{1.0, 0.5, 0.25}, std::array{1.0 / 1.5, 1.0 / 2, 1.0 / 3},
                  std::array{7e-5, 6e-5, 1e-5}}) {
                std::array<double, 3> value{};
                for (std::size_t i = 0; i < 3; ++i)
                    value[i] = 5000.0 * (1.0 + slope * std::pow(size[i] / size[0], order));
                const auto found = richardson(size, value);
                ASSERT_TRUE(found) << order;
                EXPECT_NEAR(found->value, 5000.0, 1e-8 * 5000.0) << order;
                EXPECT_NEAR(found->order, order, 1e-8);
            }
        }
    }
}

TEST(CompareRichardson, RefusesWhatDoesNotConverge) {
    const std::array size{1.0, 0.5, 0.25};
    EXPECT_FALSE(richardson(size, {5.0, 5.2, 5.1}));         // back and forth
    EXPECT_FALSE(richardson(size, {5.0, 5.1, 5.1}));         // no difference left
    EXPECT_FALSE(richardson(size, {5.0, 5.1, 5.2}));         // order 0: no limit
    EXPECT_FALSE(richardson(size, {5.0, 5.1, 5.1 + 1e-4}));  // order 10: chance
    EXPECT_FALSE(richardson({1.0, 1.0, 0.5}, {5.0, 5.1, 5.12}));
    EXPECT_FALSE(richardson(size, {5.0, 5.1, std::nan("")}));
}

TEST(CompareFront, IsWhatNothingBeats) {
    const std::array points{CostAndError{1, 1e-1}, CostAndError{2, 1e-3}, CostAndError{3, 1e-2},
                            CostAndError{4, 1e-3}, CostAndError{9, 1e-5}, CostAndError{10, 0.0}};
    EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, false, false, true, true}));
}

TEST(CompareFront, KeepsEqualsAndDropsWhatIsNotFinite) {
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const std::array points{CostAndError{1, 1e-3}, CostAndError{1, 1e-3}, CostAndError{0.5, nan},
                            CostAndError{nan, 0}, CostAndError{infinity, 0}};
    EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, false, false, false}));
    EXPECT_TRUE(pareto_front({}).empty());
}

}  // namespace
}  // namespace twinchute::compare
