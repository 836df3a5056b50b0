// The parachute in motion: mesh, force blocks, state, and the step that moves them. Knows nothing
// of stop conditions, output or reports.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "fullsim/body.hpp"
#include "fullsim/canopy_plane.hpp"
#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/time/central_difference.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/mass_scaling.hpp"
#include "fullsim/time/step_control.hpp"
#include "lib/models/inflation.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

/// Part of a payload that one of several parachutes carries.
struct PayloadPart {
    double node_mass = 0.0;              ///< [kg] of the payload's node: also half an element of each riser
    Vec3 velocity = Vec3::Zero();        ///< [m/s]
    std::optional<Vec3> moments = {};    ///< [kg m^2] of a box or a cylinder, along its own axes,
    std::optional<BodyState> body = {};  ///< and how it turns
};

class Simulation {
public:
    using LayoutMaker =
        std::function<std::unique_ptr<Layout>(const Scene&, const Mesh&, const NodeConstants&)>;
    static std::unique_ptr<Layout> layout_of_one_thread(const Scene& scene, const Mesh& mesh,
                                                        const NodeConstants& constants) {
        return make_layout(scene, mesh, constants);
    }

    /// The parachute at the scene's release: packed, at line stretch (t_s = 0) or open. `blocks`: the rows
    /// that its force blocks are chosen from. `turn`: of all of it about Mesh::pivot, at the start.
    explicit Simulation(const Scene& scene, const LayoutMaker& layout = layout_of_one_thread,
                        std::span<const ForceBlock> blocks = force_blocks(),
                        const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    const Mesh& mesh() const { return mesh_; }
    /// All but nodes, current after every step at no cost.
    const SystemState& system() const { return state_; }
    const NodeRecord& payload() const { return state_.node[mesh_.payload()]; }
    /// [N] All forces on the payload's node, as last evaluated.
    Vec3 payload_force() const {
        return to_vec3(state_.force[mesh_.payload()].value + state_.aero[mesh_.payload()].value);
    }
    /// The state with all its nodes, gathered from the layout once a step.
    const State& synchronised_state() const { return synchronised(); }
    const Inflation& inflation() const { return inflation_; }
    const NodeConstants& constants() const { return constants_; }

    // One step: evaluate_forces, then step_to; observers look between the two.

    /// All forces at system().time, once per step.
    void evaluate_forces();
    /// Critical time step, advance of the nodes, energy balance. Goes at most to `end` [s]; the last two
    /// steps before an end share what is left.
    void step_to(double end);

    // The parts of step_to, for parachutes that share a payload, see cluster.hpp.

    /// Time step and subcycles that this parachute would take.
    ChosenStep choose_step();
    /// Begins the step that it takes, toward `end` [s].
    void begin_step(const ChosenStep& chosen, double end);
    const NextStep& step_under_way() const { return next_; }
    void impulse() { layout_->impulse(state_); }
    void pull(int k) { layout_->pull(state_, k); }
    void drift(int k) { layout_->drift(state_, k); }
    void end_step();
    /// Forces on the payload's node [N]: of the air, and all others.
    Lanes& payload_drag() { return state_.aero[mesh_.payload()].value; }
    Lanes& payload_load() { return state_.force[mesh_.payload()].value; }
    /// As Layout::add_outer_work.
    void add_outer_work(double work, double power) { layout_->add_outer_work(work, power); }
    /// Takes place, velocity and attitude of the payload from another simulation of it.
    void follow_payload_of(const Simulation& other);
    /// The next step is a first one, as after a change of stage: velocities count from now, not from half a
    /// step before. Evaluates the forces anew.
    void start_anew();
    /// [kg] of the payload's node: it also carries half an element of each riser.
    double payload_node_mass() const { return mesh_.mass[mesh_.payload()]; }
    /// Bears another part of a payload from now on, as the scene says by now. What that changes of the
    /// kinetic energy is booked as work from outside. A first step follows, as after start_anew.
    void bear(const PayloadPart& part);
    /// Begins as step number `step` of a run, with the payload at this place and its motion, which the
    /// scene's release has but for rounding; a body of it turns.
    void begin_at(const Vec3& position, const PayloadPart& part, std::int64_t step);
    /// As bear, at the start of a simulation, whose ledger begins with it, and without the motion.
    void weigh_payload(const PayloadPart& part);

    /// Gives a canopy that begins open the shape that it flies with; without it fabric and lines would begin
    /// without strain and take their load at once. A copy of the parachute falls on, straight and alone, in
    /// air that goes along with it, and comes to rest whenever its motion is strongest, until that is weak. A
    /// fault in it, or `stop`, leaves everything as it is.
    void settle(const std::function<bool()>& stop);
    /// Another turn than that at the start, before the first step.
    void turn_to(const Eigen::Quaterniond& turn);
    /// Place [m] of Mesh::pivot now.
    Vec3 pivot() const;
    /// [m] middle of where the risers end.
    Vec3 riser_end() const;
    /// Torque of the risers [N m] on a payload that turns, and what it has of a velocity [rad/s].
    Vec3 payload_torque() const { return body_ ? state_.body->torque : Vec3::Zero(); }
    Vec3 payload_spin() const { return body_ ? body_->spin(state_) : Vec3::Zero(); }
    void set_payload_torque(const Vec3& torque) {
        if (body_) state_.body->torque = torque;
    }
    /// Whether settling came to its end, for a canopy that begins under load.
    bool has_settled() const { return settled_; }
    /// Nodes of the canopy may be pushed from outside by forces as stiff as `frequency` [1/s] over their
    /// material mass: counts in the critical step from here on.
    void meet_others(double frequency);
    /// All nodes of the canopy, or some of them, read into `record` and `mass`.
    PressedNodes canopy_nodes() const;
    PressedNodes canopy_nodes(std::span<const NodeIndex> nodes, std::vector<NodeRecord>& record,
                              std::vector<double>& mass) const;
    /// Adds forces [N] on some nodes of the canopy, and on it as a whole, from outside the parachute, after
    /// evaluate_forces. `of`: as canopy_nodes has read them.
    void push_canopy(std::span<const NodeIndex> nodes, std::span<const NodeRecord> of,
                     std::span<const Lanes> force, Lanes on_all);
    /// Adds a force [N] on the payload, likewise.
    void push_payload(Lanes force);

    // Equations of motion without the time step, for reference solutions by other integrators. Only nodes and
    // velocities vary in time; mesh, phase and stage stay as they are.

    /// x [m] and v [m/s] of every node of the mesh, three numbers each, and M_a [kg], as they are now.
    std::vector<double> unknowns() const;
    /// Their rates at `time` [s], by the force blocks one after the other. M_a follows its rate, which in air
    /// of one density is what a step takes of it; a static line stays where it is. The state is then that of
    /// `unknowns`, with its riser force, and is no longer the layout's: no steps after this.
    void rates(double time, std::span<const double> unknowns, std::span<double> rates);

    /// The inflation phase changes at system().time, which step_to has reached exactly.
    void begin(Phase phase) { state_.phase = phase; }
    /// The drag area has come to a kink at system().time, likewise.
    bool predicts_filling() const { return inflow_.has_value(); }
    /// Whether a canopy whose filling is predicted has become as wide as it is when steady, or as its reefing
    /// line lets it,
    bool has_filled() const;
    /// which ends its filling at system().time.
    void end_filling();
    /// Whether a reefing line is there; it may be too long to hold anything.
    bool is_reefed() const { return reefing_stage_ < scene_.parachutes.front().reefing.size(); }
    void pass_kink() { ++inflation_.piece; }
    /// [s] at which the open canopy is full; infinite as long as it is reefed.
    double full_open() const { return is_reefed() ? infinity : inflation_.end_of(Phase::filling); }

    // Changes of stage at system().time, which step_to has reached exactly. Each evaluates the forces anew.

    /// Why the opening cannot take place, if so: its initial phase is not shorter than its filling.
    std::optional<RunStatus> refused_opening(const Inflation& inflation, double speed) const;
    /// Whether 80 % of the line elements are in tension and the risers pull with 5 % of the payload's weight
    /// (the share is the paper's, 5.2; lines that flail reach it without any load).
    bool lines_are_taut() const;
    /// Lines and canopy are drawn out: the static line lets go and the canopy begins to fill, as `inflation`
    /// says or, without it, by this scene and its speed. Says why it cannot, if so.
    std::optional<RunStatus> snatch(const std::optional<Inflation>& inflation = {});
    /// Opens as this says, from the start.
    void open_as(const Inflation& inflation);
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
    ChosenStep step() const { return steps_.chosen(); }
    /// Time step if the canopy moved with so much air [kg], finite elements had that share of their
    /// stiffness, no fabric were folded and nothing else were different. For forecasts: weights of the bound
    /// may change with it.
    ChosenStep step_with(double added_mass, double fe_weight);
    /// Steps so far: shortest, longest [s], most subcycles of lines.
    const StepControl& steps() const { return steps_; }
    /// As Layout.
    int sectors() const { return layout_->sectors(); }
    /// Effect of `full.mass_scaling` on the mesh.
    const MassScaling& mass_scaling() const { return mass_scaling_; }
    EnergyLedger ledger() const { return ledger_of(layout_->levels(state_)); }
    /// Finds a fault of the state, if there is one: not finite, strained beyond the limit, energy from
    /// nowhere, or a step too small to go on.
    std::optional<RunStatus> find_fault();
    /// Every so many steps (steps_between_checks) a step looks for the same in the state that it began with,
    /// whose energy is known then to the last bit.
    bool was_checked() const { return checked_; }
    const std::optional<RunStatus>& fault() const { return fault_; }
    /// Largest loads of all steps up to the last look that found nothing.
    const LargestLoads& largest_loads() const { return sound_loads_; }

    std::int64_t own_steps() const { return state_.step - first_step_; }
    /// Element evaluations so far, and seconds spent in each block (sampled).
    std::int64_t element_steps() const { return element_steps_; }
    std::vector<BlockCost> block_costs() const { return clock_.costs(); }
    const Layout& layout() const { return *layout_; }
    /// Arrays kept in memory in this stage.
    std::vector<PlanArray> arrays() const;

    /// All that changes with time, right after a step or before the first. What is read makes a simulation
    /// of the same scene that has just been constructed go on to the same bits; throws RecordError where it
    /// is of another mesh, layout or instruction set.
    void serialize(Archive& archive);

    static constexpr int steps_between_checks = 50;  ///< for faults

private:
    /// Canopy as a whole, without its nodes.
    PressedNodes pressed() const;
    /// The ledger begins with the strains of now.
    void begin_shape();
    std::optional<bool> relax(double unit, const std::function<bool()>& stop);
    double mean_kinetic() const;
    void come_to_rest();
    void take_shape_of(const Simulation& settled, const Eigen::Quaterniond& turn);
    void lean(const Eigen::Quaterniond& turn);
    void begin_with_shape();
    void make_body_of(const PayloadPart& part);
    void turn_body(const PayloadPart& part);
    void change_stage(Stage stage);
    void build_blocks();
    /// The air as the nodes meet it at system().time.
    void renew_air();
    /// [N] AeroState::extraction.
    Vec3 extraction() const;
    void grow_ramp();
    void let_static_line_go();
    void drop_static_line();
    void set_reefing_line(std::size_t stage);
    /// Whether the reefing line is as long as it is without strain, all round together.
    bool reefing_line_is_taut() const;
    /// Mesh, layout and blocks as they are in this stage of a run.
    void take_shape(bool tethered, std::size_t reefing_stage);
    StepInputs step_inputs() const { return {*layout_, structure_, body_.get()}; }

    /// State at the beginning of a step that its energy balance needs.
    struct Balance {
        bool checked = false, watched = false;
        double time = 0.0, turning = 0.0, added_mass = 0.0;  // [s], [J], [J]
        EnergiesAndStrains levels;                           // where either is asked for
    };
    Balance begin_balance();
    Balance balance_;
    NextStep next_;
    void book_energy(const Balance& before);

    /// M_a and its rate at system().time + dt, the shape as it is now.
    ValueAndRate added_mass_after(double dt) const;
    EnergyLedger ledger_of(const EnergiesAndStrains& levels) const {
        return energy_ledger(state_, levels.kinetic + turning(), levels.elastic);
    }
    /// [J] of a payload that is a body.
    double turning() const { return body_ ? body_->inner_energy(state_) : 0.0; }
    std::optional<RunStatus> find_fault_in(const EnergiesAndStrains& levels, const EnergyLedger& ledger,
                                           double time, std::int64_t step);
    /// Residual of the energy balance over the energy exchanged [-].
    double residual_share(const EnergyLedger& ledger);
    /// The most strained element, in words.
    std::string hardest_hit() const;
    /// In `state`.
    std::string first_bad_node(const State& state) const;

    State& synchronised() const;

    static constexpr double largest_residual =
        0.002;  // of the energy that changed hands; sound: 1e-5 to 1e-4

    const Scene& scene_;
    const LayoutMaker make_layout_;
    std::span<const ForceBlock> blocks_;
    Inflation inflation_;
    MassScaling mass_scaling_;
    Mesh mesh_;
    const std::optional<InflowBalance> inflow_;  // where filling is predicted
    ForceModels structure_, loads_;
    NodeConstants constants_;
    std::unique_ptr<const Body> body_;      // the payload, where it is one
    mutable State state_;                   // nodes of canopy and lines as of
    mutable std::int64_t stored_step_ = 0;  // this step
    std::unique_ptr<Layout> layout_;
    StepControl steps_;
    bool checked_ = false;                       // by the last step,
    std::optional<RunStatus> fault_;             // which found this
    double ramp_start_ = 0.0, ramp_time_ = 0.0;  // [s]
    double ramp_energy_ = 0.0;   // [J] of the finite elements at full stiffness, at the last step of the ramp
    double full_at_ = infinity;  // [s] a canopy whose filling is predicted first came to its full area
    Eigen::Quaterniond turn_;    // of all of it at the start
    std::optional<Vec3> held_airspeed_;  // [m/s] of air that goes along, as is its density
    bool settled_ = true;
    std::size_t reefing_stage_ = 0;
    std::vector<Cable> lines_;  // elements of the suspension lines; empty after snatch
    LargestLoads sound_loads_;
    BlockClock clock_;
    std::int64_t element_steps_ = 0, first_step_ = 0;
    ElementCount elements_;
};

}  // namespace twinchute::fullsim
