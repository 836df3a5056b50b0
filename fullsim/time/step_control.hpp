// Control of the time step over a run: the bound and its subcycles, refreshed now and then, and shorter steps
// where fabric comes taut.
#pragma once

#include "fullsim/body.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/time/choose_step.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Inputs of a step from the parachute.
struct StepInputs {
    Layout& layout;
    const ForceModels& structure;
    const Body* body;  ///< the payload, where it is one
};

/// The next step: `dt` [s] in `subcycles` of lines, to `end` [s].
struct NextStep {
    double dt = 0.0;
    int subcycles = 1;
    double end = 0.0;
};

class StepControl {
public:
    StepControl(const Scene& scene, const Mesh& mesh, const NodeConstants& constants);

    /// A packed canopy is released. Returns whether its fabric is folded (SystemState::folded).
    bool begin_deployment(const State& state, const Layout& layout);
    /// Bound and subcycles for `state`.
    void refresh(const State& state, const StepInputs& inputs);
    /// Refreshes bound and subcycles where that is due. Sets state.folded to false where fabric could come
    /// taut now; the bound counts it from here on.
    void renew(State& state, const StepInputs& inputs);
    /// The next step from `time` toward `end` [s]. The last two before an end share what is left, so that it
    /// is reached exactly and none is tiny.
    NextStep take(const ChosenStep& chosen, double time, double end);
    /// Time step for another state, e.g. with more added mass. For forecasts: weights of the bound may change
    /// with it.
    ChosenStep forecast(const State& state, const StepInputs& inputs) const;

    /// Whether impacts have to be looked at with the step that begins; `checked`: faults are.
    bool watches_impacts(SystemState& state, bool checked) const;
    /// Shortens steps whose impacts bring the residual near its limit. used_up: the residual over the
    /// largest one at which a run goes on.
    void watch_impacts(double used_up, double damping);

    /// Masses have changed; counts from the next refresh on.
    void weigh(const NodeConstants& constants) { system_mass_ = constants.system_mass; }
    /// Forces from outside on the canopy's nodes, as stiff as this [1/s] over their material mass, count from
    /// the next refresh on.
    void count_outer(double frequency) { outer_frequency_ = frequency; }
    double outer_frequency() const { return outer_frequency_; }

    /// [s] bound times factor, as last refreshed.
    ChosenStep chosen() const { return {step_, subcycles_}; }
    double dt_min() const { return dt_min_; }  ///< [s] shortest step so far
    double dt_max() const { return dt_max_; }  ///< [s] longest
    int most_subcycles() const { return most_subcycles_; }

    void serialize(Archive& archive);

    /// From one bound on the step to the next.
    static constexpr int steps_between_bounds = 20;
    /// At what impacts do to the energy, while steps are short.
    static constexpr int steps_between_looks = 5;

private:
    /// Fabric comes taut and slack: before flight, unless all of it is folded.
    static bool chatters_in(const SystemState& state) {
        return state.stage != Stage::flight && !state.folded;
    }
    /// Impacts shorten steps, in flight as well where those are stable: shorter ones would hide a step beyond
    /// its bound.
    bool impacts_count(const SystemState& state) const {
        return state.stage != Stage::flight || scene_.full.time_step_factor <= 1.0;
    }
    /// share: of every bound, see StepRules.
    ChosenStep choose(const State& state, const StepInputs& inputs, double share) const;
    /// [1/s] rate of the fabric's largest strain since the last time, fabric_strain_ from now on.
    double strain_rate(const State& state, const Layout& layout);
    bool comes_taut(const State& state, const Layout& layout);

    const Scene& scene_;
    double system_mass_;            // [kg]
    double riser_stiffness_ = 0.0;  // [N/m] of the stiffest element on a body
    LineWaves line_waves_;
    double outer_frequency_ = 0.0;  // [1/s]
    double least_air_ = infinity;   // [1/kg] share of the added mass over mass, of the canopy's nodes
    ImpactWatch impacts_;
    double step_ = 0.0;                                // [s] bound times factor, as last refreshed
    int subcycles_ = 1, most_subcycles_ = 1;           // of lines, in each step
    double dt_min_ = infinity, dt_max_ = 0.0;          // [s]
    double fabric_strain_ = -1.0, strain_seen_ = 0.0;  // [-] the largest before snatch, and when [s]
    double strain_rate_ = 0.0;                         // [1/s] of that, the largest lately
};

}  // namespace twinchute::fullsim
