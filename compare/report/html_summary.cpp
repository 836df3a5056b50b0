// The first screen: what came out, in words and in numbers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

/// Where the difference lies between the ends of the tolerance, which take the middle half of the track.
std::string gauge(const MetricGap& metric) {
    if (!metric.difference || !metric.tolerance) return {};
    const double allowed = metric.tolerance->relative
                               ? metric.tolerance->value * std::abs(metric.reference->value)
                               : metric.tolerance->value;
    if (!(allowed > 0) || !std::isfinite(*metric.difference)) return {};
    const double at = std::clamp(50 - 25 * *metric.difference / allowed, 1.0, 99.0);
    return fmt::format(
        "<div class=\"gauge\" aria-hidden=\"true\"><span class=\"band\"></span><span class=\"zero\"></span>"
        "<span class=\"needle {}\" style=\"left:{:.2f}%\"></span></div>",
        metric.verdict == Verdict::within     ? "within"
        : metric.verdict == Verdict::exceeded ? "exceeded"
                                              : "unjudged",
        at);
}

std::string key_figure(const MetricGap& metric, const Comparison& comparison) {
    const auto sides = page_sides(comparison);
    std::string text = fmt::format("<li class=\"card\"><h3>{}</h3>\n<dl>\n", xml_text(metric.row->title));
    const std::array values{&metric.candidate, &metric.reference};
    for (std::size_t i = 0; i < 2; ++i)
        text += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", side_name(sides[i]),
                            xml_text(value_text(*values[i], metric.row->unit)));
    text += fmt::format(
        "</dl>\n{}<p>{}</p><p class=\"judged-by\">{} <span>tolerance {}, {}</span></p></li>\n", gauge(metric),
        xml_text(difference_words(metric, comparison)), html_cell(verdict_cell(metric.verdict)),
        metric.tolerance->value == 0
            ? "0: any difference counts"
            : "\u00b1" + xml_text(shown_tolerance(*metric.tolerance, metric.row->unit)),
        origin_text(metric.origin));
    return text;
}

std::string cost_card(const Comparison& comparison) {
    std::string text = "<li class=\"card\"><h3>Cost</h3>\n<dl>\n";
    for (const PageSide& side : page_sides(comparison))
        text += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", side_name(side),
                            xml_text(time_text(side.record->cost.wall_s)));
    text += "</dl>\n";
    if (comparison.gap.cost_ratio)
        text += fmt::format("<p class=\"ratio\"><strong>{}\u00d7</strong> as long for {}</p>",
                            ratio_text(*comparison.gap.cost_ratio), xml_text(comparison.reference.fidelity));
    return text + "<p class=\"quiet\">wall time, on the machine named below</p></li>\n";
}

std::string key_figures(const Comparison& comparison) {
    std::string text = "<ul class=\"cards\">\n";
    for (const MetricGap& metric : comparison.gap.metrics)
        if (metric.tolerance) text += key_figure(metric, comparison);
    return text + cost_card(comparison) + "</ul>\n";
}

std::string metric_tables(const Comparison& comparison) {
    const std::string text = html_table(
        metrics_table(comparison),
        fmt::format("<strong>All metrics.</strong> {} An <em>input</em> repeats what the scene says; a "
                    "<em>result</em> comes out of the model: only results compare models.",
                    xml_text(difference_legend(comparison))),
        "metrics", "metrics");
    const Table notes = metric_notes_table(comparison);
    if (notes.rows.empty()) return text;
    return text + "<details><summary>Notes on the metrics</summary>\n" +
           html_table(notes, "Which part is input, and how a result is taken.", {}, "metric-notes") +
           "</details>\n";
}

/// Verdict of all, then metric by metric what makes it.
std::string verdict_words(const Comparison& comparison, Verdict verdict) {
    std::string text;
    if (verdict == Verdict::within && exit_code(comparison) == ExitCode::done) {
        const auto judged =
            std::ranges::count(comparison.gap.metrics, Verdict::within, &MetricGap::verdict) +
            std::ranges::count(comparison.gap.histories, Verdict::within, &HistoryGap::verdict);
        text = fmt::format("<span>{0} of {0} judged metrics. Closest to its tolerance:</span>", judged);
    } else {
        text = fmt::format("<span>{}</span>", xml_text(verdict_line(comparison)));
    }
    if (is_judged(comparison.reference) && is_judged(comparison.candidate))
        for (const std::string& words : judged_words(comparison))
            text += fmt::format("<span>{}</span>", xml_text(words));
    return text;
}

/// Large gaps that no tolerance judges.
std::string unjudged_gaps(const Comparison& comparison) {
    const std::vector<const MetricGap*> largest = largest_unjudged(comparison.gap);
    if (largest.empty()) return {};
    std::string text =
        "<div class=\"unjudged-gaps\"><h3>Largest gaps that no tolerance judges</h3>\n<ul class=\"plain\">\n";
    for (const MetricGap* metric : largest)
        text += fmt::format("<li><strong>{}</strong>: {}</li>\n", xml_text(metric->row->title),
                            xml_text(difference_words(*metric, comparison)));
    return text + "</ul></div>\n";
}

bool is_unopened(const Comparison& comparison) {
    return failed_to_open(comparison.reference.status.code) ||
           failed_to_open(comparison.candidate.status.code);
}

std::string verdict_banner(const Comparison& comparison) {
    const ExitCode code = exit_code(comparison);
    const Verdict verdict = overall_verdict(comparison);
    std::string_view style = "exceeded", sign = "\u2717", word = "Outside tolerance";
    if (code == ExitCode::interrupted || code == ExitCode::numerical || code == ExitCode::usage)
        style = "broken", sign = "!", word = "No verdict";
    else if (is_unopened(comparison))
        word = "A parachute never opened";
    else if (verdict == Verdict::within)
        style = "within", sign = "\u2713", word = "Within tolerance";
    else if (verdict == Verdict::not_judged)
        style = "unjudged", sign = "\u2013", word = "Nothing judged";
    return fmt::format(
        "<div class=\"verdict {}\"><span class=\"sign\" aria-hidden=\"true\">{}</span>"
        "<p><strong>{}</strong>{}</p></div>\n",
        style, sign, word, verdict_words(comparison, verdict));
}

std::string status_lines(const Comparison& comparison) {
    std::string text;
    for (const PageSide& side : page_sides(comparison)) {
        const RunStatus& status = side.record->status;
        if (status.code == StatusCode::completed) continue;
        text += fmt::format("<p class=\"alert\">{} ended as <strong>{}</strong>{}{}</p>\n", side_name(side),
                            xml_text(status_name(status.code)), status.detail.empty() ? "" : ": ",
                            xml_text(status.detail));
    }
    std::size_t warnings = 0;
    for (const PageSide& side : page_sides(comparison))
        warnings += side.record->warnings.size();
    if (warnings > 0)
        text += fmt::format(
            "<p class=\"alert\"><a href=\"#warnings\">{} warning{}</a> from the runs, below.</p>\n", warnings,
            warnings == 1 ? "" : "s");
    return text;
}

}  // namespace

std::string summary_section(const Comparison& comparison) {
    const auto sides = page_sides(comparison);
    std::string text = fmt::format(
        "<header><p class=\"brand\">twinchute <span>one parachute scene at two fidelities</span></p>\n"
        "<h1>{}</h1>\n<p class=\"lead\">{} is the {}, quick; {} is the {}, slow. Both flew the same scene, "
        "on the same empirical aerodynamics.",
        xml_text(comparison.reference.scene.name), side_name(sides[0]), xml_text(comparison.candidate_title),
        side_name(sides[1]), xml_text(comparison.reference_title));
    if (const std::string fill = fill_constant_text(comparison.reference); !fill.empty())
        text += fmt::format(" Both were told the {}.", xml_text(fill));
    if (!units_remark().empty()) text += fmt::format(" Here: {}.", units_remark());
    text += "</p></header>\n<section id=\"summary\" tabindex=\"-1\"><h2>Verdict</h2>\n";
    return text + verdict_banner(comparison) + status_lines(comparison) + key_figures(comparison) +
           unjudged_gaps(comparison) + metric_tables(comparison) + "</section>\n";
}

}  // namespace twinchute::compare
