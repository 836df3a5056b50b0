// One scene at many values of a few keys, without a file: what a campaign does, for who has the values
// already.
#pragma once

#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "lib/solve/fidelity.hpp"
#include "study/varied_scene.hpp"

namespace twinchute::study {

/// Values of the keys that vary, run by run.
struct ManyInputs {
    std::vector<std::string> keys;
    std::vector<std::vector<double>>
        values;  ///< [SI] of each key, all of one length; keys of whole numbers too
};

struct ManyRuns {
    std::vector<std::vector<double>> metrics;  ///< of each metric, NaN where a run has none
    /// How each run ended; `refused` where a scene must not have such inputs.
    std::vector<StatusCode> statuses;
    std::string refusal;  ///< why the first run that was refused was; else empty
    bool interrupted = false;
};

/// Runs the scene at each row of the inputs, in batches where the fidelity takes it in batches and one by one
/// otherwise. `metrics`: keys of a record. The answer is the same for any number of threads. Throws
/// SceneError where the scene can have none of the inputs, UsageError for a value of a whole number that is
/// none.
ManyRuns run_many(const SceneWith& scene_with, const ManyInputs& inputs,
                  const std::vector<std::string>& metrics, const Fidelity& fidelity, int threads,
                  const std::stop_token& stop);

}  // namespace twinchute::study
