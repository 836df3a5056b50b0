#include "lib/record/record_json.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

using Json = nlohmann::ordered_json;

/// Sets a key unless the value is not finite: JSON has no NaN, and null would read as "left out".
bool put(Json& object, const std::string& key, double value) {
    if (!std::isfinite(value)) return false;
    object[key] = value;
    return true;
}

/// An object with space for so many members: one that grows copies all that is in it, and that was a fifth of
/// a request for a run of the reduced-order model.
Json object_of(std::size_t members) {
    Json json = Json::object();
    json.get_ref<Json::object_t&>().reserve(members);
    return json;
}

/// Adds a member whose key is not there yet, without a look at those that are.
void add(Json& json, const std::string& key, Json&& value) {
    json.get_ref<Json::object_t&>().push_back({key, std::move(value)});
}

Json metrics_json(const std::vector<Metric>& metrics) {
    Json json = object_of(metrics.size());
    for (const Metric& metric : metrics)
        put(json, metric.key, metric.value);
    return json;
}

/// Takes out the metrics that cannot be written; a warning says so, and they are missing.
void leave_out_not_finite(std::vector<Metric>& metrics, std::vector<MissingMetric>& missing,
                          std::vector<Warning>& warnings) {
    std::erase_if(metrics, [&](const Metric& metric) {
        if (std::isfinite(metric.value)) return false;
        missing.push_back({metric.key, "its value is not a finite number"});
        warnings.push_back({metric.key + " is left out of this record", "its value is not a finite number",
                            "look at the status and the last rows of history.csv"});
        return true;
    });
}

/// Replaces a value that is not finite by NaN, or by 0 where zero is not written either.
void tell(double& value, double instead = std::numeric_limits<double>::quiet_NaN()) {
    if (!std::isfinite(value)) value = instead;
}

/// As it stands in a JSON text: bytes that are not UTF-8 are replaced.
void tell(std::string& text) {
    text = Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

Json standing_json(const std::vector<Metric>& metrics) {
    Json json = object_of(metrics.size());
    for (const Metric& metric : metrics) {
        Json row = object_of(2);
        row["input_or_result"] = metric_kind_name(metric.kind);
        if (!metric.note.empty()) row["note"] = metric.note;
        add(json, metric.key, std::move(row));
    }
    return json;
}

Json energy_json(const EnergyLedger& energy) {
    Json json = Json::object();
    for (const EnergyTerm& row : energy_terms)
        if (energy.*row.term != 0.0 || !row.zero_is_absent) put(json, row.key, energy.*row.term);
    return json;
}

}  // namespace

nlohmann::ordered_json scene_json(const SceneId& scene) {
    Json json{{"name", scene.name}, {"file", scene.file}, {"sha256", scene.sha256}};
    if (!scene.digest.empty()) json["digest"] = scene.digest;
    return json;
}

nlohmann::ordered_json inputs_json(const std::vector<Input>& inputs) {
    Json json = object_of(inputs.size());
    for (const Input& input : inputs) {
        Json row = object_of(4);
        if (const auto* number = std::get_if<double>(&input.value)) {
            put(row, "value", *number);
        } else {
            row["value"] = std::get<std::string>(input.value);
        }
        if (!input.unit.empty()) row["unit"] = input.unit;
        row["origin"] = origin_name(input.origin);
        if (!input.source.empty()) row["source"] = input.source;
        add(json, input.key, std::move(row));
    }
    return json;
}

nlohmann::ordered_json status_json(const RunStatus& status) {
    return {{"code", status_name(status.code)}, {"detail", status.detail}};
}

nlohmann::ordered_json cost_json(const Cost& cost) {
    Json json = Json::object();
    put(json, "wall_s", cost.wall_s);
    put(json, "cpu_s", cost.cpu_s);
    json["steps"] = cost.steps;
    json["rhs_calls"] = cost.rhs_calls;
    json["rejected_steps"] = cost.rejected_steps;
    put(json, "dt_min_s", cost.dt_min_s);
    put(json, "dt_max_s", cost.dt_max_s);
    if (cost.element_steps > 0) {
        json["element_steps"] = cost.element_steps;
        put(json, "ns_per_element_step", cost.ns_per_element_step);
    }
    if (!cost.blocks.empty()) {
        Json& blocks = json["blocks"] = Json::object();
        for (const BlockCost& block : cost.blocks)
            put(blocks, block.name, block.seconds);
    }
    for (const double time : cost.resumed_at)
        json["resumed_at_s"].push_back(time);
    return json;
}

/// Absent where there are none: most records have none. A formula without a finite value is not written.
void put_estimates(Json& json, const std::vector<Estimate>& estimates) {
    for (const Estimate& estimate : estimates) {
        Json row{{"name", estimate.name}, {"title", estimate.title}, {"metric", estimate.metric}};
        if (!put(row, "value", estimate.value)) continue;
        row["source"] = estimate.source;
        if (!estimate.outside.empty()) row["outside"] = estimate.outside;
        json["estimates"].push_back(std::move(row));
    }
}

Json filling_json(const PredictedFilling& filling) {
    const auto put_known = [](Json& to, const char* key, const std::optional<double>& value) {
        if (value) put(to, key, *value);
    };
    Json json{{"model", filling.model},
              {"initial_mouth", filling.initial_mouth},
              {"entrance_loss", filling.entrance_loss}};
    put_known(json, "critical_speed_m_s", filling.critical_speed);
    json["bracket"] = Json::array();
    for (const PredictedFilling::At& at : filling.bracket) {
        Json row{{"initial_mouth", at.initial_mouth}, {"status", at.status}};
        put_known(row, "filling_time_s", at.filling_time);
        put_known(row, "fill_constant", at.fill_constant);
        put_known(row, "peak_force_N", at.peak_force);
        json["bracket"].push_back(std::move(row));
    }
    return json;
}

Json uncalibrated_json(const Uncalibrated& without) {
    Json json{{"factors", Json::object()}, {"without", Json::object()}};
    for (const CalibratedInput& input : without.inputs)
        json["factors"][input.key] = input.factor;
    for (const Metric& metric : without.metrics)
        put(json["without"], metric.key, metric.value);
    return json;
}

nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings) {
    Json json = Json::array();
    for (const Warning& warning : warnings) {
        json.push_back({{"what", warning.what}, {"why", warning.why}, {"suggestion", warning.suggestion}});
    }
    return json;
}

nlohmann::ordered_json left_out_json(const std::vector<LeftOut>& left_out) {
    Json json = Json::array();
    for (const LeftOut& row : left_out)
        json.push_back({{"what", row.what}, {"why", row.why}});
    return json;
}

nlohmann::ordered_json provenance_json(const Provenance& provenance) {
    return {{"version", provenance.version},
            {"commit", provenance.commit},
            {"compiler", provenance.compiler},
            {"flags", provenance.flags},
            {"instruction_set", provenance.instruction_set},
            {"host_cpu", provenance.host_cpu},
            {"date", provenance.date},
            {"threads", provenance.threads}};
}

std::string summary_json(const RunRecord& record, const FileChecksums& files, CsvHead head) {
    std::vector<Metric> metrics = record.metrics;
    std::vector<MissingMetric> missing = record.missing;
    std::vector<Warning> warnings = record.warnings;
    leave_out_not_finite(metrics, missing, warnings);
    Json json = object_of(24);
    json["generator"] = "twinchute";
    json["schema"] = RunRecord::schema;
    json["scene"] = scene_json(record.scene);
    json["inputs"] = inputs_json(record.inputs);
    json["fidelity"] = record.fidelity;
    json["status"] = status_json(record.status);
    json["metrics"] = metrics_json(metrics);
    json["standing"] = standing_json(metrics);
    for (const MissingMetric& row : missing)
        json["missing"].push_back(
            {{"metric", row.metric}, {"why", row.why}, {"not_reached", row.not_reached}});
    if (record.energy) json["energy"] = energy_json(*record.energy);
    json["cost"] = cost_json(record.cost);
    put_estimates(json, record.estimates);
    if (record.filling) json["filling"] = filling_json(*record.filling);
    if (record.uncalibrated) json["calibration"] = uncalibrated_json(*record.uncalibrated);
    if (record.handed_over)
        json["handed_over"] = {{"to", record.handed_over->to},
                               {"time_s", record.handed_over->time},
                               {"metrics", record.handed_over->metrics}};
    json["warnings"] = warnings_json(warnings);
    json["left_out"] = left_out_json(record.left_out);
    json["provenance"] = provenance_json(record.provenance);
    if (head == CsvHead::names) {
        json["history_units"] = Json::object();
        for (const Channel& channel : record.channels)
            json["history_units"][channel.name] = unit_field(channel.unit);
    }
    if (!files.empty()) json["files"] = files;
    return json_text(json);
}

RunRecord as_written(RunRecord record) {
    leave_out_not_finite(record.metrics, record.missing, record.warnings);
    for (Input& input : record.inputs)
        if (auto* number = std::get_if<double>(&input.value)) tell(*number);
    if (record.energy)
        for (const EnergyTerm& row : energy_terms)
            tell(*record.energy.*row.term, row.absent());
    std::erase_if(record.estimates, [](const Estimate& estimate) { return !std::isfinite(estimate.value); });
    Cost& cost = record.cost;
    for (double* value :
         {&cost.wall_s, &cost.cpu_s, &cost.dt_min_s, &cost.dt_max_s, &cost.ns_per_element_step})
        tell(*value);
    if (cost.element_steps <= 0) cost.ns_per_element_step = 0.0;
    std::erase_if(cost.blocks, [](const BlockCost& block) { return !std::isfinite(block.seconds); });
    for (std::string* text : {&record.scene.name, &record.scene.file, &record.status.detail})
        tell(*text);
    for (Channel& channel : record.channels)
        for (double& value : channel.values)
            tell(value);
    for (Event& event : record.events)
        for (double* value : {&event.time, &event.altitude, &event.speed})
            tell(*value);
    return record;
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace twinchute
