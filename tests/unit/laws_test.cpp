// The laws of one element, in their scalar instance, beside the same typed by hand: lengths by norms and
// roots, principal strains by an eigenvalue solver, forces as differences of energies. Layouts are compared
// with the instance of these laws on the state's own records (tests/contract); this is what holds the laws
// themselves.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "fullsim/laws/cable.hpp"
#include "fullsim/laws/contact.hpp"
#include "fullsim/laws/critical_step.hpp"
#include "fullsim/laws/cylinder_drag.hpp"
#include "fullsim/laws/fabric_spring.hpp"
#include "fullsim/laws/membrane.hpp"
#include "fullsim/laws/node.hpp"
#include "fullsim/laws/pressure.hpp"

namespace twinchute::fullsim {
namespace {

namespace law = HWY_NAMESPACE;

// --- membrane ------------------------------------------------------------------------------------

const MembraneLaw fabric{3.0e4, 3.0e4 / (1.0 - 0.14 * 0.14), 0.14, 0.0};
constexpr double a = 0.7, b = 0.2, c = 0.5;  // the unstrained triangle: (0, 0), (a, 0), (b, c) [m]

using Corners = std::array<Vec3, 3>;

/// Pipkin's relaxed energy [J] from the principal values of (F^T F - 1)/2.
double energy_by_hand(const Corners& x) {
    Eigen::Matrix<double, 3, 2> now, f;
    now << x[1] - x[0], x[2] - x[0];
    Eigen::Matrix2d before;
    before << a, b, 0.0, c;
    f = now * before.inverse();
    const Eigen::Matrix2d strain = 0.5 * (f.transpose() * f - Eigen::Matrix2d::Identity());
    const Eigen::Vector2d e = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(strain).eigenvalues();
    const double second = e[0], first = e[1], nu = fabric.poisson, area = 0.5 * a * c;
    if (first <= 0.0) return 0.0;
    if (second + nu * first <= 0.0) return area * 0.5 * fabric.tension_modulus * first * first;
    return area * 0.5 * fabric.plane_modulus * (first * first + second * second + 2.0 * nu * first * second);
}

law::CornerPulls<double, Vec3> pulls_of(const Corners& x, const Corners& v, double viscosity) {
    const Vec3 e1 = x[1] - x[0], e2 = x[2] - x[0], w1 = v[1] - v[0], w2 = v[2] - v[0];
    return law::membrane_pulls(fabric, 1.0 / a, 1.0 / c, b / a, 0.5 * a * c, viscosity, e1, e2, w1, w2);
}

class MembraneLaws : public testing::TestWithParam<Corners> {};

TEST_P(MembraneLaws, ForcesAreTheDerivativeOfTheRelaxedEnergy) {
    const Corners x = GetParam();
    const auto pulls = pulls_of(x, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, 0.0);
    const Corners on{pulls.on_first, -pulls.on_second, -pulls.on_third};
    const double h = 1e-6;  // [m] of 0.5: truncation (h/l)^2 and rounding eps l/h are both below 1e-8
    double scale = 1.0;
    for (const Vec3& f : on)
        scale = std::max(scale, f.norm());
    for (int corner = 0; corner < 3; ++corner)
        for (int k = 0; k < 3; ++k) {
            Corners more = x, less = x;
            more[corner][k] += h;
            less[corner][k] -= h;
            const double expected = -(energy_by_hand(more) - energy_by_hand(less)) / (2.0 * h);
            EXPECT_NEAR(on[corner][k], expected, 1e-6 * scale) << corner << " " << k;
        }
}

TEST_P(MembraneLaws, BulkViscosityTakesPowerOutOfTheMotion) {
    const Corners x = GetParam();
    const Corners v{Vec3(0.3, -0.2, 0.1), Vec3(1.0, 0.4, -0.5), Vec3(-0.6, 0.9, 0.2)};
    const auto with = pulls_of(x, v, 5.0), without = pulls_of(x, v, 0.0);
    const double power = (with.on_first - without.on_first).dot(v[0]) -
                         (with.on_second - without.on_second).dot(v[1]) -
                         (with.on_third - without.on_third).dot(v[2]);
    EXPECT_NEAR(with.dissipated, -power, 1e-12 * (1.0 + std::abs(power)));
    EXPECT_GE(with.dissipated, 0.0);
    // By hand, eta A rate^2: the rate is the trace of the strain rate where taut, along the tension field
    // where wrinkled; a slack triangle has none.
    Eigen::Matrix<double, 3, 2> now, moving;
    now << x[1] - x[0], x[2] - x[0];
    moving << v[1] - v[0], v[2] - v[0];
    Eigen::Matrix2d before;
    before << a, b, 0.0, c;
    const Eigen::Matrix<double, 3, 2> f = now * before.inverse(), g = moving * before.inverse();
    const Eigen::Matrix2d rate = 0.5 * (f.transpose() * g + g.transpose() * f);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> strain(
        0.5 * (f.transpose() * f - Eigen::Matrix2d::Identity()));
    const double second = strain.eigenvalues()[0], first = strain.eigenvalues()[1];
    const Eigen::Vector2d along = strain.eigenvectors().col(1);
    const double seen = first <= 0.0                             ? 0.0
                        : second + fabric.poisson * first <= 0.0 ? along.dot(rate * along)
                                                                 : rate.trace();
    EXPECT_NEAR(with.dissipated, 5.0 * 0.5 * a * c * seen * seen, 1e-10 * (1.0 + with.dissipated));
}

INSTANTIATE_TEST_SUITE_P(States, MembraneLaws,
                         testing::Values(
                             // taut both ways, and turned out of the plane
                             Corners{Vec3(0.1, 0.2, 0.3), Vec3(0.85, 0.25, 0.3), Vec3(0.31, 0.75, 0.4)},
                             // wrinkled: stretched along x, narrower across
                             Corners{Vec3(0.0, 0.0, 0.0), Vec3(0.75, 0.0, 0.0), Vec3(0.2, 0.4, 0.1)},
                             // slack
                             Corners{Vec3(0.0, 0.0, 0.0), Vec3(0.5, 0.1, 0.0), Vec3(0.1, 0.3, 0.0)}));

TEST(MembraneLaw, StiffensAsStVenantKirchhoff) {
    // Stretched to lambda along x alone: the tangent of S = E_t (lambda^2 - 1)/2 in lambda, P = lambda S, is
    // dP/dlambda = E_t (3 lambda^2 - 1)/2 = E_t (1 + 3 E_1).
    const double lambda = 1.2, green = 0.5 * (lambda * lambda - 1.0);
    const auto by = law::membrane_stiffening(law::SymmetricTensor<double>{green, 0.0, 0.0});
    EXPECT_DOUBLE_EQ(by.stiffness, 0.5 * (3.0 * lambda * lambda - 1.0));
    EXPECT_DOUBLE_EQ(by.damping, lambda * lambda);
    const auto slack = law::membrane_stiffening(law::SymmetricTensor<double>{-0.1, -0.2, 0.0});
    EXPECT_DOUBLE_EQ(slack.stiffness, 1.0);
}

// --- along a span ----------------------------------------------------------------------------------

const Vec3 d(0.6, -0.5, 1.1), w(2.0, 0.4, -0.3);

TEST(CableLaw, PullsByEngineeringStrainAndItsRate) {
    const double length = d.norm(), rate = d.dot(w) / length, rest = 1.3, stiffness = 900.0, dashpot = 7.0;
    const auto pull = law::cable_pull(1.0 / rest, stiffness, dashpot, d, w);
    const double spring = stiffness * (length - rest) / rest, tension = spring + dashpot * rate;
    ASSERT_GT(tension, 0.0);
    EXPECT_NEAR(pull.spring, spring, 1e-12 * stiffness);
    EXPECT_LT((pull.force - tension * d / length).norm(), 1e-12 * stiffness);
    EXPECT_NEAR(pull.dissipated, dashpot * rate * rate, 1e-10);
    EXPECT_NEAR(law::cable_energy(0.02), 0.5 * 0.02 * 0.02, 1e-18);
    EXPECT_EQ(law::cable_energy(-0.02), 0.0);
}

TEST(CableLaw, NeverPushes) {
    const Vec3 shut = -40.0 * d;  // its dashpot would push
    const auto taut = law::cable_pull(1.0 / 1.3, 900.0, 7.0, d, shut);
    EXPECT_EQ(taut.force.norm(), 0.0);
    // The tension that is cut off dissipates: the spring lets go of what it held.
    EXPECT_NEAR(taut.dissipated, -taut.spring * d.dot(shut) / d.norm(), 1e-9);
    const auto slack = law::cable_pull(1.0 / 2.0, 900.0, 0.0, d, w);
    EXPECT_EQ(slack.force.norm(), 0.0);
    EXPECT_LT(slack.spring, 0.0);
}

TEST(FabricSpringLaw, TensionIsTheDerivativeOfItsEnergy) {
    const double hardening = 40.0, repulsion = 0.01, h = 1e-6;
    for (const double strain : {-0.4, -0.01, 0.01, 0.03, 0.08}) {
        law::Span<double, Vec3> span{d, d.squaredNorm(), 1.0 / d.norm(), 0.0};
        const double tension = law::spring_tension(span, strain, 1.0, hardening, 0.0, repulsion).tension;
        const double expected = (law::spring_energy(strain + h, hardening, repulsion) -
                                 law::spring_energy(strain - h, hardening, repulsion)) /
                                (2.0 * h);
        EXPECT_NEAR(tension, expected, 1e-8) << strain;
        // By hand: EA (e + g e^2) to the strain to which it hardens, a straight line from there on.
        const double low = std::min(strain, full_hardening_strain);
        const double by_hand = strain < 0.0
                                   ? repulsion * strain
                                   : low + hardening * low * low +
                                         (strain - low) * (1.0 + 2.0 * hardening * full_hardening_strain);
        EXPECT_NEAR(tension, by_hand, 1e-14) << strain;
        if (strain > 0.0) {
            const double slope =
                (law::spring_tension(span, strain + h, 1.0, hardening, 0.0, repulsion).tension - tension) / h;
            EXPECT_NEAR(law::spring_tangent(strain, hardening), slope, 1e-3) << strain;
        }
    }
}

TEST(FoldLaw, HoldsOnlyWhatIsFoldedAndLengthens) {
    const auto hold = [](double strain, double rate) {
        const law::Span<double, Vec3> span{d, d.squaredNorm(), 1.0 / d.norm(), rate};
        return law::fold_tension(span, strain, 12.0);
    };
    EXPECT_EQ(hold(0.1, 3.0).tension, 0.0);
    EXPECT_EQ(hold(-0.1, -3.0).tension, 0.0);
    EXPECT_DOUBLE_EQ(hold(-0.1, 3.0).tension, 12.0);
    EXPECT_DOUBLE_EQ(hold(-0.1, 3.0).dissipated, 36.0);
    EXPECT_DOUBLE_EQ(hold(-0.1, 0.25 * full_fold_speed).tension, 3.0);
}

// --- contact ---------------------------------------------------------------------------------------

TEST(ContactLaw, ForcesAreTheDerivativeOfItsEnergy) {
    const Vec3 axis = Vec3(0.1, -0.2, 1.0).normalized(), centre(0.2, 0.1, -0.3);
    const double stiffness = 800.0, h = 1e-6;
    // E = K b^2/(2 (w^2 + p^2)), typed by hand.
    const auto energy = [&](const Vec3& first, const Vec3& second) {
        const Vec3 arm = 0.5 * (first + second) - centre, along = second - first, u = axis.cross(arm);
        const double behind = std::max(0.0, -along.dot(u));
        const Vec3 across = along - along.dot(axis) * axis;
        return 0.5 * stiffness * behind * behind / (u.squaredNorm() + across.squaredNorm());
    };
    const Vec3 first(1.2, 0.3, 0.1), second(1.1, 0.2, 0.4);
    const Vec3 arm = first - centre, apart = second - first;
    const auto push = law::contact_push(stiffness, axis, law::contact_arm(0.0, axis, arm, apart));
    ASSERT_GT(push.energy, 0.0);
    EXPECT_NEAR(push.energy, energy(first, second), 1e-12 * push.energy);
    for (int k = 0; k < 3; ++k) {
        Vec3 step = Vec3::Zero();
        step[k] = h;
        const double on_first = -(energy(first + step, second) - energy(first - step, second)) / (2.0 * h);
        const double on_second = -(energy(first, second + step) - energy(first, second - step)) / (2.0 * h);
        EXPECT_NEAR(push.apart[k] - push.half_of_middle[k], on_first, 1e-6);
        EXPECT_NEAR(-push.apart[k] - push.half_of_middle[k], on_second, 1e-6);
    }
    // In order: nothing.
    const Vec3 back = -apart;
    EXPECT_EQ(
        law::contact_push(stiffness, axis, law::contact_arm(0.0, axis, Vec3(second - centre), back)).energy,
        0.0);
}

// --- air -------------------------------------------------------------------------------------------

TEST(PressureLaw, PushesAlongTheFlowAndAcrossIt) {
    const Vec3 area(0.3, -0.1, 0.4), e = Vec3(0.2, 0.1, 1.0).normalized();
    const double phi = 0.8, along = area.dot(e);
    const auto pushed = law::pushed_area(area, e, 1.0 / 3.0, phi / 3.0);
    const Vec3 by_hand = (along * e + phi * (area - along * e)) / 3.0;
    EXPECT_LT((pushed.on_corner - by_hand).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(pushed.projected, along);
    // Turned away from the flow, no area is projected.
    const auto away = law::pushed_area(Vec3(-area), e, 1.0 / 3.0, phi / 3.0);
    EXPECT_EQ(away.projected, 0.0);
    EXPECT_DOUBLE_EQ(away.along, -along);
    EXPECT_LT((away.on_corner + phi / 3.0 * (area - along * e)).norm(), 1e-15);
    // Along an axis upwards or downwards, the short form, of a triangle that faces the air and of one that
    // does not.
    for (const double up : {1.0, -1.0})
        for (const Vec3& triangle : {area, Vec3(-area)}) {
            const auto general = law::pushed_area(triangle, Vec3(0.0, 0.0, up), 1.0 / 3.0, phi / 3.0);
            const auto axial =
                law::pushed_area(Lanes3{splat(triangle.x()), splat(triangle.y()), splat(triangle.z())},
                                 law::AxialFlow<Lanes>{splat(up)}, splat(1.0 / 3.0), splat(phi / 3.0));
            const Vec3 on_corner(axial.on_corner.x[0], axial.on_corner.y[0], axial.on_corner.z[0]);
            EXPECT_LT((general.on_corner - on_corner).norm(), 1e-15);
            EXPECT_DOUBLE_EQ(general.along, axial.along[0]);
            EXPECT_DOUBLE_EQ(general.projected, axial.projected[0]);
        }
}

TEST(FabricDragLaw, GrowsWithTheAreaAcrossTheFlow) {
    const Vec3 area(0.3, -0.1, 0.4), velocity(-3.0, 1.0, 4.0);
    const auto drag = law::fabric_drag(area, velocity, 0.5 * 1.2 * 0.9 / 3.0);
    const double speed = velocity.norm(), across = std::abs(area.dot(velocity)) / speed;
    EXPECT_NEAR(drag.across, across, 1e-12);
    EXPECT_LT((drag.on_corner - 0.5 * 1.2 * 0.9 * across * speed * velocity / 3.0).norm(), 1e-12);
}

TEST(CylinderDragLaw, ActsAcrossTheLine) {
    static const CylinderDragTable table;
    const double diameter = 0.005, density = 1.1, viscosity = 1.8e-5;
    const law::CylinderDrag cylinder(table, diameter, density, viscosity);
    const Vec3 velocity(4.0, -2.0, 1.0), across = velocity - velocity.dot(d) / d.squaredNorm() * d;
    const double reynolds = density * across.norm() * diameter / viscosity;
    const Vec3 by_hand = 0.5 * 0.5 * density * diameter * d.norm() * table(reynolds) * across.norm() * across;
    const Lanes3 on_end =
        cylinder.on_end(Lanes3{splat(d.x()), splat(d.y()), splat(d.z())},
                        Lanes3{splat(velocity.x()), splat(velocity.y()), splat(velocity.z())});
    EXPECT_LT((Vec3(on_end.x[0], on_end.y[0], on_end.z[0]) - by_hand).norm(), 1e-12 * by_hand.norm());
}

// --- nodes -----------------------------------------------------------------------------------------

TEST(NodeLaw, LeapfrogIsExactUnderAConstantForce) {
    // x = v0 t + a t^2/2: second differences of a parabola have no error, whatever the steps.
    const Lanes acceleration{0.0, 0.5, -9.0, 0.0}, start{3.0, -1.0, 2.0, 0.0};
    Lanes x = splat(0.0), v_half = start, v = start;
    double t = 0.0, last = 0.0;
    for (const double dt : {0.1, 0.1, 0.02, 0.05}) {
        v_half = law::kicked(v_half, acceleration, 0.5 * (last + dt));
        v = law::drift(x, v_half, acceleration, dt, 0.5 * dt);
        t += dt, last = dt;
    }
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(x[k], start[k] * t + 0.5 * acceleration[k] * t * t, 1e-14);
        EXPECT_NEAR(v[k], start[k] + acceleration[k] * t, 1e-14);
    }
}

TEST(NodeLaw, KineticEnergyOfBothHalfStepsIsThatOfLeapfrog) {
    // v^n is the mean of both half steps, so for a constant step the power of a force over it is the change
    // of m v^{n-1/2} v^{n+1/2} / 2 between two instants: a (v^n + v^{n+1})/2 dt.
    const Lanes acceleration{0.5, -9.0, 2.0, 0.0}, before{3.0, -1.0, 2.0, 0.0};
    const double dt = 0.1, m = 0.25;
    const Lanes after = law::kicked(before, acceleration, dt), later = law::kicked(after, acceleration, dt);
    const Lanes now = law::middle_of(before, after), next = law::middle_of(after, later);
    for (int k = 0; k < 3; ++k) {
        EXPECT_DOUBLE_EQ(now[k], before[k] + 0.5 * dt * acceleration[k]);
        EXPECT_NEAR(0.5 * m * (after[k] * later[k] - before[k] * after[k]),
                    m * acceleration[k] * 0.5 * (now[k] + next[k]) * dt, 1e-15);
    }
}

TEST(NodeLaw, ResistanceTakesItsPowerAndAirThatJoinsGetsIt) {
    const Lanes v{1.0, 2.0, -3.0, 0.0}, mean{0.5, 0.0, -1.0, 0.0}, wind{2.0, 0.0, 0.0, 0.0};
    Lanes force = splat(0.0), dissipated = splat(0.0), power = splat(0.0);
    law::resist(0.4, v - mean, force, dissipated);
    for (int k = 0; k < 3; ++k) {
        EXPECT_DOUBLE_EQ(force[k], -0.4 * (v[k] - mean[k]));
        EXPECT_DOUBLE_EQ(dissipated[k], 0.4 * (v[k] - mean[k]) * (v[k] - mean[k]));
    }
    force = splat(0.0);
    law::accrete(0.7, wind, v, force, power);
    for (int k = 0; k < 3; ++k) {
        EXPECT_DOUBLE_EQ(force[k], 0.7 * (wind[k] - v[k]));
        EXPECT_DOUBLE_EQ(power[k], force[k] * v[k]);
    }
}

TEST(CriticalStepLaw, IsTheRootOfItsQuadratic) {
    // Growth factor -1: K dt^2/2 + 2 C dt = 2 m with the row sums K, C; undamped 2 sqrt(m/K), without
    // stiffness m/C.
    const double k = 3.0e4, c_row = 12.0, m = 0.02, dt = law::critical_step(k, c_row, m);
    EXPECT_NEAR(0.5 * k * dt * dt + 2.0 * c_row * dt, 2.0 * m, 1e-15);
    EXPECT_DOUBLE_EQ(law::critical_step(k, 0.0, m), 2.0 * std::sqrt(m / k));
    EXPECT_DOUBLE_EQ(law::critical_step(0.0, c_row, m), m / c_row);
}

}  // namespace
}  // namespace twinchute::fullsim
