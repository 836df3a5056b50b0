// Every row of the table of explicit methods: its order on a smooth problem, across a jump of the
// right-hand side that a stage boundary takes care of, and up to an event.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "lib/solve/sundials.hpp"

namespace twinchute {
namespace {

/// Observed order from errors at steps h, h/2.
double order(const std::function<double(double)>& error, double h) {
    return std::log2(error(h) / error(0.5 * h));
}

class EveryMethod : public testing::TestWithParam<std::size_t> {
protected:
    const ExplicitMethod& method() const { return explicit_methods()[GetParam()]; }
    double step() const { return method().order >= 5 ? 0.1 : 0.05; }
};

using Values = std::span<const double>;
using Rates = std::span<double>;

TEST_P(EveryMethod, HasItsOrderOnASmoothProblem) {
    // y' = -2 t y^2, y(0) = 1: y = 1/(1 + t^2), to t = 1.
    const auto error = [&](double h) {
        ErkSolver solver(
            method(), [](double t, Values y, Rates f) { f[0] = -2.0 * t * y[0] * y[0]; }, 0.0,
            std::vector<double>{1.0}, 1e-6, std::vector<double>{1e-9});
        solver.fix_step(h);
        solver.stop_at(1.0);
        while (solver.advance() == ErkSolver::Outcome::stepped) {
        }
        EXPECT_DOUBLE_EQ(solver.time(), 1.0);
        return std::abs(solver.state()[0] - 0.5);
    };
    EXPECT_NEAR(order(error, step() / 4), method().order, 0.25) << method().name;
}

TEST_P(EveryMethod, KeepsItsOrderAcrossAStageBoundary) {
    // y' = y to t = 1/pi, then y' = -3 y^2 (not a multiple of any step): exact by hand.
    const double boundary = 1.0 / 3.14159265358979;
    const double middle = std::exp(boundary), exact = 1.0 / (1.0 / middle + 3.0 * (1.0 - boundary));
    const auto error = [&](double h) {
        bool second = false;
        ErkSolver solver(
            method(), [&](double, Values y, Rates f) { f[0] = second ? -3.0 * y[0] * y[0] : y[0]; }, 0.0,
            std::vector<double>{1.0}, 1e-6, std::vector<double>{1e-9});
        for (const double end : {boundary, 1.0}) {
            solver.fix_step(h);
            solver.stop_at(end);
            while (solver.advance() == ErkSolver::Outcome::stepped) {
            }
            EXPECT_DOUBLE_EQ(solver.time(), end);
            const std::vector<double> y(solver.state().begin(), solver.state().end());
            second = true;
            solver.restart(end, y);
        }
        return std::abs(solver.state()[0] - exact);
    };
    // The step that a boundary cuts short makes the error uneven: the mean of three halvings, and only
    // from below (the errors of the two stages may cancel). Stepped across, the jump leaves order one.
    const double h = step() / 2;
    const double observed = std::log2(error(h) / error(h / 8)) / 3.0;
    EXPECT_GT(observed, method().order - 0.3) << method().name;
}

TEST_P(EveryMethod, FindsAnEventToItsTolerance) {
    // Free fall from 1 m with g = 2: ground at t = 1. A parabola is exact for every method here.
    ErkSolver solver(
        method(), [](double, Values y, Rates f) { f[0] = y[1], f[1] = -2.0; }, 0.0,
        std::vector<double>{1.0, 0.0}, 1e-8, std::vector<double>{1e-10, 1e-10});
    solver.watch(1, [](double, Values y, Rates g) { g[0] = y[0]; });
    solver.stop_at(5.0);
    auto outcome = solver.advance();
    while (outcome == ErkSolver::Outcome::stepped)
        outcome = solver.advance();
    EXPECT_EQ(outcome, ErkSolver::Outcome::found_root);
    EXPECT_EQ(solver.root(), 0);
    EXPECT_NEAR(solver.time(), 1.0, 1e-10);
}

TEST_P(EveryMethod, DenseOutputJoinsTheSteps) {
    ErkSolver solver(
        method(), [](double, Values y, Rates f) { f[0] = -y[0]; }, 0.0, std::vector<double>{1.0}, 1e-9,
        std::vector<double>{1e-12});
    solver.stop_at(1.0);
    std::vector<double> y(1);
    double worst = 0.0;
    while (solver.advance() == ErkSolver::Outcome::stepped)
        for (const double share : {0.0, 0.3, 0.5, 0.9, 1.0}) {
            const double t = solver.previous_time() + share * (solver.time() - solver.previous_time());
            solver.interpolate(t, y);
            worst = std::max(worst, std::abs(y[0] - std::exp(-t)));
        }
    EXPECT_LT(worst, 1e-6) << method().name;
}

INSTANTIATE_TEST_SUITE_P(Rows, EveryMethod, testing::Range(std::size_t{0}, explicit_methods().size()));

TEST(Integrators, FailureIsAnOutcomeWithAReason) {
    // y' = y^2 from 1 blows up at t = 1: no step size goes through.
    ErkSolver solver(
        *find_explicit_method("dormand-prince"), [](double, Values y, Rates f) { f[0] = y[0] * y[0]; }, 0.0,
        std::vector<double>{1.0}, 1e-8, std::vector<double>{1e-10});
    solver.stop_at(2.0);
    auto outcome = solver.advance();
    for (int i = 0; i < 100000 && outcome == ErkSolver::Outcome::stepped; ++i)
        outcome = solver.advance();
    EXPECT_EQ(outcome, ErkSolver::Outcome::failed);
    EXPECT_LT(solver.time(), 1.0 + 1e-9);
    EXPECT_FALSE(solver.failure().empty());
}

TEST(Integrators, WhatTheRightHandSideThrowsComesOut) {
    ErkSolver solver(
        *find_explicit_method("heun-euler"),
        [](double, Values, Rates) { throw std::runtime_error("no air"); }, 0.0, std::vector<double>{1.0},
        1e-8, std::vector<double>{1e-10});
    solver.stop_at(1.0);
    EXPECT_THROW(solver.advance(), std::runtime_error);
}

}  // namespace
}  // namespace twinchute
