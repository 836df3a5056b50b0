// Self-contact as a layout sees it that keeps nodes elsewhere and hands over only those that it asks for.
#pragma once

#include <vector>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/laws/linear_motion.hpp"

namespace twinchute::fullsim {

class SelfContact : public ForceModel {
public:
    /// Motion by which nodes have been expected to go since the last look.
    static LinearMotion motion(const State& state);
    /// Whether pairs that sleep sleep on: `strayed_squared` is the square of the farthest [m^2] that a node
    /// before the payload is from where it is expected, times its weight. False where that is not known to
    /// be far enough from touching, as where it is no number.
    virtual bool sleeps_on(const State& state, double strayed_squared) const = 0;
    /// add_forces where sleeps_on holds: of the records of nodes it reads those alone that
    /// mark_awake_nodes marks.
    virtual void push_awake(State& state) const = 0;
    /// Marks nodes of pairs that may touch before the next look, and of those that these ask. marks: by node
    /// of the mesh.
    virtual void mark_awake_nodes(const SelfContactState& contact, std::vector<bool>& marks) const = 0;
};

}  // namespace twinchute::fullsim
