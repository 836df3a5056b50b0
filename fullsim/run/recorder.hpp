// Everything that a full run observes: its canopies, each and together, their events, slings, fields, frames.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fullsim/run/canopy_run.hpp"
#include "fullsim/run/fields.hpp"
#include "fullsim/run/frames.hpp"
#include "fullsim/run/sling_loads.hpp"
#include "fullsim/run/stages.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {

class Recorder {
public:
    /// stated_masses as FullRun. `stages`: of a scene that has some, otherwise null. All but the masses
    /// outlive it.
    Recorder(const Scene& scene, std::span<const double> stated_masses, const Run& run, Cluster& cluster,
             Stages* stages);

    CanopyRun& operator[](std::size_t k) { return *canopies_[k]; }
    const CanopyRun& operator[](std::size_t k) const { return *canopies_[k]; }
    /// The only canopy, or all together.
    const RunView& view() const { return all_ ? all_->view : canopies_.front()->view(); }
    Findings& found() { return all_ ? all_->found : canopies_.front()->found(); }
    Observer& observer() { return all_ ? all_->observer : canopies_.front()->observer(); }
    const Observer& observer() const { return view().observer; }
    /// The parachute that canopy k is, or is one of,
    const RunView& parachute(std::size_t k) const {
        const Together* group = group_of(k);
        return group ? group->view : canopies_[k]->view();
    }
    /// and the numbers of all its canopies.
    std::vector<std::size_t> canopies_with(std::size_t k) const {
        const Together* group = group_of(k);
        return group ? group->canopies : std::vector{k};
    }
    /// Views of all canopies that are out or have been; of their parachutes.
    std::vector<RunView> canopy_views() const;
    std::vector<RunView> parachute_views() const;

    /// Takes in the canopies that have joined the cluster since the last call.
    void add_canopies();
    /// Tells the observer of all what the payload weighs now.
    void weigh_payload();

    /// Looks at the forces that have just been evaluated; takes rows and shapes that are due.
    void observe();
    /// A look at one parachute, with a row of each canopy and of all.
    void observe_parachute(std::size_t k);
    /// The last row of a parachute that is cut now.
    void observe_cut(std::size_t first);

    /// Marks all so far as sound, as a check has found it; drops what has come since the last such check.
    void accept();
    void forget();
    /// Gives rows and shapes that have come since, and that are sound, to who watches the run.
    void tell_watchers();

    void add_event(std::string name);
    /// An event of a parachute, with its name where there are several.
    void add_event(std::size_t parachute, const char* name);
    std::vector<Event> take_events() { return std::move(events_); }
    /// Notes what happened to canopy k. It is an event of its parachute, and of a run without stages, once
    /// all canopies of the parachute have come to it; the end of the initial phase with the first of them.
    /// Adds such an event, and returns whether it is one.
    bool happened(std::size_t k, const char* name);
    /// Begins the next stage of the parachute that canopy k is one of.
    void disreefed(std::size_t k);
    /// [s] the shortest initial phase of its canopies.
    double initial_phase(std::size_t k) const;

    /// Frames from here on are those of a deployment, an opening, a descent.
    void begin_deployment_frames();
    void begin_opening_frames();
    void begin_descent_frames();

    /// Settles everything, with a row of the end where `is_sound`, and gives the shapes away. No observation
    /// follows.
    void finish(bool is_sound);
    /// Adds the loads of slings.
    void fill(RunRecord& record) const {
        if (slings_) slings_->fill(record);
    }

    /// Saves or restores, without the parts that the constructor makes anew, while no field waits to be
    /// accepted.
    void serialize(Archive& archive);

private:
    /// The canopies of a cluster as one: all of a run, or all of a parachute.
    struct Together {
        Observer observer;
        Findings found;
        RunView view;
        std::vector<std::size_t> canopies;

        /// So many canopies from `first` on. sequence: of the last of them, which is reefed if any is.
        Together(const Scene& scene, double stated_mass, const Cluster& cluster, std::size_t first,
                 const OpeningSequence* sequence);
        /// A scene with stages has nothing out at first. mesh: of its first parachute.
        Together(const Scene& scene, const Mesh& mesh, const Cluster& cluster);
        Together(const Together&) = delete;
        Together& operator=(const Together&) = delete;
    };

    std::vector<const Mesh*> meshes() const;
    std::vector<const State*> synchronised_states() const;
    /// Canopy k with all others of its parachute: null where it is the only one of it.
    Together* group_of(std::size_t k) const;
    template <class Work>
    void for_each_observer(Work&& work);
    /// The forces of these canopies, as one, on the payload, where there are any.
    void observe_together(Observer& observer, std::span<const std::size_t> canopies, bool row);
    /// A row of these canopies as one; of none, of the payload alone.
    void add_row_together(Observer& observer, std::span<const std::size_t> canopies);
    /// Row of the payload without a canopy.
    HistoryRow row_alone() const;
    void add_rows();
    bool is_of_parachute(std::size_t k, std::string_view name);

    const Scene& scene_;
    const Run& run_;
    Cluster& cluster_;
    Stages* stages_;
    std::vector<double> stated_masses_;
    std::vector<std::unique_ptr<CanopyRun>> canopies_;
    std::unique_ptr<Together> all_;                  // of several, or with stages
    std::vector<std::unique_ptr<Together>> groups_;  // with stages: of each parachute of several canopies
    std::vector<std::vector<std::string>> past_;     // events of each canopy
    std::optional<SlingLoads> slings_;
    FieldRecorder fields_;
    FrameRecorder frames_;
    double descent_frames_from_ = infinity;  // [s]
    std::vector<Event> events_;
    std::size_t sound_events_ = 0;  // up to the last accept()
    std::size_t told_rows_ = 0;     // to who watches
    double told_frame_ = -1.0;      // [s] the last shape
};

}  // namespace twinchute::fullsim
