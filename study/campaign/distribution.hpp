// Distributions of inputs, sampled by their inverse: one uniform number makes one value, so that designs and
// correlations work on uniform numbers alone.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace twinchute::study {

/// A distribution of one input, cut off at `low` and `high` with the rest scaled to one.
class Distribution {
public:
    enum class Kind { normal, lognormal, uniform, triangular, discrete, table };

    /// [SI] sd > 0.
    static Distribution normal(double mean, double sd);
    /// mean > 0 and sd > 0: of the variable, not of its logarithm.
    static Distribution lognormal(double mean, double sd);
    /// median > 0; log_sd > 0 [-]: of the natural logarithm.
    static Distribution lognormal_by_median(double median, double log_sd);
    static Distribution uniform(double low, double high);
    static Distribution triangular(double low, double mode, double high);
    /// Weights are positive, of any sum.
    static Distribution discrete(std::vector<double> values, const std::vector<double>& weights);
    /// Words: a value is the index of one of them.
    static Distribution discrete(std::vector<std::string> words, const std::vector<double>& weights);
    /// Rising values, and shares below each, from 0 to 1: linear between.
    static Distribution table(std::vector<double> values, std::vector<double> below);

    /// Cuts it off; false where nothing is left. Not for discrete ones.
    bool cut(double low, double high);

    /// The value that a share `u` in (0, 1) lies below.
    double at(double u) const;
    /// Share below x, of the distribution that is cut off.
    double below(double x) const;

    Kind kind() const { return kind_; }
    /// Different values of a discrete one, in order; none of others.
    std::span<const double> discrete_values() const {
        return kind_ == Kind::discrete ? std::span<const double>(values_) : std::span<const double>();
    }
    const std::vector<std::string>& words() const { return words_; }
    /// Exact: part of a store's digest.
    std::string text() const;
    /// Text for readers, rounded; a lognormal one by its mean and standard deviation.
    std::string shown() const;

private:
    double whole_at(double u, double above) const;
    double whole_below(double x) const;
    double whole_above(double x) const;
    double triangular_at(double u) const;
    double table_at(double u) const;

    Kind kind_ = Kind::uniform;
    double a_ = 0.0, b_ = 0.0, c_ = 0.0;
    std::vector<double> values_, below_;
    std::vector<std::string> words_;
    double low_ = -std::numeric_limits<double>::infinity();
    double high_ = std::numeric_limits<double>::infinity();
    double cut_below_ = 0.0, cut_above_ = 0.0, left_ = 1.0;  // shares that are cut off, and what is left
};

}  // namespace twinchute::study
