// How a parachute's nodes and elements lie in memory, and the two halves of a step over them. The arithmetic
// is the same in each layout; which one a run has is the mesh's choice.
#pragma once

#include <boost/container/static_vector.hpp>
#include <chrono>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fullsim/body.hpp"
#include "fullsim/forces/force_model.hpp"
#include "fullsim/time/central_difference.hpp"
#include "fullsim/time/critical_step.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

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
    bool timed() const { return timed_; }
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

    /// Adds the account of another clock for each block of this one.
    void add(const BlockClock& other);

    /// Before begin.
    void serialize(Archive& archive);

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

/// Quantities that the checks of a run examine.
struct EnergiesAndStrains {
    double kinetic = 0.0;  ///< [J] as kinetic_energy
    double elastic = 0.0;  ///< [J] as elastic_energy
    /// Largest, by structural block, as ForceModel::extreme. In place: steps ask for no memory.
    boost::container::static_vector<double, 16> strain;
};

/// From the node records and the blocks themselves.
EnergiesAndStrains levels_of(const State& state, const NodeConstants& constants,
                             const ForceModels& structure);
double fabric_strain_of(const State& state, const ForceModels& structure);

/// Blocks of fabric as springs, which is folded before it comes taut.
inline bool is_folding_fabric(Block block) {
    return block == Block::fabric_springs || block == Block::tapes;
}

/// Over its length: an edge that lacks less may come taut within a step. At 0.4 ms, the longest step of a
/// pack, an edge of 0.1 m would have to lengthen at 25 m/s to cross it unseen.
inline constexpr double nearly_taut = -0.1;

/// Structural elements: all, and those that pull once more in every further subcycle.
struct ElementCount {
    std::size_t all = 0, in_subcycles = 0;
};

class Layout {
public:
    virtual ~Layout() = default;

    virtual std::string_view name() const = 0;
    virtual std::string_view instruction_set() const = 0;
    virtual int threads() const { return 1; }
    /// As many parts of the canopy, one after the other in the mesh, are congruent all the time.
    virtual int sectors() const { return 1; }

    /// A stage begins: nodes and velocities are taken from the state, forces are cleared in it. The blocks
    /// say what acts; they outlive the stage, and so does the payload where it is a body.
    virtual void begin(State& state, const ForceModels& structure, const ForceModels& loads,
                       const Body* body = nullptr) = 0;
    /// Renews those node records that a step leaves out of date. Payload and static line never are.
    virtual void store(State& state) const = 0;

    /// Structural elements that a step evaluates.
    virtual ElementCount elements(const ForceModels& structure) const;

    /// Arrays that it keeps in memory since begin, by the force blocks whose elements they are.
    virtual std::vector<PlanArray> arrays() const { return {}; }

    /// [J] that the membranes of the stage would hold at full stiffness.
    virtual double membrane_energy(State& state) const = 0;
    /// Energies and strains of all nodes and elements as they are now, without store.
    virtual EnergiesAndStrains levels(const State& state) const = 0;
    /// [-] largest of fabric springs and tapes: below zero where fabric is folded.
    virtual double fabric_strain(const State& state) const = 0;

    /// All forces at state.time. Sets state.riser_force, and state.air's areas and pressure; state.largest
    /// grows here, and in the subcycles of advance.
    virtual void evaluate(State& state, BlockClock& clock) = 0;
    virtual CriticalSteps critical_steps(const State& state) = 0;

    /// One step with these forces (see advance in central_difference.hpp), in which lines, risers and payload
    /// take `subcycles` (subcycling.hpp). What risers do to the payload in subcycles after the first goes to
    /// state.in_subcycles, which is empty.
    void advance(State& state, double dt, int subcycles, double next_added_mass) {
        begin_step(state, dt, subcycles);
        move(state);
        end_step(state, next_added_mass);
    }

    // The parts of that, for parachutes that share a payload (cluster.hpp): after begin_step, and before each
    // drift, state.force of the payload is what its risers pull, in a step without subcycles all that acts on
    // it but the air.

    /// Takes the pull of lines apart from all other forces where there are subcycles.
    void begin_step(State& state, double dt, int subcycles) {
        dt_ = dt;
        subcycles_ = subcycles;
        step_sums_ = {};
        if (!together()) separate(state);
    }
    /// All of the following but end_step.
    void move(State& state) {
        impulse(state);
        if (together()) return;
        drift(state, 0);
        for (int k = 1; k < subcycles_; ++k) {
            pull(state, k);
            drift(state, k);
        }
    }
    /// Moves all that takes no subcycles from t to t + dt; lines get the impulse of all other forces.
    virtual void impulse(State& state) = 0;
    /// Forces of lines in subcycle k > 0.
    virtual void pull(State& state, int k) = 0;
    /// Subcycle k of lines, risers and payload.
    virtual void drift(State& state, int k) = 0;
    /// Sums and works of the step.
    virtual void end_step(State& state, double next_added_mass) = 0;
    /// Adds a work [J] on the payload's node, of forces from outside the parachute, and its power [W] at the
    /// time of the last forces as half of the step that they act over will have it.
    void add_outer_work(double work, double power) {
        step_sums_.outer_work += work;
        step_sums_.outer_power = power;
    }

    /// Saves or restores the data of the layout after a step that the state lacks, so that a run goes on to
    /// the same bits. `state` is kept; restored data have the name and instruction set of this layout, and go
    /// in after begin.
    virtual void serialize(Archive& archive, const State& state) = 0;

    // Other canopies push nodes of this one (cluster.hpp), after evaluate.

    /// Some nodes of the canopy as they are now.
    virtual void read(const State& state, std::span<const NodeIndex> nodes, std::span<NodeRecord> to) const;
    /// Adds forces [N] on them.
    virtual void push(State& state, std::span<const NodeIndex> nodes, std::span<const Lanes> force) const;
    /// Accelerates all of the canopy [m/s^2], in this step.
    virtual void accelerate(const Vec3& acceleration) = 0;

protected:
    virtual void separate(State& state) = 0;
    bool together() const { return subcycles_ == 1; }

    const Body* body_ = nullptr;  ///< since begin
    double dt_ = 0.0;             ///< [s] of the step under way
    int subcycles_ = 1;
    StepSums step_sums_;
};

namespace unstructured {
struct Kernels;
}

/// Node records of 64 bytes and lists of elements that refer to them: any mesh. Kernels: the best of this
/// machine unless others are given.
std::unique_ptr<Layout> make_unstructured_layout(const Scene& scene, const Mesh& mesh,
                                                 const NodeConstants& constants,
                                                 const unstructured::Kernels* kernels = nullptr,
                                                 int threads = 1);

/// The force blocks themselves, one after the other, on the same records: what other layouts are held to.
std::unique_ptr<Layout> make_reference_layout(const Mesh& mesh, const NodeConstants& constants);

/// One sector where the scene asks for it, else gore-batched where gores are alike, unstructured otherwise.
/// Throws SceneError where a sector is asked for that the mesh has not.
std::unique_ptr<Layout> make_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                    int threads = 1);

struct GoreKernels;

/// Gore-batched: the same element of several gores at once. Null where gores are not alike. Kernels: the
/// best of this machine unless others are given. As many threads at most, fewer where they would not pay.
std::unique_ptr<Layout> make_gore_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                         const GoreKernels* kernels = nullptr, int threads = 1);

struct SectorKernels;

/// One sector of a symmetric parachute, its sector-batched: the state has to be as symmetric as the mesh.
/// Null where sectors are not alike, and `why` says in what. Kernels: the best of this machine unless others
/// are given.
std::unique_ptr<Layout> make_sector_layout(const Scene& scene, const Mesh& mesh,
                                           const NodeConstants& constants, std::string* why = nullptr,
                                           const SectorKernels* kernels = nullptr);

}  // namespace twinchute::fullsim
