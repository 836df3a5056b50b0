#include "fullsim/canopy/canopy_geometry.hpp"

#include <array>
#include <cmath>

#include "fullsim/canopy/flat_circular.hpp"
#include "fullsim/canopy/panelled.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {
namespace {

/// Distance from the axis to the chord between the seams [m].
double chord_distance(const GoreOutline& outline, const SeamPoint& seam) {
    return seam.radius * std::cos(outline.half_angle);
}

/// Angle about the axis between the gore's middle and a column [rad].
double column_angle(const GoreOutline& outline, const NodeRow& row, int column) {
    return outline.half_angle * (2.0 * column / row.columns - 1.0);
}

}  // namespace

Eigen::Vector2d cut_point(const GoreOutline& outline, const NodeRow& row, int column) {
    const SeamPoint seam = outline.seam_point(row.seam);
    return {chord_distance(outline, seam) * std::tan(column_angle(outline, row, column)), seam.centre};
}

CanopyNodes constructed_shape(const GoreOutline& outline, std::span<const NodeRow> rows) {
    const SeamPoint skirt = outline.seam_point(outline.skirt);
    return {{skirt.radius, 0.0, skirt.depth}, [=](int row, int gore, int column) {
                const NodeRow& at = rows[static_cast<std::size_t>(row)];
                const SeamPoint seam = outline.seam_point(at.seam);
                const double radius =
                    Eigen::Vector2d(cut_point(outline, at, column).x(), chord_distance(outline, seam)).norm();
                const double azimuth = 2.0 * pi * (gore * at.columns + column) / (outline.gores * at.columns);
                return Vec3(radius * std::cos(azimuth), radius * std::sin(azimuth), seam.depth);
            }};
}

std::span<const CanopyGeometry> canopy_geometries() {
    static const std::array rows{flat_circular(), panelled()};
    return rows;
}

const CanopyGeometry& canopy_geometry(const Parachute& chute) {
    return canopy_geometries()[chute.mesh || gore_panels(chute).empty() ? 0 : 1];
}

}  // namespace twinchute::fullsim
