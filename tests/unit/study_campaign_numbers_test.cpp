// Random numbers, distributions and designs of campaigns.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "study/campaign/design.hpp"
#include "study/campaign/distribution.hpp"
#include "study/campaign/random.hpp"
#include "study/campaign/statistics.hpp"
#include "tests/support/campaign_spec.hpp"

namespace twinchute::study {
namespace {

// Known answers of Philox4x32-10, kat_vectors of Random123: the first two of four words each.
TEST(CampaignRandom, GivesTheKnownAnswers) {
    EXPECT_EQ(random_bits(0, 0, 0, RandomStream{}), 0xe169c58d6627e8d5u);
    constexpr std::uint64_t all = ~std::uint64_t{0};
    EXPECT_EQ(random_bits(all, all, 0xffffffffu, RandomStream{0xffffffffu}), 0x41c83b0e408f276du);
}

TEST(CampaignRandom, UnitNumbersReachNoEnd) {
    EXPECT_GT(unit_number(0), 0.0);
    EXPECT_LT(unit_number(~std::uint64_t{0}), 1.0);
    EXPECT_EQ(unit_number(0) + unit_number(~std::uint64_t{0}), 1.0);
}

/// Mean and standard deviation by the midpoint rule over the shares.
Moments moments_of(const Distribution& d) {
    Moments m;
    constexpr int points = 200'000;
    for (int i = 0; i < points; ++i)
        m.add(d.at((i + 0.5) / points));
    return m;
}

void expect_moments(const Distribution& d, double mean, double sd) {
    const Moments m = moments_of(d);
    // The midpoint rule leaves out the tails beyond 1/400000: 1e-4 of the spread.
    EXPECT_NEAR(m.mean, mean, 1e-4 * sd) << d.text();
    EXPECT_NEAR(std::sqrt(m.variance()), sd, 1e-3 * sd) << d.text();
}

TEST(CampaignDistribution, MomentsAreThoseOfTheirClosedForms) {
    expect_moments(Distribution::normal(3.0, 2.0), 3.0, 2.0);
    expect_moments(Distribution::lognormal(4.0, 0.4), 4.0, 0.4);
    expect_moments(Distribution::uniform(-1.0, 5.0), 2.0, 6.0 / std::sqrt(12.0));
    // (a + b + c)/3 and sqrt((a^2 + b^2 + c^2 - ab - ac - bc)/18)
    expect_moments(Distribution::triangular(1.0, 2.0, 6.0), 3.0,
                   std::sqrt((1. + 4 + 36 - 2 - 6 - 12) / 18.0));
    expect_moments(Distribution::discrete({1.0, 10.0}, {3.0, 1.0}), 3.25, 9.0 * std::sqrt(3.0) / 4.0);
    expect_moments(Distribution::table({0.0, 1.0, 3.0}, {0.0, 0.5, 1.0}), 1.25,
                   std::sqrt(0.5 / 3.0 + 0.5 * 13.0 / 3.0 - 1.25 * 1.25));
}

// Johnson, Kotz, Balakrishnan, Continuous Univariate Distributions 1, 13.10: mean of a truncated normal.
TEST(CampaignDistribution, CuttingOffRenormalises) {
    Distribution d = Distribution::normal(1.0, 2.0);
    ASSERT_TRUE(d.cut(0.0, 4.0));
    const auto density = [](double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); };
    const auto below = [](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); };
    const double share = below(1.5) - below(-0.5);
    EXPECT_NEAR(moments_of(d).mean, 1.0 + 2.0 * (density(-0.5) - density(1.5)) / share, 1e-4);
    EXPECT_GE(d.at(1e-15), 0.0);
    EXPECT_LE(d.at(1.0 - 1e-15), 4.0);
    EXPECT_FALSE(d.cut(5.0, 4.0));
}

TEST(CampaignDistribution, KeepsItsDigitsFarOutInATail) {
    Distribution d = Distribution::normal(0.0, 1.0);
    ASSERT_TRUE(d.cut(8.0, HUGE_VAL));  // 6e-16 of it: 1 - P knows one digit of that
    // Half of Q(8) = 6.22096057e-16 lies above 8.0849110, by bisection of erfc in another program.
    EXPECT_NEAR(d.at(0.5), 8.0849110, 1e-6);
}

TEST(CampaignDistribution, ShareBelowUndoesTheValue) {
    Distribution cut = Distribution::lognormal(4.0, 0.4);
    cut.cut(3.0, 5.0);
    for (const Distribution& d :
         {Distribution::normal(3.0, 2.0), cut, Distribution::uniform(-1.0, 5.0),
          Distribution::triangular(1.0, 2.0, 6.0), Distribution::table({0.0, 1.0, 3.0}, {0.0, 0.2, 1.0})})
        for (const double u : {0.001, 0.2, 0.5, 0.9, 0.999})
            EXPECT_NEAR(d.below(d.at(u)), u, 1e-12) << d.text();
}

std::vector<double> point_of(Design& design, std::uint64_t run) {
    std::vector<double> point(design.dimensions());
    design.point(run, point);
    return point;
}

TEST(CampaignDesign, APointHangsOnItsNumberAlone) {
    for (const DesignKind kind :
         {DesignKind::random, DesignKind::lhs, DesignKind::sobol, DesignKind::grid, DesignKind::saltelli}) {
        const CampaignSpec spec =
            test::campaign_of(std::vector(3, Distribution::uniform(0.0, 1.0)), kind, 1000);
        Design forward(spec), jumping(spec);
        std::vector<std::vector<double>> points;
        for (std::uint64_t run = 0; run < 200; ++run)
            points.push_back(point_of(forward, run));
        for (const std::uint64_t run : {150u, 0u, 1u, 7u, 6u, 199u, 0u, 64u, 65u})
            EXPECT_EQ(point_of(jumping, run), points[run]) << design_name(kind) << run;
    }
}

// A digital shift keeps Sobol's net: the first 256 points have one in each of 16 x 16 cells.
TEST(CampaignDesign, SobolPointsAreBalanced) {
    const CampaignSpec spec =
        test::campaign_of(std::vector(2, Distribution::uniform(0.0, 1.0)), DesignKind::sobol, 256, 99);
    Design design(spec);
    std::set<int> cells;
    for (std::uint64_t run = 0; run < 256; ++run) {
        const std::vector<double> p = point_of(design, run);
        cells.insert(static_cast<int>(p[0] * 16.0) * 16 + static_cast<int>(p[1] * 16.0));
    }
    EXPECT_EQ(cells.size(), 256u);
}

TEST(CampaignDesign, LatinHypercubeHasOneRunInEachStratum) {
    for (const std::uint64_t runs : {1u, 2u, 1000u, 1024u, 1025u}) {
        const CampaignSpec spec =
            test::campaign_of(std::vector(2, Distribution::uniform(0.0, 1.0)), DesignKind::lhs, runs);
        Design design(spec);
        std::array<std::set<int>, 2> strata;
        for (std::uint64_t run = 0; run < runs; ++run)
            for (std::size_t k = 0; k < 2; ++k)
                strata[k].insert(static_cast<int>(point_of(design, run)[k] * static_cast<double>(runs)));
        EXPECT_EQ(strata[0].size(), runs);
        EXPECT_EQ(strata[1].size(), runs);
    }
}

TEST(CampaignDesign, InputsGoTogetherAsAsked) {
    CampaignSpec spec = test::campaign_of({Distribution::normal(1.0, 2.0), Distribution::normal(-3.0, 0.5)},
                                          DesignKind::random, 100'000);
    spec.correlation(0, 1) = spec.correlation(1, 0) = -0.6;
    Design design(spec);
    std::array<Moments, 2> each;
    Moments sum;  // of the standardised two: its variance is 2 + 2 r
    std::vector<double> v(2);
    for (std::uint64_t run = 0; run < spec.runs; ++run) {
        design.values(run, v);
        each[0].add(v[0]), each[1].add(v[1]);
        sum.add((v[0] - 1.0) / 2.0 + (v[1] + 3.0) / 0.5);
    }
    // Four standard errors of 1e5 runs: of a mean 0.013 sd, of a standard deviation 0.9 %, of r 0.008.
    EXPECT_NEAR(each[0].mean, 1.0, 0.026);
    EXPECT_NEAR(std::sqrt(each[1].variance()), 0.5, 0.0045);
    EXPECT_NEAR(0.5 * sum.variance() - 1.0, -0.6, 0.01);
}

}  // namespace
}  // namespace twinchute::study
