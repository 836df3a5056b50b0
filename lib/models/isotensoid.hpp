// Shapes of a flat circular canopy while it fills: a bulb without hoop stress on a straight tube.
#pragma once

#include <cstddef>
#include <memory>

#include "lib/math/chebyshev.hpp"

namespace twinchute {

/// One shape of the family. Lengths in D0; slopes with respect to the bulb's radius a. Along the axis z
/// counts from the confluence to the apex.
struct FillingShape {
    double line_angle;    ///< beta [rad] between lines and axis; the tube goes on along the lines
    double volume;        ///< V of bulb and tube, from the skirt's plane
    double volume_slope;  ///< V'
    double mouth_area;    ///< A_m of the skirt's circle
    double mouth_slope;   ///< z_m' of the skirt's plane
    double fabric_area;   ///< S_c of the bulb, of the flat pattern
    double centre_slope;  ///< z_c' of the centre of the volume
    double mouth_radius;  ///< of the skirt
    /// Work of a uniform pressure on the fabric per pressure and radius, G = V' + A_m z_m': zero where the
    /// bulb has taken up the whole gore, the shape in equilibrium under that pressure.
    double work() const { return volume_slope + mouth_area * mouth_slope; }
};

/// The family of one canopy. The first part of the gore, of the length s_b from the apex, is a bulb under
/// pressure; the rest, 1/2 - s_b, is a straight tube without pressure along the lines. The bulb then is the
/// isotensoid canopy of gores s_b on lines of the length L + 1/2 - s_b: sin(phi) = (r/a)^2 along its meridian
/// (Taylor 1919; data/reference/isotensoid_canopy.csv), in equilibrium at any a.
///
/// By the angle beta of the lines everything is closed but three smooth integrals; functions of a are
/// Chebyshev series, to 1e-11.
class IsotensoidFamily {
public:
    /// Shortest and longest lines for which the series are that close; [-] of D0.
    static constexpr double shortest_lines = 0.4, longest_lines = 5.0;

    /// `lines`: L [-], from skirt to confluence over D0.
    explicit IsotensoidFamily(double lines);

    FillingShape at(double radius) const;
    /// a_eq [-], of the canopy whose gores are all bulb: half its steady D_p/D0.
    double steady_radius() const { return steady_radius_; }
    /// beta [rad] of that canopy.
    double steady_line_angle() const { return steady_line_angle_; }
    double lines() const { return lines_; }

private:
    static constexpr std::size_t terms = 32;
    double lines_, steady_radius_ = 0.0, steady_line_angle_ = 0.0;
    Chebyshev<terms> angle_, volume_, arc_, centre_;  // beta/a, V/a^2, s_b/a, z_c
};

/// The family of these lines, made once for all canopies that have them. Safe in any thread.
std::shared_ptr<const IsotensoidFamily> isotensoid_family(double lines);

}  // namespace twinchute
