// The largest time step at which the explicit midpoint rule is stable, from below.
#pragma once

#include "fullsim/forces/force_model.hpp"
#include "fullsim/step/midpoint.hpp"

namespace twinchute::fullsim {

struct StableStep {
    double dt = 0.0;     ///< [s]
    NodeIndex node = 0;  ///< the one that sets it
};

/// min over nodes of 2 sqrt(m_i/K_i) (sqrt(1 + b_i^2) - b_i), b_i = C_i/sqrt(K_i m_i), with m_i
/// including added mass and K_i, C_i the Gershgorin row sums of stiffness and damping.
///
/// b is twice the damping ratio: the velocity that the viscous forces see is extrapolated over
/// half a step. At the highest frequency, where v changes sign every step, that doubles it: the
/// growth factor is -1 when K dt^2/2 + 2 C dt = 2 m, and by Gershgorin no eigenvalue of the
/// damped system reaches that before its largest row does.
StableStep stable_step(const RowSums& sums, const std::vector<double>& inertia);

/// The same from all blocks, for the state as it is.
StableStep stable_step(const State& state, const NodeConstants& constants, const ForceModels& structure,
                       const ForceModels& loads);

}  // namespace twinchute::fullsim
