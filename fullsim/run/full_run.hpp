// One run of the full model: its loop of steps, events and checks, from the release to its record.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fullsim/run/checkpoint_clock.hpp"
#include "fullsim/run/recorder.hpp"
#include "lib/solve/fidelity.hpp"
#include "lib/solve/steady_descent.hpp"

namespace twinchute::fullsim {

/// Runs of the same scene before this one, of longer steps: their energy did not add up.
struct Attempts {
    static constexpr int most = 2;

    int count = 0;
    double wall = 0.0, cpu = 0.0;  ///< [s]
    std::string ending = {};       ///< of the last one

    void add(const RunStatus& status, const CheckpointClock& clock) {
        ++count;
        wall += clock.wall();
        cpu += clock.cpu();
        ending = status.detail;
    }
    void serialize(Archive& archive) {
        archive.whole("attempts", count, 0, most);
        archive.number("attempts", wall);
        archive.number("attempts", cpu);
        archive.text("attempts", ending);
    }
};

class FullRun {
public:
    /// Parachutes weigh what their meshes do; `stated_masses`: what the scene says of each [kg].
    FullRun(const Scene& scene, std::span<const double> stated_masses, Run& run, const Attempts& before);

    void fly();
    const RunStatus& status() const { return record_.status; }
    const CheckpointClock& clock() const { return clock_; }

    /// Once, after fly().
    RunRecord finish();

private:
    const RunView& view() const { return recorder_.view(); }
    Findings& found() { return recorder_.found(); }
    Observer& observer() { return recorder_.observer(); }

    void begin();
    void settle(std::size_t first);

    void end(StatusCode code, std::string detail) {
        record_.status = {code, std::move(detail)};
        ended_ = true;
    }

    /// Next time [s] that no step may cross.
    double next_stop() const;

    /// Ends the run and drops all that came after the last check that found nothing wrong.
    void fail(const RunStatus& fault);

    void check();

    void check_end();

    void report_progress() { run_.progress({stage_name(), cluster_.time(), expected_share(), resumed_at()}); }
    std::optional<double> resumed_at() const {
        if (record_.cost.resumed_at.empty()) return {};
        return record_.cost.resumed_at.back();
    }

    void save_if_due();

    void go_on_from(const std::string& saved);

    /// Saves or restores the run, without the parts that the constructor makes anew.
    void serialize(Archive& archive);

    std::string_view stage_name() const;
    bool any_deploys() const {
        return std::ranges::any_of(cluster_.out(), [&](std::size_t k) { return recorder_[k].deploys(); });
    }
    /// Something is out, and all of it is open.
    bool all_open() const;
    /// [s] from which on no drag area changes, and none will.
    double drag_area_steady() const;

    /// Share of the height, where the run ends at one; else a descent is usually steady four filling times
    /// after snatch. For the progress line only.
    double expected_share() const;

    void look_for_events();

    /// Parachutes leave their packs, are disreefed and cut as the sequence of them says.
    void follow_sequence(bool falls_steadily);
    /// The first of its canopies.
    std::optional<std::size_t> canopy_of(std::size_t parachute) const;
    void leave_pack(std::size_t parachute);
    void opens(std::size_t k);
    /// The parachute that canopy k is one of is disreefed.
    void disreef(std::size_t k);
    void cut(std::size_t first);

    /// Follows an event of canopy k.
    void happened(std::size_t k, const char* name);

    void look_for_descent();
    /// Whether the force has stayed well below its peak for as long as payload and canopy take to bounce
    /// once.
    bool is_past_peak();
    /// Notes where the payload falls into its own canopy. Contact between gores, whose axis leads from one to
    /// the other, means nothing from there on: such a run ends.
    void look_for_recontact();

    void note_squid();

    void note_attempts();

    /// A sample of the fall, while the drag area is steady.
    void look_at_fall();
    /// Judged now and then.
    bool falls_steadily();
    std::optional<DescentWindow> judge_fall();
    /// A sample of the fall, of several canopies their mean, which swings as one.
    FallSample fall_now() const;

    /// Notes an event at which the scene may stop.
    void met(Trigger::Kind what) {
        if (scene_.stop.kind == what)
            event_stop_ = std::min(event_stop_, cluster_.time() + scene_.stop.delay);
    }

    void look_for_ground();

    void look_for_stop();

    void fill_cost();

    Attempts before_;
    const Scene& scene_;
    Run& run_;
    RunRecord record_;
    Cluster cluster_;
    std::unique_ptr<Stages> stages_;  // of a scene that has some
    Recorder recorder_;
    SteadyDescent fall_;
    double stop_time_;
    double event_stop_ = longest_flight;
    double below_peak_since_ = infinity;  // [s]
    bool ended_ = false;
    bool begun_ = false;      // with stages: the release is past
    bool evaluated_ = false;  // as parachutes came out
    const bool accretes_ = scene_.aerodynamics.added_mass &&
                           scene_.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting;
    CheckpointClock clock_;
};

}  // namespace twinchute::fullsim
