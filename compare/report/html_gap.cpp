// Why the two differ: each judged metric's way from the candidate's value to the reference's, effect by
// effect.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/report/attribution_text.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

std::string effect_text(double effect, const MetricAttribution& metric, const std::string& unit) {
    return signed_text(effect, std::max(std::abs(metric.candidate), std::abs(metric.reference))) + unit;
}

Table way_table(const MetricAttribution& metric, const Comparison& comparison, const std::string& unit) {
    std::vector<AttributionTerm> steps;
    for (const AttributionTerm& term : metric.terms)
        if (std::abs(term.effect) > negligible * std::abs(metric.reference)) steps.push_back(term);
    if (metric.interaction != 0)
        steps.push_back({"", "Interaction", metric.interaction, "what the effects do only together"});
    double low = std::min(metric.candidate, metric.reference),
           high = std::max(metric.candidate, metric.reference), value = metric.candidate;
    for (const AttributionTerm& step : steps) {
        value += step.effect;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    const auto at = [&](double v) { return high > low ? 4 + 92 * (v - low) / (high - low) : 50; };
    Table table;
    table.add_words({"physics effect"});
    table.add_numbers({"size"});
    table.columns.push_back({.title = "on the way", .drawn = true});
    const auto add_end = [&](const PageSide& side, std::string_view style, double v) {
        table.rows.push_back(
            {{side.record->fidelity, side.tone}, readable(v) + unit, Cell(std::vector{Bar{style, at(v)}})});
    };
    add_end(page_sides(comparison)[0], "end candidate", metric.candidate);
    value = metric.candidate;
    for (const AttributionTerm& step : steps) {
        const bool down = step.effect < 0;
        const double next = value + step.effect;
        const double from = at(std::min(value, next)), width = at(std::max(value, next)) - from;
        table.rows.push_back({step.title, effect_text(step.effect, metric, unit),
                              Cell(std::vector{Bar{down ? "step down" : "step up", from, width}})});
        value = next;
    }
    add_end(page_sides(comparison)[1], "end reference", metric.reference);
    return table;
}

std::string way(const MetricAttribution& found, const Comparison& comparison) {
    const MetricAttribution metric = shown_metric(found);
    const MetricRow* known = find_metric_row(metric.metric);
    const std::string unit = known == nullptr ? std::string() : spaced_unit(known->unit);
    const auto sides = page_sides(comparison);
    double largest = 0.0;
    for (const AttributionTerm& term : metric.terms)
        largest = std::max(largest, std::abs(term.effect));
    std::string remark;
    if (std::abs(metric.interaction) > largest) remark = "interaction larger than any effect";
    if (metric.scatter)
        remark += fmt::format(
            "{}scatter over seeds {}{}{}", remark.empty() ? "" : ", ", readable(*metric.scatter, 3), unit,
            std::abs(metric.candidate - metric.reference) <= *metric.scatter ? ", no less than the gap" : "");
    return html_table(way_table(metric, comparison, unit),
                      fmt::format("<strong>{}</strong>, from {} to {}{}",
                                  xml_text(known == nullptr ? std::string_view(metric.metric) : known->title),
                                  side_name(sides[0]), side_name(sides[1]),
                                  remark.empty() ? "" : fmt::format(" ({})", xml_text(remark))),
                      "bars way");
}

/// The metric whose gap is the largest share of the reference.
const MetricAttribution& headline(const std::vector<MetricAttribution>& metrics) {
    const auto share = [](const MetricAttribution& metric) {
        return metric.reference != 0.0
                   ? std::abs(metric.reference - metric.candidate) / std::abs(metric.reference)
                   : 0.0;
    };
    return *std::ranges::max_element(metrics, {}, share);
}

}  // namespace

std::string attribution_section(const Comparison& comparison) {
    if (!comparison.attribution || comparison.attribution->metrics.empty()) return {};
    const auto sides = page_sides(comparison);
    const Attribution& attribution = *comparison.attribution;
    std::string text = fmt::format(
        "<section id=\"why\"><h2>Why they differ</h2>\n<p>{} Each bar is what one physics effect adds to the "
        "metric when it alone is brought from {} to {}.</p>\n<div class=\"ways\">\n",
        xml_text(attribution_sentence(headline(attribution.metrics), comparison)), side_name(sides[0]),
        side_name(sides[1]));
    for (const MetricAttribution& metric : attribution.metrics)
        text += "<div>" + way(metric, comparison) + "</div>\n";
    text += fmt::format(
        "</div>\n<details><summary>How effects are switched</summary>\n<p>{}</p>\n<ul class=\"plain\">\n",
        xml_text(attribution_legend(comparison)));
    for (const std::vector<std::string>& list : {attribution_details(attribution), attribution.notes})
        for (const std::string& line : list)
            text += fmt::format("<li>{}</li>\n", xml_text(line));
    text += "</ul></details>\n";
    return text + "</section>\n";
}

}  // namespace twinchute::compare
