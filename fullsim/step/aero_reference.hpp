// The velocity and direction with which the air meets the canopy.
#pragma once

#include "fullsim/state.hpp"
#include "lib/models/atmosphere.hpp"

namespace twinchute::fullsim {

/// Below this airspeed [m/s] the direction of the air means nothing: the last one is kept.
inline constexpr double smallest_airspeed = 0.01;

/// After snatch (paper, 3.2.1, "the barycenter velocity is used as reference"): across the axis
/// the canopy's own velocity, along it the whole system's,
///   v_ref = v_can + [(v_sys - v_can).a] a,   a from payload to canopy barycentre.
/// With the system's mean alone an oblique release swings up without bound; with the canopy's
/// alone its breathing feeds back into the dynamic pressure.
Vec3 reference_velocity(const NodeSums& sums, const Vec3& payload);

/// Updates density, direction e_r, airspeed and dynamic pressure for still air.
void update_air(State& state, const Atmosphere& atmosphere, NodeIndex payload);

}  // namespace twinchute::fullsim
