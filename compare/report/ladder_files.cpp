#include "compare/report/ladder_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lib/record/checksum.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::compare {
namespace {

using Json = nlohmann::ordered_json;

std::optional<double> gap_to(const LevelMetric& metric, std::string_view fidelity) {
    for (const LadderGap& gap : metric.gaps)
        if (gap.to == fidelity) return gap.value;
    return {};
}

const LadderReference* reference_for(const Ladder& ladder, const LevelResult& result, const MetricRow* row) {
    if (result.level.physics == Physics::other) return nullptr;
    for (const LadderReference& reference : ladder.references)
        if (reference.fidelity == result.level.fidelity && reference.row == row) return &reference;
    return nullptr;
}

Json worst_json(const Worst& worst) {
    return {{"value", worst.value}, {"metric", worst.metric}};
}

Json metric_json(const LevelMetric& metric) {
    Json json;
    json["value"] = metric.value;
    if (!metric.row->unit.empty()) json["unit"] = metric.row->unit;
    json["input_or_result"] = metric_kind_name(metric.kind);
    if (metric.low != metric.high) json["range"] = {metric.low, metric.high};
    if (metric.error) json["error"] = *metric.error;
    if (metric.estimate) json["error_estimate"] = *metric.estimate;
    for (const LadderGap& gap : metric.gaps)
        json["gap"][std::string(gap.to)] = gap.value;
    if (metric.effect) json["effect"] = *metric.effect;
    if (metric.to_test) json["distance_to_test"] = *metric.to_test;
    return json;
}

Json level_json(const LevelResult& result) {
    const Level& level = result.level;
    Json json;
    json["name"] = level.name;
    json["label"] = level.label;
    json["family"] = level.family;
    json["why"] = level.why;
    if (!level.fidelity.empty()) json["fidelity"] = level.fidelity;
    json["setting"] = result.setting;
    json["as_given"] = level.given;
    json["physics"] = level.physics == Physics::same ? "same" : "other";
    json["status"] = result.was_run ? status_json(result.status)
                                    : Json{{"code", "not_run"}, {"detail", result.status.detail}};
    if (result.was_run) {
        json["runs"] = result.runs;
        json["seeds"] = result.seeds;
        json["wall_s"] = result.wall_s;
        json["steps"] = result.steps;
        json["rhs_calls"] = result.rhs_calls;
    }
    if (result.error) json["error"] = worst_json(*result.error);
    if (result.estimate) json["error_estimate"] = worst_json(*result.estimate);
    for (const auto& [to, worst] : result.gaps)
        json["gap"][std::string(to)] = worst_json(worst);
    if (result.effect) json["effect"] = worst_json(*result.effect);
    if (result.to_test) json["distance_to_test"] = worst_json(*result.to_test);
    json["is_reference"] = result.is_reference;
    json["on_pareto_front"] = result.on_front;
    Json& metrics = json["metrics"] = Json::object();
    for (const LevelMetric& metric : result.metrics)
        metrics[std::string(metric.row->key)] = metric_json(metric);
    return json;
}

}  // namespace

std::string ladder_csv(const Ladder& ladder) {
    Table table;
    table.add_words({"level", "family", "fidelity", "physics", "setting", "status"}, "-");
    table.add_words({"runs", "seeds"}, "1");
    table.add_words({"wall_time"}, "s");
    table.add_words({"steps", "rhs_calls"}, "1");
    table.add_words({"on_pareto_front", "metric", "unit", "input_or_result"}, "-");
    table.add_words({"value", "low", "high", "reference"}, "see unit");
    table.add_words({"error", "error_estimate"}, "1");
    for (const std::string_view fidelity : ladder.fidelities)
        table.add_words({fmt::format("gap_to_{}", fidelity)}, "1");
    table.add_words({"effect_of_leaving_out"}, "1");
    if (ladder.test) table.add_words({"distance_to_test"}, "1");
    for (const LevelResult& result : ladder.levels) {
        const Level& level = result.level;
        const bool run = result.was_run;
        const auto counted = [&](const auto& value) { return run ? fmt::format("{}", value) : ""; };
        const std::vector<Cell> front{level.name,
                                      level.family,
                                      level.fidelity,
                                      level.physics == Physics::same ? "same" : "other",
                                      result.setting,
                                      run ? status_name(result.status.code) : "not_run",
                                      counted(result.runs),
                                      counted(result.seeds),
                                      counted(result.wall_s),
                                      counted(result.steps),
                                      counted(result.rhs_calls),
                                      result.on_front ? "yes" : "no"};
        if (result.metrics.empty()) table.rows.emplace_back(front).resize(table.columns.size());
        for (const LevelMetric& metric : result.metrics) {
            const LadderReference* reference = reference_for(ladder, result, metric.row);
            std::vector<Cell>& cells = table.rows.emplace_back(front);
            cells.insert(cells.end(), {metric.row->name, metric.row->unit.empty() ? "1" : metric.row->unit,
                                       metric_kind_name(metric.kind), fmt::format("{}", metric.value),
                                       fmt::format("{}", metric.low), fmt::format("{}", metric.high),
                                       reference ? exact(reference->value) : "", exact(metric.error),
                                       exact(metric.estimate)});
            for (const std::string_view fidelity : ladder.fidelities)
                cells.emplace_back(exact(gap_to(metric, fidelity)));
            cells.emplace_back(exact(metric.effect));
            if (ladder.test) cells.emplace_back(exact(metric.to_test));
        }
    }
    return csv_table(table);
}

std::string ladder_json(const Ladder& ladder) {
    Json json;
    json["generator"] = "twinchute";
    json["schema"] = Ladder::schema;
    json["scene"] = scene_json(ladder.scene);
    json["inputs"] = inputs_json(ladder.inputs);
    json["exit_code"] = static_cast<int>(exit_code(ladder));
    json["quick"] = ladder.quick;
    json["threads"] = ladder.threads;
    json["judged"] = ladder.judged;
    json["advice"] = advice(ladder);
    if (ladder.gap) json["gap_between_fidelities"] = worst_json(*ladder.gap);
    Json& references = json["references"] = Json::object();
    for (const std::string_view fidelity : ladder.fidelities)
        references[std::string(fidelity)] = Json::object();
    for (const LadderReference& reference : ladder.references) {
        Json& row = references[std::string(reference.fidelity)][std::string(reference.row->key)];
        row["value"] = reference.value;
        row["how"] = reference.how;
        row["input_or_result"] = metric_kind_name(reference.kind);
    }
    if (ladder.test) {
        Json& test = json["test"];
        test["file"] = ladder.test->file;
        for (const TestValue& measured : ladder.test->values)
            test["values"][std::string(measured.row->key)] = measured.value;
    }
    Json& levels = json["rungs"] = Json::array();
    for (const LevelResult& result : ladder.levels)
        levels.push_back(level_json(result));
    json["provenance"] = provenance_json(ladder.provenance);
    return json_text(json);
}

void add_ladder(FileBatch& batch, const Ladder& ladder, const std::filesystem::path& directory) {
    batch.add(directory / "ladder.svg", ladder_svg(ladder));
    batch.add(directory / "ladder.md", ladder_markdown(ladder));
    batch.add(directory / "ladder.csv", ladder_csv(ladder));
    batch.add(directory / "ladder.json", with_checksum(ladder_json(ladder)), FileBatch::Kind::marker);
}

}  // namespace twinchute::compare
