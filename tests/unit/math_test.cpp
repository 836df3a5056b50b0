// Small numerical tools: maximum of a function, lanes, moving average.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "fullsim/run/moving_average.hpp"
#include "lib/math/interpolation.hpp"
#include "lib/math/lanes.hpp"
#include "lib/math/maximum.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

TEST(Maximum, FindsAnInteriorHump) {
    // sin has its maximum 1 at pi/2; a position is only known to sqrt(epsilon).
    const Maximum top = maximum_on([](double x) { return std::sin(x); }, 0.0, 3.0, 8);
    EXPECT_NEAR(top.value, 1.0, 1e-15);
    EXPECT_NEAR(top.at, 0.5 * pi, 1e-7);
}

// Five values determine a quartic: its maxima come back to round-off.
TEST(Maximum, OfAQuarticIsExact) {
    const auto five = [](const auto& f, double a, double b) {
        std::array<double, 5> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = f(a + 0.25 * static_cast<double>(i) * (b - a));
        return maximum_of_quartic(values, a, b);
    };
    // x^2 (2 - x)^2 has its hump of 1 at 1, x (1 - x^3) its own at 4^(-1/3).
    const auto hump = [](double x) { return x * x * (2.0 - x) * (2.0 - x); };
    const Maximum top = five(hump, 0.3, 1.8);
    EXPECT_NEAR(top.at, 1.0, 1e-9);
    EXPECT_NEAR(top.value, 1.0, 1e-14);
    const Maximum skew = five([](double x) { return x * (1.0 - x * x * x); }, -0.2, 1.0);
    EXPECT_NEAR(skew.at, std::pow(4.0, -1.0 / 3.0), 1e-9);
    EXPECT_NEAR(skew.value, 0.75 * std::pow(4.0, -1.0 / 3.0), 1e-14);
    EXPECT_EQ(five([](double x) { return x; }, 2.0, 3.0).at, 3.0);
    EXPECT_EQ(five([](double x) { return -x; }, 2.0, 3.0).at, 2.0);
    EXPECT_EQ(five([](double) { return 5.0; }, 2.0, 3.0).value, 5.0);
}

TEST(Maximum, FindsTheEnds) {
    // A peak at the very start of filling is the trap that this is for.
    EXPECT_EQ(maximum_on([](double x) { return -x; }, 2.0, 3.0, 4).at, 2.0);
    EXPECT_EQ(maximum_on([](double x) { return x; }, 2.0, 3.0, 4).at, 3.0);
}

TEST(Maximum, FindsAHumpBesideAnEnd) {
    // Between the last two samples, the last being the larger: x (2.3 - x) on [0, 1.2] in 4 pieces.
    const auto hump = [](double x) { return x * (2.3 - x); };
    EXPECT_NEAR(maximum_on(hump, 0.0, 1.2, 4).at, 1.15, 1e-7);
    EXPECT_NEAR(maximum_on(hump, 1.1, 2.3, 4).at, 1.15, 1e-7);
}

TEST(Maximum, StandsAFlatTopAndAnEmptyInterval) {
    EXPECT_EQ(maximum_on([](double) { return 7.0; }, 0.0, 1.0, 4).value, 7.0);
    EXPECT_EQ(maximum_on([](double x) { return x; }, 1.0, 1.0, 4).value, 1.0);
}

TEST(Lanes, TransposeSwapsRowsAndColumns) {
    Lanes row[4] = {{0, 1, 2, 3}, {10, 11, 12, 13}, {20, 21, 22, 23}, {30, 31, 32, 33}};
    transpose(row[0], row[1], row[2], row[3]);
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            EXPECT_EQ(row[i][k], 10 * k + i);
}

TEST(Lanes, CrossAndDotAreThoseOfVectors) {
    const Lanes3 a{splat(1.0), splat(2.0), splat(3.0)}, b{splat(-4.0), splat(5.0), splat(0.5)};
    const Vec3 u(1.0, 2.0, 3.0), v(-4.0, 5.0, 0.5), w = u.cross(v);
    EXPECT_EQ(dot(a, b)[2], u.dot(v));
    const Lanes3 c = cross(a, b);
    EXPECT_EQ(Vec3(c.x[1], c.y[1], c.z[1]), w);
}

TEST(Reach, LeapsOverNoInterval) {
    // By hand: wide, thin, wide. From 100 the thin one is 80 away and may be come to, from 30 its width
    // counts.
    const std::vector<double> levels{0.0, 10.0, 20.0, 21.0, 40.0};
    const auto reach = [&](double x) { return reach_among(std::span(levels), x); };
    EXPECT_EQ(reach(100.0), 60.0);  // down to the highest level
    EXPECT_EQ(reach(30.0), 9.0);    // down to the thin interval
    EXPECT_EQ(reach(20.5), 1.0);    // inside it
    EXPECT_EQ(reach(21.0), 1.0);    // at its edge
    EXPECT_EQ(reach(15.0), 5.0);    // up to it
    EXPECT_EQ(reach(-7.0), 10.0);   // up, over the edge, no farther than the first is wide
    EXPECT_EQ(reach_among(std::span(levels).first(1), 3.0), std::numeric_limits<double>::infinity());
    EXPECT_EQ(reach_among(std::span(levels).first(0), 3.0), std::numeric_limits<double>::infinity());
    // Any levels: a step of that length either way is no longer than any interval that it comes into. It may
    // end on an edge, to rounding.
    constexpr double near = 1.0 - 1e-12;
    std::mt19937 random(7);
    std::exponential_distribution<double> width(0.1);
    for (int k = 0; k < 200; ++k) {
        std::vector<double> some{0.0};
        while (some.size() < 12)
            some.push_back(some.back() + width(random));
        const double x = std::uniform_real_distribution<double>(-20.0, 20.0 + some.back())(random);
        const double step = reach_among(std::span<const double>(some), x);
        for (std::size_t i = 0; i + 1 < some.size(); ++i) {
            const bool up = some[i] < x + near * step && some[i + 1] > x,
                       down = some[i + 1] > x - near * step && some[i] < x;
            if (up || down) {
                EXPECT_LE(step, some[i + 1] - some[i]) << k << " " << i;
            }
        }
    }
}

TEST(MovingAverage, KeepsALinearSignalInItsCentre) {
    // The average of a line over a centred window is the line. What is left is the window's left edge,
    // cut linearly through one step of the integral: slope dt^2/(8 window) = 2.5e-7.
    fullsim::MovingAverage average(0.01);
    double t = 0.0;
    for (int i = 0; i < 500; ++i) {
        t += i % 3 == 0 ? 1e-4 : 7e-5;
        average.push(t, 3.0 + 2.0 * t);
        if (t > 0.02) {
            ASSERT_TRUE(average.ready());
            ASSERT_NEAR(average.value(), 3.0 + 2.0 * average.centre(), 2.5e-7);
        }
    }
    EXPECT_NEAR(average.centre(), t - 0.005, 1e-15);
}

TEST(MovingAverage, SuppressesAPeriodOfItsWindow) {
    fullsim::MovingAverage average(0.005);
    for (int i = 0; i <= 4000; ++i) {
        const double t = i * 5e-6;
        average.push(t, 1.0 + std::sin(2.0 * pi * t / 0.005));
    }
    EXPECT_NEAR(average.value(), 1.0, 1e-6);
}

TEST(MovingAverage, GrowsWhenStepsShrink) {
    // 10 000 samples per window, ten times the ring it starts with.
    fullsim::MovingAverage average(0.01);
    for (int i = 0; i <= 30000; ++i)
        average.push(i * 1e-6, i * 1e-6);
    EXPECT_NEAR(average.value(), average.centre(), 1e-12);
}

/// Samples of a signal at uneven steps.
struct Signal {
    std::vector<double> t, value;

    /// Integral of the straight lines between samples, from the first to time x.
    double integral(double x) const {
        double sum = 0.0;
        for (std::size_t i = 1; i < t.size() && t[i - 1] < x; ++i) {
            // A piece that x cuts counts by the mean of its ends, as in the filter.
            sum += 0.5 * (value[i - 1] + value[i]) * (std::min(x, t[i]) - t[i - 1]);
        }
        return sum;
    }
};

TEST(IntervalPeak, IsTheLargestMeanOverWindowsCutOffAtBothEndsAndNeverAboveTheSamples) {
    // Random signals with spikes, and intervals from a fifth of a window to twenty of them, one after the
    // other: whatever stands just before or after an interval does not count in it.
    constexpr double window = 5e-3, half = 0.5 * window;
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    fullsim::IntervalPeak filter(window);
    double now = 3.0;
    for (int round = 0; round < 300; ++round) {
        const double length = window * std::exp(std::log(0.2) + uniform(generator) * std::log(100.0));
        Signal signal;
        for (const double begin = now; now <= begin + length; now += 1e-5 + 4e-4 * uniform(generator)) {
            signal.t.push_back(now);
            signal.value.push_back(uniform(generator) < 0.1 ? 1e4 * uniform(generator) : uniform(generator));
        }
        if (signal.t.size() < 2) continue;
        for (std::size_t i = 0; i < signal.t.size(); ++i)
            filter.push(signal.t[i], signal.value[i]);
        const auto found = filter.end();
        // The integral of the interval is a sum of so many terms, each rounded.
        EXPECT_LE(found.value, std::ranges::max(signal.value) * (1.0 + 1e-12)) << round;
        // By its definition, at the centres that the filter looks at: half a window before or after samples.
        const double a = signal.t.front(), b = signal.t.back();
        double largest = 0.0;
        const auto consider = [&](double centre) {
            if (centre < a || centre > b) return;
            const double from = std::max(a, centre - half), to = std::min(b, centre + half);
            largest = std::max(largest, (signal.integral(to) - signal.integral(from)) / (to - from));
        };
        consider(0.5 * (a + b));
        for (const double t : signal.t)
            consider(t - half), consider(t + half);
        // Steps are up to 8 % of a window: centres between those looked at may have a little more.
        EXPECT_NEAR(found.value, largest, 0.1 * largest) << round;
        EXPECT_LE(found.value, largest * (1.0 + 1e-9)) << round;
        EXPECT_GE(found.time, a - 1e-12);
        EXPECT_LE(found.time, b + 1e-12);
    }
}

TEST(IntervalPeak, OfARiseThatEndsIsTheMeanOfItsLastHalfWindow) {
    // The line 2 t up to 1 s: at the end itself the window reaches back by half of its length, 2.5 ms.
    fullsim::IntervalPeak filter(5e-3);
    for (int i = 0; i <= 10000; ++i)
        filter.push(1e-4 * i, 2e-4 * i);
    const auto peak = filter.end();
    EXPECT_NEAR(peak.value, 2.0 * (1.0 - 0.5 * 2.5e-3), 1e-9);
    EXPECT_NEAR(peak.time, 1.0, 1e-9);
    EXPECT_EQ(filter.end().value, 0.0);  // the next interval has no samples yet
}

}  // namespace
}  // namespace twinchute
