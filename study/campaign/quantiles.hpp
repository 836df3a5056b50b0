// Order statistics of numbers that come by more often than they could be kept: counted in narrow bins first,
// then collected in those bins alone where the wanted ones lie.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace twinchute::study {

/// Parts of a histogram for reading.
inline constexpr std::size_t histogram_parts = 64;

class RankFinder {
public:
    /// Numbers from `low` to `high`, so many in all.
    RankFinder(double low, double high, std::uint64_t total)
        : low_(low), width_((high - low) / static_cast<double>(bins)), total_(total), counts_(bins) {}

    std::uint64_t total() const { return total_; }
    /// First pass.
    void count(double value) { ++counts_[bin_of(value)]; }
    /// Between the passes: the number from 0 in rising order that will be asked for.
    void want(std::uint64_t rank) { collected_.try_emplace(bin_at(rank)); }
    /// Second pass.
    void collect(double value) {
        if (const auto found = collected_.find(bin_of(value)); found != collected_.end())
            found->second.push_back(value);
    }
    /// After it: one that was wanted.
    double at(std::uint64_t rank) {
        const std::size_t bin = bin_at(rank);
        for (std::size_t b = 0; b < bin; ++b)
            rank -= counts_[b];
        std::vector<double>& values = collected_.at(bin);
        const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(values.begin(), nth, values.end());
        return *nth;
    }
    /// Counts of `parts` equal parts, a divisor of the number of bins.
    std::vector<std::uint64_t> coarse(std::size_t parts) const {
        std::vector<std::uint64_t> sums(parts);
        for (std::size_t b = 0; b < bins; ++b)
            sums[b / (bins / parts)] += counts_[b];
        return sums;
    }

private:
    static constexpr std::size_t bins = 1u << 16;

    std::size_t bin_of(double value) const {
        if (!(width_ > 0.0)) return 0;
        return std::min(bins - 1, static_cast<std::size_t>(std::max(0.0, (value - low_) / width_)));
    }
    std::size_t bin_at(std::uint64_t rank) const {
        std::size_t bin = 0;
        while (bin + 1 < bins && rank >= counts_[bin])
            rank -= counts_[bin++];
        return bin;
    }

    double low_, width_;
    std::uint64_t total_;
    std::vector<std::uint64_t> counts_;
    std::map<std::size_t, std::vector<double>> collected_;
};

}  // namespace twinchute::study
