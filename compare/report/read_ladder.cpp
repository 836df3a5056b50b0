#include "compare/report/read_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "compare/report/ladder_files.hpp"
#include "lib/record/checksum.hpp"
#include "lib/record/json_node.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute::compare {
namespace {

constexpr const char* again = "run `twinchute ladder` again, or remove the file";

using Words = std::span<const std::string_view>;

/// The one of `known` that stands at `node`: it outlives the file.
std::string_view word(const JsonNode& node, Words known, std::string_view what) {
    const std::string text = node.text();
    const auto found = std::ranges::find(known, text);
    if (found == known.end())
        node.refuse(fmt::format("'{}' is not a {}", shown(text), what),
                    fmt::format("known: {}", fmt::join(known, ", ")), again);
    return *found;
}

/// Families that files of earlier versions name by a retired word.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> retired_families{
    {{"rom, without a piece", "rom, without an effect"},
     {"full, without a piece", "full, without an effect"}}};

std::string_view family(const JsonNode& node) {
    const std::string text = node.text();
    for (const auto& [retired, name] : retired_families)
        if (text == retired) return name;
    return word(node, drawn_families(), "family of levels");
}

std::string_view metric_name(const JsonNode& node) {
    const std::string text = node.text();
    const MetricRow* row = find_metric_row(text);
    if (row == nullptr) node.refuse(fmt::format("'{}' is not a metric", shown(text)), "", again);
    return row->name;
}

/// Distances have no sign.
Worst read_worst(const JsonNode& node) {
    const double value = node.at("value").number();
    if (value < 0) node.at("value").refuse("is negative", "a distance has no sign", again);
    return {value, metric_name(node.at("metric"))};
}

std::optional<Worst> worst_at(const JsonNode& node, const char* key) {
    const auto found = node.find(key);
    if (!found) return {};
    return read_worst(*found);
}

void read_run(LevelResult& result, const JsonNode& node) {
    const JsonNode status = node.at("status");
    result.status.detail = status.text_at("detail");
    result.was_run = status.text_at("code") != "not_run";
    if (!result.was_run) return;
    result.status.code = json_word(status.at("code"), status_name);
    constexpr std::int64_t most = std::numeric_limits<int>::max();
    result.runs = static_cast<int>(node.at("runs").count(most));
    result.seeds = static_cast<int>(node.at("seeds").count(most));
    result.wall_s = node.at("wall_s").number();
    result.steps = node.at("steps").count();
    result.rhs_calls = node.at("rhs_calls").count();
}

LevelResult read_level(const JsonNode& node, Words fidelities) {
    LevelResult result;
    Level& level = result.level;
    level.name = node.text_at("name");
    if (const auto label = node.find("label")) level.label = label->text();
    level.family = family(node.at("family"));
    level.why = node.text_at("why");
    if (const auto fidelity = node.find("fidelity")) level.fidelity = word(*fidelity, fidelities, "fidelity");
    level.given = node.at("as_given").truth();
    const std::vector<std::string_view> physics{"same", "other"};
    level.physics =
        word(node.at("physics"), physics, "kind of physics") == "same" ? Physics::same : Physics::other;
    result.setting = node.text_at("setting");
    read_run(result, node);
    result.error = worst_at(node, "error");
    result.estimate = worst_at(node, "error_estimate");
    result.effect = worst_at(node, "effect");
    result.to_test = worst_at(node, "distance_to_test");
    for (const std::string_view fidelity : fidelities)
        if (const auto gaps = node.find("gap"))
            if (const auto gap = worst_at(*gaps, std::string(fidelity).c_str()))
                result.gaps.emplace_back(fidelity, *gap);
    result.is_reference = node.at("is_reference").truth();
    result.on_front = node.at("on_pareto_front").truth();
    return result;
}

/// Metrics that this version does not know are left out.
void read_references(Ladder& ladder, const JsonNode& node, Words fidelities) {
    for (const std::string_view fidelity : fidelities) {
        const auto of_one = node.find(std::string(fidelity));
        if (!of_one) continue;
        ladder.fidelities.push_back(fidelity);
        of_one->each_key([&](const std::string& key, const JsonNode& reference) {
            const MetricRow* row = find_metric_row(split_metric_key(key).name);
            if (row == nullptr || row->key != key) return;
            ladder.references.push_back({fidelity, row, reference.at("value").number(),
                                         json_word(reference.at("input_or_result"), metric_kind_name),
                                         reference.text_at("how"), ""});
        });
    }
}

}  // namespace

Ladder read_ladder(std::string_view text, const std::string& file, Words fidelities) {
    const JsonDocument document(text, file);
    const JsonNode top = document.top();
    require_schema(top, "ladder", Ladder::schema);
    Ladder ladder;
    ladder.scene = read_scene_id(top.at("scene"));
    if (const auto inputs = top.find("inputs")) ladder.inputs = read_inputs(*inputs);
    ladder.provenance = read_provenance(top.at("provenance"));
    ladder.threads = static_cast<int>(top.at("threads").count(std::numeric_limits<int>::max()));
    ladder.quick = top.at("quick").truth();
    top.at("judged").each_row([&](const JsonNode& row) { ladder.judged.push_back(metric_name(row)); });
    read_references(ladder, top.at("references"), fidelities);
    ladder.gap = worst_at(top, "gap_between_fidelities");
    if (ladder.gap && ladder.fidelities.size() < 2)
        top.at("references").refuse("names fewer than two fidelities", "there is a gap between two", again);
    top.at("rungs").each_row(
        [&](const JsonNode& row) { ladder.levels.push_back(read_level(row, fidelities)); });
    if (const auto sum = top.find("sha256")) require_own_checksum(text, sum->text(), file, again);
    return ladder;
}

}  // namespace twinchute::compare
