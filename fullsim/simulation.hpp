// The parachute in motion: mesh, force blocks, state, and the step that moves them. Knows nothing
// of stop conditions, output or reports.
#pragma once

#include <optional>
#include <string>

#include "fullsim/forces/registry.hpp"
#include "fullsim/step/energy.hpp"
#include "fullsim/step/midpoint.hpp"
#include "fullsim/step/stable_step.hpp"
#include "lib/models/inflation.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

class Simulation {
public:
    /// The parachute at line stretch, at the scene's release. Opens at once: t_s = 0.
    explicit Simulation(const Scene& scene);
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    const Mesh& mesh() const { return mesh_; }
    const State& state() const { return state_; }
    const Inflation& inflation() const { return inflation_; }
    const NodeConstants& constants() const { return constants_; }

    /// All forces at state().time into the state's force arrays. Once per step, before step_to.
    void evaluate_forces();
    /// One step, at most to `end` [s], and at most the stable step. The last two steps before an
    /// end share what is left, so that it is reached exactly and none is tiny.
    void step_to(double end);
    /// The inflation phase changes at state().time, which step_to has reached exactly.
    void begin(Phase phase) { state_.phase = phase; }

    /// [s] the bound on the stable step of the current tangent, without safety factor.
    StableStep bound() const;
    double dt_min() const { return dt_min_; }
    double dt_max() const { return dt_max_; }

    EnergyLedger ledger() const { return energy_ledger(state_, constants_, structure_); }
    /// What is wrong with the state, if anything: not finite, strained beyond the limit, energy
    /// from nowhere, or a step too small to go on.
    std::optional<RunStatus> find_fault();
    /// Largest load that find_fault has met in a structural block: tension [N] of the lines,
    /// principal stress resultant [N/m] of the most strained fabric.
    double largest_load(std::string_view block) const;

    /// Element evaluations in one step, and seconds spent in each block so far (sampled).
    std::size_t elements_per_step() const;
    std::vector<BlockCost> block_costs() const;

private:
    static constexpr int steps_between_bounds = 20;

    void refresh_step();
    /// M_a and its rate at state().time + dt, the shape as it is now.
    ValueAndRate added_mass_after(double dt) const;
    std::string first_bad_node() const;

    const Scene& scene_;
    Inflation inflation_;
    Mesh mesh_;
    ForceModels structure_, loads_;
    NodeConstants constants_;
    State state_;
    double step_ = 0.0;  // [s] bound times factor, as last refreshed
    double dt_min_ = 0.0, dt_max_ = 0.0;
    std::vector<double> largest_load_;  // by structural block
    std::vector<double> block_seconds_;
    std::int64_t sampled_steps_ = 0;
};

}  // namespace twinchute::fullsim
