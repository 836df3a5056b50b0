// The central difference (leapfrog) step of a node on its record: what layouts share for the nodes that they
// do not move in lanes.
#pragma once

#include "fullsim/laws/node.hpp"
#include "fullsim/time/central_difference.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

/// A node from t to t + dt with its forces at t, which are cleared:
///   v^{n+1/2} = v^{n-1/2} + (dt^{n+1} + dt^n)/2 (f^n/m + g m_material/m),   x^{n+1} = x^n + dt^{n+1}
///   v^{n+1/2},
/// and v^{n+1} extrapolated by another half step of the same acceleration.
class NodeMover {
public:
    NodeMover(State& state, const NodeConstants& c, double dt)
        : state_(state),
          force_(state.force.view()),
          aero_(state.aero.view()),
          kick_(0.5 * (dt + state.dt)),
          dt_(dt),
          last_dt_(state.dt),
          last_line_dt_(state.line_dt),
          weighs_(state.energy.weighs),
          fall_{0.0, 0.0, -c.gravity, 0.0} {}

    double kick() const { return kick_; }

    /// Adds to the sums of power and momentum; returns the velocity at t, exact for the energy balance.
    [[gnu::always_inline]] Lanes move(std::size_t i, double mass, double inertia, StepSums& sums) {
        NodeRecord& node = state_.node[i];
        NodeVector &force_here = force_[i], &aero_here = aero_[i];
        const Lanes aero = aero_here.value;
        const Lanes weight = mass * fall_;
        const Lanes acceleration = (force_here.value + aero + weight) / splat(inertia);
        const Lanes before = state_.v_half[i].value;
        const Lanes after = law::kicked(before, acceleration, kick_);
        const Lanes middle = law::middle_of(before, after);
        sums.drag_power += work(aero, middle);
        sums.momentum += mass * middle;
        if (weighs_) weigh(inertia, before, last_dt_ * acceleration, aero + weight, middle, sums);
        state_.v_half[i].value = after;
        node.v = law::drift(node.x, after, acceleration, dt_, 0.5 * dt_);
        force_here.value = aero_here.value = splat(0.0);
        return middle;
    }
    // A node that takes subcycles, see subcycles.hpp: the impulse of everything but lines and risers, some
    // subcycles under these, the end of the step.
    /// The velocity alone changes, by `force` [N] and what is in `aero`, where the acceleration stays for
    /// end_subcycles. Works as in move: the first subcycle's kick [s] under state.force comes at the same
    /// time.
    Lanes kick_alone(std::size_t i, Lanes force, double mass, double inertia, double first_kick,
                     StepSums& sums) {
        const Lanes aero = aero_[i].value;
        const Lanes acceleration = (force + aero + mass * fall_) / splat(inertia);
        const Lanes before = state_.v_half[i].value;
        const Lanes after = law::kicked(before, acceleration, kick_);
        const Lanes middle = law::middle_of(before, after + first_kick * force_[i].value / splat(inertia));
        sums.drag_power += work(aero, middle);
        sums.momentum += mass * middle;
        if (weighs_)
            weigh(inertia, before, last_dt_ * acceleration + last_line_dt_ * force_[i].value / splat(inertia),
                  aero + mass * fall_, middle, sums);
        state_.v_half[i].value = after;
        aero_[i].value = acceleration;
        return middle;
    }
    void move_in_subcycle(std::size_t i, double inertia, const Subcycle& step) {
        NodeRecord& node = state_.node[i];
        const Lanes acceleration = force_[i].value / splat(inertia);
        const Lanes after = law::kicked(state_.v_half[i].value, acceleration, step.kick);
        state_.v_half[i].value = after;
        node.v = law::drift(node.x, after, acceleration, step.dt, 0.5 * step.dt);
        force_[i].value = splat(0.0);
    }
    void end_subcycles(std::size_t i) {
        state_.node[i].v += (0.5 * dt_) * aero_[i].value;
        aero_[i].value = splat(0.0);
    }
    [[gnu::always_inline]] void move_other(std::size_t i, double mass, StepSums& sums) {
        move(i, mass, mass, sums);
        add_other(i, mass, sums);
    }
    [[gnu::always_inline]] void add_other(std::size_t i, double mass, StepSums& sums) const {
        sums.other_position += mass * state_.node[i].x;
        sums.other_velocity += mass * state_.node[i].v;
    }
    [[gnu::always_inline]] void add_canopy(std::size_t i, const NodeConstants& c, StepSums& sums) const {
        sums.canopy_position += c.mass[i] * state_.node[i].x;
        sums.canopy_velocity += c.mass[i] * state_.node[i].v;
        sums.area_velocity += c.share[i] * state_.node[i].v;
    }
    /// Some nodes that are not of the canopy.
    void move_others(const std::vector<NodeIndex>& nodes, const NodeConstants& c, StepSums& sums);
    /// Falls with the rest, but is not of the system; what its anchor pulls is work from outside.
    void move_static_line(const NodeConstants& c, StepSums& sums);

private:
    [[gnu::always_inline]] void weigh(double inertia, Lanes before, Lanes change, Lanes booked, Lanes middle,
                                      StepSums& sums) const {
        sums.kinetic += 0.5 * sum3(law::twice_kinetic(inertia, before, change, last_dt_, booked, middle));
    }

    State& state_;
    NodeForces::View force_, aero_;
    double kick_, dt_;
    double last_dt_, last_line_dt_;  // [s] of the step before
    bool weighs_;
    Lanes fall_;
};

}  // namespace twinchute::fullsim
