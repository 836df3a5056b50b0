// A centred moving average of a signal that arrives at uneven steps.
#pragma once

#include <utility>
#include <vector>

#include "lib/record/archive.hpp"

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
    /// Mean of all samples, before there is a window; 0 without any.
    double so_far() const {
        if (end_ == 0) return 0.0;
        const Sample& last = at(end_ - 1);
        return last.t > start_ ? last.integral / (last.t - start_) : last_value_;
    }
    /// Integral of the signal from its first sample to time t, the last sample held from there on.
    double integral_until(double t) const {
        if (end_ == 0) return 0.0;
        const Sample& last = at(end_ - 1);
        return last.integral + last_value_ * (t - last.t);
    }

    /// Means at the end of the signal, whose windows would reach beyond its last sample and are cut off
    /// there, as visit(centre, mean): one for each sample that such a window may begin with. At least one
    /// once two samples have come.
    template <class Visit>
    void cut_off(Visit&& visit) const {
        if (end_ == 0 || !(at(end_ - 1).t > start_)) return;
        const Sample& last = at(end_ - 1);
        if (!(last.t - start_ > half_))
            return visit(0.5 * (start_ + last.t), last.integral / (last.t - start_));
        for (std::size_t i = first_; i < end_ && at(i).t + half_ <= last.t; ++i)
            if (at(i).t + 2.0 * half_ >= last.t)
                visit(at(i).t + half_, (last.integral - at(i).integral) / (last.t - at(i).t));
    }

    void serialize(Archive& archive);

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

/// Largest moving average of a signal over an interval, which reaches from its first sample to its last. A
/// window that would reach beyond either end is cut off there, to half its length at the end itself, so that
/// the average never exceeds the largest sample: nothing from outside the interval counts. Over an interval
/// shorter than half a window it is the mean of all of it.
class IntervalPeak {
public:
    explicit IntervalPeak(double window) : window_(window), average_(window) {}

    struct Peak {
        double value = 0.0, time = 0.0;  ///< time [s]: centre of the window before it is cut
    };

    /// The next sample of the interval, as MovingAverage::push.
    void push(double t, double value) {
        average_.push(t, value);
        if (average_.ready()) consider(average_.centre(), average_.value());
    }
    /// The interval ends at its last sample: its peak. Another one begins with the next.
    Peak end() {
        average_.cut_off([this](double t, double value) { consider(t, value); });
        average_ = MovingAverage(window_);
        return std::exchange(peak_, {});
    }
    /// So far, of windows that have passed.
    const Peak& peak() const { return peak_; }

    void serialize(Archive& archive) {
        average_.serialize(archive);
        archive.number("peak", peak_.value);
        archive.number("peak", peak_.time);
    }

private:
    void consider(double t, double value) {
        if (value > peak_.value) peak_ = {value, t};
    }

    double window_;  // [s]
    MovingAverage average_;
    Peak peak_;
};

}  // namespace twinchute::fullsim
