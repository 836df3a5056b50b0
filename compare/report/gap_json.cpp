#include "compare/report/gap_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/report/attribution_json.hpp"
#include "compare/report/words.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::compare {
namespace {

using Json = nlohmann::ordered_json;

constexpr int gap_schema = 1;

/// Differences and quotients of values near the ends of what a double holds are not finite: JSON has no word
/// for that.
void put(Json& object, const char* key, const std::optional<double>& value) {
    if (value && std::isfinite(*value)) object[key] = *value;
}

Json metric_json(const MetricGap& metric) {
    Json json;
    json["name"] = metric.row->name;
    if (!metric.row->unit.empty()) json["unit"] = metric.row->unit;
    if (metric.reference) json["reference"] = metric.reference->value;
    if (metric.candidate) json["candidate"] = metric.candidate->value;
    put(json, "difference", metric.difference);
    put(json, "relative", metric.relative);
    if (metric.tolerance) {
        json["tolerance"] = {{"value", metric.tolerance->value},
                             {"relative", metric.tolerance->relative},
                             {"from", origin_name(metric.origin)}};
    }
    json["verdict"] = verdict_name(metric.verdict);
    Json& standing = json["input_or_result"] = Json::object();
    Json notes = Json::object();
    const auto side = [&](const char* name, const std::optional<SideValue>& value) {
        if (!value) return;
        standing[name] = metric_kind_name(value->kind);
        if (!value->note.empty()) notes[name] = value->note;
    };
    side("reference", metric.reference);
    side("candidate", metric.candidate);
    if (!notes.empty()) json["standing_notes"] = std::move(notes);
    if (!metric.note.empty()) json["note"] = metric.note;
    return json;
}

Json history_json(const HistoryGap& history) {
    Json json;
    json["channel"] = history.row->key;
    for (const PhaseScore& phase : history.phases) {
        Json& phases = phase.parachute.empty() ? json : json["parachutes"][phase.parachute];
        phases[std::string(phase_name(phase.phase))] = {{"from_s", phase.from},
                                                        {"to_s", phase.to},
                                                        {"relative_maximum", phase.maximum},
                                                        {"relative_l2", phase.l2},
                                                        {"relative_infinity", phase.infinity}};
    }
    put(json, "score", history.score);
    if (history.tolerance) {
        json["tolerance"] = history.tolerance->value;
        json["tolerance_from"] = origin_name(history.origin);
    }
    json["verdict"] = verdict_name(history.verdict);
    if (!history.note.empty()) json["note"] = history.note;
    return json;
}

Json side_json(const RunRecord& record, const std::string& title) {
    return {{"fidelity", record.fidelity},
            {"title", title},
            {"status", status_json(record.status)},
            {"left_out", left_out_json(record.left_out)},
            {"warnings", warnings_json(record.warnings)}};
}

Json calibration_json(const Comparison& comparison) {
    Json json{{"factors", Json::object()}, {"metrics", Json::object()}};
    for (const CalibratedInput& input : comparison.candidate.uncalibrated->inputs)
        json["factors"][input.key] = input.factor;
    for (const CalibrationGap& one : calibration_gaps(comparison)) {
        Json& metric = json["metrics"][std::string(one.row->key)] = Json::object();
        metric["before"] = one.before;
        put(metric, "relative_before", one.gap_before);
        put(metric, "relative_after", one.gap_after);
    }
    return json;
}

Json test_json(const Comparison& comparison) {
    Json json;
    json["file"] = comparison.test->file;
    if (!comparison.test->notes.empty()) json["notes"] = comparison.test->notes;
    Json& channels = json["channels"] = Json::object();
    for (const TestScore& score : scores_of_test(comparison)) {
        Json& channel = channels[std::string(score.row->key)];
        channel["largest"] = score.largest;
        channel["unit"] = score.row->unit;
        put(channel, "candidate", score.l2[0]);
        put(channel, "reference", score.l2[1]);
    }
    return json;
}

}  // namespace

std::string gap_json(const Comparison& comparison) {
    Json json;
    json["generator"] = "twinchute";
    json["schema"] = gap_schema;
    json["scene"] = scene_json(comparison.reference.scene);
    json["verdict"] = verdict_name(overall_verdict(comparison));
    json["exit_code"] = static_cast<int>(exit_code(comparison));
    json["summary"] = verdict_line(comparison);
    Json& metrics = json["metrics"] = Json::object();
    for (const MetricGap& metric : comparison.gap.metrics) {
        metrics[std::string(metric.row->key)] = metric_json(metric);
    }
    Json& histories = json["histories"] = Json::object();
    for (const HistoryGap& history : comparison.gap.histories)
        histories[std::string(history.row->name)] = history_json(history);
    if (comparison.candidate.uncalibrated) json["calibration"] = calibration_json(comparison);
    if (comparison.test) json["test"] = test_json(comparison);
    Json& cost = json["cost"] = Json::object();
    cost["reference"] = cost_json(comparison.reference.cost);
    cost["candidate"] = cost_json(comparison.candidate.cost);
    put(cost, "ratio", comparison.gap.cost_ratio);
    json["reference"] = side_json(comparison.reference, comparison.reference_title);
    json["candidate"] = side_json(comparison.candidate, comparison.candidate_title);
    if (comparison.attribution) json["attribution"] = attribution_json(*comparison.attribution);
    json["provenance"] = provenance_json(comparison.reference.provenance);
    return json_text(json);
}

}  // namespace twinchute::compare
