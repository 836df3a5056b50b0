// A series as table and picture, and trends over its cases.
#include "compare/series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "compare/validate/run_suite.hpp"
#include "compare/validate/trends.hpp"
#include "lib/scene/opening_tables.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::compare {
namespace {

using test::edited;
using test::good_scene;

std::size_t count_of(const std::string& text, std::string_view word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
        ++count;
    return count;
}

/// Three cases in two groups; the force of the full model is 5000 N, 5500 N and 6000 N.
CaseSeries synthetic_series() {
    CaseSeries series;
    series.title = "A series <of> three";
    series.reference_title = "full model";
    series.candidate_title = "reduced model";
    series.spec = {"snatch_speed", "peak_force", "", "", {}, {}};
    for (int i = 0; i < 3; ++i) {
        Scene scene;
        scene.case_name = "case-" + std::to_string(i);
        scene.series = SeriesSpec{"snatch_speed", "peak_force", i < 2 ? "low" : "high, dry", "", {}, {}};
        Comparison comparison = synthetic_comparison();
        for (RunRecord* record : {&comparison.reference, &comparison.candidate}) {
            record->add_metric("snatch_speed_m_s", 20.0 + i);
            record->add_metric("peak_force_N", *record->metric("peak_force_N") + 500.0 * i);
        }
        comparison.gap = measure_gap(comparison.reference, comparison.candidate, {});
        series.cases.push_back(series_case(scene, comparison));
    }
    return series;
}

TEST(SeriesFiles, TheTableHasALineForEachCaseAndBothFidelities) {
    const std::string csv = series_csv(synthetic_series());
    EXPECT_EQ(csv.find("case,group,full.status,full.snatch_speed,full.peak_force,"), 0u) << csv;
    EXPECT_EQ(count_of(csv, "\n"), 5u);
    EXPECT_NE(csv.find("\n-,-,-,m/s,N,"), std::string::npos) << csv;
    EXPECT_NE(csv.find("\ncase-1,low,completed,21,5500,"), std::string::npos) << csv;
    EXPECT_NE(csv.find("\ncase-2,\"high, dry\",completed,22,6000,"), std::string::npos) << csv;
    EXPECT_NE(csv.find(",rom.status,rom.snatch_speed,rom.peak_force,"), std::string::npos) << csv;
    // The energy that the synthetic full run leaves over, and (4800 - 5000)/5000.
    EXPECT_NE(csv.find(",0.0012,12,"), std::string::npos) << csv;
    EXPECT_NE(csv.find(",-0.04\n"), std::string::npos) << csv;
}

TEST(SeriesFiles, TheMarkdownShowsBothAndTheGap) {
    const std::string markdown = series_markdown(synthetic_series());
    EXPECT_NE(markdown.find("| case-0 | low | within | completed | 20.00 |"), std::string::npos) << markdown;
    EXPECT_NE(markdown.find("| 4800 / 5000 |"), std::string::npos) << markdown;
    EXPECT_NE(markdown.find("| +4.0 % | 1.2e-03 |"), std::string::npos) << markdown;
}

TEST(SeriesFiles, ThePictureHasAMarkForEveryRunAndASlotForATest) {
    CaseSeries series = synthetic_series();
    std::string svg = svg_plot(series_plot(series));
    constexpr std::string_view cross = "m0 -9l-9 9";
    // Two marks a case, two in the legend.
    EXPECT_EQ(count_of(svg, "<circle"), 8u);
    EXPECT_NE(svg.find("case-1, rom: 21, 5300"), std::string::npos);
    EXPECT_NE(svg.find("test: none (series.test)"), std::string::npos);
    EXPECT_NE(svg.find("A series &lt;of&gt; three"), std::string::npos);
    EXPECT_NE(svg.find("Peak opening force [N]"), std::string::npos);
    EXPECT_EQ(count_of(svg, cross), 1u);  // in the legend
    series.spec.test = "drops.csv";
    series.spec.test_x = {20.5, 21.5};
    series.spec.test_y = {5100.0, 7000.0};
    svg = svg_plot(series_plot(series));
    EXPECT_EQ(svg.find("test: none"), std::string::npos);
    EXPECT_NE(svg.find("drops.csv"), std::string::npos);
    EXPECT_EQ(count_of(svg, cross), 3u);
    series.cases.clear();
    series.spec.test_x.clear(), series.spec.test_y.clear();
    EXPECT_NE(svg_plot(series_plot(series)).find("no case has both metrics"), std::string::npos);
}

TEST(SeriesFiles, OfOneFidelityHaveNothingOfAnother) {
    CaseSeries series;
    series.title = "A series of two";
    series.reference_title = "reduced-order model";
    series.spec = {"snatch_speed", "peak_force", "", "", {}, {}};
    for (const double peak : {5000.0, 6000.0}) {
        Scene scene;
        scene.case_name = peak > 5500 ? "heavy" : "light";
        series.cases.push_back(series_case(scene, synthetic_record("rom", peak, 1.5, 1e-3)));
        series.cases.back().page = scene.case_name + "/run.html";
    }
    const std::string csv = series_csv(series);
    EXPECT_EQ(csv.find("case,group,rom.status,rom.snatch_speed,rom.peak_force,"), 0u) << csv;
    EXPECT_EQ(csv.find("gap"), std::string::npos) << csv;
    EXPECT_NE(csv.find("\nheavy,,completed,21,6000,"), std::string::npos) << csv;
    const std::string table = series_terminal(series, {});
    for (const char* word : {"gap", "verdict", "group", " / "})
        EXPECT_EQ(table.find(word), std::string::npos) << word << " in " << table;
    const std::string page = series_html(series);
    EXPECT_NE(page.find("<a href=\"heavy/run.html\">heavy</a>"), std::string::npos);
    EXPECT_EQ(page.find("Where two numbers stand"), std::string::npos);
    // One metric against another, force, speed: a line for each case in the last two.
    EXPECT_EQ(count_of(page, "<svg"), 3u);
    const std::vector<Plot> openings = opening_plots(series);
    ASSERT_EQ(openings.size(), 2u);
    for (const Plot& plot : openings)
        EXPECT_EQ(plot.series.size(), 2u);
    EXPECT_EQ(openings[0].series[1].label, "heavy");
    EXPECT_NE(openings[0].series[0].colour, openings[0].series[1].colour);
    EXPECT_EQ(openings[0].x.end, 2.0 * 1.6);  // full open at 1.5 s + 0.1 s in the synthetic record
    for (std::size_t i = 0; i < 2; ++i) {     // nothing of a history is lost, least of all its peak
        const RunRecord record = synthetic_record("rom", i == 0 ? 5000.0 : 6000.0, 1.5, 1e-3);
        EXPECT_EQ(openings[0].series[i].y, record.find_channel("force")->values);
        EXPECT_EQ(openings[1].series[i].y, record.find_channel("speed")->values);
    }
}

TEST(SeriesKeys, AreReadWithTheirTestData) {
    ScratchDir here;
    here.write("drops.csv", "froude_number,peak_force\n1,kN\n2,1.5\n5,4.2\n");
    here.write("series.toml",
               edited(good_scene, "[stop]", "[series]\ny = \"peak_force\"\ntest = \"drops.csv\"\n[stop]") +
                   "[[case]]\nname = \"a\"\nset = { \"series.group\" = \"A\" }\n"
                   "[[case]]\nname = \"b\"\n");
    const std::vector<Scene> scenes = read_scenes(here / "series.toml");
    ASSERT_EQ(scenes.size(), 2u);
    EXPECT_EQ(scenes[0].series->group, "A");
    EXPECT_EQ(scenes[1].series->group, "");
    EXPECT_EQ(scenes[0].series->x, "froude_number");
    EXPECT_EQ(scenes[0].series->test_x, (std::vector<double>{2.0, 5.0}));
    EXPECT_EQ(scenes[0].series->test_y, (std::vector<double>{1500.0, 4200.0}));
    EXPECT_THROW(read_test_points("froude_number,snatch_speed\n1,m/s\n1,2\n2,3\n", "t.csv", "froude_number",
                                  "peak_force"),
                 SceneError);
}

/// y = x^2 in two groups, the second 10 % above the first.
std::vector<SeriesPoint> squares() {
    std::vector<SeriesPoint> points;
    for (const char* group : {"a", "b"})
        for (const double x : {3.0, 1.0, 2.0})
            points.push_back({group + std::to_string(static_cast<int>(x)),
                              group,
                              {{"x", x}, {"y", (*group == 'a' ? 1.0 : 1.1) * x * x}}});
    return points;
}

TEST(Trends, CountStepsAndMeasureSpreads) {
    using enum TrendAsked::Kind;
    const std::vector<SeriesPoint> points = squares();
    EXPECT_EQ(trend_of({rises, "y", "x", "group", {}}, points), 1.0);
    EXPECT_EQ(trend_of({falls, "y", "x", "group", {}}, points), 0.0);
    // Bundled by x, the second group is 0.1/1.05 above the first.
    EXPECT_NEAR(*trend_of({spread, "y", "", "x", {}}, points), 0.1 / 1.05, 1e-12);
    EXPECT_NEAR(*trend_of({spread, "y", "", "", {"a1", "a2"}}, points), 3.0 / 2.5, 1e-12);
    // y = c x^2 in each of two bundles: the power is 2 whatever c is.
    EXPECT_NEAR(*trend_of({exponent, "y", "x", "group", {}}, points), 2.0, 1e-12);
    // All points in one bundle, 1 1.1 4 4.4 9 9.9 by x: the steps within a value of x rise too, by order of
    // position.
    EXPECT_EQ(trend_of({rises, "y", "x", "", {}}, points), 1.0);
    std::vector<SeriesPoint> bent = points;
    bent[0].metrics["y"] = 0.5;  // at x = 3 of the first group
    EXPECT_EQ(trend_of({rises, "y", "x", "group", {}}, bent), 0.75);
    EXPECT_EQ(trend_of({falls, "y", "x", "group", {}}, bent), 0.25);
}

TEST(Trends, NeedTheirMetricsAndTwoCases) {
    using enum TrendAsked::Kind;
    const std::vector<SeriesPoint> points = squares();
    EXPECT_FALSE(trend_of({rises, "z", "x", "", {}}, points));
    EXPECT_FALSE(trend_of({rises, "y", "z", "", {}}, points));
    EXPECT_FALSE(trend_of({rises, "y", "x", "z", {}}, points));
    EXPECT_FALSE(trend_of({rises, "y", "x", "", {"a1"}}, points));
    EXPECT_FALSE(trend_of({rises, "y", "x", "", {"a1", "a7"}}, points));
}

class TrendSuite : public testing::Test {
protected:
    /// The descent rate of three payloads, 1 : 4 : 9, is 1 : 2 : 3.
    TrendSuite() {
        here_.write("series.toml",
                    edited(good_scene, "time = \"6 s\"", "time = \"20 s\"") +
                        "[[case]]\nname = \"light\"\nset = { \"payload.mass\" = \"50 kg\" }\n"
                        "[[case]]\nname = \"heavy\"\nset = { \"payload.mass\" = \"200 kg\" }\n"
                        "[[case]]\nname = \"heavier\"\nset = { \"payload.mass\" = \"450 kg\" }\n");
    }
    SuiteResult run(const std::string& rows) {
        here_.write(
            "s.toml",
            "schema = 1\nname = \"s\"\ntitle = \"S\"\nevidence = \"printed\"\n[[case]]\nname = \"c\"\n"
            "series = \"series.toml\"\nsource = \"s\"\n" +
                rows);
        bool interrupted = false;
        const std::vector<const Fidelity*> fidelities{&rom::rom_fidelity()};
        return run_suite(read_suite(here_ / "s.toml"), fidelities, {}, interrupted);
    }
    ScratchDir here_;
};

TEST_F(TrendSuite, JudgesTheCasesOfASeries) {
    const SuiteResult result = run(
        "row = [{ trend = \"rises\", y = \"descent_rate\", x = \"mass_ratio\", expected = 1, tolerance = 0 "
        "},\n"
        "{ trend = \"falls\", y = \"descent_rate\", x = \"mass_ratio\", expected = 1, tolerance = 0 },\n"
        "{ trend = \"spread\", y = \"descent_rate\", cases = [\"light\", \"heavier\"], expected = 1, "
        "tolerance = "
        "\"5 %\" },\n"
        "{ trend = \"rises\", y = \"landing_east\", x = \"mass_ratio\", expected = 1, tolerance = 0 }]\n");
    ASSERT_EQ(result.rows.size(), 4u);
    EXPECT_EQ(result.rows[0].verdict, RowVerdict::within) << result.rows[0].why;
    EXPECT_EQ(result.rows[1].verdict, RowVerdict::exceeded);
    // sqrt((450 + 5.19)/(50 + 5.19)) = 2.872 : 1, whose difference over their mean is 0.967.
    EXPECT_EQ(result.rows[2].verdict, RowVerdict::within);
    EXPECT_NEAR(*result.rows[2].predicted, 2.0 * 1.872 / 3.872, 1e-3);
    EXPECT_EQ(result.rows[3].verdict, RowVerdict::exceeded);
    EXPECT_EQ(result.rows[3].why, "not every case has these metrics");
}

TEST_F(TrendSuite, RefusesWhatIsNoTrend) {
    const auto complaint = [&](const std::string& row) -> std::string {
        try {
            run("row = [{ " + row + ", expected = 1, tolerance = 0 }]\n");
        } catch (const SceneError& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_NE(complaint("trend = \"grows\", y = \"impulse\", x = \"mass_ratio\"").find("'grows' is unknown"),
              std::string::npos);
    EXPECT_NE(
        complaint("trend = \"rises\", y = \"impulses\", x = \"mass_ratio\"").find("'impulses' is no metric"),
        std::string::npos);
    EXPECT_NE(complaint("trend = \"rises\", y = \"impulse\"").find('x'), std::string::npos);
    EXPECT_NE(complaint("quantity = \"impulse\"").find("trend"), std::string::npos);
}

}  // namespace
}  // namespace twinchute::compare
