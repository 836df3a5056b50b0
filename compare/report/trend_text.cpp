#include "compare/report/trend_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "compare/render/escape.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/words.hpp"
#include "lib/record/display_units.hpp"
#include "lib/record/metrics.hpp"

namespace twinchute::compare {
namespace {

using Json = nlohmann::ordered_json;

constexpr int trend_schema = 1;
constexpr std::size_t most_lines = 12;  ///< of changes on a terminal; the report has all

std::string value_or_dash(const std::optional<double>& value, std::string_view unit) {
    return value_text(value ? std::optional(SideValue{*value, MetricKind::result, {}}) : std::nullopt, unit);
}

/// Small changes are what a trend is about: as many digits as it takes.
std::string change_text(const MetricChange& change, std::string_view unit) {
    if (!change.difference) return change.now ? "new" : "gone";
    if (change.relative) return fmt::format("{:+.2g} %", 100 * *change.relative);
    return fmt::format("{:+.2g}{}", shown(*change.difference, unit).value, spaced_unit(unit));
}

Table table_of(std::span<const MetricChange> changes) {
    Table table;
    table.add_words({"metric", "of"});
    table.add_numbers({"baseline", "now", "change", "tolerance"});
    table.add_words({"verdict"});
    for (const MetricChange& change : changes) {
        const auto [name, unit] = split_metric_key(change.key);
        table.rows.push_back({name, change.fidelity, value_or_dash(change.before, unit),
                              value_or_dash(change.now, unit), change_text(change, unit),
                              change.tolerance ? shown_tolerance(*change.tolerance, unit) : "-",
                              verdict_cell(change.verdict)});
    }
    return table;
}

struct Group {
    const char* title;
    const std::vector<OtherChange>* changes;
};

std::array<Group, 3> groups_of(const Trend& trend) {
    return {{{"input", &trend.inputs}, {"model", &trend.model}, {"machine", &trend.machine}}};
}

std::string from_to(const OtherChange& change) {
    const auto shown = [](const std::string& text) { return text.empty() ? "absent" : text; };
    return fmt::format("{}: {} -> {}", change.what, shown(change.before), shown(change.now));
}

Json metric_json(const MetricChange& change) {
    Json json{{"fidelity", change.fidelity}, {"metric", change.key}};
    const auto put = [&](const char* key, const std::optional<double>& value) {
        if (value && std::isfinite(*value)) json[key] = *value;
    };
    put("baseline", change.before);
    put("now", change.now);
    put("difference", change.difference);
    put("relative", change.relative);
    if (change.tolerance)
        json["tolerance"] = {{"value", change.tolerance->value}, {"relative", change.tolerance->relative}};
    json["verdict"] = verdict_name(change.verdict);
    if (!change.note.empty()) json["note"] = change.note;
    return json;
}

}  // namespace

std::string failure_text(const MetricChange& change) {
    const auto [name, unit] = split_metric_key(change.key);
    const std::string tolerance = change.tolerance ? shown_tolerance(*change.tolerance, unit) : "none";
    const std::string text = fmt::format("{} of {}: baseline {}, now {}", name, change.fidelity,
                                         value_or_dash(change.before, unit), value_or_dash(change.now, unit));
    if (change.verdict == Verdict::missing)
        return fmt::format("{}{}{}, so that the tolerance of {} cannot be judged", text,
                           change.note.empty() ? "" : ", ", change.note, tolerance);
    return fmt::format("{}, change {}, tolerance {}", text, change_text(change, unit), tolerance);
}

std::string trend_terminal(const Trend& trend, const std::string& baseline, const Style& style) {
    std::string text = fmt::format("\nbaseline  {}\n", printable(baseline));
    for (const Group& group : groups_of(trend))
        for (const OtherChange& change : *group.changes)
            text += fmt::format("{:<9} {}\n", group.title, printable(from_to(change)));
    if (!trend.changes.empty()) {
        const auto shown = std::span(trend.changes).first(std::min(most_lines, trend.changes.size()));
        text += "\n" + terminal_table(table_of(shown), style);
        if (shown.size() < trend.changes.size())
            text += fmt::format("and {} that moved less; trend.md has them\n",
                                trend.changes.size() - shown.size());
        text += "\n";
    }
    const bool bad = overall_verdict(trend) == Verdict::exceeded;
    return text + fmt::format("trend     {}\n",
                              style.paint(printable(verdict_line(trend)), bad ? Colour::red : Colour::green));
}

std::string trend_markdown(const Trend& trend, const std::string& baseline, const std::string& scene) {
    std::string text = fmt::format("# {}, against a baseline\n\n**{}**\n\n", markdown_text(scene),
                                   markdown_text(verdict_line(trend)));
    text += fmt::format("- baseline: {}\n", markdown_text(baseline));
    for (const Group& group : groups_of(trend))
        for (const OtherChange& change : *group.changes)
            text += fmt::format("- {}: {}\n", group.title, markdown_text(from_to(change)));
    if (trend.changes.empty()) return text;
    text += "\n" + markdown_table(table_of(trend.changes));
    return text + fmt::format("\nMetrics that moved by more than {:g} of their earlier value, most first.\n",
                              trend_threshold);
}

Json trend_json(const Trend& trend, const std::string& baseline) {
    Json json{{"generator", "twinchute"}, {"schema", trend_schema}, {"baseline", baseline}};
    json["verdict"] = verdict_name(overall_verdict(trend));
    json["summary"] = verdict_line(trend);
    json["compared"] = trend.compared;
    json["judged"] = trend.judged;
    Json& changes = json["changes"] = Json::array();
    for (const MetricChange& change : trend.changes)
        changes.push_back(metric_json(change));
    const std::pair<const char*, const std::vector<OtherChange>*> others[] = {
        {"inputs", &trend.inputs}, {"model", &trend.model}, {"machine", &trend.machine}};
    for (const auto& [key, list] : others) {
        Json& rows = json[key] = Json::array();
        for (const OtherChange& change : *list)
            rows.push_back({{"what", change.what}, {"baseline", change.before}, {"now", change.now}});
    }
    return json;
}

}  // namespace twinchute::compare
