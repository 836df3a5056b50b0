#include "fullsim/time/step_control.hpp"

#include <algorithm>
#include <cmath>

#include "fullsim/time/energy.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double memory_of_rate = 0.8;  // from one bound to the next, of the fastest chatter
constexpr double few_impacts = 0.4;  // of the largest residual, which impacts of a canopy drawn out may use
/// Air that joins the canopy within a step, over all that is accelerated: what brings it to speed is booked
/// with the speed from before, an error of the energy in proportion to the step.
constexpr double most_joining = 0.003;

}  // namespace

StepControl::StepControl(const Scene& scene, const Mesh& mesh, const NodeConstants& constants)
    : scene_(scene), system_mass_(constants.system_mass) {
    for (const Cable& c : mesh.cables)
        if (std::max(c.node[0], c.node[1]) >= mesh.first_attachment())
            riser_stiffness_ =
                std::max(riser_stiffness_, c.strands * mesh.cord(c.kind).axial_stiffness() / c.rest_length);
    for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
        least_air_ = std::min(least_air_, constants.share[i] / constants.mass[i]);
    line_waves_ = line_waves(mesh, constants, scene.parachutes.front().line_length, scene.full.bulk_viscosity,
                             scene.full.beta);
}

bool StepControl::begin_deployment(const State& state, const Layout& layout) {
    strain_rate(state, layout);
    const bool folded = scene_.full.structure != Structure::fe && fabric_strain_ < nearly_taut;
    if (!folded) impacts_.expect();
    return folded;
}

double StepControl::strain_rate(const State& state, const Layout& layout) {
    const double strain = layout.fabric_strain(state), since = state.time - strain_seen_;
    const double rate = since > 0.0 ? (strain - fabric_strain_) / since : 0.0;
    fabric_strain_ = strain;
    strain_seen_ = state.time;
    return rate;
}

bool StepControl::comes_taut(const State& state, const Layout& layout) {
    // Fabric that is torn out may lack more than that and be taut two steps later.
    const double rate = strain_rate(state, layout);
    return fabric_strain_ >= nearly_taut || fabric_strain_ + 2.0 * rate * state.dt >= 0.0;
}

ChosenStep StepControl::choose(const State& state, const StepInputs& inputs, double share) const {
    CriticalSteps stable = inputs.layout.critical_steps(state);
    if (outer_frequency_ > 0.0)
        for (double* step : {&stable.all, &stable.canopy})
            *step = 1.0 / std::hypot(1.0 / *step,
                                     0.5 * outer_frequency_ / std::sqrt(1.0 + least_air_ * state.added_mass));
    StepRules rules;
    rules.factor = scene_.full.time_step_factor;
    rules.chatters = chatters_in(state);
    rules.share = share;
    rules.most_subcycles = scene_.full.line_substeps;
    // In a pack that only falls lines are slack.
    if (!state.folded) rules.resonance_limit = resonance_limit(line_waves_, state.added_mass, stable.canopy);
    if (inputs.body) {
        const CriticalSteps of_body = inputs.body->critical_steps(state, inputs.structure, riser_stiffness_);
        stable.all = std::min(stable.all, of_body.all);
        stable.canopy = std::min(stable.canopy, of_body.canopy);
        stable.lines = std::min(stable.lines, of_body.lines);
    }
    return choose_step(stable, rules);
}

ChosenStep StepControl::forecast(const State& state, const StepInputs& inputs) const {
    return choose(state, inputs, 1.0);
}

void StepControl::refresh(const State& state, const StepInputs& inputs) {
    const ChosenStep chosen = choose(state, inputs, impacts_count(state) ? impacts_.share() : 1.0);
    step_ = chosen.dt;
    const auto& added = scene_.aerodynamics.added_mass;
    if (added && added->momentum == AddedMassMomentum::accreting && state.accretion() > 0.0)
        step_ = std::min(step_, most_joining * (system_mass_ + state.added_mass) / state.accretion());
    if (state.stage == Stage::deployment && !state.folded) {
        const double rate = strain_rate(state, inputs.layout);
        strain_rate_ = std::max(std::abs(rate), memory_of_rate * strain_rate_);
        step_ = std::min({step_, step_to_first_impact(fabric_strain_, rate), step_in_impacts(strain_rate_)});
    }
    subcycles_ = chosen.subcycles;
}

void StepControl::renew(State& state, const StepInputs& inputs) {
    if (state.folded && comes_taut(state, inputs.layout)) {
        state.folded = false;
        impacts_.expect();
        refresh(state, inputs);
    }
    if (state.step > 0 && state.step % steps_between_bounds == 0) refresh(state, inputs);
}

NextStep StepControl::take(const ChosenStep& chosen, double time, double end) {
    const double left = end - time;
    NextStep step{left, chosen.subcycles, end};
    if (left > chosen.dt) {
        step.dt = std::min(chosen.dt, 0.5 * left);
        step.end = time + step.dt;
        dt_min_ = std::min(dt_min_, step.dt);
    }
    dt_max_ = std::max(dt_max_, step.dt);
    most_subcycles_ = std::max(most_subcycles_, chosen.subcycles);
    return step;
}

bool StepControl::watches_impacts(SystemState& state, bool checked) const {
    return impacts_count(state) && (checked || (state.step % steps_between_looks == 0 && impacts_.alert()) ||
                                    impacts_.is_due(state.energy.damping, energy_scale(state.energy)));
}

void StepControl::watch_impacts(double used_up, double damping) {
    // A canopy that never was in a pack has few impacts: its steps are others than those of the same canopy
    // seen from a moving frame only where its energy balance is about to be used up.
    const double tolerated = scene_.parachutes.front().deploy.starts_packed() ? 0.0 : few_impacts;
    const double before = impacts_.share();
    impacts_.look(used_up, damping, tolerated);
    // Longer ones with the next bound.
    step_ *= std::min(1.0, impacts_.share() / before);
}

void StepControl::serialize(Archive& archive) {
    for (double* x : {&step_, &dt_min_, &dt_max_})
        archive.number("step", *x);
    for (double* x : {&fabric_strain_, &strain_seen_, &strain_rate_})
        archive.number("fabric strain", *x);
    impacts_.serialize(archive);
    archive.whole("subcycles", subcycles_, 1);
    archive.whole("most subcycles", most_subcycles_, 1);
}

}  // namespace twinchute::fullsim
