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

class Course {
public:
    Course(const Scene& scene, Run& run, RunRecord& to)
        : record(to),
          stop_time(scene.stop.kind == Trigger::Kind::time ? scene.stop.value + scene.stop.delay
                                                           : unlimited()),
          scene_(scene),
          run_(run) {}

    RunRecord& record;
    Observer observer;
    const double stop_time;  ///< [s] since release; no run goes on beyond it

    /// Steps of `solver` to `end`; says why it stopped before, if it did.
    Leg integrate_to(OdeSolver& solver, double end);

    /// At the last row.
    void add_event(const char* name);
    /// What a solver that is done with has cost.
    void count(const OdeSolver& solver);

    /// How a run ends with this leg, other than by a root.
    RunStatus ending(Leg leg, const OdeSolver& solver) const;
    /// The payload has landed; `before` says what had not happened by then, if anything.
    RunStatus landed(const std::string& before) const;

private:
    static double unlimited();

    const Scene& scene_;
    Run& run_;
    int steps_ = 0;
};

}  // namespace twinchute::rom
