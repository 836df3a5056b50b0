#include "fullsim/canopy/flat_circular.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/canopy/folded_canopy.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double flat = 1e-6;  // of the canopy's radius, and of angles

constexpr Tape flat_circular_tapes[] = {{TapeLine::seam, &Tapes::radial, 1.0},
                                        {TapeLine::skirt, &Tapes::skirt, 1.0},
                                        {TapeLine::vent, &Tapes::vent, 1.0}};

GoreOutline outline(const Parachute& chute) {
    const double delta = pi / chute.gores;
    // Area of a regular polygon of n sides over its circumradius squared.
    const double polygon = 0.5 * chute.gores * std::sin(2.0 * delta);
    const double nominal = 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;
    const double vent = 0.25 * pi * chute.vent_diameter * chute.vent_diameter;
    return {chute.gores, delta, std::sqrt(vent / polygon), std::sqrt(nominal / polygon),
            [delta](double seam) {
                return SeamPoint{seam, 0.0, seam * std::cos(delta)};
            }};
}

/// columns: elements across a gore. An even number of them with fewer at the vent is pleated at seams and
/// middles of gores alone, however many there are: no triangle at the vent lies across a pleat.
FoldedCanopy fold_disc(int gores, int columns, int columns_at_vent, double radius, const Folding& folding) {
    const int pleats = columns % 2 != 0 || columns_at_vent == columns ? columns : 2;
    return canopy_with_mouth(gores, pleats, folding.mouth_area / (radius * radius),
                             folded_stretch(gores, columns, radius, folding.fabric, folding.load));
}

/// A column line's point at unit seam length; panels between pleats are plane.
Vec3 folded_point(const FoldedCanopy& canopy, double half_angle, int gore, int column, int columns) {
    if (canopy.columns() == columns) return canopy.point(gore, column);
    const int half = columns / 2;
    const Vec3 middle = canopy.point(gore, 1);
    const Vec3 seam = column < half ? canopy.point(gore, 0) : canopy.point(gore + 1, 0);
    const double angle = half_angle * std::abs(column - half) / half;
    return middle + std::tan(angle) / std::tan(half_angle) * (seam - middle);
}

/// Seam length [m] at which a vent of one element across a gore starts, see loose_vent_radius.
/// vent, below: seam lengths of its row and the next [m]. unit_point(column): of the row below in the first
/// gore, at unit seam length.
template <class UnitPoint>
double loose_vent(const FoldedCanopy& canopy, double vent, double below, double half_angle, int columns,
                  UnitPoint&& unit_point) {
    const Vec3 middle = 0.5 * (canopy.point(0, 0) + canopy.point(1, 0));
    const Vec3 foot = 0.5 * below * (unit_point(columns / 2) + unit_point((columns + 1) / 2));
    return loose_vent_radius(middle, foot, (below - vent) * std::cos(half_angle));
}

CanopyNodes fold(const GoreOutline& gore, std::span<const NodeRow> rows, const Folding& folding) {
    const int columns = rows.back().columns, at_vent = rows.front().columns;
    const FoldedCanopy canopy = fold_disc(gore.gores, columns, at_vent, gore.skirt, folding);
    const double delta = gore.half_angle;
    double vent = rows[0].seam;
    if (at_vent < columns)
        vent = loose_vent(canopy, vent, rows[1].seam, delta, columns,
                          [&](int column) { return folded_point(canopy, delta, 0, column, columns); });
    return {gore.skirt * canopy.point(0, 0), [=](int row, int g, int column) {
                const double seam = row == 0 ? vent : rows[static_cast<std::size_t>(row)].seam;
                return Vec3(seam * folded_point(canopy, delta, g, column, columns));
            }};
}

double azimuth_of(const Vec3& x) {
    return std::atan2(x.y(), x.x());
}

/// In [0, 2 pi); a whole turn but for rounding is none.
double turned(double angle) {
    const double whole = angle - 2.0 * pi * std::floor(angle / (2.0 * pi));
    return 2.0 * pi - whole < 1e-12 ? 0.0 : whole;
}

/// Distance of the skirt's seams from the axis [m].
double radius_of(const GivenCanopy& canopy) {
    double radius = 0.0;
    for (const Vec3& end : canopy.seam_end)
        radius = std::max(radius, end.head<2>().norm());
    return radius;
}

std::string mismatch(const GivenCanopy& canopy) {
    const double radius = radius_of(canopy), height = canopy.seam_end.front().z();
    for (const Vec3& x : canopy.node)
        if (std::abs(x.z() - height) > flat * radius) return "the canopy does not lie flat across z";
    const double first = azimuth_of(canopy.seam_end.front());
    const int gores = static_cast<int>(canopy.seam_end.size());
    for (int g = 0; g < gores; ++g) {
        const Vec3& end = canopy.seam_end[static_cast<std::size_t>(g)];
        const double off = turned(azimuth_of(end) - first) - 2.0 * pi * g / gores;
        if (std::abs(off) > flat || std::abs(end.head<2>().norm() - radius) > flat * radius)
            return "lines are not tied at equal angles around z";
    }
    return {};
}

/// Elements across a gore on an edge of the canopy; 0 where gores differ.
int columns_of(std::size_t edge_nodes, int gores) {
    const int count = static_cast<int>(edge_nodes);
    return count % gores == 0 ? count / gores : 0;
}

std::vector<Vec3> fold_given(const GivenCanopy& given, const Folding& folding) {
    const int gores = static_cast<int>(given.seam_end.size());
    const int at_skirt = columns_of(given.skirt_nodes, gores), at_vent = columns_of(given.vent_nodes, gores);
    const int columns = at_skirt == 0 ? 2 : at_skirt;
    const FoldedCanopy canopy = fold_disc(gores, columns, at_vent, radius_of(given), folding);
    const double first = azimuth_of(given.seam_end.front());
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(first, Vec3::UnitZ()).toRotationMatrix();
    std::vector<Vec3> folded;
    folded.reserve(given.node.size());
    for (const Vec3& x : given.node) {
        const Vec3 p = canopy.folded(x.head<2>().norm(), turned(azimuth_of(x) - first));
        folded.push_back(first == 0.0 ? p : Vec3(turn * p));
    }
    if (at_vent != 1 || columns == 1 || given.seam_ring.size() <= 2) return folded;
    // Rows differ from those of the generator in nothing but rounding.
    const auto radius_in = [&](std::size_t ring) {
        return given.node[static_cast<std::size_t>(given.seam_ring[ring][0])].head<2>().norm();
    };
    const double half_angle = pi / gores, vent = radius_in(0);
    const double loose = loose_vent(canopy, vent, radius_in(1), half_angle, columns, [&](int column) {
        return canopy.folded(FoldedCanopy::column_length(gores, columns, column),
                             2.0 * half_angle * column / columns);
    });
    for (const std::int32_t i : given.seam_ring[0])
        folded[static_cast<std::size_t>(i)] *= loose / vent;
    return folded;
}

}  // namespace

CanopyGeometry flat_circular() {
    return {"flat-circular",
            "definition of D0: the gores' polygon has the area of the nominal circle; folding: here",
            &outline,
            flat_circular_tapes,
            &fold,
            &mismatch,
            &fold_given};
}

}  // namespace twinchute::fullsim
