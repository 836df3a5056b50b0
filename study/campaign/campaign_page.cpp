// The report of a campaign: one page without scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/plot.hpp"
#include "compare/report/still_page.hpp"
#include "study/campaign/campaign_files.hpp"

namespace twinchute::study {
namespace {

using compare::page_figure;
using compare::page_section;
using compare::Plot;
using compare::PlotSeries;
using compare::still_page;
using compare::xml_text;

std::string label_of(std::string_view metric) {
    const std::string_view unit = split_metric_key(metric).unit;
    return metric_words(metric) + (unit.empty() ? "" : fmt::format(" [{}]", unit));
}

/// Thresholds and limits of answers about a metric.
void mark(Plot& plot, const Campaign& campaign, const std::string& metric) {
    for (const Answer& a : campaign.results.answers) {
        if (a.spec->metric != metric) continue;
        if (a.spec->kind == AnswerSpec::Kind::probability)
            plot.markers.push_back({a.spec->name, compare::vermillion, a.spec->threshold});
        else if (std::isfinite(a.value.estimate))
            plot.markers.push_back({a.spec->name, compare::dim, a.value.estimate});
    }
}

Plot histogram_plot(const Campaign& campaign, const Histogram& h) {
    Plot plot;
    plot.title = "Distribution of " + metric_words(h.metric);
    plot.subtitle = fmt::format("{} runs, mean {}, standard deviation {}", h.moments.count,
                                readable(h.moments.mean, 5), readable(std::sqrt(h.moments.variance()), 4));
    plot.height = 320.0;
    plot.x.label = label_of(h.metric);
    plot.y.label = "share of runs";
    plot.y.from_zero = true;
    PlotSeries shares{.label = "", .colour = compare::blue};
    const double width = (h.high - h.low) / static_cast<double>(h.counts.size());
    for (std::size_t i = 0; i < h.counts.size(); ++i) {
        const double share = static_cast<double>(h.counts[i]) / static_cast<double>(h.moments.count);
        for (const std::size_t end : {i, i + 1}) {
            shares.x.push_back(h.low + static_cast<double>(end) * width);
            shares.y.push_back(share);
        }
    }
    plot.series = {shares};
    mark(plot, campaign, h.metric);
    return plot;
}

Plot exceedance_plot(const Campaign& campaign, const Histogram& h) {
    Plot plot;
    plot.title = "Exceedance of " + metric_words(h.metric);
    plot.height = 320.0;
    plot.x.label = label_of(h.metric);
    plot.y.label = "share of runs above";
    plot.y.logarithmic = true;
    PlotSeries above{.label = "", .colour = compare::vermillion};
    const double width = (h.high - h.low) / static_cast<double>(h.counts.size());
    std::uint64_t left = h.moments.count;
    for (std::size_t i = 0; i < h.counts.size() && left > 0; ++i) {
        above.x.push_back(h.low + static_cast<double>(i) * width);
        above.y.push_back(static_cast<double>(left) / static_cast<double>(h.moments.count));
        left -= h.counts[i];
    }
    plot.series = {above};
    mark(plot, campaign, h.metric);
    return plot;
}

Plot trail_plot(const Answer& answer) {
    Plot plot;
    plot.title = "Interval of " + answer.spec->name + " against runs";
    plot.height = 300.0;
    plot.x.label = "runs";
    plot.x.logarithmic = true;
    const bool is_share = answer.spec->kind == AnswerSpec::Kind::probability;
    plot.y.label = is_share ? "probability" : label_of(answer.spec->metric);
    PlotSeries middle{.label = "estimate", .colour = compare::blue},
        low{.label = "95 % interval", .colour = compare::dim}, high{.label = "", .colour = compare::dim};
    low.line = high.line = 1.2;
    for (const TrailPoint& point : answer.trail) {
        const double runs = static_cast<double>(point.runs);
        for (PlotSeries* series : {&middle, &low, &high})
            series->x.push_back(runs);
        middle.y.push_back(point.value.estimate);
        low.y.push_back(point.value.low);
        high.y.push_back(point.value.high);
    }
    plot.series = {middle, low, high};
    if (answer.spec->limit) plot.levels = {{"limit", compare::vermillion, *answer.spec->limit}};
    return plot;
}

Plot scatter_plot(const Campaign& campaign, const std::string& metric, std::size_t input) {
    Plot plot;
    const CampaignInput& of = campaign.spec.inputs[input];
    plot.title = metric_words(metric) + " against " + of.key;
    plot.height = 280.0;
    plot.x.label = of.key + (of.unit.empty() ? "" : " [" + of.unit + "]");
    plot.y.label = label_of(metric);
    PlotSeries points{.label = "", .colour = compare::blue};
    points.line = 0.0;
    points.marker = compare::MarkerShape::dot;
    const std::size_t column = *campaign.of.front().columns.of(metric);
    for (const std::vector<double>& row : campaign.results.examples) {
        if (!std::isfinite(row[column])) continue;
        points.x.push_back(row[1 + input]);
        points.y.push_back(row[column]);
    }
    plot.series = {points};
    return plot;
}

PlotSeries ellipse_series(const Answer& answer) {
    PlotSeries line{.label = fmt::format("{} ({:.1f} % of the points inside)", answer.spec->name,
                                         100.0 * answer.ellipse->inside),
                    .colour = compare::vermillion};
    const Ellipse& e = *answer.ellipse;
    constexpr int corners = 120;
    for (int k = 0; k <= corners; ++k) {
        const double t = 2.0 * 3.14159265358979323846 * k / corners, c = std::cos(e.angle),
                     s = std::sin(e.angle);
        const double x = e.major.estimate * std::cos(t), y = e.minor.estimate * std::sin(t);
        line.x.push_back(e.centre.x() + c * x - s * y);
        line.y.push_back(e.centre.y() + s * x + c * y);
    }
    return line;
}

Plot landing_plot(const Campaign& campaign) {
    Plot plot;
    plot.title = "Landing points, from the release";
    plot.width = plot.height = 640.0;
    plot.x.label = "east [m]";
    plot.y.label = "north [m]";
    PlotSeries points{.label = "", .colour = compare::blue};
    points.line = 0.0;
    points.marker = compare::MarkerShape::dot;
    const Columns& columns = campaign.of.front().columns;
    for (const std::vector<double>& row : campaign.results.examples) {
        points.x.push_back(row[*columns.of("landing_east_m")]);
        points.y.push_back(row[*columns.of("landing_north_m")]);
    }
    plot.series = {points};
    for (const Answer& answer : campaign.results.answers)
        if (answer.ellipse && answer.count > 2) plot.series.push_back(ellipse_series(answer));
    return plot;
}

std::string summary_of(const Campaign& campaign) {
    const CampaignResults& r = campaign.results;
    std::string body = fmt::format(
        "<p>{} of {} runs are there, {} of them complete; {} model, design {}, seed {}; {}.</p>\n", r.made,
        r.wanted, r.endings.complete, fidelity_name(campaign.spec.fidelity),
        design_name(campaign.spec.design), campaign.spec.seed, campaign.of.front().engine);
    body += html_table(answers_table(campaign), "Answers, each with its 95 % interval", "", "answers");
    if (campaign.both)
        body +=
            fmt::format("<p>{} pairs of runs, {} of them the pilot.</p>\n", campaign.both->pairs,
                        campaign.both->pilot) +
            html_table(pairs_table(*campaign.both), "The full model, by way of the reduced one", "", "pairs");
    for (const std::string& note : answer_notes(campaign))
        body += fmt::format("<p>{}</p>\n", xml_text(note));
    body += html_table(inputs_table(campaign), "What varies", "", "inputs");
    return page_section("summary", "Answers", body);
}

std::string metric_section(const Campaign& campaign, std::size_t m) {
    const Histogram& h = campaign.results.histograms[m];
    if (h.moments.count == 0) return {};
    std::string body = page_figure(histogram_plot(campaign, h)) + page_figure(exceedance_plot(campaign, h));
    const MetricIndices& indices = campaign.results.indices[m];
    body += html_table(
        indices_table(campaign, indices),
        fmt::format("Share of the variance of the {} that goes with each input, with its 95 % interval",
                    xml_text(metric_words(h.metric))),
        "", fmt::format("indices-{}", m));
    for (std::size_t i = 0; i < campaign.spec.inputs.size(); ++i)
        body += page_figure(scatter_plot(campaign, h.metric, i));
    return page_section(fmt::format("metric-{}", m), xml_text(metric_words(h.metric)), body);
}

}  // namespace

std::string campaign_page(const Campaign& campaign) {
    const CampaignResults& r = campaign.results;
    std::string page;
    page += summary_of(campaign);
    if (r.has_landing) page += page_section("landing", "Landing", page_figure(landing_plot(campaign)));
    for (std::size_t m = 0; m < r.histograms.size(); ++m)
        page += metric_section(campaign, m);
    std::string trails;
    for (const Answer& answer : r.answers)
        if (answer.trail.size() > 1) trails += page_figure(trail_plot(answer));
    if (!trails.empty()) page += page_section("intervals", "Intervals", trails);
    if (const auto failures = failures_table(campaign); !failures.rows.empty())
        page += page_section(
            "failures", "Runs that did not end as they should",
            html_table(failures, "Indices count from 0; <code>--rerun INDEX</code> runs one in full", "",
                       "failed"));
    return still_page(campaign.spec.name, "campaign", page);
}

}  // namespace twinchute::study
