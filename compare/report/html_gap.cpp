// Why the two differ: each judged metric's way from the candidate's value to the reference's, piece by piece.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/report/escape.hpp"
#include "compare/report/html_parts.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

/// A step of the way: what it is called, and the values before and after it.
struct Step {
    std::string title, detail, style;
    double from, to;
};

std::vector<Step> steps_of(const MetricAttribution& metric) {
    std::vector<Step> steps;
    double value = metric.candidate;
    const auto add = [&](const std::string& title, const std::string& detail, double effect) {
        steps.push_back({title, detail, effect < 0 ? "down" : "up", value, value + effect});
        value += effect;
    };
    for (const AttributionTerm& term : metric.terms)
        add(term.title, term.detail, term.effect);
    if (metric.interaction != 0) add("Interaction", "what the pieces do only together", metric.interaction);
    return steps;
}

/// As many digits after the point as four of the metric itself have.
std::string effect_text(double effect, const MetricAttribution& metric, const std::string& unit) {
    const double larger = std::max(std::abs(metric.candidate), std::abs(metric.reference));
    const int before =
        larger > 0 && std::isfinite(larger) ? static_cast<int>(std::floor(std::log10(larger))) + 1 : 1;
    return fmt::format("{:.{}f}{}", std::abs(effect), std::clamp(4 - before, 0, 12), unit);
}

struct Scale {
    double low, high;
    double at(double value) const { return high > low ? 4 + 92 * (value - low) / (high - low) : 50; }
};

Scale scale_of(const MetricAttribution& metric, const std::vector<Step>& steps) {
    Scale scale{std::min(metric.candidate, metric.reference), std::max(metric.candidate, metric.reference)};
    for (const Step& step : steps) {
        scale.low = std::min(scale.low, step.to);
        scale.high = std::max(scale.high, step.to);
    }
    return scale;
}

std::string row(const std::string& title, const std::string& detail, const std::string& value,
                const std::string& drawing) {
    const std::string note =
        detail.empty() ? "" : fmt::format("<span class=\"note\">{}</span>", xml_text(detail));
    return fmt::format(
        "<tr><th scope=\"row\">{}{}</th><td class=\"number\">{}</td><td><span class=\"track\" "
        "aria-hidden=\"true\">{}</span></td></tr>\n",
        title, note, xml_text(value), drawing);
}

std::string end_mark(const PageSide& side, double at) {
    return fmt::format("<span class=\"end {}\" style=\"left:{:.2f}%\"></span>", side.style, at);
}

std::string way(const MetricAttribution& metric, const Comparison& comparison) {
    const MetricRow* known = find_metric_row(metric.metric);
    const std::string unit = known == nullptr || known->unit.empty() ? "" : " " + std::string(known->unit);
    const auto sides = page_sides(comparison);
    const std::vector<Step> steps = steps_of(metric);
    const Scale scale = scale_of(metric, steps);
    std::string text =
        fmt::format("<table class=\"bars way\"><caption><strong>{}</strong>, from {} to {}</caption>\n",
                    xml_text(known == nullptr ? std::string_view(metric.metric) : known->title),
                    side_name(sides[0]), side_name(sides[1]));
    text += table_head({"piece", "effect", "on the way"}, "lrl") + "<tbody>\n";
    text += row(side_name(sides[0]), "", readable(metric.candidate) + unit,
                end_mark(sides[0], scale.at(metric.candidate)));
    for (const Step& step : steps) {
        const double from = scale.at(std::min(step.from, step.to)),
                     to = scale.at(std::max(step.from, step.to));
        const std::string effect =
            (step.to < step.from ? "\u2212" : "+") + effect_text(step.to - step.from, metric, unit);
        text += row(xml_text(step.title), step.detail, effect,
                    fmt::format("<span class=\"step {}\" style=\"left:{:.2f}%;width:{:.2f}%\"></span>",
                                step.style, from, to - from));
    }
    text += row(side_name(sides[1]), "", readable(metric.reference) + unit,
                end_mark(sides[1], scale.at(metric.reference)));
    text += "</tbody></table>\n";
    double largest = 0.0;
    for (const AttributionTerm& term : metric.terms)
        largest = std::max(largest, std::abs(term.effect));
    if (std::abs(metric.interaction) > largest)
        text +=
            "<p class=\"alert\">The interaction is larger than any single piece: the pieces cannot be read "
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
        "<section id=\"why\"><h2>Why they differ</h2>\n<p>Each bar is what one piece of physics does to the "
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
