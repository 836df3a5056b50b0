// Many runs of one kind of scene side by side: a canopy that opens at once from line stretch, to its peak
// force or until it is full. All that happens is known at snatch then, so that each stage takes as long as it
// takes in its own normalised time, and all lanes come to its end together.
#pragma once

#include <span>
#include <string>

#include "lib/solve/fidelity.hpp"

namespace twinchute::rom {

inline constexpr std::size_t batch_lanes = 64;

/// Whether scenes of this kind go in batches (Fidelity::batches): still air, one canopy of one drag area, a
/// prescribed filling without stages, at most the inertia of added mass, a stop at peak force or full open.
bool batches(const Scene& scene, std::span<const std::string> keys);

/// Fidelity::metrics_of_batch, of batch_lanes scenes. What a lane's trajectory does not settle goes to
/// rom_metrics(): a scene of another kind, a peak that is not past in time, the ground.
void batch_metrics(std::span<const Scene> scenes, Run& run, std::span<const std::string> keys,
                   std::span<double> values, std::span<StatusCode> statuses);

}  // namespace twinchute::rom
