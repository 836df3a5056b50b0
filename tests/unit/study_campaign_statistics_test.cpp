// Intervals of campaigns: textbook values, and how often they hold.
#include <gtest/gtest.h>

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "study/campaign/design.hpp"
#include "study/campaign/multi_fidelity.hpp"
#include "study/campaign/quantiles.hpp"
#include "study/campaign/sensitivity_indices.hpp"
#include "study/campaign/statistics.hpp"
#include "tests/support/twin_models.hpp"

namespace twinchute::study {
namespace {

constexpr int repetitions = 1000;
// 95 % of 1000 repetitions, give or take four standard errors of 0.7 %.
constexpr int fewest = 922, most = 978;

// Newcombe, Statistics in Medicine 17 (1998), Table I: method 3 (Wilson), and method 5 (exact) without a hit.
TEST(CampaignStatistics, SharesHaveTheTextbookIntervals) {
    const Interval a = share_interval(81, 263), b = share_interval(15, 148), c = share_interval(1, 29),
                   none = share_interval(0, 20), all = share_interval(20, 20);
    EXPECT_NEAR(a.low, 0.2553, 5e-5);
    EXPECT_NEAR(a.high, 0.3662, 5e-5);
    EXPECT_NEAR(b.low, 0.0624, 5e-5);
    EXPECT_NEAR(b.high, 0.1605, 5e-5);
    EXPECT_NEAR(c.low, 0.0061, 5e-5);
    EXPECT_NEAR(c.high, 0.1718, 5e-5);
    EXPECT_EQ(none.low, 0.0);
    EXPECT_NEAR(none.high, 0.1684, 5e-5);
    EXPECT_NEAR(all.low, 1.0 - 0.1684, 5e-5);
    EXPECT_EQ(all.high, 1.0);
}

// Conover, Practical Nonparametric Statistics, table of binomial sums: of 10 numbers the 2nd and 9th hold the
// median with 97.9 %, of 20 the 6th and 15th with 95.9 %. 1 - 0.95^n reaches 97.5 % at n = 72.
TEST(CampaignStatistics, QuantilesHaveTheTextbookRanks) {
    const QuantileRanks ten = quantile_ranks(0.5, 10), twenty = quantile_ranks(0.5, 20);
    EXPECT_EQ(ten.low, 1u);
    EXPECT_EQ(ten.high, 8u);
    EXPECT_EQ(twenty.low, 5u);
    EXPECT_EQ(twenty.high, 14u);
    EXPECT_EQ(quantile_ranks(0.95, 71).high, std::nullopt);
    EXPECT_EQ(quantile_ranks(0.95, 72).high, 71u);
}

TEST(CampaignStatistics, IntervalsHoldAsOftenAsTheySay) {
    int means = 0, shares = 0, rare = 0, quantiles = 0;
    for (std::uint64_t r = 0; r < repetitions; ++r) {
        Moments moments;
        std::uint64_t hits = 0, rare_hits = 0;
        std::vector<double> values;
        for (std::uint64_t i = 0; i < 200; ++i) {
            values.push_back(uniform(r, i));
            moments.add(values.back());
            hits += values.back() < 0.1 ? 1 : 0;
            rare_hits += values.back() < 0.001 ? 1 : 0;
        }
        means += covers(mean_interval(moments), 0.5) ? 1 : 0;
        shares += covers(share_interval(hits, 200), 0.1) ? 1 : 0;
        rare += covers(share_interval(rare_hits, 200), 0.001) ? 1 : 0;
        std::ranges::sort(values);
        const QuantileRanks ranks = quantile_ranks(0.9, values.size());
        quantiles += values[*ranks.low] <= 0.9 && 0.9 <= values[*ranks.high] ? 1 : 0;
    }
    EXPECT_GE(means, fewest);
    EXPECT_LE(means, most);
    EXPECT_GE(shares, fewest);
    EXPECT_LE(shares, most);
    EXPECT_GE(rare, 930);
    EXPECT_GE(quantiles, 930);
}

TEST(CampaignStatistics, MomentsAddUpAsIfTheyCameOneByOne) {
    Moments one, other, all;
    for (std::uint64_t i = 0; i < 100; ++i) {
        const double x = 1e6 + uniform(1, i);
        (i < 30 ? one : other).add(x);
        all.add(x);
    }
    one.add(other);
    EXPECT_EQ(one.count, all.count);
    EXPECT_NEAR(one.mean, all.mean, 1e-9);
    EXPECT_NEAR(one.variance(), all.variance(), 1e-9);
}

// Axes sd sqrt(-2 ln(1 - level)) of a normal distribution with standard deviations 3 and 1, turned by 30 deg.
TEST(CampaignStatistics, LandingEllipseIsThatOfTheNormalDistribution) {
    PlaneMoments plane;
    const double turn = std::numbers::pi / 6.0;
    std::vector<Eigen::Vector2d> places;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        const double a = 3.0 * normal(1, i), b = normal(2, i);
        places.emplace_back(10.0 + std::cos(turn) * a - std::sin(turn) * b,
                            -5.0 + std::sin(turn) * a + std::cos(turn) * b);
        plane.add(places.back());
    }
    Ellipse ellipse = normal_ellipse(plane, 0.95);
    const double reach = std::sqrt(-2.0 * std::log(0.05));
    EXPECT_TRUE(covers(ellipse.major, 3.0 * reach));
    EXPECT_TRUE(covers(ellipse.minor, reach));
    // A standard deviation of n numbers is sure to 1.96/sqrt(2 n) of itself.
    EXPECT_NEAR(ellipse.major.halfwidth() / ellipse.major.estimate, 1.96 / std::sqrt(40'000.0), 1e-4);
    EXPECT_NEAR(ellipse.major.estimate, 3.0 * reach, 0.02 * 3.0 * reach);  // four standard errors, 0.5 % each
    EXPECT_NEAR(std::remainder(ellipse.angle - turn, std::numbers::pi), 0.0, 0.02);
    EXPECT_TRUE(covers(ellipse.centre_x, 10.0));
    EXPECT_TRUE(covers(ellipse.centre_y, -5.0));
    const auto inside = std::ranges::count_if(places, [&](const auto& p) { return ellipse.contains(p); });
    EXPECT_NEAR(static_cast<double>(inside) / 20'000.0, 0.95, 0.007);
    // All on one line, as without any wind across: half of its length, and no width.
    PlaneMoments line;
    const Eigen::Vector2d along(std::cos(turn), std::sin(turn)), across(-std::sin(turn), std::cos(turn));
    for (std::uint64_t i = 0; i < 20'000; ++i)
        line.add(normal(1, i) * along);
    const Ellipse flat = normal_ellipse(line, 0.95);
    const double half = flat.major.estimate;
    for (const double share : {-0.97, -0.3, 0.2, 0.97})
        EXPECT_TRUE(flat.contains(share * half * along)) << share;
    EXPECT_FALSE(flat.contains(1.03 * half * along));
    EXPECT_FALSE(flat.contains(1e-3 * across));
}

TEST(CampaignStatistics, RankFinderFindsOrderStatistics) {
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 5000; ++i)
        values.push_back(std::exp(normal(7, i)));
    const auto [low, high] = std::ranges::minmax(values);
    RankFinder finder(low, high, values.size());
    for (const double value : values)
        finder.count(value);
    for (const std::uint64_t rank : {0u, 17u, 2500u, 4999u})
        finder.want(rank);
    for (const double value : values)
        finder.collect(value);
    std::ranges::sort(values);
    for (const std::uint64_t rank : {0u, 17u, 2500u, 4999u})
        EXPECT_EQ(finder.at(rank), values[rank]);
}

// Ishigami and Homma (1990), a = 7, b = 0.1: indices in closed form, e.g. Saltelli et al., Global Sensitivity
// Analysis: The Primer, 4.
double ishigami(const std::vector<double>& x) {
    return std::sin(x[0]) + 7.0 * std::pow(std::sin(x[1]), 2) + 0.1 * std::pow(x[2], 4) * std::sin(x[0]);
}
constexpr double ishigami_first[] = {0.3139, 0.4424, 0.0}, ishigami_total[] = {0.5576, 0.4424, 0.2437};

std::vector<Index> ishigami_indices(DesignKind design, std::uint64_t runs) {
    const CampaignSpec spec = test::campaign_of(
        std::vector(3, Distribution::uniform(-std::numbers::pi, std::numbers::pi)), design, runs);
    Design points(spec);
    IndexEstimator estimator(spec);
    std::vector<double> x(3);
    for (std::uint64_t run = 0; run < runs; ++run) {
        points.values(run, x);
        estimator.add(run, x, ishigami(x));
    }
    return estimator.indices();
}

TEST(CampaignSensitivity, SaltellisDesignGivesIshigamisIndices) {
    const std::vector<Index> indices = ishigami_indices(DesignKind::saltelli, 5 * 8192);
    for (std::size_t i = 0; i < 3; ++i) {
        // Plain sampling of 8192 points would scatter by 0.015.
        EXPECT_NEAR(indices[i].first->estimate, ishigami_first[i], 0.02) << i;
        EXPECT_NEAR(indices[i].total->estimate, ishigami_total[i], 0.02) << i;
        EXPECT_TRUE(covers(*indices[i].first, ishigami_first[i])) << i;
        EXPECT_TRUE(covers(*indices[i].total, ishigami_total[i])) << i;
    }
}

TEST(CampaignSensitivity, AnyDesignGivesFirstOrderIndices) {
    for (const DesignKind design : {DesignKind::random, DesignKind::lhs, DesignKind::sobol}) {
        const std::vector<Index> indices = ishigami_indices(design, 40'000);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(indices[i].first->estimate, ishigami_first[i], 0.02) << design_name(design) << i;
        EXPECT_FALSE(indices[0].total.has_value());
    }
}

// Y = x1 + x2 with x1 = 4, or 12 once in a hundred (either end), and x2 uniform over 1: variances of
// 64 * 0.0099 and 1/12.
TEST(CampaignSensitivity, RareValuesHaveTheirShare) {
    for (const std::vector<double>& weights : {std::vector{99.0, 1.0}, std::vector{1.0, 99.0}}) {
        const CampaignSpec spec =
            test::campaign_of({Distribution::discrete({4.0, 12.0}, weights), Distribution::uniform(0.0, 1.0)},
                              DesignKind::random, 40'000);
        Design points(spec);
        IndexEstimator estimator(spec);
        std::vector<double> x(2);
        for (std::uint64_t run = 0; run < spec.runs; ++run) {
            points.values(run, x);
            estimator.add(run, x, x[0] + x[1]);
        }
        const double rare = 64.0 * 0.0099, other = 1.0 / 12.0;
        // 400 rare ones: a twentieth, of the variance that they make.
        EXPECT_NEAR(estimator.indices()[0].first->estimate, rare / (rare + other), 0.03);
        EXPECT_NEAR(estimator.indices()[1].first->estimate, other / (rare + other), 0.03);
    }
}

// The number of a realisation has no order: the mean over a share of its numbers says nothing of it.
// Saltelli's design asks what stays where it stays. Y = h(number) + x with h of variance 1: shares of one
// half.
TEST(CampaignSensitivity, RoundingHasNoShares) {
    // A metric that varies by less than the tolerance of its runs: nobody has a share of that.
    for (const DesignKind design : {DesignKind::random, DesignKind::saltelli})
        for (const double size : {1e-9, 1e-3}) {
            const CampaignSpec spec =
                test::campaign_of(std::vector(2, Distribution::normal(0.0, 1.0)), design, 4000);
            Design points(spec);
            IndexEstimator estimator(spec);
            std::vector<double> x(2);
            for (std::uint64_t run = 0; run < spec.runs; ++run) {
                points.values(run, x);
                estimator.add(run, x, 5000.0 * (1.0 + size * x[0]));
            }
            const Interval first = *estimator.indices()[0].first, other = *estimator.indices()[1].first;
            EXPECT_EQ(std::isnan(first.estimate), size < 1e-8) << design_name(design);
            if (size < 1e-8) continue;
            EXPECT_NEAR(first.estimate, 1.0, 0.1) << design_name(design);
            EXPECT_GE(other.high, 0.0) << design_name(design);  // no index is below zero
        }
}

TEST(CampaignSensitivity, GustsHaveAnIndexBySaltellisDesignAlone) {
    for (const DesignKind design : {DesignKind::random, DesignKind::saltelli}) {
        CampaignSpec spec = test::campaign_of(
            {Distribution::uniform(0.0, 1.0), Distribution::normal(0.0, 1.0)}, design, 4 * 8192);
        spec.inputs[0].gusts = GustProcess{{1.0, 1.0, 1.0}, {100.0, 100.0, 100.0}};
        Design points(spec);
        IndexEstimator estimator(spec);
        std::vector<double> x(2);
        for (std::uint64_t run = 0; run < spec.runs; ++run) {
            points.values(run, x);
            const double h = gusts_of(*spec.inputs[0].gusts, spec.seed, x[0], 1)(0, 0);
            estimator.add(run, x, h + x[1]);
        }
        const std::vector<Index> indices = estimator.indices();
        const bool knows = design == DesignKind::saltelli;
        ASSERT_EQ(indices[0].first.has_value(), knows);
        // 8192 points: a scatter of 0.02 or less, as of Ishigami's.
        EXPECT_NEAR(indices[1].first->estimate, 0.5, 0.06) << design_name(design);
        if (!knows) continue;
        EXPECT_NEAR(indices[0].first->estimate, 0.5, 0.06);
        EXPECT_NEAR(indices[0].total->estimate, 0.5, 0.06);
    }
}

// Y = 3 x1 + 4 x2 of standard normals: shares 9/25 and 16/25.
TEST(CampaignSensitivity, IntervalsHoldForALinearAnswer) {
    int held = 0;
    constexpr int tries = 200;
    for (std::uint64_t r = 0; r < tries; ++r) {
        const CampaignSpec spec =
            test::campaign_of(std::vector(2, Distribution::normal(0.0, 1.0)), DesignKind::random, 2000, r);
        Design points(spec);
        IndexEstimator estimator(spec);
        std::vector<double> x(2);
        for (std::uint64_t run = 0; run < spec.runs; ++run) {
            points.values(run, x);
            estimator.add(run, x, 3.0 * x[0] + 4.0 * x[1]);
        }
        held += covers(*estimator.indices()[0].first, 9.0 / 25.0) ? 1 : 0;
    }
    EXPECT_GE(held, 176);  // 95 % of 200 less four standard errors, and the bins' own width
}

TEST(CampaignPairs, ControlVariateMeanHoldsAsOftenAsItSays) {
    const double variance = 0.11 * 0.11 + 0.01 * 0.01, truth = std::exp(0.02 + 0.5 * variance);
    int held = 0;
    for (std::uint64_t r = 0; r < repetitions; ++r) {
        Pairs pairs;
        Moments cheap;
        for (std::uint64_t i = 0; i < 400; ++i) {
            const Twins t = twins(r, i);
            cheap.add(t.cheap);
            if (i >= 30) continue;
            pairs.cheap.push_back(t.cheap);
            pairs.dear.push_back(t.dear);
        }
        held += covers(control_variate_mean(pairs, cheap), truth) ? 1 : 0;
    }
    EXPECT_GE(held, fewest);
    EXPECT_LE(held, most);
}

TEST(CampaignPairs, GainIsThatOfTheCorrelation) {
    Pairs pairs;
    for (std::uint64_t i = 0; i < 40; ++i) {
        pairs.cheap.push_back(twins(3, i).cheap);
        pairs.dear.push_back(twins(3, i).dear);
    }
    const double r2 = std::pow(pairs.correlation(), 2);
    const Interval gain = control_variate_gain(pairs, 400);
    EXPECT_DOUBLE_EQ(gain.estimate, 1.0 / (1.0 - r2 + 0.1 * r2));
    EXPECT_LT(gain.low, gain.estimate);
    EXPECT_GT(gain.high, gain.estimate);
}

// For what n dear runs at 250 and r n cheap ones cost, the variance of the mean, (1 - c^2)/n + c^2/(r n), has
// its least value there: its derivative vanishes, so 1 % beside it changes by less than 1e-4.
TEST(CampaignPairs, SharesRunsOutForTheLeastVariance) {
    constexpr double c = 0.99, cost = 250.0;
    const auto variance = [&](double r) { return ((1.0 - c * c) + c * c / r) * (cost + r); };
    const double best = best_cheap_runs(c, cost);
    for (const double other : {0.5, 0.99, 1.01, 2.0})
        EXPECT_GT(variance(other * best), variance(best)) << other;
    EXPECT_LT(variance(1.01 * best), 1.0001 * variance(best));
    EXPECT_EQ(best_cheap_runs(0.0, cost), 1.0);
    EXPECT_TRUE(std::isnan(best_cheap_runs(c, std::nan(""))));
}

TEST(CampaignPairs, CorrectionFindsScatterAndTrend) {
    Pairs pairs;
    for (std::uint64_t i = 0; i < 200; ++i) {
        const Twins t = twins(5, i);
        pairs.cheap.push_back(t.cheap), pairs.dear.push_back(t.dear), pairs.inputs.push_back({t.x});
    }
    const auto fit = fit_correction(pairs);
    ASSERT_TRUE(fit.has_value());
    EXPECT_NEAR(fit->scatter, 0.01, 0.002);  // four standard errors of 200 residuals
    EXPECT_NEAR(fit->at(std::vector{1.0}), 0.03, 0.004);
}

TEST(CampaignPairs, ExceedanceAndQuantileAreThoseOfTheDearModel) {
    const Held held = held_by_pairs(40);
    EXPECT_GE(held.probability, 32);
    EXPECT_GE(held.quantile, 32);  // 95 % of 40 less four standard errors
}

}  // namespace
}  // namespace twinchute::study
