#include "compare/record_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "compare/render/escape.hpp"
#include "compare/render/table.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::compare {
namespace {

constexpr int table_schema = 1;
constexpr std::array<std::string_view, 6> brief{"snatch_speed_m_s", "filling_time_s",   "peak_force_N",
                                                "load_factor",      "descent_rate_m_s", "altitude_loss_m"};

std::optional<double> value_of(const RecordRow& row, std::string_view key) {
    const auto found = std::ranges::find(row.metrics, key, &std::pair<std::string, double>::first);
    return found == row.metrics.end() ? std::nullopt : std::optional(found->second);
}

/// Keys that some record has: those of the table of metrics in its order, then the others as they come.
std::vector<std::string> keys_of(const std::vector<RecordRow>& rows) {
    std::vector<std::string> keys;
    const auto add = [&](std::string_view key) {
        if (std::ranges::find(keys, key) == keys.end()) keys.emplace_back(key);
    };
    for (const MetricRow& metric : metric_rows())
        if (std::ranges::any_of(rows,
                                [&](const RecordRow& row) { return value_of(row, metric.key).has_value(); }))
            add(metric.key);
    for (const RecordRow& row : rows)
        for (const auto& [key, value] : row.metrics)
            add(key);
    return keys;
}

std::string cell_of(const RecordRow& row, const std::string& key) {
    const std::optional<double> value = value_of(row, key);
    return value ? readable(*value) : "-";
}

Table table_of(const std::vector<RecordRow>& rows, const std::vector<std::string>& keys, bool with_scene) {
    Table table;
    table.add_words({"record"});
    if (with_scene) table.add_words({"scene"});
    table.add_words({"fidelity", "status"});
    for (const std::string& key : keys)
        table.add_numbers({metric_words(key)}, split_metric_key(key).unit);
    table.add_numbers({"time"});
    for (const RecordRow& row : rows) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells = {row.place, row.fidelity, row.status};
        if (with_scene) cells.insert(cells.begin() + 1, row.scene);
        for (const std::string& key : keys)
            cells.emplace_back(cell_of(row, key));
        cells.emplace_back(time_text(row.wall_s));
    }
    return table;
}

}  // namespace

RecordRow record_row(const RunRecord& record, std::string place) {
    RecordRow row{std::move(place),
                  record.scene.name,
                  record.fidelity,
                  std::string(status_name(record.status.code)),
                  {},
                  record.cost.wall_s};
    for (const Metric& metric : record.metrics)
        if (std::isfinite(metric.value)) row.metrics.emplace_back(metric.key, metric.value);
    return row;
}

std::string records_terminal(const std::vector<RecordRow>& rows, const Style& style) {
    std::vector<std::string> keys;
    for (const std::string_view key : brief)
        if (std::ranges::any_of(rows, [&](const RecordRow& row) { return value_of(row, key).has_value(); }))
            keys.emplace_back(key);
    return terminal_table(table_of(rows, keys, false), style);
}

std::string records_markdown(const std::vector<RecordRow>& rows) {
    return fmt::format("# {} records\n\n{}\nA metric that a record lacks is '-'.\n", rows.size(),
                       markdown_table(table_of(rows, keys_of(rows), true)));
}

std::string records_csv(const std::vector<RecordRow>& rows) {
    const std::vector<std::string> keys = keys_of(rows);
    Table table;
    table.add_words({"record", "scene", "fidelity", "status"}, "-");
    for (const std::string& key : keys) {
        const auto [name, unit] = split_metric_key(key);
        table.add_words({name}, unit.empty() ? "1" : unit);
    }
    table.add_words({"wall_time"}, "s");
    for (const RecordRow& row : rows) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells = {clean_text(row.place), clean_text(row.scene), clean_text(row.fidelity), row.status};
        for (const std::string& key : keys)
            cells.emplace_back(exact(value_of(row, key)));
        cells.emplace_back(exact(row.wall_s));
    }
    return csv_table(table);
}

std::string records_json(const std::vector<RecordRow>& rows) {
    using Json = nlohmann::ordered_json;
    Json json{{"generator", "twinchute"}, {"schema", table_schema}};
    Json& records = json["records"] = Json::array();
    for (const RecordRow& row : rows) {
        Json record{
            {"record", row.place}, {"scene", row.scene}, {"fidelity", row.fidelity}, {"status", row.status}};
        record["metrics"] = Json::object();
        for (const auto& [key, value] : row.metrics)
            record["metrics"][key] = value;
        if (std::isfinite(row.wall_s)) record["wall_s"] = row.wall_s;
        records.push_back(std::move(record));
    }
    return json_text(json);
}

}  // namespace twinchute::compare
