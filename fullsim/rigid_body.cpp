#include "fullsim/rigid_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/attitude.hpp"

namespace twinchute::fullsim {

RigidBody::RigidBody(BodyNodes nodes, double mass, const BodyMesh& body)
    : Body(nodes), mass_(mass), principal_(principal_axes(body.lumped)) {
    moments_ = (principal_.transpose() * body.lumped.inertia * principal_).diagonal();
    for (const Vec3& place : body.attachments())
        attachments_.emplace_back(principal_.transpose() * place);
}

void RigidBody::start(State& state, const Eigen::Matrix3d& frame) const {
    const Eigen::Quaterniond turn(Eigen::Matrix3d(frame * principal_));
    state.body = BodyState{attitude_of(turn)};
}

void RigidBody::pull(State& state) const {
    const Vec3 centre = to_vec3(state.node[nodes().payload].x);
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t k = 0; k < attachments_.size(); ++k) {
        const std::size_t i = attachment(k);
        const Vec3 force = to_vec3(state.force[i].value);
        sum += force;
        torque += (to_vec3(state.node[i].x) - centre).cross(force);
    }
    state.force[nodes().payload].value += to_lanes(sum);
    state.body->torque = torque;
}

void RigidBody::move(State& state, double kick, double dt) const {
    BodyState& body = *state.body;
    body.half_momentum += kick * body.torque;
    Eigen::Quaterniond turn = turn_of(body.attitude);
    Vec3 momentum = turn.conjugate() * body.half_momentum;  // along the body's own axes
    const auto about = [&](int axis, double time) {
        const double angle = time * momentum[axis] / moments_[axis];
        const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Vec3::Unit(axis)));
        turn = turn * q;
        momentum = q.conjugate() * momentum;
    };
    about(0, 0.5 * dt);
    about(1, 0.5 * dt);
    about(2, dt);
    about(1, 0.5 * dt);
    about(0, 0.5 * dt);
    turn.normalize();
    body.attitude = attitude_of(turn);
    body.momentum = body.half_momentum + 0.5 * dt * body.torque;
    place(state);
    for (std::size_t k = 0; k < attachments_.size(); ++k)
        state.force[attachment(k)].value = state.aero[attachment(k)].value = splat(0.0);
}

Vec3 RigidBody::spin_of(const BodyState& body) const {
    const Eigen::Matrix3d frame = turn_of(body.attitude).toRotationMatrix();
    const Vec3 own = frame.transpose() * body.momentum;
    return frame * own.cwiseQuotient(moments_);
}

void RigidBody::place(State& state) const {
    const BodyState& body = *state.body;
    const Eigen::Matrix3d frame = turn_of(body.attitude).toRotationMatrix();
    const Vec3 spin = spin_of(body);
    const NodeRecord& centre = state.node[nodes().payload];
    for (std::size_t k = 0; k < attachments_.size(); ++k) {
        const std::size_t i = attachment(k);
        const Vec3 arm = frame * attachments_[k];
        state.node[i] = {centre.x + to_lanes(arm), centre.v + to_lanes(spin.cross(arm))};
        state.v_half[i].value = state.node[i].v;
    }
}

double RigidBody::turning_energy(const BodyState& body) const {
    const Vec3 own = turn_of(body.attitude).conjugate() * body.momentum;
    return 0.5 * own.dot(own.cwiseQuotient(moments_));
}

double RigidBody::critical_step(double riser) const {
    double arm = 0.0;
    for (const Vec3& p : attachments_)
        arm = std::max(arm, p.norm());
    const double give = 1.0 / mass_ + arm * arm / moments_.minCoeff();
    // All attachments at once may pull on the same motion.
    const double all = 2.0 * riser * static_cast<double>(attachments_.size());
    return all > 0.0 ? 2.0 / std::sqrt(all * give) : infinity;
}

}  // namespace twinchute::fullsim
