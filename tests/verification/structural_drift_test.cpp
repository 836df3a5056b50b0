// Energy over a million steps: a taut net without any damping, which has to swing on for ever.
#include <gtest/gtest.h>

#include <random>

#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::CableKind;
using fullsim::Mesh;
using fullsim::NodeIndex;
using test::Structure;

constexpr int side = 5;  // nodes
constexpr double strain = 0.02;

/// Cables of 1 m, stretched, between nodes in a square in the x-y plane.
Mesh square_net() {
    Mesh mesh;
    mesh.cords.fill(test::cord_of(1e4, 0.01));
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
            mesh.position.emplace_back((1.0 + strain) * i, (1.0 + strain) * j, 0.0);
    for (NodeIndex j = 0; j < side; ++j)
        for (NodeIndex i = 0; i < side; ++i) {
            if (i + 1 < side)
                mesh.cables.push_back({{j * side + i, j * side + i + 1}, 1.0, 1.0, CableKind::line});
            if (j + 1 < side)
                mesh.cables.push_back({{j * side + i, j * side + i + side}, 1.0, 1.0, CableKind::line});
        }
    return mesh;
}

struct Swing {
    double start = 0.0;              // [J] of motion
    double first = 0.0, last = 0.0;  // [J] above rest, means over the first and last tenth of the steps
};

Swing swing(double bulk_viscosity, double factor, int steps) {
    Structure net(square_net(), bulk_viscosity);
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> kick(-1.0, 1.0);
    for (NodeIndex i = 0; i < side * side; ++i) {
        const NodeIndex row = i / side, column = i % side;
        if (row == 0 || row == side - 1 || column == 0 || column == side - 1)
            net.hold(i);
        else
            net.set_velocity(i, Vec3(kick(generator), kick(generator), kick(generator)));
    }
    const double dt = factor * critical_step(net.row_sums(), net.constants().mass).dt;
    const auto energy = [&] {
        return kinetic_energy(net.state, net.constants()) + elastic_energy(net.state, net.blocks);
    };
    Swing result;
    result.start = kinetic_energy(net.state, net.constants());
    const double rest = energy() - result.start;
    const int tenth = steps / 10;
    int counted = 0;
    for (int n = 0; n < steps; ++n) {
        net.step(dt);
        // Not in time with any swing; a mean over many of them.
        if (n % 7 != 0 || (n >= tenth && n < steps - tenth)) continue;
        (n < tenth ? result.first : result.last) += energy() - rest;
        counted += n < tenth;
    }
    result.first /= counted;
    result.last /= counted;
    return result;
}

TEST(StructuralDrift, ATautNetKeepsItsEnergyOverAMillionSteps) {
    // The central difference scheme conserves an energy that differs from the real one by a share of (w dt)^2
    // and swings about it. What a mean over 14 000 samples leaves of the swings is below 1e-3 of a tenth; a
    // drift would go on with the steps.
    const Swing net = swing(0.0, 0.5, 1'000'000), finer = swing(0.0, 0.25, 100'000);
    test::report("net: energy over the first and last tenth of 1e6 steps, of the start",
                 net.first / net.start, net.last / net.start);
    EXPECT_NEAR(net.last / net.first, 1.0, 1e-4);
    // Half the step, a quarter of the difference; the next term is (w dt)^2 of it, at most 1 and a quarter
    // here.
    const double coarse_offset = net.first / net.start - 1.0, fine_offset = finer.first / finer.start - 1.0;
    test::report("the same: first tenth less the start, steps 2:1", coarse_offset, fine_offset);
    EXPECT_NEAR(coarse_offset / fine_offset, 4.0, 1.0);
}

TEST(StructuralDrift, IsSeenWhereThereIsDamping) {
    // This net with a tenth of the usual bulk viscosity, a hundredth of the steps.
    const Swing net = swing(0.006, 0.5, 10'000);
    EXPECT_LT(net.last, 0.9 * net.first);
}

}  // namespace
}  // namespace twinchute
