// Histories of a drop test: how they are read, how far runs are from them, where they are drawn.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "compare/drop_test_histories.hpp"
#include "compare/report/aligned.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "compare/report/plots.hpp"
#include "compare/report/terminal.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute {
namespace {

using namespace compare;

TEST(DropTestHistories, AreReadInTheirUnits) {
    const DropTestHistories test =
        read_test_histories("time,speed,force\ns,ft/s,kN\n0,10,0\n0.5,20,2\n1,15,1\n", "drop.csv");
    ASSERT_NE(test.find("force"), nullptr);
    EXPECT_EQ(test.find("force")->value, (std::vector{0.0, 2000.0, 1000.0}));
    EXPECT_EQ(test.find("force")->time, (std::vector{0.0, 0.5, 1.0}));
    EXPECT_NEAR(test.find("speed")->value[1], 6.096, 1e-12);
    EXPECT_EQ(test.find("drag_area"), nullptr);
}

TEST(DropTestHistories, WhatIsNoHistoryIsRefusedWithItsPlace) {
    const auto refusal = [](const char* text) -> std::string {
        try {
            read_test_histories(text, "drop.csv");
        } catch (const SceneError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(refusal("time\ns\n0\n1\n").find("drop.csv:1:1: there is no history beside the time"),
              std::string::npos);
    EXPECT_NE(refusal("force\nN\n0\n1\n").find("drop.csv:1"), std::string::npos);
    EXPECT_NE(refusal("time,mass\ns,kg\n0,1\n1,1\n").find("there is no history beside the time"),
              std::string::npos);
    EXPECT_NE(refusal("time,force\ns,N\n-2,1\n-1,1\n").find("drop.csv:4:1: the history lies wholly before"),
              std::string::npos);
    EXPECT_NE(refusal("time,force\ns,m\n0,1\n1,1\n").find("drop.csv:2:3"), std::string::npos);
    EXPECT_NE(refusal("time,force\ns,N\n1,1\n0,1\n").find("drop.csv:4:1"), std::string::npos);
}

TEST(DropTestHistories, AreReadAsPeopleHaveThem) {
    for (const char* text :
         {"\"Time (ms)\";\"Force (kN)\"\r\n0;1,5\r\n100;2\r\n\r\n",
          "# rig 3\nt\tforce\n% units\ns\tkN\n0\t1.5\n0.1\t2\n", "time,force\n0,1500\n0.1,2000",
          "time,force,air [degC]\ns,N,\n0,1500,20\n0.1,2000,\n"}) {
        const DropTestHistories test = read_test_histories(text, "drop.csv");
        ASSERT_NE(test.find("force"), nullptr) << text;
        EXPECT_EQ(test.find("force")->time, (std::vector{0.0, 0.1})) << text;
        EXPECT_EQ(test.find("force")->value, (std::vector{1500.0, 2000.0})) << text;
        EXPECT_EQ(test.notes.size(), std::string_view(text).find("degC") == std::string_view::npos ? 0u : 1u);
    }
    // What its clock reads at release is time 0.
    const DropTestHistories late = read_test_histories("time,force\n12,1\n13,2\n", "drop.csv", 12.5);
    EXPECT_EQ(late.find("force")->time, (std::vector{-0.5, 0.5}));
}

/// A record of one channel that is straight from (0, a) to (4, b).
RunRecord straight(const char* channel, double a, double b) {
    RunRecord record = synthetic_record("full", 5000, 1.5, 1.0);
    record.channels = {{"time", "s", {0.0, 4.0}}, {channel, "N", {a, b}}};
    return record;
}

TEST(DropTestHistories, RunsAreAsFarAwayAsTheirDifferenceIsLarge) {
    // Measured 10 from 1 s to 6 s; a run of 11 is 1/10 away over the three seconds that both have, one of
    // 10 + t - 2.5 has sqrt(int (t - 2.5)^2 dt / 300) = sqrt(2.25/300). A run without forces has no distance.
    const DropTestHistories test{"drop.csv", {{"force", {{1.0, 6.0}, {10.0, 10.0}}}}};
    const RunRecord level = straight("force", 11.0, 11.0), tilted = straight("force", 7.5, 11.5),
                    without = straight("speed", 1.0, 1.0);
    const auto scores = test_scores(test, {&level, &tilted});
    ASSERT_EQ(scores.size(), 1u);
    EXPECT_EQ(scores[0].row->key, "force");
    EXPECT_EQ(scores[0].largest, 10.0);
    EXPECT_NEAR(*scores[0].l2[0], 0.1, 1e-12);
    EXPECT_NEAR(*scores[0].l2[1], std::sqrt(2.25 / 300.0), 1e-12);
    EXPECT_FALSE(test_scores(test, {&without, &level})[0].l2[0]);
    // No time in common.
    const DropTestHistories later{"drop.csv", {{"force", {{5.0, 6.0}, {10.0, 10.0}}}}};
    EXPECT_FALSE(test_scores(later, {&level, &tilted})[0].l2[0]);
}

TEST(DropTestHistories, AreDotsAndNumbersOfEveryReport) {
    Comparison comparison = synthetic_comparison();
    EXPECT_EQ(
        force_svg(page_sides(comparison), comparison.test ? &*comparison.test : nullptr).find("<circle"),
        std::string::npos);
    EXPECT_FALSE(nlohmann::json::parse(gap_json(comparison)).contains("test"));
    comparison.test = DropTestHistories{"a&b.csv", {{"force", {{0.25, 1.0, 2.75}, {100.0, 4321.0, 50.0}}}}};
    const std::string svg = force_svg(page_sides(comparison), comparison.test ? &*comparison.test : nullptr);
    EXPECT_NE(svg.find("<circle"), std::string::npos);
    EXPECT_NE(svg.find("a&amp;b.csv"), std::string::npos);
    const auto json = nlohmann::json::parse(gap_json(comparison))["test"];
    EXPECT_EQ(json["file"], "a&b.csv");
    EXPECT_EQ(json["channels"]["force"]["largest"], 4321.0);
    EXPECT_GT(json["channels"]["force"]["candidate"], 0.0);
    EXPECT_NE(terminal_text(comparison, {}).find("4321 N"), std::string::npos);
    EXPECT_NE(report_html(comparison).find("Dots: what a test measured"), std::string::npos);
}

TEST(DropTestHistories, LieOnTheClockOfThePageAsTheReferenceDoes) {
    // Whose snatch comes 0.5 s after release, so that what was measured at 1.25 s stands at 0.75 s, and at
    // nothing but its own instants; what was measured before the runs and after them stands nowhere.
    Comparison comparison = synthetic_comparison();
    comparison.reference.events[0].time = 0.5;
    comparison.test =
        DropTestHistories{"drop.csv", {{"speed", {{-3.0, 1.25, 2.5, 99.0}, {20.0, 17.0, 12.0, 7.0}}}}};
    const AlignedHistories aligned =
        aligned_histories(page_sides(comparison), comparison.test ? &*comparison.test : nullptr);
    ASSERT_TRUE(aligned.channels[0].test.empty());
    const AlignedChannel& speed = aligned.channels[1];
    ASSERT_EQ(speed.channel, "speed");
    std::vector<std::pair<double, double>> dots;
    for (std::size_t i = 0; i < aligned.clock.size(); ++i)
        if (!std::isnan(speed.test[i])) dots.emplace_back(aligned.clock[i], speed.test[i]);
    EXPECT_EQ(dots, (std::vector<std::pair<double, double>>{{0.75, 17.0}, {2.0, 12.0}}));
}

}  // namespace
}  // namespace twinchute
