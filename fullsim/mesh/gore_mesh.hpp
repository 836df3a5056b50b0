// The mesh of a canopy sewn from gores, with its lines, links and risers: at line stretch, or as it is made.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Generates the parachute at line stretch: lines and risers straight, the canopy, of its canopy_geometry,
/// folded to a mouth of mouth_area [m^2]. All is stretched so as to carry `load` [N], the opening force of
/// this instant: an unloaded parachute would fall into it and ring like a snatch that the scene left out.
///
/// axis: unit vector from payload to apex. With an odd number of columns the diagonals of the middle
/// one alternate; all others are mirror images, as the gore's cut is. Where vent lines hold the vent down,
/// the canopy is shorter along the axis, so far that they hang straight; throws SceneError where they are too
/// short for that.
Mesh make_gore_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass, const Vec3& axis,
                    double mouth_area, double load);

/// Generates the parachute as it is made, without any strain: the canopy in its constructed shape, lines and
/// risers straight below it, the payload at the origin and the apex above it on z. The first seam lies toward
/// x. Lines have to be longer than the canopy's radius at the skirt.
/// Its fabric alone where vent lines hold the vent down: these are shorter than it would take.
Mesh make_constructed_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass);

/// How elements are distributed: as counts says, but uniformly around an open middle, whose edge has no
/// narrow elements.
Grading meshed_grading(const Parachute& chute, const MeshCounts& counts);

}  // namespace twinchute::fullsim
