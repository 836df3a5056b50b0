#include "fullsim/deformable_body.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "fullsim/attitude.hpp"
#include "fullsim/laws/node.hpp"
#include "fullsim/time/critical_step.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

constexpr int weight_iterations = 20;  // within some per cent of the best that row sums can say
constexpr double least_weight = 1e-3;

}  // namespace

DeformableBody::DeformableBody(BodyNodes nodes, std::vector<double> masses, const BodyMesh& body,
                               const SolidLaw& law, double gravity)
    : Body(nodes),
      node_mass_(std::move(masses)),
      mass_(std::accumulate(node_mass_.begin(), node_mass_.end(), 0.0)),
      rest_(body.solid.node),
      end_(body.end),
      pulled_(body.end),
      principal_(principal_axes(body.lumped)),
      gravity_(gravity) {
    std::ranges::sort(pulled_);
    pulled_.erase(std::unique(pulled_.begin(), pulled_.end()), pulled_.end());
    weigh_rows(body, law);
}

/// Power iterations on the matrix of norms: each row's weight times where it stands.
void DeformableBody::weigh_rows(const BodyMesh& body, const SolidLaw& law) {
    State still;
    for (const Vec3& x : rest_)
        still.node.push_back({to_lanes(x), splat(0.0)});
    const auto tetrahedra = make_tetrahedra(body.solid, law, 0);
    weight_.assign(rest_.size(), 1.0);
    for (int k = 0; k < weight_iterations; ++k) {
        GershgorinSums sums = no_rows(still, weight_);
        tetrahedra->add_row_sums(still, sums);
        for (std::size_t i = 0; i < weight_.size(); ++i)
            weight_[i] *= sums.stiffness[i] / node_mass_[i];
        const double largest = *std::ranges::max_element(weight_);
        for (double& w : weight_)
            w = std::max(w / largest, least_weight);
    }
}

void DeformableBody::start(State& state, const Eigen::Matrix3d& frame) const {
    const Eigen::Quaterniond turn(Eigen::Matrix3d(frame * principal_));
    state.body = BodyState{attitude_of(turn)};
}

void DeformableBody::pull(State& state) const {
    Lanes sum = splat(0.0);
    for (const int k : pulled_)
        sum += state.force[attachment(static_cast<std::size_t>(k))].value;
    state.force[nodes().payload].value += sum;
}

void DeformableBody::impulse(State& state, double kick) const {
    const Lanes fall{0.0, 0.0, -gravity_, 0.0};
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const std::size_t i = attachment(k);
        Lanes& acceleration = state.aero[i].value;
        acceleration = acceleration / splat(node_mass_[k]) + fall;
        state.v_half[i].value = law::kicked(state.v_half[i].value, acceleration, kick);
    }
}

void DeformableBody::move(State& state, double kick, double dt) const {
    Lanes mean = splat(0.0);
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const std::size_t i = attachment(k);
        Lanes& acceleration = state.force[i].value;
        acceleration = acceleration / splat(node_mass_[k]);
        state.v_half[i].value = law::kicked(state.v_half[i].value, acceleration, kick);
        mean += node_mass_[k] / mass_ * state.v_half[i].value;
    }
    const Lanes together = state.v_half[nodes().payload].value - mean;
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const std::size_t i = attachment(k);
        Lanes& half = state.v_half[i].value;
        half += together;
        const Lanes acceleration = std::exchange(state.force[i].value, splat(0.0));
        state.node[i].v = law::drift(state.node[i].x, half, acceleration, dt, 0.5 * dt);
    }
}

void DeformableBody::finish(State& state, double dt) const {
    Lanes mean = splat(0.0);
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const std::size_t i = attachment(k);
        state.node[i].v += (0.5 * dt) * std::exchange(state.aero[i].value, splat(0.0));
        mean += node_mass_[k] / mass_ * state.node[i].v;
    }
    const Lanes together = state.node[nodes().payload].v - mean;
    for (std::size_t k = 0; k < node_mass_.size(); ++k)
        state.node[attachment(k)].v += together;
    turn(state);
}

void DeformableBody::turn(State& state) const {
    const Vec3 centre = to_vec3(state.node[nodes().payload].x);
    Eigen::Matrix3d shape = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const std::size_t i = attachment(k);
        shape += node_mass_[k] * (to_vec3(state.node[i].x) - centre) * rest_[k].transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(shape, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d turned = svd.matrixU() * svd.matrixV().transpose();
    if (turned.determinant() < 0.0) {
        Eigen::Matrix3d u = svd.matrixU();
        u.col(2) *= -1.0;
        turned = u * svd.matrixV().transpose();
    }
    const Eigen::Quaterniond q(Eigen::Matrix3d(turned * principal_));
    state.body->attitude = attitude_of(q);
}

double DeformableBody::inner_energy(const State& state) const {
    const Lanes mean = state.node[nodes().payload].v;
    double twice = 0.0;
    for (std::size_t k = 0; k < node_mass_.size(); ++k) {
        const Lanes v = state.node[attachment(k)].v - mean;
        twice += node_mass_[k] * sum3(v * v);
    }
    return 0.5 * twice;
}

double DeformableBody::critical_step(const State& state, const ForceModels& structure, double riser) const {
    const std::size_t first = attachment(0);
    std::vector<double> weights(state.node.size(), 1.0);
    std::ranges::copy(weight_, weights.begin() + nodes().first_attachment);
    GershgorinSums sums = no_rows(state, weights);
    for (const auto& model : structure)
        if (model->block() == Block::payload_tetrahedra) model->add_row_sums(state, sums);
    // K (a - b)^2 <= 2 K a^2 + 2 K b^2 parts body and riser, whose other node has the same in its own row.
    for (const int k : end_)
        sums.stiffness[first + static_cast<std::size_t>(k)] += 2.0 * riser;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < node_mass_.size(); ++k)
        least = std::min(least,
                         critical_step_of(sums.stiffness[first + k], sums.damping[first + k], node_mass_[k]));
    return least;
}

}  // namespace twinchute::fullsim
