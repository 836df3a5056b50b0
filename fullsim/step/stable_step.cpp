#include "fullsim/step/stable_step.hpp"

#include <cmath>
#include <limits>

namespace twinchute::fullsim {

StableStep stable_step(const RowSums& sums, const std::vector<double>& inertia) {
    StableStep best{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t i = 0; i < inertia.size(); ++i) {
        const double K = sums.stiffness[i], C = sums.damping[i], m = inertia[i];
        // (sqrt(C^2 + K m) - C)/K without cancellation, and right for K = 0.
        const double dt = 2.0 * m / (std::sqrt(C * C + K * m) + C);
        if (dt < best.dt) best = {dt, static_cast<NodeIndex>(i)};
    }
    return best;
}

StableStep stable_step(const State& state, const NodeConstants& c, const ForceModels& structure,
                       const ForceModels& loads) {
    constexpr double never = std::numeric_limits<double>::infinity();
    RowSums sums;
    sums.stiffness.assign(state.node.size(), 0.0);
    sums.damping.assign(state.node.size(), 0.0);
    for (const ForceModels* models : {&structure, &loads})
        for (const auto& model : *models)
            model->add_row_sums(state, sums);
    std::vector<double> inertia = c.mass;
    for (NodeIndex i = 0; i < c.canopy_nodes; ++i)
        inertia[i] += c.share[i] * state.added_mass;
    // Neither the dummy nor the far end of a static line is accelerated.
    inertia.push_back(never);
    if (const auto& line = c.static_line_mass; !line.empty()) {
        inertia.insert(inertia.end(), line.begin(), line.end());
        inertia.back() = never;
    }
    return stable_step(sums, inertia);
}

}  // namespace twinchute::fullsim
