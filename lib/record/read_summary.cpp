// summary.json back into a record.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "lib/record/json_node.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::vector<Metric> read_metrics(const JsonNode& values, const JsonNode& standings) {
    std::vector<Metric> metrics;
    values.each_key([&](const std::string& key, const JsonNode& value) {
        Metric metric{key, value.number(), MetricKind::result, ""};
        const JsonNode row = standings.at(key);
        metric.kind = json_word(row.at("input_or_result"), metric_kind_name);
        if (const auto note = row.find("note")) metric.note = note->text();
        metrics.push_back(std::move(metric));
    });
    return metrics;
}

EnergyLedger read_energy(const JsonNode& node) {
    EnergyLedger energy;
    for (const EnergyTerm& row : energy_terms)
        energy.*row.term = node.number_at(row.key, row.absent());
    return energy;
}

Cost read_cost(const JsonNode& node) {
    Cost cost;
    cost.wall_s = node.number_at("wall_s", not_a_number);
    cost.cpu_s = node.number_at("cpu_s", not_a_number);
    cost.steps = node.at("steps").count();
    cost.rhs_calls = node.at("rhs_calls").count();
    cost.rejected_steps = node.at("rejected_steps").count();
    cost.dt_min_s = node.number_at("dt_min_s", not_a_number);
    cost.dt_max_s = node.number_at("dt_max_s", not_a_number);
    if (const auto steps = node.find("element_steps")) {
        cost.element_steps = steps->count();
        cost.ns_per_element_step = node.number_at("ns_per_element_step", not_a_number);
    }
    if (const auto blocks = node.find("blocks")) {
        blocks->each_key([&](const std::string& name, const JsonNode& seconds) {
            cost.blocks.push_back({name, seconds.number()});
        });
    }
    if (const auto times = node.find("resumed_at_s"))
        times->each_row([&](const JsonNode& time) { cost.resumed_at.push_back(time.number()); });
    return cost;
}

PredictedFilling read_filling(const JsonNode& node) {
    const auto known = [](const JsonNode& from, const char* key) {
        const auto found = from.find(key);
        return found ? std::optional(found->number()) : std::nullopt;
    };
    PredictedFilling filling;
    filling.model = node.text_at("model");
    filling.initial_mouth = node.at("initial_mouth").number();
    filling.entrance_loss = node.at("entrance_loss").number();
    filling.critical_speed = known(node, "critical_speed_m_s");
    node.at("bracket").each_row([&](const JsonNode& row) {
        filling.bracket.push_back({row.at("initial_mouth").number(), row.text_at("status"),
                                   known(row, "filling_time_s"), known(row, "fill_constant"),
                                   known(row, "peak_force_N")});
    });
    return filling;
}

Uncalibrated read_uncalibrated(const JsonNode& node) {
    Uncalibrated without;
    node.at("factors").each_key([&](const std::string& key, const JsonNode& factor) {
        without.inputs.push_back({key, factor.number()});
    });
    node.at("without").each_key([&](const std::string& key, const JsonNode& value) {
        without.metrics.push_back({key, value.number(), MetricKind::result, {}});
    });
    return without;
}

HandOver read_hand_over(const JsonNode& node) {
    HandOver made{node.text_at("to"), node.at("time_s").number(), {}};
    node.at("metrics").each_row([&](const JsonNode& key) { made.metrics.push_back(key.text()); });
    return made;
}

/// Names of files in the record's own directory: nothing else is ever looked at.
FileChecksums read_checksums(const JsonNode& node) {
    FileChecksums checksums;
    node.each_key([&](const std::string& name, const JsonNode& checksum) {
        constexpr std::string_view plain =
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
        if (name.empty() || name.starts_with('.') || name.size() > 100 ||
            name.find_first_not_of(plain) != name.npos)
            node.refuse(fmt::format("'{}' is not the name of a file of a record", shown(name)), "");
        checksums[name] = checksum.text();
    });
    return checksums;
}

}  // namespace

std::vector<Input> read_inputs(const JsonNode& node) {
    std::vector<Input> inputs;
    node.each_key([&](const std::string& key, const JsonNode& row) {
        Input input{key, not_a_number, "", InputOrigin::given, ""};
        if (const auto value = row.find("value")) {
            if (value->is_text())
                input.value = value->text();
            else
                input.value = value->number();
        }
        if (const auto unit = row.find("unit")) input.unit = unit->text();
        input.origin = json_word(row.at("origin"), origin_name);
        if (const auto source = row.find("source")) input.source = source->text();
        inputs.push_back(std::move(input));
    });
    return inputs;
}

Provenance read_provenance(const JsonNode& node) {
    Provenance made;
    made.version = node.text_at("version");
    made.commit = node.text_at("commit");
    made.compiler = node.text_at("compiler");
    made.flags = node.text_at("flags");
    made.instruction_set = node.text_at("instruction_set");
    made.host_cpu = node.text_at("host_cpu");
    made.date = node.text_at("date");
    made.threads = static_cast<int>(node.at("threads").count(std::numeric_limits<int>::max()));
    return made;
}

SceneId read_scene_id(const JsonNode& node) {
    const auto digest = node.find("digest");
    return {node.text_at("name"), node.text_at("file"), node.text_at("sha256"), digest ? digest->text() : ""};
}

void require_schema(const JsonNode& top, std::string_view what, std::int64_t known) {
    const auto generator = top.find("generator");
    if (!generator || !generator->is_text() || generator->text() != "twinchute")
        throw RecordError({top.file()}, fmt::format("is not of a {} of twinchute", what),
                          "its generator is another one", "name a directory that twinchute wrote");
    const std::int64_t schema = top.at("schema").count();
    if (schema != known)
        top.at("schema").refuse(fmt::format("{} is not known", schema),
                                fmt::format("this version reads {}", known),
                                "read it with the version that wrote it");
}

RunRecord read_summary(std::string_view text, const std::string& file, FilesBeside& beside) {
    const JsonDocument document(text, file);
    const JsonNode top = document.top();
    require_schema(top, "record", RunRecord::schema);
    RunRecord record;
    const JsonNode status = top.at("status");
    record.scene = read_scene_id(top.at("scene"));
    record.inputs = read_inputs(top.at("inputs"));
    record.fidelity = top.text_at("fidelity");
    record.status = {json_word(status.at("code"), status_name), status.text_at("detail")};
    record.metrics = read_metrics(top.at("metrics"), top.at("standing"));
    if (const auto missing = top.find("missing"))
        missing->each_row([&](const JsonNode& row) {
            record.missing.push_back(
                {row.text_at("metric"), row.text_at("why"), row.at("not_reached").truth()});
        });
    if (const auto energy = top.find("energy")) record.energy = read_energy(*energy);
    record.cost = read_cost(top.at("cost"));
    if (const auto estimates = top.find("estimates"))
        estimates->each_row([&](const JsonNode& row) {
            const auto outside = row.find("outside");
            record.estimates.push_back({row.text_at("name"), row.text_at("title"), row.text_at("metric"),
                                        row.at("value").number(), row.text_at("source"),
                                        outside ? outside->text() : std::string()});
        });
    if (const auto filling = top.find("filling")) record.filling = read_filling(*filling);
    if (const auto calibration = top.find("calibration"))
        record.uncalibrated = read_uncalibrated(*calibration);
    if (const auto handed_over = top.find("handed_over")) record.handed_over = read_hand_over(*handed_over);
    top.at("warnings").each_row([&](const JsonNode& row) {
        record.warnings.push_back({row.text_at("what"), row.text_at("why"), row.text_at("suggestion")});
    });
    top.at("left_out").each_row([&](const JsonNode& row) {
        record.left_out.push_back({row.text_at("what"), row.text_at("why")});
    });
    record.provenance = read_provenance(top.at("provenance"));
    if (const auto units = top.find("history_units")) {
        beside.history_units.emplace();
        units->each_key([&](const std::string& column, const JsonNode& unit) {
            (*beside.history_units)[column] = unit.text();
        });
    }
    if (const auto files = top.find("files")) beside.checksums = read_checksums(*files);
    // Last: what is wrong in it is said with its key; only then, that it is another one.
    if (const auto checksum = top.find("sha256")) require_own_checksum(text, checksum->text(), file);
    return record;
}

}  // namespace twinchute
