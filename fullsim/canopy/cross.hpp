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

    double area() const { return width * (2.0 * length - width); }  ///< [m^2]
    /// Area within the feet of all lines, laid flat: the octagon of the arms' corners [m^2].
    double mouth() const {
        const double open = length - width;
        return length * length - 0.5 * open * open;
    }
};

CrossOutline cross_outline(const Parachute& chute);

/// Constructed nodes [m], flat about the origin, drawn together to a mouth [m^2]: the edges of an upturned
/// pyramid lie along the diagonals of the middle square, an arm hangs from each of its sides. Along the arms
/// nothing changes its length; across them fabric comes as close as the mouth asks for, the excess hangs in
/// folds finer than the mesh. z points from the apex to the payload. A mouth that is wider than the flat
/// cross leaves it flat.
std::vector<Vec3> folded_cross(const CrossOutline& outline, std::span<const Vec3> node, double mouth_area);

}  // namespace twinchute::fullsim
