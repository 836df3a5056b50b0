// A series as a picture, laid out as printed figures are: one metric against another, a colour for each
// group, both fidelities, and what a test measured.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "compare/report/escape.hpp"
#include "compare/report/svg_canvas.hpp"
#include "compare/report/svg_plot.hpp"
#include "compare/series.hpp"

namespace twinchute::compare {
namespace {

// [px]
constexpr double width = 860, height = 520, left = 78, right = 590, top = 70, bottom = 452;
constexpr std::string_view ink = "#222222", faint = "#dddddd", dim = "#555555";
// Okabe and Ito: apart for every kind of colour vision.
constexpr std::array<std::string_view, 7> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#e69f00", "#56b4e9", "#222222"};
constexpr double room = 0.06;  // of an axis, beyond the outermost points

struct CasePoint {
    double x, y;
    std::string title;
};

/// One fidelity of one group.
struct GroupCurve {
    std::size_t group;
    bool is_reference;
    std::vector<CasePoint> points;  ///< by x
};

std::vector<std::string> groups_of(const CaseSeries& series) {
    std::vector<std::string> groups;
    for (const SeriesCase& one : series.cases)
        if (std::ranges::find(groups, one.group) == groups.end()) groups.push_back(one.group);
    return groups;
}

std::vector<GroupCurve> curves_of(const CaseSeries& series, const std::vector<std::string>& groups) {
    const MetricRow &across = *find_metric_row(series.spec.x), &up = *find_metric_row(series.spec.y);
    std::vector<GroupCurve> curves;
    for (std::size_t g = 0; g < groups.size(); ++g)
        for (const bool is_reference : {true, false}) {
            GroupCurve curve{g, is_reference, {}};
            for (const SeriesCase& one : series.cases) {
                if (one.group != groups[g]) continue;
                const SeriesSide& side = is_reference ? one.reference : one.candidate;
                const auto x = side.value_of(across), y = side.value_of(up);
                if (x && y)
                    curve.points.push_back(
                        {*x, *y, fmt::format("{}, {}: {:.4g}, {:.4g}", one.name, side.row.fidelity, *x, *y)});
            }
            std::ranges::stable_sort(curve.points, {}, &CasePoint::x);
            curves.push_back(std::move(curve));
        }
    return curves;
}

struct Axis {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    double from = 0.0, to = 1.0;

    void take(double value) {
        if (!std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void round() {
        const double more = high > low ? room * (high - low) : std::max(0.1 * std::abs(high), 1e-3);
        low -= more;
        high += more;
    }
    double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
};

std::string axis_label(std::string_view name) {
    const MetricRow* row = find_metric_row(name);
    return fmt::format("{} [{}]", row->title, row->unit.empty() ? "-" : row->unit);
}

void draw_axes(SvgCanvas& canvas, const Axis& x, const Axis& y, const SeriesSpec& spec) {
    const auto ticks = [](const Axis& axis, int wanted, auto&& draw) {
        const Ticks at = nice_ticks(axis.low, axis.high, wanted);
        for (const double value : at.values)
            if (value >= axis.low && value <= axis.high)
                draw(value, fmt::format("{:.{}f}", value, at.decimals));
    };
    ticks(x, 7, [&](double value, const std::string& words) {
        canvas.line(x.at(value), top, x.at(value), bottom, faint);
        canvas.words(x.at(value), bottom + 20, "middle", ink, words);
    });
    ticks(y, 7, [&](double value, const std::string& words) {
        canvas.line(left, y.at(value), right, y.at(value), faint);
        canvas.words(left - 8, y.at(value) + 4.5, "end", ink, words);
    });
    canvas.line(left, bottom, right, bottom, ink);
    canvas.line(left, top, left, bottom, ink);
    canvas.words(0.5 * (left + right), bottom + 46, "middle", ink, axis_label(spec.x));
    const double middle = 0.5 * (top + bottom);
    canvas.words(22, middle, "middle", ink, axis_label(spec.y),
                 fmt::format(R"x( transform="rotate(-90 22 {:.1f})")x", middle));
}

/// Filled and joined by a line: the reference. Hollow and dashed: the candidate.
void draw_mark(SvgCanvas& canvas, double x, double y, std::string_view colour, bool filled,
               const std::string& title) {
    canvas.add(
        R"(<circle cx="{:.1f}" cy="{:.1f}" r="4.5" fill="{}" stroke="{}" stroke-width="1.8"><title>{}</title></circle>)",
        x, y, filled ? colour : "#ffffff", colour, xml_text(title));
}

void draw_cross(SvgCanvas& canvas, double x, double y) {
    canvas.add(
        R"(<path d="M{0:.1f} {1:.1f}l10 10m-10 0l10 -10" stroke="{2}" stroke-width="1.6" fill="none"/>)",
        x - 5, y - 5, ink);
}

void draw_curve(SvgCanvas& canvas, const Axis& x, const Axis& y, const GroupCurve& curve) {
    const std::string_view colour = colours[curve.group % colours.size()];
    const std::string_view dash =
        curve.is_reference ? R"( stroke-width="1.6")" : R"( stroke-width="1.4" stroke-dasharray="6 4")";
    for (std::size_t i = 1; i < curve.points.size(); ++i)
        canvas.line(x.at(curve.points[i - 1].x), y.at(curve.points[i - 1].y), x.at(curve.points[i].x),
                    y.at(curve.points[i].y), colour, dash);
    for (const CasePoint& point : curve.points)
        draw_mark(canvas, x.at(point.x), y.at(point.y), colour, curve.is_reference, point.title);
}

void draw_legend(SvgCanvas& canvas, const CaseSeries& series, const std::vector<std::string>& groups) {
    const double x = right + 26;
    double y = top + 10;
    const auto entry = [&](std::string_view words) {
        canvas.words(x + 40, y + 4.5, "start", ink, words, R"( font-size="12")");
        y += 22;
    };
    canvas.line(x, y, x + 30, y, dim, R"( stroke-width="1.6")");
    draw_mark(canvas, x + 15, y, dim, true, "");
    entry(series.reference_title);
    canvas.line(x, y, x + 30, y, dim, R"( stroke-width="1.4" stroke-dasharray="6 4")");
    draw_mark(canvas, x + 15, y, dim, false, "");
    entry(series.candidate_title);
    draw_cross(canvas, x + 15, y);
    entry(series.spec.test.empty() ? "test: none (series.test)" : clean_text(series.spec.test).substr(0, 30));
    y += 8;
    if (groups.size() == 1 && groups.front().empty()) return;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        canvas.add(R"(<rect x="{:.1f}" y="{:.1f}" width="30" height="10" fill="{}"/>)", x, y - 5,
                   colours[g % colours.size()]);
        entry(groups[g].empty() ? "no group" : clean_text(groups[g]).substr(0, 34));
    }
}

}  // namespace

std::string series_svg(const CaseSeries& series) {
    const std::vector<std::string> groups = groups_of(series);
    const std::vector<GroupCurve> curves = curves_of(series, groups);
    Axis x, y;
    for (const GroupCurve& curve : curves)
        for (const CasePoint& point : curve.points)
            x.take(point.x), y.take(point.y);
    for (std::size_t i = 0; i < series.spec.test_x.size(); ++i)
        x.take(series.spec.test_x[i]), y.take(series.spec.test_y[i]);
    SvgCanvas canvas;
    canvas.words(left, 26, "start", ink, clean_text(series.title).substr(0, 90),
                 R"( font-size="16" font-weight="bold")");
    canvas.words(left, 48, "start", dim, fmt::format("{} cases at both fidelities", series.cases.size()),
                 R"( font-size="12")");
    if (!(x.low <= x.high)) {
        canvas.words(0.5 * (left + right), 0.5 * (top + bottom), "middle", dim, "no case has both metrics");
        return canvas.sheet(width, height, series.title);
    }
    x.round(), y.round();
    x.from = left, x.to = right, y.from = bottom, y.to = top;
    draw_axes(canvas, x, y, series.spec);
    for (const GroupCurve& curve : curves)
        draw_curve(canvas, x, y, curve);
    for (std::size_t i = 0; i < series.spec.test_x.size(); ++i)
        draw_cross(canvas, x.at(series.spec.test_x[i]), y.at(series.spec.test_y[i]));
    draw_legend(canvas, series, groups);
    return canvas.sheet(width, std::max(height, top + 110 + 22.0 * static_cast<double>(groups.size())),
                        series.title);
}

}  // namespace twinchute::compare
