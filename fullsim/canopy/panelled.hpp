// Canopies whose gores are a list of panels: conical, biconical, triconical, extended skirt, hemispherical.
#pragma once

#include "fullsim/canopy/canopy_geometry.hpp"

namespace twinchute::fullsim {

/// Gores of gore_panels(); one flat panel where a parachute has none. All gores together, with the tips that
/// the vent cuts off, have the nominal area, or around an open middle without them; the vent's polygon has
/// the area of the vent circle.
CanopyGeometry panelled();

}  // namespace twinchute::fullsim
