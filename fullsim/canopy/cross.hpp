// The cross: two strips of fabric that cross in their middles, with lines along their ends.
#pragma once

#include <span>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Sizes of the strips as they are cut. Where they cross the fabric lies once, as the nominal area counts it.
struct CrossOutline {
    double width, length;  ///< of a strip [m]
    int lines;             ///< tied along the end of an arm, the first and the last at its corners
    double tie;            ///< cord from a corner of each arm to that of the next one, as made [m]

    double area() const { return width * (2.0 * length - width); }  ///< [m^2]
    /// Area within the feet of all lines, laid flat: the octagon of the arms' corners [m^2].
    double mouth() const {
        const double open = length - width;
        return length * length - 0.5 * open * open;
    }
};

/// Ties are D0/6 long unless the parachute says so: assumption of this toolkit. The canopy of `cross-example`
/// thereby settles at D_p/D0 = 0.68, within the handbook's 0.66 to 0.72. Arms that nothing ties together do
/// not stay open under a pressure that knows no flow between them: the middle of their ends folds in, and
/// their corners meet.
CrossOutline cross_outline(const Parachute& chute);

/// Constructed nodes [m], flat about the origin, drawn together to a mouth [m^2] as an upturned pyramid, cut
/// off where ties ask for it: the middle square becomes a pyramid with edges along its diagonals, an arm
/// hangs from each of its sides, as steep or steeper. Along the arms nothing changes its length. Across,
/// fabric comes as close as the mouth asks for; the excess hangs in folds finer than the mesh. Ties are slack
/// or just taut. z points from the apex to the payload. A wider mouth than fits leaves the square flat.
std::vector<Vec3> folded_cross(const CrossOutline& outline, std::span<const Vec3> node, double mouth_area);

}  // namespace twinchute::fullsim
