// Any bytes as a record, its three files one after the other with a NUL between them, after a fourth a
// gap.json that may hold an attribution, and what is left as its frames: a record that survives being written
// and read again, of which every report can be made and which can be a baseline, or a RecordError with a
// place.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "compare/report/attribution_json.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "compare/report/junit.hpp"
#include "compare/report/markdown.hpp"
#include "compare/report/plots.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/trend_text.hpp"
#include "compare/trend.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_json.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace twinchute;

std::string_view part_of(std::string_view& text) {
    const std::size_t end = text.find('\0');
    const std::string_view part = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return part;
}

bool holds_null(const nlohmann::json& json) {
    return json.is_null() || (json.is_structured() && std::ranges::any_of(json, holds_null));
}

/// The record as a baseline that later runs are held against.
void follow(const compare::Comparison& now) {
    compare::Comparison before;
    before.reference = before.candidate = now.reference;
    for (const bool itself : {false, true}) {
        const compare::Trend trend =
            compare::measure_trend(itself ? now : before, now, {{"peak_force", {1e-2, true}}});
        const auto json = compare::trend_json(trend, "d");
        fuzz::require(!holds_null(nlohmann::json::parse(json.dump())), "what is absent has no key");
        fuzz::require(!compare::trend_markdown(trend, "d", now.reference.scene.name).empty() &&
                          !compare::trend_terminal(trend, "d", {}).empty(),
                      "a trend says something");
        const auto stands = [](const compare::MetricChange& change) {
            return change.verdict == compare::Verdict::missing && !change.before && !change.now;  // asked for
        };
        fuzz::require(!itself || (std::ranges::all_of(trend.changes, stands) && trend.inputs.empty()),
                      "a record has not moved from itself");
    }
}

/// The record beside itself one metric further: differences and quotients of whatever it holds.
void report(const RunRecord& record, std::string_view foreign_gap, const ShapeFrames& frames) {
    compare::Comparison comparison;
    comparison.reference_frames = frames;
    comparison.reference = comparison.candidate = record;
    std::vector<Metric>& metrics = comparison.candidate.metrics;
    for (std::size_t i = 0; i + 1 < metrics.size(); ++i)
        metrics[i].value = metrics[i + 1].value;
    comparison.gap = compare::measure_gap(comparison.reference, comparison.candidate, {});
    if (!foreign_gap.empty()) try {
            comparison.attribution = compare::read_attribution(foreign_gap, "d/gap.json", comparison);
        } catch (const RecordError& error) {
            fuzz::require(error.place().file == "d/gap.json", "an error has a place");
        }
    follow(comparison);
    const std::string gap = compare::gap_json(comparison);
    fuzz::require(!holds_null(nlohmann::json::parse(gap)), "what is absent has no key");
    fuzz::require(!compare::report_markdown(comparison).empty() && !compare::junit_xml(comparison).empty() &&
                      !compare::terminal_text(comparison, {}).empty(),
                  "a report says something");
    constexpr std::size_t largest_page = 4 << 20;
    fuzz::require(compare::report_html(comparison).size() < largest_page, "a page is of the size of a page");
    constexpr std::size_t largest_plot = 1 << 20;
    fuzz::require(compare::force_svg(compare::page_sides(comparison)).size() < largest_plot &&
                      compare::speed_svg(compare::page_sides(comparison)).size() < largest_plot,
                  "a plot is of the size of a plot");
}

/// Reads the frames; none when the bytes are refused. Whatever is read is written as it was.
ShapeFrames frames_of(std::string_view bytes) {
    if (bytes.empty()) return {};
    try {
        ShapeFrames shape = read_frames_bytes(bytes, "d/frames.bin");
        fuzz::require(frames_bytes(shape) == bytes, "frames are written as they were read");
        return shape;
    } catch (const RecordError& error) {
        fuzz::require(error.place().file == "d/frames.bin", "an error has a place");
        return {};
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text = fuzz::text_of(data, size);
    const std::string_view summary = part_of(text), history = part_of(text), events = part_of(text),
                           gap = part_of(text);
    const ShapeFrames frames = frames_of(text);
    RunRecord record;
    try {
        record = read_record_text(summary, history, events, "d");
    } catch (const RecordError& error) {
        const RecordPlace& place = error.place();
        fuzz::require(place.file.starts_with("d/") && (place.line > 0) == (place.column > 0),
                      "an error has a place");
        fuzz::require(*error.what() != '\0', "an error says something");
        return 0;
    }
    for (const Channel& channel : record.channels)
        fuzz::require(channel.values.size() == record.channels.front().values.size(),
                      "all channels have the same length");
    const std::string written[] = {summary_json(record), history_csv(record), events_csv(record)};
    const RunRecord again = read_record_text(written[0], written[1], written[2]);
    fuzz::require(summary_json(again) == written[0] && history_csv(again) == written[1] &&
                      events_csv(again) == written[2],
                  "a record is the same when it is read again");
    fuzz::require(summary_json(as_written(record)) == written[0], "a record that was read is as written");
    report(record, gap, frames);
    return 0;
}
