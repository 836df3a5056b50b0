// Context that all stages of a run share: the record that they write, the observer, the number of steps, and
// the status in which a run ends.
#pragma once

#include <string>

#include "lib/solve/fidelity.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "lib/solve/sundials.hpp"
#include "rom/observer.hpp"

namespace twinchute::rom {

/// Below this many metres, or metres per second, the relative tolerance stops to be relative.
inline constexpr double smallest_scale = 1.0;

/// How an integration segment ended.
enum class IntegrationSegment { reached_end, root, failed, not_finite, interrupted, too_many_steps };

class RunContext {
public:
    RunContext(const Scene& scene, Run& run, RunRecord& to)
        : record(to),
          stop_time(scene.stop.kind == Trigger::Kind::time ? scene.stop.value + scene.stop.delay
                                                           : unlimited()),
          scene_(scene),
          run_(run),
          stop_is_set_(scene.stop.kind == Trigger::Kind::time) {
        if (has_several_canopies(scene)) observer.watch_canopies();
    }

    RunRecord& record;
    Observer observer;
    double stop_time;  ///< [s] since release; no run goes on beyond it
    /// The number of the root that every segment watches: the payload's altitude less floor().
    static constexpr int floor_root = 0;
    /// [m] the ground, or before that the altitude that the scene stops at.
    double floor() const;
    /// Notes that a stop condition of this kind is met at `time` [s].
    void met(Trigger::Kind what, double time);
    /// The run is to end at `time` [s] at the latest, and is then complete.
    void end_at(double time);

    /// Advances `solver` to `end`; returns why it stopped, at `end` or before.
    IntegrationSegment integrate_to(OdeSolver& solver, double end);

    /// Adds an event at the last row, with the name of the parachute where there are several.
    void add_event(const char* name);
    void add_event(std::size_t parachute, const char* name);
    /// Adds the cost of a solver that is no longer used.
    void count(const OdeSolver& solver);

    /// Status of a run that ends with this segment, other than by a root.
    RunStatus ending(IntegrationSegment segment, const OdeSolver& solver) const;
    /// The payload has landed; `before` says what had not happened by then, if anything.
    RunStatus landed(const std::string& before) const;

private:
    static double unlimited();
    /// [s] of a step that leaps over no layer of wind or air.
    double longest_step() const;
    bool stops_above_ground() const;

    const Scene& scene_;
    Run& run_;
    bool stop_is_set_;  // the stop condition has a time, so that reaching it completes the run
    bool below_stop_altitude_ = false;
    int steps_ = 0;
};

}  // namespace twinchute::rom
