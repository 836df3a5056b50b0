#include "compare/report/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "compare/report/escape.hpp"
#include "compare/report/svg_canvas.hpp"

namespace twinchute::compare {
namespace {

// [px] of a page 720 wide; the inner frame holds the curves.
constexpr double width = 720, height = 440;
constexpr double left = 78, right = 700, top = 112, bottom = 386;

constexpr std::string_view ink = "#222222", faint = "#dddddd", dim = "#555555";

using Canvas = SvgCanvas;

// Blue and vermillion of Okabe and Ito: apart for every kind of colour vision and in grey.
constexpr std::size_t most_dots = 400;  // of a test: more run together

std::string_view colour(Role role) {
    if (role == Role::test) return ink;
    return role == Role::reference ? "#0072b2" : "#d55e00";
}
std::string_view dash(Role role) {
    return role == Role::reference ? "none" : "8 4";
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void take(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    bool empty() const { return !(low <= high); }
};

/// From data to pixels along one axis.
struct Axis {
    Ticks ticks;
    double low = 0, high = 1, from = 0, to = 1;

    Axis(Range range, int wanted, double from_px, double to_px, bool round_up)
        : ticks(nice_ticks(range.low, range.high, wanted)), from(from_px), to(to_px) {
        low = ticks.values.front();
        high = ticks.values.back();
        if (round_up) return;
        high = range.high > range.low ? range.high : high;
        std::erase_if(ticks.values, [&](double tick) { return tick > high * (1 + 1e-9) + 1e-300; });
    }
    double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
};

std::string shortened(std::string_view text, std::size_t longest) {
    std::string clean = clean_text(text);
    std::size_t count = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
        if ((static_cast<unsigned char>(clean[i]) & 0xC0) == 0x80) continue;
        if (count++ == longest) return clean.substr(0, i) + "...";
    }
    return clean;
}

std::string tick_text(double value, int decimals) {
    return fmt::format("{:.{}f}", std::abs(value) < 0.5 * std::pow(10.0, -decimals) ? 0.0 : value, decimals);
}

void draw_axes(Canvas& canvas, const Plot& plot, const Axis& x, const Axis& y) {
    for (const double tick : y.ticks.values) {
        canvas.line(left, y.at(tick), right, y.at(tick), faint);
        canvas.words(left - 8, y.at(tick) + 4.5, "end", ink, tick_text(tick, y.ticks.decimals));
    }
    for (const double tick : x.ticks.values) {
        canvas.line(x.at(tick), bottom, x.at(tick), bottom + 5, ink);
        canvas.words(x.at(tick), bottom + 20, "middle", ink, tick_text(tick, x.ticks.decimals));
    }
    canvas.line(left, bottom, right, bottom, ink);
    canvas.line(left, top, left, bottom, ink);
    canvas.words(0.5 * (left + right), height - 12, "middle", ink, plot.x_label);
    const double middle = 0.5 * (top + bottom);
    canvas.words(20, middle, "middle", ink, plot.y_label,
                 fmt::format(R"x( transform="rotate(-90 20 {:.1f})")x", middle));
}

void draw_heading(Canvas& canvas, const Plot& plot) {
    canvas.words(left, 26, "start", ink, plot.title, R"( font-size="16" font-weight="bold")");
    canvas.words(left, 45, "start", dim, shortened(plot.subtitle, 90), R"( font-size="12")");
    double x = left;
    for (const Series& series : plot.series) {
        if (series.role == Role::test) {  // in the line of the subtitle, which has room at its end
            canvas.words(right, 45, "end", ink, "\u25e6 " + shortened(series.label, 40),
                         R"( font-size="12")");
            continue;
        }
        canvas.line(x, 67, x + 34, 67, colour(series.role),
                    fmt::format(R"( stroke-width="2.2" stroke-dasharray="{}")", dash(series.role)));
        canvas.words(x + 42, 71.5, "start", ink, shortened(series.label, 42));
        x += 0.5 * (right - left);
    }
}

/// Lines through the frame, words above it where no curve can run through them.
void draw_markers(Canvas& canvas, const Plot& plot, const Axis& x) {
    std::vector<PlotMarker> markers = plot.markers;
    std::erase_if(markers,
                  [&](const PlotMarker& marker) { return !(marker.x >= x.low && marker.x <= x.high); });
    std::ranges::stable_sort(markers, {}, &PlotMarker::x);
    constexpr double room = 130;  // [px] for a label
    for (std::size_t i = 0; i < markers.size(); ++i) {
        const double at = x.at(markers[i].x);
        const bool last = i + 1 == markers.size();
        // The first one's words go to its left and the last one's to its right; what has no room
        // there goes to the other side, a line higher.
        bool to_left = i == 0 && !last;
        const bool cramped = to_left ? at < left + room : at > right - room;
        if (cramped) to_left = !to_left;
        const double row = top - (cramped || (i > 0 && !last) ? 22 : 7);
        canvas.line(at, top - 4, at, bottom, colour(markers[i].role), R"( stroke-dasharray="2 3")");
        canvas.words(to_left ? at - 4 : at + 4, row, to_left ? "end" : "start", colour(markers[i].role),
                     shortened(markers[i].label, 24), R"( font-size="12")");
    }
}

/// Differences and shares of what is larger are not finite any more.
bool is_drawable(double value) {
    return std::abs(value) <= 1e100;  // not of a NaN either
}

/// The runs of drawable points inside [low, high], so that gaps in the data stay gaps.
std::vector<std::vector<Point>> runs_of(const Series& series, double low, double high) {
    std::vector<std::vector<Point>> runs(1);
    const std::size_t count = std::min(series.x.size(), series.y.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Point point{series.x[i], series.y[i]};
        if (!is_drawable(point.x) || !is_drawable(point.y)) {
            if (!runs.back().empty()) runs.emplace_back();
        } else if (point.x >= low && point.x <= high) {
            runs.back().push_back(point);
        }
    }
    return runs;
}

void draw_series(Canvas& canvas, const Series& series, const Axis& x, const Axis& y) {
    std::string path;
    for (const auto& run : runs_of(series, x.low, x.high)) {
        if (series.role == Role::test) {
            for (const Point& point : thinned(run, most_dots / 4))
                canvas.add(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2" fill="none" stroke="{}"/>)",
                           x.at(point.x), y.at(point.y), ink);
            continue;
        }
        char command = 'M';
        for (const Point& point : thinned(run, static_cast<std::size_t>(right - left))) {
            fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, x.at(point.x),
                           y.at(point.y));
            command = 'L';
        }
    }
    if (path.empty()) return;
    canvas.add(
        R"(<path d="{}" fill="none" stroke="{}" stroke-width="2.2" stroke-linejoin="round" stroke-dasharray="{}"/>)",
        path, colour(series.role), dash(series.role));
}

}  // namespace

Ticks nice_ticks(double low, double high, int wanted) {
    // A constant still gets an axis; so does what differs by round-off only, whose ticks would be the same
    // number over and over.
    const double size = std::max(std::abs(low), std::abs(high));
    if (!(high - low > std::max(1e-9 * size, 1e-100))) {
        const double margin = size < 1e-100 ? 1 : 0.1 * size;
        low -= margin;
        high += margin;
    }
    const double rough = (high - low) / std::max(1, wanted);
    const int power = static_cast<int>(std::floor(std::log10(rough)));
    const double unit = std::pow(10.0, power);
    const double ratio = rough / unit;
    const double factor = ratio <= 1.0 ? 1 : ratio <= 2.0 ? 2 : ratio <= 5.0 ? 5 : 10;
    const double step = factor * unit;
    Ticks ticks;
    ticks.decimals = std::clamp(factor == 10 ? -power - 1 : -power, 0, 12);
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    for (double i = first; i <= last; ++i)
        ticks.values.push_back(i * step);
    return ticks;
}

std::vector<Point> thinned(const std::vector<Point>& points, std::size_t buckets) {
    if (buckets == 0 || points.size() <= 4 * buckets) return points;
    const double low = points.front().x, span = points.back().x - low;
    const auto bucket_of = [&](const Point& point) {
        const double share = span > 0 ? std::clamp((point.x - low) / span, 0.0, 1.0) : 0;
        return std::min(buckets - 1, static_cast<std::size_t>(share * static_cast<double>(buckets)));
    };
    std::vector<Point> kept;
    for (auto begin = points.begin(); begin != points.end();) {
        const std::size_t bucket = bucket_of(*begin);
        const auto end =
            std::find_if(begin, points.end(), [&](const Point& p) { return bucket_of(p) != bucket; });
        const auto [lowest, highest] =
            std::minmax_element(begin, end, [](const Point& a, const Point& b) { return a.y < b.y; });
        std::array chosen{begin, lowest, highest, std::prev(end)};
        std::ranges::sort(chosen);
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            if (i == 0 || chosen[i] != chosen[i - 1]) kept.push_back(*chosen[i]);
        }
        begin = end;
    }
    return kept;
}

std::string svg_plot(const Plot& plot) {
    Range xs, ys;
    const double end = plot.x_end.value_or(std::numeric_limits<double>::infinity());
    for (const Series& series : plot.series) {
        for (const auto& run : runs_of(series, -std::numeric_limits<double>::infinity(), end)) {
            for (const Point& point : run) {
                xs.take(point.x);
                ys.take(point.y);
            }
        }
    }
    Canvas canvas;
    draw_heading(canvas, plot);
    if (xs.empty()) {
        canvas.words(0.5 * (left + right), 0.5 * (top + bottom), "middle", dim, "no data");
    } else {
        ys.take(ys.high + 0.03 * std::abs(ys.high));  // air above the highest point
        ys.take(0);  // forces and speeds: their size is the message, so the axis starts at nothing
        const Axis x(xs, 8, left, right, false), y(ys, 6, bottom, top, true);
        draw_axes(canvas, plot, x, y);
        draw_markers(canvas, plot, x);
        for (const Series& series : plot.series)
            draw_series(canvas, series, x, y);
    }
    return canvas.sheet(width, height, plot.title + ": " + plot.subtitle);
}

}  // namespace twinchute::compare
