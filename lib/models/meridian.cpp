#include "lib/models/meridian.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "lib/math/quadrature.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {

double polygon_radius(double circle_diameter, int sides) {
    return circle_diameter * std::sqrt(0.5 * pi / (sides * std::sin(2.0 * pi / sides)));
}

Meridian::Meridian(std::span<const GorePanel> panels, int gores, double area)
    : gores_(gores), half_angle_(pi / gores) {
    // At unit length first: the area grows with its square.
    double whole = 0.0, unit_area = 0.0;
    for (const GorePanel& panel : panels)
        whole += panel.length;
    for (int pass = 0; pass < 2; ++pass) {
        const double scale = pass == 0 ? 1.0 / whole : std::sqrt(area / unit_area) / whole;
        pieces_.clear();
        edges_.clear();
        MeridianPoint end{0.0, 0.0, 0.0};
        double seam = 0.0;
        for (const GorePanel& panel : panels) {
            const double length = panel.length * scale;
            const Piece piece{seam, panel.top, (panel.bottom - panel.top) / length, end};
            end = within(piece, length);
            unit_area += area_of(piece, 0.0, length);
            pieces_.push_back(piece);
            edges_.push_back(seam += length);
        }
    }
}

double Meridian::centre_rate(double slope) const {
    return std::hypot(std::cos(half_angle_) * std::cos(slope), std::sin(slope));
}

MeridianPoint Meridian::within(const Piece& piece, double along) const {
    const auto& [radius, depth, centre] = piece.start;
    const double cosine = std::cos(piece.top), sine = std::sin(piece.top);
    if (piece.rate == 0.0)
        return {radius + along * cosine, depth + along * sine, centre + along * centre_rate(piece.top)};
    const double turn = piece.rate * along, slope = piece.top + turn;
    return {radius + (std::sin(slope) - sine) / piece.rate, depth - (std::cos(slope) - cosine) / piece.rate,
            centre + integral([&](double s) { return centre_rate(piece.top + piece.rate * s); }, along)};
}

MeridianPoint Meridian::at(double seam) const {
    std::size_t panel = 0;
    while (panel + 1 < pieces_.size() && seam > edges_[panel])
        ++panel;
    return within(pieces_[panel], seam - pieces_[panel].seam);
}

double Meridian::area(double from, double to) const {
    std::size_t panel = 0;
    while (panel + 1 < pieces_.size() && to > edges_[panel])
        ++panel;
    return area_of(pieces_[panel], from - pieces_[panel].seam, to - from);
}

double Meridian::area_of(const Piece& piece, double from, double length) const {
    const double width = 2.0 * gores_ * std::sin(half_angle_);  // of all chords over their radius
    const MeridianPoint begin = within(piece, from), end = within(piece, from + length);
    if (piece.rate == 0.0) return 0.5 * width * (begin.radius + end.radius) * (end.centre - begin.centre);
    return width * integral(
                       [&](double along) {
                           return within(piece, from + along).radius *
                                  centre_rate(piece.top + piece.rate * (from + along));
                       },
                       length);
}

double Meridian::seam_at(double radius) const {
    constexpr double beyond = std::numeric_limits<double>::quiet_NaN();
    const Piece& first = pieces_.front();
    const double seam = first.rate == 0.0
                            ? radius / std::cos(first.top)
                            : (std::asin(std::sin(first.top) + first.rate * radius) - first.top) / first.rate;
    return seam >= 0.0 && seam < edges_.front() ? seam : beyond;
}

Meridian open_meridian(std::span<const GorePanel> panels, int gores, double area, double radius) {
    const double delta = pi / gores, slope = panels.front().top;
    const double tip = radius / std::cos(slope);  // along the seam
    const double with_tip = area + gores * radius * std::sin(delta) * tip *
                                       std::hypot(std::cos(delta) * std::cos(slope), std::sin(slope));
    std::vector<GorePanel> prolonged(panels.begin(), panels.end());
    double whole = 0.0;
    for (const GorePanel& panel : panels)
        whole += panel.length;
    const auto with_share = [&](double added) {
        prolonged.front().length = panels.front().length + added;
        return Meridian(prolonged, gores, with_tip);
    };
    // The tip is the longer, the larger its share of all panels.
    const auto too_short = [&](double added) {
        return with_share(added).length() * added < tip * (whole + added);
    };
    double low = 0.0, high = whole;
    while (too_short(high))
        low = std::exchange(high, 2.0 * high);
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
        (too_short(middle) ? low : high) = middle;
    return with_share(high);
}

}  // namespace twinchute
