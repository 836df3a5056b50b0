#include "fullsim/gore_pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "fullsim/canopy/canopy_geometry.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int pieces_of_a_panel = 256;           // chords of an arc: 3e-6 of a hemispherical gore is missing
constexpr double collinear = 1e-9;               // [m] off the line through its neighbours
constexpr int matches = 4;                       // equal parts of a seam between marks
constexpr double mark_without_allowance = 0.01;  // [m]

double cross(const PatternPoint& a, const PatternPoint& b) {
    return a.x() * b.y() - a.y() * b.x();
}

double area_of(const std::vector<PatternPoint>& polygon) {
    double twice = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    return 0.5 * std::abs(twice);
}

/// Rows of the cut along a seam [m]: where panels meet, and between them.
std::vector<double> stations(const GoreOutline& outline) {
    std::vector<double> ends{outline.vent};
    std::ranges::copy_if(outline.corners, std::back_inserter(ends),
                         [&](double seam) { return seam > outline.vent && seam < outline.skirt; });
    ends.push_back(outline.skirt);
    std::vector<double> all;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k)
        for (int i = 0; i < pieces_of_a_panel; ++i)
            all.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / pieces_of_a_panel);
    all.push_back(outline.skirt);
    return all;
}

PatternPoint edge_point(const GoreOutline& outline, double seam) {
    return cut_point(outline, {seam, 1}, 1);
}

PatternPoint mirrored(const PatternPoint& point) {
    return {-point.x(), point.y()};
}

/// Without points on the line between their neighbours.
std::vector<PatternPoint> simplified(const std::vector<PatternPoint>& edge) {
    std::vector<PatternPoint> kept{edge.front()};
    for (std::size_t i = 1; i + 1 < edge.size(); ++i) {
        const PatternPoint along = edge[i + 1] - kept.back();
        if (std::abs(cross(along, edge[i] - kept.back())) > collinear * along.norm()) kept.push_back(edge[i]);
    }
    kept.push_back(edge.back());
    return kept;
}

/// Each edge of a polygon moved outward, to where it meets its neighbours. Corners that point inward are
/// those between panels, so slight that no edge vanishes. It begins along the right seam, away from the apex.
std::vector<PatternPoint> widened(const std::vector<PatternPoint>& polygon, double allowance) {
    const std::size_t n = polygon.size();
    const auto outward = [&](std::size_t i) {
        const PatternPoint along = (polygon[(i + 1) % n] - polygon[i]).normalized();
        return PatternPoint(along.y(), -along.x());
    };
    std::vector<PatternPoint> wide;
    for (std::size_t i = 0; i < n; ++i) {
        const PatternPoint before = outward((i + n - 1) % n), behind = outward(i);
        wide.push_back(polygon[i] + allowance / (1.0 + before.dot(behind)) * (before + behind));
    }
    return wide;
}

// --- drawings ---------------------------------------------------------------------------------------------

constexpr double mm = 1000.0;  // of a metre

struct Extent {
    PatternPoint low, high;
};

Extent extent_of(const std::vector<PatternPoint>& points) {
    Extent extent{points.front(), points.front()};
    for (const PatternPoint& p : points) {
        extent.low = extent.low.cwiseMin(p);
        extent.high = extent.high.cwiseMax(p);
    }
    return extent;
}

std::string xml_escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

}  // namespace

GorePattern gore_pattern(const Parachute& chute, double allowance) {
    const GoreOutline outline = canopy_geometry(chute).outline(chute);
    std::vector<PatternPoint> edge;
    for (const double seam : stations(outline))
        edge.push_back(edge_point(outline, seam));
    edge = simplified(edge);
    GorePattern pattern;
    pattern.allowance = allowance;
    pattern.sew = edge;
    for (auto point = edge.rbegin(); point != edge.rend(); ++point)
        pattern.sew.push_back(mirrored(*point));
    pattern.area = area_of(pattern.sew);
    pattern.cut = widened(pattern.sew, allowance);
    pattern.cut_area = area_of(pattern.cut);
    for (const double seam : outline.corners)
        if (seam > outline.vent && seam < outline.skirt) {
            const PatternPoint end = edge_point(outline, seam);
            pattern.panels.push_back({mirrored(end), end});
        }
    const double step = 1e-3 * (outline.skirt - outline.vent);
    for (int i = 1; i < matches; ++i) {
        const double seam = outline.vent + (outline.skirt - outline.vent) * i / matches;
        const PatternPoint at = edge_point(outline, seam);
        const PatternPoint along =
            (edge_point(outline, seam + step) - edge_point(outline, seam - step)).normalized();
        const PatternPoint outward(along.y(), -along.x());
        const PatternPoint end = at + outward * (allowance > 0.0 ? allowance : -mark_without_allowance);
        pattern.marks.push_back({at, end});
        pattern.marks.push_back({mirrored(at), mirrored(end)});
    }
    const double top = edge.front().y(), bottom = edge.back().y();
    pattern.grain = {{0.0, top + 0.25 * (bottom - top)}, {0.0, top + 0.75 * (bottom - top)}};
    return pattern;
}

std::string pattern_svg(const GorePattern& pattern, const std::string& title) {
    const Extent extent = extent_of(pattern.cut);
    const PatternPoint size = mm * (extent.high - extent.low);
    const auto at = [&](const PatternPoint& p) { return PatternPoint(mm * (p - extent.low)); };
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- twinchute pattern -->\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" "
        "viewBox=\"0 0 {0:.3f} {1:.3f}\" fill=\"none\" stroke=\"black\">\n<title>{2}</title>\n",
        size.x(), size.y(), xml_escaped(title));
    const auto polygon = [&](const char* name, const std::vector<PatternPoint>& points, const char* style) {
        text += fmt::format("<polygon id=\"{}\" {} points=\"", name, style);
        for (const PatternPoint& p : points)
            text += fmt::format("{:.4f},{:.4f} ", at(p).x(), at(p).y());
        text += "\"/>\n";
    };
    const auto lines = [&](const char* name, const std::vector<PatternLine>& all, const char* style) {
        text += fmt::format("<g id=\"{}\" {}>\n", name, style);
        for (const PatternLine& line : all)
            text += fmt::format("<line x1=\"{:.4f}\" y1=\"{:.4f}\" x2=\"{:.4f}\" y2=\"{:.4f}\"/>\n",
                                at(line.from).x(), at(line.from).y(), at(line.to).x(), at(line.to).y());
        text += "</g>\n";
    };
    polygon("cut", pattern.cut, "stroke-width=\"1\"");
    polygon("sew", pattern.sew, "stroke-width=\"0.5\" stroke-dasharray=\"8 4\"");
    lines("panels", pattern.panels, "stroke-width=\"0.5\"");
    lines("marks", pattern.marks, "stroke-width=\"1\"");
    lines("grain", {pattern.grain}, "stroke-width=\"0.5\" stroke-dasharray=\"20 4 4 4\"");
    const PatternPoint begin =
        at(pattern.grain.to) + PatternPoint(-10.0, 0.0);  // beside the grain line, along it
    text += fmt::format(
        "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" font-family=\"sans-serif\" "
        "font-size=\"20\" fill=\"black\" stroke=\"none\">{}</text>\n</svg>\n",
        begin.x(), begin.y(), xml_escaped(title));
    return text;
}

std::string pattern_dxf(const GorePattern& pattern, const std::string& title) {
    std::string text = "999\ntwinchute pattern\n";
    const auto pair = [&](int code, const auto& value) { text += fmt::format("{}\n{}\n", code, value); };
    const auto point = [&](int offset, const PatternPoint& p) {  // y up, as drawings have it
        pair(10 + offset, fmt::format("{:.6f}", mm * p.x()));
        pair(20 + offset, fmt::format("{:.6f}", -mm * p.y()));
        pair(30 + offset, "0.0");
    };
    constexpr const char* layers[] = {"CUT", "SEW", "PANELS", "MARKS", "GRAIN", "TEXT"};
    pair(0, "SECTION"), pair(2, "HEADER"), pair(9, "$ACADVER"), pair(1, "AC1009"), pair(0, "ENDSEC");
    pair(0, "SECTION"), pair(2, "TABLES"), pair(0, "TABLE"), pair(2, "LTYPE"), pair(70, 1);
    pair(0, "LTYPE"), pair(2, "CONTINUOUS"), pair(70, 0), pair(3, "Solid"), pair(72, 65), pair(73, 0);
    pair(40, "0.0"), pair(0, "ENDTAB"), pair(0, "TABLE"), pair(2, "LAYER"), pair(70, std::size(layers));
    for (std::size_t i = 0; i < std::size(layers); ++i)
        pair(0, "LAYER"), pair(2, layers[i]), pair(70, 0), pair(62, i + 1), pair(6, "CONTINUOUS");
    pair(0, "ENDTAB"), pair(0, "ENDSEC"), pair(0, "SECTION"), pair(2, "ENTITIES");
    const auto polygon = [&](const char* layer, const std::vector<PatternPoint>& points) {
        pair(0, "POLYLINE"), pair(8, layer), pair(66, 1), point(0, {0.0, 0.0}), pair(70, 1);
        for (const PatternPoint& p : points)
            pair(0, "VERTEX"), pair(8, layer), point(0, p);
        pair(0, "SEQEND"), pair(8, layer);
    };
    const auto lines = [&](const char* layer, const std::vector<PatternLine>& all) {
        for (const PatternLine& line : all)
            pair(0, "LINE"), pair(8, layer), point(0, line.from), point(1, line.to);
    };
    polygon("CUT", pattern.cut);
    polygon("SEW", pattern.sew);
    lines("PANELS", pattern.panels);
    lines("MARKS", pattern.marks);
    lines("GRAIN", {pattern.grain});
    pair(0, "TEXT"), pair(8, "TEXT"), point(0, pattern.grain.to - PatternPoint(0.01, 0.0));
    pair(40, "20.0"), pair(1, title), pair(50, "90.0");
    pair(0, "ENDSEC"), pair(0, "EOF");
    return text;
}

}  // namespace twinchute::fullsim
