#include "fullsim/time/choose_step.hpp"

#include <algorithm>
#include <cmath>

namespace twinchute::fullsim {
namespace {

constexpr double subcycle_cost = 0.12;  // of a subcycle of lines over a step of everything
/// Before finite elements carry the fabric alone, springs chatter between taut and slack all the time: what
/// that adds to the energy grows with the step, and so do lines. Where lines take subcycles, either takes no
/// more than this share of its own bound.
constexpr double share_while_chattering = 0.5;
/// Shares of the largest residual: the one that impacts may use, and the remainder below which steps become
/// shorter. A crane drop uses 0.56 and keeps its steps.
constexpr double most_used = 0.9, careful_from = 0.33;
constexpr double most_at_once = 0.2;  // of what is left, from one look to the next
constexpr double faster = 1.1;        // by which steps become longer again, at most
constexpr double least_share = 0.02;
constexpr double unnoticed = 0.01;    // of what is left, from one look to the next
constexpr double least_left = 0.002;  // of that: once all is used, steps must not stay short for ever

}  // namespace

double cost_of(int subcycles) {
    return 1.0 + subcycle_cost * (subcycles - 1);
}

double step_to_first_impact(double strain, double rate) {
    constexpr double steps = 40.0, at_impact = 0.005;
    if (!(strain < 0.0 && rate > 0.0)) return infinity;
    return std::max(-strain / steps, at_impact) / rate;
}

double step_in_impacts(double rate) {
    constexpr double overshoot = 0.002;
    return rate > 0.0 ? overshoot / rate : infinity;
}

void ImpactWatch::look(double used_up, double dissipated, double tolerated) {
    const double used = std::abs(used_up), change = std::abs(used_up - used_up_),
                 left = std::max(0.0, most_used - used);
    used_up_ = used_up;
    dissipated_ = dissipated;
    if (used < tolerated) {
        share_ = 1.0;
        return;
    }
    if (change <=
        unnoticed * std::max(least_left, left)) {  // nothing hits: however little is left, nothing uses it
        share_ = std::min(1.0, faster * share_);
        return;
    }
    // An impact makes its error in proportion to the step: in as many steps, the square of it.
    const double longer = std::min(faster, std::sqrt(most_at_once * left / change));
    share_ = std::clamp(std::min(share_ * longer, left / careful_from), least_share, 1.0);
}

ChosenStep choose_step(const CriticalSteps& stable, const StepRules& rules) {
    const double left = rules.share;
    const double share = rules.chatters ? std::min(1.0, share_while_chattering / rules.factor) : 1.0;
    const double limit = rules.resonance_limit / rules.factor;
    int subcycles = 1;
    double step = left * stable.all, cost = 1.0 / step;
    for (int count = 2; count <= rules.most_subcycles; ++count) {
        const double longer = std::min(limit, left * share * std::min(stable.canopy, count * stable.lines));
        const double cost_of_this = cost_of(count) / longer;
        if (cost_of_this >= cost) continue;
        subcycles = count;
        step = longer;
        cost = cost_of_this;
    }
    return {rules.factor * step, subcycles};
}

}  // namespace twinchute::fullsim
