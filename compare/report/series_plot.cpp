// A series as pictures: one metric against another, laid out as printed figures are, with a colour for each
// group, each fidelity, and what a test measured; and the openings above each other.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/render/plot.hpp"
#include "compare/series.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

constexpr std::array colours{blue, vermillion, green, purple, orange, sky, ink};
constexpr const char* dashed = "6 4";

std::vector<std::string> groups_of(const CaseSeries& series) {
    std::vector<std::string> groups;
    for (const SeriesCase& one : series.cases)
        if (std::ranges::find(groups, one.group) == groups.end()) groups.push_back(one.group);
    return groups;
}

/// Filled and joined by a line: the reference. Hollow and dashed: the candidate.
PlotSeries look_of(bool is_reference, const char* colour, std::string label = {}) {
    return {.label = std::move(label),
            .colour = colour,
            .line = 1.6,
            .dash = is_reference ? "" : dashed,
            .marker = MarkerShape::circle,
            .filled = is_reference};
}

/// One fidelity of one group, by x.
PlotSeries curve_of(const CaseSeries& series, const std::string& group, bool is_reference,
                    const char* colour) {
    const MetricRow &across = *find_metric_row(series.spec.x), &up = *find_metric_row(series.spec.y);
    struct CasePoint {
        double x, y;
        std::string title;
    };
    std::vector<CasePoint> points;
    for (const SeriesCase& one : series.cases) {
        if (one.group != group || (!is_reference && !one.candidate)) continue;
        const SeriesSide& side = is_reference ? one.reference : *one.candidate;
        const auto x = side.value_of(across), y = side.value_of(up);
        if (!x || !y) continue;
        const double shown_x = shown(*x, across.unit).value, shown_y = shown(*y, up.unit).value;
        points.push_back(
            {shown_x, shown_y,
             fmt::format("{}, {}: {:.4g}, {:.4g}", one.name, side.row.fidelity, shown_x, shown_y)});
    }
    std::ranges::stable_sort(points, {}, &CasePoint::x);
    PlotSeries curve = look_of(is_reference, colour);
    for (CasePoint& point : points) {
        curve.x.push_back(point.x);
        curve.y.push_back(point.y);
        curve.notes.push_back({std::move(point.title)});
    }
    return curve;
}

Axis axis_of(std::string_view name) {
    const MetricRow* row = find_metric_row(name);
    return {.label = fmt::format("{} [{}]", row->title, row->unit.empty() ? "-" : shown_unit(row->unit)),
            .margin = 0.06};
}

std::vector<double> shown_all(std::vector<double> values, std::string_view metric) {
    const double factor = shown_factor(find_metric_row(metric)->unit);
    for (double& value : values)
        value *= factor;
    return values;
}

bool is_grouped(const std::vector<std::string>& groups) {
    return groups.size() > 1 || (groups.size() == 1 && !groups.front().empty());
}

/// A channel of each case; `end` [s]: of the axis, where the plot is to stop before the runs do.
Plot overlay(const CaseSeries& series, Curve SeriesSide::*channel, std::string title, std::string_view what,
             std::string_view unit, std::optional<double> end) {
    Plot plot{.title = std::move(title),
              .subtitle = series.title,
              .x = {.label = "time since snatch [s]", .end = end},
              .y = {.label = fmt::format("{} [{}]", what, shown_unit(unit)), .from_zero = true},
              .series = {},
              .width = 860,
              .height = 480,
              .beside = 270};
    const std::vector<std::string> groups = groups_of(series);
    const bool grouped = is_grouped(groups);
    for (std::size_t i = 0; i < series.cases.size(); ++i) {
        const SeriesCase& one = series.cases[i];
        const Curve& curve = one.reference.*channel;
        if (curve.time.empty()) continue;
        const std::size_t place =
            grouped ? static_cast<std::size_t>(std::ranges::find(groups, one.group) - groups.begin()) : i;
        constexpr std::array<const char*, 3> dashes{"", dashed, "2 3"};
        PlotSeries line{.label = grouped ? "" : one.name,
                        .colour = colours[place % colours.size()],
                        .x = curve.time,
                        .y = curve.value,
                        .line = 1.4,
                        .dash = dashes[place / colours.size() % dashes.size()]};
        for (double& value : line.y)
            value *= shown_factor(unit);
        plot.series.push_back(std::move(line));
    }
    for (std::size_t g = 0; grouped && g < groups.size(); ++g)  // colours alone, for the legend
        plot.series.push_back({.label = groups[g].empty() ? "no group" : groups[g],
                               .colour = colours[g % colours.size()],
                               .line = 10.0,
                               .dash = ""});
    return plot;
}

}  // namespace

Plot series_plot(const CaseSeries& series) {
    const bool compares = !series.candidate_title.empty();
    Plot plot{
        .title = series.title,
        .subtitle = compares ? fmt::format("{} cases at both fidelities", series.cases.size())
                             : fmt::format("{} cases of the {}", series.cases.size(), series.reference_title),
        .x = axis_of(series.spec.x),
        .y = axis_of(series.spec.y),
        .series = {look_of(true, dim, series.reference_title)},
        .width = 860,
        .height = 520,
        .beside = 270,
        .nothing = "no case has both metrics"};
    const std::vector<std::string> groups = groups_of(series);
    const bool grouped = is_grouped(groups);
    if (compares) plot.series.push_back(look_of(false, dim, series.candidate_title));
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const char* colour = colours[g % colours.size()];
        for (const bool is_reference : {true, false})
            plot.series.push_back(curve_of(series, groups[g], is_reference, colour));
    }
    if (compares || !series.spec.test.empty())
        plot.series.push_back(
            {.label = series.spec.test.empty() ? "test: none (series.test)" : series.spec.test,
             .x = shown_all(series.spec.test_x, series.spec.x),
             .y = shown_all(series.spec.test_y, series.spec.y),
             .line = 0.0,
             .marker = MarkerShape::cross});
    for (std::size_t g = 0; grouped && g < groups.size(); ++g)  // colours alone, for the legend
        plot.series.push_back({.label = groups[g].empty() ? "no group" : groups[g],
                               .colour = colours[g % colours.size()],
                               .line = 10.0});
    return plot;
}

std::vector<Plot> opening_plots(const CaseSeries& series) {
    double end = 0.0;
    bool any = false;
    for (const SeriesCase& one : series.cases) {
        end = std::max(end, 2.0 * one.reference.opening_end);
        any = any || !one.reference.force.time.empty();
    }
    if (!any) return {};
    const std::optional<double> opening = end > 0.0 ? std::optional(end) : std::nullopt;
    return {overlay(series, &SeriesSide::force, "Opening force", "opening force", "N", opening),
            overlay(series, &SeriesSide::speed, "Speed of the payload", "speed", "m/s", opening)};
}

}  // namespace twinchute::compare
