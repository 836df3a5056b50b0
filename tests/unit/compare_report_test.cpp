// Output of a comparison: files and text.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "compare/render/escape.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "compare/report/junit.hpp"
#include "compare/report/markdown.hpp"
#include "compare/report/plots.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/words.hpp"
#include "compare/report/write_report.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::compare {
namespace {

using nlohmann::json;

// Everything that can break out of a format: XML, Markdown table, HTML in Markdown, a terminal.
constexpr const char* hostile = "]]></x>\"'&|<script>*_`[a](b)\n# \x1b[31m\xff";

Comparison hostile_comparison() {
    Comparison comparison = synthetic_comparison({{"peak_force", {0.01, true}}});
    for (RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        side->scene.name = hostile;
        side->scene.file = hostile;
        side->events.push_back({hostile, 2, 0, 0});
        side->left_out.push_back({hostile, hostile});
        side->warnings.push_back({hostile, hostile, hostile});
        side->status.detail = hostile;
        side->provenance.host_cpu = hostile;
        side->inputs.push_back({hostile, std::string(hostile), hostile, InputOrigin::given, hostile});
        side->inputs[1].source = hostile;
    }
    return comparison;
}

/// No '<', no control character, and every '&' starts one of the entities that we write.
bool is_character_data(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (text[i] == '<' || (byte < 0x20 && text[i] != '\n')) return false;
        if (text[i] != '&') continue;
        const std::string_view rest = text.substr(i);
        if (std::ranges::none_of(std::array{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"},
                                 [&](std::string_view entity) { return rest.starts_with(entity); }))
            return false;
    }
    return true;
}

/// Attributes are name="value"; what is between the quotes is character data.
bool are_attributes(std::string_view text) {
    while (!text.empty()) {
        const auto equals = text.find("=\"");
        const auto end = equals == text.npos ? text.npos : text.find('"', equals + 2);
        if (end == text.npos || text[0] != ' ' ||
            text.substr(1, equals - 1).find_first_of(" \"'") != text.npos ||
            !is_character_data(text.substr(equals + 2, end - equals - 2)))
            return false;
        text.remove_prefix(end + 1);
    }
    return true;
}

/// Tags balance and everything in and between them is escaped: enough of XML for what we write.
bool well_formed(std::string_view xml) {
    std::vector<std::string_view> open;
    if (xml.starts_with("<?xml ")) xml.remove_prefix(xml.find("?>") + 2);
    while (!xml.empty()) {
        const auto begin = std::min(xml.find('<'), xml.size());
        if (!is_character_data(xml.substr(0, begin))) return false;
        if (begin == xml.size()) break;
        const auto end = xml.find('>', begin);
        if (end == xml.npos) return false;
        std::string_view tag = xml.substr(begin + 1, end - begin - 1);
        xml.remove_prefix(end + 1);
        const bool closing = tag.starts_with('/'), empty = tag.ends_with('/');
        tag = tag.substr(closing ? 1 : 0, tag.size() - (closing || empty ? 1 : 0));
        const std::string_view name = tag.substr(0, std::min(tag.find(' '), tag.size()));
        if (name.empty() || !are_attributes(tag.substr(name.size()))) return false;
        if (closing) {
            if (open.empty() || open.back() != name) return false;
            open.pop_back();
        } else if (!empty) {
            open.push_back(name);
        }
    }
    return open.empty();
}

TEST(CompareEscape, TheCheckItselfFindsBrokenXml) {
    EXPECT_TRUE(well_formed("<a b=\"1\"><c/>x &amp; y</a>"));
    EXPECT_FALSE(well_formed("<a><b></a></b>"));
    EXPECT_FALSE(well_formed("<a>x & y</a>"));
    EXPECT_FALSE(well_formed("<a>x < y</a>"));
    EXPECT_FALSE(well_formed("<a b=\"<\"/>"));
    EXPECT_FALSE(well_formed("<a>\x1b</a>"));
    EXPECT_FALSE(well_formed("<a b=\"1\"2\"/>"));
    EXPECT_FALSE(well_formed("<a b=1/>"));
    EXPECT_FALSE(well_formed("<a>"));
}

TEST(CompareEscape, TextIsHarmlessInEachFormat) {
    EXPECT_EQ(xml_text("<a b=\"c\" d='e'>&"), "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;");
    EXPECT_EQ(markdown_text("a|b*c_d`e<f>\n# g"), "a\\|b\\*c\\_d\\`e&lt;f&gt; \\# g");
    EXPECT_EQ(clean_text("a\x01\xff\xc0\xaf"), "a\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
    EXPECT_EQ(clean_text("\xEF\xBF\xBF"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // U+FFFF is not XML
    EXPECT_EQ(clean_text("\xC3\xA9\xF0\x9F\xAA\x82"), "\xC3\xA9\xF0\x9F\xAA\x82");  // valid UTF-8 stays
}

TEST(CompareReport, GapJsonHasTheKeysOfTheContract) {
    const json gap = json::parse(gap_json(synthetic_comparison({{"peak_force", {150, false}}})));
    EXPECT_EQ(gap["generator"], "twinchute");
    EXPECT_EQ(gap["verdict"], "exceeded");
    EXPECT_EQ(gap["exit_code"], 1);
    const json& peak = gap["metrics"]["peak_force_N"];
    EXPECT_EQ(peak["reference"], 5000.0);
    EXPECT_EQ(peak["candidate"], 4800.0);
    EXPECT_EQ(peak["difference"], -200.0);
    EXPECT_EQ(peak["relative"], -0.04);
    EXPECT_EQ(peak["tolerance"], (json{{"value", 150.0}, {"relative", false}, {"from", "scene"}}));
    EXPECT_EQ(peak["verdict"], "exceeded");
    EXPECT_EQ(gap["metrics"]["snatch_speed_m_s"]["input_or_result"],
              (json{{"reference", "input"}, {"candidate", "input"}}));
    EXPECT_FALSE(gap["metrics"]["snatch_speed_m_s"].contains("tolerance"));
    const json& history = gap["histories"]["force_history"];
    EXPECT_EQ(history["channel"], "force");
    EXPECT_EQ(history["verdict"], "not judged");
    // Full open of the reference is at 1.6 s, both records last 6 s, the peak is 200 N lower.
    EXPECT_EQ(history["inflation"]["to_s"], 1.6);
    EXPECT_EQ(history["descent"]["to_s"], 6.0);
    EXPECT_NEAR(history["inflation"]["relative_maximum"], -0.04, 1e-3);  // of points 1 ms apart
    EXPECT_FALSE(history.contains("deployment"));
    EXPECT_EQ(gap["cost"]["reference"]["wall_s"], 12.0);
    EXPECT_EQ(gap["cost"]["ratio"].get<double>(), 12.0 / 4e-4);
    EXPECT_EQ(gap["reference"]["fidelity"], "full");
    EXPECT_EQ(gap["candidate"]["fidelity"], "rom");
}

TEST(CompareReport, JunitHasACaseForEachRunMetricAndHistory) {
    const std::string xml = junit_xml(synthetic_comparison({{"peak_force", {150, false}}}));
    EXPECT_TRUE(well_formed(xml)) << xml;
    // Two runs; filling time, peak force and descent rate; snatch speed, time to peak force and the histories
    // of force and speed, for which nobody asked for a tolerance.
    EXPECT_NE(xml.find("tests=\"9\" failures=\"1\" errors=\"0\" skipped=\"4\""), std::string::npos) << xml;
    EXPECT_NE(xml.find("<failure type=\"exceeded\" message=\"Peak opening force: full 5000 N, rom 4800 N"),
              std::string::npos);
    EXPECT_NE(
        xml.find(
            "name=\"snatch_speed\" time=\"0.000000\">\n      <skipped message=\"no tolerance asked for\"/>"),
        std::string::npos);
}

TEST(CompareReport, JunitIsRedWhenARunFailed) {
    Comparison comparison = synthetic_comparison();
    comparison.reference.status = {StatusCode::energy_grew, "at 1 s"};
    EXPECT_NE(junit_xml(comparison).find("<error type=\"energy_grew\" message=\"at 1 s\">"),
              std::string::npos);
}

TEST(CompareReport, JunitIsRedWhenABaselineIsNotHeld) {
    Comparison now = synthetic_comparison();
    now.reference.add_metric("peak_force_N", 5100);
    now.candidate.add_metric("descent_rate_m_s", 7.7 * (1 + 1e-5));
    now.gap = measure_gap(now.reference, now.candidate, {});
    const Trend trend = measure_trend(synthetic_comparison(), now, {});
    ASSERT_EQ(overall_verdict(trend), Verdict::exceeded);
    const std::string alone = junit_xml(now), xml = junit_xml(now, &trend);
    EXPECT_NE(alone.find(" failures=\"0\""), std::string::npos) << alone;
    EXPECT_TRUE(well_formed(xml)) << xml;
    // The baseline as a whole and the metric that moved by 2 %, not the one that moved within its tolerance.
    EXPECT_NE(xml.find("tests=\"12\" failures=\"2\" errors=\"0\" skipped=\"4\""), std::string::npos) << xml;
    EXPECT_NE(xml.find("name=\"baseline full peak_force\""), std::string::npos) << xml;
    EXPECT_NE(
        xml.find("<failure type=\"exceeded\" message=\"peak_force of full: baseline 5000 N, now 5100 N, "
                 "change +2 %, tolerance 0.1 %\">"),
        std::string::npos)
        << xml;
}

TEST(CompareReport, JunitTellsWhatWasNotReachedAndWhatNeverOpened) {
    Comparison comparison = synthetic_comparison();
    std::erase_if(comparison.candidate.metrics, [](const Metric& m) { return m.key == "descent_rate_m_s"; });
    comparison.candidate.missing.push_back({"descent_rate_m_s", "the run stopped before", true});
    comparison.candidate.status = {StatusCode::not_opened, "main never opened"};
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, {});
    const std::string xml = junit_xml(comparison);
    EXPECT_NE(xml.find("<skipped message=\"not reached: only full has it, rom: the run stopped before\"/>"),
              std::string::npos)
        << xml;
    EXPECT_NE(xml.find("<failure type=\"not_opened\" message=\"main never opened\">"), std::string::npos)
        << xml;
    EXPECT_NE(report_markdown(comparison).find("not opened in rom: main never opened"), std::string::npos);
    EXPECT_NE(report_html(comparison).find("A parachute never opened"), std::string::npos);
    EXPECT_EQ(json::parse(gap_json(comparison))["verdict"], "exceeded");
    EXPECT_EQ(json::parse(gap_json(comparison))["exit_code"], 1);
}

TEST(CompareReport, HostileNamesBreakNothing) {
    const Comparison comparison = hostile_comparison();
    for (const std::string& xml :
         {junit_xml(comparison), force_svg(page_sides(comparison)), speed_svg(page_sides(comparison))}) {
        EXPECT_TRUE(well_formed(xml)) << xml;
    }
    EXPECT_TRUE(json::accept(gap_json(comparison)));
    const std::string markdown = report_markdown(comparison);
    EXPECT_EQ(markdown.find("<script>"), std::string::npos);
    EXPECT_EQ(markdown.find("[a](b)"), std::string::npos);
    EXPECT_EQ(markdown.find('\x1b'), std::string::npos);
    EXPECT_EQ(terminal_text(comparison, {}).find('\x1b'), std::string::npos);
}

TEST(CompareReport, MarkdownTablesHaveAsManyCellsInEachRow) {
    std::istringstream lines(report_markdown(hostile_comparison()));
    std::ptrdiff_t cells = 0;
    int rows = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with('|')) {
            cells = 0;
            continue;
        }
        std::ptrdiff_t bars = 0;  // those that are not escaped
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (line[i] == '\\') {
                ++i;
            } else if (line[i] == '|') {
                ++bars;
            }
        }
        if (cells == 0) cells = bars;
        EXPECT_EQ(bars, cells) << line;
        ++rows;
    }
    EXPECT_GT(rows, 15);  // three tables with heads
}

TEST(CompareReport, TheVerdictComesFirst) {
    const std::string markdown = report_markdown(synthetic_comparison());
    const auto verdict = markdown.find("**within tolerance: 3 of 3 judged metrics**");
    ASSERT_NE(verdict, std::string::npos) << markdown;
    EXPECT_LT(verdict, markdown.find("## "));
}

TEST(CompareReport, TheTerminalTableSaysEverythingOfAMetric) {
    const std::string text = terminal_text(synthetic_comparison(), {});
    std::istringstream line(text.substr(text.find("Peak opening force")));
    std::string words, word;
    while (line.peek() != '\n' && line >> word)
        words += word + ' ';
    EXPECT_EQ(words, "Peak opening force 4800 N 5000 N +200 N (+4.0 %) 10 % within result result ");
    EXPECT_NE(text.find("Differences are full minus rom; per cents are shares of full."), std::string::npos);
    EXPECT_NE(text.find("fill constant n = 4 (given: an assumption)"), std::string::npos);
    EXPECT_NE(text.find("ratio 30000"), std::string::npos);
    EXPECT_NE(text.find("left out  full: payload drag"), std::string::npos);
}

TEST(CompareWords, SmallDifferencesKeepTwoDigits) {
    // Four digits of 7.7 end after the third place; two of the difference may lie further on.
    EXPECT_EQ(signed_text(-0.157, 1.6), "-0.157");
    EXPECT_EQ(signed_text(-0.00032, 7.72), "-0.00032");
    EXPECT_EQ(signed_text(0.000996, 7.72), "+0.0010");  // rounded up into the third place
    EXPECT_EQ(signed_text(134.2, 5207.0), "+134");
    EXPECT_EQ(signed_text(7e-9, 7.72), "0");  // rounding, 1e-9 of what it comes from
    EXPECT_EQ(signed_text(0.0, 0.0), "0");
    EXPECT_EQ(signed_text(1e-7, 0.0), "+0.00000010");  // beside nothing no difference is small
    EXPECT_EQ(share_text(-0.0259, true), "-2.6 %");
    EXPECT_EQ(share_text(0.000041, true), "+0.0041 %");
    EXPECT_EQ(share_text(0.0000998, false), "0.010 %");
    EXPECT_EQ(share_text(1e-10, true), "0 %");
}

TEST(CompareWords, LargestGapsWithoutAToleranceAreFoundOnce) {
    Comparison c = synthetic_comparison();
    const auto both = [&](const char* key, double candidate, double reference) {
        c.candidate.add_metric(key, candidate);
        c.reference.add_metric(key, reference);
    };
    both("snatch_force_N", 900.0, 1000.0);    // 10 %
    both("max_deceleration_g", 3.9, 3.0);     // 30 %
    both("peak_force_ratio", 0.96, 1.0);      // 4 % as the peak force, which is judged
    both("max_line_tension_N", 99.5, 100.0);  // 0.5 %: not worth it
    both("landing_north_m", 0.1, 1e-3);       // a hundred times nearly nothing
    c.gap = measure_gap(c.reference, c.candidate, {});
    std::vector<std::string_view> names;
    for (const MetricGap* metric : largest_unjudged(c.gap, 2))
        names.push_back(metric->row->name);
    EXPECT_EQ(names, (std::vector<std::string_view>{"max_deceleration", "snatch_force"}));
    for (const MetricGap* metric : largest_unjudged(c.gap, 100)) {
        EXPECT_NE(metric->row->name, "peak_force_ratio");
        EXPECT_NE(metric->row->name, "max_line_tension");
        EXPECT_NE(metric->row->name, "landing_north");
    }
    const std::string page = report_html(c), text = terminal_text(c, {});
    EXPECT_NE(text.find("unjudged  Maximum deceleration: full is 0.900 g (30.0 %) below rom"), text.npos)
        << text;
    EXPECT_NE(page.find("<strong>Maximum deceleration</strong>: full is 0.900 g (30.0 %) below rom"),
              page.npos);
}

TEST(CompareReport, WritesTheFilesOfTheContract) {
    const ScratchDir scratch;
    write_report(synthetic_comparison(), scratch / "out");
    std::set<std::string> expected{"force.svg", "speed.svg", "report.html", "report.md",
                                   "junit.xml", "gap.json",  "rom",         "full"};
    for (const std::string side : {"rom", "full"}) {
        for (const std::string file : {"/history.csv", "/events.csv", "/summary.json"})
            expected.insert(side + file);
    }
    EXPECT_EQ(tree_of(scratch / "out"), expected);
}

}  // namespace
}  // namespace twinchute::compare
