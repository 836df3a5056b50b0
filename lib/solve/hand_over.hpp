// The rest of a fall: where one fidelity has stopped with its canopies open, another one flies on to the
// ground.
#pragma once

#include <span>

#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// For plans of a scene that asks for it.
std::string then_text(const Scene& scene);

/// The scene as it goes on from the last row of a record, to the ground: without the parachutes that were
/// cut, the others open, place and velocity of the payload as they are there. It begins at time 0 above the
/// place of that row.
Scene continued_from(const Scene& scene, const RunRecord& record);

/// One record of a run and of what came after its last row by a run of continued_from. Channels of `first` go
/// on with those of `rest`, or with NaN where that has none; the metrics of the landing are those of `rest`,
/// in the time and place of `first`, and say so, as HandOver does.
RunRecord joined(RunRecord first, const Scene& scene, const RunRecord& rest);

/// Runs a scene, and by that one of `others` which Scene::then names the rest of the fall. A run that has not
/// met its stop condition, or has met it before every canopy was open or cut for good, is not handed over;
/// the latter says so in a warning.
RunRecord run_scene(const Fidelity& fidelity, const Scene& scene, Run& run,
                    std::span<const Fidelity* const> others);

}  // namespace twinchute
