// Runs that know nothing of each other, several at once.
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

struct RunJob {
    const Fidelity* fidelity = nullptr;
    Scene scene;
};

/// The record of each job, in their order: the same for any number of threads, since each run has one of
/// its own. `progress` may be empty; it is called by one thread at a time. What a run throws is thrown here,
/// the first in order, once all have ended.
std::vector<RunRecord> run_jobs(std::span<const RunJob> jobs, int threads, const std::stop_token& stop,
                                const std::function<void(const Progress&)>& progress);

}  // namespace twinchute::compare
