// Campaigns by hand: inputs without a scene behind them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "study/campaign/spec.hpp"

namespace twinchute::test {

/// Inputs "x1", "x2", ... with these distributions.
inline study::CampaignSpec campaign_of(std::vector<study::Distribution> distributions,
                                       study::DesignKind design, std::uint64_t runs, std::uint64_t seed = 1) {
    study::CampaignSpec spec;
    spec.design = design;
    spec.runs = runs;
    spec.seed = seed;
    for (study::Distribution& distribution : distributions) {
        study::CampaignInput& input = spec.inputs.emplace_back();
        input.key = "x" + std::to_string(spec.inputs.size());
        input.distribution = std::move(distribution);
    }
    const auto n = static_cast<Eigen::Index>(spec.inputs.size());
    spec.correlation = Eigen::MatrixXd::Identity(n, n);
    return spec;
}

}  // namespace twinchute::test
