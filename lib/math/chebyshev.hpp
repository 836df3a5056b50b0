// A smooth function on an interval as a series of Chebyshev polynomials: to round-off with few terms where it
// is analytic, and smooth in all derivatives, as implicit integrators want it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "lib/math/vec.hpp"

namespace twinchute {

template <std::size_t terms>
class Chebyshev {
public:
    struct ValueAndSlope {
        double value, slope;
    };

    /// Zero everywhere.
    Chebyshev() = default;
    /// Through `values` at the nodes, node(k, low, high), of the interval from `low` to `high`.
    Chebyshev(const std::array<double, terms>& values, double low, double high)
        : middle_(0.5 * (low + high)), scale_(2.0 / (high - low)) {
        constexpr double n = static_cast<double>(terms);
        for (std::size_t j = 0; j < terms; ++j) {
            double sum = 0.0;
            for (std::size_t k = 0; k < terms; ++k)
                sum += values[k] * std::cos(pi * static_cast<double>(j) * (static_cast<double>(k) + 0.5) / n);
            coefficients_[j] = (j == 0 ? 1.0 : 2.0) / n * sum;
        }
        // Terms of an analytic function behind the last one that counts are rounding.
        double largest = 0.0;
        for (const double c : coefficients_)
            largest = std::max(largest, std::abs(c));
        while (used_ > 1 && std::abs(coefficients_[used_ - 1]) < 1e-15 * largest)
            --used_;
    }

    /// Zero number k of the Chebyshev polynomial of degree `terms`, from high to low.
    static double node(std::size_t k, double low, double high) {
        const double angle = pi * (static_cast<double>(k) + 0.5) / static_cast<double>(terms);
        return 0.5 * (low + high) + 0.5 * (high - low) * std::cos(angle);
    }

    /// By Clenshaw's recurrence and its derivative. Outside the interval the polynomial goes on.
    ValueAndSlope at(double x) const {
        const double u = scale_ * (x - middle_);
        double b = 0.0, b_before = 0.0, d = 0.0, d_before = 0.0;
        for (std::size_t j = used_ - 1; j > 0; --j) {
            const double d_next = 2.0 * (u * d + b) - d_before;
            const double b_next = 2.0 * u * b - b_before + coefficients_[j];
            d_before = d, d = d_next;
            b_before = b, b = b_next;
        }
        return {u * b - b_before + coefficients_[0], scale_ * (u * d + b - d_before)};
    }

    bool operator==(const Chebyshev&) const = default;

private:
    std::array<double, terms> coefficients_{};
    std::size_t used_ = terms;
    double middle_ = 0.0, scale_ = 1.0;
};

}  // namespace twinchute
