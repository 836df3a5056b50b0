#include "compare/report_verb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "compare/gap.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/write_report.hpp"
#include "compare/tolerances.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/read_record.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::compare {
namespace {

namespace fs = std::filesystem;

bool holds_a_record(const fs::path& directory, const Fidelity& fidelity) {
    std::error_code ignored;
    return fs::exists(directory / fidelity.name / "summary.json", ignored);
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
    std::ranges::sort(places);
    return places;
}

std::string summary_of(const fs::path& place, const Fidelity& fidelity) {
    return (place / fidelity.name / "summary.json").string();
}

RunRecord record_of(const fs::path& place, const Fidelity& fidelity) {
    RunRecord record = read_record(place / fidelity.name);
    if (record.fidelity != fidelity.name)
        throw RecordError({summary_of(place, fidelity)}, "is not a record of " + std::string(fidelity.name),
                          "it says that it is of '" + record.fidelity.substr(0, 40) + "'",
                          "put the records back in their places");
    return record;
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
        if (other != nullptr && other->value != input.value) refuse("they differ in " + input.key);
    }
}

Comparison comparison_of(const fs::path& place, const Fidelity& reference, const Fidelity& candidate,
                         const std::map<std::string, Tolerance>& asked) {
    Comparison comparison;
    comparison.reference_title = reference.title;
    comparison.candidate_title = candidate.title;
    comparison.candidate = record_of(place, candidate);
    comparison.reference = record_of(place, reference);
    comparison.candidate_frames = read_frames(place / candidate.name);
    comparison.reference_frames = read_frames(place / reference.name);
    require_same_scene(comparison, place);
    std::map<std::string, Tolerance> tolerances = asked;  // they win
    tolerances.merge(recorded_tolerances(comparison.reference, summary_of(place, reference)));
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, tolerances);
    return comparison;
}

ExitCode run_report(const Fidelity& reference, const Fidelity& candidate, const Arguments& arguments) {
    const std::map<std::string, Tolerance> asked = read_tolerances(tolerance_overrides(arguments));
    std::vector<fs::path> places;
    bool one = arguments.operands.size() == 1;
    for (const std::string& operand : arguments.operands) {
        for (fs::path& place : comparisons_in(operand, reference, candidate)) {
            one = one && place == operand;
            if (std::ranges::find(places, place) == places.end()) places.push_back(std::move(place));
        }
    }
    FileBatch batch;  // all of them or none
    ExitCode code = ExitCode::done;
    std::string text;
    for (const fs::path& place : places) {
        const Comparison comparison = comparison_of(place, reference, candidate, asked);
        add_gap_files(batch, comparison, place);
        code = gravest(code, exit_code(comparison));
        if (arguments.has("json")) {
            text += (text.empty() ? "" : ",\n") + gap_json(comparison);
        } else if (!arguments.has("quiet")) {
            text += (text.empty() ? "" : "\n") + terminal_text(comparison, output_style());
            text += fmt::format("report    {}\n", printable((place / "report.html").string()));
        }
    }
    batch.commit();
    print(arguments.has("json") && !one ? "[\n" + text + "]\n" : text);
    return code;
}

}  // namespace

Verb report_verb(const Fidelity& reference, const Fidelity& candidate) {
    Verb verb;
    verb.name = "report";
    verb.summary = "make the reports of comparisons again, from their records";
    verb.operand = "DIR...";
    verb.example = "twinchute report c9-inflation.out";
    verb.options = {tolerance_option(reference.name),
                    {"json", "", "print the gap as JSON and nothing else"},
                    {"quiet", "", "print nothing but errors"}};
    verb.run = [&reference, &candidate](const Arguments& arguments) {
        return run_report(reference, candidate, arguments);
    };
    return verb;
}

}  // namespace twinchute::compare
