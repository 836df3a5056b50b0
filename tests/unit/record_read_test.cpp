// Records read back: the same bits, or a complaint that says where.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <clocale>
#include <limits>
#include <locale>
#include <nlohmann/json.hpp>

#include "lib/record/read_record.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/same_record.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

using nlohmann::ordered_json;
using test::record_difference;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

RunRecord read_back(const RunRecord& record) {
    return read_record_text(summary_json(record), history_csv(record), events_csv(record));
}

RunRecord record_to_read() {
    RunRecord record = compare::synthetic_record("rom", 4800, 1.45, 4e-4);
    for (Channel& channel : record.channels)
        channel.values.resize(3);
    return record;
}

/// Numbers at the ends of what a double holds, and what a decimal text gets wrong first.
const std::vector<double> hard{0.0,
                               -0.0,
                               0.1 + 0.2,
                               1.0 / 3,
                               -1e22,
                               9007199254740993.0,
                               123456789012345680.0,
                               5e-324,
                               -2.2250738585072011e-308,
                               2.2250738585072014e-308,
                               1.7976931348623157e308,
                               8.41e-21,
                               5.0e-20,
                               9.5367431640625e-7};

TEST(RecordRead, ASyntheticRecordComesBackToTheLastBit) {
    RunRecord record = compare::synthetic_comparison().reference;
    record.cost.blocks = {{"membrane", 0.1 + 0.2}, {"a \"quoted\", name\n", 0}};
    record.cost.resumed_at = {0.1, 1e-300};
    record.missing = {{"descent_rate_m_s", "the run \"stopped\" before", true}, {"x", "", false}};
    record.handed_over = HandOver{"rom", 1.0 / 3.0, {"flight_time_s", "landing_east_m"}};
    record.filling = PredictedFilling{"predicted",
                                      0.005,
                                      2.0,
                                      1.0 / 3,
                                      {{0.002, "squids", {}, {}, 5e-324}, {0.04, "completed", 0.1, 0.3, {}}}};
    record.inputs.push_back(
        {"a \"key\"", std::string("line\nbreak \x01 \xC3\xA9"), "", InputOrigin::design, ""});
    record.add_metric("impulse_N_s", 1.0 / 3, MetricKind::mixed, "n is an input");
    record.add_metric("load_factor", -0.0, MetricKind::input);
    record.channels.push_back({"a, \"b\"\r\n", "m/s,\n", std::vector<double>(6001, not_a_number)});
    record.channels.push_back({"share", "", std::vector<double>(6001, 1e-3)});
    record.events.push_back({"full, open \"main\"\r", 1.5, not_a_number, 18});
    record.events.push_back({"", 1.5, 1, -0.0});
    EXPECT_EQ(record_difference(record, read_back(record)), "");
}

TEST(RecordRead, HardNumbersComeBackToTheLastBit) {
    RunRecord record = record_to_read();
    record.channels = {{"x", "m", hard}};
    for (std::size_t i = 0; i < hard.size(); ++i) {
        record.add_metric("metric_" + std::to_string(i), hard[i]);
        record.inputs.push_back({"key_" + std::to_string(i), hard[i], "", InputOrigin::given, ""});
        record.cost.blocks.push_back({"block_" + std::to_string(i), hard[i]});
        record.events.push_back({"event", hard[i], hard[i], hard[i]});
    }
    record.cost.steps = record.cost.element_steps = std::numeric_limits<std::int64_t>::max();
    EXPECT_EQ(record_difference(record, read_back(record)), "");
}

TEST(RecordRead, EveryStatusComesBack) {
    RunRecord record = record_to_read();
    for (int code = 0; code <= static_cast<int>(StatusCode::time_limit); ++code) {
        record.status.code = static_cast<StatusCode>(code);
        EXPECT_EQ(record_difference(record, read_back(record)), "") << code;
    }
}

TEST(RecordRead, NothingButTheNamesOfColumnsIsARecordToo) {
    RunRecord record;
    EXPECT_EQ(record_difference(record, read_back(record)), "");
    record.channels = {{"time", "s", {}}};
    EXPECT_EQ(record_difference(record, read_back(record)), "");
    record.channels = {{"time", "s", {1, not_a_number, 2, not_a_number}}};  // empty lines
    EXPECT_EQ(record_difference(record, read_back(record)), "");
}

TEST(RecordRead, WhatCannotBeWrittenComesBackAsWritten) {
    RunRecord record = record_to_read();
    record.add_metric("impulse_N_s", not_a_number);
    record.add_metric("load_factor", 3);
    record.add_metric("max_force_N", infinite);
    record.energy = EnergyLedger{infinite, 1, not_a_number, infinite, 1, not_a_number, -infinite};
    record.cost.dt_max_s = infinite;
    record.cost.element_steps = 7;
    record.cost.ns_per_element_step = infinite;
    record.cost.blocks = {{"membrane", not_a_number}, {"cable", 1}};
    record.inputs.push_back({"stop.time", infinite, "s", InputOrigin::given, ""});
    record.scene.file = "not utf-8 \xff \xE2\x82.toml";
    record.channels[1].values[0] = -infinite;
    record.events[0].speed = infinite;
    const RunRecord written = as_written(record);
    EXPECT_EQ(record_difference(written, read_back(record)), "");
    EXPECT_EQ(record_difference(written, as_written(written)), "");
    EXPECT_EQ(summary_json(written), summary_json(record));
    EXPECT_FALSE(written.metric("impulse_N_s"));
    EXPECT_EQ(written.metric("load_factor"), 3);
    EXPECT_EQ(written.warnings.size(), 2u);
}

TEST(RecordRead, RunsOfBothModelsComeBackToTheLastBit) {
    const std::string file = TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml";
    const Scene scene =
        read_scene(file, {"full.mesh.gore_columns=1", "full.mesh.gore_rows=4", "full.mesh.line_elements=4",
                          "stop.time=0.25", "compare.tolerance.peak_force=7.5 %"});
    const ScratchDir scratch;
    for (const RunRecord& record : {test::run_rom(scene), test::run_full(scene)}) {
        write_record(record, scratch / record.fidelity);
        const RunRecord again = read_record(scratch / record.fidelity);
        EXPECT_EQ(record_difference(record, again), "");
        EXPECT_GT(again.channels.front().values.size(), 2u);
        EXPECT_EQ(std::get<std::string>(again.find_input("compare.tolerance.peak_force")->value), "7.5 %");
    }
}

TEST(RecordRead, TheLocaleChangesNothing) {
    struct Comma : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    const RunRecord record = compare::synthetic_record("rom", 4800.5, 1.45, 4e-4);
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})  // where there is one
        if (std::setlocale(LC_ALL, name) != nullptr) break;
    const std::string difference = record_difference(record, read_back(record));
    std::setlocale(LC_ALL, "C");
    std::locale::global(before);
    EXPECT_EQ(difference, "");
}

/// Complaint of a reader about a changed record.
std::string complaint(const std::string& summary, const std::string& history, const std::string& events) {
    try {
        read_record_text(summary, history, events, "d");
    } catch (const RecordError& error) {
        return error.what();
    }
    return "no complaint";
}

std::string complaint_of_summary(const std::string& summary) {
    return complaint(summary, history_csv(record_to_read()), events_csv(record_to_read()));
}
std::string complaint_of_history(const std::string& history) {
    return complaint(summary_json(record_to_read()), history, events_csv(record_to_read()));
}
std::string complaint_of_events(const std::string& events) {
    return complaint(summary_json(record_to_read()), history_csv(record_to_read()), events);
}

/// The complaint about a summary in which the value at a pointer is another one.
std::string complaint_with(const std::string& pointer, const ordered_json& value) {
    ordered_json json = ordered_json::parse(summary_json(record_to_read()));
    json[ordered_json::json_pointer(pointer)] = value;
    return complaint_of_summary(json.dump());
}
std::string complaint_without(const std::string& parent, const std::string& key) {
    ordered_json json = ordered_json::parse(summary_json(record_to_read()));
    json[ordered_json::json_pointer(parent)].erase(key);
    return complaint_of_summary(json.dump());
}

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

TEST(RecordRead, KeysAndColumnsOfLaterVersionsAreSkipped) {
    ordered_json json = ordered_json::parse(summary_json(record_to_read()));
    const std::vector<std::string> objects{"",        "/scene", "/inputs/payload.mass",   "/status",
                                           "/energy", "/cost",  "/standing/peak_force_N", "/provenance"};
    for (const std::string& object : objects)
        json[ordered_json::json_pointer(object + "/later")] = {{"a", {1, nullptr, "b"}}};
    json["left_out"].push_back({{"what", "a"}, {"why", "b"}, {"later", true}});
    json["standing"]["of_no_metric"] = 1;
    RunRecord wanted = record_to_read();
    wanted.left_out.push_back({"a", "b"});
    wanted.events = {{"snatch", 1, 2, 3}};
    const RunRecord read =
        read_record_text(json.dump(), history_csv(wanted),
                         "later,speed,name,altitude,time\nwords,m/s,-,m,s\n\"x,y\",3,snatch,2,1\n");
    EXPECT_EQ(record_difference(wanted, read), "");
}

TEST(RecordRead, LinesMayEndAsOnOtherSystems) {
    RunRecord wanted = record_to_read();
    std::string history, events;
    for (const char c : history_csv(wanted))
        history += c == '\n' ? std::string("\r\n") : std::string(1, c);
    for (const char c : events_csv(wanted))
        events += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(record_difference(wanted, read_record_text(summary_json(wanted), history, events)), "");
}

TEST(RecordRead, ABrokenSummaryIsRefusedWithTheKey) {
    EXPECT_EQ(complaint_with("/schema", 2).substr(0, 41), "d/summary.json: schema: 2 is not known (t");
    EXPECT_TRUE(has(complaint_with("/schema", "1"), "schema: is text where a whole number belongs"));
    EXPECT_TRUE(has(complaint_with("/schema", 1.0), "schema: is a number where a whole number"));
    EXPECT_TRUE(has(complaint_with("/generator", "other"), "is not of a record of twinchute"));
    EXPECT_TRUE(
        has(complaint_with("/status/code", "fine"), "status.code: 'fine' is not known (known: completed"));
    EXPECT_TRUE(has(complaint_with("/status/code", "unknown"), "is not known"));
    EXPECT_TRUE(
        has(complaint_with("/metrics/peak_force_N", "5"), "metrics.peak_force_N: is text where a number"));
    EXPECT_TRUE(has(complaint_with("/metrics/peak_force_N", nullptr), "is null where a number"));
    EXPECT_TRUE(has(complaint_with("/metrics/new_metric", 1), "standing: the key 'new_metric' is missing"));
    EXPECT_TRUE(
        has(complaint_with("/standing/peak_force_N/input_or_result", "guess"), "'guess' is not known"));
    EXPECT_TRUE(has(complaint_with("/inputs/payload.mass/origin", "heaven"), "'heaven' is not known"));
    EXPECT_TRUE(has(complaint_with("/inputs/payload.mass/value", true), "is true or false where a number"));
    EXPECT_TRUE(has(complaint_with("/cost/steps", -1), "cost.steps: is out of range"));
    EXPECT_TRUE(has(complaint_with("/cost/steps", 9223372036854775808ull), "cost.steps: is out of range"));
    EXPECT_TRUE(has(complaint_with("/cost/steps", 1.5), "cost.steps: is a number where a whole number"));
    EXPECT_TRUE(has(complaint_with("/provenance/threads", 2147483648), "0 to 2147483647 is possible"));
    EXPECT_TRUE(has(complaint_with("/warnings", {{"what", "a"}}), "warnings: is an object where an array"));
    EXPECT_TRUE(has(complaint_with("/warnings", {1}), "warnings[0]: is a number where an object"));
    EXPECT_TRUE(has(complaint_with("/scene", {1}), "scene: is an array where an object"));
    EXPECT_TRUE(has(complaint_of_summary("[]"), "is an array where an object belongs"));
    const std::vector<std::string> keys{"schema",   "scene", "inputs",   "fidelity", "status",    "metrics",
                                        "standing", "cost",  "warnings", "left_out", "provenance"};
    for (const std::string& key : keys)
        EXPECT_TRUE(has(complaint_without("", key), "the key '" + key + "' is missing")) << key;
    EXPECT_TRUE(has(complaint_without("/scene", "sha256"), "scene: the key 'sha256' is missing"));
    EXPECT_TRUE(has(complaint_without("/cost", "steps"), "cost: the key 'steps' is missing"));
}

TEST(RecordRead, WhatIsNotJsonIsRefusedWithLineAndColumn) {
    EXPECT_EQ(complaint_of_summary("{\n  \"schema\": 1,\n  x }").substr(0, 33),
              "d/summary.json:3:3: is not JSON, ");
    EXPECT_TRUE(has(complaint_of_summary(""), "is not JSON"));
    EXPECT_TRUE(has(complaint_of_summary("{\"a\": \"\xff\"}"), "is not JSON"));
    EXPECT_TRUE(has(complaint_of_summary("{\"a\": NaN}"), "is not JSON"));
    EXPECT_TRUE(has(complaint_of_summary("{\"a\": 1e999}"), "a number that is not finite"));
    const std::string whole = summary_json(record_to_read());
    for (std::size_t length = 0; length + 1 < whole.size(); length += 7)
        EXPECT_TRUE(has(complaint_of_summary(whole.substr(0, length)), "is not JSON")) << length;
}

TEST(RecordRead, AbsurdSummariesAreRefused) {
    const auto many = [](const std::string& text, std::size_t count) {
        std::string all;
        for (std::size_t i = 0; i < count; ++i)
            all += text;
        return all;
    };
    EXPECT_TRUE(has(complaint_of_summary(many("[", 1'000'000)), "is nested too deeply"));
    EXPECT_TRUE(has(complaint_of_summary(many("{\"a\":", 100'000)), "is nested too deeply"));
    EXPECT_TRUE(
        has(complaint_of_summary(std::string((4u << 20) + 1, ' ')), "is too large (more than 4 MiB)"));
    EXPECT_TRUE(has(complaint_of_summary("{\"a\": 1, \"a\": 2}"), "the key 'a' stands twice"));
    std::string keys = "{\"z\": 1";
    for (int i = 0; i < 3000; ++i)
        keys += ", \"k" + std::to_string(i) + "\": 1";
    EXPECT_TRUE(has(complaint_of_summary(keys + "}"), "an object is too large (more than 2048 keys)"));
}

TEST(RecordRead, ABrokenHistoryIsRefusedWithLineAndColumn) {
    const auto expect = [](const std::string& history, const std::string& start) {
        EXPECT_EQ(complaint_of_history(history).substr(0, start.size()), start) << history;
    };
    expect("time,x\ns,m\n0,1\n1,2x\n", "d/history.csv:4:3: '2x' is not a number");
    expect("time,x\ns,m\n0,1\n1,nan\n", "d/history.csv:4:3: 'nan' is not a finite number");
    expect("time,x\ns,m\n-inf,1\n", "d/history.csv:3:1: '-inf' is not a finite number");
    expect("time,x\ns,m\n0,1e999\n", "d/history.csv:3:3: '1e999' is not a finite number");
    expect("time,x\ns,m\n0,0x1p3\n", "d/history.csv:3:3: '0x1p3' is not a number");
    expect("time,x\ns,m\n0, 1\n", "d/history.csv:3:3: ' 1' is not a number");
    expect("time,x\ns,m\n0,+1\n", "d/history.csv:3:3: '+1' is not a number");
    expect("time,x\ns,m\n0,\"1\"\n", "d/history.csv:3:3: '1' is not a number");
    expect("time,x\ns,m\n0,1\n1\n", "d/history.csv:4:1: too few cells (the first line has 2)");
    expect("time,x\ns,m\n0,1,2\n", "d/history.csv:3:3: too many cells (the first line has 2)");
    expect("time,x\ns,m\n0,1\n\n", "d/history.csv:4:1: too few cells");
    expect("time,x\ns\n0,1\n", "d/history.csv:2:1: too few cells");
    expect("time,time\ns,s\n", "d/history.csv:1:6: the column 'time' stands here twice");
    expect("time,\ns,m\n", "d/history.csv:1:1: column 2 has no name");
    expect("time,x\ns,m\n0,1\n1,2", "d/history.csv:4:4: ends within a line (was it cut off?)");
    expect("time,x\n", "d/history.csv:2:1: ends within a line");
    expect("", "d/history.csv:1:1: ends within a line");
    expect("\n\n0\n", "d/history.csv:3:1: numbers without a column");
    expect("\"time\n", "d/history.csv:1:1: a quotation mark that is not closed");
    expect("ti\"me\n", "d/history.csv:1:3: a quotation mark inside a cell");
    expect("\"time\"x\n", "d/history.csv:1:7: a cell goes on after its quotation mark");
    expect(std::string(2000, ',') + "\n", "d/history.csv:1:1025: too many columns (more than 1024)");
}

TEST(RecordRead, BrokenEventsAreRefusedWithLineAndColumn) {
    const auto expect = [](const std::string& events, const std::string& start) {
        EXPECT_EQ(complaint_of_events(events).substr(0, start.size()), start) << events;
    };
    expect("name,time,altitude\n-,s,m\n", "d/events.csv:1:1: the column 'speed' is missing");
    expect("name,time,altitude,speed\n-,s,m,ft/s\n", "d/events.csv:2:1: speed is in 'ft/s' ('m/s' is known)");
    expect("name,time,altitude,speed\n-,s,m,m/s\na,1,b,2\n", "d/events.csv:3:5: 'b' is not a number");
    expect("name,time,altitude,speed\n-,s,m,m/s\na,,1,2\n", "d/events.csv:3:1: an event without a time");
    std::string many = "name,time,altitude,speed\n-,s,m,m/s\n";
    for (int i = 0; i < 5000; ++i)
        many += "a,1,1,1\n";
    expect(many, "d/events.csv:4099:1: too many events (more than 4096)");
}

TEST(RecordRead, ATableThatIsCutOffAnywhereIsRefusedOrShorterByWholeLines) {
    const std::string whole = history_csv(record_to_read());
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const std::string cut = whole.substr(0, length);
        const bool two_lines = std::ranges::count(cut, '\n') >= 2;
        EXPECT_EQ(complaint_of_history(cut) == "no complaint", two_lines && cut.ends_with('\n')) << length;
    }
}

TEST(RecordRead, TablesWithoutALineOfUnitsTakeThemFromTheSummary) {
    const RunRecord record = record_to_read();
    const std::string history = history_csv(record, CsvHead::names),
                      events = events_csv(record, CsvHead::names),
                      summary = summary_json(record, {}, CsvHead::names);
    EXPECT_EQ(record_difference(as_written(record), read_record_text(summary, history, events)), "");
    // Units that one of the two lacks, or both have.
    EXPECT_TRUE(has(complaint(summary, history_csv(record), events), "history.csv:2:1: 's' is not a number"))
        << complaint(summary, history_csv(record), events);
    EXPECT_TRUE(has(complaint(summary, history, events_csv(record)), "events.csv:2:3: 's' is not a number"))
        << complaint(summary, history, events_csv(record));
    ordered_json json = ordered_json::parse(summary);
    json["history_units"].erase("force");
    EXPECT_TRUE(
        has(complaint(json.dump(), history, events), "history.csv:1:1: the column 'force' has no unit"))
        << complaint(json.dump(), history, events);
    EXPECT_TRUE(
        has(complaint(summary_json(record), history_csv(record), events), "events.csv:2:1: name is in"))
        << complaint(summary_json(record), history_csv(record), events);
}

TEST(RecordRead, AFileThatIsNotTheOneTheSummaryVouchesForIsRefused) {
    const ScratchDir scratch;
    ShapeFrames frames{3, 0, {{0, 1, 2}}, {}, {}};
    frames.frames.push_back(quantised(0.5, std::vector<double>{0, 0, 1, 2, 0, 1, 0, 2, 1}, std::vector{7.0},
                                      {FabricFolds::taut}));
    const auto whole = [&] { write_record(record_to_read(), scratch / "r", frames); };
    const auto says = [&] {
        try {
            read_record(scratch / "r");
        } catch (const RecordError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    whole();
    EXPECT_EQ(says(), "");
    for (const std::string name : {"history.csv", "events.csv", "frames.bin"}) {
        whole();
        std::string text = content_of(scratch / ("r/" + name));
        const auto digit = name == "frames.bin" ? text.size() - 1 : text.rfind('5');
        ASSERT_NE(digit, std::string::npos) << name;
        text[digit] = text[digit] == '6' ? '7' : '6';  // tables stay tables of numbers
        scratch.write("r/" + name, text);
        EXPECT_TRUE(
            has(says(), "r/" + name + ": is not the file that this record was written with (its SHA-256"))
            << says();
        text.resize(name == "frames.bin" ? 5 : text.find('\n', text.find('\n') + 1) + 1);  // no row left
        scratch.write("r/" + name, text);
        EXPECT_TRUE(has(says(), "it was edited or cut short), run the scene again")) << name << says();
    }
    whole();
    std::filesystem::remove(scratch / "r/frames.bin");
    EXPECT_TRUE(has(says(), "r/frames.bin: no such file (the record is not whole)"));

    // An earlier version wrote no checksums: its record is read, edited or not.
    whole();
    ordered_json summary = ordered_json::parse(content_of(scratch / "r/summary.json"));
    EXPECT_EQ(summary["files"].size(), 3u);
    summary.erase("files");
    summary.erase("sha256");
    scratch.write("r/summary.json", summary.dump());
    scratch.write("r/events.csv", "name,time,altitude,speed\n-,s,m,m/s\n");
    EXPECT_EQ(says(), "");
    // Names stay inside the directory: no file of another place is opened, whatever its checksum.
    for (const char* name : {"../r/history.csv", "/etc/hostname", "..", ".hidden", "", "a b", "a\nb"}) {
        summary["files"] = {{name, "0"}};
        scratch.write("r/summary.json", summary.dump());
        EXPECT_TRUE(has(says(), "summary.json: files: '") && has(says(), "is not the name of a file"))
            << says();
    }
    summary["files"] = {{"history.csv", 3}};
    scratch.write("r/summary.json", summary.dump());
    EXPECT_TRUE(has(says(), "files.history.csv: is a number where text belongs")) << says();
}

TEST(RecordRead, ADirectoryWithoutSummaryIsNotARecord) {
    const ScratchDir scratch;
    const auto says = [&](const std::filesystem::path& directory) {
        try {
            read_record(directory);
        } catch (const RecordError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_TRUE(has(says(scratch.path()), "is not a record (there is no summary.json in it), name"));
    EXPECT_TRUE(has(says(scratch / "none"), "no such directory, check the path"));
    write_record(record_to_read(), scratch / "r");
    EXPECT_EQ(says(scratch / "r"), "");
    EXPECT_TRUE(has(says(scratch / "r/summary.json"), "is not a directory"));
    std::filesystem::remove(scratch / "r/history.csv");
    EXPECT_TRUE(has(says(scratch / "r"), "r/history.csv: no such file (the record is not whole)"));
    ASSERT_EQ(::mkfifo((scratch / "r/history.csv").c_str(), 0600), 0);  // would be waited for
    EXPECT_TRUE(has(says(scratch / "r"), "r/history.csv: is not a regular file"));
}

}  // namespace
}  // namespace twinchute
