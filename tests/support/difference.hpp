// Derivatives by difference quotients, for tests that check a rate against its value.
#pragma once

namespace twinchute::test {

/// Central difference: exact to second order in h.
template <class Function>
double central_difference(Function&& f, double x, double h) {
    return (f(x + h) - f(x - h)) / (2.0 * h);
}

}  // namespace twinchute::test
