#include "study/campaign/sensitivity_indices.hpp"

#include <algorithm>
#include <cmath>

#include "study/campaign/design.hpp"
#include "study/campaign/random.hpp"

namespace twinchute::study {
namespace {

/// Shares of an input's distribution: a means' noise and the width of a share go against each other.
std::size_t bins_for(std::uint64_t runs) {
    return static_cast<std::size_t>(std::clamp(std::cbrt(static_cast<double>(runs)), 4.0, 64.0));
}

/// Values of their own, rare ones too; so many of them that shares do as well are binned.
bool has_bin_of_each(const CampaignInput& input) {
    constexpr std::size_t most = 64;
    const std::size_t values = input.distribution ? input.distribution->discrete_values().size() : 0;
    return values > 0 && values <= most;
}

/// Whether a metric varies by more than the tolerance of the runs that it is from: shares of less say
/// nothing. `shift`: by which its numbers are less than the metric's.
bool varies(const Moments& m, double shift) {
    constexpr double tolerance = 1e-7;
    return std::sqrt(m.variance()) > tolerance * std::abs(m.mean + shift);
}

/// An index is no less than zero, whatever its estimator came to.
Interval from_zero(Interval index) {
    index.high = std::max(index.high, 0.0);
    return index;
}

}  // namespace

IndexEstimator::IndexEstimator(const CampaignSpec& spec)
    : spec_(spec), inputs_(spec.inputs.size()), bins_(bins_for(spec.runs)) {
    for (const CampaignInput& input : spec.inputs)
        if (has_bin_of_each(input)) bins_ = std::max(bins_, input.distribution->discrete_values().size());
    if (spec.design == DesignKind::saltelli) {
        sums_.resize(groups, {{}, std::vector<double>(inputs_), std::vector<double>(inputs_), 0});
        point_.assign(saltelli_block(inputs_), std::nan(""));
    } else {
        cells_.resize(groups * inputs_ * bins_);
    }
}

std::size_t IndexEstimator::group_of(std::uint64_t index) const {
    return random_bits(spec_.seed, index, 0, RandomStream::groups) % groups;
}

void IndexEstimator::add(std::uint64_t run, std::span<const double> values, double metric) {
    if (spec_.design == DesignKind::saltelli) {
        const std::uint64_t block = saltelli_block(inputs_);
        if (run / block != base_) std::ranges::fill(point_, std::nan(""));
        base_ = run / block;
        point_[run % block] = metric;
        if (run % block == block - 1) add_point();
        return;
    }
    if (!std::isfinite(metric)) return;
    const std::size_t group = group_of(run);
    for (std::size_t i = 0; i < inputs_; ++i) {
        if (!spec_.inputs[i].is_ordered()) continue;
        cells_[(group * inputs_ + i) * bins_ + bin_of(spec_.inputs[i], values[i])].add(metric);
    }
}

std::size_t IndexEstimator::bin_of(const CampaignInput& input, double value) const {
    if (has_bin_of_each(input)) {
        const std::span<const double> all = input.distribution->discrete_values();
        return static_cast<std::size_t>(std::ranges::find(all, value) - all.begin()) % all.size();
    }
    const double share = input.distribution->below(value);
    return std::min(bins_ - 1, static_cast<std::size_t>(share * static_cast<double>(bins_)));
}

void IndexEstimator::add_point() {
    if (!std::ranges::all_of(point_, [](double y) { return std::isfinite(y); })) return;
    if (!has_shift_) shift_ = point_[0], has_shift_ = true;
    Sums& sums = sums_[group_of(base_)];
    const double a = point_[0] - shift_, b = point_[1] - shift_;
    sums.all.add(a), sums.all.add(b);
    for (std::size_t i = 0; i < inputs_; ++i) {
        const double mixed = point_[i + 2] - shift_;
        sums.first[i] += b * (mixed - a);
        sums.total[i] += 0.5 * (a - mixed) * (a - mixed);
    }
    ++sums.points;
    std::ranges::fill(point_, std::nan(""));
}

double IndexEstimator::of_sums(std::size_t input, bool total, std::optional<std::size_t> without) const {
    Moments all;
    double sum = 0.0;
    std::uint64_t points = 0;
    for (std::size_t g = 0; g < groups; ++g) {
        if (g == without) continue;
        all.add(sums_[g].all);
        sum += total ? sums_[g].total[input] : sums_[g].first[input];
        points += sums_[g].points;
    }
    return varies(all, shift_) ? sum / static_cast<double>(points) / all.variance() : std::nan("");
}

Index IndexEstimator::by_points(std::size_t input) const {
    Index index;
    const auto with_interval = [&](bool total) {
        std::vector<double> without;
        for (std::size_t g = 0; g < groups; ++g)
            if (sums_[g].points > 0) without.push_back(of_sums(input, total, g));
        return from_zero(jackknife_interval(of_sums(input, total, {}), without));
    };
    index.first = with_interval(false);
    index.total = with_interval(true);
    return index;
}

double IndexEstimator::binned(std::size_t input, std::optional<std::size_t> without) const {
    Moments all;
    std::vector<Moments> bins(bins_);
    for (std::size_t g = 0; g < groups; ++g)
        if (g != without)
            for (std::size_t b = 0; b < bins_; ++b)
                bins[b].add(cells_[(g * inputs_ + input) * bins_ + b]);
    double within = 0.0, filled = 0.0;
    for (const Moments& bin : bins) {
        all.add(bin);
        within += bin.squares;
        filled += bin.count > 0 ? 1.0 : 0.0;
    }
    const double n = static_cast<double>(all.count);
    if (!(n > filled) || !varies(all, 0.0)) return std::nan("");
    // Means of scatter alone vary, too: by its variance for each mean but one.
    const double scatter = within / (n - filled);
    return (all.squares - within - (filled - 1.0) * scatter) / all.squares;
}

std::vector<Index> IndexEstimator::indices() const {
    std::vector<Index> all(inputs_);
    for (std::size_t i = 0; i < inputs_; ++i) {
        if (!sums_.empty()) {
            all[i] = by_points(i);
            continue;
        }
        if (!spec_.inputs[i].is_ordered()) continue;
        std::vector<double> without;
        for (std::size_t g = 0; g < groups; ++g)
            without.push_back(binned(i, g));
        all[i].first = from_zero(jackknife_interval(binned(i, {}), without));
    }
    return all;
}

}  // namespace twinchute::study
