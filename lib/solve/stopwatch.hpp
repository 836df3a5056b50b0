// Wall and processor time of a piece of work.
#pragma once

#include <chrono>
#include <ctime>

namespace twinchute {

class Stopwatch {
public:
    double wall() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    }
    double cpu() const { return process_seconds() - cpu_; }

private:
    static double process_seconds() {
        timespec now{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
    double cpu_ = process_seconds();
};

}  // namespace twinchute
