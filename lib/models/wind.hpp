// Motion of the air: the wind against altitude.
#pragma once

#include <string>
#include <vector>

#include "lib/math/vec.hpp"

namespace twinchute {

struct WindLevel {
    double altitude = 0.0;         ///< [m] above sea level
    Vec3 velocity = Vec3::Zero();  ///< [m/s] of the air; x east, y north, z up

    bool operator==(const WindLevel&) const = default;
};

/// Levels with rising altitudes, at least one; a uniform wind is a single level.
struct Wind {
    std::vector<WindLevel> levels;
    std::string table = {};  ///< name of the file it was read from; empty for a uniform wind

    bool operator==(const Wind&) const = default;

    /// Velocity of the air [m/s], x east, y north, z up, at an altitude [m] above sea level: each
    /// component is linear between levels. Below the lowest level and above the highest the wind of that
    /// level goes on: a sounding seldom begins at the ground, and air that stands still just outside of
    /// it would be the odder guess. Records of such a scene carry a warning.
    Vec3 at(double altitude) const;

    /// Whether the levels reach from `low` to `high` [m]; a single level holds everywhere.
    /// [m] How far a step from an altitude may go, up or down, without leaping over a layer.
    double reach(double altitude) const;

    bool covers(double low, double high) const {
        return levels.size() == 1 || (levels.front().altitude <= low && levels.back().altitude >= high);
    }
};

/// Wind that is uniform in space.
Wind uniform_wind(const Vec3& velocity);

/// Horizontal velocity [m/s] of a wind of `speed` [m/s] that blows `from` a direction [rad], from north,
/// clockwise, as weather services report it: from 270 deg (west) toward the east, (+speed, 0, 0).
Vec3 wind_from(double speed, double from);

}  // namespace twinchute
