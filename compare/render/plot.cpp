#include "compare/render/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "compare/render/escape.hpp"
#include "compare/render/svg_canvas.hpp"
#include "compare/render/ticks.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

constexpr std::string_view faint = "#dddddd", sheet = "#ffffff";
constexpr double half_marker = 4.5, legend_line = 34.0;  // [px]
constexpr double letter = 5.6;         // [px] of a label, an estimate: nobody measures fonts here
constexpr std::size_t max_dots = 400;  // more run together

constexpr double max_size = 1e100, min_positive = 1e-100;  // beyond, shares and powers of ten overflow

bool is_drawable(double value) {
    return std::abs(value) <= max_size;  // not of a NaN either
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    void take(double value, bool logarithmic) {
        if (logarithmic && value < min_positive) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    bool empty() const { return !(low <= high); }
};

struct Tick {
    double value;
    std::string text;               ///< none: a small mark
    std::optional<int> power = {};  ///< of ten, in place of a text
};

/// Data to pixels along one axis.
struct Scale {
    bool logarithmic;
    double low, high, from, to;
    std::vector<Tick> ticks = {};

    Scale(const Axis& axis, Range range, double from_px, double to_px)
        : logarithmic(axis.logarithmic), low(range.low), high(range.high), from(from_px), to(to_px) {
        if (logarithmic)
            set_decades(axis.margin);
        else
            set_even(axis);
    }
    double at(double value) const {
        const double share = logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low)
                                         : (value - low) / (high - low);
        return from + share * (to - from);
    }

private:
    void set_even(const Axis& axis) {
        const double margin = axis.margin * (high - low);
        low -= margin;
        high += axis.from_zero ? 0.03 * std::abs(high) : margin;
        if (axis.from_zero) low = std::min(low, 0.0), high = std::max(high, 0.0);
        Ticks at = nice_ticks(low, high, axis.from_zero ? 6 : 8);
        const auto is_outside = [&](double tick) { return tick < low || tick > high * (1 + 1e-9) + 1e-300; };
        if (axis.from_zero || std::ranges::count_if(at.values, std::not_fn(is_outside)) < 2)
            low = at.values.front(), high = at.values.back();
        if (axis.end) high = std::min(high, std::max(*axis.end, low));
        std::erase_if(at.values, is_outside);
        for (const double tick : at.values)
            ticks.push_back(
                {tick,
                 fmt::format("{:.{}f}", std::abs(tick) < 0.5 * std::pow(10.0, -at.decimals) ? 0.0 : tick,
                             at.decimals)});
    }

    /// Whole decades from two on; digits between powers of ten below that.
    void set_decades(double margin) {
        low *= std::pow(10.0, -margin);
        high *= std::pow(10.0, margin);
        const bool dense = high / low < 100.0;
        if (!dense || !(high > low)) {
            low = std::pow(10.0, std::floor(std::log10(low)));
            high = std::pow(10.0, std::ceil(std::log10(high)));
            if (!(high > low)) high = 10.0 * low;
        }
        const int first = static_cast<int>(std::floor(std::log10(low) + 1e-9)),
                  last = static_cast<int>(std::ceil(std::log10(high) - 1e-9));
        const int stride = last - first > 12 ? 2 : 1;  // of labels
        for (int power = first; power <= last; ++power)
            for (int digit = 1; digit < (stride == 1 ? 10 : 2); ++digit) {
                const double value = digit * std::pow(10.0, power);
                if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
                Tick& tick = ticks.emplace_back(Tick{value, ""});
                if (dense && (digit == 1 || digit == 2 || digit == 5))
                    tick.text = readable(value, 1);
                else if (!dense && digit == 1 && (power - first) % stride == 0)
                    tick.power = power;
            }
    }
};

struct Frame {
    double left = 78.0, right, top, bottom;

    explicit Frame(const Plot& plot)
        : right(plot.width - (plot.beside > 0.0 ? plot.beside : 20.0)),
          top(plot.beside > 0.0 ? 66.0 : 90.0 + 22.0 * std::ceil(0.5 * legend_entries(plot))),
          bottom(plot.height - 58.0) {}
    double middle() const { return 0.5 * (left + right); }

private:
    static double legend_entries(const Plot& plot) {
        return static_cast<double>(
            std::ranges::count_if(plot.series, [](const PlotSeries& s) { return !s.label.empty(); }));
    }
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

/// Paths about the marker's place [px].
std::string_view path_of(MarkerShape shape) {
    switch (shape) {
        case MarkerShape::square:
            return "M-4 -4h8v8h-8Z";
        case MarkerShape::triangle:
            return "M0 -5l5 9h-10Z";
        case MarkerShape::diamond:
            return "M0 -5.4l5.4 5.4l-5.4 5.4l-5.4 -5.4Z";
        case MarkerShape::cross:
            return "M-4.5 -4.5l9 9m0 -9l-9 9";
        default:
            return {};
    }
}

void draw_marker(SvgCanvas& canvas, double x, double y, const PlotSeries& series, const std::string& title) {
    if (series.marker == MarkerShape::none) return;
    const std::string_view path = path_of(series.marker);
    const std::string shape =
        path.empty() ? fmt::format(R"(circle cx="{:.1f}" cy="{:.1f}" r="{}")", x, y,
                                   series.marker == MarkerShape::dot ? 2.0 : half_marker)
                     : fmt::format(R"x(path d="{}" transform="translate({:.1f} {:.1f})")x", path, x, y);
    const std::string_view fill = series.marker == MarkerShape::cross ? std::string_view("none")
                                  : series.filled                     ? std::string_view(series.colour)
                                                                      : sheet;
    canvas.add(R"(<{} fill="{}" stroke="{}" stroke-width="1.6">{}</{}>)", shape, fill, series.colour,
               title.empty() ? "" : "<title>" + xml_text(title) + "</title>",
               path.empty() ? "circle" : "path");
}

void draw_axes(SvgCanvas& canvas, const Plot& plot, const Frame& f, const Scale& x, const Scale& y) {
    const auto label = [&](const Tick& tick, double px, double py, std::string_view anchor) {
        if (tick.power)
            canvas.add(
                R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}">10<tspan dy="-5" font-size="9">{}</tspan></text>)",
                px, py, anchor, ink, *tick.power);
        else
            canvas.words(px, py, anchor, ink, tick.text);
    };
    for (const Tick& tick : y.ticks) {
        const bool small = tick.text.empty() && !tick.power;
        const double at = y.at(tick.value);
        canvas.line(small ? f.left - 4 : f.left, at, small ? f.left : f.right, at, small ? ink : faint);
        if (!small) label(tick, f.left - 8, at + 4.5, "end");
    }
    for (const Tick& tick : x.ticks) {
        const bool small = tick.text.empty() && !tick.power;
        const double at = x.at(tick.value);
        if (plot.beside > 0.0 && !small) canvas.line(at, f.top, at, f.bottom, faint);
        canvas.line(at, f.bottom, at, f.bottom + (small ? 4 : 5), ink);
        if (!small) label(tick, at, f.bottom + 20, "middle");
    }
    canvas.line(f.left, f.bottom, f.right, f.bottom, ink);
    canvas.line(f.left, f.top, f.left, f.bottom, ink);
    canvas.words(f.middle(), plot.height - 14, "middle", ink, plot.x.label);
    const double middle = 0.5 * (f.top + f.bottom);
    canvas.words(20, middle, "middle", ink, plot.y.label,
                 fmt::format(R"x( transform="rotate(-90 20 {:.1f})")x", middle));
}

std::string stroke_of(const PlotSeries& series) {
    return fmt::format(R"( stroke-width="{:g}"{})", series.line,
                       series.dash.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", series.dash));
}

/// Two to a row above the frame, or one below the other beside it. Returns where it ends.
double draw_legend(SvgCanvas& canvas, const Plot& plot, const Frame& f) {
    const bool above = plot.beside <= 0.0;
    const double first = above ? f.left : f.right + 22;
    double x = first, y = above ? 67.0 : f.top + 8;
    for (const PlotSeries& series : plot.series) {
        if (series.label.empty()) continue;
        if (series.line > 0.0) canvas.line(x, y, x + legend_line, y, series.colour, stroke_of(series));
        draw_marker(canvas, x + 0.5 * legend_line, y, series, "");
        canvas.words(x + legend_line + 8, y + 4.5, "start", ink, shortened(series.label, 42));
        const bool ends_row = !above || x > first;
        y += ends_row ? 22 : 0;
        x = ends_row ? first : f.middle();
    }
    y += 12;
    for (const std::string& note : plot.notes) {
        canvas.words(first, y, "start", dim, note, R"( font-size="11.5")");
        y += 16;
    }
    return y;
}

/// Lines through the frame, words above it where no curve can run through them.
void draw_markers(SvgCanvas& canvas, const Plot& plot, const Frame& f, const Scale& x) {
    std::vector<GuideLine> markers = plot.markers;
    std::erase_if(markers,
                  [&](const GuideLine& marker) { return !(marker.at >= x.low && marker.at <= x.high); });
    std::ranges::stable_sort(markers, {}, &GuideLine::at);
    constexpr double room = 130;  // [px] for a label
    struct Taken {
        int row;
        double from, to;
    };
    std::vector<Taken> taken;
    for (std::size_t i = 0; i < markers.size(); ++i) {
        const double at = x.at(markers[i].at);
        const bool last = i + 1 == markers.size();
        // The first one's words go to its left and the last one's to its right; what has no room
        // there goes to the other side, a line higher; so does what would cover the words before.
        bool to_left = i == 0 && !last;
        const bool cramped = to_left ? at < f.left + room : at > f.right - room;
        if (cramped) to_left = !to_left;
        int row = cramped || (i > 0 && !last) ? 1 : 0;
        const std::string label = shortened(markers[i].label, 24);
        const double length = 1.15 * letter * static_cast<double>(label.size());
        const auto place = [&](bool left, int line) {
            return left ? Taken{line, at - 4 - length, at - 4} : Taken{line, at + 4, at + 4 + length};
        };
        const auto is_free = [&](const Taken& here) {
            return here.to < f.right + 40 && std::ranges::none_of(taken, [&](const Taken& other) {
                       return other.row == here.row && other.from < here.to && here.from < other.to;
                   });
        };
        for (const auto& [left, line] : {std::pair(to_left, row), std::pair(to_left, 1 - row),
                                         std::pair(!to_left, row), std::pair(!to_left, 1 - row)})
            if (is_free(place(left, line))) {
                to_left = left, row = line;
                break;
            }
        taken.push_back(place(to_left, row));
        canvas.line(at, f.top - 4, at, f.bottom, markers[i].colour, R"( stroke-dasharray="2 3")");
        canvas.words(to_left ? at - 4 : at + 4, f.top - (row == 1 ? 22 : 7), to_left ? "end" : "start",
                     markers[i].colour, label, R"( font-size="12")");
    }
}

/// Labels where they meet neither a marker nor each other: beside their marker, else farther off at the end
/// of a thin line. A label without room stays away; its marker keeps its title.
class Labels {
public:
    explicit Labels(const Frame& frame) : frame_(frame) {}

    void block(double x1, double y1, double x2, double y2) { taken_.push_back({x1, y1, x2, y2}); }

    void place(SvgCanvas& canvas, double x, double y, const std::string& text) {
        const double length = letter * static_cast<double>(text.size());
        for (const Spot& spot : spots) {
            const double share = spot.anchor == "start" ? 0.0 : spot.anchor == "end" ? 1.0 : 0.5;
            const double x1 = x + spot.dx - share * length, base = y + spot.dy;
            const Box box{x1, base - 9.0, x1 + length, base + 2.0};
            const bool inside = box.x1 >= frame_.left + 2 && box.x2 <= frame_.right + 16 &&
                                box.y1 >= frame_.top && box.y2 <= frame_.bottom - 2;
            if (!inside || std::ranges::any_of(taken_, [&](const Box& b) { return b.meets(box); })) continue;
            taken_.push_back(box);
            if (std::abs(spot.dy) > 20)
                canvas.line(x, y, x + spot.dx, spot.dy > 0 ? box.y1 : box.y2, dim, R"( stroke-width="0.6")");
            canvas.words(x + spot.dx, base, spot.anchor, ink, text, R"( font-size="10.5")");
            return;
        }
    }

private:
    struct Box {
        double x1, y1, x2, y2;
        bool meets(const Box& b) const { return x1 < b.x2 && b.x1 < x2 && y1 < b.y2 && b.y1 < y2; }
    };
    struct Spot {
        double dx, dy;  // [px] of the text's baseline from the marker
        std::string_view anchor;
    };
    static constexpr double gap = half_marker + 3;
    static constexpr std::array<Spot, 14> spots{{{gap, -6, "start"},
                                                 {gap, 3.5, "start"},
                                                 {-gap, 3.5, "end"},
                                                 {0, -gap, "middle"},
                                                 {0, gap + 8, "middle"},
                                                 {gap, 13, "start"},
                                                 {-gap, -6, "end"},
                                                 {-gap, 13, "end"},
                                                 {-14, 46, "end"},
                                                 {14, 46, "start"},
                                                 {-14, -36, "end"},
                                                 {14, -36, "start"},
                                                 {14, 62, "start"},
                                                 {14, -50, "start"}}};
    const Frame& frame_;
    std::vector<Box> taken_;
};

/// Levels that are drawn, and their words above them at the left.
void draw_levels(SvgCanvas& canvas, const Plot& plot, const Frame& f, const Scale& y, Labels& labels) {
    for (const GuideLine& level : plot.levels) {
        if (!(level.at >= y.low && level.at <= y.high)) continue;
        const double at = y.at(level.at);
        canvas.line(f.left, at, f.right, at, level.colour, R"( stroke-width="1.4" stroke-dasharray="7 4")");
        labels.block(f.left, at - 1, f.right, at + 1);
        labels.block(f.left + 6, at - 14, f.left + 6 + letter * static_cast<double>(level.label.size()), at);
        canvas.words(f.left + 6, at - 5, "start", level.colour, level.label, R"( font-size="11")");
    }
}

bool is_shown(const Plot& plot, double x, double y) {
    return is_drawable(x) && is_drawable(y) && (!plot.x.logarithmic || x >= min_positive) &&
           (!plot.y.logarithmic || y >= 0.0) && !(plot.x.end && x > *plot.x.end);
}

/// The runs of points that are shown, so that gaps in the data stay gaps.
std::vector<std::vector<Point>> runs_of(const Plot& plot, const PlotSeries& series) {
    std::vector<std::vector<Point>> runs(1);
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
        if (is_shown(plot, series.x[i], series.y[i]))
            runs.back().push_back({series.x[i], series.y[i]});
        else if (!runs.back().empty())
            runs.emplace_back();
    }
    return runs;
}

void draw_line(SvgCanvas& canvas, const Plot& plot, const PlotSeries& series, const Frame& f, const Scale& x,
               const Scale& y) {
    std::string path;
    for (const auto& run : runs_of(plot, series)) {
        char command = 'M';
        for (const Point& point : thinned(run, static_cast<std::size_t>(f.right - f.left))) {
            fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, x.at(point.x),
                           y.at(std::min(point.y, plot.y.end.value_or(point.y))));
            command = 'L';
        }
    }
    if (!path.empty())
        canvas.add(R"(<path d="{}" fill="none" stroke="{}" stroke-linejoin="round"{}/>)", path, series.colour,
                   stroke_of(series));
}

void draw_points(SvgCanvas& canvas, const Plot& plot, const PlotSeries& series, const Scale& x,
                 const Scale& y, Labels& labels) {
    if (series.notes.empty()) {
        for (const auto& run : runs_of(plot, series))
            for (const Point& point : thinned(run, max_dots / 4))
                if (!(plot.y.end && point.y > *plot.y.end))
                    draw_marker(canvas, x.at(point.x), y.at(point.y), series, "");
        return;
    }
    for (std::size_t i = 0; i < series.notes.size(); ++i) {
        if (!is_shown(plot, series.x[i], series.y[i])) continue;
        const double px = x.at(series.x[i]), py = y.at(series.y[i]), r = half_marker;
        labels.block(px - r, py - r, px + r, py + r);
        draw_marker(canvas, px, py, series, series.notes[i].title);
    }
}

void draw_labels(SvgCanvas& canvas, const Plot& plot, const Scale& x, const Scale& y, Labels& labels) {
    for (const int rank : {0, 1, 2})
        for (const PlotSeries& series : plot.series)
            for (std::size_t i = 0; i < series.notes.size(); ++i)
                if (const PointNote& note = series.notes[i];
                    note.rank == rank && !note.label.empty() && is_shown(plot, series.x[i], series.y[i]))
                    labels.place(canvas, x.at(series.x[i]), y.at(series.y[i]), note.label);
}

void draw_data(SvgCanvas& canvas, const Plot& plot, const Frame& f, const Scale& x, const Scale& y) {
    Labels labels(f);
    draw_axes(canvas, plot, f, x, y);
    draw_markers(canvas, plot, f, x);
    draw_levels(canvas, plot, f, y, labels);
    for (const PlotSeries& series : plot.series)
        if (series.line > 0.0) draw_line(canvas, plot, series, f, x, y);
    for (const PlotSeries& series : plot.series)
        if (series.marker != MarkerShape::none) draw_points(canvas, plot, series, x, y, labels);
    draw_labels(canvas, plot, x, y, labels);
}

}  // namespace

std::string svg_plot(const Plot& plot) {
    Range xs, ys;
    for (const PlotSeries& series : plot.series)
        for (const auto& run : runs_of(plot, series))
            for (const Point& point : run) {
                xs.take(point.x, plot.x.logarithmic);
                ys.take(std::min(point.y, plot.y.end.value_or(point.y)), plot.y.logarithmic);
            }
    const Frame frame(plot);
    SvgCanvas canvas;
    canvas.words(frame.left, 26, "start", ink, shortened(plot.title, 90),
                 R"( font-size="16" font-weight="bold")");
    canvas.words(frame.left, 45, "start", dim, shortened(plot.subtitle, 90), R"( font-size="12")");
    if (xs.empty() || ys.empty()) {
        canvas.words(frame.middle(), 0.5 * (frame.top + frame.bottom), "middle", dim, plot.nothing);
    } else {
        for (const GuideLine& level : plot.levels)
            if (is_drawable(level.at)) ys.take(level.at, plot.y.logarithmic);
        draw_data(canvas, plot, frame, Scale(plot.x, xs, frame.left, frame.right),
                  Scale(plot.y, ys, frame.bottom, frame.top));
    }
    const double end = draw_legend(canvas, plot, frame);
    return canvas.sheet(plot.width, plot.beside > 0.0 ? std::max(plot.height, end) : plot.height,
                        plot.title + ": " + plot.subtitle);
}

}  // namespace twinchute::compare
