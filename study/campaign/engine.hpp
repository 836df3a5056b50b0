// Makes the runs of a campaign, chunk by chunk, on some threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "lib/solve/fidelity.hpp"
#include "study/campaign/results.hpp"
#include "study/campaign/sampler.hpp"
#include "study/campaign/store.hpp"

namespace twinchute::study {

/// Cost of runs.
struct MakingCost {
    double seconds = 0.0;  ///< of all threads
    std::uint64_t runs = 0;
    double each() const { return seconds / static_cast<double>(runs); }  ///< [s]; NaN of none
};

/// Runs of one fidelity.
struct Engine {
    const CampaignSpec& spec;
    const Sampler& sampler;
    const Fidelity& fidelity;
    Columns columns;
    int threads = 1;
    std::uint64_t shard = 0, shards = 1;  ///< chunks whose number is `shard` modulo `shards`
    std::stop_token stop = {};
    /// After so many more runs; from any thread, one at a time. May be empty.
    std::function<void(std::span<const double> rows)> made = {};
    bool in_batches = false;  ///< by Fidelity::metrics_of_batch
    /// Independent standard normal scores of the inputs, a row a run: runs lie there, not where the design
    /// has them. May be empty.
    std::span<const double> scores = {};
    MakingCost* cost = nullptr;  ///< counts what run() makes; may be null

    /// Makes the chunks of the first `runs` runs that are missing. False where it was interrupted before the
    /// end. Throws WriteError.
    bool run(const RunStore& store, std::uint64_t runs) const;
    /// Makes the runs at `scores`, a row each [status, inputs, metrics]. False where it was interrupted.
    bool run_at_scores(std::span<double> rows) const;

private:
    /// State of one thread.
    struct Worker {
        Design design;
        Scene scene;
        std::vector<Scene> scenes;  // of a batch
        std::vector<double> values;
    };
    bool make_chunk(Worker& worker, std::uint64_t first, std::span<double> rows) const;
    bool make_batches(Worker& worker, std::uint64_t first, std::span<double> rows) const;
    void make_batch(Worker& worker, std::uint64_t first, std::span<double> rows) const;
    void make_row(Design& design, Scene& scene, std::uint64_t run, std::span<double> row) const;
    /// None, of a run that ended as it should: the metric is there where some have not opened.
    void count_unopened(std::span<double> row) const;
    void find_inputs(Design& design, std::uint64_t run, std::span<double> values) const;
};

/// Status of a run whose inputs a scene must not have.
inline constexpr StatusCode refused_inputs = StatusCode::refused;

}  // namespace twinchute::study
