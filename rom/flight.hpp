// From snatch, or from an inflated start, to the end of a run: payload and parachutes as one rigid body.
#pragma once

#include <optional>

#include "rom/motion.hpp"
#include "rom/openings.hpp"

namespace twinchute::rom {

/// Flies on from a state at `time` [s]: each phase of each canopy is its own stage that ends exactly at its
/// time; conditions of triggers, steady descent and ground are roots. `separation` [m] of payload and
/// parachute. Fills in what an opening is judged by and says how the run ended; without a status where a pack
/// has to be left first (OpeningSequence::leaves_pack()), `motion` is then that of the payload at
/// Observer::rows().back().time.
template <int dimensions>
std::optional<RunStatus> fly_on(const Scene& scene, RunContext& context, OpeningSequence& sequence,
                                double time, Motion<dimensions>& motion, double separation,
                                Openings& openings);

}  // namespace twinchute::rom
