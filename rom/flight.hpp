// From snatch, or from an inflated start, to the end of a run: payload and parachute as one rigid body.
#pragma once

#include "lib/solve/opening.hpp"
#include "rom/course.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// Flies on from a state at the snatch time of `inflation`, in the phase that it begins with: initial phase,
/// filling, descent, each its own stage that ends exactly at its time; steady descent and ground are roots.
/// `event` names the start, unless it is null. Fills in what an opening is judged by and says how the run
/// ended.
template <int dimensions>
RunStatus fly_on(const Scene& scene, Course& course, const Inflation& inflation,
                 const Motion<dimensions>& start, double separation, const char* event,
                 OpeningResult& result);

}  // namespace twinchute::rom
