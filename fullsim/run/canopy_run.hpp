// The opening of one canopy of a run: its events, from pack or line stretch to the steady canopy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fullsim/run/findings.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::fullsim {

class CanopyRun {
public:
    /// Canopy `which` of a cluster, or the only one. stated_mass as RunView. `shared`: the sequence of all
    /// parachutes of a scene with stages, each canopy its own, whose canopy of that number it is. All outlive
    /// it.
    CanopyRun(const Scene& scene, double stated_mass, Cluster& canopies, std::size_t which,
              OpeningSequence* shared = nullptr, std::size_t number = 0);
    CanopyRun(const CanopyRun&) = delete;
    CanopyRun& operator=(const CanopyRun&) = delete;

    Simulation& simulation() { return canopies_[which_]; }
    const SystemState& system() const { return canopies_[which_].system(); }
    const RunView& view() const { return view_; }
    const Findings& found() const { return found_; }
    Findings& found() { return found_; }
    Observer& observer() { return observer_; }
    const Observer& observer() const { return observer_; }
    const OpeningSequence* sequence() const { return sequence_; }
    FlightState flight_state() const;

    /// Forces, and a row of the history where one is due; before look().
    void observe(bool row_is_due);
    /// Changes of phase and stage that are due now: their names, in order. Ends the run where one cannot go
    /// on: then `ending` says so.
    const std::vector<const char*>& look(bool falls_steadily);
    const std::optional<RunStatus>& ending() const { return ending_; }
    /// Next time [s] at which something is due.
    double next_stop() const;
    /// Its reefing line is cut now, as a shared sequence says.
    void disreef();
    /// Stage of its opening by the sequence of it; of a parachute that is not reefed 0.
    std::size_t stage() const { return view_.sequence ? sequence_->all()[number_].stage : 0; }
    bool deploys() const { return system().stage == Stage::deployment; }
    /// A steady descent counts for a reefing line that waits for it.
    bool waits_for_steady_descent() const {
        return own_ && own_->waits_for_steady_descent() && system().phase == Phase::open;
    }

    /// A canopy that still squids at the end of a run has not opened, whatever ended it; nor has one that was
    /// full and fell in. None: it does not.
    std::optional<std::string> squids() const;

    void serialize(Archive& archive);

private:
    void look_for_snatch();
    void look_for_opening();
    void look_for_disreef(bool falls_steadily);
    void watch_growth();
    double next_load_change() const;
    double hold() const;
    double last_deployment() const;
    const Parachute& parachute() const { return scene_.parachutes.front(); }

    const Scene& scene_;
    Cluster& canopies_;
    std::size_t which_;
    Observer observer_;
    Findings found_;
    std::optional<OpeningSequence> own_;   // of a reefed parachute
    OpeningSequence* sequence_ = nullptr;  // that, or a shared one,
    std::size_t number_ = 0;               // of which it is this canopy
    const RunView view_;
    std::vector<const char*> happened_;  // in this look
    std::optional<RunStatus> ending_;
    /// Progress of a predicted filling: distance travelled [m] since a projected area [m^2], and whether that
    /// area stood still over the stretch before.
    struct Growth {
        double travelled = 0.0, area = 0.0;
        bool stands = false;
    } growth_;
    double hold_end_ = infinity;  // [s] at which lines that are taut now will have been so long enough
};

}  // namespace twinchute::fullsim
