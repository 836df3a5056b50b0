// What all stages of a run share: the record that they write, the observer, the number of steps, and the
// words in which a run ends.
#pragma once

#include <string>

#include "lib/solve/fidelity.hpp"
#include "lib/solve/sundials.hpp"
#include "rom/observer.hpp"

namespace twinchute::rom {

/// Below this many metres, or metres per second, the relative tolerance stops to be relative.
inline constexpr double smallest_scale = 1.0;

/// Why the integration of a stage stopped.
enum class Leg { reached_end, root, failed, not_finite, interrupted, too_many_steps };

/// Whether single canopies pull less than all of them together may.
inline bool has_several_canopies(const Scene& scene) {
    return scene.parachutes.size() > 1 || scene.parachutes.front().count > 1;
}

class Course {
public:
    Course(const Scene& scene, Run& run, RunRecord& to)
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
    /// The number of the root that every leg watches: the payload's altitude less floor().
    static constexpr int floor_root = 0;
    /// [m] the ground, or before that the altitude that the scene stops at.
    double floor() const;
    /// What the scene may stop at has happened at `time` [s].
    void met(Trigger::Kind what, double time);
    /// The run is to end at `time` [s] at the latest, and is then complete.
    void end_at(double time);

    /// Steps of `solver` to `end`; says why it stopped before, if it did.
    Leg integrate_to(OdeSolver& solver, double end);

    /// At the last row. Of one of several parachutes it carries the name.
    void add_event(const char* name);
    void add_event(std::size_t parachute, const char* name);
    /// What a solver that is done with has cost.
    void count(const OdeSolver& solver);

    /// How a run ends with this leg, other than by a root.
    RunStatus ending(Leg leg, const OdeSolver& solver) const;
    /// The payload has landed; `before` says what had not happened by then, if anything.
    RunStatus landed(const std::string& before) const;

private:
    static double unlimited();
    bool stops_above_ground() const;

    const Scene& scene_;
    Run& run_;
    bool stop_is_set_;  // the stop condition has a time, so that reaching it completes the run
    bool below_stop_altitude_ = false;
    int steps_ = 0;
};

}  // namespace twinchute::rom
