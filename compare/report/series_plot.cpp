// A series as a picture, laid out as printed figures are: one metric against another, a colour for each
// group, both fidelities, and what a test measured.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "compare/render/plot.hpp"
#include "compare/series.hpp"

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
        const SeriesSide& side = is_reference ? one.reference : one.candidate;
        const auto x = side.value_of(across), y = side.value_of(up);
        if (one.group == group && x && y)
            points.push_back(
                {*x, *y, fmt::format("{}, {}: {:.4g}, {:.4g}", one.name, side.row.fidelity, *x, *y)});
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
    return {.label = fmt::format("{} [{}]", row->title, row->unit.empty() ? "-" : row->unit), .margin = 0.06};
}

}  // namespace

std::string series_svg(const CaseSeries& series) {
    Plot plot{
        .title = series.title,
        .subtitle = fmt::format("{} cases at both fidelities", series.cases.size()),
        .x = axis_of(series.spec.x),
        .y = axis_of(series.spec.y),
        .series = {look_of(true, dim, series.reference_title), look_of(false, dim, series.candidate_title)},
        .width = 860,
        .height = 520,
        .beside = 270,
        .nothing = "no case has both metrics"};
    const std::vector<std::string> groups = groups_of(series);
    const bool grouped = groups.size() > 1 || (groups.size() == 1 && !groups.front().empty());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const char* colour = colours[g % colours.size()];
        for (const bool is_reference : {true, false})
            plot.series.push_back(curve_of(series, groups[g], is_reference, colour));
    }
    plot.series.push_back({.label = series.spec.test.empty() ? "test: none (series.test)" : series.spec.test,
                           .x = series.spec.test_x,
                           .y = series.spec.test_y,
                           .line = 0.0,
                           .marker = MarkerShape::cross});
    for (std::size_t g = 0; grouped && g < groups.size(); ++g)  // colours alone, for the legend
        plot.series.push_back({.label = groups[g].empty() ? "no group" : groups[g],
                               .colour = colours[g % colours.size()],
                               .line = 10.0});
    return svg_plot(plot);
}

}  // namespace twinchute::compare
