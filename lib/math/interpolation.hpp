// Linear interpolation in a table of one or several columns, and steps that leap over none of its intervals.
#pragma once

#include <gsl/gsl_interp.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace twinchute {

/// Where a value lies among at least two rising abscissae. Found once, used for every column.
class Between {
public:
    /// Outside the first or last interval goes on.
    Between(const std::vector<double>& abscissae, double x) {
        assert(abscissae.size() >= 2);
        index_ = gsl_interp_bsearch(abscissae.data(), x, 0, abscissae.size() - 1);
        share_ = (x - abscissae[index_]) / (abscissae[index_ + 1] - abscissae[index_]);
    }

    double linear(const std::vector<double>& column) const { return at(column, share_); }
    /// Linear up to the last abscissa, and the last value beyond it.
    double held_above(const std::vector<double>& column) const { return at(column, std::min(share_, 1.0)); }

private:
    double at(const std::vector<double>& column, double share) const {
        return column[index_] + share * (column[index_ + 1] - column[index_]);
    }

    std::size_t index_ = 0;
    double share_ = 0.0;
};

/// How far from x, to either side, a step may go that is no longer than any interval which it comes into: of
/// two abscissae next to each other, `at` those of rising levels. Infinite where there is one level, or none.
template <class Level, class At = std::identity>
double reach_among(std::span<const Level> levels, double x, At at = {}) {
    double reach = std::numeric_limits<double>::infinity();
    const auto comes_to = [&](double distance, std::size_t low) {
        const double width = std::invoke(at, levels[low + 1]) - std::invoke(at, levels[low]);
        reach = std::min(reach, std::max(distance, width));
    };
    const auto above = std::ranges::upper_bound(levels, x, {}, at),
               below = std::ranges::lower_bound(levels, x, {}, at);
    const auto begin = static_cast<std::size_t>(above - levels.begin());
    for (std::size_t low = begin == 0 ? 0 : begin - 1; low + 1 < levels.size(); ++low) {
        const double distance = std::max(0.0, std::invoke(at, levels[low]) - x);
        if (distance >= reach) break;
        comes_to(distance, low);
    }
    for (auto high = std::min(static_cast<std::size_t>(below - levels.begin()), levels.size() - 1); high > 0;
         --high) {
        const double distance = std::max(0.0, x - std::invoke(at, levels[high]));
        if (distance >= reach) break;
        comes_to(distance, high - 1);
    }
    return reach;
}

}  // namespace twinchute
