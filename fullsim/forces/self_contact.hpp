// Self-contact as a layout sees it that keeps nodes elsewhere and hands over only those that it asks for.
#pragma once

#include <vector>

#include "fullsim/forces/force_model.hpp"

namespace twinchute::fullsim {

class SelfContact : public ForceModel {
public:
    /// Whether pairs that sleep sleep on: `moved_squared` is the square of the farthest [m^2] that a node
    /// before the payload has gone since the last look, relative to the mean of the canopy. False where that
    /// is not known to be far enough from touching, as where it is no number.
    virtual bool sleeps_on(const SelfContactState& contact, double moved_squared) const = 0;
    /// add_forces where sleeps_on holds: of the records of nodes it reads those alone that
    /// mark_awake_nodes marks.
    virtual void push_awake(State& state) const = 0;
    /// Marks nodes of pairs that may touch before the next look, and of those that these ask. marks: by node
    /// of the mesh.
    virtual void mark_awake_nodes(const SelfContactState& contact, std::vector<bool>& marks) const = 0;
};

}  // namespace twinchute::fullsim
