// The explicit midpoint rule (paper, Eqs 8 and 9), and the sums that come with a pass over nodes.
#pragma once

#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// What the node update needs that does not change.
struct NodeConstants {
    std::vector<double> mass;   ///< [kg] material, payload included
    std::vector<double> share;  ///< [-] of the added mass; zero outside the canopy
    NodeIndex canopy_nodes = 0;
    double canopy_mass = 0.0;              ///< [kg]
    double system_mass = 0.0;              ///< [kg]
    double gravity = 0.0;                  ///< [m/s^2]
    std::size_t places = 0;                ///< of risers on a body, which nothing accelerates here
    std::vector<double> static_line_mass;  ///< [kg] the far end last, which keeps its velocity

    /// Index of its first node: after the dummy and the places.
    std::size_t first_static_line() const { return mass.size() + 1 + places; }
};

NodeConstants node_constants(const Mesh& mesh, double gravity);

/// Sums over nodes of one step, for reference velocities and books.
struct StepSums {
    Lanes canopy_position = splat(0.0), canopy_velocity = splat(0.0);  ///< after the step, times mass
    Lanes other_position = splat(0.0), other_velocity = splat(0.0);    ///< of what is not canopy
    Lanes area_velocity = splat(0.0);                                  ///< times share
    Lanes drag_power = splat(0.0), momentum = splat(0.0);  ///< by component, at the time of the forces
    double share_square = 0.0;        ///< of share times speed squared, likewise [m^2/s^2]
    double kinetic = 0.0;             ///< [J] likewise, where State.energy.weighs
    double line_damping = 0.0;        ///< [J] by lines and risers in substeps
    double line_damping_power = 0.0;  ///< [W] in the last of them, by its part of the step
};

/// A step of lines and risers within one of the canopy.
struct Substep {
    double kick = 0.0;  ///< [s] from the middle of the one before to its own
    double dt = 0.0;    ///< [s]
};

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
        const Lanes after = before + kick_ * acceleration;
        const Lanes middle = 0.5 * (before + after);
        sums.drag_power += aero * middle;
        sums.momentum += mass * middle;
        if (weighs_)
            weigh(inertia, before, last_dt_ * acceleration, (aero + weight) * (middle - before), sums);
        state_.v_half[i].value = after;
        node.x += dt_ * after;
        node.v = after + (0.5 * dt_) * acceleration;
        force_here.value = aero_here.value = splat(0.0);
        return middle;
    }
    // A node that takes substeps, see substeps.hpp: the impulse of everything but lines and risers, some
    // substeps under these, the end of the step.
    /// The velocity alone changes, by `force` [N] and what is in `aero`, where the acceleration stays for
    /// end_substeps. Works as in move: the first substep's kick [s] under state.force comes at the same time.
    Lanes kick_alone(std::size_t i, Lanes force, double mass, double inertia, double first_kick,
                     StepSums& sums) {
        const Lanes aero = aero_[i].value;
        const Lanes acceleration = (force + aero + mass * fall_) / splat(inertia);
        const Lanes before = state_.v_half[i].value;
        const Lanes after = before + kick_ * acceleration;
        const Lanes middle = 0.5 * (before + after + first_kick * force_[i].value / splat(inertia));
        sums.drag_power += aero * middle;
        sums.momentum += mass * middle;
        if (weighs_)
            weigh(inertia, before, last_dt_ * acceleration + last_line_dt_ * force_[i].value / splat(inertia),
                  (aero + mass * fall_) * (middle - before), sums);
        state_.v_half[i].value = after;
        aero_[i].value = acceleration;
        return middle;
    }
    void move_in_substep(std::size_t i, double inertia, const Substep& step) {
        NodeRecord& node = state_.node[i];
        const Lanes acceleration = force_[i].value / splat(inertia);
        const Lanes after = state_.v_half[i].value + step.kick * acceleration;
        state_.v_half[i].value = after;
        node.x += step.dt * after;
        node.v = after + (0.5 * step.dt) * acceleration;
        force_[i].value = splat(0.0);
    }
    void end_substeps(std::size_t i) {
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
    /// Falls with the rest, but is not of the system; what its far end pulls is work from outside.
    void move_static_line(const NodeConstants& c, StepSums& sums);

private:
    /// See ledger_before. change: [m/s] of the velocity by the forces at t over the step that led there;
    /// ahead: [W] by which drag and weight are booked with more than their power half a step before.
    void weigh(double inertia, Lanes before, Lanes change, Lanes ahead, StepSums& sums) const {
        sums.kinetic += 0.5 * sum3(inertia * before * (before + change) + last_dt_ * ahead);
    }

    State& state_;
    NodeForces::View force_, aero_;
    double kick_, dt_;
    double last_dt_, last_line_dt_;  // [s] of the step before
    bool weighs_;
    Lanes fall_;
};

/// Renews state.sums and books gravity, drag and damping work, and the work of the added mass's growth from
/// state.added_mass to `next_added_mass`. line_dt: [s] of the last substep.
void finish_step(State& state, const NodeConstants& constants, const StepSums& sums, double kick, double dt,
                 double line_dt, double next_added_mass);

/// All nodes from time t to t + dt with the forces in state.force and state.aero at t, and finish_step.
void advance(State& state, const NodeConstants& constants, double dt, double next_added_mass);

/// state.sums from the node records.
void update_sums(State& state, const NodeConstants& constants);

}  // namespace twinchute::fullsim
