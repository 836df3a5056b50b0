// A parachute and its model, after Froude: lengths times k, times sqrt(k), masses k^3, stiffness k^3 as
// weight, densities and gravity as they are. Nothing in the equations then tells one from the other, unless a
// length, a time or a speed is written into them.
//
// k = 4: lengths, times, masses and stiffness change by powers of two, and so does every number of a run, to
// the last bit. What is left are guards against 0/0 (1e-18 m^2 beside the square of a length) and, in a pack,
// its chaos. Left out is what is not similar: drag of lines, which goes with the Reynolds number, and the 5
// ms mean, an instrument of the payload's: forces are compared as they are.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using test::run_full;
using test::run_rom;

constexpr double k = 4.0, root_k = 2.0;

Cord enlarged(Cord cord) {
    cord.youngs_modulus *= k;  // EA goes as a force, k^3
    cord.diameter *= k;
    return cord;
}

Scene enlarged(Scene scene) {
    scene.environment.ground *= k;
    scene.payload.mass *= k * k * k;
    scene.release.altitude *= k;
    scene.release.speed *= root_k;
    scene.stop.value *= root_k;
    Parachute& chute = scene.parachutes.front();
    for (double* length : {&chute.nominal_diameter, &chute.vent_diameter, &chute.line_length,
                           &chute.riser_length, &chute.deploy.static_line_length})
        *length *= k;
    chute.drag_area *= k * k;
    chute.mass *= k * k * k;
    chute.fabric.youngs_modulus *= k;
    chute.fabric.thickness *= k;
    chute.line = enlarged(chute.line);
    for (Cord* tape : {&chute.tapes.radial, &chute.tapes.skirt, &chute.tapes.vent})
        *tape = enlarged(*tape);
    chute.deploy.deployment_resistance *= k * k;  // a force per width
    scene.full.output_rate /= root_k;
    if (scene.full.noise) scene.full.noise->amplitude *= k;
    return scene;
}

/// Largest distance of a channel from `factor` times that of the smaller run, over its largest value.
double distance(const RunRecord& small, const RunRecord& large, const char* channel, double factor) {
    const auto &a = small.find_channel(channel)->values, &b = large.find_channel(channel)->values;
    EXPECT_EQ(a.size(), b.size()) << channel;
    double most = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        most = std::max(most, std::abs(factor * a[i]));
        apart = std::max(apart, std::abs(factor * a[i] - b[i]));
    }
    return apart / most;
}

/// A coarse C-9 that opens in 1.6 s and settles for as long.
Scene small_scene(AddedMassMomentum momentum) {
    Scene scene = test::c9_scene();
    scene.aerodynamics.line_drag.reset();
    scene.aerodynamics.added_mass->momentum = momentum;
    scene.full.mesh = {1, 5, 4, 1};
    scene.stop = {Trigger::Kind::time, 3.2, 0.0};
    return scene;
}

class FroudeSimilarity : public testing::TestWithParam<AddedMassMomentum> {};

TEST_P(FroudeSimilarity, HoldsForAnOpeningAndWhatFollows) {
    // The loads swing for as long as they are compared, by steps of the same number in both: rounding of the
    // guards is all that may differ, and grows to 1e-9 at most in a smooth opening.
    const Scene scene = small_scene(GetParam());
    const RunRecord small = run_full(scene), large = run_full(enlarged(scene));
    ASSERT_EQ(small.status.code, StatusCode::completed) << small.status.detail;
    ASSERT_EQ(large.status.code, StatusCode::completed) << large.status.detail;
    EXPECT_EQ(small.cost.steps, large.cost.steps);
    constexpr double tolerance = 1e-9;
    EXPECT_LT(distance(small, large, "time", root_k), tolerance);
    EXPECT_LT(distance(small, large, "altitude", k), tolerance);
    EXPECT_LT(distance(small, large, "speed", root_k), tolerance);
    EXPECT_LT(distance(small, large, "force_raw", k * k * k), tolerance);
    EXPECT_LT(distance(small, large, "projected_area", k * k), tolerance);
    EXPECT_LT(distance(small, large, "added_mass", k * k * k), tolerance);
    EXPECT_LT(distance(small, large, "canopy_airspeed", root_k), tolerance);
    const double ratio = *large.metric("peak_force_raw_N") / *small.metric("peak_force_raw_N");
    EXPECT_NEAR(ratio / (k * k * k), 1.0, tolerance);
    // Compared is more than the opening: the added mass has gone over to the canopy's own shape.
    EXPECT_LT(small.find_event("full-open")->time, 0.6 * test::last(small, "time"));
}

INSTANTIATE_TEST_SUITE_P(Momentum, FroudeSimilarity,
                         testing::Values(AddedMassMomentum::inertia_only, AddedMassMomentum::accreting),
                         [](const auto& of) {
                             return of.param == AddedMassMomentum::accreting ? "Accreting" : "InertiaOnly";
                         });

TEST(FroudeSimilarityOfTheRom, HoldsToTheTolerance) {
    // Nothing in it has a time of its own. Steps are chosen by an absolute tolerance beside the relative one,
    // so that they differ by its size.
    for (const auto momentum : {AddedMassMomentum::inertia_only, AddedMassMomentum::accreting}) {
        const Scene scene = small_scene(momentum);
        const RunRecord small = run_rom(scene), large = run_rom(enlarged(scene));
        for (const char* force : {"peak_force_N", "max_force_N"})
            EXPECT_NEAR(*large.metric(force) / *small.metric(force), k * k * k, 1e-6 * k * k * k) << force;
        EXPECT_NEAR(test::last(large, "speed") / test::last(small, "speed"), root_k, 1e-6);
    }
}

TEST(FroudeSimilarityOfAPack, HoldsForHoldAndRamp) {
    // A pack is chaotic, and its folds resist fully from 1 m/s on in either: the instants themselves
    // agree to a per cent (found: 0.8 %). How long lines have to stay taut before it is a snatch, and how
    // long the ramp takes, are numbers of the model: similar to rounding, in air of one density.
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.aerodynamics.line_drag.reset();
    scene.full.ramp_time.reset();
    scene.stop = {Trigger::Kind::time, 6.0, 0.0};
    const RunRecord small = run_full(scene), large = run_full(enlarged(scene));
    const auto hold = [](const RunRecord& r) {
        return *r.metric("snatch_time_s") - *r.metric("line_stretch_time_s");
    };
    const auto ramp = [](const RunRecord& r) {
        return r.find_event("finite-elements-alone")->time - r.find_event("switch")->time;
    };
    ASSERT_TRUE(small.find_event("finite-elements-alone") && large.find_event("finite-elements-alone"));
    EXPECT_NEAR(hold(small), 2e-3, 1e-12);  // of a C-9
    EXPECT_NEAR(hold(large), root_k * hold(small), 1e-12);
    EXPECT_NEAR(ramp(small), 0.15, 0.001);  // likewise, at 7.7 m/s
    EXPECT_NEAR(ramp(large), root_k * ramp(small), 1e-9);
    const double snatch = root_k * *small.metric("snatch_time_s");
    EXPECT_NEAR(*large.metric("snatch_time_s"), snatch, 0.01 * snatch);
}

}  // namespace
}  // namespace twinchute
