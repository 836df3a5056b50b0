// Intervals of `fidelity = "both"` for probabilities and quantiles: 95 % of them hold, in 1000 campaigns.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/twin_models.hpp"

namespace twinchute::study {
namespace {

TEST(CampaignPairsLong, IntervalsHoldAsOftenAsTheySay) {
    const Held held = held_by_pairs(1000);
    std::printf("PAIRS|probability %d|quantile %d of 1000\n", held.probability, held.quantile);
    // At least 93 % is asked for: 95 % less three standard errors of 0.7 %.
    EXPECT_GE(held.probability, 930);
    EXPECT_GE(held.quantile, 930);
}

}  // namespace
}  // namespace twinchute::study
