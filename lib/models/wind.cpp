#include "lib/models/wind.hpp"

#include <algorithm>
#include <cmath>

#include "lib/math/interpolation.hpp"

namespace twinchute {

Vec3 Wind::at(double altitude) const {
    const auto above = std::ranges::upper_bound(levels, altitude, {}, &WindLevel::altitude);
    if (above == levels.begin()) return levels.front().velocity;
    if (above == levels.end()) return levels.back().velocity;
    const WindLevel& low = *(above - 1);
    const double share = (altitude - low.altitude) / (above->altitude - low.altitude);
    return low.velocity + share * (above->velocity - low.velocity);
}

double Wind::reach(double altitude) const {
    return reach_among(std::span<const WindLevel>(levels), altitude, &WindLevel::altitude);
}

Wind uniform_wind(const Vec3& velocity) {
    return {{{0.0, velocity}}, {}};
}

Vec3 wind_from(double speed, double from) {
    return {-speed * std::sin(from), -speed * std::cos(from), 0.0};
}

}  // namespace twinchute
