// The step of the full model against Runge-Kutta pairs of another library, on the same equations in space:
// what differs is time alone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tests/support/c9_scene.hpp"
#include "tests/support/time_integration.hpp"

namespace twinchute {
namespace {

/// An open canopy of 8 gores at its steady drag: fabric and lines swing, and hardly any comes taut or slack
/// within 20 ms. Each such bend of the right-hand side costs the order.
Scene open_canopy() {
    Scene scene = test::c9_scene();
    Parachute& chute = scene.parachutes.front();
    chute.deploy.by = DeployBy::inflated;
    chute.gores = 8;
    scene.full.mesh = {2, 5, 4, 1};
    return scene;
}
constexpr double end = 0.02;  // [s]

/// A pair of order 4 at 1e-8, 4e-9 m from what it gives at 1e-10 and 3e-10 m from one of order 5 at 1e-12:
/// four decades below the errors that it judges.
const test::Marched& truth() {
    static const test::Marched found =
        test::by_sundials(open_canopy(), *find_ode_method("zonneveld"), {1e-8}, end);
    return found;
}

TEST(TimeIntegration, TheStepIsOfSecondOrder) {
    // Errors of place fall by 4.07, 3.79 and 3.98 where steps are halved, of force by 4.08, 4.09 and 4.05
    // (2026-11-21); 0.2 in the order is what few bends leave of it. A rule of first order would be at 1.
    for (const int subcycles : {1, 4}) {
        std::array<double, 4> place{}, force{};
        for (std::size_t level = 0; level < place.size(); ++level) {
            Scene scene = open_canopy();
            scene.full.line_substeps = subcycles;
            scene.full.time_step_factor = 0.5 / static_cast<double>(1 << level);
            const test::Marched run = test::by_own_steps(scene, end);
            place[level] = test::distance(run, truth());
            force[level] = std::abs(run.force - truth().force);
        }
        for (std::size_t level = 1; level < place.size(); ++level) {
            EXPECT_NEAR(std::log2(place[level - 1] / place[level]), 2.0, 0.2) << subcycles << ' ' << level;
            // With subcycles the force is the small difference of two errors, without an order of its own.
            if (subcycles == 1) {
                EXPECT_NEAR(std::log2(force[level - 1] / force[level]), 2.0, 0.1) << level;
            }
        }
        const auto orders = [](const std::array<double, 4>& e) {
            return fmt::format("{:.2f}, {:.2f}, {:.2f}", std::log2(e[0] / e[1]), std::log2(e[1] / e[2]),
                               std::log2(e[2] / e[3]));
        };
        // For docs/verification.md.
        fmt::print("order of places{}: {}\n", subcycles > 1 ? ", up to 4 subcycles of lines" : "",
                   orders(place));
        if (subcycles == 1) fmt::print("order of the opening force: {}\n", orders(force));
    }
}

TEST(TimeIntegration, PairsOfEveryOrderAgreeOnTheSameEquations) {
    // Each keeps the error of a step to about its tolerance, 1e-6 m and m/s; over some hundred steps that may
    // come to ten times as much. With a rate that is wrong by a per mille they would agree with each other,
    // but not with the test above.
    for (const char* name : {"bogacki-shampine", "zonneveld", "dormand-prince"}) {
        const test::Marched run = test::by_sundials(open_canopy(), *find_ode_method(name), {1e-6}, end);
        ASSERT_TRUE(run.failure.empty()) << name << run.failure;
        EXPECT_LT(test::distance(run, truth()), 1e-5) << name;
    }
}

TEST(TimeIntegration, NoPairIsAsFarWithAsFewEvaluations) {
    // Why the model has a step of its own: at the largest stable one, nothing else has come as near to the
    // answer after as few evaluations of all forces. Pairs cannot take fewer: their steps are then unstable.
    Scene scene = open_canopy();
    scene.full.time_step_factor = 0.95;
    const test::Marched own = test::by_own_steps(scene, end);
    const double error = test::distance(own, truth());
    for (const char* name : {"heun-euler", "bogacki-shampine", "zonneveld", "dormand-prince"}) {
        // As many evaluations, in even steps.
        const OdeMethod& method = *find_ode_method(name);
        const int stages = method.order == 2 ? 2 : method.order == 3 ? 3 : method.order == 4 ? 5 : 6;
        const double dt = end * stages / static_cast<double>(own.evaluations);
        const test::Marched run = test::by_sundials(scene, method, {1e-6, dt}, end);
        EXPECT_NEAR(static_cast<double>(run.evaluations), static_cast<double>(own.evaluations), 12.0) << name;
        EXPECT_FALSE(run.failure.empty() && test::distance(run, truth()) < error) << name;
    }
}

}  // namespace
}  // namespace twinchute
