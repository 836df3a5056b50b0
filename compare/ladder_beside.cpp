#include "compare/ladder_beside.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "compare/report/read_ladder.hpp"
#include "compare/trend.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute::compare {
namespace {

constexpr std::size_t largest_ladder = 16u << 20;  // [bytes] a real one takes some 300 kB

/// Fields are written beside a run and change nothing in it.
std::vector<OtherChange> changes_between(const Ladder& ladder, const RunRecord& record) {
    std::vector<OtherChange> changes = input_changes(ladder.inputs, record.inputs);
    std::erase_if(changes, [](const OtherChange& change) { return change.what == "full.fields_rate"; });
    return changes;
}

/// Why a ladder is not one of the record's scene; empty where it is.
std::string difference(const Ladder& ladder, const RunRecord& record) {
    if (ladder.scene.sha256 != record.scene.sha256)
        return fmt::format(
            "it is of another scene file, or of an earlier state of it ({}, SHA-256 {} instead of {})",
            ladder.scene.file, ladder.scene.sha256.substr(0, 12), record.scene.sha256.substr(0, 12));
    if (ladder.inputs.empty()) return "it does not say its inputs, as versions before this one did not";
    const std::vector<OtherChange> changes = changes_between(ladder, record);
    if (changes.empty()) return {};
    const auto value = [](const std::string& text) { return text.empty() ? "not given" : text; };
    const OtherChange& first = changes.front();
    const std::string more =
        changes.size() > 1 ? fmt::format(", and {} more of its inputs differ", changes.size() - 1) : "";
    return fmt::format("it is of the scene with other inputs ({} is {} there and {} here{})", first.what,
                       value(first.before), value(first.now), more);
}

}  // namespace

LadderBeside ladder_beside(const std::filesystem::path& place, const RunRecord& record,
                           std::span<const std::string_view> fidelities) {
    const std::filesystem::path file = place / "ladder.json";
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return {};
    LadderBeside beside{read_ladder(read_record_file(file, largest_ladder), file.string(), fidelities), {}};
    beside.why_not = difference(*beside.ladder, record);
    if (!beside.why_not.empty()) beside.ladder.reset();
    return beside;
}

std::string ladder_line(const LadderBeside& beside, const std::filesystem::path& place) {
    const std::string file = printable((place / "ladder.json").string());
    if (!beside.why_not.empty())
        return fmt::format("ladder    {} is not in the report: {}\n", file, printable(beside.why_not));
    return beside.ladder ? fmt::format("ladder    {} is in the report\n", file) : std::string();
}

}  // namespace twinchute::compare
