// The shapes in which a scene's parachute can start: drawn out without load, packed, under load at line
// stretch, open.
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/models/inflation.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// The scene with the mass of its mesh in place of parachute.mass, which is the reduced-order model's.
Scene weighed(const Scene& scene);

/// Unit vector straight behind the release, against the flight through the air; up where there is none.
Vec3 trailing_direction(const Scene& scene);

/// Unit vector that the parachute starts along: the trailing direction, for a pack turned by its pitch in the
/// vertical plane of the release, apex up; a release straight down, or at rest, turns toward its heading.
Vec3 start_axis(const Scene& scene);

/// The parachute as it is made, without any strain: the generated one (make_constructed_mesh), an imported
/// one as its file has it.
Mesh built_mesh(const Scene& scene);

/// The parachute drawn out along its axis without any load, mouth as at line stretch: the shape that is
/// packed.
Mesh unloaded_mesh(const Scene& scene);

/// Collapses a drawn-out parachute onto the confluence: every distance from it times `ratio` (paper, 4).
void pack(Mesh& mesh, double ratio);

/// The mesh as a run of this scene begins: packed, or drawn out or open under the opening force of that
/// instant in the phase the inflation begins with.
Mesh start_mesh(const Scene& scene, const Inflation& inflation, Phase phase);

}  // namespace twinchute::fullsim
