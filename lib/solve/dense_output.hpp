// The state inside one step of an integrator, from the state and its rate at both ends.
#pragma once

#include <span>

namespace twinchute {

/// State and rate at the ends of a step; all four of one size.
struct StepEnds {
    double begin = 0.0, end = 0.0;  ///< time [s]
    std::span<const double> state, rate, next_state, next_rate;
};

/// The state at a time of the step, by Hermite interpolation: the ends are met, with their rates.
///
/// `space` > 0: the state is one or more blocks of `space` positions that are followed by their velocities.
/// Positions then are quintic (they have two rates at each end) and velocities are their rates: errors of
/// h^6 and h^5, without an evaluation of the right-hand side. Otherwise cubic: h^4.
void interpolate_step(const StepEnds& step, int space, double time, std::span<double> state);

}  // namespace twinchute
