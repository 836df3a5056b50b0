// A payload that turns, on its own: against closed forms of inertia, Euler's equations and a pendulum.
#include "fullsim/rigid_body.hpp"

#include <gsl/gsl_sf_elljac.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "fullsim/attitude.hpp"
#include "fullsim/time/central_difference.hpp"

namespace twinchute::fullsim {
namespace {

TEST(Solid, ABoxHasItsInertia) {
    // m (b^2 + c^2)/12 and so on; tetrahedra are integrated exactly, so only rounding is left.
    const double a = 0.6, b = 0.5, c = 0.9, mass = 152.4;
    const Lumped box = lump(solid_of(make_box({a, b, c}, {1, 2, 3})), mass);
    EXPECT_NEAR(box.volume, a * b * c, 1e-15);
    EXPECT_LT(box.centre.norm(), 1e-15);
    const Vec3 exact = mass / 12.0 * Vec3(b * b + c * c, a * a + c * c, a * a + b * b);
    EXPECT_LT((box.inertia.diagonal() - exact).norm(), 1e-13 * exact.norm());
    EXPECT_LT((box.inertia - Eigen::Matrix3d(box.inertia.diagonal().asDiagonal())).norm(),
              1e-13 * exact.norm());
}

TEST(Solid, InertiaMovesAndTurnsWithTheSolid) {
    // About its own centre of mass wherever it lies; J' = R J R^T. 1e-12: positions of 10 m, squared, over
    // 0.1 m2.
    const Solid box = solid_of(make_box({0.6, 0.5, 0.9}, {2, 1, 1}));
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Solid moved = box;
    for (Tetrahedron& t : moved)
        for (Vec3& x : t)
            x = turn * x + Vec3(3.0, -4.0, 8.0);
    const Lumped before = lump(box, 10.0), after = lump(moved, 10.0);
    EXPECT_LT((after.centre - Vec3(3.0, -4.0, 8.0)).norm(), 1e-13);
    EXPECT_LT((after.inertia - turn * before.inertia * turn.transpose()).norm(), 1e-12);
}

TEST(Solid, ACylinderConvergesAtSecondOrder) {
    // m R^2/2 and m (3 R^2 + h^2)/12. A regular prism misses its circle by O(1/n^2): halved, a quarter.
    const double diameter = 0.8, height = 1.1, mass = 3.0, r2 = 0.16;
    const Vec3 exact = mass / 12.0 * Vec3(3.0 * r2 + height * height, 3.0 * r2 + height * height, 6.0 * r2);
    double before = 0.0, volume_before = 0.0;
    for (const int sides : {12, 24, 48, 96}) {
        const Lumped prism = lump(solid_of(make_cylinder(diameter, height, sides, 2)), mass);
        const double error = (prism.inertia.diagonal() - exact).norm() / exact.norm();
        const double volume = 1.0 - prism.volume / (pi * r2 * height);
        EXPECT_LT((prism.inertia - Eigen::Matrix3d(prism.inertia.diagonal().asDiagonal())).norm(), 1e-14);
        if (before > 0.0) {
            EXPECT_NEAR(before / error, 4.0, 0.1);
            EXPECT_NEAR(volume_before / volume, 4.0, 0.1);
        }
        before = error;
        volume_before = volume;
    }
    EXPECT_LT(before, 2e-3);  // of what a run takes, as solid.hpp says
}

/// One node, which is the payload, and a dummy.
State still_state(std::size_t places = 0) {
    State state;
    state.node.assign(2 + places, {splat(0.0), splat(0.0)});
    state.v_half.assign(2 + places, {splat(0.0)});
    state.force.clear(2 + places);
    state.aero.clear(2 + places);
    state.body.emplace();
    return state;
}

/// Angular velocity along the body's own axes [rad/s].
Vec3 own_spin(const RigidBody& body, const BodyState& state) {
    return (turn_of(state.attitude).conjugate() * state.momentum).cwiseQuotient(body.moments());
}

/// State of a free body that begins to turn with `spin` about its own axes, after `time` in steps of `dt`
/// [s].
BodyState tumbled(const RigidBody& body, const Vec3& spin, double time, double dt,
                  const Eigen::Quaterniond& start = Eigen::Quaterniond::Identity()) {
    State state = still_state();
    state.body->attitude = attitude_of(start);
    state.body->momentum = state.body->half_momentum = start * spin.cwiseProduct(body.moments());
    const auto steps = static_cast<long>(std::lround(time / dt));
    for (long k = 0; k < steps; ++k)
        body.advance(state, dt, dt);
    return *state.body;
}

constexpr BodyNodes nodes{0, 2};

const RigidBody box(nodes, 30.0,
                    lump(solid_of(make_box({0.6, 0.9, 0.3}, {1, 1, 1})), 30.0).inertia.diagonal(), {});

/// Euler's equations of a free body with moments I1 < I2 < I3 and L^2 > 2 E I2, started in the plane of its
/// first and third axes (Landau and Lifshitz, Mechanics, 37).
Vec3 exact_spin(const Vec3& moments, const Vec3& start, double time) {
    const double I1 = moments[0], I2 = moments[1], I3 = moments[2];
    const Vec3 momentum = start.cwiseProduct(moments);
    const double twice = momentum.dot(start), square = momentum.squaredNorm();
    const double u = time * std::sqrt((I3 - I2) * (square - twice * I1) / (I1 * I2 * I3));
    const double m = (I2 - I1) * (twice * I3 - square) / ((I3 - I2) * (square - twice * I1));
    double sn = 0.0, cn = 0.0, dn = 0.0;
    gsl_sf_elljac_e(u, m, &sn, &cn, &dn);
    return {start[0] * cn, std::sqrt((twice * I3 - square) / (I2 * (I3 - I2))) * sn, start[2] * dn};
}

TEST(RigidBody, TumblesFreelyAsEulerSays) {
    // Axes in rising order of their moments. Steps of 50 us: 1e-6 after 10 s and six turns.
    const Vec3 sorted(box.moments()[1], box.moments()[0], box.moments()[2]);
    ASSERT_LT(sorted[0], sorted[1]);
    ASSERT_LT(sorted[1], sorted[2]);
    const RigidBody body(nodes, 30.0, sorted, {});
    const Vec3 start(1.5, 0.0, 3.0);
    ASSERT_GT(start.cwiseProduct(sorted).squaredNorm(), start.cwiseProduct(sorted).dot(start) * sorted[1]);
    const Vec3 exact = exact_spin(sorted, start, 10.0);
    const double error = (own_spin(body, tumbled(body, start, 10.0, 5e-5)) - exact).norm();
    EXPECT_LT(error, 1e-6 * start.norm());
    // Second order: a step forty times as long errs 1600 times as much, and one of eighty four times that.
    const double coarse = (own_spin(body, tumbled(body, start, 10.0, 2e-3)) - exact).norm();
    const double coarser = (own_spin(body, tumbled(body, start, 10.0, 4e-3)) - exact).norm();
    EXPECT_NEAR(coarser / coarse, 4.0, 0.2);
}

TEST(RigidBody, KeepsLengthMomentumAndEnergyOverAMillionSteps) {
    // About the middle axis, where it is unstable, so that it tumbles. Angular momentum in space is never
    // touched; the energy of a symplectic rule swings with (w dt)^2 and does not drift.
    const Vec3 start(4.0, 0.01, 0.02);
    State state = still_state();
    state.body->momentum = state.body->half_momentum = start.cwiseProduct(box.moments());
    const Vec3 momentum = state.body->momentum;
    const double energy = box.turning_energy(*state.body), dt = 1e-4;
    double worst_length = 0.0, worst_energy = 0.0;
    for (int k = 0; k < 1'000'000; ++k) {
        box.advance(state, dt, dt);
        if (k % 1000 != 0) continue;
        worst_length = std::max(worst_length, std::abs(turn_of(state.body->attitude).norm() - 1.0));
        worst_energy = std::max(worst_energy, std::abs(box.turning_energy(*state.body) / energy - 1.0));
    }
    EXPECT_LT(worst_length, 1e-15);
    EXPECT_EQ(state.body->momentum, momentum);
    EXPECT_LT(worst_energy, 1e-7);  // (4 rad/s 1e-4 s)^2 = 1.6e-7
}

TEST(RigidBody, TurnsWithTheWorld) {
    const Eigen::Quaterniond world(Eigen::AngleAxisd(1.1, Vec3(2, -1, 3).normalized()));
    const Vec3 spin(1.0, -2.0, 3.0);
    const BodyState plain = tumbled(box, spin, 1.0, 1e-3);
    const BodyState turned = tumbled(box, spin, 1.0, 1e-3, world);
    EXPECT_LT((turned.momentum - world * plain.momentum).norm(), 1e-13);
    EXPECT_LT(
        (turn_of(turned.attitude).toRotationMatrix() - (world * turn_of(plain.attitude)).toRotationMatrix())
            .norm(),
        1e-12);
}

/// A spring without mass that pulls `node` toward a point.
void pull(State& state, std::size_t node, const Vec3& to, double length, double stiffness) {
    const Vec3 d = to - to_vec3(state.node[node].x);
    state.force[node].value += to_lanes(stiffness * (d.norm() - length) * d.normalized());
}

TEST(RigidBody, SwingsAsADoublePendulum) {
    // A body on one riser below a fixed point, l long, b from its centre: for small angles
    //   M l q1'' + M b q2'' + M g q1 = 0,  M l b q1'' + (I + M b^2) q2'' + M g b q2 = 0.
    // Both modes to 0.1 %: the riser gives by M g/k = 1e-5 of l, angles of 0.01 change a period by 6e-6.
    const double mass = 150.0, l = 3.0, b = 0.45, g = 9.80665;
    const Vec3 moments = lump(solid_of(make_box({0.6, 0.6, 0.9}, {1, 1, 1})), mass).inertia.diagonal();
    const RigidBody body(nodes, mass, moments, {Vec3(0, 0, b)});
    Eigen::Matrix2d inertia, stiffness;
    inertia << mass * l, mass * b, mass * l * b, moments[1] + mass * b * b;
    stiffness << mass * g, 0.0, 0.0, mass * g * b;
    const Eigen::Matrix2d rates = inertia.inverse() * stiffness;
    const Eigen::EigenSolver<Eigen::Matrix2d> modes(rates);
    NodeConstants constants;
    constants.mass = {mass};
    constants.share = {0.0};
    constants.canopy_mass = constants.system_mass = mass;
    constants.gravity = g;
    for (int mode = 0; mode < 2; ++mode) {
        const double exact = std::sqrt(modes.eigenvalues()[mode].real());
        Eigen::Vector2d q = modes.eigenvectors().col(mode).real();
        q *= 0.01 / q.cwiseAbs().maxCoeff();
        State state = still_state(1);
        const double stretch = l * (1.0 + 1e-5), dt = 2e-4;
        // Angles from the vertical toward x, in the order of the equations.
        state.node[0].x = Lanes{stretch * std::sin(q[0]) + b * std::sin(q[1]), 0.0,
                                -stretch * std::cos(q[0]) - b * std::cos(q[1]), 0.0};
        state.body->attitude = attitude_of(Eigen::Quaterniond(Eigen::AngleAxisd(-q[1], Vec3::UnitY())));
        body.place(state);
        std::vector<double> crossings;
        double before = state.node[0].x[0];
        while (crossings.size() < 5) {
            pull(state, 2, Vec3::Zero(), l, mass * g / (1e-5 * l));
            body.pull(state);
            const double kick = 0.5 * (dt + state.dt);
            advance(state, constants, dt, 0.0);
            body.advance(state, kick, dt);
            state.time += dt;
            const double now = state.node[0].x[0];
            if (before * now < 0.0) crossings.push_back(state.time - dt * now / (now - before));
            before = now;
            ASSERT_LT(state.time, 60.0);
        }
        const double found = 4.0 * pi / (crossings[4] - crossings[0]);
        EXPECT_NEAR(found, exact, 1e-3 * exact) << "mode " << mode;
    }
}

TEST(RigidBody, KeepsMomentaWithWhatHangsOnIt) {
    // A body and a point mass on two springs, far from anything: no momentum comes or goes but by rounding.
    const RigidBody body(nodes, 30.0, box.moments(), {Vec3(0.3, 0.45, 0.15), Vec3(-0.3, 0.45, 0.15)});
    State state = still_state(2);
    state.node[1].x = Lanes{0.1, 2.0, 0.3, 0.0};  // the point mass, of 5 kg, in the dummy's place
    state.body->momentum = state.body->half_momentum = Vec3(3.0, -1.0, 2.0);
    state.v_half[1].value = state.node[1].v = Lanes{1.0, -2.0, 0.5, 0.0};
    body.place(state);
    NodeConstants constants;
    constants.mass = {30.0, 5.0};
    constants.share = {0.0, 0.0};
    constants.canopy_mass = constants.system_mass = 35.0;
    const auto momenta = [&] {
        Vec3 linear = Vec3::Zero(), angular = state.body->half_momentum;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 p = constants.mass[i] * to_vec3(state.v_half[i].value);
            linear += p;
            angular += to_vec3(state.node[i].x).cross(p);
        }
        return std::pair(linear, angular);
    };
    const auto [linear, angular] = momenta();
    const auto energy = [&] {
        double sum = body.turning_energy(*state.body);
        for (std::size_t i = 0; i < 2; ++i)
            sum += 0.5 * constants.mass[i] * to_vec3(state.node[i].v).squaredNorm();
        for (const std::size_t place : {2u, 3u})
            sum += 0.5 * 5e3 *
                   std::pow((to_vec3(state.node[1].x) - to_vec3(state.node[place].x)).norm() - 1.5, 2);
        return sum;
    };
    const double at_start = energy(), dt = 1e-4;
    double worst = 0.0;
    for (int k = 0; k < 50'000; ++k) {
        const Vec3 mass_at = to_vec3(state.node[1].x);
        for (const std::size_t place : {2u, 3u})
            pull(state, place, mass_at, 1.5, 5e3);
        state.force[1].value -= state.force[2].value + state.force[3].value;
        body.pull(state);
        const double kick = 0.5 * (dt + state.dt);
        advance(state, constants, dt, 0.0);
        body.advance(state, kick, dt);
        worst = std::max(worst, std::abs(energy() - at_start));
    }
    const auto [linear_end, angular_end] = momenta();
    EXPECT_LT((linear_end - linear).norm(), 1e-11 * linear.norm());
    EXPECT_LT((angular_end - angular).norm(), 1e-11 * angular.norm());
    // Velocities half a step on are extrapolated: that much of the springs' power over a step.
    EXPECT_LT(worst, 1e-3 * at_start);
}

}  // namespace
}  // namespace twinchute::fullsim
