// Estimates from many runs of a cheap model and few of a dear one, at the same inputs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/campaign/results.hpp"

namespace twinchute::study {

/// Runs of both models at the same inputs, of one metric.
struct Pairs {
    std::vector<double> cheap, dear;          ///< [metric's unit]
    std::vector<std::vector<double>> inputs;  ///< of each pair

    std::size_t count() const { return cheap.size(); }
    double correlation() const;
};

/// An answer of the dear model.
struct PairedAnswer {
    const AnswerSpec* spec = nullptr;
    Interval value = {};       ///< of the dear model, with the uncertainty of pairs and of cheap runs
    Interval dear_alone = {};  ///< from its own runs, as if there were no cheap model
    double cheap = 0.0;        ///< of the cheap model's runs
    double correlation = 0.0;  ///< of the pairs
    Interval gain = {};        ///< dear runs that plain sampling would need, over those that were made; means
    std::uint64_t cheap_runs = 0;  ///< that have the metric
    double scatter = 0.0;          ///< [-] of ln(dear/cheap) about its fit; probabilities and quantiles
    /// Upper end of `value`, were the runs of either model without the metric the worst of all; of a mean, as
    /// bad as the worst of those that have it.
    double worst = 0.0;
    std::string method;
    Verdict verdict = Verdict::open;
    std::string note;  ///< a sentence, may be empty
};

struct MultiFidelity {
    std::uint64_t pairs = 0, pilot = 0;
    Endings endings;          ///< of the dear model's runs
    double cost_ratio = 0.0;  ///< of a dear run over a cheap one, by the clock; NaN: not seen this time
    std::vector<PairedAnswer> answers;
};

/// Mean of the dear model by the cheap one as control variate (Lavenberg, Welch, Management Science 27
/// (1981)): mean(dear) + b (mean of all cheap - mean of the pairs' cheap), b by least squares on all pairs,
/// the pilot's among them. Interval by Student's t of n - 2 degrees of freedom; the mean of all cheap runs
/// has its own uncertainty, b^2 s^2/N.
Interval control_variate_mean(const Pairs& pairs, const Moments& cheap);

/// Variance of the plain mean of as many dear runs over that of the control variate's,
/// 1/(1 - r^2 + r^2 n/N); its interval from Fisher's z of the correlation r: what n pairs do not know of it.
Interval control_variate_gain(const Pairs& pairs, std::uint64_t cheap_runs);

/// Cheap runs for each dear one at which a mean by control variate has the narrowest interval for what it
/// costs, from the correlation of the models and the cost of a dear run over that of a cheap one:
/// Peherstorfer, Willcox, Gunzburger, SIAM J. Sci. Comput. 38 (2016). At least one: every dear run is one of
/// a pair.
double best_cheap_runs(double correlation, double cost_ratio);

/// Fit of ln(dear/cheap), linear in the inputs where there are enough pairs, otherwise constant.
struct Correction {
    std::vector<double> coefficients;    ///< constant, then of each input less its mean over its spread
    std::vector<double> centre, spread;  ///< of each input
    double scatter = 0.0;                ///< standard deviation of residuals, each of a fit without its pair
    double at(std::span<const double> inputs) const;  ///< of ln(dear/cheap)
};
/// Nothing where a value is not positive or there are fewer than four pairs. `take`: which pairs, some more
/// than once; empty: each once.
std::optional<Correction> fit_correction(const Pairs& pairs, std::span<const std::size_t> take = {});

/// Answers about the dear model from the runs of both, those of `dear` at the inputs of the first of `cheap`.
/// Means by control variates; probabilities and quantiles from the cheap runs, each corrected and scattered.
MultiFidelity combine(const CampaignSpec& spec, const RunStore& cheap, const Columns& cheap_columns,
                      const RunStore& dear, const Columns& dear_columns, std::uint64_t cheap_runs,
                      std::uint64_t dear_runs);

}  // namespace twinchute::study
