// The step that is taken: as long as is stable and does not make lines ring, in as many subcycles of lines as
// make it cheapest.
#pragma once

#include "fullsim/time/critical_step.hpp"
#include "lib/math/vec.hpp"
#include "lib/record/archive.hpp"

namespace twinchute::fullsim {

/// A step [s] with safety factor, and the subcycles of lines in it.
struct ChosenStep {
    double dt = 0.0;
    int subcycles = 1;
};

/// Rules of the time step beside the bounds of nodes.
struct StepRules {
    double factor = 1.0;     ///< full.time_step_factor
    int most_subcycles = 1;  ///< full.line_substeps
    bool chatters = false;   ///< fabric comes taut and slack: before flight, unless all of it is folded
    double share = 1.0;      ///< of every bound, see ImpactWatch
    double resonance_limit =
        infinity;  ///< [s] the longest, factor and all, in which lines do not ring (resonance_limit)
};

ChosenStep choose_step(const CriticalSteps& stable, const StepRules& rules);

/// Cost of a step with so many subcycles over that of one without.
double cost_of(int subcycles);

/// Longest step [s] while fabric that is still slack is drawn out to its length: its largest strain [-] and
/// the rate of that [1/s]. In 20 steps half of the slack is left, and what comes taut at last does so by half
/// a per cent in a step. Infinite where nothing is about to come taut.
double step_to_first_impact(double strain, double rate);

/// Longest step [s] while fabric chatters between taut and slack: `rate` [1/s] is how fast its largest strain
/// has changed lately. What an edge that comes taut within a step makes of an error grows with the square of
/// the strain that it overshoots by, a fifth of a per cent at most.
double step_in_impacts(double rate);

/// How much of its step a run is given, by what its energy balance loses and gains. An element that comes
/// taut at speed, or goes slack, within a step makes an error of the energy in proportion to that step: its
/// dashpot begins to act somewhere within, and is booked with the speed from before. It is not a matter of
/// stability, and no stiffness tells it. But impacts dissipate, which is known after every step: whenever a
/// little has been dissipated the balance is looked at.
class ImpactWatch {
public:
    double share() const { return share_; }
    /// Whether to look again with the next bound.
    bool alert() const { return share_ < 1.0; }
    /// Whether to look now. dissipated: since the start [J]; changed_hands: what the residual is held against
    /// [J].
    bool is_due(double dissipated, double changed_hands) const {
        return dissipated - dissipated_ > between_looks * changed_hands;
    }
    /// Impacts are about to begin: of fabric that has been folded until now.
    void expect() { share_ = expecting; }
    /// used_up: what does not add up over the largest residual at which a run goes on. What is used of it up
    /// to `tolerated` changes no step.
    void look(double used_up, double dissipated, double tolerated = 0.0);

    void serialize(Archive& archive) {
        for (double* x : {&share_, &used_up_, &dissipated_})
            archive.number("impacts", *x);
    }

private:
    static constexpr double expecting = 0.02, between_looks = 1e-3;

    double share_ = 1.0, used_up_ = 0.0, dissipated_ = 0.0;
};

}  // namespace twinchute::fullsim
