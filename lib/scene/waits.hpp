// Dependencies between the triggers of parachutes, and triggers that nothing can ever meet.
#pragma once

#include <optional>
#include <string>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// A trigger that is never met, whatever the flight.
struct HopelessWait {
    std::size_t parachute = 0;  ///< in the scene, whose trigger it is
    std::string table;          ///< of its keys, e.g. "parachute.deploy.when"
    std::string problem, why, hint;
};

/// The first trigger that waits for itself, through however many others, for the cut of a parachute that is
/// never cut, for the cut of the parachute that it opens further, or for an altitude below the ground.
/// Absent: none. Names that triggers are about are those of parachutes of the scene.
std::optional<HopelessWait> find_hopeless_wait(const Scene& scene);

}  // namespace twinchute
