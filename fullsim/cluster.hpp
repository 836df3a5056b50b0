// Parachutes that carry one payload together: each is a simulation of its own with its share of the payload,
// and all of them take their steps together.
//
// Each of N canopies carries the payload's N-th part, as a node with an N-th of its mass and drag. Before
// these nodes move, in subcycles before each of them, the force on each becomes the mean of all: they move as
// one body of the whole mass under all forces, and momentum and energy are those of the whole. All take the
// smallest step and the most subcycles that any of them asks for.
//
// Canopies do not pass through each other: two that touch do so along a plane between them, see
// canopy_plane.hpp. What the air does between them is the scene's cluster_drag_ratio and nothing else.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fullsim/canopy_plane.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/threads/thread_count_tuner.hpp"
#include "fullsim/threads/worker_pool.hpp"

namespace twinchute::fullsim {

/// The scene of canopy number `k` of a cluster alone: with its share of the payload, its lag, its noise.
Scene scene_of_canopy(const Scene& scene, int k);

/// [rad] by which the canopies of a cluster lean outward at the start, so far that neighbours just stay clear
/// of each other. Throws SceneError where they would not even side by side.
double outward_lean(const Scene& scene);

class Cluster {
public:
    /// The scene outlives it. One parachute is a simulation as any other.
    /// Several share as many threads at most; nothing that they compute depends on these.
    explicit Cluster(const Scene& scene,
                     const Simulation::LayoutMaker& layout = Simulation::layout_of_one_thread,
                     int threads = 1);

    int threads() const { return threads_ ? tuner_.most() : 1; }
    std::size_t size() const { return canopies_.size(); }
    Simulation& operator[](std::size_t k) { return *canopies_[k]; }
    const Simulation& operator[](std::size_t k) const { return *canopies_[k]; }
    /// Scene of one canopy alone.
    const Scene& scene(std::size_t k) const { return *scenes_[k]; }
    Simulation& front() { return *canopies_.front(); }
    const Simulation& front() const { return *canopies_.front(); }

    /// As Simulation, for all.
    void evaluate_forces();
    void step_to(double end);
    /// Canopy that is full last, as far as that is known.
    std::size_t last_to_open() const;
    /// A stage of one canopy has changed, with a new first step: all take one.
    void start_anew_but(std::size_t changed);

    /// Contact of each two canopies.
    const std::vector<CanopyPlane>& planes() const { return planes_; }
    /// Sum over all [J].
    EnergyLedger ledger() const;
    LargestLoads largest_loads() const;
    std::int64_t element_steps() const;
    std::vector<BlockCost> block_costs() const;
    /// The first fault of any, with whose it is.
    std::optional<RunStatus> fault() const;
    std::optional<RunStatus> find_fault();

    void serialize(Archive& archive);

private:
    template <class Work>
    void for_each(Work&& work);
    void count_time();
    void push_apart();
    void share_pulls(double kick, int subcycles);
    template <class Force>
    Lanes mean_of(Force&& force) const;
    std::optional<RunStatus> of_first(
        const std::function<std::optional<RunStatus>(std::size_t)>& fault) const;

    std::vector<std::unique_ptr<Scene>> made_;  // scenes of several canopies
    std::vector<const Scene*> scenes_;
    std::vector<std::unique_ptr<Simulation>> canopies_;
    std::vector<Lanes> rest_;  // [N] on each part of the payload but for air and, in subcycles, risers
    std::vector<CanopyPlane> planes_;
    double near_ = 0.0;  // [m] see CanopyPlane::search
    struct Touching {
        std::vector<NodeRecord> node;
        std::vector<double> mass;
        std::vector<Lanes> force;
    };
    std::array<Touching, 2> touching_;  // of the pair at hand
    ThreadCountTuner tuner_;
    std::unique_ptr<WorkerPool> threads_;  // if it may be more than one
    std::optional<std::chrono::steady_clock::time_point> step_began_;
};

}  // namespace twinchute::fullsim
