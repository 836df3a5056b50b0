#include "fullsim/canopy/folded_canopy.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute::fullsim {

FoldedCanopy::FoldedCanopy(int gores, int columns, double seam_angle, double stretch)
    : gores_(gores), columns_(columns), stretch_(stretch), inner_(seam_angle), outer_(seam_angle) {
    if (columns % 2 != 0) return;
    // Neighbouring rays keep the angle of the cut: A cos(outer) + B sin(outer) = cos(cut).
    const double cut = 2.0 * pi / (gores_ * columns_), azimuth = cut;
    const double A = std::cos(inner_), B = std::sin(inner_) * std::cos(azimuth);
    outer_ = std::atan2(B, A) + std::acos(std::min(1.0, std::cos(cut) / std::hypot(A, B)));
}

Vec3 FoldedCanopy::point(int gore, int column) const {
    const double azimuth = 2.0 * pi * (gore * columns_ + column) / (gores_ * columns_);
    const double cone = column % 2 == 0 ? inner_ : outer_;
    return stretch_ * column_length(gores_, columns_, column) *
           Vec3(std::sin(cone) * std::cos(azimuth), std::sin(cone) * std::sin(azimuth), std::cos(cone));
}

Vec3 FoldedCanopy::folded(double radius, double azimuth) const {
    const double panel = 2.0 * pi / (gores_ * columns_);
    const int first = std::clamp(static_cast<int>(azimuth / panel), 0, gores_ * columns_ - 1);
    const int gore = first / columns_, column = first % columns_;
    const bool last = column + 1 == columns_;
    // The flat point by the rays on both sides of it.
    const double past = azimuth - first * panel, ahead = panel - past;
    const double whole = std::sin(panel);
    const double a = std::sin(ahead) / (whole * column_length(gores_, columns_, column));
    const double b = std::sin(past) / (whole * column_length(gores_, columns_, last ? 0 : column + 1));
    return radius * (a * point(gore, column) + b * (last ? point(gore + 1, 0) : point(gore, column + 1)));
}

double FoldedCanopy::mouth() const {
    double twice = 0.0;
    for (int gore = 0; gore < gores_; ++gore)
        for (int column = 0; column < columns_; ++column) {
            const Vec3 a = point(gore, column);
            const Vec3 b = column + 1 < columns_ ? point(gore, column + 1) : point(gore + 1, 0);
            twice += a.x() * b.y() - a.y() * b.x();
        }
    return 0.5 * twice;
}

double FoldedCanopy::column_length(int gores, int columns, int column) {
    const double delta = pi / gores;
    return std::cos(delta) / std::cos(delta * (2.0 * column / columns - 1.0));
}

FoldedCanopy canopy_with_mouth(int gores, int columns, double mouth, double stretch) {
    double low = 0.0, high = 0.5 * pi;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (FoldedCanopy(gores, columns, middle, stretch).mouth() < mouth ? low : high) = middle;
    }
    return {gores, columns, 0.5 * (low + high), stretch};
}

double folded_stretch(int gores, int columns, double skirt_radius, const Fabric& fabric, double load) {
    if (columns % 2 == 0) return 1.0;
    const double half_angle = pi / gores;
    const double around = 2.0 * gores * skirt_radius * std::sin(half_angle);  // [m]
    const double strain = load / (around * fabric.youngs_modulus * fabric.thickness);
    return std::cos(half_angle / columns) * std::sqrt(1.0 + 2.0 * strain);
}

double loose_vent_radius(const Vec3& vent, const Vec3& foot, double height) {
    // |foot - r vent| = height, of the two roots the one above; the nearest point where there is none, on
    // canopies of very few gores.
    const double a = vent.squaredNorm(), b = vent.dot(foot), c = foot.squaredNorm() - height * height;
    return (b - std::sqrt(std::max(0.0, b * b - a * c))) / a;
}

}  // namespace twinchute::fullsim
