// Every row of the table of methods: the order of Runge-Kutta pairs on a smooth problem and across a jump of
// the right-hand side that a stage boundary takes care of; events, dense output and the use of the tolerance
// of all; the implicit ones on stiff problems.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "lib/solve/sundials.hpp"

namespace twinchute {
namespace {

/// Observed order from errors at steps h, h/2.
double order(const std::function<double(double)>& error, double h) {
    return std::log2(error(h) / error(0.5 * h));
}

class EveryMethod : public testing::TestWithParam<std::size_t> {
protected:
    const OdeMethod& method() const { return ode_methods()[GetParam()]; }
    double step() const { return method().order >= 5 ? 0.1 : 0.05; }
};

class EveryPair : public EveryMethod {};

/// With fixed steps the tolerances only say how well Newton's method solves the stages.
constexpr double newton_rtol = 1e-11, newton_atol = 1e-13;

using Values = std::span<const double>;
using Rates = std::span<double>;

TEST_P(EveryPair, HasItsOrderOnASmoothProblem) {
    // y' = -2 t y^2, y(0) = 1: y = 1/(1 + t^2), to t = 1.
    const auto error = [&](double h) {
        OdeSolver solver(
            method(), [](double t, Values y, Rates f) { f[0] = -2.0 * t * y[0] * y[0]; }, 0.0,
            std::vector<double>{1.0}, newton_rtol, std::vector<double>{newton_atol});
        solver.fix_step(h);
        solver.stop_at(1.0);
        while (solver.advance() == OdeSolver::Outcome::stepped) {
        }
        EXPECT_DOUBLE_EQ(solver.time(), 1.0);
        return std::abs(solver.state()[0] - 0.5);
    };
    // Order of the leading term of the error; the next one is at most h times it, here a fortieth of it.
    EXPECT_NEAR(order(error, step() / 4), method().order, 0.1) << method().name;
}

TEST_P(EveryPair, KeepsItsOrderAcrossAStageBoundary) {
    // y' = y to t = 1/pi, then y' = -3 y^2 (not a multiple of any step): exact by hand.
    const double boundary = 1.0 / 3.14159265358979;
    const double middle = std::exp(boundary), exact = 1.0 / (1.0 / middle + 3.0 * (1.0 - boundary));
    const auto error = [&](double h) {
        bool second = false;
        OdeSolver solver(
            method(), [&](double, Values y, Rates f) { f[0] = second ? -3.0 * y[0] * y[0] : y[0]; }, 0.0,
            std::vector<double>{1.0}, newton_rtol, std::vector<double>{newton_atol});
        for (const double end : {boundary, 1.0}) {
            solver.fix_step(h);
            solver.stop_at(end);
            while (solver.advance() == OdeSolver::Outcome::stepped) {
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
    // Free fall from 1 m with g = 2: ground at t = 1. A parabola is exact for every pair here; a multistep
    // method begins with order one and keeps to its tolerance.
    OdeSolver solver(
        method(), [](double, Values y, Rates f) { f[0] = y[1], f[1] = -2.0; }, 0.0,
        std::vector<double>{1.0, 0.0}, 1e-8, std::vector<double>{1e-10, 1e-10});
    solver.watch(1, [](double, Values y, Rates g) { g[0] = y[0]; });
    solver.stop_at(5.0);
    auto outcome = solver.advance();
    while (outcome == OdeSolver::Outcome::stepped)
        outcome = solver.advance();
    EXPECT_EQ(outcome, OdeSolver::Outcome::found_root);
    EXPECT_EQ(solver.root(), 0);
    EXPECT_NEAR(solver.time(), 1.0, method().multistep ? 1e-7 : 1e-10);
}

TEST_P(EveryMethod, EndsAStepAtTheFirstOfTwoEventsAndGoesOnFromThere) {
    // y = t with a rate that no method errs about: y - 0.7 and y - 0.3, in the wrong order, may fall into one
    // step. The root is on the far side of its event, by no more than rounding; no restart is asked for.
    OdeSolver solver(
        method(), [](double, Values, Rates f) { f[0] = 1.0; }, 0.0, std::vector<double>{0.0}, 1e-8,
        std::vector<double>{1e-10});
    solver.watch(2, [](double, Values y, Rates g) { g[0] = y[0] - 0.7, g[1] = 0.3 - y[0]; });
    solver.stop_at(1.0);
    std::vector<int> roots;
    for (auto outcome = OdeSolver::Outcome::stepped; outcome != OdeSolver::Outcome::reached_stop;) {
        outcome = solver.advance();
        ASSERT_NE(outcome, OdeSolver::Outcome::failed) << solver.failure();
        if (outcome != OdeSolver::Outcome::found_root) continue;
        roots.push_back(solver.root());
        const double event = solver.root() == 0 ? 0.7 : 0.3;
        EXPECT_GE(solver.state()[0], event);
        EXPECT_NEAR(solver.state()[0], event, 1e-14);
        EXPECT_NEAR(solver.time(), event, 1e-9);
    }
    EXPECT_EQ(roots, (std::vector{1, 0}));
    EXPECT_NEAR(solver.state()[0], 1.0, 1e-8);
}

TEST_P(EveryMethod, AFunctionThatBeginsAtZeroIsNoEvent) {
    // y = t^2 - t leaves zero downwards and comes back at t = 1: the start is not an event, the return is.
    OdeSolver solver(
        method(), [](double t, Values, Rates f) { f[0] = 2.0 * t - 1.0; }, 0.0, std::vector<double>{0.0},
        1e-8, std::vector<double>{1e-10});
    solver.watch(1, [](double, Values y, Rates g) { g[0] = y[0]; });
    solver.limit_step(0.1);
    solver.stop_at(2.0);
    auto outcome = solver.advance();
    while (outcome == OdeSolver::Outcome::stepped)
        outcome = solver.advance();
    EXPECT_EQ(outcome, OdeSolver::Outcome::found_root);
    EXPECT_NEAR(solver.time(), 1.0, 1e-7);
}

TEST_P(EveryMethod, TakesNoStepLongerThanItIsAskedFor) {
    // y' = 0 has steps of any length; the limit holds for the step that it is asked of. How near to it a
    // method comes is SUNDIALS' business: two thirds are the least.
    OdeSolver solver(
        method(), [](double, Values, Rates f) { f[0] = 0.0; }, 0.0, std::vector<double>{1.0}, 1e-6,
        std::vector<double>{1e-9});
    solver.stop_at(10.0);
    auto outcome = OdeSolver::Outcome::stepped;
    double longest = 0.0;
    while (outcome == OdeSolver::Outcome::stepped) {
        const double before = solver.time();
        outcome = solver.advance(0.3);
        longest = std::max(longest, solver.time() - before);
    }
    EXPECT_EQ(outcome, OdeSolver::Outcome::reached_stop);
    EXPECT_EQ(solver.time(), 10.0);
    EXPECT_LE(longest, 0.3 * (1.0 + 1e-12));
    EXPECT_GT(longest, 0.19);
    // Without a limit it goes as far as it likes again.
    solver.stop_at(1000.0);
    for (int step = 0; step < 40 && solver.time() < 1000.0; ++step)
        solver.advance();
    EXPECT_EQ(solver.time(), 1000.0);
}

TEST_P(EveryMethod, FollowsItsTolerance) {
    // y' = -2 t y^2 as above, across a restart with another right-hand side, y' = y from t = 1: y(2) = e/2.
    const auto error = [&](double rtol) {
        bool second = false;
        OdeSolver solver(
            method(), [&](double t, Values y, Rates f) { f[0] = second ? y[0] : -2.0 * t * y[0] * y[0]; },
            0.0, std::vector<double>{1.0}, rtol, std::vector<double>{1e-3 * rtol});
        for (const double end : {1.0, 2.0}) {
            solver.stop_at(end);
            auto outcome = solver.advance();
            while (outcome == OdeSolver::Outcome::stepped)
                outcome = solver.advance();
            EXPECT_EQ(outcome, OdeSolver::Outcome::reached_stop) << solver.failure();
            EXPECT_DOUBLE_EQ(solver.time(), end);
            const std::vector<double> y(solver.state().begin(), solver.state().end());
            second = true;
            solver.restart(end, y);
        }
        return std::abs(solver.state()[0] / (0.5 * std::exp(1.0)) - 1.0);
    };
    // The tolerance is per step, and a step's error grows by e at most until the end: tens of steps of the
    // loosest, hundreds of the tightest tolerance.
    for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-10})
        EXPECT_LT(error(rtol), 100.0 * rtol) << method().name;
    EXPECT_LT(error(1e-10), 1e-3 * error(1e-4)) << method().name;
}

TEST_P(EveryMethod, CountsItsWork) {
    std::int64_t calls = 0;
    OdeSolver solver(
        method(), [&](double, Values y, Rates f) { f[0] = -y[0], ++calls; }, 0.0, std::vector<double>{1.0},
        1e-6, std::vector<double>{1e-9});
    std::int64_t steps = 0;
    for (const double end : {0.5, 1.0}) {  // restarts included
        const std::vector<double> y(solver.state().begin(), solver.state().end());
        solver.restart(solver.time(), y);
        solver.stop_at(end);
        do
            ++steps;
        while (solver.advance() == OdeSolver::Outcome::stepped);
    }
    const auto s = solver.statistics();
    EXPECT_EQ(s.steps, steps);
    EXPECT_EQ(s.rhs_calls, calls);
    EXPECT_GE(s.rejected, 0);
    EXPECT_GT(s.dt_min, 0.0);
    EXPECT_LE(s.dt_max, 1.0);
}

TEST_P(EveryMethod, DenseOutputJoinsTheSteps) {
    OdeSolver solver(
        method(), [](double, Values y, Rates f) { f[0] = -y[0]; }, 0.0, std::vector<double>{1.0}, 1e-9,
        std::vector<double>{1e-12});
    solver.stop_at(1.0);
    std::vector<double> y(1);
    double worst = 0.0;
    while (solver.advance() == OdeSolver::Outcome::stepped)
        for (const double share : {0.0, 0.3, 0.5, 0.9, 1.0}) {
            const double t = solver.previous_time() + share * (solver.time() - solver.previous_time());
            solver.interpolate(t, y);
            worst = std::max(worst, std::abs(y[0] - std::exp(-t)));
        }
    EXPECT_LT(worst, 1e-6) << method().name;
}

/// A multistep method has neither fixed steps nor a fixed order.
std::vector<std::size_t> pairs() {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < ode_methods().size(); ++i)
        if (!ode_methods()[i].multistep) rows.push_back(i);
    return rows;
}

INSTANTIATE_TEST_SUITE_P(Rows, EveryMethod, testing::Range(std::size_t{0}, ode_methods().size()));
INSTANTIATE_TEST_SUITE_P(Rows, EveryPair, testing::ValuesIn(pairs()));

/// Steps to t = 1 of y' = -rate (y - cos t) - sin t, y(0) = 1 (Prothero and Robinson): y = cos t exactly,
/// whatever the rate; the error at the end.
struct Relaxation {
    std::int64_t steps = 0, rhs_calls = 0;
    double error = 0.0;
};

Relaxation relax(const OdeMethod& method, double rate) {
    OdeSolver solver(
        method, [rate](double t, Values y, Rates f) { f[0] = -rate * (y[0] - std::cos(t)) - std::sin(t); },
        0.0, std::vector<double>{1.0}, 1e-6, std::vector<double>{1e-9});
    solver.stop_at(1.0);
    auto outcome = solver.advance();
    while (outcome == OdeSolver::Outcome::stepped)
        outcome = solver.advance();
    EXPECT_EQ(outcome, OdeSolver::Outcome::reached_stop) << method.name << ": " << solver.failure();
    return {solver.statistics().steps, solver.statistics().rhs_calls,
            std::abs(solver.state()[0] - std::cos(1.0))};
}

TEST(StiffProblem, ImplicitMethodsFollowTheSolutionExplicitOnesTheRate) {
    // An explicit pair of order 5 is stable for rate h < 3.3 or so: at least 3e4 steps for a rate of 1e5. The
    // smooth solution itself asks for some tens at this tolerance.
    const Relaxation explicit_pair = relax(*find_ode_method("dormand-prince"), 1e5);
    EXPECT_GT(explicit_pair.steps, 20000);
    for (const OdeMethod& method : implicit_methods()) {
        const Relaxation r = relax(method, 1e5);
        EXPECT_LT(100 * r.steps, explicit_pair.steps) << method.name;
        EXPECT_LT(100 * r.rhs_calls, explicit_pair.rhs_calls) << method.name;
        EXPECT_LT(r.error, 1e-6) << method.name;
        RecordProperty(std::string(method.name) + "_steps", static_cast<int>(r.steps));
    }
    RecordProperty("explicit_steps", static_cast<int>(explicit_pair.steps));
}

TEST(StiffProblem, TheJacobianIsThatOfTheSystem) {
    // y1' = -1e4 y1 + y2, y2' = -y2 couples the components: y2 = e^-t, y1 = e^-t/9999 once its transient is
    // over. A Jacobian with rows and columns exchanged lets Newton's method fail, or creep.
    for (const OdeMethod& method : implicit_methods()) {
        OdeSolver solver(
            method, [](double, Values y, Rates f) { f[0] = -1e4 * y[0] + y[1], f[1] = -y[1]; }, 0.0,
            std::vector<double>{1.0, 1.0}, 1e-8, std::vector<double>{1e-12, 1e-12});
        solver.stop_at(1.0);
        auto outcome = solver.advance();
        while (outcome == OdeSolver::Outcome::stepped)
            outcome = solver.advance();
        EXPECT_EQ(outcome, OdeSolver::Outcome::reached_stop) << method.name << ": " << solver.failure();
        EXPECT_NEAR(solver.state()[1], std::exp(-1.0), 1e-7) << method.name;
        EXPECT_NEAR(solver.state()[0], std::exp(-1.0) / 9999.0, 1e-11) << method.name;
    }
}

TEST(Integrators, ExplicitRowsComeFirstAndNamesAreUnique) {
    EXPECT_EQ(explicit_methods().size() + implicit_methods().size(), ode_methods().size());
    for (const OdeMethod& method : explicit_methods())
        EXPECT_FALSE(method.implicit) << method.name;
    for (const OdeMethod& method : implicit_methods())
        EXPECT_TRUE(method.implicit) << method.name;
    for (const OdeMethod& method : ode_methods())
        EXPECT_EQ(find_ode_method(method.name), &method) << method.name;
    EXPECT_EQ(find_ode_method("euler"), nullptr);
}

TEST(Integrators, MultistepMethodsHaveNoFixedSteps) {
    for (const OdeMethod& method : ode_methods()) {
        OdeSolver solver(
            method, [](double, Values y, Rates f) { f[0] = -y[0]; }, 0.0, std::vector<double>{1.0}, 1e-6,
            std::vector<double>{1e-9});
        if (method.multistep)
            EXPECT_THROW(solver.fix_step(0.1), std::invalid_argument) << method.name;
        else
            EXPECT_NO_THROW(solver.fix_step(0.1)) << method.name;
    }
}

TEST(Integrators, TheFirstStepsAreAsLongAsThoseAfterThem) {
    // y'' = -y from (1, 0): nothing happens at t = 0, so that a first step of a tenth of the longest is near
    // enough. One that grows up from the tolerance of an order-one method begins a thousand times shorter.
    for (const OdeMethod& method : ode_methods()) {
        if (method.multistep) continue;
        OdeSolver solver(
            method, [](double, Values y, Rates f) { f[0] = y[1], f[1] = -y[0]; }, 0.0,
            std::vector<double>{1.0, 0.0}, 1e-8, std::vector<double>{1e-8, 1e-8}, 1);
        solver.stop_at(6.0);
        double longest = 0.0;
        solver.advance();
        const double first = solver.time();
        for (auto outcome = OdeSolver::Outcome::stepped; outcome == OdeSolver::Outcome::stepped;) {
            outcome = solver.advance();
            longest = std::max(longest, solver.time() - solver.previous_time());
        }
        EXPECT_GT(first, 0.1 * longest) << method.name;
        EXPECT_LT(first, 2.0 * longest) << method.name;
    }
}

TEST(Integrators, FailureIsAnOutcomeWithAReason) {
    // y' = y^2 from 1 blows up at t = 1: no step size goes through.
    OdeSolver solver(
        *find_ode_method("dormand-prince"), [](double, Values y, Rates f) { f[0] = y[0] * y[0]; }, 0.0,
        std::vector<double>{1.0}, 1e-8, std::vector<double>{1e-10});
    solver.stop_at(2.0);
    auto outcome = solver.advance();
    for (int i = 0; i < 100000 && outcome == OdeSolver::Outcome::stepped; ++i)
        outcome = solver.advance();
    EXPECT_EQ(outcome, OdeSolver::Outcome::failed);
    EXPECT_LT(solver.time(), 1.0 + 1e-9);
    EXPECT_FALSE(solver.failure().empty());
}

TEST(Integrators, WhatTheRightHandSideThrowsComesOut) {
    OdeSolver solver(
        *find_ode_method("heun-euler"), [](double, Values, Rates) { throw std::runtime_error("no air"); },
        0.0, std::vector<double>{1.0}, 1e-8, std::vector<double>{1e-10});
    solver.stop_at(1.0);
    EXPECT_THROW(solver.advance(), std::runtime_error);
}

}  // namespace
}  // namespace twinchute
