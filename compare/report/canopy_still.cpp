// A few moments of the opening side by side, as a drawing that needs no script: shaded fabric, lines,
// payload.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "compare/report/html_parts.hpp"
#include "lib/math/vec.hpp"

namespace twinchute::compare {
namespace {

constexpr double picture_height = 340, caption = 44, gap = 14, margin = 10;  // [px]
constexpr double full_width = 960;                                           // [px]
constexpr std::size_t most_moments = 7;
constexpr double deployment_seen = 0.35;  // before snatch, as a share of the deployment
constexpr int shades = 5;
constexpr std::size_t most_shaded = 6000;  // triangles; a finer mesh is drawn by its tapes and lines

/// Place of a point as the eye sees it, north of the payload and level with it.
struct Seen {
    double x = 0.0, y = 0.0, depth = 0.0;  // [m] to the right, up, toward the eye
};

Vec3 place(const ShapeFrame& frame, std::size_t node) {
    Vec3 x;
    for (int k = 0; k < 3; ++k)
        x[k] = frame.corner[static_cast<std::size_t>(k)] +
               frame.step * frame.place[3 * node + static_cast<std::size_t>(k)];
    return x;
}

/// Horizontal and across the eye: the way that the payload drifts, so that a slanting flight is seen from its
/// side.
Vec3 drift_of(const ShapeFrames& shape) {
    Vec3 way = place(shape.frames.back(), shape.payload) - place(shape.frames.front(), shape.payload);
    const double fall = std::abs(way.z());
    way.z() = 0.0;
    return way.norm() > 0.05 * fall && way.norm() > 0.0 ? Vec3(way.normalized()) : Vec3(Vec3::UnitX());
}

/// A frame as seen, the payload at the origin.
struct Moment {
    const ShapeFrame* frame;
    std::string name;
    std::vector<Seen> node;
    double left = 0, right = 0, low = 0, high = 0;  // [m]
};

Moment moment_of(const ShapeFrames& shape, std::size_t index, std::string name, const Vec3& across) {
    Moment moment{&shape.frames[index], std::move(name), {}};
    const Vec3 toward = Vec3::UnitZ().cross(across), origin = place(*moment.frame, shape.payload);
    moment.node.reserve(shape.nodes);
    for (std::size_t i = 0; i < shape.nodes; ++i) {
        const Vec3 arm = place(*moment.frame, i) - origin;
        moment.node.push_back({across.dot(arm), arm.z(), -toward.dot(arm)});
        moment.left = std::min(moment.left, moment.node.back().x);
        moment.right = std::max(moment.right, moment.node.back().x);
        moment.low = std::min(moment.low, moment.node.back().y);
        moment.high = std::max(moment.high, moment.node.back().y);
    }
    return moment;
}

struct Wanted {
    double time;
    std::string name;
};

std::size_t nearest(const ShapeFrames& shape, double time) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < shape.frames.size(); ++i)
        if (std::abs(shape.frames[i].time - time) < std::abs(shape.frames[best].time - time)) best = i;
    return best;
}

/// Moments with a name, and the times between them; those that fall on one frame are one.
std::vector<std::pair<std::size_t, std::string>> chosen(const ShapeFrames& shape, const RunRecord& record) {
    double begin = shape.frames.front().time, end = shape.frames.back().time;
    std::vector<Wanted> wanted{{end, "end"}};
    struct Name {
        const char *event, *words;
    };
    for (const Name& name : {Name{"line-stretch", "line stretch"}, Name{"snatch", "snatch"},
                             Name{"peak-force", "peak force"}, Name{"full-open", "full open"}}) {
        const Event* event = record.find_event(name.event);
        if (event == nullptr || !std::isfinite(event->time)) continue;
        wanted.push_back({event->time, name.words});
        const std::string_view words = name.words;
        if (words == "snatch" || words == "line stretch") begin = event->time;
        if (words == "full open") end = event->time;
    }
    // A pack is a dot: it is seen when it is well on its way.
    wanted.push_back({begin - deployment_seen * (begin - shape.frames.front().time), ""});
    for (const double share : {0.4, 0.6, 0.8})
        if (wanted.size() < most_moments) wanted.push_back({begin + share * (end - begin), ""});
    std::vector<std::pair<std::size_t, std::string>> moments;
    for (const Wanted& one : wanted) {
        const std::size_t index = nearest(shape, one.time);
        const auto same = std::ranges::find(moments, index, &std::pair<std::size_t, std::string>::first);
        if (same == moments.end())
            moments.emplace_back(index, one.name);
        else if (same->second.empty() || same->second == "end")
            same->second = one.name;
    }
    std::ranges::sort(moments);
    while (moments.size() > most_moments) {
        const auto unnamed = std::ranges::find(moments, "", &std::pair<std::size_t, std::string>::second);
        moments.erase(unnamed == moments.end() ? moments.end() - 2 : unnamed);
    }
    return moments;
}

class Drawing {
public:
    Drawing(double scale, double x0, double y0) : scale_(scale), x0_(x0), y0_(y0) {}

    std::string at(const Seen& seen) const {
        return fmt::format("{:.0f} {:.0f}", 10 * (x0_ + scale_ * seen.x), 10 * (y0_ - scale_ * seen.y));
    }

private:
    double scale_, x0_, y0_;
};

/// Triangles that face the eye, in classes of how squarely they do: from far to near within each.
std::string fabric(const ShapeFrames& shape, const Moment& moment, const Drawing& drawing) {
    if (shape.triangles.size() > most_shaded) return {};
    std::array<std::string, shades> paths;
    for (const auto& corner : shape.triangles) {
        const Seen &a = moment.node[corner[0]], &b = moment.node[corner[1]], &c = moment.node[corner[2]];
        const Vec3 ab(b.x - a.x, b.y - a.y, b.depth - a.depth), ac(c.x - a.x, c.y - a.y, c.depth - a.depth);
        const Vec3 normal = ab.cross(ac);
        const double size = normal.norm();
        if (!(size > 0.0) || normal.z() <= 0.0) continue;
        // Light from the upper left, before the canopy.
        const double lit = std::max(0.0, normal.dot(Vec3(-0.45, 0.6, 0.66))) / size;
        const auto shade = static_cast<std::size_t>(std::min(shades - 1.0, lit * shades));
        paths[shade] += "M" + drawing.at(a) + "L" + drawing.at(b) + " " + drawing.at(c) + "z";
    }
    std::string svg;
    for (std::size_t i = 0; i < paths.size(); ++i)
        if (!paths[i].empty()) svg += fmt::format("<path class=\"shade{}\" d=\"{}\"/>\n", i, paths[i]);
    return svg;
}

std::string cables(const ShapeFrames& shape, const Moment& moment, const Drawing& drawing, bool tapes) {
    std::string path;
    for (const ShapeCable& cable : shape.cables) {
        if ((cable.kind <= ShapeCableKind::vent) != tapes) continue;
        path += "M" + drawing.at(moment.node[cable.node[0]]) + "L" + drawing.at(moment.node[cable.node[1]]);
    }
    return path.empty() ? ""
                        : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", tapes ? "tapes" : "lines", path);
}

}  // namespace

std::string canopy_still(const ShapeFrames& shape, const RunRecord& record, double clock_zero) {
    if (shape.empty()) return {};
    const Vec3 across = drift_of(shape);
    std::vector<Moment> moments;
    double wide = 0.0, high = 0.0;
    for (const auto& [index, name] : chosen(shape, record)) {
        moments.push_back(moment_of(shape, index, name, across));
        const Moment& moment = moments.back();
        wide += std::max(moment.right - moment.left, 2.5);
        high = std::max(high, moment.high - moment.low);
    }
    const double free = full_width - 2 * margin - gap * static_cast<double>(moments.size() - 1);
    const double scale = std::min(free / wide, (picture_height - 2 * margin) / std::max(high, 1e-3));
    const double spare = (free - scale * wide) / static_cast<double>(moments.size());
    double tallest = 0.0;
    for (const Moment& moment : moments)
        tallest = std::max(tallest, moment.high);
    const double bottom = margin + scale * high + 4;
    std::string svg = fmt::format(
        "<svg class=\"canopy-still\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"The parachute "
        "at {} moments, to "
        "one scale, seen from the side\">\n",
        full_width, bottom + caption, moments.size());
    double x = margin;
    for (const Moment& moment : moments) {
        const double room = scale * std::max(moment.right - moment.left, 2.5) + spare;
        const double x0 = x + 0.5 * room - scale * 0.5 * (moment.left + moment.right);
        const Drawing drawing(scale, x0, margin + scale * tallest);
        svg += "<g transform=\"scale(.1)\">\n" + cables(shape, moment, drawing, false) +
               fabric(shape, moment, drawing) +
               (shape.triangles.size() > most_shaded ? cables(shape, moment, drawing, true) : "") + "</g>\n";
        svg += fmt::format("<rect class=\"payload\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"6\" height=\"6\"/>\n",
                           x0 - 3, margin + scale * tallest - 1);
        svg += fmt::format("<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{:.2f} s</text>\n",
                           x + 0.5 * room, bottom + 20, moment.frame->time - clock_zero);
        if (!moment.name.empty())
            svg += fmt::format(
                "<text class=\"small\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                x + 0.5 * room, bottom + 37, moment.name);
        x += room + gap;
    }
    return svg + "</svg>\n";
}

}  // namespace twinchute::compare
