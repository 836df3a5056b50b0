// `twinchute export`: the parachutes of a scene for another program.
#pragma once

#include <string>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::exchange {

/// `rom`: gives the time from trigger to full canopy.
Command export_command(const Fidelity& rom);

/// Python that makes a rocketpy.Parachute of each parachute of a scene. `record`: a run of it. Throws
/// UsageError where RocketPy has no trigger of that kind.
std::string rocketpy_text(const Scene& scene, const RunRecord& record);

}  // namespace twinchute::exchange
