// The page that a comparison makes: what is in it, and what cannot break out of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/report/aligned.hpp"
#include "compare/report/glossary.hpp"
#include "compare/report/html.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/page_files.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/explanations.hpp"

namespace twinchute::compare {
namespace {

using nlohmann::json;

/// A tetrahedron of two frames that hangs on one line.
ShapeFrames small_shape() {
    ShapeFrames shape{5, 4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}, {{{0, 4}, ShapeCableKind::line}}, {}};
    for (const double time : {0.0, 1.5}) {
        const std::vector<double> place{0, 0, 9, 2 + time, 0, 7, -1, 2, 7, -1, -2, 7, 0, 0, 0};
        shape.frames.push_back(
            quantised(time, place, std::vector{10.0, 20.0, 30.0},
                      std::vector{FabricFolds::taut, FabricFolds::taut, FabricFolds::slack}));
    }
    return shape;
}

Comparison whole_comparison() {
    Comparison comparison = synthetic_comparison();
    comparison.reference_frames = small_shape();
    comparison.attribution =
        Attribution{{{"peak_force",
                      4800,
                      5000,
                      {{"added-mass", "Added mass", 250, ""}, {"shape", "Shape", -80, "its own"}},
                      30,
                      12.0}},
                    {1, 2, 3},
                    {"wind: the scene has none"}};
    return comparison;
}

/// The page without its scripts, style and explanations of words: what a reader sees.
std::string text_of(const std::string& page) {
    std::string text;
    std::size_t at = 0;
    for (;;) {
        const std::size_t script = page.find("<script", at), style = page.find("<style", at);
        const std::size_t begin = std::min(script, style);
        text += page.substr(at, begin - at);
        if (begin == page.npos) return test::without_explanations(text);
        const char* end = begin == script ? "</script>" : "</style>";
        at = page.find(end, begin) + std::char_traits<char>::length(end);
    }
}

std::size_t count(std::string_view text, std::string_view what) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += what.size())
        ++found;
    return found;
}

json data_of(const std::string& page) {
    const std::string before = "id=\"report-data\">";
    const std::size_t begin = page.find(before) + before.size();
    return json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(CompareHtml, HasAllPartsOnceEachInItsOrder) {
    const std::string text = text_of(report_html(whole_comparison()));
    std::size_t at = 0;
    for (const char* id : {"summary", "histories", "events", "why", "energy", "canopy-section", "left-out",
                           "warnings", "provenance", "words"}) {
        const std::string section = std::string("<section id=\"") + id + "\"";
        EXPECT_EQ(count(text, section), 1u) << id;
        EXPECT_EQ(count(text, std::string("href=\"#") + id + "\""),
                  id == std::string("warnings") || id == std::string("summary") ? 2u : 1u)
            << id;
        EXPECT_GT(text.find(section), at) << id;
        at = text.find(section);
    }
    EXPECT_EQ(count(text, "<h1>"), 1u);
    EXPECT_EQ(count(text, "<h2>"), 10u);
    EXPECT_EQ(count(text, "<main>"), 1u);
    // Every table says what it is, and every heading of a table of what.
    EXPECT_EQ(count(text, "<table"), count(text, "<caption"));
    EXPECT_EQ(count(text, "<th"), count(text, "<th scope=") + count(text, "<thead"));
    EXPECT_EQ(count(text, "<section"), count(text, "</section>"));
    EXPECT_EQ(count(text, "<div"), count(text, "</div>"));
}

TEST(Glossary, ExplainsTheLongestTermOfAName) {
    const std::string row = "<tr><th scope=\"row\">";
    const auto made = [&row](const std::string& name) {
        const std::string page = with_glossary(row + name + "</th></tr>");
        return page.substr(row.size(), page.find("</th>") - row.size());
    };
    // The terms of docs/glossary.md: "opening force" and "peak force" are there, "peak opening force" is not.
    const std::string force = made("Peak opening force");
    EXPECT_TRUE(force.starts_with("Peak <abbr title=\"")) << force;
    EXPECT_TRUE(force.ends_with("\">opening force</abbr>")) << force;
    EXPECT_TRUE(made("full-open").ends_with("\">full-open</abbr>"));
    EXPECT_EQ(made("A disguised canopyish thing"), "A disguised canopyish thing");  // whole words alone
    EXPECT_NE(made("two canopies, one canopy").find("<abbr"), std::string::npos);
    EXPECT_EQ(made("&lt;b&gt;"), "&lt;b&gt;");
    EXPECT_EQ(made(""), "");
    // "design" has a meaning in scenes and one in campaigns: which one, a name does not say.
    EXPECT_EQ(made("Design"), "Design");
    // Links and code in a meaning are words; the list has each term once.
    const std::string page =
        with_glossary(row + "Filling time</th></tr>" + row + "filling time</th></tr><h3>Attribution</h3>");
    EXPECT_EQ(count(page, "<dt>filling time</dt>"), 1u) << page;
    EXPECT_EQ(page.find("](") + 1, 0u) << page;
    EXPECT_NE(page.find("<h3><abbr title=\"Split of a gap"), std::string::npos) << page;
    EXPECT_EQ(with_glossary("<p>Filling time</p>"), "<p>Filling time</p>");  // names alone, no prose
}

TEST(CompareHtml, LeavesOutWhatIsNotThere) {
    Comparison comparison = synthetic_comparison();
    comparison.reference.warnings.clear();
    comparison.reference.energy.reset();
    comparison.candidate.energy.reset();
    const std::string page = report_html(comparison);
    for (const char* id : {"why", "energy", "canopy-section", "warnings"})
        EXPECT_EQ(page.find(std::string("id=\"") + id + "\""), page.npos) << id;
    EXPECT_EQ(page.find(page_file("three.min.js").substr(0, 200)), page.npos);  // no shape, no weight
    EXPECT_NE(page.find(page_file("dygraph.min.js").substr(0, 200)), page.npos);
}

TEST(RecordHtml, HasThePartsOfARunAlone) {
    RunRecord record = synthetic_record("full", 5000, 1.50, 12.0);
    record.warnings = {{"the mesh weighs 5.4 kg", "why", "check"}};
    record.left_out = {{"payload drag", "no payload.drag_area in the scene"}};
    record.estimates = {{"pflanz", "Pflanz", "peak_force_N", 2500, "a source", "too slow"}};
    record.missing = {{"drift_m", "the run stopped before the landing", true}};
    const std::string page = record_html(record, small_shape(), "full aeroelastic model", true);
    const std::string text = text_of(page);
    std::size_t at = 0;
    for (const char* id : {"summary", "histories", "events", "energy", "canopy-section", "left-out",
                           "warnings", "provenance"}) {
        const std::string section = std::string("<section id=\"") + id + "\"";
        EXPECT_EQ(count(text, section), 1u) << id;
        EXPECT_GT(text.find(section), at) << id;
        at = text.find(section);
    }
    EXPECT_EQ(count(text, "<h1>"), 1u);
    EXPECT_EQ(count(text, "<table"), count(text, "<caption"));
    EXPECT_EQ(count(text, "<div"), count(text, "</div>"));
    // Nothing of a comparison: no verdict, no difference, no other side. (The glossary has all words.)
    const std::string before = text.substr(0, text.find("<section id=\"words\""));
    for (const char* word :
         {"verdict-", "ifference", "both", "tolerance", "class=\"candidate", "side candidate"})
        EXPECT_EQ(before.find(word), text.npos) << word;
    EXPECT_NE(text.find("<h3>Peak opening force</h3>\n<p class=\"ratio\"><strong>5000 N</strong>"),
              text.npos);
    EXPECT_NE(text.find("1.500 s after snatch"), text.npos);
    EXPECT_NE(text.find(">50 %<"), text.npos);  // Pflanz: 2500 N of 5000 N
    EXPECT_NE(text.find("does not hold: too slow"), text.npos);
    EXPECT_NE(text.find("the run stopped before the landing"), text.npos);
    const json data = data_of(page);
    EXPECT_EQ(data["sides"], json({"full"}));
    EXPECT_EQ(data["styles"], json({"reference"}));
    for (const json& channel : data["channels"]) {
        ASSERT_EQ(channel["values"].size(), 1u);
        EXPECT_EQ(channel["values"][0].size(), data["clock"].size());
    }
    // The other model has the other colour.
    EXPECT_EQ(data_of(record_html(record, {}, "reduced-order model", false))["styles"], json({"candidate"}));
}

TEST(RecordHtml, SaysHowARunEnded) {
    RunRecord record = synthetic_record("rom", 5000, 1.50, 12.0);
    const auto banner = [&record](StatusCode code, const std::string& detail) {
        record.status = {code, detail};
        const std::string text = text_of(record_html(record, {}, "reduced-order model", false));
        const std::size_t at = text.find("<div class=\"verdict ");
        return text.substr(at, text.find("</div>", at) - at);
    };
    EXPECT_NE(banner(StatusCode::completed, "steady").find("verdict within"), std::string::npos);
    const std::string broken = banner(StatusCode::not_finite, "node <7> is lost");
    EXPECT_NE(broken.find("verdict broken"), std::string::npos) << broken;
    EXPECT_NE(broken.find("node &lt;7&gt; is lost"), std::string::npos) << broken;
    EXPECT_NE(banner(StatusCode::squids, "").find("verdict exceeded"), std::string::npos);
}

TEST(CompareHtml, SaysTheVerdictInWords) {
    const std::string within = text_of(report_html(synthetic_comparison()));
    EXPECT_NE(within.find("<strong>Within tolerance</strong>"), within.npos);
    // 5000 N over 4800 N, in per cent of 5000 N; of 10 % each, filling with 1.6 s over 1.55 s uses less.
    EXPECT_NE(within.find("Peak opening force: full is 200 N (4.0 %) above rom, tolerance 10 % (by default)"),
              within.npos);
    EXPECT_EQ(within.find("the one that counts"), within.npos);
    const std::string outside = text_of(report_html(synthetic_comparison({{"peak_force", {150, false}}})));
    EXPECT_NE(outside.find("<strong>Outside tolerance</strong>"), outside.npos);
    EXPECT_NE(outside.find("1 exceeded (peak_force)"), outside.npos);
    EXPECT_NE(outside.find("Peak opening force: full 5000 N, rom 4800 N: full is 200 N (4.0 %) above rom, "
                           "tolerance 150 N (of the scene)"),
              outside.npos);
    Comparison broken = synthetic_comparison();
    broken.reference.status = {StatusCode::not_finite, "node 7"};
    const std::string none = text_of(report_html(broken));
    EXPECT_NE(none.find("<strong>No verdict</strong>"), none.npos);
    EXPECT_NE(none.find("ended as <strong>not_finite</strong>: node 7"), none.npos);
}

TEST(CompareHtml, TheWayFromOneSideToTheOtherEndsThere) {
    const std::string text = text_of(report_html(whole_comparison()));
    for (const char* part : {"+250 N", "-80 N", "+30 N", ">4800 N", ">5000 N", "its own",
                             "scatter over seeds 12.0 N", "wind: the scene has none"})
        EXPECT_NE(text.find(part), text.npos) << part;
    // From 4800 to 5050, 4970 and 5000 N; the lowest and the highest of these lie at 4 and 96 % of the track.
    for (const char* place :
         {"left:4.00%;width:92.00%", "left:66.56%;width:29.44%", "left:66.56%;width:11.04%",
          "end candidate\" style=\"left:4.00%", "end reference\" style=\"left:77.60%"})
        EXPECT_NE(text.find(place), text.npos) << place;
    EXPECT_EQ(text.find("interaction larger"), text.npos);
    Comparison tangled = whole_comparison();
    tangled.attribution->metrics[0].interaction = -300;
    EXPECT_NE(text_of(report_html(tangled)).find("interaction larger than any effect"), text.npos);
}

TEST(CompareHtml, ForeignTextStaysText) {
    // Text that ends a script, a comment, a tag, an attribute; controls; bytes that are not UTF-8; and much
    // of it.
    const std::string hostile =
        "</script><script>alert(1)</script><!--\"'><img src=x onerror=alert(2)>&\u2028\x01\xff" +
        std::string(100'000, 'x');
    Comparison comparison = whole_comparison();
    for (RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        side->fidelity = side->scene.name = side->scene.file = side->scene.sha256 = hostile;
        side->status = {StatusCode::interrupted, hostile};
        side->events.push_back({hostile, 2, 0, 0});
        side->left_out.push_back({hostile, hostile});
        side->warnings.push_back({hostile, hostile, hostile});
        side->inputs.push_back({hostile, hostile, hostile, InputOrigin::given, hostile});
        side->inputs[1].source = hostile;
        side->cost.blocks.push_back({hostile, 1});
        Provenance& made = side->provenance;
        for (std::string* text : {&made.version, &made.commit, &made.compiler, &made.flags,
                                  &made.instruction_set, &made.host_cpu, &made.date})
            *text = hostile;
        for (Channel& channel : side->channels)
            if (channel.name != "time") channel.unit = hostile;
        for (Metric& metric : side->metrics)
            metric.note = hostile;
    }
    MetricAttribution& way = comparison.attribution->metrics[0];
    way.metric = way.terms[0].name = way.terms[0].title = way.terms[0].detail = hostile;
    comparison.attribution->notes = {hostile};
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, {});
    const std::string page = report_html(comparison), harmless = report_html(whole_comparison());
    for (const char* tag :
         {"<script", "</script", "<style", "</style", "<!--", "<img", "onerror=alert(2)>&\u2028"})
        EXPECT_EQ(count(page, tag), count(harmless, tag)) << tag;
    EXPECT_EQ(page.find('\x01'), page.npos);
    EXPECT_EQ(page.find('\xff'), page.npos);
    const json data = data_of(page);
    EXPECT_TRUE(data["sides"][0].get<std::string>().starts_with("</script><script>alert(1)"));
    EXPECT_LT(data["events"].back()["name"].get<std::string>().size(), 100'200u);
}

TEST(CompareHtml, AsksForNothingFromOutside) {
    const std::string page = report_html(whole_comparison());
    EXPECT_NE(page.find("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';"),
              page.npos);
    const std::string text = text_of(page);
    EXPECT_EQ(text.find("src="), text.npos);
    EXPECT_EQ(text.find("<link"), text.npos);
    constexpr std::string_view reference = "href=\"";
    int references = 0;
    for (auto at = text.find(reference); at != text.npos; at = text.find(reference, at + 1), ++references)
        EXPECT_EQ(text[at + reference.size()], '#') << text.substr(at, 80);
    EXPECT_GT(references, 0);
    // Addresses stand in the libraries as names of namespaces and of authors; here none fetches.
    for (const char* own : {"report.css", "shared.js", "clock.js", "charts.js", "frames.js", "canopy.js"})
        for (const char* way : {"http:", "https:", "url(", "@import", "fetch(", "XMLHttpRequest", "import("})
            EXPECT_EQ(page_file(own).find(way), std::string_view::npos) << own << " " << way;
    EXPECT_EQ(page.find("sourceMappingURL"), page.npos);
}

TEST(CompareHtml, TheSameComparisonIsTheSamePage) {
    EXPECT_EQ(report_html(whole_comparison()), report_html(whole_comparison()));
}

TEST(CompareHtml, ManyFramesAreThinnedToWhatAMailboxTakes) {
    Comparison comparison = synthetic_comparison();
    ShapeFrames& shape = comparison.reference_frames;
    shape = {2000, 0, std::vector<std::array<std::uint32_t, 3>>(4000, {0, 1, 2}), {}, {}};
    const std::vector<double> place(6000, 1.0), stress(4000, 1.0);
    for (int i = 0; i < 200; ++i)
        shape.frames.push_back(quantised(i, place, stress, std::vector(4000, FabricFolds::taut)));
    const ShapeFrames shown = page_frames(shape);
    EXPECT_GT(shown.frames.size(), 50u);
    EXPECT_TRUE(shown.frames.back() == shape.frames.back());
    // 3 MB is what the page of the demo may weigh.
    EXPECT_LT(report_html(comparison).size(), 3'000'000u);
}

TEST(CompareHtml, HistoriesLieAboveEachOtherFromSnatchOn) {
    // Two ramps, 1 + t and 1 + 2 t from their own snatch on, one of them 0.5 s later than the other.
    Comparison comparison = synthetic_comparison();
    for (RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        const bool reference = side == &comparison.reference;
        const double snatch = reference ? 0.5 : 0.0, slope = reference ? 2.0 : 1.0;
        side->events = {{"snatch", snatch, 0, 0}, {"full-open", snatch + 1, 0, 0}};
        side->channels = {{"time", "s", {}}, {"force", "N", {}}};
        for (int i = 0; i <= 400; ++i) {
            side->channels[0].values.push_back(0.01 * i + snatch);
            side->channels[1].values.push_back(1 + slope * 0.01 * i);
        }
    }
    comparison.candidate.channels[0].values.resize(301);  // ends at 3 s
    comparison.candidate.channels[1].values.resize(301);
    const AlignedHistories aligned = aligned_histories(page_sides(comparison));
    ASSERT_EQ(aligned.channels.size(), 1u);
    EXPECT_NEAR(aligned.opening_end, 2.0, 1e-12);  // twice the time of full open
    EXPECT_NEAR(aligned.clock.front(), 0, 1e-12);
    EXPECT_NEAR(aligned.clock.back(), 4, 1e-12);
    for (std::size_t i = 0; i < aligned.clock.size(); ++i) {
        const double t = aligned.clock[i];
        if (i > 0) {
            EXPECT_GT(t, aligned.clock[i - 1]);
        }
        EXPECT_NEAR(aligned.channels[0].value[1][i], 1 + 2 * t, 1e-9);
        if (t <= 3)
            EXPECT_NEAR(aligned.channels[0].value[0][i], 1 + t, 1e-9);
        else
            EXPECT_TRUE(std::isnan(aligned.channels[0].value[0][i])) << t;
    }
}

TEST(CompareHtml, FewRowsOfASmoothHistoryMakeNoDifference) {
    // One solution, 1 + cos t, in rows 0.01 s and 0.25 s apart. Straight lines between the latter would be
    // off by h^2/8, 0.0078; a smooth curve through them by less than a third of that; its ends need
    // it.
    Comparison comparison = synthetic_comparison();
    for (RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        const double h = side == &comparison.reference ? 0.01 : 0.25;
        side->events = {{"snatch", 0.0, 0, 0}, {"full-open", 1.0, 0, 0}};
        side->channels = {{"time", "s", {}}, {"speed", "m/s", {}}};
        for (int i = 0; i * h <= 4.0 + 1e-9; ++i) {
            side->channels[0].values.push_back(i * h);
            side->channels[1].values.push_back(1.0 + std::cos(i * h));
        }
    }
    const AlignedHistories aligned = aligned_histories(page_sides(comparison));
    double largest = 0.0;
    for (std::size_t i = 0; i < aligned.clock.size(); ++i)
        largest =
            std::max(largest, std::abs(aligned.channels[0].value[0][i] - aligned.channels[0].value[1][i]));
    EXPECT_LT(largest, 0.25 * 0.25 / 8.0 / 3.0);
    // Both sides' rows are instants of the clock, so that no value of the finer one is lost.
    for (const RunRecord* side : {&comparison.reference, &comparison.candidate})
        for (const double t : side->channels[0].values)
            EXPECT_TRUE(std::ranges::binary_search(aligned.clock, t)) << t;
}

/// Forces of a lock-up: the lines pull up to 24 kN, and from one row to the next of the same time a tenth of
/// that, on one side alone.
Comparison with_a_jump() {
    Comparison comparison = synthetic_comparison();
    for (RunRecord* side : {&comparison.reference, &comparison.candidate}) {
        side->events = {{"snatch", 0.0, 0, 0}, {"full-open", 1.0, 0, 0}};
        side->channels = {{"time", "s", {}}, {"force", "N", {}}, {"speed", "m/s", {}}};
        const auto row = [&](double t, double force) {
            side->channels[0].values.push_back(t);
            side->channels[1].values.push_back(force);
            side->channels[2].values.push_back(20.0 - t);
        };
        const bool jumps = side == &comparison.candidate;
        for (int i = 0; i <= 300; ++i) {
            // Steps of 10 ms, coarser than the page's clock; -0.5 s to 2.5 s.
            const double t = 0.01 * (i - 50);
            row(t, jumps && t <= 0.0 ? 24000.0 + 1000.0 * t : 2000.0 + 100.0 * t);
            if (jumps && t == 0.0) row(t, 2000.0);
        }
    }
    return comparison;
}

TEST(CompareHtml, AJumpIsAStepUpright) {
    const AlignedHistories aligned = aligned_histories(page_sides(with_a_jump()));
    const auto& clock = aligned.clock;
    const auto at = std::ranges::find(clock, 0.0) - clock.begin();
    ASSERT_LT(at + 1, std::ssize(clock));
    ASSERT_EQ(std::ranges::count(clock, 0.0), 2);
    EXPECT_TRUE(std::ranges::is_sorted(clock));
    const std::vector<double>&candidate = aligned.channels[0].value[0],
          &reference = aligned.channels[0].value[1], &speed = aligned.channels[1].value[0];
    for (std::size_t i = 0; i < clock.size(); ++i) {
        const double t = clock[i];
        const bool before = t < 0.0 || i == static_cast<std::size_t>(at);
        // Straight lines, sampled: to rounding. Anything drawn across the jump would be off by thousands.
        EXPECT_NEAR(candidate[i], before ? 24000.0 + 1000.0 * t : 2000.0 + 100.0 * t, 1e-8) << t;
        EXPECT_NEAR(reference[i], 2000.0 + 100.0 * t, 1e-8) << t;
        EXPECT_NEAR(speed[i], 20.0 - t, 1e-12) << t;
    }
    // Data that scripts draw: both values at one instant, and no other instant occurs twice.
    const json data = data_of(report_html(with_a_jump()));
    const auto& values = data["channels"][0]["values"][0];
    EXPECT_EQ(values[static_cast<std::size_t>(at)], 24000.0);
    EXPECT_EQ(values[static_cast<std::size_t>(at) + 1], 2000.0);
    for (std::size_t i = 1; i < clock.size(); ++i)
        if (i != static_cast<std::size_t>(at) + 1) {
            EXPECT_GT(clock[i], clock[i - 1]);
        }
}

TEST(CompareHtml, NoPeakIsCut) {
    // A spike of a single row, far narrower than the coarse clock.
    Comparison comparison = synthetic_comparison();
    comparison.reference.channels[1].values[5555] = 1e5;
    const json data = data_of(report_html(comparison));
    double most = 0;
    for (const json& value : data["channels"][0]["values"][1])
        if (value.is_number()) most = std::max(most, value.get<double>());
    EXPECT_EQ(most, 1e5);
}

}  // namespace
}  // namespace twinchute::compare
