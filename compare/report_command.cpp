#include "compare/report_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "compare/drop_test_option.hpp"
#include "compare/gap.hpp"
#include "compare/record_table.hpp"
#include "compare/records.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/write_report.hpp"
#include "compare/tolerances.hpp"
#include "compare/trend.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::compare {
namespace {

namespace fs = std::filesystem;

bool holds_a_record(const fs::path& directory, const Fidelity& fidelity) {
    std::error_code ignored;
    return fs::exists(directory / fidelity.name / "summary.json", ignored);
}

/// Cases that a directory of a series has by its table; 0: it has none.
std::size_t cases_of(const fs::path& directory) {
    std::ifstream table(directory / "series.csv");
    std::size_t lines = 0;
    for (std::string line; std::getline(table, line);)
        ++lines;
    constexpr std::size_t head = 2;  // names, units
    return lines > head ? lines - head : 0;
}

/// The directory itself, or those of the cases where it is that of a series, by name.
std::vector<fs::path> comparisons_in(const fs::path& directory, const Fidelity& reference,
                                     const Fidelity& candidate) {
    const auto is_comparison = [&](const fs::path& place) {
        return holds_a_record(place, reference) || holds_a_record(place, candidate);
    };
    if (is_comparison(directory)) return {directory};
    std::vector<fs::path> places;
    std::error_code error;
    for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error))
        if (!entry->is_symlink(error) && is_comparison(entry->path())) places.push_back(entry->path());
    if (places.empty())
        throw UsageError(
            fmt::format("'{0}' holds no comparison (neither '{0}/{1}' nor '{0}/{2}' is a record), "
                        "name a directory that `twinchute compare` wrote",
                        directory.string(), reference.name, candidate.name));
    if (const std::size_t cases = cases_of(directory); places.size() < cases)
        throw UsageError(
            fmt::format("'{}' holds {} of the {} comparisons that its series.csv lists (what is not there "
                        "cannot be judged), run `twinchute compare` again, or name those that are there",
                        directory.string(), places.size(), cases));
    std::ranges::sort(places);
    return places;
}

/// Two records that are not of the same scene have no gap.
void require_same_scene(const Comparison& comparison, const fs::path& place) {
    const auto refuse = [&](const std::string& why) {
        throw RecordError({place.string()}, "its two records are not of one scene", why,
                          "run `twinchute compare` again");
    };
    if (comparison.reference.scene.sha256 != comparison.candidate.scene.sha256)
        refuse("the SHA-256 of their scenes differ");
    for (const Input& input : comparison.reference.inputs) {
        const Input* other = comparison.candidate.find_input(input.key);
        if (other == nullptr || other->origin == InputOrigin::calibrated) continue;
        if (!same_value(*other, input)) refuse("they differ in " + input.key);
    }
}

Comparison comparison_of(const fs::path& place, const Fidelity& reference, const Fidelity& candidate,
                         const std::map<std::string, Tolerance>& asked,
                         const std::optional<DropTestHistories>& test) {
    Comparison comparison;
    comparison.test = test;
    comparison.reference_title = reference.title;
    comparison.candidate_title = candidate.title;
    comparison.candidate = record_of(place, candidate);
    comparison.reference = record_of(place, reference);
    comparison.candidate_frames = read_frames(place / candidate.name);
    comparison.reference_frames = read_frames(place / reference.name);
    require_same_scene(comparison, place);
    std::map<std::string, Tolerance> tolerances = asked;  // they win
    tolerances.merge(recorded_tolerances(comparison.reference, summary_of(place, reference)));
    auto of_command_line = command_line_tolerances(comparison.reference);
    for (const auto& [name, tolerance] : asked)
        of_command_line.insert(name);
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, tolerances, of_command_line);
    comparison.attribution = attribution_in(place, comparison);
    return comparison;
}

/// One way to write a directory: "s/a" of "s/a/" and "s/../s/a".
fs::path plain(const fs::path& directory) {
    return (directory / "").lexically_normal().parent_path();
}

/// A directory that an operand leads to, and what lies there.
struct Place {
    fs::path directory;
    bool comparison = true;  ///< otherwise the record of one fidelity
};

std::vector<Place> places_of(const Arguments& arguments, const Fidelity& reference,
                             const Fidelity& candidate) {
    std::vector<Place> places;
    const auto add = [&](fs::path directory, bool comparison) {
        directory = plain(directory);
        if (std::ranges::find(places, directory, &Place::directory) == places.end())
            places.push_back({std::move(directory), comparison});
    };
    for (const std::string& operand : arguments.operands) {
        std::error_code ignored;
        if (fs::exists(fs::path(operand) / "summary.json", ignored)) {
            add(operand, false);
            continue;
        }
        for (fs::path& place : comparisons_in(operand, reference, candidate))
            add(std::move(place), true);
    }
    return places;
}

/// Summary of all places together.
struct Summary {
    ExitCode code = ExitCode::done;
    std::vector<RecordRow> rows;
    std::vector<std::string> json;
    std::string verdicts;   ///< a line a comparison
    std::string last_text;  ///< of the only comparison, where there is one
};

void add_to(Summary& summary, const Comparison& comparison, const LadderBeside& beside, const fs::path& place,
            bool alone) {
    for (const RunRecord* side : {&comparison.candidate, &comparison.reference})
        summary.rows.push_back(record_row(*side, place.string()));
    summary.code = gravest(summary.code, exit_code(comparison));
    summary.json.push_back(gap_json(comparison));
    summary.verdicts +=
        fmt::format("verdict   {}: {}\n", printable(place.string()), printable(verdict_line(comparison)));
    if (!beside.why_not.empty()) summary.verdicts += ladder_line(beside, place);
    if (alone)
        summary.last_text = terminal_text(comparison, output_style()) + ladder_line(beside, place) +
                            fmt::format("report    {}\n", printable((place / "report.html").string()));
}

std::string joined(const std::vector<std::string>& texts) {
    return fmt::format("[\n{}]\n", fmt::join(texts, ",\n"));
}

/// The table of all records, in a directory of its own.
void add_table(FileBatch& batch, const std::vector<RecordRow>& rows, const fs::path& directory) {
    batch.add(directory / "report.md", records_markdown(rows));
    batch.add(directory / "records.csv", records_csv(rows));
    batch.add(directory / "records.json", records_json(rows), FileBatch::Kind::marker);
}

ExitCode run_report(const Fidelity& reference, const Fidelity& candidate, const Arguments& arguments) {
    choose_units(arguments);
    const std::map<std::string, Tolerance> asked = read_tolerances(tolerance_overrides(arguments));
    const std::optional<DropTestHistories> test = test_of(arguments);
    const std::optional<std::string> out = arguments.value("out");
    if (out) check_output_dir(*out);
    const std::vector<Place> places = places_of(arguments, reference, candidate);
    for (const Place& place : places)
        if (!place.comparison && (arguments.has("tolerance") || test))
            throw UsageError(
                fmt::format("'{}' is the record of one model (a tolerance or a test is held against a "
                            "comparison), name a directory that `twinchute compare` wrote",
                            place.directory.string()));
    if (out && test)
        throw UsageError(
            "--test with --out (a table of records has no place for a test), leave one of them out");
    const bool alone = places.size() == 1 && places.front().comparison && !out;
    const bool one = places.size() == 1 && places.front().directory == plain(arguments.operands.front());
    const std::array<std::string_view, 2> fidelities{candidate.name, reference.name};
    FileBatch batch;  // all of them or none
    Summary summary;
    for (const Place& place : places) {
        if (!place.comparison) {
            const RunRecord record = read_record(place.directory);
            if (!out) {
                const bool is_reference = record.fidelity == reference.name;
                batch.add(place.directory / "run.html",
                          record_html(record, read_frames(place.directory),
                                      is_reference ? reference.title : candidate.title, is_reference));
                summary.verdicts +=
                    fmt::format("report    {}\n", printable((place.directory / "run.html").string()));
            }
            summary.rows.push_back(record_row(record, place.directory.string()));
            summary.code = gravest(summary.code, twinchute::exit_code(record.status.code));
            summary.json.push_back(summary_json(record));
            continue;
        }
        const Comparison comparison = comparison_of(place.directory, reference, candidate, asked, test);
        LadderBeside beside;
        if (!out) {
            beside = ladder_beside(place.directory, comparison.reference, fidelities);
            add_gap_files(batch, comparison, place.directory, beside);
        }
        add_to(summary, comparison, beside, place.directory, alone);
    }
    if (out) add_table(batch, summary.rows, *out);
    batch.commit();
    if (arguments.has("json")) {
        print(one ? summary.json.front() : joined(summary.json));
    } else if (!arguments.has("quiet")) {
        print(alone ? summary.last_text
                    : records_terminal(summary.rows, output_style()) + "\n" + summary.verdicts);
        if (out) print(fmt::format("report    {}\n", printable((fs::path(*out) / "report.md").string())));
    }
    return summary.code;
}

}  // namespace

Command report_command(const Fidelity& reference, const Fidelity& candidate) {
    Command command;
    command.name = "report";
    command.summary = "make the reports of comparisons and runs again, from their records; of many, a table";
    command.operand = "DIR...";
    command.example = "twinchute report c9-inflation.out";
    command.options = drop_test_options();
    command.options.insert(command.options.begin(), tolerance_option(reference.name));
    for (Option& option : std::vector<Option>{
             {"out", "DIR", "write only a table of all records there, as Markdown, CSV and JSON"},
             units_option(),
             {"json", "", "print the gap as JSON and nothing else"},
             {"quiet", "", "print nothing but errors"}})
        command.options.push_back(std::move(option));
    command.run = [&reference, &candidate](const Arguments& arguments) {
        return run_report(reference, candidate, arguments);
    };
    return command;
}

}  // namespace twinchute::compare
