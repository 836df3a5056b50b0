// The parachute in motion: mesh, force blocks, state, and the step that moves them. Knows nothing
// of stop conditions, output or reports.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "fullsim/body.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/time/choose_step.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/mass_scaling.hpp"
#include "fullsim/time/midpoint.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/models/inflation.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

class Simulation {
public:
    using LayoutMaker =
        std::function<std::unique_ptr<Layout>(const Scene&, const Mesh&, const NodeConstants&)>;
    static std::unique_ptr<Layout> layout_of_one_thread(const Scene& scene, const Mesh& mesh,
                                                        const NodeConstants& constants) {
        return make_layout(scene, mesh, constants);
    }

    /// The parachute at the scene's release: packed, at line stretch (t_s = 0) or open. `blocks`: the rows
    /// that its force blocks are chosen from.
    explicit Simulation(const Scene& scene, const LayoutMaker& layout = layout_of_one_thread,
                        std::span<const ForceBlock> blocks = force_blocks());
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    const Mesh& mesh() const { return mesh_; }
    /// All of it.
    const State& state() const { return whole(); }
    /// Without the nodes of the parachute: what is there after every step at no cost. Nodes of payload and
    /// static line are always right.
    const State& outline() const { return state_; }
    /// With the positions of the seams, at least.
    const State& seams() const;
    const Inflation& inflation() const { return inflation_; }
    const NodeConstants& constants() const { return constants_; }

    /// All forces at state().time into the state's force arrays. Once per step, before step_to.
    void evaluate_forces();
    /// One step, at most to `end` [s], and at most the critical time step. The last two steps before an
    /// end share what is left, so that it is reached exactly and none is tiny.
    void step_to(double end);

    // The same equations for other integrators, without the step: what it is held to. Nodes and velocities in
    // time alone; mesh, phase and stage are as they stand.

    /// x [m] and v [m/s] of every node of the mesh, three numbers each, and M_a [kg], as they are now.
    std::vector<double> unknowns() const;
    /// Their rates at `time` [s], by the force blocks one after the other. M_a follows its rate, which in air
    /// of one density is what a step takes of it; a static line stays where it is. The state is then that of
    /// `unknowns`, with its riser force, and is no longer the layout's: no steps after this.
    void rates(double time, std::span<const double> unknowns, std::span<double> rates);

    /// The inflation phase changes at state().time, which step_to has reached exactly.
    void begin(Phase phase) { state_.phase = phase; }
    /// The drag area has come to a kink at state().time, likewise.
    void pass_kink() { ++inflation_.piece; }

    // Changes of stage at state().time, which step_to has reached exactly. Each evaluates the forces anew.

    /// Whether 80 % of the line elements are in tension and the risers pull with 5 % of the payload's weight
    /// (the share is the paper's, 5.2; lines that flail reach it without any load).
    bool lines_are_taut() const;
    /// Lines and canopy are drawn out: the static line lets go and the canopy begins to fill. Says why it
    /// cannot, if so.
    std::optional<RunStatus> snatch();
    /// The reefing line of a stage is cut, the next one of the opening begins: its line, if it has one, holds
    /// the mouth. `stage`: those of Parachute::reefing, then the open canopy.
    void disreef(const Inflation& inflation, std::size_t stage);
    /// Finite elements begin to take over from springs, and have.
    void begin_ramp();
    void end_ramp();
    /// Whether the mouth has opened far enough for that: the signed area, since folds make the positive one
    /// of a pack as large as a quarter of the canopy.
    bool mouth_is_open() const;
    /// D0/v [s], v the steady speed of the open canopy with all that hangs on it in the air at hand: the
    /// time in which air passes by. It does not follow the motion, so that nothing feeds back.
    double time_scale() const;
    /// [s] that the ramp takes if it begins now.
    double ramp_time() const;
    /// [s] end of the ramp; infinite when none is going on.
    double ramp_end() const;

    /// [s] the bound on the critical time step of the current tangent, without safety factor.
    CriticalStep bound() const;
    ChosenStep step() const { return {step_, subcycles_}; }
    /// What it would be if the canopy moved with so much air [kg], finite elements had that share of their
    /// stiffness, no cloth were folded and nothing else were different. For forecasts: weights of the bound
    /// may change with it.
    ChosenStep step_with(double added_mass, double fe_weight);
    double dt_min() const { return dt_min_; }
    double dt_max() const { return dt_max_; }
    /// As Layout.
    int sectors() const { return layout_->sectors(); }
    /// What `full.mass_scaling` did to the mesh.
    const MassScaling& mass_scaling() const { return mass_scaling_; }
    /// Most subcycles that lines have taken in a step.
    int most_subcycles() const { return most_subcycles_; }

    EnergyLedger ledger() const { return ledger_of(layout_->levels(state_)); }
    /// What is wrong with the state, if anything: not finite, strained beyond the limit, energy
    /// from nowhere, or a step too small to go on.
    std::optional<RunStatus> find_fault();
    /// Every so many steps (steps_between_checks) a step looks for the same in the state that it began with,
    /// whose energy is known then to the last bit.
    bool was_checked() const { return checked_; }
    const std::optional<RunStatus>& fault() const { return fault_; }
    /// Largest loads of all steps up to the last look that found nothing.
    const LargestLoads& largest_loads() const { return sound_loads_; }

    /// Element evaluations so far, and seconds spent in each block (sampled).
    std::int64_t element_steps() const { return element_steps_; }
    std::vector<BlockCost> block_costs() const { return clock_.costs(); }
    const Layout& layout() const { return *layout_; }
    /// What it keeps in memory in this stage.
    std::vector<PlanArray> arrays() const;

    /// All that changes with time, right after a step or before the first. What is read makes a simulation
    /// of the same scene that has just been constructed go on to the same bits; throws RecordError where it
    /// is of another mesh, layout or instruction set.
    void serialize(Archive& archive);

    /// From one bound on the step to the next, and what a run leaves between two looks for faults.
    static constexpr int steps_between_bounds = 20, steps_between_checks = 50;
    /// At what impacts do to the energy, while steps are short.
    static constexpr int steps_between_looks = 5;

private:
    void change_stage(Stage stage);
    void build_blocks();
    /// The air as the nodes meet it at state().time.
    void renew_air();
    void grow_ramp();
    void let_static_line_go();
    void drop_static_line();
    void set_reefing_line(std::size_t stage);
    /// Mesh, layout and blocks as they are in this stage of a run.
    void take_shape(bool tethered, std::size_t reefing_stage);
    /// Whether cloth could come taut now; the bound then counts it from here on.
    void look_at_folds();
    /// [1/s] rate of its largest strain since the last time, cloth_strain_ from now on.
    double cloth_lengthens();
    /// Cloth comes taut and slack: before flight, unless all of it is folded.
    static bool chatters_in(const State& state) { return state.stage != Stage::flight && !state.folded; }
    /// Impacts shorten steps, in flight as well where those are stable: shorter ones would hide a step beyond
    /// its bound.
    bool impacts_count() const {
        return state_.stage != Stage::flight || scene_.full.time_step_factor <= 1.0;
    }
    /// share: of every bound, see StepRules.
    ChosenStep choose_step(const State& state, double share);
    void refresh_step();
    /// M_a and its rate at state().time + dt, the shape as it is now.
    ValueAndRate added_mass_after(double dt) const;
    EnergyLedger ledger_of(const EnergiesAndStrains& levels) const {
        return energy_ledger(state_, levels.kinetic + turning(), levels.elastic);
    }
    /// [J] of a payload that is a body.
    double turning() const {
        return body_ ? body_->inner_energy(state_, mesh_.payload(), mesh_.first_place()) : 0.0;
    }
    std::optional<RunStatus> find_fault_in(const EnergiesAndStrains& levels, const EnergyLedger& ledger,
                                           double time, std::int64_t step);
    /// Impacts that use up the books' room make steps shorter.
    void watch_impacts(const EnergyLedger& ledger);
    /// What does not add up, over what changed hands [-].
    double residual_share(const EnergyLedger& ledger);
    /// The most strained element, in words.
    std::string hardest_hit() const;
    /// In `state`.
    std::string first_bad_node(const State& state) const;

    /// The state with all its nodes as they are now.
    State& whole() const;

    const Scene& scene_;
    const LayoutMaker make_layout_;
    std::span<const ForceBlock> blocks_;
    Inflation inflation_;
    MassScaling mass_scaling_;
    Mesh mesh_;
    ForceModels structure_, loads_;
    NodeConstants constants_;
    std::unique_ptr<const Body> body_;  // the payload, where it is one
    double riser_stiffness_ = 0.0;      // [N/m] of the stiffest element
    mutable State state_;               // its nodes may lag behind the layout's
    mutable bool lags_ = false;
    std::unique_ptr<Layout> layout_;
    double step_ = 0.0;                       // [s] bound times factor, as last refreshed
    int subcycles_ = 1, most_subcycles_ = 1;  // of lines, in each step
    LineWaves line_waves_;
    ImpactWatch impacts_;
    bool checked_ = false;                           // by the last step,
    std::optional<RunStatus> fault_;                 // which found this
    double cloth_strain_ = -1.0, cloth_seen_ = 0.0;  // [-] of the longest before snatch, and when [s]
    double cloth_rate_ = 0.0;                        // [1/s] of that, the largest lately
    double dt_min_ = 0.0, dt_max_ = 0.0;
    double ramp_start_ = 0.0, ramp_time_ = 0.0;  // [s]
    double ramp_energy_ = 0.0;  // [J] of the finite elements at full stiffness, at the last step of the ramp
    std::size_t reefing_stage_ = 0;
    std::vector<Cable> lines_;  // elements of the suspension lines; empty after snatch
    LargestLoads sound_loads_;
    BlockClock clock_;
    std::int64_t element_steps_ = 0;
    ElementCount elements_;
};

}  // namespace twinchute::fullsim
