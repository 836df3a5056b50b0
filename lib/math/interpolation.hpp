// Linear interpolation in a table of one or several columns.
#pragma once

#include <gsl/gsl_interp.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
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

}  // namespace twinchute
