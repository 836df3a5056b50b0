#include "compare/report/attribution_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

/// Terms that a sentence names: no more, and none below this share of the largest.
constexpr std::size_t most_named = 3;
constexpr double worth_naming = 0.2;

std::string unit_of(const MetricAttribution& metric) {
    const MetricRow* row = find_metric_row(metric.metric);
    return row == nullptr ? std::string() : spaced_unit(row->unit);
}

std::string title_of(const MetricAttribution& metric) {
    const MetricRow* row = find_metric_row(metric.metric);
    return row == nullptr ? metric.metric : std::string(row->title);
}

/// To as many places as the metric's own four digits have, and one more: terms are small beside it.
int places(const MetricAttribution& metric) {
    const double size = std::max(std::abs(metric.reference), std::abs(metric.candidate));
    if (!(size > 0.0)) return 4;
    return std::clamp(4 - static_cast<int>(std::floor(std::log10(size))), 0, 12);
}

std::string signed_number(double value, int decimals) {
    std::string text = fmt::format("{:+.{}f}", value, decimals);
    return text.find_first_not_of("+-0.") == std::string::npos ? "0" : text;
}

std::string effect_text(double effect, const MetricAttribution& metric) {
    return signed_number(effect, places(metric)) + unit_of(metric);
}

/// The largest first; those alike in the order of the ladder.
std::vector<AttributionTerm> by_size(const MetricAttribution& metric) {
    std::vector<AttributionTerm> terms = metric.terms;
    std::ranges::stable_sort(terms, std::greater<>(),
                             [](const AttributionTerm& term) { return std::abs(term.effect); });
    return terms;
}

std::string named(const MetricAttribution& metric) {
    const std::vector<AttributionTerm> terms = by_size(metric);
    const double floor = negligible * std::abs(metric.reference);
    std::string text;
    for (std::size_t i = 0; i < terms.size() && i < most_named; ++i) {
        const double size = std::abs(terms[i].effect);
        if (size < worth_naming * std::abs(terms.front().effect) || size <= floor) break;
        text +=
            fmt::format("{}{} {}", i == 0 ? "" : ", ", terms[i].title, effect_text(terms[i].effect, metric));
    }
    return text;
}

/// In the order in which they first come; not every metric has each.
std::vector<AttributionTerm> rows_of(const Attribution& attribution) {
    std::vector<AttributionTerm> rows;
    for (const MetricAttribution& metric : attribution.metrics)
        for (const AttributionTerm& term : metric.terms)
            if (std::ranges::none_of(rows, [&](const auto& row) { return row.name == term.name; }))
                rows.push_back(term);
    return rows;
}

}  // namespace

MetricAttribution shown_metric(MetricAttribution metric) {
    const MetricRow* row = find_metric_row(metric.metric);
    const double factor = row == nullptr ? 1.0 : shown_factor(row->unit);
    for (double* value : {&metric.reference, &metric.candidate, &metric.interaction})
        *value *= factor;
    for (AttributionTerm& term : metric.terms)
        term.effect *= factor;
    if (metric.scatter) *metric.scatter *= factor;
    return metric;
}

std::string attribution_sentence(const MetricAttribution& found, const Comparison& comparison) {
    const MetricAttribution metric = shown_metric(found);
    const double gap = metric.reference - metric.candidate;
    const std::string reference = comparison.reference.fidelity, candidate = comparison.candidate.fidelity;
    std::string text = title_of(metric) + ": ";
    if (std::abs(gap) <= negligible * std::abs(metric.reference)) {
        text += fmt::format("no gap to speak of ({}).", effect_text(gap, metric));
    } else {
        text += fmt::format("{} is {:.{}f}{}", reference, std::abs(gap), places(metric), unit_of(metric));
        if (metric.reference != 0.0)
            text += fmt::format(" ({:.1f} %)", 100.0 * std::abs(gap / metric.reference));
        text += fmt::format(" {} {}.", gap > 0.0 ? "above" : "below", candidate);
    }
    if (metric.scatter && std::abs(gap) <= *metric.scatter)
        return text + fmt::format(
                          " That is within the scatter of {} over seeds, {:.{}f}{}: no effect can be held "
                          "responsible.",
                          reference, *metric.scatter, places(metric), unit_of(metric));
    double largest = 0.0;
    for (const AttributionTerm& term : metric.terms)
        largest = std::max(largest, std::abs(term.effect));
    const std::string terms = named(metric);
    if (std::abs(metric.interaction) > largest &&
        std::abs(metric.interaction) > negligible * std::abs(metric.reference))
        return text + fmt::format(
                          " The effects act together: their interaction, {}, is larger than any of them "
                          "({}), so that the terms cannot be read on their own.",
                          effect_text(metric.interaction, metric), terms.empty() ? "none counts" : terms);
    if (terms.empty()) return text + " No effect makes any difference worth naming.";
    return text +
           fmt::format(" Largest terms: {}; interaction {}.", terms, effect_text(metric.interaction, metric));
}

Table attribution_table(const Comparison& comparison) {
    const Attribution& attribution = *comparison.attribution;
    Table table;
    table.add_words({"from " + comparison.candidate.fidelity + " to " + comparison.reference.fidelity});
    const bool scatters = std::ranges::any_of(
        attribution.metrics, [](const MetricAttribution& metric) { return metric.scatter.has_value(); });
    std::vector<Cell> first{comparison.candidate.fidelity}, last{comparison.reference.fidelity},
        together{"+ Interaction"}, scatter{"scatter of " + comparison.reference.fidelity};
    for (const MetricAttribution& found : attribution.metrics) {
        const MetricAttribution metric = shown_metric(found);
        const MetricRow* row = find_metric_row(metric.metric);
        table.add_numbers({title_of(metric)}, row == nullptr ? "" : shown_unit(row->unit));
        first.emplace_back(fmt::format("{:.{}f}", metric.candidate, places(metric)));
        last.emplace_back(fmt::format("{:.{}f}", metric.reference, places(metric)));
        together.emplace_back(signed_number(metric.interaction, places(metric)));
        scatter.emplace_back(metric.scatter ? fmt::format("{:.{}f}", *metric.scatter, places(metric)) : "-");
    }
    table.rows.push_back(std::move(first));
    for (const AttributionTerm& row : rows_of(attribution)) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells.emplace_back("+ " + row.title);
        for (const MetricAttribution& found : attribution.metrics) {
            const MetricAttribution metric = shown_metric(found);
            const auto term = std::ranges::find(metric.terms, row.name, &AttributionTerm::name);
            cells.emplace_back(term == metric.terms.end() ? "-"
                                                          : signed_number(term->effect, places(metric)));
        }
    }
    table.rows.push_back(std::move(together));
    table.rows.push_back(std::move(last));
    if (scatters) table.rows.push_back(std::move(scatter));
    return table;
}

std::string attribution_legend(const Comparison& comparison) {
    const Attribution& attribution = *comparison.attribution;
    std::string text = fmt::format(
        "Each effect is switched alone, in both models, with all others off; its term is what that does to "
        "{} "
        "less "
        "{}. What no effect does alone is the interaction.",
        comparison.reference.fidelity, comparison.candidate.fidelity);
    if (!attribution.seeds.empty())
        text += fmt::format(" Scatter: largest less smallest over {} seeds.", attribution.seeds.size());
    return text;
}

std::vector<std::string> attribution_details(const Attribution& attribution) {
    std::vector<std::string> details;
    for (const AttributionTerm& row : rows_of(attribution))
        if (!row.detail.empty()) details.push_back(row.title + ": " + row.detail);
    return details;
}

}  // namespace twinchute::compare
