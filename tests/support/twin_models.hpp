// Two models whose difference is known, for estimates from many runs of the one and few of the other.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include <gsl/gsl_cdf.h>

#include "study/campaign/multi_fidelity.hpp"
#include "study/campaign/random.hpp"
#include "tests/support/campaign_spec.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::study {

inline double uniform(std::uint64_t repetition, std::uint64_t index, std::uint32_t dimension = 0) {
    return unit_number(random_bits(repetition, index, dimension, RandomStream::test));
}
inline double normal(std::uint64_t repetition, std::uint64_t index, std::uint32_t dimension = 0) {
    return gsl_cdf_ugaussian_Pinv(uniform(repetition, index, dimension));
}

inline bool covers(const Interval& interval, double truth) {
    return interval.low <= truth && truth <= interval.high;
}

/// dear = cheap exp(0.02 + 0.01 x + 0.01 e), ln cheap = 0.1 x, x and e standard normal.
struct Twins {
    double cheap, dear, x;
};
inline Twins twins(std::uint64_t repetition, std::uint64_t run) {
    const double x = normal(repetition, run, 0), e = normal(repetition, run, 1);
    return {std::exp(0.1 * x), std::exp(0.02 + 0.11 * x + 0.01 * e), x};
}

/// A campaign's stores of both models, `dear_runs` of the dear one.
inline MultiFidelity combined(const CampaignSpec& spec, const ScratchDir& here, std::uint64_t repetition,
                              std::uint64_t dear_runs) {
    StoreIdentity identity{"program", "digest", 1, 8192, {"status", "x1", "y"}, {"", "", ""}, {"completed"}};
    RunStore cheap(here / "cheap", identity), dear(here / "dear", identity);
    cheap.begin(), dear.begin();
    std::vector<double> of_cheap, of_dear;
    for (std::uint64_t run = 0; run < spec.runs; ++run) {
        const Twins t = twins(repetition, run);
        of_cheap.insert(of_cheap.end(), {0.0, t.x, t.cheap});
        if (run < dear_runs) of_dear.insert(of_dear.end(), {0.0, t.x, t.dear});
    }
    cheap.write(0, of_cheap), dear.write(0, of_dear);
    const Columns columns{{"y"}, 1};
    return combine(spec, cheap, columns, dear, columns, spec.runs, dear_runs);
}

struct Held {
    int probability = 0, quantile = 0;
};

/// How many of so many intervals hold P(ln dear > 0.2) and the 90 % quantile. ln dear is normal with mean
/// 0.02 and variance 0.0122; the cheap model alone says 2.3 %.
inline Held held_by_pairs(std::uint64_t tries) {
    CampaignSpec spec = test::campaign_of({Distribution::normal(0.0, 1.0)}, DesignKind::random, 8000);
    AnswerSpec overload, high;
    overload.kind = AnswerSpec::Kind::probability, overload.metric = "y", overload.threshold = std::exp(0.2);
    high.kind = AnswerSpec::Kind::quantile, high.metric = "y", high.level = 0.9;
    spec.answers = {overload, high};
    const double sd = std::sqrt(0.0122);
    const double truth = gsl_cdf_ugaussian_Q(0.18 / sd),
                 top = std::exp(0.02 + sd * gsl_cdf_ugaussian_Pinv(0.9));
    Held held;
    for (std::uint64_t r = 0; r < tries; ++r) {
        const ScratchDir here;
        const MultiFidelity both = combined(spec, here, r, 40);
        held.probability += covers(both.answers[0].value, truth) ? 1 : 0;
        held.quantile += covers(both.answers[1].value, top) ? 1 : 0;
        EXPECT_NEAR(both.answers[0].value.estimate, truth, 0.35 * truth);
        EXPECT_NEAR(both.answers[0].cheap, gsl_cdf_ugaussian_Q(2.0), 0.01);
    }
    return held;
}

}  // namespace twinchute::study
