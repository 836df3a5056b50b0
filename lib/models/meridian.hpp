// Meridian of a canopy as it is constructed: the seam between two gores, from the apex to the skirt.
#pragma once

#include <span>
#include <vector>

#include "lib/models/canopy_type.hpp"

namespace twinchute {

/// Circumradius [m] of the regular polygon of `sides` sides that has the area of a circle.
double polygon_radius(double circle_diameter, int sides);

/// A point of the seam in the constructed shape.
struct MeridianPoint {
    double radius;  ///< distance from the axis [m]
    double depth;   ///< below the apex, along the axis [m]
    double centre;  ///< apex to the chord through this point, along the gore's centre line [m]
};

/// Seam of alike gores, each straight across the axis. A panel of constant slope is a flat trapezoid of each
/// gore, one that turns is part of a cylinder: gores are cut from flat fabric without any strain.
class Meridian {
public:
    /// Panels from apex to skirt, at least one. area [m^2]: of all gores, up to the apex.
    Meridian(std::span<const GorePanel> panels, int gores, double area);

    double length() const { return edges_.back(); }  ///< of the seam, apex to skirt [m]
    /// seam: distance from the apex along the seam [m].
    MeridianPoint at(double seam) const;
    /// Lower edges of the panels along the seam, the skirt last [m].
    const std::vector<double>& edges() const { return edges_; }
    /// Area [m^2] of all gores between two distances along the seam, both of one panel.
    double area(double from, double to) const;
    /// Distance along the seam to a radius of the first panel [m]; NaN where that panel ends before.
    double seam_at(double radius) const;

private:
    struct Piece {
        double seam, top, rate;  ///< [m], [rad], [rad/m]
        MeridianPoint start;
    };
    double area_of(const Piece& piece, double from, double length) const;
    MeridianPoint within(const Piece& piece, double along) const;
    double centre_rate(double slope) const;

    int gores_;
    double half_angle_;          ///< pi/gores [rad]
    std::vector<Piece> pieces_;  ///< one for each panel
    std::vector<double> edges_;
};

/// Meridian of gores around an open middle, whose polygon has the circumradius `radius` [m]: their panels
/// begin at its edge, and the first one, of constant slope below 90 deg, is prolonged to the apex. area
/// [m^2]: of all gores from that edge to the skirt.
Meridian open_meridian(std::span<const GorePanel> panels, int gores, double area, double radius);

}  // namespace twinchute
