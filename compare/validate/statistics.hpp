// How far a model is from measurements as a whole: bias and scatter of a group of comparisons, and spreads.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace twinchute::compare {

/// A predicted and a measured value of one quantity, both positive.
struct Pair {
    double predicted = 0.0, measured = 0.0;
    double sigma = 0.0;  ///< [-] relative standard uncertainty of the comparison: measurement and inputs
};

/// Bias and scatter of a group as validation guides of fire models state them (FDS Validation Guide,
/// "Calculating Model Uncertainty"; McGrattan and Toman, Metrologia 48, 2011, 173-180). With L = mean ln(M/E)
/// and s^2 = sum (ln(M/E) - L)^2/(n - 1):
///   sigma_M^2 = s^2 - sigma_E^2, and bias = exp(L + sigma_M^2/2 - sigma_E^2/2).
/// sigma_E is the root mean square of the pairs' sigma. A model cannot be shown to be more accurate than what
/// it is compared with, so that sigma_E^2 is at most s^2/2 there.
struct Agreement {
    int count = 0;
    double mean_log = 0.0;          ///< L
    double spread = 0.0;            ///< s [-]
    double sigma_experiment = 0.0;  ///< [-] as stated
    bool capped = false;            ///< sigma_E^2 was more than s^2/2
    double sigma_model = 0.0;       ///< [-]
    double bias = 1.0;              ///< predicted over true
};

/// Nothing with fewer than three pairs, or where one is not positive and finite.
std::optional<Agreement> agreement(std::span<const Pair> pairs);

/// The middle value, or the mean of the two in the middle. values: not empty, none is NaN.
double median(std::vector<double> values);

/// Root of the mean squared distance from the mean, over n - 1; 0 for a single value.
double standard_deviation(std::span<const double> values);

/// Numbers from a standard normal distribution, cut off at three: the same for the same seed and count.
std::vector<double> normal_numbers(std::size_t count, unsigned long seed);

}  // namespace twinchute::compare
