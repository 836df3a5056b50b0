#include "lib/models/meridian.hpp"

#include <cmath>
#include <limits>

#include "lib/math/quadrature.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {

double polygon_radius(double circle_diameter, int sides) {
    return circle_diameter * std::sqrt(0.5 * pi / (sides * std::sin(2.0 * pi / sides)));
}

Meridian::Meridian(std::span<const GorePanel> panels, int gores, double area) : half_angle_(pi / gores) {
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
            const double width = 2.0 * gores * std::sin(half_angle_);  // of all chords over their radius
            end = within(piece, length);
            unit_area +=
                piece.rate == 0.0
                    ? 0.5 * width * (piece.start.radius + end.radius) * (end.centre - piece.start.centre)
                    : width * integral(
                                  [&](double along) {
                                      return within(piece, along).radius *
                                             centre_rate(piece.top + piece.rate * along);
                                  },
                                  length);
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

double Meridian::seam_at(double radius) const {
    constexpr double beyond = std::numeric_limits<double>::quiet_NaN();
    const Piece& first = pieces_.front();
    const double seam = first.rate == 0.0
                            ? radius / std::cos(first.top)
                            : (std::asin(std::sin(first.top) + first.rate * radius) - first.top) / first.rate;
    return seam >= 0.0 && seam < edges_.front() ? seam : beyond;
}

}  // namespace twinchute
