// A canopy of the same shape in another size, for designs that a scene gives another nominal diameter and for
// sizing.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// A quantity that went along with D0.
struct ScaledQuantity {
    std::string key;     ///< "parachute.mass"; of a reefed stage with its number
    double value = 0.0;  ///< [SI] now
};

/// Gives a parachute the nominal diameter `diameter` [m] in the same shape: vent, lines, risers and reefing
/// lines go with D0, the drag area with its square (C_D0 stays), volume and mouth of a filling balance with
/// its cube and square, the mass with that of fabric, tapes, lines and risers, or with the nominal area where
/// they are not all known; a length that does not follow is taken for part of that shape. Gores, links,
/// materials, ratios and times stay. `follows`: whether the quantity of a key goes along. Drag area: without
/// corrections, which have to be made again (set_drag_area). Returns what changed.
std::vector<ScaledQuantity> scale_canopy(Parachute& chute, double diameter,
                                         const std::function<bool(std::string_view key)>& follows);

}  // namespace twinchute
