#include "study/size/size_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/cli/record_text.hpp"
#include "lib/record/display_units.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/scene_id.hpp"

namespace twinchute::study {
namespace {

using compare::Table;
using compare::Tone;
using nlohmann::ordered_json;
using rom::Candidate;
using rom::Found;
using rom::Judged;
using rom::Met;
using rom::Sized;
using rom::VaryRow;

/// Columns of the trade table: metrics of the record, that of one canopy where several pull at once.
std::vector<const char*> traded_of(const Sized& sized) {
    std::vector<const char*> metrics{"descent_rate_m_s", "max_force_N",    "max_deceleration_g",
                                     "snatch_force_N",   "filling_time_s", "altitude_loss_m"};
    constexpr const char* of_one = "max_canopy_force_N";
    if (std::ranges::any_of(sized.candidates, [](const Candidate& c) {
            return c.found && c.found->judged.record.find_metric(of_one) != nullptr;
        }))
        metrics.insert(metrics.begin() + 2, of_one);
    return metrics;
}

compare::Cell verdict(const Candidate& candidate) {
    if (!candidate.found) return "not sized";
    const Judged& judged = candidate.found->judged;
    if (!judged.why_not.empty()) return {"no: " + judged.why_not, Tone::bad};
    if (judged.meets()) return {"yes", Tone::good};
    const Met* worst = judged.binding();
    return {fmt::format("no: {} {:.3g} % over", worst->row->title, 100.0 * (worst->share() - 1.0)),
            Tone::bad};
}

ordered_json limit_json(const Met& met) {
    return {{"name", met.row->name}, {"unit", met.row->unit}, {"value", met.value},
            {"limit", met.limit},    {"used", met.share()},   {"met", met.share() <= 1.0}};
}

ordered_json candidate_json(const Sized& sized, const Candidate& candidate) {
    ordered_json json = ordered_json::object();
    if (!candidate.type.empty()) json["type"] = candidate.type;
    json["meets"] = candidate.meets();
    json["best"] = &candidate == sized.best();
    if (!candidate.notes.empty()) json["notes"] = candidate.notes;
    if (!candidate.found) {
        json["why_not"] = candidate.why_not;
        return json;
    }
    const Found& found = *candidate.found;
    if (!found.judged.why_not.empty()) json["why_not"] = found.judged.why_not;
    for (const VaryRow* row : sized.vary)
        json["varied"][row->name] = {{"value", row->get(found.scene)}, {"unit", row->unit}};
    json["parachute_mass_kg"] = candidate.mass();
    json["drag_area_m2"] = rom::sized_parachute(found.scene).drag_area;
    ordered_json limits = ordered_json::array(), estimates = limits;
    for (const Met& met : found.judged.limits)
        limits.push_back(limit_json(met));
    json["limits"] = std::move(limits);
    ordered_json metrics = ordered_json::object();
    for (const Metric& metric : found.judged.record.metrics)
        metrics[metric.key] = metric.value;
    json["metrics"] = std::move(metrics);
    for (const Estimate& estimate : found.judged.record.estimates) {
        ordered_json row{{"name", estimate.name}, {"metric", estimate.metric}, {"value", estimate.value}};
        if (!estimate.outside.empty()) row["outside"] = estimate.outside;
        estimates.push_back(std::move(row));
    }
    json["estimates"] = std::move(estimates);
    return json;
}

}  // namespace

std::string type_text(const Candidate& candidate) {
    return candidate.type.empty() ? "as in the scene" : candidate.type;
}

Table trade_table(const Sized& sized) {
    Table table;
    table.add_words({"canopy"});
    const std::vector<const char*> traded = traded_of(sized);
    for (const VaryRow* row : sized.vary)
        table.add_numbers({row->name}, shown_unit(row->unit));
    for (const char* metric : traded)
        table.add_numbers({metric_words(metric)}, shown_unit(split_metric_key(metric).unit));
    table.add_numbers({"mass, estimated"}, shown_unit("kg"));
    table.add_words({"meets the limits"});
    for (const Candidate& candidate : sized.candidates) {
        std::vector<compare::Cell>& cells = table.rows.emplace_back();
        cells.emplace_back(type_text(candidate));
        for (const VaryRow* row : sized.vary)
            cells.emplace_back(
                candidate.found ? readable(shown(row->get(candidate.found->scene), row->unit).value) : "-");
        for (const char* metric : traded) {
            const auto value = candidate.found ? candidate.found->judged.record.metric(metric) : std::nullopt;
            cells.emplace_back(value ? readable(shown(*value, split_metric_key(metric).unit).value) : "-");
        }
        cells.emplace_back(candidate.found ? readable(shown(candidate.mass(), "kg").value, 3) : "-");
        cells.push_back(verdict(candidate));
    }
    return table;
}

Table limits_table(const Judged& judged) {
    Table table;
    table.add_words({"limit"});
    table.add_numbers({"value"});
    table.add_words({"unit"});
    table.add_numbers({"used"});
    table.add_words({"allowed"});
    for (const Met& met : judged.limits) {
        const double over = 100.0 * (met.share() - 1.0);
        table.rows.push_back({met.row->title, readable(shown(met.value, met.row->unit).value),
                              shown_unit(met.row->unit), fmt::format("{:.1f} %", 100.0 * met.share()),
                              fmt::format("of {}{}", with_unit(met.limit, met.row->unit),
                                          met.share() > 1.0 ? fmt::format(": {:.3g} % too much", over)
                                          : &met == judged.binding() ? ", binds"
                                                                     : "")});
    }
    return table;
}

std::string found_text(const Sized& sized, const Candidate& best) {
    const bool several = sized.candidates.size() > 1;
    const std::string who = several ? type_text(best) + ", " : "";
    if (best.meets())
        return who + (several ? "the lightest by the estimate that meets the limits" : "meets the limits");
    return who + "no value was found that meets the limits; this one misses them least of those tried";
}

std::vector<std::string> size_notes(const Scene& scene, const Sized& sized, const Candidate& best) {
    std::vector<std::string> notes;
    if (scene.size->max_descent_rate)
        notes.push_back(fmt::format(
            "by the steady drag alone the descent rate asks for D0 = {:.4g} m (sqrt(8 m g/(pi rho C_D0 "
            "v^2)), densest air)",
            rom::diameter_by_descent_rate(best.found->scene)));
    for (const VaryRow* row : sized.vary)
        notes.push_back(fmt::format("{} varies: {}", row->title, row->what));
    notes.push_back("mass: " + rom::mass_text(rom::sized_parachute(best.found->scene)));
    for (const Candidate& candidate : sized.candidates) {
        const std::string who = sized.candidates.size() > 1 ? type_text(candidate) + ": " : "";
        for (const std::string& note : candidate.notes)
            notes.push_back(who + note);
        if (!candidate.why_not.empty()) notes.push_back(who + candidate.why_not);
    }
    return notes;
}

std::string size_text(const Scene& scene, const Sized& sized, const Style& style) {
    std::string text = style.paint(printable(scene.name), Colour::bold);
    if (!scene.case_name.empty()) text += ", " + printable(scene.case_name);
    text += "  sizing by the reduced-order model\n\n" + terminal_table(trade_table(sized), style, 2);
    const Candidate* best = sized.best();
    if (best == nullptr) return text + "\n" + style.paint("none could be sized", Colour::red) + "\n";
    const Found& found = *best->found;
    text += "\n" + style.paint(found_text(sized, *best), best->meets() ? Colour::green : Colour::red) + "\n" +
            terminal_table(limits_table(found.judged), style, 2);
    if (!found.judged.why_not.empty()) text += "  " + printable(found.judged.why_not) + "\n";
    if (!found.judged.record.estimates.empty())
        text += "\n" + style.paint("peak force by formula", Colour::bold) + "\n" +
                estimates_text(found.judged.record, style);
    text += "\n" + units_text();
    for (const std::string& note : size_notes(scene, sized, *best))
        text += "note      " + printable(note) + "\n";
    return text + warnings_text(found.judged.record.warnings, "", style);
}

nlohmann::ordered_json size_json(const Scene& scene, const Sized& sized) {
    const Candidate* best = sized.best();
    ordered_json candidates = ordered_json::array();
    for (const Candidate& candidate : sized.candidates)
        candidates.push_back(candidate_json(sized, candidate));
    return {{"generator", "twinchute"},
            {"schema", 1},
            {"scene", scene_json(scene_id(scene))},
            {"meets", best != nullptr && best->meets()},
            {"candidates", std::move(candidates)}};
}

}  // namespace twinchute::study
