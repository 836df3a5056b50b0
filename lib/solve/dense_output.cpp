#include "lib/solve/dense_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace twinchute {
namespace {

/// Cubic with values v and slopes a (by the step's share s) at both ends, and its integral from 0.
struct Cubic {
    double v0, a0, v1, a1;

    double at(double s) const {
        const double r = 1.0 - s;
        return r * r * ((1.0 + 2.0 * s) * v0 + s * a0) + s * s * ((1.0 + 2.0 * r) * v1 - r * a1);
    }
    double integral(double s) const {
        const double ss = s * s;
        return s * v0 + ss * (0.5 * a0 + s * ((v1 - v0) - (2.0 * a0 + a1) / 3.0 +
                                              s * (0.5 * (v0 - v1) + 0.25 * (a0 + a1))));
    }
};

/// A cubic through velocities and accelerations, and on it the bump s^2 (1 - s)^2 of the size that leads from
/// the first position to the second: the quintic of both, without its cancellation.
void quintic(const StepEnds& step, std::size_t position, std::size_t velocity, double s,
             std::span<double> state) {
    const double h = step.end - step.begin;
    const Cubic cubic{step.state[velocity], h * step.rate[velocity], step.next_state[velocity],
                      h * step.next_rate[velocity]};
    const double x = step.state[position], way = step.next_state[position] - x;
    const double bump = 30.0 * (way / h - cubic.integral(1.0));
    // In a very short step the way is lost in the rounding of the positions, and the bump with it.
    constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();
    const double noise = 30.0 * rounding * std::max(std::abs(x), std::abs(step.next_state[position])) / h;
    const double r = 1.0 - s, ss = s * s;
    state[velocity] = cubic.at(s) + (std::abs(bump) > noise ? bump * ss * r * r : 0.0);
    state[position] = x + h * (cubic.integral(s) + bump * ss * s * (1.0 / 3.0 + s * (0.2 * s - 0.5)));
}

}  // namespace

void interpolate_step(const StepEnds& step, int space, double time, std::span<double> state) {
    const double h = step.end - step.begin;
    if (!(time < step.end) || !(time > step.begin)) {
        std::ranges::copy(time < step.end ? step.state : step.next_state, state.begin());
        return;
    }
    const double s = (time - step.begin) / h;
    if (space == 0) {
        for (std::size_t i = 0; i < state.size(); ++i)
            state[i] =
                Cubic{step.state[i], h * step.rate[i], step.next_state[i], h * step.next_rate[i]}.at(s);
        return;
    }
    const auto width = static_cast<std::size_t>(space);
    for (std::size_t block = 0; block < state.size(); block += 2 * width)
        for (std::size_t i = block; i < block + width; ++i)
            quintic(step, i, i + width, s, state);
}

}  // namespace twinchute
