// The mesh of a flat circular canopy sewn from plane gores, with its lines, links and risers, in
// the shape it has at line stretch.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Cut pattern of one gore: an isosceles triangle with the vent's tip cut off. The polygon of all
/// gores has the area of the nominal circle, the polygon of the vent that of the vent circle.
struct GorePattern {
    double half_angle;    ///< delta = pi/gores [rad]
    double skirt_radius;  ///< apex to skirt along the seam [m]
    double vent_radius;   ///< apex to vent along the seam [m]
};
GorePattern gore_pattern(const Parachute& chute);

/// Generates the parachute at line stretch: lines and risers straight, the canopy closed to a narrow
/// cone whose mouth has the area mouth_area [m^2]. All is stretched so as to carry `load` [N], the
/// opening force of this instant: an unloaded parachute would fall into it and ring like a snatch
/// that the scene left out.
///
/// axis: unit vector from payload to apex. With an odd number of columns the diagonals of the middle
/// one alternate; all others are mirror images, as the gore's cut is.
Mesh make_gore_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass, const Vec3& axis,
                    double mouth_area, double load);

/// The same elements as they are made, without any strain: the canopy flat, gore beside gore, lines and
/// risers straight below it, the payload at the origin and the apex above it on z. The first seam lies toward
/// x. Only where lines are longer than the canopy's radius.
Mesh make_flat_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass);

}  // namespace twinchute::fullsim
