// Vectors of the space that a scene needs, and what the air does to a body in it.
#pragma once

#include <span>

#include "lib/math/vec.hpp"
#include "lib/models/wind.hpp"

namespace twinchute::rom {

/// Position or velocity in the space the scene needs: 1 = (up), 2 = (downrange, up), and with wind
/// 3 = (east, north, up).
template <int dimensions>
using Vec = Eigen::Matrix<double, dimensions, 1>;

/// The state vector of the integrator begins with position [m], then velocity [m/s]; the last component
/// of each is up, altitude counted from sea level.
template <int dimensions>
struct Motion {
    Vec<dimensions> position, velocity;
    double altitude() const { return position[dimensions - 1]; }
};

/// The first two vectors of a state vector.
template <int dimensions>
Motion<dimensions> motion_of(std::span<const double> y) {
    return {Vec<dimensions>(y.data()), Vec<dimensions>(y.data() + dimensions)};
}

/// Velocity relative to the air [m/s]; wind blows in three dimensions only.
template <int dimensions>
Vec<dimensions> airspeed_of(const Vec<dimensions>& velocity, double altitude,
                            [[maybe_unused]] const Wind* wind) {
    if constexpr (dimensions == 3)
        if (wind) return velocity - wind->at(altitude);
    return velocity;
}

/// Drag [N] of a drag area [m^2] in air of density rho [kg/m^3] that is met with `velocity`.
template <int dimensions>
Vec<dimensions> drag_of(double rho, double area, const Vec<dimensions>& velocity) {
    return -0.5 * rho * area * velocity.norm() * velocity;
}

}  // namespace twinchute::rom
