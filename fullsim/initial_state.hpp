// Initial conditions of a run: opening, mesh and state at the scene's release.
#pragma once

#include <Eigen/Geometry>

#include "fullsim/mesh/mesh.hpp"
#include "fullsim/state.hpp"
#include "fullsim/time/mass_scaling.hpp"
#include "lib/models/inflation.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Phase in which the opening begins: open, initial or filling.
Phase first_phase(const Scene& scene, const Inflation& inflation);

/// Opening that begins with a snatch at `snatch` [s] and airspeed `speed` [m/s] in air of `density` [kg/m^3],
/// later by the lag of the parachute.
Inflation inflation_from(const Scene& scene, double snatch, double speed, double density);

/// Opening as known at release. That of a packed canopy is made at snatch; until then none of it has a time.
Inflation first_inflation(const Scene& scene);

/// Mesh at release, with the masses that `full.mass_scaling` adds; `scaling` says what it did.
Mesh first_mesh(const Scene& scene, const Inflation& inflation, MassScaling& scaling);

/// The mesh turned about the point where it meets the payload, which stays as it is.
Mesh turned(Mesh mesh, const Eigen::Quaterniond& by);

/// Nodes at release with the scene's noise, at the release's velocity; the anchor of a static line at its
/// own, a pack as its mortar throws it and the payload as that recoils.
State first_state(const Scene& scene, const Mesh& mesh);

}  // namespace twinchute::fullsim
