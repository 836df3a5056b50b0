// The gore of a canopy as it is cut: its outline with seam allowance, panels, match marks and grain, at true
// scale. Gores are straight across the axis (GoreOutline), so that they are developable: the cut is exact.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// x across the gore from its centre line, y along it from the apex [m].
using PatternPoint = Eigen::Vector2d;

struct PatternLine {
    PatternPoint from, to;
};

struct GorePattern {
    double allowance = 0.0;           ///< [m]
    double area = 0.0;                ///< [m^2] within the seams
    double cut_area = 0.0;            ///< [m^2] with the allowance
    std::vector<PatternPoint> sew;    ///< seams, vent and skirt edge, closed
    std::vector<PatternPoint> cut;    ///< around them by the allowance, closed
    std::vector<PatternLine> panels;  ///< across, where the constructed angle changes
    std::vector<PatternLine> marks;   ///< that neighbouring gores are matched by, in the allowance
    PatternLine grain;                ///< along the centre line: assumption of this toolkit
};

/// The gore of a parachute that has a structure and a canopy of its own. `allowance`: [m] around all edges.
GorePattern gore_pattern(const Parachute& chute, double allowance);

/// Drawn at true scale in mm. `title`: printed on it.
std::string pattern_svg(const GorePattern& pattern, const std::string& title);

/// DXF R12, in mm: layers CUT, SEW, PANELS, MARKS, GRAIN and TEXT.
std::string pattern_dxf(const GorePattern& pattern, const std::string& title);

}  // namespace twinchute::fullsim
