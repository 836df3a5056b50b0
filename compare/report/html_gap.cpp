// Why the two differ: each judged metric's way from the candidate's value to the reference's, effect by
// effect.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/report/html_parts.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

/// As many digits after the point as four of the metric itself have.
std::string effect_text(double effect, const MetricAttribution& metric, const std::string& unit) {
    const double larger = std::max(std::abs(metric.candidate), std::abs(metric.reference));
    const int before =
        larger > 0 && std::isfinite(larger) ? static_cast<int>(std::floor(std::log10(larger))) + 1 : 1;
    return fmt::format("{:.{}f}{}", std::abs(effect), std::clamp(4 - before, 0, 12), unit);
}

Table way_table(const MetricAttribution& metric, const Comparison& comparison, const std::string& unit) {
    std::vector<AttributionTerm> steps = metric.terms;
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
        table.rows.push_back({{step.title, Tone::plain, step.detail},
                              (down ? "\u2212" : "+") + effect_text(step.effect, metric, unit),
                              Cell(std::vector{Bar{down ? "step down" : "step up", from, width}})});
        value = next;
    }
    add_end(page_sides(comparison)[1], "end reference", metric.reference);
    return table;
}

std::string way(const MetricAttribution& metric, const Comparison& comparison) {
    const MetricRow* known = find_metric_row(metric.metric);
    const std::string unit = known == nullptr || known->unit.empty() ? "" : " " + std::string(known->unit);
    const auto sides = page_sides(comparison);
    std::string text =
        html_table(way_table(metric, comparison, unit),
                   fmt::format("<strong>{}</strong>, from {} to {}",
                               xml_text(known == nullptr ? std::string_view(metric.metric) : known->title),
                               side_name(sides[0]), side_name(sides[1])),
                   "bars way");
    double largest = 0.0;
    for (const AttributionTerm& term : metric.terms)
        largest = std::max(largest, std::abs(term.effect));
    if (std::abs(metric.interaction) > largest)
        text +=
            "<p class=\"alert\">The interaction is larger than any single effect: the effects cannot be read "
            "on their "
            "own.</p>\n";
    if (metric.scatter)
        text += fmt::format("<p class=\"quiet\">Scatter over seeds: {}{}.{}</p>\n",
                            effect_text(*metric.scatter, metric, ""), xml_text(unit),
                            std::abs(metric.candidate - metric.reference) <= *metric.scatter
                                ? " The gap is no larger than that: chance alone makes as much."
                                : "");
    return text;
}

}  // namespace

std::string attribution_section(const Comparison& comparison) {
    if (!comparison.attribution || comparison.attribution->metrics.empty()) return {};
    const auto sides = page_sides(comparison);
    std::string text = fmt::format(
        "<section id=\"why\"><h2>Why they differ</h2>\n<p>Each bar is what one physics effect does to the "
        "metric when it "
        "alone is brought from {} to {}; purple raises it, green lowers it.</p>\n<div class=\"ways\">\n",
        side_name(sides[0]), side_name(sides[1]));
    for (const MetricAttribution& metric : comparison.attribution->metrics)
        text += "<div>" + way(metric, comparison) + "</div>\n";
    text += "</div>\n";
    if (!comparison.attribution->notes.empty()) {
        text += "<ul class=\"plain\">\n";
        for (const std::string& note : comparison.attribution->notes)
            text += fmt::format("<li>{}</li>\n", xml_text(note));
        text += "</ul>\n";
    }
    return text + "</section>\n";
}

}  // namespace twinchute::compare
