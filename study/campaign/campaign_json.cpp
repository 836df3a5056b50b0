#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/record/record_json.hpp"
#include "study/campaign/campaign_files.hpp"

namespace twinchute::study {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json interval_json(const Interval& value) {
    return {{"estimate", number(value.estimate)}, {"interval_95", {number(value.low), number(value.high)}}};
}

ordered_json rare_json(const RareEvent& event, const CampaignSpec& spec) {
    ordered_json json{{"simulations", simulations},
                      {"levels", event.levels},
                      {"failed", event.failed},
                      {"direct", interval_json(event.direct)},
                      {"inputs", ordered_json::object()}};
    for (std::size_t i = 0; i < event.inputs.size(); ++i)
        json["inputs"][spec.inputs[i].key] = number(event.inputs[i]);
    return json;
}

ordered_json answer_json(const Answer& answer, const CampaignSpec& campaign) {
    const AnswerSpec& spec = *answer.spec;
    constexpr const char* kinds[] = {"probability", "quantile", "mean", "ellipse"};
    ordered_json json = interval_json(answer.value);
    json["name"] = spec.name;
    json["kind"] = kinds[static_cast<std::size_t>(spec.kind)];
    json["asked"] = spec.asked;
    json["unit"] = spec.kind == AnswerSpec::Kind::probability ? "" : spec.unit;
    json["method"] = answer.method;
    json["runs"] = answer.count;
    if (answer.rare)
        json["rare"] = rare_json(*answer.rare, campaign);
    else if (spec.kind == AnswerSpec::Kind::probability)
        json["hits"] = answer.hits;
    if (spec.level > 0.0) json["level"] = spec.level;
    if (answer.ellipse) {
        const Ellipse& e = *answer.ellipse;
        json["ellipse"] = {{"east_m", interval_json(e.centre_x)},    {"north_m", interval_json(e.centre_y)},
                           {"major_m", interval_json(e.major)},      {"minor_m", interval_json(e.minor)},
                           {"angle_rad_from_east", number(e.angle)}, {"share_inside", number(e.inside)}};
    }
    if (spec.limit) json["limit"] = *spec.limit;
    json["verdict"] = verdict_name(answer.verdict);
    if (!answer.note.empty()) json["note"] = answer.note;
    return json;
}

ordered_json indices_json(const Campaign& campaign) {
    ordered_json all = ordered_json::object();
    for (const MetricIndices& indices : campaign.results.indices) {
        ordered_json& of = all[indices.metric] = ordered_json::object();
        for (std::size_t i = 0; i < indices.of.size(); ++i) {
            ordered_json& one = of[campaign.spec.inputs[i].key] = ordered_json::object();
            if (indices.of[i].first) one["first_order"] = interval_json(*indices.of[i].first);
            if (indices.of[i].total) one["total"] = interval_json(*indices.of[i].total);
        }
    }
    return all;
}

ordered_json failures_json(const Endings& endings) {
    ordered_json json = ordered_json::object();
    for (const auto& [status, failed] : endings.failed)
        json[status] = {{"runs", failed.count}, {"first", failed.first}};
    return json;
}

ordered_json both_json(const MultiFidelity& both, const std::string& engine) {
    ordered_json json{{"pairs", both.pairs},
                      {"pilot", both.pilot},
                      {"engine", engine},
                      {"cost_ratio", number(both.cost_ratio)},
                      {"complete", both.endings.complete},
                      {"failures", failures_json(both.endings)},
                      {"answers", ordered_json::array()}};
    for (const PairedAnswer& a : both.answers) {
        ordered_json one = interval_json(a.value);
        one["name"] = a.spec->name;
        one["method"] = a.method;
        one["rom_alone"] = number(a.cheap);
        one["full_alone"] = interval_json(a.dear_alone);
        one["correlation"] = number(a.correlation);
        one["gain"] = interval_json(a.gain);
        if (a.spec->kind == AnswerSpec::Kind::mean)
            one["best_rom_runs"] = number(best_cheap_runs(a.correlation, both.cost_ratio));
        one["verdict"] = verdict_name(a.verdict);
        if (!a.note.empty()) one["note"] = a.note;
        json["answers"].push_back(std::move(one));
    }
    return json;
}

}  // namespace

std::string campaign_json(const Campaign& campaign) {
    const CampaignSpec& spec = campaign.spec;
    const CampaignResults& r = campaign.results;
    const Scene& scene = campaign.sampler->nominal();
    ordered_json json{{"schema", 1}, {"generator", "twinchute"}};
    json["campaign"] = {{"name", spec.name},
                        {"file", spec.file.filename().string()},
                        {"sha256", spec.sha256},
                        {"base", spec.base},
                        {"scene", scene.name},
                        {"design", design_name(spec.design)},
                        {"fidelity", fidelity_name(spec.fidelity)},
                        {"seed", spec.seed}};
    json["inputs"] = ordered_json::array();
    for (const CampaignInput& input : spec.inputs)
        json["inputs"].push_back(
            {{"key", input.key},
             {"unit", input.unit},
             {"distribution", input.distribution ? input.distribution->shown() : "points"},
             {"source", input.source},
             {"grade", input.grade}});
    json["runs"] = {{"wanted", r.wanted}, {"made", r.made}, {"complete", r.endings.complete}};
    json["status"] = campaign.interrupted ? "interrupted" : r.made < r.wanted ? "incomplete" : "complete";
    json["failures"] = failures_json(r.endings);
    json["answers"] = ordered_json::array();
    for (const Answer& answer : r.answers)
        json["answers"].push_back(answer_json(answer, spec));
    json["sensitivity"] = indices_json(campaign);
    if (campaign.both) json["both"] = both_json(*campaign.both, campaign.of[1].engine);
    json["engine"] = campaign.of.front().engine;
    json["cost"] = {{"wall_s", campaign.seconds}, {"threads", campaign.threads}};
    json["provenance"] = provenance_json(current_provenance());
    return json_text(json);
}

}  // namespace twinchute::study
