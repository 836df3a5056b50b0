// Average pressure of the canopy, for every layout.
#pragma once

#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// Sets air.pressure so that it gives the prescribed drag on air.projected_area [Pa], at most three dynamic
/// pressures and on no less than the smallest area [m^2]. Returns the residual drag [N], which
/// acts uniformly on the fabric: the sum along e_r is then the prescribed drag to round-off.
Vec3 set_pressure(AeroState& air, double smallest_area);

}  // namespace twinchute::fullsim
