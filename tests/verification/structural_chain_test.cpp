// The folded falling chain: hung up by both ends side by side, one of them let go.
//
// Energy is conserved in the fold, and the free end falls faster than a stone (Calkin and March 1989):
//   v^2 = g L y (2 - y)/(1 - y), y = fall/L,
// which gives 1.1380 sqrt(L/g) to y = 0.8 and 1.1770 sqrt(L/g) to y = 0.9, against 1.2649 and 1.3416 of a
// free fall. The pointwise tension of a discrete chain rings, so times and impulses are compared.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::CableKind;
using fullsim::Mesh;
using test::Structure;

constexpr double length = 1.0, mass = 1.0;

/// [s] by quadrature of dy/v, in sqrt(L/g): y = 1 - cos takes the root at the start away.
double fall_time(double y_end) {
    const double end = std::acos(1.0 - y_end);
    const int n = 20000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double angle = end * (i + 0.5) / n, y = 1.0 - std::cos(angle);
        sum += std::sin(angle) / std::sqrt(y * (2.0 - y) / (1.0 - y)) * end / n;
    }
    return sum;
}

struct Fall {
    double to_80, to_90;   // [sqrt(L/g)]
    double impulse_error;  // largest, over m g sqrt(L/g)
    double energy_error;   // largest, over m g L
};

Fall drop(int elements, double gap) {
    Mesh mesh;
    const double weight = mass * standard_gravity;
    mesh.cords.fill(test::cord_of(1e4 * weight, mass / length));
    // A narrow hairpin: two straight strands and a bottom of `gap`.
    const double part = length / elements;
    for (int i = 0; i <= elements; ++i) {
        const double s = part * i, strand = 0.5 * (length - gap);
        if (s <= strand)
            mesh.position.emplace_back(0.0, 0.0, -s);
        else if (s >= length - strand)
            mesh.position.emplace_back(gap, 0.0, -(length - s));
        else
            mesh.position.emplace_back(s - strand, 0.0, -strand);
    }
    for (int i = 0; i < elements; ++i)
        mesh.cables.push_back({{i, i + 1}, part, 1.0, CableKind::line});
    Structure chain(mesh, 0.0, standard_gravity);
    chain.hold(0);
    chain.hold(elements);
    EXPECT_LT(chain.relax(1e-6 * weight / elements, 400000).residual, 1e-6 * weight / elements);
    chain.stop();
    chain.release(elements);

    const auto& m = chain.constants().mass;
    const double unit = std::sqrt(length / standard_gravity);
    const double dt = 0.4 * part / std::sqrt(chain.mesh().cords[0].axial_stiffness() * length / mass);
    const double start = chain.position(elements).z();
    const auto energy = [&] {
        double sum = chain.blocks[0]->energy(chain.state);
        for (std::size_t i = 0; i < m.size(); ++i)
            sum += m[i] * (standard_gravity * chain.state.node[i].x[2] +
                           0.5 * sum3(chain.state.node[i].v * chain.state.node[i].v));
        return sum;
    };
    const double energy_at_start = energy();
    Fall fall{};
    double impulse = 0.0, before = 0.0;
    while (fall.to_90 == 0.0 && chain.state.time < 2.0 * unit) {
        const double kick = 0.5 * (dt + chain.state.dt);
        chain.step(dt);
        impulse += kick * (chain.reaction(0).z() - weight);
        double momentum = 0.0;  // at the half step that the kicks lead to
        for (std::size_t i = 0; i < m.size(); ++i)
            momentum += m[i] * chain.state.v_half[i].value[2];
        fall.impulse_error = std::max(fall.impulse_error, std::abs(momentum - impulse) / (weight * unit));
        fall.energy_error =
            std::max(fall.energy_error, std::abs(energy() - energy_at_start) / (weight * length));
        const double y = (start - chain.position(elements).z()) / length;
        const auto passed = [&](double level) {
            return (chain.state.time - dt * (y - level) / (y - before)) / unit;
        };
        if (before < 0.8 && y >= 0.8) fall.to_80 = passed(0.8);
        if (before < 0.9 && y >= 0.9) fall.to_90 = passed(0.9);
        before = y;
    }
    test::report("chain elements, gap: to 0.8, 0.9, impulse, energy", elements, gap, fall.to_80, fall.to_90,
                 fall.impulse_error, fall.energy_error);
    return fall;
}

TEST(StructuralChain, FallsFasterThanAStone) {
    EXPECT_NEAR(fall_time(0.8), 1.1380, 5e-5);
    EXPECT_NEAR(fall_time(0.9), 1.1770, 5e-5);
    // A fold of four elements. One that is narrower than its elements are long turns them over with a
    // jerk, loses energy to vibration, and falls later: with a gap of one element 100 of them miss by 1.5 %.
    double error[2];
    int level = 0;
    for (const int elements : {50, 100}) {
        const Fall fall = drop(elements, 4.0 / elements);
        error[level++] = fall.to_80 / fall_time(0.8) - 1.0;
        EXPECT_NEAR(fall.to_80 / fall_time(0.8), 1.0, 0.015);
        EXPECT_NEAR(fall.to_90 / fall_time(0.9), 1.0, 0.015);
        // The momentum is the impulse of support and gravity, at every step and to round-off.
        EXPECT_LT(fall.impulse_error, 1e-6);
        // Folding is thousands of changes between slack and taut, each with the error of a step across it.
        EXPECT_LT(fall.energy_error, 0.002);
    }
    EXPECT_LT(std::abs(error[1]), std::abs(error[0]));
}

}  // namespace
}  // namespace twinchute
