// The largest value of a smooth function of one variable on an interval.
#pragma once

#include <array>
#include <functional>
#include <span>

namespace twinchute {

struct Maximum {
    double at = 0.0;
    double value = 0.0;
};

/// Largest value of f on [a, b], ends included: the best of `samples` + 1 equidistant points,
/// refined by GSL's Brent minimiser where that point is inside the interval.
/// `closeness` [-] is that of the place; closer than the root of epsilon values no longer tell it.
/// Finds the right hump when humps are wider than (b - a)/samples.
Maximum maximum_on(const std::function<double(double)>& f, double a, double b, int samples,
                   double closeness = 1e-8);
/// Largest value of f on [a, b] where its values at two or more equidistant points, a and b included, are
/// known.
Maximum maximum_on(const std::function<double(double)>& f, double a, double b, std::span<const double> values,
                   double closeness = 1e-8);

/// Largest value on [a, b] of the quartic through values at five equidistant points, a and b included.
Maximum maximum_of_quartic(const std::array<double, 5>& values, double a, double b);

}  // namespace twinchute
