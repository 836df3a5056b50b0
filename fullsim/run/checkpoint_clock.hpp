// Wall and processor time of a run with those that it goes on from, and when its checkpoints are due.
#pragma once

#include "lib/record/archive.hpp"
#include "lib/solve/fidelity.hpp"
#include "lib/solve/stopwatch.hpp"

namespace twinchute::fullsim {

class CheckpointClock {
public:
    /// interval: [s] of wall time from one checkpoint to the next; 0: none are made. `run` outlives this.
    CheckpointClock(const Run& run, double interval) : run_(run), interval_(interval), next_(interval) {}

    bool saves() const { return run_.checkpoints.save && interval_ > 0.0; }
    /// The clock decides when, and nothing of what follows. A run that is asked to stop saves first.
    bool is_due() const { return saves() && (run_.stop.stop_requested() || watch_.wall() >= next_); }
    void save(std::string state) {
        const bool stops = run_.stop.stop_requested();
        run_.checkpoints.save(std::move(state));
        saved_for_stop_ = stops;
        next_ = watch_.wall() + interval_;
    }
    /// Asked to, and with a checkpoint of where it stops where there are any.
    bool may_stop() const { return run_.stop.stop_requested() && (saved_for_stop_ || !saves()); }

    double wall() const { return wall_before_ + watch_.wall(); }  ///< [s]
    double cpu() const { return cpu_before_ + watch_.cpu(); }     ///< [s]

    void serialize(Archive& archive) {
        double wall_so_far = wall(), cpu_so_far = cpu();
        archive.number("wall time", wall_so_far);
        archive.number("processor time", cpu_so_far);
        if (archive.reads()) wall_before_ = wall_so_far, cpu_before_ = cpu_so_far;
    }

private:
    const Run& run_;
    Stopwatch watch_;
    double interval_, next_;                       // [s] of wall time
    double wall_before_ = 0.0, cpu_before_ = 0.0;  // [s] of the runs that this one goes on from
    bool saved_for_stop_ = false;
};

}  // namespace twinchute::fullsim
