// The gore of a canopy as it is cut, whole or panel by panel: outlines with seam allowance, match marks and
// grain. Gores are straight across the axis (GoreOutline), so that they are developable: the cut is exact.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// x across the gore from its centre line, y along it away from the apex [m].
using PatternPoint = Eigen::Vector2d;

struct PatternLine {
    PatternPoint from, to;
};

/// A piece of fabric; each gore has one.
struct PatternPiece {
    std::string name;                 ///< "gore", or "panel 1" and so on from the vent
    double area = 0.0;                ///< [m^2] within the seams
    double cut_area = 0.0;            ///< [m^2] with the allowance
    std::vector<PatternPoint> sew;    ///< seams, and edges toward vent and skirt, closed
    std::vector<PatternPoint> cut;    ///< around them by the allowance, closed
    std::vector<PatternLine> panels;  ///< across, where the constructed angle changes within the piece
    std::vector<PatternLine> marks;   ///< that neighbouring gores are matched by, in the allowance
    PatternLine grain;                ///< along the centre line: assumption of this toolkit
};

enum class PatternPieces { gore, panels };  ///< that a gore is cut in

struct GorePattern {
    double allowance = 0.0;            ///< [m]
    std::vector<PatternPiece> pieces;  ///< apart from each other, below one another
};

/// The gore of a parachute that has a structure and a canopy of its own. `allowance`: [m] around all edges. A
/// gap has no piece; a gore with one is cut in panels.
GorePattern gore_pattern(const Parachute& chute, double allowance, PatternPieces pieces);

}  // namespace twinchute::fullsim
