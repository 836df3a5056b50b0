// One run of the reduced-order model.
#pragma once

#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

/// From release to the scene's stop condition. A packed parachute is a second body until snatch
/// (rom/deployment.hpp), from then on, and in the other scenes from the start, both are one (rom/flight.hpp).
/// One dimension for a vertical fall in still air, two for any other in still air, three with wind.
RunRecord run_rom(const Scene& scene, Run& run);

/// Metrics of such a run alone (Fidelity::metrics).
RunStatus rom_metrics(const Scene& scene, Run& run, std::span<const std::string> keys,
                      std::span<double> values);

}  // namespace twinchute::rom
