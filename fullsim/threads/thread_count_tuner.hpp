// How many threads take the next step. Threads that wait for each other several times a step lose as soon as
// other programs want the same processors: a thread that is not running keeps all others waiting, for a
// thousand times as long as its work takes. The bits do not depend on their number, so that it may change at
// any step.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace twinchute::fullsim {

class ThreadCountTuner {
public:
    explicit ThreadCountTuner(int most) : most_(most), threads_(1), left_(trial) {}

    int most() const { return most_; }
    int now() const { return threads_; }

    /// A step begins, and the one before it has ended.
    void begin_step() {
        if (most_ == 1) return;
        const auto now = std::chrono::steady_clock::now();
        if (began_) took(std::chrono::duration<double>(now - *began_).count());
        began_ = now;
    }

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
                if (slow_ == patience)
                    rest();
                else if (left_ == 0)
                    least_ < one_ ? work_together() : rest();
                break;
            case State::chosen:
                if (threads_ > 1 && loses(seconds)) return rest();
                if (left_ == 0) begin_one();
                break;
        }
    }

private:
    static constexpr int trial = 8, first_interval = 500, longest_interval = 8000;
    static constexpr int patience = 2, interruptions = 3;   // steps in a row, steps since all began
    static constexpr double too_long = 4.0, waking = 2e-3;  // times a step of one's; [s]
    enum class State { one, all, chosen };

    void enter(State state, int threads, int steps) {
        state_ = state;
        threads_ = threads;
        left_ = steps;
        slow_ = interrupted_ = 0;
        least_ = std::numeric_limits<double>::infinity();
        gained_ = 0.0;
    }
    void begin_one() {
        if (threads_ > 1) rest_ = first_interval;  // they have worked for as long as they were to
        enter(State::one, 1, trial);
    }
    void begin_all() {
        one_ = least_;
        enter(State::all, most_, trial);
    }
    /// For longer than the last time, if nothing went wrong in between.
    void work_together() {
        enter(State::chosen, most_, work_);
        work_ = std::min(2 * work_, longest_interval);
    }
    /// With one, the longer the more often this did not pay.
    void rest() {
        enter(State::chosen, 1, rest_);
        rest_ = std::min(2 * rest_, longest_interval);
        work_ = first_interval;
    }
    /// Steps that are far too long, one after the other; or more time lost to others, who had the processor
    /// that one of the threads was to have, than has been gained so far.
    bool loses(double seconds) {
        slow_ = seconds > too_long * one_ ? slow_ + 1 : 0;
        interrupted_ += seconds > waking;
        if (slow_ == 0 || seconds > waking) gained_ += one_ - seconds;
        return slow_ == patience || (interrupted_ >= interruptions && gained_ < 0.0);
    }

    int most_, threads_;
    State state_ = State::one;
    int left_;                                           // steps until the next change
    int slow_ = 0, interrupted_ = 0;                     // steps that took far too long: in a row, in all
    int work_ = first_interval, rest_ = first_interval;  // steps for which all work, or one
    double least_ = std::numeric_limits<double>::infinity(), one_ = 0.0;  // [s] a step
    double gained_ = 0.0;                                                 // [s] since all work
    std::optional<std::chrono::steady_clock::time_point> began_;
};

}  // namespace twinchute::fullsim
