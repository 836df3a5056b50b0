// The largest time step at which the central difference scheme is stable, from below.
#pragma once

#include <cmath>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/time/central_difference.hpp"
#include "lib/record/archive.hpp"

namespace twinchute::fullsim {

struct CriticalStep {
    double dt = 0.0;     ///< [s]
    NodeIndex node = 0;  ///< the one that sets it
};

/// [s] of one node with these row sums: the law of fullsim/laws/critical_step.hpp.
double critical_step_of(double stiffness, double damping, double mass);

/// None yet, for every node of a state.
GershgorinSums no_rows(const State& state, const std::vector<double>& weights = {});

/// min over nodes of 2 sqrt(m_i/K_i) (sqrt(1 + b_i^2) - b_i), b_i = C_i/sqrt(K_i m_i), with m_i
/// including added mass and K_i, C_i the Gershgorin row sums of stiffness and damping.
///
/// b is twice the damping ratio: the velocity that the viscous forces see is extrapolated over
/// half a step. At the highest frequency, where v changes sign every step, that doubles it: the
/// growth factor is -1 when K dt^2/2 + 2 C dt = 2 m, and by Gershgorin no eigenvalue of the
/// damped system reaches that before its largest row does.
CriticalStep critical_step(const GershgorinSums& sums, const std::vector<double>& inertia);

/// Weights of the columns in row sums that bring the largest of them close to the largest eigenvalue of the
/// matrix of norms, which is as far down as row sums can come: any weights bound it from above, and those of
/// its own eigenvector (Perron's) exactly (Collatz 1942). Some power iterations from equal weights, on what
/// is unstrained and without lines, so that gores that are alike have the same. Before flight all are equal:
/// fabric chatters between taut and slack then, and what that adds to the energy grows with the step.
class PerronScaling {
public:
    /// Anew for these blocks, at the state's added mass. `lines` as below.
    void begin(const State& state, const NodeConstants& constants, const ForceModels& structure,
               const ForceModel* lines);
    /// Renews the weights where the added mass has changed much since. Returns whether it did.
    bool renew(const State& state);

    const std::vector<double>& by_node() const { return weight_; }

    /// After begin.
    void serialize(Archive& archive) {
        archive.numbers("weights of rows", std::span(weight_));
        archive.number("weighed at", added_mass_);
    }

private:
    void iterate(const State& state);

    const NodeConstants* constants_ = nullptr;
    const ForceModels* structure_ = nullptr;
    const ForceModel* lines_ = nullptr;
    std::vector<double> weight_;
    double added_mass_ = 0.0;  // [kg] when they were made
};

/// Critical time step from all blocks, for the state as it is.
CriticalStep critical_step(const State& state, const NodeConstants& constants, const ForceModels& structure,
                           const ForceModels& loads, const std::vector<double>& weights);

/// Bounds [s] where nodes on lines and risers may take subcycles.
struct CriticalSteps {
    double all = 0.0;     ///< where every node takes the same step
    double canopy = 0.0;  ///< of canopy and static line, held by everything but lines and risers
    double lines = 0.0;   ///< of nodes on lines and risers, held by these alone
};

/// From all blocks; `lines` is that of lines and risers among the structure, if there is one.
CriticalSteps critical_steps(const State& state, const NodeConstants& constants, const ForceModels& structure,
                             const ForceModels& loads, const ForceModel* lines,
                             const std::vector<double>& weights);

}  // namespace twinchute::fullsim
