#include "study/size/size_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/table.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/still_page.hpp"
#include "compare/series.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/record/display_units.hpp"
#include "study/size/size_text.hpp"

namespace twinchute::study {
namespace {

using compare::page_figure;
using compare::page_section;
using compare::Plot;
using compare::PlotSeries;
using compare::xml_text;

/// Runs on either side of the value found, from half of it to twice, as far as it may vary.
constexpr int samples = 48;
/// Largest share of a limit that is drawn.
constexpr double most_share = 2.5;

/// How the best candidate's share of each limit goes with one variable, the others as they were found.
Plot share_plot(const rom::VaryRow& row, const rom::Found& found, const std::stop_token& stop) {
    const double value = row.get(found.scene);
    const rom::Bounds bounds = row.bounds(found.scene);
    const double low = std::clamp(0.5 * value, bounds.low, value),
                 high = std::clamp(2.0 * value, value, bounds.high);
    constexpr std::array colours{compare::blue, compare::vermillion, compare::green, compare::purple,
                                 compare::orange};
    Plot plot{
        .title = "Limits against the " + std::string(row.title),
        .subtitle = "found: " + with_unit(value, row.unit),
        .x = {.label = fmt::format("{} [{}]", row.title, row.unit.empty() ? "-" : shown_unit(row.unit))},
        .y = {.label = "share of the limit used [-]", .from_zero = true},
        .series = {},
        .width = 860,
        .beside = 270};
    double largest = 1.0;
    for (int i = 0; i <= samples; ++i) {
        const double at = low * std::pow(high / low, static_cast<double>(i) / samples);
        Scene varied = found.scene;
        row.set(varied, at);
        const rom::Judged judged = rom::judge(varied, stop);
        if (stop.stop_requested()) throw rom::Interrupted();
        if (!judged.why_not.empty()) continue;
        for (const rom::Met& met : judged.limits) {
            const std::string title(met.row->title);
            auto line = std::ranges::find(plot.series, title, &PlotSeries::label);
            if (line == plot.series.end()) {
                plot.series.push_back(
                    {.label = title, .colour = colours[plot.series.size() % colours.size()]});
                line = plot.series.end() - 1;
            }
            line->x.push_back(shown(at, row.unit).value);
            line->y.push_back(met.share());
            largest = std::max(largest, met.share());
        }
    }
    if (largest > most_share) plot.y.end = most_share;
    plot.levels = {{"limit", compare::ink, 1.0}};
    plot.markers = {{"found", compare::dim, shown(value, row.unit).value}};
    plot.nothing = "no run comes to what is limited";
    return plot;
}

/// Opening of each candidate that was sized.
std::string openings(const Scene& scene, const rom::Sized& sized) {
    compare::CaseSeries series;
    series.title = scene.name;
    for (const rom::Candidate& candidate : sized.candidates) {
        if (!candidate.found) continue;
        series.cases.push_back(compare::series_case(candidate.found->scene, candidate.found->judged.record));
        series.cases.back().name = type_text(candidate);
        series.cases.back().group.clear();
    }
    std::string text;
    for (const Plot& plot : opening_plots(series))
        text += page_figure(plot);
    return text;
}

std::string verdict_banner(const rom::Sized& sized, const rom::Candidate& best) {
    const bool meets = best.meets();
    return fmt::format(
        "<div class=\"verdict {}\"><span class=\"sign\" aria-hidden=\"true\">{}</span><p><strong>{}</strong>"
        "<span>{}</span></p></div>\n",
        meets ? "within" : "exceeded", meets ? "\u2713" : "\u2717",
        meets ? "Meets the limits" : "No value meets the limits", xml_text(found_text(sized, best)));
}

}  // namespace

std::string size_page(const Scene& scene, const rom::Sized& sized, const std::stop_token& stop) {
    const rom::Candidate* best = sized.best();
    std::string summary;
    if (best == nullptr)
        summary +=
            "<div class=\"verdict exceeded\"><span class=\"sign\" aria-hidden=\"true\">\u2717</span>"
            "<p><strong>None could be sized</strong></p></div>\n";
    else
        summary += verdict_banner(sized, *best);
    if (!units_remark().empty()) summary += fmt::format("<p>Here: {}.</p>\n", units_remark());
    summary += html_table(trade_table(sized), "Candidates, by the reduced-order model. Mass is an estimate.",
                          {}, "candidates");
    if (best != nullptr)
        summary += html_table(limits_table(best->found->judged),
                              "Limits, and what the best candidate uses of them.", {}, "limits");
    std::string page = page_section("summary", "Result", summary);
    if (best != nullptr) {
        const rom::Found& found = *best->found;
        std::string shares;
        for (const rom::VaryRow* row : sized.vary)
            shares += page_figure(share_plot(*row, found, stop));
        page += page_section("shares", "Around the values found", shares);
        page += page_section("openings", "Openings", openings(scene, sized));
        if (!found.judged.record.estimates.empty())
            page += page_section("estimates", "Peak force by formula",
                                 html_table(compare::estimates_table(found.judged.record),
                                            "Beside the run of the best candidate.", {}, "formulas"));
        std::string notes = "<ul>\n";
        for (const std::string& note : size_notes(scene, sized, *best))
            notes += "<li>" + xml_text(note) + "</li>\n";
        for (const Warning& warning : found.judged.record.warnings)
            notes += fmt::format("<li>Warning: {} ({}), {}</li>\n", xml_text(warning.what),
                                 xml_text(warning.why), xml_text(warning.suggestion));
        page += page_section("notes", "Notes", notes + "</ul>\n");
    }
    const std::string name = scene.case_name.empty() ? scene.name : scene.name + ", " + scene.case_name;
    return compare::still_page(name, "sizing", page);
}

}  // namespace twinchute::study
