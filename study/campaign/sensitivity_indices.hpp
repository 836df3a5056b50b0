// Which input matters: shares of the variance of a metric, from the runs of a campaign as they come.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "study/campaign/spec.hpp"
#include "study/campaign/statistics.hpp"

namespace twinchute::study {

/// Shares of the variance [-] of one metric that go with one input.
struct Index {
    /// Var(E[Y|X_i])/Var(Y); of an input whose values have no order, gusts, by Saltelli's design alone.
    std::optional<Interval> first = {};
    std::optional<Interval> total = {};  ///< 1 - Var(E[Y|all but X_i])/Var(Y): Saltelli's design alone
};

/// Indices of one metric from runs in the order of their numbers.
///
/// Saltelli's design: first order by Saltelli et al., Comp. Phys. Comm. 181 (2010), Table 2 (b); total by
/// Jansen, ibid. (f). Any other: first order from equal shares of the input's distribution (of a
/// discrete one, from its values), as the variance
/// of their means less what their own scatter makes of it. Intervals leave out one of twenty groups of runs
/// in turn.
class IndexEstimator {
public:
    explicit IndexEstimator(const CampaignSpec& spec);

    /// `values`: of the inputs; a metric that is not a number spoils its run, of Saltelli's design its point.
    void add(std::uint64_t run, std::span<const double> values, double metric);
    std::vector<Index> indices() const;

private:
    static constexpr std::size_t groups = 20;

    /// Sums of Saltelli's estimators over base points.
    struct Sums {
        Moments all;                       // of A and B
        std::vector<double> first, total;  // of each input
        std::uint64_t points = 0;
    };

    /// Drawn at random: every n-th point of a sequence is no fair share of it.
    std::size_t group_of(std::uint64_t index) const;
    void add_point();
    std::size_t bin_of(const CampaignInput& input, double value) const;
    double binned(std::size_t input, std::optional<std::size_t> without) const;
    Index by_points(std::size_t input) const;
    double of_sums(std::size_t input, bool total, std::optional<std::size_t> without) const;

    const CampaignSpec& spec_;
    std::size_t inputs_, bins_;
    std::vector<Moments> cells_;  // group, input, bin
    std::vector<Sums> sums_;      // group
    std::vector<double> point_;   // metrics of the base point that is coming
    std::uint64_t base_ = 0;
    double shift_ = 0.0;  // a typical value: products of large numbers would cancel
    bool has_shift_ = false;
};

}  // namespace twinchute::study
