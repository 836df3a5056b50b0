// Lines, links, risers and payload in smaller steps than the canopy: lines are stiff and light, and a step of
// theirs costs a tenth of one of everything.
//
// Forces of canopy and air on a node come as one impulse at the beginning of a step; under lines and risers
// alone it then takes its subcycles, and the canopy's own nodes one drift (impulse form of the method of
// multiple time steps, Tuckerman, Berne and Martyna 1992, here with the central difference scheme's half
// steps). A payload that is a body is advanced by the subcycles, too: its attachments follow the risers' pull
// at once, so that momenta are kept as without subcycles.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "fullsim/body.hpp"
#include "fullsim/time/central_difference.hpp"

namespace twinchute::fullsim {

/// Nodes that take subcycles and have their records in State.
class SubcycledNodes {
public:
    SubcycledNodes() = default;
    /// attachments: nodes of a body that moves itself, after the first of them.
    explicit SubcycledNodes(std::vector<NodeIndex> nodes, NodeIndex first_attachment = 0,
                            std::size_t attachments = 0)
        : nodes_(std::move(nodes)),
          first_attachment_(first_attachment),
          pull_(nodes_.size() + attachments),
          others_(nodes_.size()) {}

    const std::vector<NodeIndex>& nodes() const { return nodes_; }

    /// Keeps what `lines` adds to the nodes' forces.
    template <class Lines>
    void note(State& state, Lines&& lines) {
        const NodeForces::View force = state.force.view();
        for (std::size_t k = 0; k < pull_.size(); ++k)
            pull_[k].value = force[node(k)].value;
        lines();
        for (std::size_t k = 0; k < pull_.size(); ++k)
            pull_[k].value = force[node(k)].value - pull_[k].value;
    }
    /// Only that stays in the forces; the rest of attachments goes to state.aero.
    void take_others(State& state) {
        const NodeForces::View force = state.force.view(), aero = state.aero.view();
        for (std::size_t k = 0; k < pull_.size(); ++k) {
            Lanes& of_node = force[node(k)].value;
            const Lanes rest = of_node - pull_[k].value;
            if (k < nodes_.size())
                others_[k].value = rest;
            else
                aero[node(k)].value += rest;
            of_node = pull_[k].value;
        }
    }
    /// The rest [N], of node number k.
    Lanes others(std::size_t k) const { return others_[k].value; }

private:
    std::size_t node(std::size_t k) const {
        return k < nodes_.size() ? static_cast<std::size_t>(nodes_[k])
                                 : static_cast<std::size_t>(first_attachment_) + (k - nodes_.size());
    }

    std::vector<NodeIndex> nodes_;
    NodeIndex first_attachment_ = 0;
    std::vector<NodeVector> pull_, others_;  // [N]
};

/// Function of the line forces: adds them to a state's, and returns their dissipation [W].
using LinePulls = std::function<double(State&)>;

// The parts of advance_in_subcycles, each adding to `sums`.

/// Everything but lines, whose forces at t are in the state alone: `pulled` has the others.
void give_impulse(State& state, const NodeConstants& constants, double dt, int count, SubcycledNodes& pulled,
                  const Body* body, StepSums& sums);
/// damping: [W] that lines dissipate at the beginning of this subcycle.
void drift_in_subcycle(State& state, const NodeConstants& constants, const Subcycle& step,
                       const SubcycledNodes& pulled, double damping, const Body* body, StepSums& sums);
/// damping: [W] in the last one.
void end_subcycles(State& state, const NodeConstants& constants, double dt, int count,
                   const SubcycledNodes& pulled, double damping, const Body* body, StepSums& sums);

/// All nodes from time t to t + dt as advance in central_difference.hpp; those of `pulled` in `count` > 1
/// subcycles, with them the payload where it is a body. The forces at t are in the state, what lines
/// dissipate at t is `damping` [W].
void advance_in_subcycles(State& state, const NodeConstants& constants, double dt, int count,
                          double next_added_mass, SubcycledNodes& pulled, double damping,
                          const LinePulls& lines, const Body* body = nullptr);

/// A suspension line as waves run through it, from a node of the skirt to an end that stands still.
struct LineWaves {
    double stiffness = 0.0;          ///< EA/L of the whole line [N/m]; 0: there is none
    double lag = 0.0;                ///< dashpot over stiffness of its elements, the least [s]
    double mass = 0.0, share = 0.0;  ///< of the lightest node on the skirt: [kg], and of the added mass [-]
};

LineWaves line_waves(const Mesh& mesh, const NodeConstants& constants, double line_length,
                     double bulk_viscosity, double beta);

/// Longest step of the canopy [s] in which impulses do not make lines ring, however small their subcycles
/// are, by docs/theory/full-model.md, "Subcycling of lines": H^5 = pi^5 lag h^2 m/(8 EA/L), of which half is
/// taken. `canopy_bound`: h, the longest critical time step of the canopy without lines [s]. Infinite without
/// lines.
double resonance_limit(const LineWaves& line, double added_mass, double canopy_bound);

/// The subcycle number `k` of as many in a step of `dt` [s].
inline Subcycle subcycle(const SystemState& state, double dt, int count, int k) {
    const double length = dt / count;
    return {k == 0 ? 0.5 * (length + state.line_dt) : length, length};
}

}  // namespace twinchute::fullsim
