#include "compare/report/cost_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "compare/report/escape.hpp"
#include "compare/report/svg_canvas.hpp"

namespace twinchute::compare {
namespace {

// [px] of a page; the inner frame holds the points, to its right stands the legend.
constexpr double width = 960, height = 600;
constexpr double left = 78, right = 700, top = 66, bottom = 536;
constexpr double half_marker = 4.5;
constexpr double letter = 5.6, line_height = 11.0;  // of the labels, an estimate: nobody measures fonts here
constexpr std::string_view ink = "#222222", faint = "#e4e4e4", dim = "#555555";

bool is_drawable(const CostPoint& p) {
    return std::isfinite(p.x) && p.x > 0.0 && std::isfinite(p.y) && p.y >= 0.0;
}

/// Whole decades to pixels.
struct LogAxis {
    int low = 0, high = 1;  // powers of ten
    double from = 0.0, to = 1.0;

    double at(double value) const {
        const double power = value > 0.0 ? std::log10(value) : low;
        return from + (std::max<double>(power, low) - low) / (high - low) * (to - from);
    }
};

LogAxis axis_of(double smallest, double largest, double from, double to) {
    constexpr double room = 0.1;  // decades: no marker sits on the frame
    LogAxis axis{static_cast<int>(std::floor(std::log10(smallest) - room)),
                 static_cast<int>(std::ceil(std::log10(largest) + room)), from, to};
    if (axis.high <= axis.low) axis.high = axis.low + 1;
    return axis;
}

struct Box {
    double x1, y1, x2, y2;
    bool meets(const Box& b) const { return x1 < b.x2 && b.x1 < x2 && y1 < b.y2 && b.y1 < y2; }
};

class Canvas : public SvgCanvas {
public:
    void power(double x, double y, std::string_view anchor, int exponent) {
        add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}">10<tspan dy="-5" font-size="9">{}</tspan></text>)",
            x, y, anchor, ink, exponent);
    }
    void marker(double x, double y, Shape shape, bool filled, std::string_view colour,
                std::string_view title) {
        const std::string paint =
            fmt::format(R"(fill="{}" stroke="{}" stroke-width="1.6")", filled ? colour : "#ffffff", colour);
        const double r = half_marker;
        std::string drawn;
        switch (shape) {
            case Shape::circle:
                drawn = fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" {}>)", x, y, r, paint);
                break;
            case Shape::square:
                drawn = fmt::format(R"(<path d="M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}Z" {}>)", x - 0.9 * r,
                                    y - 0.9 * r, 1.8 * r, 1.8 * r, -1.8 * r, paint);
                break;
            case Shape::triangle:
                drawn = fmt::format(R"(<path d="M{:.1f} {:.1f}l{:.1f} {:.1f}h{:.1f}Z" {}>)", x, y - 1.1 * r,
                                    1.1 * r, 2.0 * r, -2.2 * r, paint);
                break;
            case Shape::diamond:
                drawn = fmt::format(
                    R"(<path d="M{0:.1f} {1:.1f}l{2:.1f} {2:.1f}l{3:.1f} {2:.1f}l{3:.1f} {3:.1f}Z" {4}>)", x,
                    y - 1.2 * r, 1.2 * r, -1.2 * r, paint);
                break;
            case Shape::cross:
                drawn = fmt::format(
                    R"(<path d="M{:.1f} {:.1f}l{:.1f} {:.1f}m0 {:.1f}l{:.1f} {:.1f}" fill="none" stroke="{}" stroke-width="2">)",
                    x - r, y - r, 2 * r, 2 * r, -2 * r, -2 * r, 2 * r, colour);
                break;
        }
        const std::string_view closing = shape == Shape::circle ? "</circle>" : "</path>";
        add("{}<title>{}</title>{}", drawn, xml_text(title), closing);
    }
};

void draw_axes(Canvas& canvas, const CostPlot& plot, const LogAxis& x, const LogAxis& y) {
    // Beyond a dozen decades every second one is labelled.
    const int y_stride = y.high - y.low > 12 ? 2 : 1;
    for (int power = y.low; power <= y.high; ++power) {
        const double at = y.at(std::pow(10.0, power));
        canvas.line(left, at, right, at, faint);
        if ((power - y.low) % y_stride == 0) canvas.power(left - 8, at + 4.5, "end", power);
    }
    for (int power = x.low; power <= x.high; ++power) {
        const double at = x.at(std::pow(10.0, power));
        canvas.line(at, top, at, bottom, faint);
        canvas.power(at, bottom + 21, "middle", power);
        for (int i = 2; i < 10 && power < x.high; ++i) {
            const double minor = x.at(i * std::pow(10.0, power));
            canvas.line(minor, bottom, minor, bottom + 4, ink);
        }
    }
    canvas.line(left, bottom, right, bottom, ink);
    canvas.line(left, top, left, bottom, ink);
    canvas.words(0.5 * (left + right), height - 18, "middle", ink, plot.x_label);
    const double middle = 0.5 * (top + bottom);
    canvas.words(22, middle, "middle", ink, plot.y_label,
                 fmt::format(R"x( transform="rotate(-90 22 {:.1f})")x", middle));
}

/// Labels where they meet neither a marker nor each other: beside their marker, else farther off at the end
/// of a thin line. A label without room stays away; its marker keeps its title.
class Labels {
public:
    void block(const Box& box) { taken_.push_back(box); }

    void place(Canvas& canvas, double x, double y, const std::string& text) {
        const double length = letter * static_cast<double>(text.size());
        for (const Spot& spot : spots) {
            const double share = spot.anchor == "start" ? 0.0 : spot.anchor == "end" ? 1.0 : 0.5;
            const double x1 = x + spot.dx - share * length, base = y + spot.dy;
            const Box box{x1, base - line_height + 2, x1 + length, base + 2};
            const bool inside =
                box.x1 >= left + 2 && box.x2 <= right + 16 && box.y1 >= top && box.y2 <= bottom - 2;
            if (!inside || std::ranges::any_of(taken_, [&](const Box& b) { return b.meets(box); })) continue;
            taken_.push_back(box);
            if (std::abs(spot.dy) > 20)
                canvas.line(x, y, x + spot.dx, spot.dy > 0 ? box.y1 : box.y2, dim, R"( stroke-width="0.6")");
            canvas.words(x + spot.dx, base, spot.anchor, ink, text, R"( font-size="10.5")");
            return;
        }
    }

private:
    struct Spot {
        double dx, dy;  // [px] of the text's baseline from the marker
        std::string_view anchor;
    };
    static constexpr double gap = half_marker + 3;
    static constexpr std::array<Spot, 14> spots{{{gap, 3.5, "start"},
                                                 {-gap, 3.5, "end"},
                                                 {0, -gap, "middle"},
                                                 {0, gap + 8, "middle"},
                                                 {gap, -6, "start"},
                                                 {gap, 13, "start"},
                                                 {-gap, -6, "end"},
                                                 {-gap, 13, "end"},
                                                 {-14, 46, "end"},
                                                 {14, 46, "start"},
                                                 {-14, -36, "end"},
                                                 {14, -36, "start"},
                                                 {14, 62, "start"},
                                                 {14, -50, "start"}}};
    std::vector<Box> taken_;
};

void draw_levels(Canvas& canvas, const CostPlot& plot, const LogAxis& y, Labels& labels) {
    for (const CostLevel& level : plot.levels) {
        if (!(level.y > 0.0) || !std::isfinite(level.y)) continue;
        const double at = y.at(level.y);
        canvas.line(left, at, right, at, dim, R"( stroke-width="1.4" stroke-dasharray="7 4")");
        labels.block({left, at - 1, right, at + 1});
        const double length = letter * static_cast<double>(level.label.size());
        labels.block({left + 6, at - 14, left + 6 + length, at});
        canvas.words(left + 6, at - 5, "start", dim, level.label, R"( font-size="11")");
    }
}

void draw_points(Canvas& canvas, const CostPlot& plot, const LogAxis& x, const LogAxis& y, Labels& labels) {
    for (const CostFamily& family : plot.families) {
        std::string path;
        bool begun = false;
        for (const CostPoint& p : family.points) {
            if (!is_drawable(p)) continue;
            fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", begun && p.joined ? 'L' : 'M',
                           x.at(p.x), y.at(p.y));
            begun = true;
        }
        if (family.joined && begun)
            canvas.add(R"(<path d="{}" fill="none" stroke="{}" stroke-width="1.2" opacity="0.6"/>)", path,
                       family.colour);
    }
    for (const CostFamily& family : plot.families) {
        for (const CostPoint& p : family.points) {
            if (!is_drawable(p)) continue;
            const double px = x.at(p.x), py = y.at(p.y);
            labels.block({px - half_marker, py - half_marker, px + half_marker, py + half_marker});
            canvas.marker(px, py, p.shape, p.filled, family.colour, p.title);
        }
    }
    for (const int rank : {0, 1, 2})
        for (const CostFamily& family : plot.families)
            for (const CostPoint& p : family.points)
                if (is_drawable(p) && p.rank == rank && !p.label.empty())
                    labels.place(canvas, x.at(p.x), y.at(p.y), p.label);
}

/// Returns where it ends.
double draw_legend(Canvas& canvas, const CostPlot& plot) {
    double y = top + 12;
    const double x = right + 36;
    for (const CostFamily& family : plot.families) {
        if (std::ranges::none_of(family.points, is_drawable)) continue;
        if (family.joined) canvas.line(x - 11, y - 4, x + 11, y - 4, family.colour, R"( opacity="0.6")");
        canvas.marker(x, y - 4, family.shape, family.filled, family.colour, family.name);
        canvas.words(x + 18, y, "start", ink, family.name, R"( font-size="12")");
        y += 22;
    }
    y += 10;
    for (const std::string& note : plot.notes) {
        canvas.words(x - 11, y, "start", dim, note, R"( font-size="11")");
        y += 15;
    }
    return y;
}

}  // namespace

std::string cost_svg(const CostPlot& plot) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double x_low = infinity, x_high = 0, y_low = infinity, y_high = 0;
    for (const CostFamily& family : plot.families) {
        for (const CostPoint& p : family.points) {
            if (!is_drawable(p)) continue;
            x_low = std::min(x_low, p.x), x_high = std::max(x_high, p.x);
            if (p.y > 0.0) y_low = std::min(y_low, p.y), y_high = std::max(y_high, p.y);
        }
    }
    for (const CostLevel& level : plot.levels)
        if (level.y > 0.0 && std::isfinite(level.y) && x_high > 0.0)
            y_low = std::min(y_low, level.y), y_high = std::max(y_high, level.y);
    Canvas canvas;
    canvas.words(left, 26, "start", ink, plot.title, R"( font-size="16" font-weight="bold")");
    canvas.words(left, 46, "start", dim, plot.subtitle, R"( font-size="12")");
    if (!(x_high > 0.0) || !(y_high > 0.0)) {
        canvas.words(0.5 * (left + right), 0.5 * (top + bottom), "middle", dim, "no data");
    } else {
        const LogAxis x = axis_of(x_low, x_high, left, right), y = axis_of(y_low, y_high, bottom, top);
        Labels labels;
        draw_axes(canvas, plot, x, y);
        draw_levels(canvas, plot, y, labels);
        draw_points(canvas, plot, x, y, labels);
    }
    const double page = std::max(height, draw_legend(canvas, plot));  // failures may be many
    return canvas.sheet(width, page, plot.title + ": " + plot.subtitle);
}

}  // namespace twinchute::compare
