// The velocity and direction with which the air meets the canopy.
#pragma once

#include "fullsim/state.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Below this airspeed [m/s] the direction of the air means nothing: the last one is kept.
inline constexpr double smallest_airspeed = 0.01;

/// After snatch (paper, 3.2.1, "the barycenter velocity is used as reference"): across the axis
/// the canopy's own velocity, along it that of the whole system with the air that moves with it,
///   v_ref = v_can + [(v_all - v_can).a] a,   a from payload to canopy barycentre.
///
/// With the system's mean in all directions an oblique release swings up without bound; with the
/// canopy's own along the axis its breathing feeds back into the dynamic pressure.
/// system_mass: of the material [kg]; air_mass: see air_mass_in_reference [kg].
Vec3 reference_velocity(const NodeSums& sums, const Vec3& payload, double system_mass, double air_mass);

/// D0/v [s] of the C-9 with 152.4 kg at sea level, v its steady 7.7 m/s. What takes its time as the air does,
/// here and elsewhere, was found there and scales with D0/v of the canopy at hand (Simulation::time_scale).
inline constexpr double time_scale_of_c9 = 8.53 / 7.7;

/// How much of the added mass [kg] counts in the mean velocity v_all. None while the canopy fills:
/// then its shape changes, and the speed of that is not a speed of the canopy through the air. All
/// of it once open, approached over 0.45 D0/v (half a second of the C-9): the mean of the material alone is
/// nearly the payload's velocity, so drag would answer the payload while it acts on the canopy. Where the two
/// bounce against each other on elastic lines, and added mass makes the canopy heavy, that is
/// negative damping: the bounce of a C-9 with 152 kg grows to the slackening of its lines within
/// 10 s. The mean over all inertia stands still in a bounce, which then neither feeds nor is fed.
/// time_scale: D0/v [s].
double air_mass_in_reference(double added_mass, double time_since_full_open, double time_scale);

/// Updates density, wind, direction e_r, airspeed and dynamic pressure: density at the payload's
/// altitude, wind at the canopy's, and at the payload's for the payload.
void update_air(State& state, const Environment& environment, NodeIndex payload, double system_mass,
                double air_mass);

}  // namespace twinchute::fullsim
