#include "fullsim/pattern/gore_pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

#include "fullsim/canopy/canopy_geometry.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int pieces_of_a_panel = 256;           // chords of an arc: 3e-6 of a hemispherical gore is missing
constexpr double collinear = 1e-9;               // [m] off the line through its neighbours
constexpr int matches = 4;                       // equal parts of a seam between marks
constexpr double mark_without_allowance = 0.01;  // [m]
constexpr double between_pieces = 0.02;          // [m] at least, on a drawing

double cross(const PatternPoint& a, const PatternPoint& b) {
    return a.x() * b.y() - a.y() * b.x();
}

double area_of(const std::vector<PatternPoint>& polygon) {
    double twice = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    return 0.5 * std::abs(twice);
}

/// Where a cut has corners along a seam [m]: the vent, panels that meet, the skirt.
std::vector<double> panel_ends(const GoreOutline& outline) {
    std::vector<double> ends{outline.vent};
    std::ranges::copy_if(outline.corners, std::back_inserter(ends),
                         [&](double seam) { return seam > outline.vent && seam < outline.skirt; });
    ends.push_back(outline.skirt);
    return ends;
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

/// One piece, from the first to the last of the given ends of panels.
PatternPiece piece_of(const GoreOutline& outline, std::span<const double> ends, double allowance) {
    std::vector<PatternPoint> edge;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k)
        for (int i = 0; i < pieces_of_a_panel; ++i)
            edge.push_back(edge_point(outline, ends[k] + (ends[k + 1] - ends[k]) * i / pieces_of_a_panel));
    edge.push_back(edge_point(outline, ends.back()));
    edge = simplified(edge);
    PatternPiece piece;
    piece.sew = edge;
    for (auto point = edge.rbegin(); point != edge.rend(); ++point)
        piece.sew.push_back(mirrored(*point));
    piece.area = area_of(piece.sew);
    piece.cut = widened(piece.sew, allowance);
    piece.cut_area = area_of(piece.cut);
    for (const double seam : ends.subspan(1, ends.size() - 2)) {
        const PatternPoint end = edge_point(outline, seam);
        piece.panels.push_back({mirrored(end), end});
    }
    const double length = ends.back() - ends.front(), step = 1e-3 * length;
    for (int i = 1; i < matches; ++i) {
        const double seam = ends.front() + length * i / matches;
        const PatternPoint at = edge_point(outline, seam);
        const PatternPoint along =
            (edge_point(outline, seam + step) - edge_point(outline, seam - step)).normalized();
        const PatternPoint outward(along.y(), -along.x());
        const PatternPoint end = at + outward * (allowance > 0.0 ? allowance : -mark_without_allowance);
        piece.marks.push_back({at, end});
        piece.marks.push_back({mirrored(at), mirrored(end)});
    }
    const double top = edge.front().y(), bottom = edge.back().y();
    piece.grain = {{0.0, top + 0.25 * (bottom - top)}, {0.0, top + 0.75 * (bottom - top)}};
    return piece;
}

void move_down(PatternPiece& piece, double way) {
    const PatternPoint by(0.0, way);
    for (std::vector<PatternPoint>* points : {&piece.sew, &piece.cut})
        for (PatternPoint& point : *points)
            point += by;
    for (std::vector<PatternLine>* lines : {&piece.panels, &piece.marks})
        for (PatternLine& line : *lines)
            line = {line.from + by, line.to + by};
    piece.grain = {piece.grain.from + by, piece.grain.to + by};
}

}  // namespace

GorePattern gore_pattern(const Parachute& chute, double allowance, PatternPieces pieces) {
    const GoreOutline outline = canopy_geometry(chute).outline(chute);
    const std::vector<double> ends = panel_ends(outline);
    GorePattern pattern{allowance, {}};
    if (pieces == PatternPieces::gore) {
        pattern.pieces.push_back(piece_of(outline, ends, allowance));
        pattern.pieces.back().name = "gore";
        return pattern;
    }
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
        if (outline.in_gap(0.5 * (ends[k] + ends[k + 1]))) continue;
        PatternPiece piece = piece_of(outline, std::span(ends).subspan(k, 2), allowance);
        piece.name = fmt::format("panel {}", pattern.pieces.size() + 1);
        move_down(piece, static_cast<double>(pattern.pieces.size()) * (2.0 * allowance + between_pieces));
        pattern.pieces.push_back(std::move(piece));
    }
    return pattern;
}

}  // namespace twinchute::fullsim
