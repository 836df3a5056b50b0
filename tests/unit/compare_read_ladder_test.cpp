// A ladder read back from its file, and its part of the page.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "compare/ladder_beside.hpp"
#include "compare/report/html.hpp"
#include "compare/report/ladder_files.hpp"
#include "compare/report/read_ladder.hpp"
#include "lib/record/checksum.hpp"
#include "lib/record/record_error.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/explanations.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/support/synthetic_ladder.hpp"

namespace twinchute::compare {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> names{"rom", "full"};

/// With a test, failed levels, a level that was not run, a parachute of several, and names that mean
/// something to HTML.
Ladder ladder_of_everything() {
    int runs = 0;
    const RunOne fragile = [&](const Fidelity& fidelity, const Scene& scene) {
        RunRecord record = synthetic(fidelity, scene);
        record.events.push_back({"main.full-open", 2.0, 0.0, 0.0});
        record.add_metric("main_filling_time_s", 1.0 + 2.0 * scene.rom.rtol);
        if (++runs == 7) record.status = {StatusCode::strain_limit, "fabric <b>broke</b>"};
        if (fidelity.name == "full" && scene.full.time_step_factor < 0.3)
            record.status = {StatusCode::interrupted, ""};
        return record;
    };
    LadderOptions options;
    const MetricRow* peak = find_metric_row("peak_force");
    options.test = TestReference{"test.csv", {{peak, 4500.0}}};
    Scene scene = test::c9_scene();
    scene.name = "</script><b>\"C&9\"";
    scene.inputs = {{"payload.mass", 152.4, "kg", InputOrigin::given, ""},
                    {"rom.method", std::string("auto"), "", InputOrigin::fallback, ""}};
    return synthetic_ladder(options, scene, fragile);
}

std::string complaint(const std::string& text) {
    try {
        read_ladder(text, "d/ladder.json", names);
    } catch (const RecordError& error) {
        return error.what();
    }
    return "no complaint";
}

std::string complaint_with(const std::string& pointer, const ordered_json& value) {
    ordered_json json = ordered_json::parse(ladder_json(synthetic_ladder()));
    json[ordered_json::json_pointer(pointer)] = value;
    return complaint(json.dump());
}

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

TEST(CompareReadLadder, TakesRetiredWordsForFamilies) {
    const Ladder wrote = ladder_of_everything();
    const std::string now = ladder_json(wrote), word = "without an effect";
    std::string then = now;
    std::size_t found = 0;
    for (std::size_t at = 0; (at = then.find(word, at)) != then.npos; ++found)
        then.replace(at, word.size(), "without a piece");
    ASSERT_GT(found, 1u);
    EXPECT_EQ(ladder_svg(read_ladder(with_checksum(then), "d/ladder.json", names)), ladder_svg(wrote));
}

TEST(CompareReadLadder, SaysWhatWasWritten) {
    const Ladder wrote = ladder_of_everything();
    const Ladder read = read_ladder(with_checksum(ladder_json(wrote)), "d/ladder.json", names);
    EXPECT_EQ(ladder_svg(read), ladder_svg(wrote));
    EXPECT_EQ(levels_table(read).columns.size(), levels_table(wrote).columns.size() - 1);  // but for the test
    Ladder untested = wrote;
    untested.test.reset();
    EXPECT_EQ(levels_table(read).rows, levels_table(untested).rows);
    EXPECT_EQ(references_table(read, true).rows, references_table(wrote, true).rows);
    EXPECT_EQ(advice(read), advice(wrote));
    EXPECT_EQ(exit_code(read), exit_code(wrote));
    EXPECT_EQ(exit_code(read), ExitCode::interrupted);
    ASSERT_EQ(read.inputs.size(), 2u);
    EXPECT_EQ(std::get<double>(read.inputs[0].value), 152.4);
    EXPECT_EQ(read.judged, wrote.judged);
    EXPECT_EQ(read.judged.back(), "main_filling_time");
    EXPECT_EQ(read.quick, wrote.quick);
    EXPECT_EQ(read.threads, wrote.threads);
}

TEST(CompareReadLadder, WhatIsWrongIsRefusedWithTheKey) {
    EXPECT_TRUE(has(complaint("[]"), "d/ladder.json"));
    EXPECT_TRUE(has(complaint_with("/schema", 2), "schema: 2 is not known (this version reads 1)"));
    EXPECT_TRUE(has(complaint_with("/generator", "x"), "is not of a ladder of twinchute"));
    EXPECT_TRUE(
        has(complaint_with("/rungs/1/family", "x"), "rungs[1].family: 'x' is not a family of levels"));
    EXPECT_TRUE(has(complaint_with("/rungs/1/fidelity", "x"), "'x' is not a fidelity (known: rom, full)"));
    EXPECT_TRUE(
        has(complaint_with("/rungs/3/error/metric", "x"), "rungs[3].error.metric: 'x' is not a metric"));
    EXPECT_TRUE(has(complaint_with("/rungs/3/error/value", -1), "error.value: is negative"));
    EXPECT_TRUE(has(complaint_with("/rungs/1/as_given", 1), "is a number where true or false belongs"));
    EXPECT_TRUE(has(complaint_with("/rungs/1/status/code", "fine"), "status.code: 'fine' is not known"));
    EXPECT_TRUE(
        has(complaint_with("/references", ordered_json::object()), "names fewer than two fidelities"));
    EXPECT_TRUE(has(complaint_with("/judged/0", "x"), "judged[0]: 'x' is not a metric"));
    std::string edited = with_checksum(ladder_json(synthetic_ladder()));
    edited.replace(edited.find("rtol 1e-3"), 9, "rtol 1e-2");
    EXPECT_TRUE(has(complaint(edited), "d/ladder.json: is not the file that was written"))
        << complaint(edited);
    EXPECT_TRUE(has(complaint(edited), "run `twinchute ladder` again, or remove the file"));
}

/// Contents of a directory with this ladder, beside a record of that scene.
LadderBeside beside(const std::string& text, const RunRecord& record) {
    const ScratchDir scratch;
    scratch.write("ladder.json", text);
    return ladder_beside(scratch.path(), record, names);
}

RunRecord record_of(const Ladder& ladder) {
    RunRecord record;
    record.scene = ladder.scene;
    record.inputs = ladder.inputs;
    return record;
}

TEST(CompareReadLadder, OnlyOneOfTheSameSceneIsShown) {
    const Ladder ladder = ladder_of_everything();
    const std::string text = with_checksum(ladder_json(ladder));
    RunRecord record = record_of(ladder);
    EXPECT_TRUE(beside(text, record).ladder.has_value());
    // Keys that only a comparison asks for do not change the scene.
    record.inputs.push_back({"compare.tolerance.peak_force", std::string("5 %"), "", InputOrigin::given, ""});
    record.inputs.push_back({"full.fields_rate", 50.0, "1/s", InputOrigin::given, ""});
    EXPECT_TRUE(beside(text, record).ladder.has_value());
    EXPECT_FALSE(beside(text, record).ladder->levels.empty());

    record.inputs[0].value = 160.0;
    EXPECT_EQ(beside(text, record).why_not,
              "it is of the scene with other inputs (payload.mass is 152.4 kg there and 160 kg here)");
    EXPECT_FALSE(beside(text, record).ladder.has_value());
    record.inputs.erase(record.inputs.begin() + 1);
    EXPECT_TRUE(has(beside(text, record).why_not, "160 kg here, and 1 more of its inputs differ)"));
    record = record_of(ladder);
    record.scene.sha256 = "0123456789abcdef";
    EXPECT_TRUE(has(beside(text, record).why_not, "another scene file, or of an earlier state of it ("));

    Ladder old = ladder;
    old.inputs.clear();
    EXPECT_TRUE(has(beside(ladder_json(old), record_of(ladder)).why_not, "does not say its inputs"));
    const ScratchDir empty;
    const LadderBeside none = ladder_beside(empty.path(), record, names);
    EXPECT_FALSE(none.ladder.has_value());
    EXPECT_EQ(none.why_not + ladder_line(none, "d"), "");
}

TEST(CompareReadLadder, ThePageShowsItAndEscapesWhatItSays) {
    const Comparison comparison = synthetic_comparison();
    const std::string without = report_html(comparison);
    EXPECT_FALSE(has(without, "id=\"ladder\""));
    const std::string page = report_html(comparison, {ladder_of_everything(), {}});
    EXPECT_TRUE(has(page, "<section id=\"ladder\"><h2>Error against run time</h2>"));
    EXPECT_TRUE(has(page, "<a href=\"#ladder\">Error against run time</a>"));
    for (const LevelResult& result : ladder_of_everything().levels)
        EXPECT_TRUE(has(test::without_explanations(page), "<th scope=\"row\">" + result.level.name + "</th>"))
            << result.level.name;
    // The synthetic models differ by 5000 to 4000 N at their best.
    EXPECT_TRUE(has(page, "The gap between rom and full, each at its best, is 25 % (Peak opening force)"));
    EXPECT_TRUE(has(page, "&lt;/script&gt;&lt;b&gt;&quot;C&amp;9&quot;"));
    EXPECT_FALSE(has(page, "</script><b>"));
    const auto scripts = [](const std::string& text) {
        std::size_t count = 0;
        for (std::size_t at = 0; (at = text.find("<script", at)) != text.npos; ++at)
            ++count;
        return count;
    };
    EXPECT_EQ(scripts(page), scripts(without));
    const std::string refused = report_html(comparison, {{}, "it is of <i>another</i> scene"});
    EXPECT_TRUE(has(refused, "is not shown: it is of &lt;i&gt;another&lt;/i&gt; scene. Run"));
    EXPECT_FALSE(has(refused, "All levels"));
}

}  // namespace
}  // namespace twinchute::compare
