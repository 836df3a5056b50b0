// Places near a point of the Earth, for maps.
#pragma once

#include <cmath>

namespace twinchute {

/// A place on WGS 84 [deg].
struct GeographicPlace {
    double latitude = 0.0, longitude = 0.0;
};

/// East and north of a point, by the radii of curvature of WGS 84 there: for places within some kilometres of
/// it.
class LocalMap {
public:
    /// `latitude`, `longitude` [rad] of the point.
    LocalMap(double latitude, double longitude) : latitude_(latitude), longitude_(longitude) {
        constexpr double a = 6378137.0, e2 = 6.69437999014e-3;
        const double w = 1.0 - e2 * std::sin(latitude) * std::sin(latitude);
        meridian_ = a * (1.0 - e2) / (w * std::sqrt(w));
        parallel_ = a / std::sqrt(w) * std::cos(latitude);
    }

    /// The place that lies `east` and `north` [m] of the point.
    GeographicPlace at(double east, double north) const {
        constexpr double degree = 57.29577951308232;
        return {degree * (latitude_ + north / meridian_), degree * (longitude_ + east / parallel_)};
    }

private:
    double latitude_, longitude_;  ///< [rad]
    double meridian_ = 0.0;        ///< [m] radius of curvature along the meridian
    double parallel_ = 0.0;        ///< [m] radius of the parallel
};

}  // namespace twinchute
