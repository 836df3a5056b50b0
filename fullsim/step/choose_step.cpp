#include "fullsim/step/choose_step.hpp"

#include <algorithm>

namespace twinchute::fullsim {
namespace {

constexpr double substep_cost = 0.12;  // of a substep of lines over a step of everything
/// Before finite elements carry the cloth alone, springs slap taut and slack all the time: what that adds to
/// the energy grows with the step, and so do lines. Where lines take substeps, either takes no more than this
/// share of its own bound.
constexpr double share_while_slapping = 0.5;

}  // namespace

double cost_of(int substeps) {
    return 1.0 + substep_cost * (substeps - 1);
}

double share_with(double used_up) {
    return std::clamp((0.8 - used_up) / 0.2, 0.2, 1.0);
}

ChosenStep choose_step(const StableSteps& stable, const StepRules& rules) {
    const double left = rules.slaps ? rules.share_left : 1.0;
    const double share = rules.slaps ? std::min(1.0, share_while_slapping / rules.factor) : 1.0;
    const double quiet = rules.quiet / rules.factor;
    int substeps = 1;
    double step = left * stable.all, dearness = 1.0 / step;
    step = std::min(step, rules.payload);
    for (int count = 2; count <= rules.most_substeps; ++count) {
        const double longer = std::min(quiet, left * share * std::min(stable.canopy, count * stable.lines));
        const double dearness_of_count = cost_of(count) / longer;
        if (dearness_of_count >= dearness) continue;
        substeps = count;
        step = longer;
        dearness = dearness_of_count;
    }
    return {rules.factor * step, substeps};
}

}  // namespace twinchute::fullsim
