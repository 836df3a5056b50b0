// Which physics effect makes which part of the gap: both models run again with effects switched.
//
// First every effect is off in both models, and what is left between them is a term of its own. Then each
// comes back alone, in both models, and its effect is what that does to the difference between the two. The
// canopy's own shape comes last, on top of all others. What no effect does alone is the interaction. A packed
// scene has two more steps, between its own deployment and a start at line stretch.
#pragma once

#include <functional>
#include <stop_token>

#include "compare/attribution.hpp"
#include "compare/gap.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

struct AttributionOptions {
    int seeds = 7;    ///< of the reference, where its scene has random numbers; its own is one of them
    int threads = 1;  ///< runs at once; the answer is the same for any number
    std::stop_token stop = {};
    std::function<void(const Progress&)> progress = {};
};

/// Attributes the judged metrics of a comparison that has been made of `scene`. Where a side did not come to
/// its end, or an interrupt comes, there are no metrics in it, and a note says why.
Attribution attribute(const Comparison& comparison, const Scene& scene, const Fidelity& reference,
                      const Fidelity& candidate, const AttributionOptions& options);

}  // namespace twinchute::compare
