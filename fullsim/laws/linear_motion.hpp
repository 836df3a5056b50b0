// Linear field of motion.
#pragma once

#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

/// A node that was at x from a centre is expected at the centre of now plus stretch x.
struct LinearMotion {
    Vec3 centre = Vec3::Zero();                             ///< [m]
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();  ///< [-]

    Vec3 place_of(const Vec3& x) const { return centre + stretch * x; }
};

}  // namespace twinchute::fullsim
