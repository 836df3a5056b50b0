// Places near a point of the Earth, for maps.
#pragma once

#include <cmath>

namespace twinchute {

/// A place on WGS 84 [deg].
struct GeographicPlace {
    double latitude = 0.0, longitude = 0.0;
};

/// East and north of a point on WGS 84, along a path that goes straight there, by the radii of curvature on
/// its way: to a metre after 200 km at 70 deg of latitude. Not for the poles.
class LocalMap {
public:
    /// `latitude`, `longitude` [rad] of the point.
    LocalMap(double latitude, double longitude) : latitude_(latitude), longitude_(longitude) {}

    /// The place that lies `east` and `north` [m] of the point; its longitude within +-180 deg.
    GeographicPlace at(double east, double north) const {
        constexpr double degree = 57.29577951308232;
        double latitude = latitude_;
        for (int pass = 0; pass < 3; ++pass)
            latitude = latitude_ + north * per_metre_north(0.5 * (latitude_ + latitude));
        // Simpson's rule.
        const double longitude =
            longitude_ + east / 6.0 *
                             (per_metre_east(latitude_) + 4.0 * per_metre_east(0.5 * (latitude_ + latitude)) +
                              per_metre_east(latitude));
        return {degree * latitude, std::remainder(degree * longitude, 360.0)};
    }

private:
    static constexpr double a = 6378137.0, e2 = 6.69437999014e-3;  // [m], [-]
    static double w(double latitude) { return 1.0 - e2 * std::sin(latitude) * std::sin(latitude); }
    /// [rad/m] one over the radii of curvature along the meridian, and of the parallel.
    static double per_metre_north(double latitude) {
        return w(latitude) * std::sqrt(w(latitude)) / (a * (1.0 - e2));
    }
    static double per_metre_east(double latitude) {
        return std::sqrt(w(latitude)) / (a * std::cos(latitude));
    }

    double latitude_, longitude_;  ///< [rad]
};

}  // namespace twinchute
