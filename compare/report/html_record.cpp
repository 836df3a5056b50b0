// The first screen of a run alone: how it ended, and its key figures.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compare/render/escape.hpp"
#include "compare/report/html_parts.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"
#include "lib/record/metrics.hpp"

namespace twinchute::compare {
namespace {

/// Metrics that have a card where the record has them.
constexpr std::array<std::string_view, 8> on_cards{"peak_force",     "filling_time", "max_deceleration",
                                                   "descent_rate",   "drift",        "landing_vertical_speed",
                                                   "landing_energy", "flight_time"};

std::string kind_text(const Metric& metric) {
    return metric.kind == MetricKind::result ? "" : std::string(metric_kind_name(metric.kind));
}

std::string cards(const RunRecord& record) {
    std::string text = "<ul class=\"cards\">\n";
    for (const std::string_view name : on_cards) {
        const MetricRow& row = *find_metric_row(name);
        const Metric* metric = record.find_metric(row.key);
        if (metric == nullptr) continue;
        text += fmt::format("<li class=\"card\"><h3>{}</h3>\n<p class=\"ratio\"><strong>{}</strong></p>",
                            xml_text(row.title), xml_text(with_unit(metric->value, row.unit)));
        std::string below = kind_text(*metric);
        if (const auto time = record.metric("time_to_peak_force_s"); time && name == on_cards.front())
            below += fmt::format("{}{} s after {}", below.empty() ? "" : ", ", readable(*time, 4),
                                 record.find_event("snatch") ? "snatch" : "line stretch");
        if (!below.empty()) text += fmt::format("<p class=\"quiet\">{}</p>", xml_text(below));
        text += "</li>\n";
    }
    return text + fmt::format(
                      "<li class=\"card\"><h3>Cost</h3>\n<p class=\"ratio\"><strong>{}</strong></p>"
                      "<p class=\"quiet\">wall time, on the machine named below</p></li>\n</ul>\n",
                      xml_text(time_text(record.cost.wall_s)));
}

std::string all_metrics(const RunRecord& record) {
    Table table;
    table.add_words({"metric"});
    table.add_numbers({"value"});
    table.add_words({"unit", "is", "note"});
    for (const Metric& metric : record.metrics) {
        const Shown number = shown(metric.value, split_metric_key(metric.key).unit);
        table.rows.push_back(
            {{metric_words(metric.key), metric.kind == MetricKind::input ? Tone::quiet : Tone::plain},
             readable(number.value),
             unit_for_reading(number.unit),
             metric_kind_name(metric.kind),
             metric.note});
    }
    if (table.rows.empty()) return {};
    return html_table(table,
                      "<strong>All metrics.</strong> An <em>input</em> repeats what the scene says; a "
                      "<em>result</em> comes out of the model.",
                      "metrics", "metrics");
}

std::string missing_metrics(const RunRecord& record) {
    Table table;
    table.add_words({"metric", "why it is missing"});
    for (const MissingMetric& one : record.missing)
        table.rows.push_back({metric_words(one.metric), one.why});
    if (table.rows.empty()) return {};
    return "<details><summary>Metrics that this run does not have</summary>\n" +
           html_table(table, "Each with the reason.", {}, "missing") + "</details>\n";
}

std::string status_banner(const RunRecord& record) {
    const StatusCode code = record.status.code;
    std::string_view style = "within", sign = "\u2713";
    if (is_numerical_failure(code) || code == StatusCode::interrupted || code == StatusCode::refused)
        style = "broken", sign = "!";
    else if (failed_to_open(code))
        style = "exceeded", sign = "\u2717";
    return fmt::format(
        "<div class=\"verdict {}\"><span class=\"sign\" aria-hidden=\"true\">{}</span>"
        "<p><strong>{}</strong>{}</p></div>\n",
        style, sign, xml_text(status_name(code)),
        record.status.detail.empty() ? "" : fmt::format("<span>{}</span>", xml_text(record.status.detail)));
}

}  // namespace

Table estimates_table(const RunRecord& record) {
    Table table;
    table.add_words({"formula"});
    table.add_numbers({"value", "of the run's"});
    table.add_words({"range", "source"});
    for (const Estimate& estimate : record.estimates) {
        const auto run = record.metric(estimate.metric);
        table.rows.push_back({{estimate.title, estimate.outside.empty() ? Tone::plain : Tone::quiet},
                              with_unit(estimate.value, split_metric_key(estimate.metric).unit),
                              run && *run != 0 ? fmt::format("{:.0f} %", 100 * estimate.value / *run) : "-",
                              estimate.outside.empty() ? "holds here" : "does not hold: " + estimate.outside,
                              estimate.source});
    }
    return table;
}

std::string record_summary(const PageSide& side) {
    const RunRecord& record = *side.record;
    std::string text = fmt::format(
        "<header><p class=\"brand\">twinchute <span>one run</span></p>\n<h1>{}</h1>\n"
        "<p class=\"lead\">By the {} ({}).",
        xml_text(record.scene.name), xml_text(side.title), side_name(side));
    if (const std::string fill = fill_constant_text(record); !fill.empty())
        text += fmt::format(" It was told the {}.", xml_text(fill));
    if (!units_remark().empty()) text += fmt::format(" Here: {}.", units_remark());
    text += "</p></header>\n<section id=\"summary\" tabindex=\"-1\"><h2>Key figures</h2>\n";
    text += status_banner(record);
    if (const std::size_t warnings = record.warnings.size(); warnings > 0)
        text += fmt::format(
            "<p class=\"alert\"><a href=\"#warnings\">{} warning{}</a> from the run, below.</p>\n", warnings,
            warnings == 1 ? "" : "s");
    text += cards(record) + all_metrics(record) + missing_metrics(record);
    if (!record.estimates.empty())
        text += html_table(estimates_table(record), "<strong>Peak force by formula</strong>, beside the run.",
                           {}, "estimates");
    return text + "</section>\n";
}

}  // namespace twinchute::compare
