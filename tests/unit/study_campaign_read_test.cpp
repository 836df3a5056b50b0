// Reading campaign files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "study/campaign/spec.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::study {
namespace {

const std::string head = "base = \"s.toml\"\n[campaign]\nruns = 10\n";

CampaignSpec read(const std::string& text, const std::filesystem::path& directory = {}) {
    return read_campaign_text(text, "c.toml", directory);
}

std::string complaint(const std::string& text, const std::filesystem::path& directory = {}) {
    try {
        read(text, directory);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no complaint";
}

bool says(const std::string& text, std::string_view what) {
    return text.find(what) != std::string::npos;
}

TEST(CampaignRead, TakesUnitsOfTheKey) {
    const CampaignSpec spec =
        read(head +
             "[[vary]]\nkey = \"payload.mass\"\ndist = { triangular = { low = \"100 lb\", mode = 50, high = "
             "60 } }\n"
             "[[vary]]\nkey = \"release.path_angle\"\ndist = { normal = { mean = \"80 deg\", sd = \"5 %\" }, "
             "max = \"90 deg\" }\n"
             "[[answer]]\nname = \"a\"\nprobability = \"max_deceleration > 6 g0\"\nlimit = \"1 %\"\n"
             "[[answer]]\nname = \"b\"\nquantile = \"peak_force\"\nlevel = \"99 %\"\nlimit = \"12 kN\"\n");
    ASSERT_EQ(spec.inputs.size(), 2u);
    EXPECT_EQ(spec.inputs[0].unit, "kg");
    EXPECT_NEAR(spec.inputs[0].distribution->at(1e-12), 45.359237, 1e-4);
    EXPECT_LE(spec.inputs[1].distribution->at(1.0 - 1e-9), 1.5707963267948966);
    EXPECT_NEAR(spec.answers[0].threshold, 6.0, 1e-12);  // a metric in standard gravities
    EXPECT_EQ(spec.answers[0].metric, "max_deceleration_g");
    EXPECT_DOUBLE_EQ(*spec.answers[0].limit, 0.01);
    EXPECT_DOUBLE_EQ(*spec.answers[1].limit, 12000.0);
    EXPECT_DOUBLE_EQ(spec.answers[1].level, 0.99);
}

// A run of the scene says whether it has that parachute.
TEST(CampaignRead, AsksForMetricsOfOneParachute) {
    const std::string vary =
        head + "[[vary]]\nkey = \"payload.mass\"\ndist = { uniform = { low = 50, high = 60 } }\n";
    const CampaignSpec spec = read(vary +
                                   "[[answer]]\nname = \"a\"\nprobability = \"main_peak_force > 2 kN\"\n"
                                   "[[answer]]\nname = \"b\"\nmean = \"drogue_descent_rate\"\n");
    ASSERT_EQ(spec.answers.size(), 2u);
    EXPECT_EQ(spec.answers[0].metric, "main_peak_force_N");
    EXPECT_DOUBLE_EQ(spec.answers[0].threshold, 2000.0);
    EXPECT_EQ(spec.answers[1].metric, "drogue_descent_rate_m_s");
    EXPECT_EQ(spec.answers[1].unit, "m/s");
    EXPECT_TRUE(
        says(complaint(vary + "[[answer]]\nname = \"a\"\nmean = \"main_force_history\"\n"), "is no metric"));
}

TEST(CampaignRead, TakesACovarianceApart) {
    const CampaignSpec spec = read(head +
                                   "[[vary]]\nkeys = [\"parachute.fill_time.n\", \"payload.mass\"]\n"
                                   "mean = [4, 150]\ncovariance = [[0.16, 0.6], [0.6, 9]]\n");
    EXPECT_NEAR(spec.correlation(0, 1), 0.6 / (0.4 * 3.0), 1e-15);
    EXPECT_NEAR(spec.inputs[1].distribution->at(0.5), 150.0, 1e-12);
    EXPECT_NEAR(spec.inputs[1].distribution->at(0.8413447460685429), 153.0, 1e-9);  // one standard deviation
}

TEST(CampaignRead, TakesInputsOfACalibration) {
    const ScratchDir here;
    here.write("calibrated.toml",
               "schema = 1\nname = \"c\"\nbase = \"c9-inflation.toml\"\n"
               "[[parachute]]\nfill_time.n = 5.5\ndrag_area = 39\n[uncertainty]\n"
               "inputs = [\"ln parachute.fill_time.n\", \"parachute.drag_area\"]\n"
               "covariance = [0.01, -0.18, 4]\n");
    const std::string all = head + "[[vary]]\ncalibrated = \"calibrated.toml\"\n";
    const CampaignSpec spec = read(all, here.path());
    ASSERT_EQ(spec.inputs.size(), 2u);
    EXPECT_NEAR(spec.inputs[0].distribution->at(0.5), 5.5, 1e-12);
    // One standard deviation up: of the logarithm 0.1, of the drag area 2.
    EXPECT_NEAR(spec.inputs[0].distribution->at(0.8413447460685429), 5.5 * std::exp(0.1), 1e-8);
    EXPECT_NEAR(spec.inputs[1].distribution->at(0.8413447460685429), 41.0, 1e-8);
    EXPECT_DOUBLE_EQ(spec.correlation(1, 0), -0.9);
    EXPECT_EQ(read(all + "keys = [\"parachute.drag_area\"]\n", here.path()).inputs.size(), 1u);
    EXPECT_TRUE(says(complaint(all + "keys = [\"payload.mass\"]\n", here.path()),
                     "'payload.mass' is not known there"));
    here.write("calibrated.toml", "schema = 1\nname = \"c\"\nbase = \"c9-inflation.toml\"\n");
    EXPECT_TRUE(says(complaint(all, here.path()), "'calibrated.toml' has no uncertainty"));
}

TEST(CampaignRead, SaysWhereAMistakeIs) {
    const std::string vary = "[[vary]]\nkey = \"payload.mass\"\n";
    EXPECT_TRUE(
        complaint(head + vary + "dist = { normal = { mean = 4, sd = 0 } }\n").starts_with("c.toml:6:"));
    const std::pair<std::string, const char*> wrong[] = {
        {vary + "dist = { normal = { mean = \"4 m\", sd = 1 } }\n", "vary.dist.normal.mean"},
        {vary + "dist = { normal = { mean = 4, sd = 1 }, min = 9, max = 3 }\n", "leaves nothing"},
        {vary + "dist = { normal = { mean = 4, sd = 1 }, uniform = { low = 1, high = 2 } }\n",
         "two distributions"},
        {vary + "dist = { gauss = { mean = 4 } }\n", "no distribution"},
        {vary + "dist = { uniform = { low = 2, high = 1 } }\n", "not above low"},
        {vary + "dist = { table = { values = [1, 2], below = [0, 0.9] } }\n", "from 0 to 1"},
        {vary + "dist = { discrete = { values = [1, 2], weights = [1] } }\n", "weights"},
        {vary, "vary.dist"},
        {"[[vary]]\nkey = \"parachute.drag_area_law\"\ndist = { uniform = { low = 1, high = 2 } }\n",
         "several words"},
        {"[[vary]]\nkey = \"name\"\ndist = { uniform = { low = 1, high = 2 } }\n", "neither a number"},
        {"[[vary]]\nkeys = [\"payload.mass\", \"release.speed\"]\nmean = [1, 2]\ncovariance = [[1, 2], [2, "
         "1]]\n",
         "positive definite"},
    };
    for (const auto& [text, what] : wrong)
        EXPECT_TRUE(says(complaint(head + text), what)) << complaint(head + text) << "\nwants: " << what;
}

TEST(CampaignRead, RefusesPlansThatDoNotGoTogether) {
    const std::string vary = "[[vary]]\nkey = \"payload.mass\"\ndist = { uniform = { low = 1, high = 2 } }\n";
    const auto plan = [&](const std::string& text) {
        return complaint("base = \"s.toml\"\n[campaign]\n" + text + "\n" + vary);
    };
    EXPECT_TRUE(says(plan("runs = 0"), "is zero"));
    EXPECT_TRUE(says(plan("runs = 5\ndesign = \"grid\""), "is not used"));
    EXPECT_TRUE(says(plan("runs = 5\ndesign = \"sobel\""), "sobol"));
    EXPECT_TRUE(says(plan("runs = 5\npilot = 20"), "fidelity = \"both\""));
    EXPECT_TRUE(says(plan("runs = 5\nfidelity = \"both\""), "between pilot and runs"));
    EXPECT_TRUE(says(plan("runs = 5\nuntil = { answer = \"x\", halfwidth = 1 }"), "there is no answer 'x'"));
    // A grid has no interval for a limit; degrees without a unit are radians; a pair is told once.
    EXPECT_TRUE(says(plan("design = \"grid\"\n[[answer]]\nname = \"m\"\nmean = \"peak_force\"\nlimit = 1"),
                     "does not go with a grid"));
    EXPECT_TRUE(says(plan("runs = 5\nrelease_point = { latitude = 47.3, longitude = 8.5 }"),
                     "2710.1 deg is no latitude"));
    EXPECT_TRUE(says(plan("runs = 5\nrelease_point = { latitude = \"89 deg\", longitude = \"181 deg\" }"),
                     "181 deg is no longitude"));
    const std::string speed =
        "[[vary]]\nkey = \"release.speed\"\ndist = { uniform = { low = 1, high = 2 } }\n";
    const auto pair = [](const char* one, const char* other) {
        return fmt::format("[[correlation]]\nbetween = [\"{}\", \"{}\"]\nvalue = 0.5\n", one, other);
    };
    EXPECT_TRUE(says(plan("runs = 5\n" + speed + pair("payload.mass", "release.speed") +
                          pair("release.speed", "payload.mass")),
                     "is given twice"));
    EXPECT_EQ(read("base = \"s.toml\"\n[campaign]\nruns = 7\ndesign = \"saltelli\"\n" + vary).runs, 9u);
    EXPECT_EQ(read("base = \"s.toml\"\n[campaign]\ndesign = \"grid\"\n" + vary + "levels = 12\n").runs, 12u);
}

}  // namespace
}  // namespace twinchute::study
