#include "study/campaign/distribution.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace twinchute::study {
namespace {

std::vector<double> running_share(const std::vector<double>& weights) {
    std::vector<double> below;
    double sum = 0.0;
    for (const double weight : weights)
        below.push_back(sum += weight);
    for (double& share : below)
        share /= sum;
    below.back() = 1.0;
    return below;
}

}  // namespace

Distribution Distribution::normal(double mean, double sd) {
    Distribution d;
    d.kind_ = Kind::normal, d.a_ = mean, d.b_ = sd;
    return d;
}

Distribution Distribution::lognormal(double mean, double sd) {
    const double ratio = sd / mean, log_sd = std::sqrt(std::log1p(ratio * ratio));
    return lognormal_by_median(mean * std::exp(-0.5 * log_sd * log_sd), log_sd);
}

Distribution Distribution::lognormal_by_median(double median, double log_sd) {
    Distribution d;
    d.kind_ = Kind::lognormal, d.a_ = std::log(median), d.b_ = log_sd;
    return d;
}

Distribution Distribution::uniform(double low, double high) {
    Distribution d;
    d.kind_ = Kind::uniform, d.a_ = low, d.b_ = high;
    return d;
}

Distribution Distribution::triangular(double low, double mode, double high) {
    Distribution d;
    d.kind_ = Kind::triangular, d.a_ = low, d.b_ = mode, d.c_ = high;
    return d;
}

Distribution Distribution::discrete(std::vector<double> values, const std::vector<double>& weights) {
    Distribution d;
    d.kind_ = Kind::discrete, d.values_ = std::move(values), d.below_ = running_share(weights);
    return d;
}

Distribution Distribution::discrete(std::vector<std::string> words, const std::vector<double>& weights) {
    std::vector<double> indices;
    for (std::size_t i = 0; i < words.size(); ++i)
        indices.push_back(static_cast<double>(i));
    Distribution d = discrete(std::move(indices), weights);
    d.words_ = std::move(words);
    return d;
}

Distribution Distribution::table(std::vector<double> values, std::vector<double> below) {
    Distribution d;
    d.kind_ = Kind::table, d.values_ = std::move(values), d.below_ = std::move(below);
    return d;
}

bool Distribution::cut(double low, double high) {
    low_ = low, high_ = high;
    cut_below_ = whole_below(low), cut_above_ = whole_above(high);
    // Of the tail that it lies in: far out one share less another, both almost 1, has no digits.
    left_ = cut_below_ > 0.5 ? whole_above(low) - cut_above_ : whole_below(high) - cut_below_;
    return left_ > 0.0;
}

double Distribution::at(double u) const {
    // Both tails are kept: of a distribution that is cut off far out, the nearer one counts.
    const double share = cut_below_ + u * left_, above = cut_above_ + (1.0 - u) * left_;
    return std::clamp(whole_at(share, above), low_, high_);
}

double Distribution::below(double x) const {
    if (x <= low_) return x < low_ || kind_ != Kind::discrete ? 0.0 : whole_below(x);
    if (x >= high_) return 1.0;
    return (whole_below(x) - cut_below_) / left_;
}

double Distribution::whole_at(double u, double above) const {
    const auto normal = [&] { return u < above ? gsl_cdf_ugaussian_Pinv(u) : gsl_cdf_ugaussian_Qinv(above); };
    switch (kind_) {
        case Kind::normal:
            return a_ + b_ * normal();
        case Kind::lognormal:
            return std::exp(a_ + b_ * normal());
        case Kind::uniform:
            return a_ + u * (b_ - a_);
        case Kind::triangular:
            return triangular_at(u);
        case Kind::discrete:
            return values_[static_cast<std::size_t>(std::ranges::upper_bound(below_, u) - below_.begin())];
        case Kind::table:
            return table_at(u);
    }
    return 0.0;
}

double Distribution::triangular_at(double u) const {
    const double left = (b_ - a_) / (c_ - a_);
    return u < left ? a_ + std::sqrt(u * (c_ - a_) * (b_ - a_))
                    : c_ - std::sqrt((1.0 - u) * (c_ - a_) * (c_ - b_));
}

double Distribution::table_at(double u) const {
    const auto above = std::ranges::upper_bound(below_, u);
    if (above == below_.end()) return values_.back();
    const auto i = static_cast<std::size_t>(above - below_.begin());
    return values_[i - 1] + (values_[i] - values_[i - 1]) * (u - below_[i - 1]) / (below_[i] - below_[i - 1]);
}

double Distribution::whole_below(double x) const {
    switch (kind_) {
        case Kind::normal:
            return gsl_cdf_ugaussian_P((x - a_) / b_);
        case Kind::lognormal:
            return x > 0.0 ? gsl_cdf_ugaussian_P((std::log(x) - a_) / b_) : 0.0;
        case Kind::uniform:
            return std::clamp((x - a_) / (b_ - a_), 0.0, 1.0);
        case Kind::triangular:
            if (x <= a_) return 0.0;
            if (x >= c_) return 1.0;
            return x < b_ ? (x - a_) * (x - a_) / ((c_ - a_) * (b_ - a_))
                          : 1.0 - (c_ - x) * (c_ - x) / ((c_ - a_) * (c_ - b_));
        case Kind::discrete: {
            double share = 0.0;
            for (std::size_t i = 0; i < values_.size(); ++i)
                if (values_[i] <= x) share += below_[i] - (i > 0 ? below_[i - 1] : 0.0);
            return share;
        }
        case Kind::table: {
            if (x <= values_.front()) return 0.0;
            if (x >= values_.back()) return 1.0;
            const auto i = static_cast<std::size_t>(std::ranges::upper_bound(values_, x) - values_.begin());
            return below_[i - 1] +
                   (below_[i] - below_[i - 1]) * (x - values_[i - 1]) / (values_[i] - values_[i - 1]);
        }
    }
    return 0.0;
}

double Distribution::whole_above(double x) const {
    if (kind_ == Kind::normal) return gsl_cdf_ugaussian_Q((x - a_) / b_);
    if (kind_ == Kind::lognormal) return x > 0.0 ? gsl_cdf_ugaussian_Q((std::log(x) - a_) / b_) : 1.0;
    return 1.0 - whole_below(x);
}

namespace {

constexpr const char* kind_names[] = {"normal", "lognormal", "uniform", "triangular", "discrete", "table"};

}  // namespace

std::string Distribution::text() const {
    std::string text = kind_names[static_cast<std::size_t>(kind_)];
    if (!values_.empty())
        text += fmt::format("({}; {}; {})", fmt::join(words_, ", "), fmt::join(values_, ", "),
                            fmt::join(below_, ", "));
    else
        text += fmt::format("({}, {}, {})", a_, b_, c_);
    return text + fmt::format(" from {} to {}", low_, high_);
}

std::string Distribution::shown() const {
    std::string text = kind_names[static_cast<std::size_t>(kind_)];
    if (!words_.empty())
        text += fmt::format(" of {}", fmt::join(words_, ", "));
    else if (!values_.empty())
        text += fmt::format(" of {:.5g}", fmt::join(values_, ", "));
    else if (kind_ == Kind::triangular)
        text += fmt::format(" from {:.5g} over {:.5g} to {:.5g}", a_, b_, c_);
    else if (kind_ == Kind::uniform)
        text += fmt::format(" from {:.5g} to {:.5g}", a_, b_);
    const double mean = kind_ == Kind::lognormal ? std::exp(a_ + 0.5 * b_ * b_) : a_;
    const double sd = kind_ == Kind::lognormal ? mean * std::sqrt(std::expm1(b_ * b_)) : b_;
    if (kind_ == Kind::normal || kind_ == Kind::lognormal)
        text += fmt::format(", mean {:.5g}, sd {:.5g}", mean, sd);
    if (std::isfinite(low_)) text += fmt::format(", not below {:.5g}", low_);
    if (std::isfinite(high_)) text += fmt::format(", not above {:.5g}", high_);
    return text;
}

}  // namespace twinchute::study
