// One line on standard error that says how far a run has come; gone when the run has ended.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// E.g. "full inflation   1.23 s  45 %  4 s left". `elapsed` [s] wall time so far, in which the run came from
/// `before`, its share when it began: 0, or where it went on from.
std::string progress_text(std::string_view fidelity, const Progress& progress, double elapsed,
                          double before = 0.0);

/// Whether standard error is a terminal that can rewrite a line.
bool progress_is_seen();

class ProgressLine {
public:
    /// Silent unless `shown`.
    ProgressLine(std::string_view fidelity, bool shown);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// Callback for Run::progress; empty when nothing is shown. It must not outlive this object.
    std::function<void(const Progress&)> reporter();

private:
    using Clock = std::chrono::steady_clock;
    void update(const Progress& progress);

    std::string fidelity_;
    bool shown_;
    bool drawn_ = false;
    double before_ = 0.0;  // share done by the run that this one goes on from
    Clock::time_point start_ = Clock::now();
    Clock::time_point next_ = start_;
};

}  // namespace twinchute
