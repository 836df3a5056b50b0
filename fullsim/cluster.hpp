// Parachutes that carry one payload, together or one after the other: each is a simulation of its own with
// its share of the payload, and all that are out take their steps together.
//
// Each of N canopies carries the payload's N-th part, as a node with an N-th of its mass and drag. Before
// these nodes move, in subcycles before each of them, the force on each becomes the mean of all: they move as
// one body of the whole mass under all forces, and momentum and energy are those of the whole. All take the
// smallest step and the most subcycles that any of them asks for.
//
// Canopies of a cluster do not pass through each other: two that touch do so along a plane between them, see
// canopy_plane.hpp. What the air does between them is the scene's cluster_drag_ratio and nothing else.
//
// In a scene with stages (has_stages) each parachute joins when it leaves its pack, with all canopies that it
// has, and leaves when it is cut. Shares are even, and change with that; while none is out the payload flies
// by itself (free_flight.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fullsim/canopy_plane.hpp"
#include "fullsim/free_flight.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/threads/thread_count_tuner.hpp"
#include "fullsim/threads/worker_pool.hpp"

namespace twinchute::fullsim {

/// The scene of canopy number `k` of a cluster alone: with its share of the payload, its lag, its noise.
Scene scene_of_canopy(const Scene& scene, int k);

/// Whether parachutes come out one after the other, in flight, or are cut.
bool has_stages(const Scene& scene);

/// The scene of one parachute of several alone, from where it leaves its pack: with all of the payload, and
/// all canopies of the parachute.
Scene scene_in_flight(const Scene& scene, std::size_t parachute, const PayloadFlight& at);

/// [rad] by which the canopies of a cluster lean outward at the start, so far that neighbours just stay clear
/// of each other. Throws SceneError where they would not even side by side.
double outward_lean(const Scene& scene);

class Cluster {
public:
    /// The scene outlives it. One parachute is a simulation as any other. Of a scene with stages none is out.
    /// Several share as many threads at most; nothing that they compute depends on these.
    explicit Cluster(const Scene& scene,
                     const Simulation::LayoutMaker& layout = Simulation::layout_of_one_thread,
                     int threads = 1);

    bool is_staged() const { return staged_; }
    bool is_of_several() const { return scene_.parachutes.size() > 1; }  ///< parachutes
    int threads() const { return threads_ ? tuner_.most() : 1; }
    /// Canopies that are out or have been.
    std::size_t size() const { return canopies_.size(); }
    /// Canopies that are out, in rising order.
    const std::vector<std::size_t>& out() const { return out_; }
    bool is_out(std::size_t k) const { return std::ranges::binary_search(out_, k); }
    Simulation& operator[](std::size_t k) { return *canopies_[k]; }
    const Simulation& operator[](std::size_t k) const { return *canopies_[k]; }
    /// Scene of one canopy alone.
    const Scene& scene(std::size_t k) const { return *scenes_[k]; }
    /// The first that is out; there is one.
    Simulation& front() { return *canopies_[out_.front()]; }
    const Simulation& front() const { return *canopies_[out_.front()]; }

    double time() const { return out_.empty() ? alone_.time : front().system().time; }  ///< [s]
    /// Steps with canopies out, or of the flight alone: neither counts those of the other.
    std::int64_t step() const { return out_.empty() ? steps_alone_ : front().system().step; }
    /// Sum of both.
    std::int64_t all_steps() const {
        return steps_alone_ + (out_.empty() ? steps_before_ : front().system().step);
    }
    /// The payload now; its acceleration only where it flies alone.
    PayloadFlight payload() const;
    /// A check of the last step has looked for faults.
    bool was_checked() const;

    /// A parachute of the scene leaves its pack: the payload weighs `left` [kg] without it. The number here
    /// of its first canopy, which others of it follow. Throws SceneError, and changes nothing, where it
    /// cannot begin as it would have to here.
    std::size_t join(std::size_t parachute, double left);
    /// Parachute of the scene that canopy k is, or one of,
    std::size_t parachute(std::size_t k) const {
        return staged_ ? departures_[members_[k].departure].parachute : 0;
    }
    /// and which of it.
    std::size_t number(std::size_t k) const {
        return staged_ ? k - departures_[members_[k].departure].first : k;
    }
    /// "main, canopy 2"; without what is the only one, and of the only canopy empty.
    std::string name_of(std::size_t k) const;
    /// Scene in flight of the parachute that canopy k is one of: all of the payload, and all of its canopies.
    const Scene& scene_of_all(std::size_t k) const {
        return staged_ ? *departures_[members_[k].departure].scene : scene_;
    }
    /// All canopies of a parachute from its first on, which come out open, settle as each does alone, and
    /// lean out as far as they are wide then.
    void settle(std::size_t first, const std::function<bool()>& stop);
    /// A parachute is cut: all canopies of it from its first on. They no longer move.
    void leave(std::size_t first);
    /// Sets what ends a free flight before its end.
    void watch(FlightWatch watch) { watch_ = std::move(watch); }

    /// As Simulation, for all that are out.
    void evaluate_forces();
    void step_to(double end);
    /// Canopy that is full last of so many, as far as that is known.
    std::size_t last_to_open(std::size_t first, std::size_t count) const;
    /// A stage of one canopy has changed, with a new first step: all take one.
    void start_anew_but(std::size_t changed);

    /// Contact of each two canopies.
    const std::vector<CanopyPlane>& planes() const { return planes_; }
    /// Sum over all [J].
    EnergyLedger ledger() const;
    LargestLoads largest_loads(std::size_t first, std::size_t count) const;
    std::int64_t element_steps() const;
    std::vector<BlockCost> block_costs() const;
    /// The first fault of any, with whose it is.
    std::optional<RunStatus> fault() const;
    std::optional<RunStatus> find_fault();

    void serialize(Archive& archive);

private:
    void add_canopies(const Scene& scene);
    double payload_nodes_mass() const;
    PayloadPart part_of(const PayloadFlight& payload, double count) const;
    void share_payload(const PayloadFlight& payload);
    void fly_alone(double end);
    void serialize_members(Archive& archive);
    template <class Work>
    void for_each(Work&& work);
    void push_apart();
    void share_pulls(double kick, int subcycles);
    template <class Force>
    Lanes mean_of(Force&& force) const;
    std::optional<RunStatus> of_first(
        const std::function<std::optional<RunStatus>(std::size_t)>& fault) const;

    const Scene& scene_;
    const Simulation::LayoutMaker make_layout_;
    const bool staged_;
    std::vector<std::unique_ptr<Scene>> made_;  // scenes of several canopies, or of stages
    std::vector<const Scene*> scenes_;
    std::vector<std::unique_ptr<Simulation>> canopies_;
    /// A parachute of a scene with stages, as it left its pack.
    struct Departure {
        std::size_t parachute = 0, first = 0;
        std::unique_ptr<Scene> scene;
    };
    std::vector<Departure> departures_;
    struct Member {
        std::size_t departure = 0;
        double riser_mass = 0.0;  // [kg] that the payload's node carries of its risers
        double parts = 1.0;       // that the payload is parted into, as last borne
    };
    std::vector<Member> members_;
    std::vector<std::size_t> out_;
    // While none is out. The flight takes steps of its own, each from the end of the last one. Rows in
    // between lead nowhere: the flight goes on from that end, however many there are.
    PayloadFlight alone_, step_to_;
    std::optional<Vec3> moments_;    // [kg m^2] of a payload that is a body, without packs
    std::int64_t steps_alone_ = 0;   // that a row ends, or the flight itself
    std::int64_t steps_before_ = 0;  // of canopies that were out before
    bool checked_alone_ = false;
    std::optional<RunStatus> fault_alone_;
    double payload_mass_ = 0.0;  // [kg] with packs, of a scene with stages
    FlightWatch watch_;
    std::vector<Lanes> rest_;  // [N] on each part of the payload but for air and, in subcycles, risers
    std::vector<CanopyPlane> planes_;
    bool has_new_planes_ = false;  // not searched yet
    struct Touching {
        std::vector<NodeRecord> node;
        std::vector<double> mass;
        std::vector<Lanes> force;
    };
    std::array<Touching, 2> touching_;  // of the pair at hand
    ThreadCountTuner tuner_;
    std::unique_ptr<WorkerPool> threads_;  // if it may be more than one
};

}  // namespace twinchute::fullsim
