// Vectors of ordinary space, and the few constants that have one value everywhere.
#pragma once

#include <Eigen/Core>
#include <limits>

namespace twinchute {

/// A vector in the world frame: x east, y north, z up.
using Vec3 = Eigen::Vector3d;

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// As those of Lanes: formulas that are templates call it so.
inline double dot(const Vec3& a, const Vec3& b) {
    return a.dot(b);
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

/// [m/s^2] standard gravity, ISO 80000-3.
inline constexpr double standard_gravity = 9.80665;

}  // namespace twinchute
