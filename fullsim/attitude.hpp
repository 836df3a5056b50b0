// How a body has turned, as a quaternion to reckon with and as the four numbers that are stored.
#pragma once

#include <Eigen/Geometry>
#include <array>

namespace twinchute::fullsim {

/// w x y z, as BodyState and Release have it; the turn takes the body's axes to x y z.
using Attitude = std::array<double, 4>;

inline Eigen::Quaterniond turn_of(const Attitude& q) {
    return {q[0], q[1], q[2], q[3]};
}
inline Attitude attitude_of(const Eigen::Quaterniond& turn) {
    return {turn.w(), turn.x(), turn.y(), turn.z()};
}

}  // namespace twinchute::fullsim
