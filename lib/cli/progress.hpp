// One line on standard error that says how far a run has come; gone when the run has ended.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// E.g. "full inflation   1.23 s  45 %  4 s left". `elapsed` [s] wall time so far.
std::string progress_text(std::string_view fidelity, const Progress& progress, double elapsed);

/// Whether standard error is a terminal that can rewrite a line.
bool progress_is_seen();

class ProgressLine {
public:
    /// Silent unless `shown`.
    ProgressLine(std::string_view fidelity, bool shown);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// What a Run calls; empty when nothing is shown. It must not outlive this object.
    std::function<void(const Progress&)> reporter();

private:
    using Clock = std::chrono::steady_clock;
    void update(const Progress& progress);

    std::string fidelity_;
    bool shown_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point next_ = start_;
};

}  // namespace twinchute
