// How a parachute's nodes and elements lie in memory, and the two halves of a step over them. The arithmetic
// is the same in each layout; which one a run has is the mesh's choice.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/step/midpoint.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Seconds spent in each block, from a sample of the steps: a clock read for every block in every step costs
/// more than some blocks do.
class BlockClock {
public:
    /// The blocks from here on, by name; those known from an earlier stage go on with their account.
    void begin(const std::vector<std::string>& names);
    void begin_step(bool timed) {
        timed_ = timed;
        next_ = 0;
    }
    /// The next block's work.
    template <class Work>
    void run(Work&& work) {
        Account& account = accounts_[active_[next_++]];
        ++account.steps;
        if (!timed_) return work();
        const auto start = std::chrono::steady_clock::now();
        work();
        account.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        ++account.sampled;
    }
    /// [s], of all steps.
    std::vector<BlockCost> costs() const;

private:
    struct Account {
        std::string name;
        double seconds = 0.0;
        std::int64_t sampled = 0, steps = 0;
    };
    std::vector<Account> accounts_;    // in the order in which blocks first took part
    std::vector<std::size_t> active_;  // account of each block of now
    std::size_t next_ = 0;
    bool timed_ = false;
};

class Layout {
public:
    virtual ~Layout() = default;

    virtual std::string_view name() const = 0;
    virtual std::string_view instruction_set() const = 0;

    /// A stage begins: nodes and velocities are taken from the state, forces are cleared in it. The blocks
    /// say what acts; they outlive the stage.
    virtual void begin(State& state, const ForceModels& structure, const ForceModels& loads) = 0;
    /// Renews those node records that a step leaves out of date. Payload, links, risers and static line never
    /// are.
    virtual void store(State& state) const = 0;

    /// [J] that the membranes of the stage would hold at full stiffness.
    virtual double membrane_energy(State& state) const = 0;

    /// All forces at state.time. Sets state.riser_force, and state.air's areas and pressure.
    virtual void evaluate(State& state, BlockClock& clock) = 0;
    /// [s] the bound on the stable step of the current tangent, without safety factor (stable_step.hpp).
    virtual double stable_step(const State& state) = 0;

    /// One step with these forces (see advance in midpoint.hpp).
    virtual void advance(State& state, double dt, double next_added_mass) = 0;
};

/// Node records of 64 bytes and lists of elements that refer to them: any mesh.
std::unique_ptr<Layout> make_indexed_layout(const Mesh& mesh, const NodeConstants& constants);

/// Gores in lanes where gores are alike, indexed otherwise.
std::unique_ptr<Layout> make_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants);

struct GoreKernels;

/// Gores in lanes: the same element of several gores at once. Null where gores are not alike. Kernels: the
/// best of this machine unless others are given.
std::unique_ptr<Layout> make_gore_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                         const GoreKernels* kernels = nullptr);

}  // namespace twinchute::fullsim
