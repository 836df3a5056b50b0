// The central difference scheme and the bound on its step, on problems with exact answers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

#include "fullsim/forces/registry.hpp"
#include "fullsim/time/aero_reference.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

using test::state_of;

/// Two nodes of 0.3 kg and a cord of 1 m between them, held taut by opposite forces of `pull` [N].
struct Spring {
    static constexpr double pull = 300.0;
    Mesh mesh;
    std::unique_ptr<const ForceModel> cable;
    NodeConstants constants;
    double stiffness, frequency;  // EA/l0 [N/m], sqrt(2 k/m) [rad/s]

    explicit Spring(double bulk_viscosity, double gravity = 0.0) {
        mesh.cords.fill({"cord", 462.0, 9.7e8, 4e-3});
        mesh.cables = {{{0, 1}, 1.0, 1.0, CableKind::line}};
        stiffness = mesh.cords[0].axial_stiffness();
        frequency = std::sqrt(2.0 * stiffness / 0.3);
        mesh.position = {Vec3(0, 0, 0), Vec3(0, 0, 1.0 + pull / stiffness)};
        mesh.mass = {0.3, 0.3};
        mesh.tributary_area = {0.0, 0.0};
        cable = make_cable(mesh, bulk_viscosity);
        constants.mass = mesh.mass;
        constants.share = {0.0, 0.0};
        constants.system_mass = 0.6;
        constants.canopy_mass = 1.0;
        constants.gravity = gravity;
    }

    State start(double amplitude) const {
        State state = state_of(mesh);
        state.node[1].x[2] += amplitude;
        state.node[0].x[2] -= amplitude;
        return state;
    }

    void step(State& state, double dt) const {
        cable->add_forces(state);
        state.aero[0].value[2] -= pull;
        state.aero[1].value[2] += pull;
        advance(state, constants, dt, 0.0);
        state.time += dt;
    }

    double stretch(const State& state) const {
        return 0.5 * (state.node[1].x[2] - state.node[0].x[2] - 1.0 - pull / stiffness);
    }
};

TEST(Midpoint, IsOfSecondOrder) {
    const Spring spring(0.0);
    const double amplitude = 1e-3, end = 2.5 * 2.0 * pi / spring.frequency;
    // Stretch a cos(omega t); also with steps that vary smoothly by 30 %.
    for (const double variation : {0.0, 0.3}) {
        double error[3];
        for (int level = 0; level < 3; ++level) {
            const int n = 200 << level;
            std::vector<double> dt(n);
            double sum = 0.0;
            for (int i = 0; i < n; ++i)
                sum += dt[i] = 1.0 + variation * std::sin(2.0 * pi * i / n);
            State state = spring.start(amplitude);
            for (int i = 0; i < n; ++i)
                spring.step(state, dt[i] * end / sum);
            error[level] = std::abs(spring.stretch(state) - amplitude * std::cos(spring.frequency * end));
            // The position error is of second order in the phase where the cosine is flat, so look
            // at the velocity as well.
            const double v = 0.5 * (state.node[1].v[2] - state.node[0].v[2]);
            error[level] += std::abs(v / spring.frequency + amplitude * std::sin(spring.frequency * end));
        }
        EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1) << variation;
        EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.1) << variation;
    }
}

TEST(Midpoint, FallsExactly) {
    // Constant acceleration is integrated exactly by a rule of second order.
    const Spring spring(0.0, 9.81);
    State state = spring.start(0.0);
    for (int i = 0; i < 100; ++i)
        spring.step(state, i % 2 ? 1e-3 : 2e-4);
    // The mean of both nodes; each also swings by the cable's regularising 1e-9 m.
    const double rest = 0.5 * (1.0 + Spring::pull / spring.stiffness);
    const Lanes x = 0.5 * (state.node[0].x + state.node[1].x), v = 0.5 * (state.node[0].v + state.node[1].v);
    EXPECT_NEAR(x[2], rest - 0.5 * 9.81 * state.time * state.time, 1e-12);
    EXPECT_NEAR(v[2], -9.81 * state.time, 1e-12);
    // The last half step is booked with the power before it: m g^2 dt^2/2.
    EXPECT_NEAR(state.energy.gravity_work + 0.5 * state.dt * state.energy.gravity_power,
                0.5 * 0.6 * std::pow(9.81 * state.time, 2), 0.6 * 9.81 * 9.81 * 1e-6);
}

/// Largest stretch in the last tenth of 4000 steps of length dt.
double late_amplitude(const Spring& spring, double dt) {
    State state = spring.start(1e-6);
    double late = 0.0;
    for (int i = 0; i < 4000; ++i) {
        spring.step(state, dt);
        if (i >= 3600) late = std::max(late, std::abs(spring.stretch(state)));
    }
    return late;
}

TEST(CriticalStep, IsSharpForOneSpring) {
    // One spring is its own largest row: the bound is the limit. 1 % below it stays, 1 % above it
    // grows until the cord goes slack.
    for (const double viscosity : {0.0, 0.06, 0.3}) {
        const Spring spring(viscosity);
        GershgorinSums sums{{0.0, 0.0}, {0.0, 0.0}};
        spring.cable->add_row_sums(state_of(spring.mesh), sums);
        const double dt = critical_step(sums, spring.mesh.mass).dt;
        if (viscosity == 0.0) {
            EXPECT_NEAR(dt, 2.0 / spring.frequency, 1e-12);
        }
        EXPECT_LT(late_amplitude(spring, 0.99 * dt), 1e-5) << viscosity;
        EXPECT_GT(late_amplitude(spring, 1.01 * dt), 1e-3) << viscosity;
    }
}

TEST(CriticalStep, TakesPureDamping) {
    // K = 0: v' = -(C/m) v with the velocity extrapolated is stable to dt = m/C.
    const CriticalStep step = critical_step({{0.0}, {5.0}}, {2.0});
    EXPECT_DOUBLE_EQ(step.dt, 0.4);
}

/// Largest eigenfrequency of the tangent of `blocks` at `state`, by differences of forces.
double largest_frequency(const Mesh& mesh, const std::vector<std::unique_ptr<const ForceModel>>& blocks,
                         const State& state) {
    const int n = 3 * mesh.node_count();
    Eigen::MatrixXd K(n, n);
    const double h = 1e-7;
    for (int j = 0; j < n; ++j) {
        Eigen::VectorXd side[2] = {Eigen::VectorXd(n), Eigen::VectorXd(n)};
        for (int s = 0; s < 2; ++s) {
            State moved = state;
            moved.node[j / 3].x[j % 3] += s == 0 ? h : -h;
            test::clear_forces(moved);
            for (const auto& block : blocks)
                block->add_forces(moved);
            for (int i = 0; i < n; ++i)
                side[s][i] = moved.force[i / 3].value[i % 3];
        }
        K.col(j) = (side[1] - side[0]) / (2.0 * h);
    }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            K(i, j) /= std::sqrt(mesh.mass[i / 3] * mesh.mass[j / 3]);
    const Eigen::MatrixXd symmetric = 0.5 * (K + K.transpose());
    EXPECT_LT((K - K.transpose()).norm(), 1e-4 * K.norm());  // the tangent of an energy is symmetric
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
                         .eigenvalues()
                         .maxCoeff());
}

TEST(CriticalStep, IsBelowTheTrueLimitOfACanopy) {
    // Open and taut everywhere (7 % along the seams, 3 % around the skirt).
    for (const int columns : {1, 2, 3}) {
        const Mesh mesh = test::coarse_c9(columns, 3, 2000.0);
        ForceModels blocks, loads;
        blocks.push_back(make_membrane(mesh, 0.0));
        blocks.push_back(make_cable(mesh, 0.0));
        State state = state_of(mesh);
        test::stretch_open(state, 8.0, 0.3);
        const NodeConstants constants = node_constants(mesh, 0.0);
        PerronScaling weights;
        weights.begin(state, constants, blocks, nullptr);
        const double limit = 2.0 / largest_frequency(mesh, blocks, state);
        const double plain = critical_step(state, constants, blocks, loads, {}).dt;
        const double weighed = critical_step(state, constants, blocks, loads, weights.by_node()).dt;
        EXPECT_LE(weighed, (1.0 + 1e-6) * limit) << columns;
        EXPECT_GT(weighed, 0.7 * limit) << columns;  // a bound that gave away more would be worth sharpening
        EXPECT_GT(weighed, plain) << columns;
    }
}

TEST(ReferenceVelocity, TakesTheAxisFromTheSystemAndTheRestFromTheCanopy) {
    NodeSums sums;
    sums.canopy_position = Vec3(0, 0, 10);
    sums.canopy_velocity = Vec3(2, 0, -7);
    sums.system_velocity = Vec3(5, 1, -9);
    EXPECT_EQ(reference_velocity(sums, Vec3::Zero(), 100.0, 0.0), Vec3(2, 0, -9));
    // With 50 kg of air that moves like the fabric at -6 m/s: (100 (-9) + 50 (-6))/150.
    sums.canopy_area_velocity = Vec3(0, 0, -6);
    EXPECT_NEAR(reference_velocity(sums, Vec3::Zero(), 100.0, 50.0).z(), -8.0, 1e-14);
}

TEST(ReferenceVelocity, StandsStillInABounce) {
    // Payload and canopy against each other at zero total momentum: the reference does not move, so
    // drag neither feeds the bounce nor is fed by it. The mean of the material alone would move.
    const double payload = 152.4, fabric = 4.0, air = 75.0, speed = 1.0;
    NodeSums sums;
    sums.canopy_position = Vec3(0, 0, 10);
    sums.canopy_velocity = sums.canopy_area_velocity = Vec3(0, 0, speed);
    const double back = -(fabric + air) / payload * speed;
    sums.system_velocity = Vec3(0, 0, (payload * back + fabric * speed) / (payload + fabric));
    EXPECT_NEAR(reference_velocity(sums, Vec3::Zero(), payload + fabric, air).norm(), 0.0, 1e-14);
    EXPECT_LT(reference_velocity(sums, Vec3::Zero(), payload + fabric, 0.0).z(), -0.4);
    // Once open, within half a second of a C-9, and of any canopy within as much of its own D0/v.
    for (const double scale : {time_scale_of_c9, 0.1, 5.0}) {
        EXPECT_EQ(air_mass_in_reference(75.0, -0.1, scale), 0.0);
        const double half_second = 0.5 * scale / time_scale_of_c9;
        EXPECT_NEAR(air_mass_in_reference(75.0, half_second, scale), 75.0 * (1.0 - std::exp(-1.0)), 1e-12);
        EXPECT_NEAR(air_mass_in_reference(75.0, 10.0 * half_second, scale), 75.0, 0.01);
    }
}

TEST(Energy, BalancesInASpring) {
    // No gravity; the opposite pulls work as "drag". Exchange of kinetic and elastic energy to
    // second order: halving the step quarters the residual's amplitude.
    const Spring spring(0.0);
    ForceModels structure;
    structure.push_back(make_cable(spring.mesh, 0.0));
    double worst[2] = {0.0, 0.0};
    for (int level = 0; level < 2; ++level) {
        const double dt = (level == 0 ? 0.1 : 0.05) / spring.frequency;
        State state = spring.start(1e-3);
        state.energy.elastic_start = elastic_energy(state, structure);
        for (int i = 0; i < 400 << level; ++i) {
            spring.step(state, dt);
            worst[level] = std::max(
                worst[level], std::abs(residual(energy_ledger(state, kinetic_energy(state, spring.constants),
                                                              elastic_energy(state, structure)))));
        }
    }
    const double exchanged = 4e-3 * Spring::pull;  // work of the pull from end to end of the swing
    EXPECT_LT(worst[0], 5e-3 * exchanged);
    EXPECT_NEAR(std::log2(worst[0] / worst[1]), 2.0, 0.2);
}

TEST(Energy, OfTheRuleIsKeptToTheLastBit) {
    // A linear spring under a constant pull and its weight, at half the step that is stable: velocities
    // extrapolated to a step's beginning are off by a fourth of the swing's energy, those of the rule by
    // rounding. What the first step, which begins with half a kick, leaves over stays.
    const Spring spring(0.0, 9.81);
    ForceModels structure;
    structure.push_back(make_cable(spring.mesh, 0.0));
    State state = spring.start(1e-3);
    state.energy.elastic_start = elastic_energy(state, structure);
    const double swing = spring.stiffness * 2e-3 * 1e-3;  // 1/2 k (2 a)^2
    std::vector<double> extrapolated, of_rule;
    for (int i = 0; i < 400; ++i) {
        const double elastic = elastic_energy(state, structure);
        extrapolated.push_back(
            residual(energy_ledger(state, kinetic_energy(state, spring.constants), elastic)));
        state.energy.weighs = true;
        spring.step(state, 1.0 / spring.frequency);
        of_rule.push_back(residual(ledger_before(state, elastic, 0.0, 0.0)));
    }
    const auto range_after_first = [](const std::vector<double>& values) {
        const auto [least, most] = std::minmax_element(values.begin() + 1, values.end());
        return *most - *least;
    };
    EXPECT_GT(range_after_first(extrapolated), 0.1 * swing);
    // 400 sums of terms up to the work of gravity, 2e4 times the swing; the cable's regularising 1e-18 m^2.
    EXPECT_LT(range_after_first(of_rule), 1e-8 * swing);
}

}  // namespace
}  // namespace twinchute::fullsim
