// The flat circular canopy: plane gores that lie side by side as a disc with a vent.
#pragma once

#include "fullsim/canopy/canopy_geometry.hpp"

namespace twinchute::fullsim {

/// Gores are isosceles triangles with the vent's tip cut off. The polygon of all gores has the area of the
/// nominal circle, the polygon of the vent that of the vent circle.
CanopyGeometry flat_circular();

}  // namespace twinchute::fullsim
