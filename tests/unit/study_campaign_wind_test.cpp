// Winds of a campaign: gusts with the moments that they are asked for, and tables drawn by index.
#include <gtest/gtest.h>

#include <cmath>

#include "study/campaign/design.hpp"
#include "study/campaign/dispersed_wind.hpp"
#include "study/campaign/sampler.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::study {
namespace {

const GustProcess process{{2.0, 1.0, 0.5}, {100.0, 200.0, 400.0}};
constexpr int runs = 20'000, levels = 31;  // 10 m apart

/// A number of a realisation, as an input of a campaign has it.
double realisation(int run) {
    return (run + 0.5) / runs;
}

// Independent realisations of a Gaussian process: their variance is known to sd^2 sqrt(2/runs), a covariance
// at a lag to sd^2 sqrt((1 + r^2)/runs); five of these are beyond chance in one test of 10^5.
TEST(CampaignGusts, HaveTheVarianceAndTheCorrelationOfTheirProcess) {
    constexpr int low = 3, lag = 10, high = low + lag;  // 100 m
    Eigen::Matrix3d variance = Eigen::Matrix3d::Zero();
    Eigen::Array3d at_high = Eigen::Array3d::Zero(), product = at_high, mean = at_high;
    for (int run = 0; run < runs; ++run) {
        const Eigen::Matrix3Xd gusts = gusts_of(process, 7, realisation(run), levels);
        variance += gusts.col(low) * gusts.col(low).transpose() / runs;
        at_high += gusts.col(high).array().square() / runs;
        product += gusts.col(low).array() * gusts.col(high).array() / runs;
        mean += gusts.col(high).array() / runs;
    }
    for (int c = 0; c < 3; ++c) {
        const double sd = process.sd[c], r = std::exp(-100.0 / process.correlation_length[c]);
        EXPECT_NEAR(mean[c], 0.0, 5.0 * sd / std::sqrt(runs));
        EXPECT_NEAR(variance(c, c), sd * sd, 5.0 * sd * sd * std::sqrt(2.0 / runs));
        EXPECT_NEAR(at_high[c], sd * sd, 5.0 * sd * sd * std::sqrt(2.0 / runs));
        EXPECT_NEAR(product[c], r * sd * sd, 5.0 * sd * sd * std::sqrt((1.0 + r * r) / runs));
        const int other = (c + 1) % 3;  // components are independent
        EXPECT_NEAR(variance(c, other), 0.0, 5.0 * sd * process.sd[other] / std::sqrt(runs));
    }
}

TEST(CampaignGusts, AreAFunctionOfSeedAndNumberAlone) {
    const Eigen::Matrix3Xd one = gusts_of(process, 7, 0.25, levels);
    EXPECT_EQ(one, gusts_of(process, 7, 0.25, 2 * levels).leftCols(levels));
    EXPECT_NE(one, gusts_of(process, 8, 0.25, levels));
    EXPECT_NE(one, gusts_of(process, 7, std::nextafter(0.25, 1.0), levels));
}

TEST(CampaignGusts, AddToTheWindOnTheLevelsOfBoth) {
    const Wind table{{{0.0, {1, 0, 0}}, {15.0, {2, 0, 0}}, {500.0, {5, 3, 0}}}, "t.csv"};
    const Wind both = with_gusts(table, process, 7, 0.25, 100.0, 395.0);
    const Eigen::Matrix3Xd gusts = gusts_of(process, 7, 0.25, levels);
    for (int level = 0; level < levels; ++level) {
        const double altitude = 100.0 + 10.0 * level;
        EXPECT_LT((both.at(altitude) - table.at(altitude) - gusts.col(level)).norm(), 1e-12) << altitude;
    }
    // Beyond its ends a gust goes on as a wind does.
    EXPECT_LT((both.at(15.0) - Vec3(2, 0, 0) - gusts.col(0)).norm(), 1e-12);
    EXPECT_EQ(both.table, "t.csv");
}

class CampaignWind : public ::testing::Test {
protected:
    CampaignSpec spec_of(const std::string& more) const {
        here_.write("calm.csv", "altitude,east,north\nm,m/s,m/s\n0,0,0\n2000,0,0\n");
        here_.write("east.csv", "altitude,east,north\nm,m/s,m/s\n0,3,0\n2000,9,0\n");
        return read_campaign_text(
            "base = \"c9-drift.toml\"\n[campaign]\nruns = 100\n[[vary]]\nkey = \"wind.table\"\n"
            "dist = { discrete = { values = [\"calm.csv\", \"east.csv\"], weights = [1, 3] } }\n"
            "[[vary]]\nkey = \"wind.scale\"\ndist = { uniform = { low = 0, high = 2 } }\n" +
                more + "[[answer]]\nname = \"rate\"\nmean = \"descent_rate\"\n",
            "c.toml", here_.path());
    }
    ScratchDir here_;
};

TEST_F(CampaignWind, IsOneOfTheTables) {
    const CampaignSpec spec = spec_of("");
    const Sampler sampler(spec, base_of(spec));
    Scene scene = sampler.blank();
    sampler.put(scene, std::vector{1.0, 2.0});
    EXPECT_EQ(scene.environment.wind->at(1000.0), Vec3(12, 0, 0));  // half way up, times two
    sampler.put(scene, std::vector{0.0, 2.0});
    EXPECT_EQ(scene.environment.wind->at(1000.0), Vec3(0, 0, 0));
    // Each number of the run's row names its scene, whoever makes it.
    Design design(spec);
    std::vector<double> values(2);
    int of_east = 0;
    for (std::uint64_t run = 0; run < 100; ++run) {
        design.values(run, values);
        of_east += values[0] == 1.0 ? 1 : 0;
        sampler.put(scene, values);
        EXPECT_EQ(scene.environment.wind, sampler.scene_at(values).environment.wind);
    }
    EXPECT_NEAR(of_east, 75, 5 * std::sqrt(100 * 0.75 * 0.25));  // binomial
}

TEST_F(CampaignWind, HasGustsOnTopOfItsTable) {
    const CampaignSpec spec = spec_of(
        "[[vary]]\nkey = \"wind.gusts\"\nsd = [\"2 m/s\", \"1 m/s\", 0.5]\n"
        "correlation_length = [\"100 m\", 200, 400]\n");
    const Sampler sampler(spec, base_of(spec));
    Scene scene = sampler.blank();
    sampler.put(scene, std::vector{1.0, 1.0, 0.25});
    const double ground = scene.environment.ground;
    const Eigen::Matrix3Xd gusts = gusts_of(process, spec.seed, 0.25, levels);
    const Vec3 table(3.0 + 6.0 * (ground + 50.0) / 2000.0, 0, 0);
    EXPECT_LT((scene.environment.wind->at(ground + 50.0) - table - gusts.col(5)).norm(), 1e-9);
    EXPECT_EQ(scene.environment.wind, sampler.scene_at(std::vector{1.0, 1.0, 0.25}).environment.wind);
}

TEST_F(CampaignWind, IsRefusedWhereItIsNone) {
    const auto complaint = [&](const std::string& more) {
        try {
            spec_of(more);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string head = "[[vary]]\nkey = \"wind.gusts\"\n";
    EXPECT_NE(complaint(head + "sd = [1, 1]\ncorrelation_length = [9, 9, 9]\n").find("east, north and up"),
              std::string::npos);
    EXPECT_NE(complaint(head + "sd = [0, 0, 0]\ncorrelation_length = [9, 9, 9]\n").find("zero of all"),
              std::string::npos);
    EXPECT_NE(complaint(head + "sd = [1, 1, 1]\ncorrelation_length = [0, 9, 9]\n").find("below 1 m"),
              std::string::npos);
    EXPECT_NE(complaint("[[vary]]\nkey = \"wind.tabel\"\n").find("did you mean 'wind.table'?"),
              std::string::npos);
}

}  // namespace
}  // namespace twinchute::study
