// A body that hangs on stiff risers in subcycles of a step: what is kept without them is kept with them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>

#include "fullsim/attitude.hpp"
#include "fullsim/deformable_body.hpp"
#include "fullsim/forces/tetrahedra.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/rigid_body.hpp"
#include "fullsim/time/subcycling.hpp"

namespace twinchute::fullsim {
namespace {

/// A mass on a soft spring, a link, and two stiff risers from there to a body that spins. Nothing acts from
/// outside and nothing dissipates.
class Hanging {
public:
    explicit Hanging(bool deformable) : deformable_(deformable) {
        mesh_.lumped = lump(solid_of(mesh_.solid), mass);
        mesh_.deformable = deformable;
        for (const double x : {0.3, -0.3})
            for (std::size_t i = 0; i < mesh_.solid.node.size(); ++i)
                if ((mesh_.solid.node[i] - Vec3(x, 0.45, 0.15)).norm() < 1e-9)
                    mesh_.end.push_back(static_cast<int>(i));
        constants_.mass = {1.0, 0.5, mass};
        constants_.share = {0.0, 0.0, 0.0};
        constants_.canopy_nodes = 1;
        constants_.canopy_mass = 1.0;
        constants_.system_mass = 1.5 + mass;
        const BodyNodes nodes{payload, attachments};
        if (deformable) {
            node_mass_ = node_masses(mesh_.solid, mass, mesh_.lumped);
            const SolidLaw law = solid_law({2e6, 0.3}, mass / mesh_.lumped.volume, 0.0, 0.0);
            tetrahedra_ = make_tetrahedra(mesh_.solid, law, attachments);
            body_ = std::make_unique<DeformableBody>(nodes, node_mass_, mesh_, law, 0.0);
        } else {
            body_ = std::make_unique<RigidBody>(nodes, mass, mesh_);
        }
        const std::vector<Vec3> places = mesh_.attachments();
        const std::size_t count = attachments + places.size();
        state_.node.assign(count, {splat(0.0), splat(0.0)});
        state_.v_half.assign(count, {splat(0.0)});
        state_.force.clear(count);
        state_.aero.clear(count);
        body_->start(state_, frame_along(Vec3::UnitZ()));
        const Vec3 spin(3.0, 0.5, 1.0);
        place(canopy, Vec3(0.2, 0.1, 2.9), Vec3(0.5, -1.0, 2.0));
        place(link, Vec3(0.1, 0.3, 1.6), Vec3(1.0, 0.0, -0.5));
        const Eigen::Matrix3d frame = start_frame();
        for (std::size_t k = 0; k < places.size(); ++k)
            place(attachments + k, frame * places[k], spin.cross(frame * places[k]));
        if (!deformable)
            state_.body->half_momentum = state_.body->momentum =
                frame * mesh_.lumped.inertia * frame.transpose() * spin;
        rest_ = {distance(canopy, link), distance(link, attachments + place_of(0)),
                 distance(link, attachments + place_of(1))};
        pulled_ = SubcycledNodes({link, payload}, attachments, places.size());
    }

    void step(double dt, int count) {
        spring(canopy, link, soft, 0.9 * rest_[0]);
        const LinePulls risers = [this](State& s) {
            for (std::size_t r = 0; r < 2; ++r)
                spring(link, attachments + place_of(r), stiff, rest_[1 + r]);
            body_->pull(s);
            return 0.0;
        };
        pulled_.note(state_, [&] { risers(state_); });
        if (tetrahedra_) tetrahedra_->add_forces(state_);
        if (count > 1) {
            advance_in_subcycles(state_, constants_, dt, count, 0.0, pulled_, 0.0, risers, body_.get());
        } else {
            const double kick = 0.5 * (dt + state_.dt);
            advance(state_, constants_, dt, 0.0);
            body_->advance(state_, kick, dt);
        }
    }

    std::array<Vec3, 2> momenta() const {
        Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
        const auto add = [&](std::size_t i, double m) {
            const Vec3 p = m * to_vec3(state_.v_half[i].value);
            linear += p;
            angular += to_vec3(state_.node[i].x).cross(p);
        };
        add(canopy, 1.0);
        add(link, 0.5);
        if (!deformable_) {
            add(payload, mass);
            return {linear, angular + state_.body->half_momentum};
        }
        for (std::size_t k = 0; k < node_mass_.size(); ++k)
            add(attachments + k, node_mass_[k]);
        return {linear, angular};
    }
    double energy() const {
        double sum = body_->inner_energy(state_) + (tetrahedra_ ? tetrahedra_->energy(state_) : 0.0);
        for (std::size_t i = 0; i < 3; ++i)
            sum += 0.5 * constants_.mass[i] * to_vec3(state_.node[i].v).squaredNorm();
        sum += stored(canopy, link, soft, 0.9 * rest_[0]);
        for (std::size_t r = 0; r < 2; ++r)
            sum += stored(link, attachments + place_of(r), stiff, rest_[1 + r]);
        return sum;
    }
    /// Places [m] of link, canopy and the last attachment.
    Eigen::Matrix3d shape() const {
        Eigen::Matrix3d all;
        all << to_vec3(state_.node[canopy].x), to_vec3(state_.node[link].x), to_vec3(state_.node.back().x);
        return all;
    }
    /// The payload's node less the centre of the body's own nodes [m].
    double apart() const {
        Vec3 centre = Vec3::Zero();
        for (std::size_t k = 0; k < node_mass_.size(); ++k)
            centre += node_mass_[k] / mass * to_vec3(state_.node[attachments + k].x);
        return (to_vec3(state_.node[payload].x) - centre).norm();
    }

private:
    static constexpr double mass = 30.0, soft = 2e3, stiff = 2e5;                   // [kg], [N/m]
    static constexpr NodeIndex canopy = 0, link = 1, payload = 2, attachments = 4;  // a dummy between

    std::size_t place_of(std::size_t riser) const { return static_cast<std::size_t>(mesh_.place_of(riser)); }
    Eigen::Matrix3d start_frame() const {
        return turn_of(state_.body->attitude).toRotationMatrix() * principal_axes(mesh_.lumped).transpose();
    }
    void place(std::size_t i, const Vec3& x, const Vec3& v) {
        state_.node[i] = {to_lanes(x), to_lanes(v)};
        state_.v_half[i].value = to_lanes(v);
    }
    double distance(std::size_t a, std::size_t b) const {
        return (to_vec3(state_.node[b].x) - to_vec3(state_.node[a].x)).norm();
    }
    double stored(std::size_t a, std::size_t b, double stiffness, double rest) const {
        return 0.5 * stiffness * std::pow(distance(a, b) - rest, 2);
    }
    void spring(std::size_t a, std::size_t b, double stiffness, double rest) {
        const Vec3 along = (to_vec3(state_.node[b].x) - to_vec3(state_.node[a].x)).normalized();
        const Lanes force = to_lanes(stiffness * (distance(a, b) - rest) * along);
        state_.force[a].value += force;
        state_.force[b].value -= force;
    }

    bool deformable_;
    BodyMesh mesh_{make_box({0.6, 0.9, 0.3}, {2, 3, 2}), {}, {}, false};
    std::vector<double> node_mass_;  // [kg]
    std::unique_ptr<const ForceModel> tetrahedra_;
    std::unique_ptr<const Body> body_;
    NodeConstants constants_;
    SubcycledNodes pulled_;
    std::array<double, 3> rest_{};  // [m] from canopy to link, and of the risers
    State state_;
};

// Risers of 2e5 N/m on a link of 0.5 kg: w = 900/s; the soft spring and the body's tetrahedra: at most 200/s.
constexpr double whole_step = 2e-3;  // [s] beyond the bound without subcycles, 2/w = 2.2e-3, with row sums

TEST(BodyInSubcycles, KeepsMomentaAndEnergy) {
    // Each impulse has its opposite at the same time and along the line between the two: only rounding is
    // left. The energy swings with what velocities that are extrapolated over half a step miss, and does not
    // drift: in the second half of the run it strays no farther than in the first.
    for (const bool deformable : {false, true}) {
        SCOPED_TRACE(deformable);
        Hanging hanging(deformable);
        const auto [linear, angular] = hanging.momenta();
        const double energy = hanging.energy();
        std::array<double, 2> strayed{};
        for (int k = 0; k < 20'000; ++k) {
            hanging.step(0.25 * whole_step, 4);
            strayed[k / 10'000] = std::max(strayed[k / 10'000], std::abs(hanging.energy() / energy - 1.0));
        }
        const auto [linear_end, angular_end] = hanging.momenta();
        EXPECT_LT((linear_end - linear).norm(), 1e-11 * linear.norm());
        EXPECT_LT((angular_end - angular).norm(), 1e-11 * angular.norm());
        EXPECT_LT(strayed[0], 0.02);
        EXPECT_LT(strayed[1], 1.2 * strayed[0]);
        EXPECT_TRUE(!deformable || hanging.apart() < 1e-9) << hanging.apart();
    }
}

TEST(BodyInSubcycles, IsOfSecondOrder) {
    // Against steps so short that their own error is a thousandth of the smallest one here. The deformable
    // body's own modes, up to 1400/s, ask for shorter ones.
    for (const bool deformable : {false, true}) {
        SCOPED_TRACE(deformable);
        const double end = deformable ? 0.05 : 0.2;
        const auto shape_after = [&](int steps, int count) {
            Hanging hanging(deformable);
            for (int k = 0; k < steps; ++k)
                hanging.step(end / steps, count);
            return hanging.shape();
        };
        const Eigen::Matrix3d exact = shape_after(51'200, 1);
        std::array<double, 3> error{};
        for (int level = 0; level < 3; ++level)
            error[level] = (shape_after(400 << level, 4) - exact).norm();
        EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1);
        EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.1);
    }
}

TEST(BodyInSubcycles, LetsTheWholeStepExceedTheRisersBound) {
    // Twice the bound of the link, which a step without subcycles does not survive.
    Hanging with(false), without(false);
    const double energy = with.energy();
    for (int k = 0; k < 500; ++k) {
        with.step(2.0 * whole_step, 4);
        without.step(2.0 * whole_step, 1);
    }
    EXPECT_NEAR(with.energy(), energy, 0.1 * energy);
    EXPECT_FALSE(without.energy() < 10.0 * energy);
}

}  // namespace
}  // namespace twinchute::fullsim
