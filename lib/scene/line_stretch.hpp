// Release and closed canopy at line stretch, as far as the scene alone decides them.
#pragma once

#include "lib/scene/scene.hpp"

namespace twinchute {

/// Velocity [m/s] of a release over ground; x east, y north, z up.
Vec3 velocity_over_ground(const Release& release);
/// Velocity [m/s] of a release through the air.
Vec3 release_airspeed(const Scene& scene);

/// [m^2] floor of the projected area that the canopy pressure divides by; 0.05 m^2 for a C-9.
double smallest_projected_area(const Parachute& chute);

/// Mouth area [m^2] at line stretch: that of the steady canopy times the initial drag-area ratio, so that
/// shape and prescribed drag area say the same, and never below smallest_projected_area.
double mouth_area_at_line_stretch(const Parachute& chute);

/// Distance [m] of the seams from the axis when they alone border that mouth: the lines have to be longer.
double mouth_radius_at_line_stretch(const Parachute& chute);

/// [N/m] of lines and risers together, of the whole cluster: a riser has as many strands as it carries lines.
double line_stiffness(const Parachute& chute);

/// Inputs of filling times at a snatch with airspeed `speed` [m/s] in air of `density` [kg/m^3]: for one
/// canopy, and in a cluster for its share of the payload.
FillTimeInputs fill_inputs(const Scene& scene, const Parachute& chute, double speed, double density);

/// [m] once around the mouth, of a reefing stage from 0 on: given, or that of a mouth whose area is the
/// stage's share of the steady projected area, pi D_p sqrt((C_D S)_r/(C_D S)_0).
double reefing_line_length(const Parachute& chute, std::size_t stage);

}  // namespace twinchute
