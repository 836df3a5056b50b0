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

#include "fullsim/run/canopy_run.hpp"
#include "fullsim/run/checkpoint_clock.hpp"
#include "fullsim/run/fields.hpp"
#include "fullsim/run/frames.hpp"
#include "fullsim/run/sling_loads.hpp"
#include "fullsim/run/stages.hpp"
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
    /// The canopies of a cluster as one: all of a run, or all of a parachute.
    struct Together {
        Observer observer;
        Findings found;
        RunView view;
        std::vector<std::size_t> canopies;

        /// So many canopies from `first` on. sequence: of the last of them, which is reefed if any is.
        Together(const Scene& scene, double stated_mass, const Cluster& cluster, std::size_t first,
                 const OpeningSequence* sequence)
            : observer(cluster[first].mesh(), scene.environment.gravity, scene.full.row_rate(), 1,
                       scene.parachutes.front().count),
              view{scene,
                   stated_mass,
                   cluster,
                   first,
                   static_cast<std::size_t>(scene.parachutes.front().count),
                   observer,
                   found,
                   sequence},
              canopies(view.count) {
            std::iota(canopies.begin(), canopies.end(), first);
            found.snatch = scene.release.time;
            observer.count_peak_from(scene.release.time);
            if (!view.packed()) return;
            found.snatch = infinity;
            observer.count_peak_from(infinity);
        }
        /// A scene with stages has nothing out at first. mesh: of its first parachute.
        Together(const Scene& scene, const Mesh& mesh, const Cluster& cluster)
            : observer(mesh, scene.environment.gravity, scene.full.row_rate()),
              view(RunView{scene, 0.0, cluster, 0, 0, observer, found, nullptr}) {
            observer.weigh_payload(cluster.payload().mass);
        }
        void disreefed(double time) {
            found.stages.push_back({time});
            observer.begin_stage(time);
        }
        Together(const Together&) = delete;
        Together& operator=(const Together&) = delete;
    };

    const SystemState& system() const { return cluster_.front().system(); }
    CanopyRun& only() { return *canopies_.front(); }
    const CanopyRun& only() const { return *canopies_.front(); }
    const RunView& view() const { return together_ ? together_->view : only().view(); }
    Findings& found() { return together_ ? together_->found : only().found(); }
    Observer& observer() { return together_ ? together_->observer : only().observer(); }
    std::vector<const Mesh*> meshes() const;
    std::vector<const State*> synchronised_states() const;
    /// Canopy k with all others of its parachute: null where it is the only one of it.
    Together* group_of(std::size_t k) const;
    /// The parachute that canopy k is, or is one of.
    const RunView& parachute_view(std::size_t k) const {
        const Together* group = group_of(k);
        return group ? group->view : canopies_[k]->view();
    }
    /// Numbers of all canopies of the parachute that canopy k is one of.
    std::vector<std::size_t> canopies_with(std::size_t k) const {
        const Together* group = group_of(k);
        return group ? group->canopies : std::vector{k};
    }
    template <class Work>
    void for_each_observer(Work&& work);

    void begin();
    void settle(std::size_t first);

    void observe();
    /// The forces of these canopies, as one, on the payload, where there are any.
    void observe_together(Observer& observer, std::span<const std::size_t> canopies, bool row);
    /// A row of these canopies as one; of none, of the payload alone.
    void add_row_together(Observer& observer, std::span<const std::size_t> canopies);
    /// Row of the payload without a canopy.
    HistoryRow row_alone() const;
    void add_rows();

    void end(StatusCode code, std::string detail) {
        record_.status = {code, std::move(detail)};
        ended_ = true;
    }

    void add_event(std::string name);
    /// Adds an event of a parachute, with its name where there are several.
    void add_event(std::size_t parachute, const char* name) {
        if (scene_.parachutes.size() == 1) return add_event(name);
        add_event(fmt::format("{}.{}", scene_.parachutes[parachute].name, name));
    }

    /// Next time [s] that no step may cross.
    double next_stop() const;

    /// Ends the run and drops all that came after the last check that found nothing wrong.
    void fail(const RunStatus& fault);

    void check();

    void check_end();

    /// Rows and shapes that have come since it was called last.
    void tell_watchers();

    void report_progress() { run_.progress({stage_name(), cluster_.time(), expected_share(), resumed_at()}); }
    std::optional<double> resumed_at() const {
        if (record_.cost.resumed_at.empty()) return {};
        return record_.cost.resumed_at.back();
    }

    void save_if_due();

    void go_on_from(const std::string& saved);

    /// Saves or restores the run, without the parts that the constructor makes anew.
    void serialize(Archive& archive);

    void begin_opening_frames();
    void begin_descent_frames();
    std::string_view stage_name() const;
    bool any_deploys() const {
        return std::ranges::any_of(cluster_.out(), [&](std::size_t k) { return canopies_[k]->deploys(); });
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
    void add_canopy(std::size_t k);
    void observe_parachute(std::size_t k);
    /// Tells the observer of all what the payload weighs now.
    void weigh_payload();
    void leave_pack(std::size_t parachute);
    void opens(std::size_t k);
    /// The parachute that canopy k is one of is disreefed.
    void disreef(std::size_t k);
    void cut(std::size_t first);

    /// An event of canopy k is one of its parachute, and of a run without stages, once all of the parachute
    /// have come to it; the end of the initial phase with the first of them.
    void happened(std::size_t k, const char* name);
    bool is_of_parachute(std::size_t k, std::string_view name);
    void snatched(std::size_t k);
    double shortest_initial_phase(std::size_t k) const;

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
    std::vector<double> stated_masses_;
    std::unique_ptr<Stages> stages_;  // of a scene that has some
    std::vector<std::unique_ptr<CanopyRun>> canopies_;
    std::unique_ptr<Together> together_;             // of several
    std::vector<std::unique_ptr<Together>> groups_;  // with stages: of each parachute of several canopies
    std::vector<std::vector<std::string>> past_ =
        std::vector<std::vector<std::string>>(cluster_.size());  // events of each canopy
    std::optional<SlingLoads> slings_;
    SteadyDescent fall_;
    FieldRecorder fields_;
    FrameRecorder frames_;
    double descent_frames_from_ = infinity;  // [s]
    double stop_time_;
    double event_stop_ = longest_flight;
    double below_peak_since_ = infinity;  // [s]
    bool ended_ = false;
    bool begun_ = false;            // with stages: the release is past
    bool evaluated_ = false;        // as parachutes came out
    std::size_t told_rows_ = 0;     // to who watches
    double told_frame_ = -1.0;      // [s] the last shape
    std::size_t sound_events_ = 0;  // events up to the last check that found nothing wrong
    const bool accretes_ = scene_.aerodynamics.added_mass &&
                           scene_.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting;
    CheckpointClock clock_;
};

}  // namespace twinchute::fullsim
