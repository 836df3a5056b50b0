// Which method integrates which part of a run (docs/cost.md, "Methods of the reduced-order model").
#pragma once

#include "lib/scene/scene.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::rom {

inline constexpr std::string_view automatic = "auto";

/// Until the descent is steady. `automatic`: the pair of the highest order asks for the fewest evaluations at
/// any tolerance; the snatch is no exception, since it lasts a quarter of the lines' period, however short.
inline const OdeMethod& opening_method(const Scene& scene) {
    return *find_ode_method(scene.rom.method == automatic ? "dormand-prince" : scene.rom.method);
}
/// A steady descent that lasts: its rate of decay, 2 g/v, holds an explicit method back where nothing
/// happens.
inline const OdeMethod& descent_method() {
    return *find_ode_method("bdf");
}
/// While canopies fill by themselves: the mass that a small bulb moves goes with its volume, and its inflow
/// balances at once. An explicit method that a scene chooses would take steps of microseconds there.
inline const OdeMethod& filling_method(const Scene& scene) {
    const OdeMethod* chosen = find_ode_method(scene.rom.method);
    return chosen && chosen->implicit ? *chosen : *find_ode_method("bdf");
}
/// Factor on rom.rtol in a descent: at one tolerance its answer is ten times as far off as that of the
/// opening's pair.
inline constexpr double descent_tolerance = 0.1;

}  // namespace twinchute::rom
