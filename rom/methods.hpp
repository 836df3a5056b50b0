// Which method integrates which part of a run (docs/cost.md, "Methods of the reduced-order model").
#pragma once

#include "lib/scene/scene.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::rom {

inline constexpr std::string_view automatic = "auto";

/// Until the descent is steady, the snatch apart. The looser the tolerance, the lower the order that asks for
/// the fewest evaluations: the choice of `automatic` changes where the pairs' curves of error against
/// evaluations cross.
inline const OdeMethod& opening_method(const Scene& scene) {
    constexpr double loose = 3e-4, middling = 3e-8;
    if (scene.rom.method != automatic) return *find_ode_method(scene.rom.method);
    return *find_ode_method(scene.rom.rtol > loose      ? "bogacki-shampine"
                            : scene.rom.rtol > middling ? "zonneveld"
                                                        : "dormand-prince");
}
/// Taut lines are the stiff part of a run, whatever the scene says: with stiff cord and a light canopy they
/// swing in milliseconds.
inline const OdeMethod& snatch_method() {
    return *find_ode_method("kvaerno-5");
}
/// A steady descent that lasts: its rate of decay, 2 g/v, holds an explicit method back where nothing
/// happens.
inline const OdeMethod& descent_method() {
    return *find_ode_method("bdf");
}
/// Of rom.rtol: at the same tolerance its answer is ten times as far off as that of the opening's pair.
inline constexpr double descent_tolerance = 0.1;

}  // namespace twinchute::rom
