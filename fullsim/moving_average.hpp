// A centred moving average of a signal that arrives at uneven steps.
#pragma once

#include <vector>

#include "lib/record/keeper.hpp"

namespace twinchute::fullsim {

/// Average over [t - window/2, t + window/2], known half a window late. At the start the window
/// is cut off. Holds as many samples as a window does, in a ring that grows only when steps shrink.
class MovingAverage {
public:
    explicit MovingAverage(double window);  ///< [s] > 0

    /// The signal at time t, later than the last; trapezoidal in between.
    void push(double t, double value);

    /// True once half a window has passed.
    bool ready() const { return ready_; }
    double centre() const { return centre_; }  ///< [s] the time that value() belongs to
    double value() const { return value_; }

    void keep(Keeper& k);

private:
    struct Sample {
        double t, integral;
    };
    const Sample& at(std::size_t i) const { return ring_[i & (ring_.size() - 1)]; }

    double half_;
    std::vector<Sample> ring_;
    std::size_t first_ = 0, end_ = 0;  // samples held are [first_, end_), counted without end
    double start_ = 0.0, last_value_ = 0.0;
    double centre_ = 0.0, value_ = 0.0;
    bool ready_ = false;
};

}  // namespace twinchute::fullsim
