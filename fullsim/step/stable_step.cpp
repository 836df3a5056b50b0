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

}  // namespace twinchute::fullsim
