// Canopy geometries: how the gores of a canopy are cut, which tapes they have, and how it is folded. One row
// for each shape that the full model can mesh.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// A point of a seam in the constructed shape, the canopy as it is sewn, without any strain.
struct SeamPoint {
    double radius;  ///< distance from the axis [m]
    double depth;   ///< below the apex, along the axis [m]
    double centre;  ///< apex to the chord through this point, along the gore's centre line [m]
};

/// Outline of the gores. All are alike; each is straight across the axis, so that its cut is as wide as the
/// chord between its seams in the constructed shape.
struct GoreOutline {
    int gores;
    double half_angle;                                 ///< delta = pi/gores [rad]
    double vent, skirt;                                ///< apex to vent and to skirt along the seam [m]
    std::function<SeamPoint(double seam)> seam_point;  ///< by distance from the apex along the seam [m]
    /// Between vent and skirt, where the cut has corners and the mesh a row [m], rising.
    std::vector<double> corners = {};
    /// Where gores have no fabric: from corner to corner [m].
    std::vector<std::array<double, 2>> gaps = {};
    /// The vent is so wide that no element at its edge is narrow: rows are as on a uniform mesh.
    bool open_middle = false;

    bool in_gap(double seam) const {
        return std::ranges::any_of(gaps, [&](const auto& gap) { return seam > gap[0] && seam < gap[1]; });
    }
};

/// Nodes around the canopy at one distance from the apex along the seams.
struct NodeRow {
    double seam;  ///< [m]
    int columns;  ///< elements across a gore
};

/// Point of a row on the cut pattern [m]: x across the gore from its centre line, y along it from the apex.
/// Columns are equal angles about the axis; the first and the last lie on the seams.
Eigen::Vector2d cut_point(const GoreOutline& outline, const NodeRow& row, int column);

/// Nodes of a canopy in one of its shapes [m], apex at the origin: z along the axis toward the payload, x and
/// y across, the first seam toward x. The rows that it was made from have to outlive it.
struct CanopyNodes {
    Vec3 skirt;  ///< end of the first seam
    std::function<Vec3(int row, int gore, int column)> node;
};

/// The canopy as it is sewn, without any strain.
CanopyNodes constructed_shape(const GoreOutline& outline, std::span<const NodeRow> rows);

/// State in which a canopy is folded.
struct Folding {
    double mouth_area;  ///< [m^2] across the axis, within the skirt
    double load;        ///< along the canopy [N]
    const Fabric& fabric;
};

/// Constructed shape of a canopy from a mesh file, z the axis.
struct GivenCanopy {
    std::span<const Vec3> node;                            ///< [m]
    std::vector<Vec3> seam_end;                            ///< at the skirt, in the order of azimuths [m]
    std::size_t skirt_nodes, vent_nodes;                   ///< around these edges
    std::span<const std::vector<std::int32_t>> seam_ring;  ///< indices of nodes on seams, vent to skirt
};

enum class TapeLine { seam, skirt, vent };  ///< where a tape is sewn on

struct Tape {
    TapeLine line;
    Cord Tapes::*cord;
    double strands;  ///< cords side by side
};

struct CanopyGeometry {
    std::string_view name;
    std::string_view source;
    GoreOutline (*outline)(const Parachute& chute);
    std::span<const Tape> tapes;  ///< in the order of their cables

    /// The canopy closed to a mouth, rows from vent to skirt.
    CanopyNodes (*fold)(const GoreOutline& outline, std::span<const NodeRow> rows, const Folding& folding);
    /// Why a canopy is not of this geometry; empty where it is.
    std::string (*mismatch)(const GivenCanopy& canopy);
    /// Nodes of a canopy of this geometry when it is folded [m], axes as in CanopyNodes.
    std::vector<Vec3> (*fold_given)(const GivenCanopy& canopy, const Folding& folding);
};

std::span<const CanopyGeometry> canopy_geometries();

/// The row by which a parachute is meshed: by panels where its type's gores have some, else the flat circular
/// canopy, which stands in for other types (MeshedCanopy). A mesh of one's own folds where it is flat
/// circular.
const CanopyGeometry& canopy_geometry(const Parachute& chute);

}  // namespace twinchute::fullsim
