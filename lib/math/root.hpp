// Where a function of one variable is zero.
#pragma once

#include <functional>

namespace twinchute {

/// A zero of f between a and b, where f has opposite signs, by GSL's Brent-Dekker method: to `relative` of
/// the larger of its two ends. Where f jumps across zero it is the place of the jump. Not a number where the
/// signs are equal or a value is no number.
double root_between(const std::function<double(double)>& f, double a, double b, double relative);

}  // namespace twinchute
