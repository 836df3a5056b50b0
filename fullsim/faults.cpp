// Faults of a simulation: what is not finite, torn, out of balance or endless, with the element and a remedy.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/simulation.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double smallest_step = 1e-9;  // [s] below which nothing would ever finish
constexpr std::int64_t most_steps = 2'000'000'000;

}  // namespace

std::string Simulation::first_bad_node(const State& state) const {
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i) {
        const Lanes both = state.node[i].x + state.node[i].v;
        if (std::isfinite(sum3(both))) continue;
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            if (std::ranges::count(mesh_.triangles[t].node, i))
                return fmt::format("node {}, fabric triangle {}", i, t);
        for (std::size_t c = 0; c < mesh_.cables.size(); ++c)
            if (std::ranges::count(mesh_.cables[c].node, i))
                return fmt::format("node {}, {} cable {}", i, cable_kind_name(mesh_.cables[c].kind), c);
    }
    return std::isfinite(state.added_mass) ? "a load" : "the added mass";
}

std::string Simulation::hardest_hit() const {
    const State& s = synchronised();
    double most = -1.0;
    std::string name = "elements";
    for (const auto& model : structure_)
        if (const StrainExtremum extreme = model->extreme(s); extreme.strain > most) {
            most = extreme.strain;
            name =
                fmt::format("{}, strained by {:.2g} %", model->element_name(extreme.element), 100.0 * most);
        }
    return name;
}

std::optional<RunStatus> Simulation::find_fault() {
    const EnergiesAndStrains levels = layout_->levels(state_);
    return find_fault_in(levels, ledger_of(levels), state_.time, state_.step);
}

std::optional<RunStatus> Simulation::find_fault_in(const EnergiesAndStrains& levels, const EnergyLedger& e,
                                                   double time, std::int64_t step) {
    const auto where = [&] { return fmt::format("at t = {:.6f} s, step {}", time, step); };
    // A sum, which a NaN cannot hide from; comparisons and maxima can lose it.
    const double everything = levels.kinetic + state_.sums.system_position.sum() +
                              state_.largest.line_tension + state_.largest.fabric_stress;
    if (!std::isfinite(everything))
        return RunStatus{
            StatusCode::not_finite,
            fmt::format("{} {}; the time step is probably above the stable one, lower full.time_step_factor",
                        first_bad_node(synchronised()), where())};
    if (steps_.chosen().dt < smallest_step)
        return RunStatus{
            StatusCode::step_too_small,
            fmt::format("critical time step {:.3g} s set by node {} {}; a coarser full.mesh there, or fabric "
                        "and lines that are less stiff for their mass, allow longer ones",
                        steps_.chosen().dt, bound().node, where())};
    // Written so that a NaN fails, too; energy that vanishes is as wrong as energy from nowhere.
    const double share = residual_share(e);
    if (!(std::abs(share) <= largest_residual)) {
        const bool lost = share < 0.0;
        return RunStatus{
            lost ? StatusCode::solver_failed : StatusCode::energy_grew,
            fmt::format(
                "{:.3g} J of energy {}, {:.2g} % of what changed hands, {}: the step of {:.2g} s is too "
                "long for impacts of {}; a smaller full.time_step_factor (now {:g}) brings shorter ones",
                std::abs(residual(e)), lost ? "were lost" : "came from nowhere", 100.0 * std::abs(share),
                where(), steps_.chosen().dt, hardest_hit(), scene_.full.time_step_factor)};
    }
    for (std::size_t i = 0; i < structure_.size(); ++i)
        if (const double strain = levels.strain[i]; strain > scene_.full.strain_limit)
            return RunStatus{
                StatusCode::strain_limit,
                fmt::format("{} is strained by {:.1f} % (limit {:.1f} %) {}: it would have torn; a lighter "
                            "payload, a slower release or a slower filling loads it less, "
                            "full.strain_limit lets it stretch further",
                            structure_[i]->element_name(structure_[i]->extreme(synchronised()).element),
                            100.0 * strain, 100.0 * scene_.full.strain_limit, where())};
    if (step >= most_steps)
        return RunStatus{
            StatusCode::step_limit,
            fmt::format("{} steps are the most that a run may take, {}; an earlier stop or a coarser "
                        "full.mesh takes fewer",
                        most_steps, where())};
    sound_loads_ = state_.largest;
    return std::nullopt;
}

}  // namespace twinchute::fullsim
