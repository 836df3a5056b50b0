#include "compare/validate/statistics.hpp"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace twinchute::compare {

std::optional<Agreement> agreement(std::span<const Pair> pairs) {
    if (pairs.size() < 3) return {};
    std::vector<double> logs;
    double squares = 0.0;
    for (const Pair& pair : pairs) {
        if (!(pair.predicted > 0.0 && pair.measured > 0.0)) return {};
        logs.push_back(std::log(pair.predicted / pair.measured));
        squares += pair.sigma * pair.sigma;
        if (!std::isfinite(logs.back()) || !std::isfinite(squares)) return {};
    }
    Agreement found;
    found.count = static_cast<int>(pairs.size());
    found.mean_log = gsl_stats_mean(logs.data(), 1, logs.size());
    found.spread = standard_deviation(logs);
    found.sigma_experiment = std::sqrt(squares / static_cast<double>(pairs.size()));
    const double variance = found.spread * found.spread, most = 0.5 * variance;
    const double stated = found.sigma_experiment * found.sigma_experiment;
    found.capped = stated > most;
    const double experiment = std::min(stated, most), model = variance - experiment;
    found.sigma_model = std::sqrt(model);
    found.bias = std::exp(found.mean_log + 0.5 * model - 0.5 * experiment);
    return found;
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return gsl_stats_median_from_sorted_data(values.data(), 1, values.size());
}

double standard_deviation(std::span<const double> values) {
    return values.size() < 2 ? 0.0 : gsl_stats_sd(values.data(), 1, values.size());
}

std::vector<double> normal_numbers(std::size_t count, unsigned long seed) {
    const std::unique_ptr<gsl_rng, void (*)(gsl_rng*)> source(gsl_rng_alloc(gsl_rng_mt19937), gsl_rng_free);
    gsl_rng_set(source.get(), seed);
    std::vector<double> numbers;
    while (numbers.size() < count)
        if (const double z = gsl_ran_gaussian(source.get(), 1.0); std::abs(z) <= 3.0) numbers.push_back(z);
    return numbers;
}

}  // namespace twinchute::compare
