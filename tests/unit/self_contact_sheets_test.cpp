// Self-contact of sheets that meet, are pressed together, slide and coincide: momentum, energy, friction.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/sheets.hpp"

namespace twinchute::fullsim {
namespace {

/// Two sheets of 0.6 m, 3 cm apart, that fly at each other at 1 m/s each, turned against each other and
/// sliding: with different meshes, so that no node meets a node.
Sheets meeting_sheets(double friction, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
    Sheets two(friction);
    const Vec3 x = turn * Vec3::UnitX(), y = turn * Vec3::UnitY(), z = turn * Vec3::UnitZ();
    const Vec3 u = (std::cos(0.3) * x + std::sin(0.3) * y), v = z.cross(u);
    two.add(6, 6, 0.1, Vec3(turn * Vec3(0.0, 0.0, 0.0)), x, y);
    two.add(5, 5, 0.12, Vec3(turn * Vec3(0.11, -0.13, 0.03)), u, v);
    two.finish();
    two.launch(0, [&](const Vec3& at) { return Vec3(turn * Vec3(0.0, 0.0, 1.0) + z.cross(at)); });
    two.launch(1, [&](const Vec3&) { return Vec3(turn * Vec3(0.5, 0.2, -1.0)); });
    return two;
}

TEST(SelfContact, SheetsThatMeetKeepMomentumAndAngularMomentum) {
    Sheets two = meeting_sheets(0.3);
    const double dt = 0.5 * two.critical();
    const Vec3 momentum = two.momentum(), angular = two.angular_momentum();
    double most = 0.0, deepest = 0.0;
    while (two.state.time < 0.06) {
        two.step(dt);
        most = std::max(most, two.structure[1]->energy(two.state));
        deepest = std::max(deepest, two.state.contact.deepest);
    }
    const double kinetic = two.state.energy.kinetic_start;
    EXPECT_GT(most, 0.05 * kinetic);        // they have met,
    EXPECT_GT(two.mean(1, true).z(), 0.3);  // thrown each other back
    EXPECT_LT(two.mean(0, true).z(), -0.3);
    EXPECT_GT(two.state.energy.damping, 0.01 * kinetic);  // and rubbed
    EXPECT_LT((two.momentum() - momentum).norm(), 1e-10 * momentum.norm());
    EXPECT_LT((two.angular_momentum() - angular).norm(), 1e-10 * angular.norm());
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(deepest, 0.1);
}

TEST(SelfContact, EnergyOfSheetsThatMeetAddsUp) {
    // The scheme's error falls with the square of the step while the sheets touch.
    double before = 0.0;
    for (const double share : {0.5, 0.25}) {
        Sheets two = meeting_sheets(0.3);
        const double dt = share * two.critical();
        double worst = 0.0;
        while (two.state.time < 0.06) {
            two.step(dt);
            const EnergyLedger ledger = energy_ledger(two.state, kinetic_energy(two.state, two.constants),
                                                      elastic_energy(two.state, two.structure));
            worst = std::max(worst, std::abs(residual(ledger)));
        }
        worst /= two.state.energy.kinetic_start;
        EXPECT_LT(worst, 0.05);
        if (before > 0.0) {
            EXPECT_LT(worst, 0.5 * before);
        }
        before = worst;
    }
}

TEST(SelfContact, TurnsWithTheWorld) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Sheets one = meeting_sheets(0.3), other = meeting_sheets(0.3, turn);
    const double dt = 0.5 * one.critical();
    while (one.state.time < 0.025) {
        one.step(dt);
        other.step(dt);
    }
    double worst = 0.0;
    for (NodeIndex i = 0; i < one.mesh.canopy_nodes; ++i)
        worst =
            std::max(worst, (turn * to_vec3(one.state.node[i].x) - to_vec3(other.state.node[i].x)).norm());
    // Round-off of 1e-16 grows with the folds of the sheets: 50 ms of them leave nine digits.
    EXPECT_LT(worst, 1e-9);
}

TEST(SelfContact, PressedSheetsCarryThePressureAndStayApart) {
    // 300 Pa on the upper of two sheets, the lower one as heavy as a table: the force between both is p S.
    Sheets two(0.0, 4e8);
    two.add(8, 8, 0.1, Vec3(-0.1, -0.1, 0.0), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.11, Vec3(0.03, 0.02, 0.002), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.hold(0);
    const double pressure = 300.0, area = 0.55 * 0.55;
    const auto press = [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i) {
            state.force[i].value[2] -= pressure * two.mesh.tributary_area[i];
            state.force[i].value -= 40.0 * two.mesh.mass[i] * state.node[i].v;  // settles
        }
    };
    // Closer than their thickness they begin without a force.
    two.structure[1]->add_forces(two.state);
    EXPECT_EQ(two.structure[1]->energy(two.state), 0.0);
    for (std::size_t i = 0; i < two.state.force.size(); ++i)
        EXPECT_EQ(to_vec3(two.state.force[i].value).norm(), 0.0);
    two.run(0.6, press);
    clear_forces(two.state);
    two.structure[1]->add_forces(two.state);
    double held = 0.0, lowest = 1.0;
    for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i) {
        held += two.state.force[i].value[2];
        lowest = std::min(lowest, two.state.node[i].x[2]);
    }
    EXPECT_NEAR(held, pressure * area, 1e-3 * pressure * area);
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(two.state.contact.deepest, 0.1);
}

/// A strip of 0.3 x 0.2 m on a table, under gravity at `angle` to its normal, sliding at v0: x [m] over time.
struct Slide {
    double distance, speed, dissipated, mass;
};
Slide slide(double friction, double angle, double v0, double time) {
    constexpr double g = 9.80665;
    Sheets two(friction);
    two.add(14, 5, 0.1, Vec3(-0.1, -0.15, 0.0), Vec3::UnitX(), Vec3::UnitY());
    two.add(3, 2, 0.1, Vec3(0.03, 0.02, 0.002), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.hold(0);
    const auto weigh = [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i)
            state.force[i].value +=
                two.mesh.mass[i] * to_lanes(g * Vec3(std::sin(angle), 0.0, -std::cos(angle)));
    };
    two.launch(1, [&](const Vec3&) { return Vec3(v0, 0.0, 0.0); });
    const double from = two.mean(1).x();
    two.run(time, weigh);
    EXPECT_EQ(two.state.contact.passed, 0);
    return {two.mean(1).x() - from, two.mean(1, true).x(), two.state.energy.damping, two.mass(1)};
}

TEST(SelfContact, AStripStopsAfterTheDistanceOfItsFriction) {
    const double v0 = 2.0, mu = 0.3, g = 9.80665, distance = v0 * v0 / (2.0 * mu * g);
    const Slide s = slide(mu, 0.0, v0, 1.2 * v0 / (mu * g));
    // Friction below mu N/c, some mm/s, is less than Coulomb's: that lengthens the way by less than a per
    // cent.
    EXPECT_NEAR(s.distance, distance, 0.01 * distance);
    EXPECT_LT(std::abs(s.speed), 0.01);
    EXPECT_NEAR(s.dissipated, 0.5 * s.mass * v0 * v0, 0.01 * 0.5 * s.mass * v0 * v0);
}

TEST(SelfContact, AStripSlidesDownAnInclineAsItsFrictionLetsIt) {
    const double mu = 0.3, g = 9.80665, steep = std::atan(0.6), time = 0.6;
    const Slide s = slide(mu, steep, 0.0, time);
    const double acceleration = g * (std::sin(steep) - mu * std::cos(steep));
    EXPECT_NEAR(s.speed, acceleration * time, 0.01 * acceleration * time);
    EXPECT_NEAR(s.distance, 0.5 * acceleration * time * time, 0.02 * 0.5 * acceleration * time * time);
    // Below the angle of friction it stays, but for a creep at g sin(angle) m/c.
    const Slide at_rest = slide(mu, std::atan(0.15), 0.0, 0.6);
    EXPECT_LT(at_rest.speed, 0.01);
}

TEST(SelfContact, CoincidentSheetsStartWithoutForceAndStayOnTheSideTheyTake) {
    Sheets two(0.2);
    two.add(5, 5, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.structure[1]->add_forces(two.state);
    for (std::size_t i = 0; i < two.state.force.size(); ++i)
        EXPECT_EQ(to_vec3(two.state.force[i].value).norm(), 0.0);
    // One leaves upwards, and comes back: it ends above.
    two.launch(1, [](const Vec3&) { return Vec3(0.0, 0.0, 0.5); });
    double highest = 0.0;
    two.run(0.2, [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i)
            state.force[i].value[2] -= 10.0 * two.mesh.mass[i];
        highest = std::max(highest, two.mean(1).z() - two.mean(0).z());
    });
    EXPECT_GT(highest, 0.01);
    EXPECT_GT(two.mean(1).z(), two.mean(0).z());
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(two.state.contact.deepest, 0.1);
}

}  // namespace
}  // namespace twinchute::fullsim
