// The step that is taken: as long as is stable and quiet, in as many substeps of lines as make it cheapest.
#pragma once

#include <limits>

#include "fullsim/step/stable_step.hpp"

namespace twinchute::fullsim {

/// A step [s] with safety factor, and the substeps of lines in it.
struct ChosenStep {
    double dt = 0.0;
    int substeps = 1;
};

/// What a step depends on beside the bounds of nodes.
struct StepRules {
    static constexpr double never = std::numeric_limits<double>::infinity();

    double factor = 1.0;      ///< full.time_step_factor
    int most_substeps = 1;    ///< full.line_substeps; 1 under a body, which moves with the canopy
    bool slaps = false;       ///< cloth comes taut and slack: before flight, unless all of it is folded
    double share_left = 1.0;  ///< of slapping cloth's step, see share_with
    double quiet = never;     ///< [s] the longest, factor and all, in which lines do not ring (quiet_step)
    double payload = never;   ///< [s] stable step of a payload that is a body
};

ChosenStep choose_step(const StableSteps& stable, const StepRules& rules);

/// Of a step with so many substeps over one without.
double cost_of(int substeps);

/// How much of its step slapping cloth is given, by the share of the largest residual of energy that is used
/// up: what it adds to the energy shrinks with the step. What a crane drop uses goes unnoticed, a fifth is
/// left for the flight.
double share_with(double used_up);

}  // namespace twinchute::fullsim
