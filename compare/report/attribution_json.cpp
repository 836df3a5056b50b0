#include "compare/report/attribution_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "lib/record/checksum.hpp"
#include "lib/record/json_node.hpp"

namespace twinchute::compare {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* again = "run `twinchute compare --why` again, or remove the file";

/// Share of the largest of its numbers: an attribution adds up to round-off.
constexpr double round_off = 1e-9;

Json metric_json(const MetricAttribution& metric, const MetricRow& row) {
    Json json;
    json["name"] = metric.metric;
    if (!row.unit.empty()) json["unit"] = row.unit;
    json["candidate"] = metric.candidate;
    json["reference"] = metric.reference;
    Json& terms = json["terms"] = Json::array();
    for (const AttributionTerm& term : metric.terms) {
        Json one{{"name", term.name}, {"title", term.title}, {"effect", term.effect}};
        if (!term.detail.empty()) one["detail"] = term.detail;
        terms.push_back(std::move(one));
    }
    json["interaction"] = metric.interaction;
    if (metric.scatter) json["scatter"] = *metric.scatter;
    return json;
}

/// A number that has to be the record's own.
double same(const JsonNode& node, std::string_view key, const RunRecord& record) {
    const double value = node.number();
    if (record.metric(key) != value)
        node.refuse("is not what the record says", fmt::format("{} of {}", key, record.fidelity), again);
    return value;
}

void require_sum(const JsonNode& node, const MetricAttribution& metric) {
    double sum = metric.candidate + metric.interaction - metric.reference;
    double scale = std::abs(metric.candidate) + std::abs(metric.interaction) + std::abs(metric.reference);
    for (const AttributionTerm& term : metric.terms) {
        sum += term.effect;
        scale += std::abs(term.effect);
    }
    if (!(std::abs(sum) <= round_off * scale)) node.refuse("does not add up", "", again);
}

MetricAttribution read_metric(const JsonNode& node, std::string_view key, const MetricRow& row,
                              const Comparison& comparison) {
    MetricAttribution metric;
    metric.metric = row.name;
    metric.candidate = same(node.at("candidate"), key, comparison.candidate);
    metric.reference = same(node.at("reference"), key, comparison.reference);
    node.at("terms").each_row([&](const JsonNode& term) {
        const auto detail = term.find("detail"), name = term.find("name");
        metric.terms.push_back({name ? name->text() : term.text_at("piece"),  // of earlier versions
                                term.text_at("title"), term.at("effect").number(),
                                detail ? detail->text() : std::string()});
    });
    metric.interaction = node.at("interaction").number();
    if (const auto scatter = node.find("scatter")) metric.scatter = scatter->number();
    require_sum(node, metric);
    return metric;
}

}  // namespace

nlohmann::ordered_json attribution_json(const Attribution& attribution) {
    Json json;
    Json& metrics = json["metrics"] = Json::object();
    for (const MetricAttribution& metric : attribution.metrics)
        if (const MetricRow* row = find_metric_row(metric.metric))
            metrics[std::string(row->key)] = metric_json(metric, *row);
    json["seeds"] = attribution.seeds;
    json["notes"] = attribution.notes;
    return json;
}

std::optional<Attribution> read_attribution(std::string_view gap, const std::string& file,
                                            const Comparison& comparison) {
    const JsonDocument document(gap, file);
    const auto node = document.top().find("attribution");
    if (!node) return {};
    Attribution attribution;
    node->at("metrics").each_key([&](const std::string& key, const JsonNode& metric) {
        if (const MetricRow* row = find_metric_row(split_metric_key(key).name); row && row->key == key)
            attribution.metrics.push_back(read_metric(metric, key, *row, comparison));
    });
    node->at("seeds").each_row(
        [&](const JsonNode& seed) { attribution.seeds.push_back(static_cast<std::uint64_t>(seed.count())); });
    node->at("notes").each_row([&](const JsonNode& note) { attribution.notes.push_back(note.text()); });
    if (const auto sum = document.top().find("sha256")) require_own_checksum(gap, sum->text(), file, again);
    return attribution;
}

}  // namespace twinchute::compare
