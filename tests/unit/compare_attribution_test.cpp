// Attribution on synthetic models, formulas in place of solvers: every term is known by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include "compare/attribute.hpp"
#include "compare/physics_effects.hpp"
#include "compare/runs_at_once.hpp"
#include "compare/snatch_state.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/predicted.hpp"

namespace twinchute::compare {
namespace {

constexpr double cord = 9.7e8;  // [Pa] of the lines as they are

RunRecord begun(const char* name) {
    RunRecord record;
    record.fidelity = name;
    record.status = {StatusCode::completed, "steady descent"};
    return record;
}

/// 4800 N, 50 more with added mass; fills as prescribed, in 1.6 s.
RunRecord quick(const Scene& scene, Run&) {
    RunRecord record = begun("rom");
    record.add_metric("peak_force_N", 4800.0 + (scene.aerodynamics.added_mass ? 50.0 : 0.0));
    record.add_metric("filling_time_s", 1.6, MetricKind::input);
    record.events = {{"line-stretch", 0.0, 300.0, 21.0}, {"full-open", 1.6, 280.0, 10.0}};
    return record;
}

/// 4810 N; 120 more with added mass, 30 less with line drag, another 8 with both, 5 with lines that stretch,
/// 3 for each of the canopy's own radius, initial phase and breathing; noise adds its seed.
RunRecord dear(const Scene& scene, Run& run) {
    RunRecord record = begun("full");
    if (run.stop.stop_requested()) record.status = {StatusCode::interrupted, "stopped on request"};
    const auto& air = scene.aerodynamics;
    const Parachute& chute = scene.parachutes.front();
    double peak = 4810.0;
    if (air.added_mass) peak += 120.0;
    if (air.line_drag) peak -= 30.0;
    if (air.added_mass && air.line_drag) peak += 8.0;
    if (chute.line.youngs_modulus < 2.0 * cord) peak += 5.0;
    if (air.added_mass && air.added_mass->open_radius == AddedMassRadius::shape_once_open) peak += 3.0;
    if (chute.initial_phase.transit) peak += 3.0;
    if (air.breathing_damping < 1.0) peak += 3.0;
    if (scene.full.noise) peak += static_cast<double>(scene.full.noise->seed);
    record.add_metric("peak_force_N", peak);
    record.add_metric("filling_time_s", air.line_drag ? 1.5 : 2.5);
    record.events = {{"line-stretch", 0.0, 300.0, 21.0}, {"full-open", 1.6, 280.0, 10.0}};
    return record;
}

std::vector<std::string> all_physics(const Scene&) {
    return {};
}
const Fidelity quick_row{"rom", "synthetic quick model", &quick, &all_physics};
const Fidelity dear_row{"full", "synthetic dear model", &dear, &all_physics};

Comparison compared(const Scene& scene, const Fidelity& reference = dear_row,
                    const Fidelity& candidate = quick_row) {
    Comparison comparison;
    Run run;
    comparison.reference = reference.run(scene, run);
    comparison.candidate = candidate.run(scene, run);
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, {});
    return comparison;
}

Attribution attributed(const Scene& scene, const AttributionOptions& options = {},
                       const Fidelity& reference = dear_row, const Fidelity& candidate = quick_row) {
    return attribute(compared(scene, reference, candidate), scene, reference, candidate, options);
}

const MetricAttribution& of(const Attribution& attribution, const char* metric) {
    const auto found = std::ranges::find(attribution.metrics, metric, &MetricAttribution::metric);
    if (found == attribution.metrics.end()) throw std::runtime_error(metric);
    return *found;
}

double effect(const MetricAttribution& metric, const char* effect) {
    const auto term = std::ranges::find(metric.terms, effect, &AttributionTerm::name);
    if (term == metric.terms.end()) throw std::runtime_error(effect);
    return term->effect;
}

double sum(const MetricAttribution& metric) {
    double all = metric.candidate + metric.interaction;
    for (const AttributionTerm& term : metric.terms)
        all += term.effect;
    return all;
}

// Numbers of a few thousand, added some ten times: round-off is below 1e-11 of them.
constexpr double exact = 1e-8;

TEST(CompareAttribution, TermsAreThoseOfTheFormulas) {
    const Attribution attribution = attributed(test::c9_scene());
    const MetricAttribution& peak = of(attribution, "peak_force");
    EXPECT_EQ(peak.candidate, 4850.0);
    EXPECT_EQ(peak.reference, 4922.0);
    EXPECT_NEAR(effect(peak, "structure"), 10.0, exact);
    EXPECT_NEAR(effect(peak, "line-elasticity"), 5.0, exact);
    EXPECT_NEAR(effect(peak, "added-mass"), 70.0, exact);  // 120 in one model, 50 in the other
    EXPECT_NEAR(effect(peak, "line-drag"), -30.0, exact);
    EXPECT_NEAR(effect(peak, "initial-phase"), 3.0, exact);
    EXPECT_NEAR(effect(peak, "breathing"), 3.0, exact);
    EXPECT_NEAR(effect(peak, "own-shape"), 3.0, exact);
    EXPECT_NEAR(peak.interaction, 8.0, exact);  // added mass and line drag together
    EXPECT_NEAR(sum(peak), peak.reference, exact);
    EXPECT_FALSE(peak.scatter);
    EXPECT_TRUE(attribution.seeds.empty());
    EXPECT_TRUE(attribution.notes.empty());
}

TEST(CompareAttribution, AFillingTimeIsPrescribedUntilTheShapeIsTheCanopysOwn) {
    const Attribution attribution = attributed(test::c9_scene());
    const MetricAttribution& filling = of(attribution, "filling_time");
    for (const AttributionTerm& term : filling.terms)
        EXPECT_NEAR(term.effect, term.name == "own-shape" ? -0.1 : 0.0, 1e-12) << term.name;
    EXPECT_NEAR(filling.interaction, 0.0, 1e-12);
}

TEST(CompareAttribution, WhatTheSceneHasNotGotIsNoTerm) {
    Scene scene = test::c9_scene();
    scene.aerodynamics = {};
    scene.parachutes.front().initial_phase = {false, 0.0};
    std::set<std::string> found;
    const Attribution attribution = attributed(scene);
    for (const AttributionTerm& term : of(attribution, "peak_force").terms)
        found.insert(term.name);
    EXPECT_EQ(found, (std::set<std::string>{"structure", "line-elasticity", "own-shape"}));
}

TEST(CompareAttribution, OnlyJudgedMetricsAreAttributed) {
    const Scene scene = test::c9_scene();
    Comparison comparison = compared(scene);
    std::erase_if(comparison.gap.metrics, [](const MetricGap& m) { return m.row->name != "peak_force"; });
    comparison.gap.metrics.front().tolerance.reset();
    EXPECT_TRUE(attribute(comparison, scene, dear_row, quick_row, {}).metrics.empty());
}

TEST(CompareAttribution, SeedsGiveTheScatter) {
    Scene scene = test::c9_scene();
    scene.full.noise = Noise{1e-4, 11};
    AttributionOptions options;
    options.seeds = 4;
    const Attribution attribution = attributed(scene, options);
    EXPECT_EQ(attribution.seeds, (std::vector<std::uint64_t>{11, 12, 13, 14}));
    const MetricAttribution& peak = of(attribution, "peak_force");
    EXPECT_NEAR(peak.scatter.value(), 3.0, exact);
    EXPECT_NEAR(effect(peak, "noise"), 11.0, exact);
    EXPECT_NEAR(of(attribution, "filling_time").scatter.value(), 0.0, exact);
    options.seeds = 1;  // says nothing of a scatter
    EXPECT_FALSE(of(attributed(scene, options), "peak_force").scatter);
}

TEST(CompareAttribution, AnyNumberOfThreadsGivesTheSameBits) {
    Scene scene = test::c9_scene();
    scene.full.noise = Noise{1e-4, 3};
    const Attribution one = attributed(scene);
    AttributionOptions many;
    many.threads = 8;
    const Attribution other = attributed(scene, many);
    ASSERT_EQ(one.metrics.size(), other.metrics.size());
    for (std::size_t i = 0; i < one.metrics.size(); ++i) {
        ASSERT_EQ(one.metrics[i].terms.size(), other.metrics[i].terms.size());
        EXPECT_EQ(one.metrics[i].interaction, other.metrics[i].interaction);
        for (std::size_t k = 0; k < one.metrics[i].terms.size(); ++k)
            EXPECT_EQ(one.metrics[i].terms[k].effect, other.metrics[i].terms[k].effect);
    }
}

TEST(CompareAttribution, ARunThatFailsIsSaidAndGoesIntoTheInteraction) {
    static const Fidelity fragile{"full", "falls over without line drag",
                                  [](const Scene& scene, twinchute::Run& run) {
                                      RunRecord record = dear(scene, run);
                                      if (scene.aerodynamics.added_mass && !scene.aerodynamics.line_drag)
                                          record.status = {StatusCode::energy_grew, "at 1 s"};
                                      return record;
                                  },
                                  &all_physics};
    const Attribution attribution = attributed(test::c9_scene(), {}, fragile);
    const MetricAttribution& peak = of(attribution, "peak_force");
    EXPECT_THROW(effect(peak, "added-mass"), std::runtime_error);
    EXPECT_NEAR(peak.interaction, 78.0, exact);  // 8 and the 70 that could not be seen
    EXPECT_NEAR(sum(peak), peak.reference, exact);
    ASSERT_EQ(attribution.notes.size(), 1u);
    EXPECT_EQ(
        attribution.notes[0],
        "Added mass: full ended as energy_grew, at 1 s; what it would have shown is in the interaction");
}

TEST(CompareAttribution, ASideThatBrokeOffHasNoGapToAttribute) {
    const Scene scene = test::c9_scene();
    Comparison comparison = compared(scene);
    comparison.candidate.status = {StatusCode::solver_failed, "x"};
    const Attribution attribution = attribute(comparison, scene, dear_row, quick_row, {});
    EXPECT_TRUE(attribution.metrics.empty());
    ASSERT_EQ(attribution.notes.size(), 1u);
    EXPECT_NE(attribution.notes[0].find("rom ended as solver_failed"), std::string::npos);
}

TEST(CompareAttribution, AnInterruptAttributesNothing) {
    std::stop_source stop;
    stop.request_stop();
    AttributionOptions options;
    options.stop = stop.get_token();
    const Scene scene = test::c9_scene();
    const Attribution attribution = attribute(compared(scene), scene, dear_row, quick_row, options);
    EXPECT_TRUE(attribution.metrics.empty());
    ASSERT_EQ(attribution.notes.size(), 1u);
    EXPECT_NE(attribution.notes[0].find("interrupted"), std::string::npos);
}

TEST(CompareAttribution, WhatARunThrowsIsThrown) {
    static const Fidelity thrower{
        "full", "throws",
        [](const Scene&, twinchute::Run&) -> RunRecord { throw std::runtime_error("out of luck"); },
        &all_physics};
    const std::vector<RunJob> jobs(3, RunJob{&thrower, test::c9_scene()});
    EXPECT_THROW(run_jobs(jobs, 2, {}, {}), std::runtime_error);
}

TEST(CompareAttribution, ProgressOfAllRunsTogetherEndsAtOne) {
    double last = 0.0;
    const std::vector<RunJob> jobs(5, RunJob{&quick_row, test::c9_scene()});
    run_jobs(jobs, 3, {}, [&](const Progress& progress) {
        EXPECT_GE(progress.share, last - 1e-12);
        last = progress.share;
    });
    EXPECT_NEAR(last, 1.0, 1e-12);
}

// --- packed scenes
// ---------------------------------------------------------------------------------------------

/// A peak of 10 N for each m/s of the snatch speed and each 100 m of altitude; packed, a snatch at 20 m/s, 70
/// m and 3 s, and 1 N less.
RunRecord packed_quick(const Scene& scene, Run&) {
    RunRecord record = begun("rom");
    const bool packed = scene.parachutes.front().deploy.starts_packed();
    const double speed = packed ? 20.0 : scene.release.speed,
                 altitude = packed ? 70.0 : scene.release.altitude;
    const double snatch = packed ? 3.0 : 0.0;
    record.add_metric("peak_force_N", 10.0 * speed + 0.1 * altitude - (packed ? 1.0 : 0.0));
    record.add_metric("snatch_speed_m_s", speed);
    record.add_metric("flight_time_s", snatch + 8.0);
    if (packed) record.add_metric("snatch_force_N", 900.0);
    record.events = {{packed ? "snatch" : "line-stretch", snatch, altitude, speed},
                     {"full-open", snatch + 1.6, 0.0, 0.0}};
    record.channels = {{"time", "s", {0.0, 2.0, 4.0}}, {"vertical_speed", "m/s", {0.0, -20.0, -20.0}}};
    return record;
}

/// A peak as packed_quick's and 40 N more; packed, a snatch at 22 m/s, 60 m and 2.5 s, and another 7 N.
RunRecord packed_dear(const Scene& scene, Run&) {
    RunRecord record = begun("full");
    const bool packed = scene.parachutes.front().deploy.starts_packed();
    const double speed = packed ? 22.0 : scene.release.speed,
                 altitude = packed ? 60.0 : scene.release.altitude;
    const double snatch = packed ? 2.5 : 0.0;
    record.add_metric("peak_force_N", 10.0 * speed + 0.1 * altitude + 40.0 + (packed ? 7.0 : 0.0));
    record.add_metric("snatch_speed_m_s", speed);
    record.add_metric("flight_time_s", snatch + 9.0);
    if (packed) record.add_metric("snatch_force_N", 1500.0);
    record.events = {{packed ? "snatch" : "line-stretch", snatch, altitude, speed},
                     {"full-open", snatch + 1.6, 0.0, 0.0}};
    record.channels = {{"time", "s", {0.0, 2.0, 4.0}}, {"vertical_speed", "m/s", {0.0, -20.0, -20.0}}};
    return record;
}

TEST(CompareAttribution, APackedSceneIsBegunAnewAtItsSnatch) {
    static const Fidelity rom{"rom", "", &packed_quick, &all_physics};
    static const Fidelity full{"full", "", &packed_dear, &all_physics};
    const Scene scene = test::packed_c9(DeployBy::static_line);
    Comparison comparison = compared(scene, full, rom);
    const Tolerance tolerance{0.1, true};
    comparison.gap = measure_gap(comparison.reference, comparison.candidate,
                                 {{"peak_force", tolerance},
                                  {"snatch_speed", tolerance},
                                  {"snatch_force", tolerance},
                                  {"flight_time", tolerance}});
    AttributionOptions options;
    options.seeds = 1;
    const Attribution attribution = attribute(comparison, scene, full, rom, options);
    const MetricAttribution& peak = of(attribution, "peak_force");
    EXPECT_NEAR(effect(peak, "snatch-speed"), 20.0, 1e-6);        // 2 m/s
    EXPECT_NEAR(effect(peak, "snatch-state"), -1.0 + 1.0, 1e-6);  // 10 m lower, and the 1 N of the pack
    EXPECT_NEAR(effect(peak, "structure"), 40.0, 1e-6);
    EXPECT_NEAR(effect(peak, "drawing-out"), 7.0, 1e-6);
    EXPECT_NEAR(peak.interaction, 0.0, 1e-6);
    EXPECT_NEAR(effect(of(attribution, "snatch_speed"), "snatch-speed"), 2.0, 1e-9);
    EXPECT_NEAR(effect(of(attribution, "snatch_force"), "deployment"), 600.0, 1e-9);
    // From release both fly on for another 8 s and 9 s: half a second less until the snatch, one second more
    // after.
    const MetricAttribution& flight = of(attribution, "flight_time");
    EXPECT_NEAR(effect(flight, "snatch-state"), -0.5, 1e-9);
    EXPECT_NEAR(effect(flight, "structure"), 1.0, 1e-9);
    EXPECT_NEAR(flight.interaction, 0.0, 1e-9);
}

TEST(CompareAttribution, TheStateAtSnatchIsThatAfterItsJump) {
    // Lines without weight lock up at 1 s: 30 m/s east and 40 m/s down become 24 and 32 at once, places go
    // on.
    RunRecord record;
    record.add_metric("snatch_speed_m_s", 40.0);
    record.events = {{"snatch", 1.0, 100.0, 40.0}};
    record.channels = {{"time", "s", {0.0, 1.0, 1.0, 2.0}},
                       {"east", "m", {0.0, 30.0, 30.0, 54.0}},
                       {"speed", "m/s", {50.0, 50.0, 40.0, 40.0}},
                       {"vertical_speed", "m/s", {-40.0, -40.0, -32.0, -32.0}}};
    const auto state = snatch_state(record, test::c9_scene().release);
    ASSERT_TRUE(state);
    EXPECT_NEAR(state->place.x(), 30.0, 1e-12);
    EXPECT_NEAR(state->payload_velocity.x(), 24.0, 1e-9);
    EXPECT_NEAR(state->payload_velocity.z(), -32.0, 1e-9);
}

TEST(CompareAttribution, EverySwitchedEffectChangesTheSceneAndHasAName) {
    std::set<std::string_view> names;
    for (const PhysicsEffect& effect : physics_effects()) {
        EXPECT_TRUE(names.insert(effect.name).second) << effect.name;
        EXPECT_FALSE(effect.title.empty() || effect.why.empty()) << effect.name;
        EXPECT_EQ(find_physics_effect(effect.name), &effect);
        EXPECT_TRUE(effect.switching != Switching::never || !effect.level.empty()) << effect.name;
    }
    // One that comes back on top of everything else, whether the filling is told or not.
    for (const Scene& scene : {test::c9_scene(), test::predicted(test::c9_scene())})
        EXPECT_EQ(std::ranges::count_if(physics_effects(),
                                        [&](const PhysicsEffect& effect) {
                                            return effect.switching == Switching::last &&
                                                   effect.present(scene);
                                        }),
                  1);
}

TEST(CompareAttribution, StillAirKeepsTheReleaseThroughTheAir) {
    Scene scene = test::c9_scene();
    scene.environment.wind = uniform_wind({4.0, -2.0, 0.0});
    silence(*find_physics_effect("wind"), scene);
    EXPECT_FALSE(scene.environment.wind);
    // 21 m/s straight down over ground through that wind.
    EXPECT_NEAR(scene.release.speed, std::sqrt(21.0 * 21.0 + 20.0), 1e-12);
    EXPECT_NEAR(std::tan(scene.release.path_angle), 21.0 / std::sqrt(20.0), 1e-9);
    EXPECT_NEAR(std::sin(scene.release.heading), -4.0 / std::sqrt(20.0), 1e-12);  // against the wind
    EXPECT_NEAR(std::cos(scene.release.heading), 2.0 / std::sqrt(20.0), 1e-12);
}

}  // namespace
}  // namespace twinchute::compare
