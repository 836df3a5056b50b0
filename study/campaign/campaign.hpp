// A campaign from its file to its results.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "lib/solve/fidelity.hpp"
#include "study/campaign/engine.hpp"
#include "study/campaign/multi_fidelity.hpp"
#include "study/campaign/rare.hpp"
#include "study/campaign/results.hpp"
#include "study/campaign/sampler.hpp"
#include "study/campaign/spec.hpp"
#include "study/campaign/store.hpp"

namespace twinchute::study {

/// One fidelity of a campaign: its runs and where they lie.
struct CampaignRuns {
    const Fidelity* fidelity = nullptr;
    Columns columns;
    std::unique_ptr<RunStore> store;
    bool in_batches = false;
    std::string engine;    ///< how its runs are made, for the record
    MakingCost cost = {};  ///< of those that were made this time
};

struct Campaign {
    CampaignSpec spec;
    std::unique_ptr<Sampler> sampler;
    std::filesystem::path directory;
    std::vector<CampaignRuns> of;  ///< the first answers; of `both` ROM, then full

    CampaignResults results = {};
    std::optional<MultiFidelity> both = {};
    std::uint64_t full_runs = 0;  ///< of `both`
    std::vector<std::optional<RareEvent>> rare =
        {};                                     ///< of each answer that is a probability, once it is made
    std::vector<std::string> set_in_vain = {};  ///< keys that are set and vary: the set values are of no run
    double seconds = 0.0;                       ///< [s] that making the runs took
    int threads = 1;
    bool interrupted = false;
};

/// Verdict on an answer: that of the full model where it has one.
struct Judgement {
    const AnswerSpec* spec;
    Interval value;
    Verdict verdict;
    bool is_of_full;
};
std::vector<Judgement> judgements(const Campaign& campaign);

struct CampaignSettings {
    std::vector<std::string> overrides;  ///< of the scene, "--set key=value"
    SceneWith scene_with = {};           ///< the scene that varies; empty: the one that the file names
    int threads = 1;
    std::uint64_t shard = 0, shards = 1;
    std::stop_token stop = {};
    std::function<void(const Progress&)> progress = {};  ///< may be empty
};

/// Opens a campaign: reads its scene, finds the metrics that it keeps by one run of it. Throws SceneError and
/// UsageError.
Campaign open_campaign(CampaignSpec spec, const Fidelity& rom, const Fidelity& full,
                       const std::filesystem::path& directory, const CampaignSettings& settings);

/// Makes the runs that are missing. Throws WriteError.
void run_campaign(Campaign& campaign, const CampaignSettings& settings);

/// Results of the runs that are there, all of the campaign's or those that were made so far.
void evaluate_campaign(Campaign& campaign);

}  // namespace twinchute::study
