// How many threads take the next step. Threads that wait for each other several times a step lose as soon as
// other programs want the same processors: a thread that is not running keeps all others waiting, for a
// thousand times as long as its work takes. The bits do not depend on their number, so that it may change at
// any step.
#pragma once

#include <algorithm>
#include <limits>

namespace twinchute::fullsim {

class Crew {
public:
    explicit Crew(int most) : most_(most), threads_(1), left_(trial) {}

    int most() const { return most_; }
    int now() const { return threads_; }

    /// The step with so many took this long [s].
    void took(double seconds) {
        if (most_ == 1) return;
        least_ = std::min(least_, seconds);
        --left_;
        switch (state_) {
            case State::one:
                if (left_ == 0) begin_all();
                break;
            case State::all:
                // The least of some steps is what they take when nothing else is in the way. One that is far
                // too long may be that others had to wake.
                if (seconds > too_long * one_) slow_ = seconds > waking ? patience : slow_ + 1;
                if (slow_ < patience && left_ > 0) break;
                choose(slow_ < patience && least_ < one_ ? most_ : 1);
                break;
            case State::chosen:
                if (threads_ > 1) slow_ = seconds > too_long * one_ ? slow_ + 1 : 0;
                if (slow_ == patience) choose(1);
                if (left_ == 0) begin_one();
                break;
        }
    }

private:
    static constexpr int trial = 8, first_interval = 500, longest_interval = 8000, patience = 2;
    static constexpr double too_long = 4.0, waking = 2e-3;  // times a step of one's; [s]
    enum class State { one, all, chosen };

    void enter(State state, int threads, int steps) {
        state_ = state;
        threads_ = threads;
        left_ = steps;
        slow_ = 0;
        least_ = std::numeric_limits<double>::infinity();
    }
    void begin_one() { enter(State::one, 1, trial); }
    void begin_all() {
        one_ = least_;
        enter(State::all, most_, trial);
    }
    /// For longer than the last time, if it is the same again.
    void choose(int threads) {
        interval_ = threads == last_choice_ ? std::min(2 * interval_, longest_interval) : first_interval;
        last_choice_ = threads;
        enter(State::chosen, threads, interval_);
    }

    int most_, threads_;
    State state_ = State::one;
    int left_;      // steps until the next change
    int slow_ = 0;  // steps that took far too long
    int interval_ = first_interval, last_choice_ = 0;
    double least_ = std::numeric_limits<double>::infinity(), one_ = 0.0;  // [s] a step
};

}  // namespace twinchute::fullsim
