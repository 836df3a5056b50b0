// An attribution in words, as a table and as JSON, there and back. Expected sentences are written out.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "compare/report/attribution_json.hpp"
#include "compare/report/attribution_text.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/markdown.hpp"
#include "compare/report/terminal.hpp"
#include "lib/record/record_error.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute::compare {
namespace {

/// The synthetic records have peaks of 4800 and 5000 N.
Comparison explained() {
    Comparison comparison = synthetic_comparison();
    MetricAttribution peak{"peak_force", 4800, 5000, {}, 30, {}};
    peak.terms = {{"structure", "Structure", 20, "what is left"},
                  {"added-mass", "Added mass", 160, ""},
                  {"line-drag", "Line drag", -10, ""}};
    comparison.attribution = Attribution{{peak}, {}, {"a note"}};
    return comparison;
}

std::string sentence(const Comparison& comparison) {
    return attribution_sentence(comparison.attribution->metrics.front(), comparison);
}

TEST(CompareAttributionText, NamesTheGapAndTheLargestTerms) {
    EXPECT_EQ(sentence(explained()),
              "Peak opening force: full is 200.0 N (4.0 %) above rom. Largest terms: Added mass +160.0 N; "
              "interaction +30.0 N.");
}

TEST(CompareAttributionText, AGapWithinTheScatterIsCalledSo) {
    Comparison comparison = explained();
    comparison.attribution->metrics.front().scatter = 200.0;
    EXPECT_EQ(
        sentence(comparison),
        "Peak opening force: full is 200.0 N (4.0 %) above rom. That is within the scatter of full over "
        "seeds, 200.0 N: no effect can be held responsible.");
    comparison.attribution->metrics.front().scatter = 199.0;
    EXPECT_EQ(sentence(comparison).find("scatter"), std::string::npos);
}

TEST(CompareAttributionText, AnInteractionLargerThanEveryTermForbidsToReadThem) {
    Comparison comparison = explained();
    MetricAttribution& peak = comparison.attribution->metrics.front();
    peak.terms[1].effect = 20;
    peak.interaction = 170;
    EXPECT_NE(sentence(comparison)
                  .find("their interaction, +170.0 N, is larger than any of them (Structure +20.0 N, "
                        "Added mass +20.0 N, Line drag -10.0 N), so that the terms cannot be read on "
                        "their own."),
              std::string::npos)
        << sentence(comparison);
}

TEST(CompareAttributionText, TheTableGoesFromTheCandidateToTheReference) {
    const Table table = attribution_table(explained());
    const std::vector<std::vector<Cell>> rows{{"rom", "4800.0"},          {"+ Structure", "+20.0"},
                                              {"+ Added mass", "+160.0"}, {"+ Line drag", "-10.0"},
                                              {"+ Interaction", "+30.0"}, {"full", "5000.0"}};
    EXPECT_EQ(table.rows, rows);
    EXPECT_EQ(table.columns[1].title, "Peak opening force");
    EXPECT_EQ(table.columns[1].unit, "N");
}

TEST(CompareAttributionText, ComesBackFromJson) {
    Comparison comparison = explained();
    comparison.attribution->metrics.front().scatter = 1.0 / 3.0;
    comparison.attribution->seeds = {1, 2};
    const std::string text = gap_json(comparison);
    comparison.attribution = read_attribution(text, "gap.json", comparison);
    ASSERT_TRUE(comparison.attribution);
    EXPECT_EQ(gap_json(comparison), text);
    Comparison none = synthetic_comparison();
    EXPECT_FALSE(read_attribution(gap_json(none), "gap.json", none));
}

// Metrics of one of several parachutes have its name and their unit, in gap.json, too.
TEST(CompareAttributionText, ExplainsAParachutesOwnMetrics) {
    Comparison comparison = synthetic_comparison();
    comparison.reference.add_metric("main_filling_time_s", 1.5);
    comparison.candidate.add_metric("main_filling_time_s", 1.25);
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, {});
    MetricAttribution time{"main_filling_time", 1.25, 1.5, {}, 0.125, {}};
    time.terms = {{"breathing", "Breathing", 0.125, ""}};
    comparison.attribution = Attribution{{time}, {}, {}};
    EXPECT_EQ(sentence(comparison),
              "main: Filling time: full is 0.2500 s (16.7 %) above rom. Largest terms: Breathing +0.1250 s; "
              "interaction +0.1250 s.");
    EXPECT_EQ(attribution_table(comparison).columns[1].title, "main: Filling time");
    EXPECT_EQ(attribution_table(comparison).columns[1].unit, "s");
    const std::string text = gap_json(comparison);
    EXPECT_EQ(nlohmann::json::parse(text)["attribution"]["metrics"]["main_filling_time_s"]["unit"], "s");
    comparison.attribution = read_attribution(text, "gap.json", comparison);
    ASSERT_EQ(comparison.attribution->metrics.size(), 1u);
    EXPECT_EQ(gap_json(comparison), text);
}

TEST(CompareAttributionText, EarlierVersionsCalledATermAPiece) {
    Comparison comparison = explained();
    const std::string text = gap_json(comparison);
    nlohmann::json gap = nlohmann::json::parse(text);
    for (auto& metric : gap["attribution"]["metrics"])
        for (auto& term : metric["terms"]) {
            term["piece"] = term["name"];
            term.erase("name");
        }
    comparison.attribution = read_attribution(gap.dump(), "gap.json", comparison);
    EXPECT_EQ(gap_json(comparison), text);
}

TEST(CompareAttributionText, AMetricOfALaterVersionIsLeftOut) {
    Comparison comparison = explained();
    nlohmann::json gap = nlohmann::json::parse(gap_json(comparison));
    gap["attribution"]["metrics"]["comfort_1"] = {{"later", true}};
    const auto read = read_attribution(gap.dump(), "gap.json", comparison);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->metrics.size(), 1u);
}

TEST(CompareAttributionText, ForeignTextIsHarmless) {
    Comparison comparison = explained();
    MetricAttribution& peak = comparison.attribution->metrics.front();
    peak.terms[1].title = peak.terms[1].detail = "|<script>\n# \x1b[31m";
    comparison.attribution->notes = {"|<script>\n# \x1b[31m"};
    const std::string markdown = report_markdown(comparison), terminal = terminal_text(comparison, {});
    EXPECT_EQ(markdown.find("<script>"), std::string::npos);
    EXPECT_EQ(markdown.find('\x1b'), std::string::npos);
    EXPECT_EQ(terminal.find('\x1b'), std::string::npos);
    EXPECT_EQ(markdown.find("\n# \x1b"), std::string::npos);
}

}  // namespace
}  // namespace twinchute::compare
