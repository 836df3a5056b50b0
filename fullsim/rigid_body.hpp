// A rigid payload that turns: it moves like the payload's node and turns about it; the points that risers are
// tied to go along.
#pragma once

#include <vector>

#include "fullsim/body.hpp"

namespace twinchute::fullsim {

class RigidBody final : public Body {
public:
    RigidBody(BodyNodes nodes, double mass, const BodyMesh& body);
    /// Any body: principal moments of inertia [kg m^2] about its own axes, attachments [m] from its centre of
    /// mass.
    RigidBody(BodyNodes nodes, double mass, const Vec3& moments, std::vector<Vec3> attachments)
        : Body(nodes), mass_(mass), moments_(moments), attachments_(std::move(attachments)) {}

    /// Positions of the risers' ends from the centre of mass, along the principal axes [m].
    const std::vector<Vec3>& attachments() const { return attachments_; }
    const Vec3& moments() const { return moments_; }

    void start(State& state, const Eigen::Matrix3d& frame) const override;

    /// Sets the torque of state.body as well.
    void pull(State& state) const override;

    /// The angular momentum as velocities by the central difference scheme, L += kick torque, and the
    /// attitude by turns about the principal axes one after the other, forth and back (Dullweber, Leimkuhler
    /// and McLachlan 1997, J. Chem. Phys. 107, 5840): of second order, exact in L, without drift in energy.
    /// The quaternion is brought to length 1 after each step. Nothing but risers turns the body.
    void move(State& state, double kick, double dt) const override;
    void finish(State& state, double) const override { place(state); }

    void place(State& state) const override;

    Vec3 spin(const State& state) const override { return spin_of(*state.body); }

    /// [J] of the turning.
    double inner_energy(const State& state) const override { return turning_energy(*state.body); }
    double turning_energy(const BodyState& body) const;

    /// 2 sqrt(m'/2 K) with the inertia m' that an attachment has across its arm, from below 1/m' = 1/m +
    /// r^2/I_min, of the subcycles; K (a - b)^2 <= 2 K a^2 + 2 K b^2 parts body and riser. What else acts on
    /// it does not grow as it moves.
    CriticalSteps critical_steps(const State&, const ForceModels&, double riser) const override {
        const double step = critical_step(riser);
        return {step, infinity, step};
    }
    double critical_step(double riser) const;

    /// [rad/s]
    Vec3 spin_of(const BodyState& body) const;

private:
    double mass_;   // [kg]
    Vec3 moments_;  // [kg m^2]
    std::vector<Vec3> attachments_;
    Eigen::Matrix3d principal_ = Eigen::Matrix3d::Identity();
};

}  // namespace twinchute::fullsim
