#include "fullsim/time/critical_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fullsim/laws/critical_step.hpp"

namespace twinchute::fullsim {

double critical_step_of(double stiffness, double damping, double mass) {
    return HWY_NAMESPACE::critical_step(stiffness, damping, mass);
}

CriticalStep critical_step(const GershgorinSums& sums, const std::vector<double>& inertia) {
    CriticalStep best{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t i = 0; i < inertia.size(); ++i) {
        const double dt = critical_step_of(sums.stiffness[i], sums.damping[i], inertia[i]);
        if (dt < best.dt) best = {dt, static_cast<NodeIndex>(i)};
    }
    return best;
}

namespace {

constexpr int weight_iterations = 4;    // ten come within a per cent of the best
constexpr double least_weight = 1e-3;   // rows that far from the largest have no say
constexpr double much_more_mass = 0.5;  // of air and canopy, after which weights are renewed

std::vector<double> inertia_of(const State& state, const NodeConstants& c) {
    std::vector<double> inertia = c.mass;
    for (NodeIndex i = 0; i < c.canopy_nodes; ++i)
        inertia[i] += c.share[i] * state.added_mass;
    // Neither the dummy nor the anchor of a static line is accelerated, and a body moves its attachment
    // points.
    inertia.resize(c.first_static_line(), infinity);
    if (const auto& line = c.static_line_mass; !line.empty()) {
        inertia.insert(inertia.end(), line.begin(), line.end());
        inertia.back() = infinity;
    }
    return inertia;
}

}  // namespace

GershgorinSums no_rows(const State& state, const std::vector<double>& weights) {
    return {std::vector<double>(state.node.size(), 0.0), std::vector<double>(state.node.size(), 0.0),
            weights};
}

void PerronScaling::begin(const State& state, const NodeConstants& constants, const ForceModels& structure,
                          const ForceModel* lines) {
    constants_ = &constants;
    structure_ = &structure;
    lines_ = lines;
    weight_.assign(state.node.size(), 1.0);
    if (state.stage == Stage::flight) iterate(state);
}

bool PerronScaling::renew(const State& state) {
    if (state.stage != Stage::flight) return false;
    const double change = std::abs(state.added_mass - added_mass_);
    if (change <= much_more_mass * (added_mass_ + constants_->canopy_mass)) return false;
    iterate(state);
    return true;
}

void PerronScaling::iterate(const State& state) {
    added_mass_ = state.added_mass;
    State still = state;
    for (NodeRecord& node : still.node)
        node = {splat(0.0), splat(0.0)};  // nothing is strained
    const std::vector<double> inertia = inertia_of(state, *constants_);
    GershgorinSums sums = no_rows(state, std::vector<double>(state.node.size(), 1.0));
    for (int k = 0; k < weight_iterations; ++k) {
        std::ranges::fill(sums.stiffness, 0.0);
        std::ranges::fill(sums.damping, 0.0);
        for (const auto& model : *structure_)
            if (model.get() != lines_) model->add_row_sums(still, sums);
        // Where a row stands at the step that the largest allows: 1 for that one, less for others.
        const double dt = critical_step(sums, inertia).dt;
        for (std::size_t i = 0; i < inertia.size(); ++i) {
            const double row = dt * (0.25 * dt * sums.stiffness[i] + sums.damping[i]) / inertia[i];
            if (sums.stiffness[i] > 0.0) sums.weight[i] *= std::max(row, least_weight);
        }
        const double largest = *std::ranges::max_element(sums.weight);
        for (double& w : sums.weight)
            w = std::max(w / largest, least_weight);
    }
    // A line's node on the skirt has the canopy's weight, its others have the same.
    double skirt = 1.0;
    GershgorinSums pulled = no_rows(state);
    if (lines_) lines_->add_row_sums(still, pulled);
    const auto canopy = static_cast<std::size_t>(constants_->canopy_nodes);
    for (std::size_t i = 0; i < canopy; ++i)
        if (pulled.stiffness[i] > 0.0 && sums.stiffness[i] > 0.0) skirt = std::min(skirt, sums.weight[i]);
    for (std::size_t i = 0; i < inertia.size(); ++i)
        if (pulled.stiffness[i] > 0.0 && !(i < canopy && sums.stiffness[i] > 0.0)) sums.weight[i] = skirt;
    weight_ = std::move(sums.weight);
}

CriticalStep critical_step(const State& state, const NodeConstants& c, const ForceModels& structure,
                           const ForceModels& loads, const std::vector<double>& weights) {
    GershgorinSums sums = no_rows(state, weights);
    for (const ForceModels* models : {&structure, &loads})
        for (const auto& model : *models)
            model->add_row_sums(state, sums);
    return critical_step(sums, inertia_of(state, c));
}

CriticalSteps critical_steps(const State& state, const NodeConstants& c, const ForceModels& structure,
                             const ForceModels& loads, const ForceModel* lines,
                             const std::vector<double>& weights) {
    GershgorinSums canopy = no_rows(state, weights), pulled = no_rows(state);
    if (lines) lines->add_row_sums(state, pulled);
    const auto on_lines = [&](std::size_t i) { return pulled.stiffness[i] > 0.0; };
    for (const ForceModels* models : {&structure, &loads})
        for (const auto& model : *models)
            if (model.get() != lines) model->add_row_sums(state, canopy);
    const std::vector<double> inertia = inertia_of(state, c);
    std::vector<double> of_canopy = inertia, of_lines = inertia;
    for (std::size_t i = 0; i < inertia.size(); ++i) {
        const bool is_canopy = static_cast<NodeIndex>(i) < c.canopy_nodes;
        if (on_lines(i) && !is_canopy) {
            pulled.damping[i] += canopy.damping[i];                     // of loads
            if (!(canopy.stiffness[i] > 0.0)) of_canopy[i] = infinity;  // contact acts once a step
        }
        if (!on_lines(i)) of_lines[i] = infinity;
    }
    CriticalSteps steps;
    steps.canopy = critical_step(canopy, of_canopy).dt;
    steps.lines = critical_step(pulled, of_lines).dt;
    steps.all = fullsim::critical_step(state, c, structure, loads, weights).dt;
    return steps;
}

}  // namespace twinchute::fullsim
