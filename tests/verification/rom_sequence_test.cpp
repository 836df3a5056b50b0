// Reefing, sequences and clusters of the reduced-order model: limits that reduce to simpler scenes, and exact
// solutions of what happens in between.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/scene/drag_area.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "rom/canopy_force.hpp"
#include "rom/fidelity.hpp"
#include "rom/rigid_composite.hpp"
#include "tests/support/runs.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using namespace test;

double metric_of_sequence(const RunRecord& record, const std::string& key) {
    const auto value = record.metric(key);
    EXPECT_TRUE(value) << key << ", " << record.status.detail;
    return value.value_or(std::nan(""));
}

double time_of(const RunRecord& record, const char* event) {
    const Event* found = record.find_event(event);
    EXPECT_NE(found, nullptr) << event;
    return found != nullptr ? found->time : std::nan("");
}

/// The good scene with more keys of its parachute.
std::string with(const std::string& keys) {
    return edited(edited(good_scene, "[aerodynamics]\n", keys + "[aerodynamics]\n"), "time = \"6 s\"",
                  "time = \"20 s\"");
}

const std::string one_stage = R"([[parachute.reefing]]
drag_area_ratio = 0.1
until = { at = "line-stretch", delay = "4 s" }
)";

const std::string sequence = R"(schema = 1
name = "sequence"
[environment]
atmosphere = { density = "1 kg/m^3" }
[payload]
mass = "100 kg"
[release]
altitude = "1000 m"
speed = "50 m/s"
path_angle = "-90 deg"
[[parachute]]
name = "drogue"
design = "usaf-c9"
drag_area = "2 m^2"
mass = "1 kg"
deploy = { by = "line-stretch", when = { at = "apogee", delay = "2 s" } }
fill_time = { time = "0.5 s" }
initial_phase = "0 s"
cut = { after = "main.full-open", delay = "0.25 s" }
[[parachute]]
name = "main"
design = "usaf-c9"
mass = "4 kg"
deploy = { by = "line-stretch", when = { height = "300 m" } }
fill_time = { time = "1 s" }
initial_phase = "0 s"
[stop]
at = "steady-descent"
)";

void expect_same_flight(const RunRecord& a, const RunRecord& b, double relative) {
    for (const char* key : {"peak_force_N", "descent_rate_m_s", "max_deceleration_g"})
        EXPECT_NEAR(metric_of_sequence(a, key), metric_of_sequence(b, key),
                    relative * std::abs(metric_of_sequence(b, key)))
            << key;
    EXPECT_NEAR(a.find_channel("altitude")->values.back(), b.find_channel("altitude")->values.back(),
                relative * 300.0);
}

TEST(RomSequence, AReefingLineCutAtOnceIsNone) {
    const RunRecord plain = run_rom(read_text(with("")));
    const RunRecord cut = run_rom(read_text(with(one_stage), {"parachute.reefing.1.until.delay=0 s"}));
    // Not a bit differs: the canopy has not begun to fill when the line goes.
    EXPECT_EQ(plain.find_channel("force")->values, cut.find_channel("force")->values);
    EXPECT_EQ(metric_of_sequence(plain, "peak_force_N"), metric_of_sequence(cut, "peak_force_N"));
}

TEST(RomSequence, AReefingLineThatIsNeverCutMakesASmallerParachute) {
    // The reefed canopy is one with a tenth of the drag area: eta^2 and R_0 as shares of that. Its filling
    // takes sqrt(g) of what follows the initial phase, g = (0.1 - 0.04)/(1 - 0.04) (opening.hpp).
    const Scene reefed =
        read_text(with(one_stage), {"parachute.reefing.1.until.delay=100 s", "rom.rtol=1e-10"});
    Scene small = read_text(with(""), {"rom.rtol=1e-10"});
    Parachute& p = small.parachutes.front();
    const double initial = 0.5 * p.nominal_diameter / 21.0, whole = 4.0 * p.nominal_diameter / 21.0;
    p.initial_drag_area_ratio = 0.4;
    p.drag_area *= 0.1;
    p.projected_diameter_ratio *= std::sqrt(0.1);
    p.fill_time = {find_fill_time("given"), 0.0, 0.0, initial + (whole - initial) * std::sqrt(0.06 / 0.96)};
    // Both are integrated to 1e-10; sums of a few terms apart by rounding alone, unless that changes a step.
    const RunRecord a = run_rom(reefed), b = run_rom(small);
    EXPECT_NEAR(metric_of_sequence(a, "peak_force_N"), metric_of_sequence(b, "peak_force_N"),
                1e-7 * metric_of_sequence(b, "peak_force_N"));
    EXPECT_NEAR(time_of(a, "reefed-open"), time_of(b, "full-open"), 1e-12);
    EXPECT_NEAR(a.find_channel("altitude")->values.back(), b.find_channel("altitude")->values.back(), 1e-5);
}

TEST(RomSequence, ACutterFiresExactlyAfterItsDelay) {
    const RunRecord record = run_rom(read_text(with(one_stage)));
    EXPECT_EQ(time_of(record, "disreef"), 4.0);
    // The second stage begins at a tenth: sqrt(1 - g) of a whole filling at the speed of that instant,
    // without its initial phase of half a diameter, which no later stage has.
    const double whole = (4.0 - 0.5) * 8.53 / record.find_event("disreef")->speed;
    EXPECT_NEAR(metric_of_sequence(record, "stage_2_filling_time_s"), whole * std::sqrt(1.0 - 0.06 / 0.96),
                1e-6 * whole);
    EXPECT_EQ(time_of(record, "full-open"), 4.0 + metric_of_sequence(record, "stage_2_filling_time_s"));
    // The drag area goes on from where it was: 0.1 (C_D S)_0.
    const auto& time = record.find_channel("time")->values;
    const auto& area = record.find_channel("drag_area")->values;
    const double open = area.back();
    for (std::size_t i = 1; i < time.size(); ++i)
        if (time[i] == 4.0) {
            EXPECT_NEAR(area[i], 0.1 * open, 1e-12 * open);
        }
}

TEST(RomSequence, StagesTakeTheirPartsOfOneFilling) {
    // For stages that follow each other without a wait at one speed, the squares of the filling times add up
    // to the square of the whole: g goes from 0 to 1.
    const Scene scene = read_text(with(R"([[parachute.reefing]]
drag_area_ratio = 0.2
until = { time = "9 s" }
[[parachute.reefing]]
drag_area_ratio = 0.6
until = { time = "9 s" }
)"));
    Parachute without = scene.parachutes.front();
    without.initial_phase = {false, 0.0};
    Inflation stage = make_inflation(scene, without, 0.0, 30.0, 1.0);
    double squares = stage.filling_time * stage.filling_time;
    for (std::size_t k = 1; k <= 2; ++k) {
        stage = next_stage(scene, without, k, stage, Phase::open, 10.0 * static_cast<double>(k), 30.0, 1.0);
        squares += stage.filling_time * stage.filling_time;
    }
    const double whole = without.fill_time.seconds(fill_inputs(scene, without, 30.0, 1.0));
    EXPECT_NEAR(squares, whole * whole, 1e-12 * whole * whole);
    EXPECT_DOUBLE_EQ(stage.steady_drag_area, without.drag_area);
}

TEST(RomSequence, AParachuteOfNoSizeChangesNothing) {
    const Scene one = read_text(with(""));
    Scene two = one;
    Parachute& none = two.parachutes.emplace_back(one.parachutes.front());
    none.name = "none";
    none.drag_area = none.mass = 1e-13;
    none.projected_diameter_ratio = 1e-6;
    // The second has 1e-13 of 42 m2 and 5 kg: what is left is the integration's 1e-8.
    expect_same_flight(run_rom(two), run_rom(one), 1e-7);
}

TEST(RomSequence, AClusterWithoutLagIsOneParachute) {
    Scene cluster = read_text(with("count = 3\n"), {"payload.mass=450 kg"});
    Scene one = cluster;
    Parachute& p = one.parachutes.front();
    p.count = 1;
    p.drag_area *= 3.0;
    p.mass *= 3.0;
    p.projected_diameter_ratio *= std::cbrt(3.0);  // three times the air
    const RunRecord three = run_rom(cluster);
    expect_same_flight(three, run_rom(one), 1e-7);
    // Each carries a third.
    const auto& each = three.find_channel("canopy_force")->values;
    const auto& all = three.find_channel("force")->values;
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_NEAR(each[i], all[i] / 3.0, 1e-12 * all[i]);
}

TEST(RomSequence, AClusterHasTheShockCoefficientOfEach) {
    const Scene cluster = read_text(with("count = 3\n"), {"payload.mass=450 kg"});
    const Scene one = read_text(with(""), {"payload.mass=150 kg"});
    const RunRecord three = run_rom(cluster), single = run_rom(one);
    EXPECT_NEAR(*three.metric("opening_shock_coefficient") / *single.metric("opening_shock_coefficient"), 1.0,
                1e-6);
}

// One is never reefed and opens first; the other's line is cut after 4 s. Filling ends with the last one, and
// the impulse is that of the force until then.
TEST(RomSequence, FillingOfAClusterEndsWithItsLastCanopy) {
    const RunRecord record = run_rom(read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-reefed.toml",
                                                {"parachute.count=2", "parachute.skips_reefing=1",
                                                 "parachute.lag=[0, 0.1]", "payload.mass='300 kg'"}));
    const double begin = record.find_event("line-stretch")->time, end = record.find_event("full-open")->time;
    EXPECT_GT(end, 4.0);
    EXPECT_NEAR(*record.metric("filling_time_s"), end - begin, 1e-9);
    const auto &t = record.find_channel("time")->values, &force = record.find_channel("force")->values;
    double impulse = 0.0;
    for (std::size_t i = 1; i < t.size() && t[i] <= end; ++i)
        impulse += 0.5 * (force[i] + force[i - 1]) * (t[i] - t[i - 1]);
    EXPECT_NEAR(*record.metric("impulse_N_s") / impulse, 1.0, 2e-3);  // straight lines between rows
}

TEST(RomSequence, ThePeakIsWhereTheHistoryHasIt) {
    for (const char* name : {"c9-inflation", "c9-crosswind", "personnel"}) {
        const RunRecord record =
            run_rom(read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/" + std::string(name) + ".toml"));
        const Event peak = *record.find_event("peak-force");
        const auto at = [&](const char* channel) {
            const auto &t = record.find_channel("time")->values, &y = record.find_channel(channel)->values;
            const auto i = static_cast<std::size_t>(std::ranges::upper_bound(t, peak.time) - t.begin());
            return y[i - 1] + (peak.time - t[i - 1]) / (t[i] - t[i - 1]) * (y[i] - y[i - 1]);
        };
        // Between rows h apart a path bends by h^2/8 of its acceleration.
        const auto& t = record.find_channel("time")->values;
        const auto i = static_cast<std::size_t>(std::ranges::upper_bound(t, peak.time) - t.begin());
        const double h = t[i] - t[i - 1];
        EXPECT_NEAR(peak.altitude, at("altitude"), h * h / 8.0 * g * *record.metric("max_deceleration_g"))
            << name;
        EXPECT_NEAR(peak.speed, at("speed"), 1e-6) << name;
    }
}

/// Balance of the pull of two canopies, one a second late, on the confluence in a flight across the wind of
/// their own speed, with the pull on the payload in the equation of motion: one law, summed.
void expect_balance(const Scene& scene, const AddedMassSpec* added_mass) {
    const FlightState at_snatch{0.0, 300.0, -20.0, 22.0, 1.225};
    OpeningSequence openings(scene);
    openings.release(at_snatch);
    constexpr double t = 1.3;  // [s] the first nearly full, the second in its initial phase
    while (openings.next_time() <= t)
        openings.advance({openings.next_time(), 280.0, -20.0, 22.0, 1.225});
    rom::RigidComposite<2> model;
    model.atmosphere = scene.environment.atmosphere;
    model.canopies = &openings;
    model.gravity = g;
    model.payload_mass = scene.payload.mass;
    model.payload_drag_area = 1.0;
    model.added_mass = added_mass;
    const rom::Motion<2> motion{{0.0, 280.0}, {9.0, -20.0}};
    const auto loads = model.loads(t, motion);
    const rom::CanopyAir<2> shared{
        t, loads.density, g, 0.0, added_mass, model.accretes(), loads.airspeed, loads.acceleration};
    rom::Vec<2> sum = rom::Vec<2>::Zero(), drag = rom::Vec<2>::Zero(), own = rom::Vec<2>::Zero();
    std::vector<double> each;
    for (const Canopy& c : openings.all()) {
        const rom::Vec<2> pull = rom::canopy_force<2>(c, openings, shared);
        each.push_back(pull.norm());
        sum += c.count * pull;
        drag += c.count * rom::drag_of<2>(loads.density, OpeningSequence::drag_area_of(c, t), loads.airspeed);
        own += c.count * c.chute->mass * (loads.acceleration + g * rom::Vec<2>::UnitY());
    }
    // Forces of 1e4 N out of sums of a few terms of that size: 1e-12 is a hundred roundings.
    const double force = model.opening_force(loads);
    EXPECT_NEAR(sum.norm(), force, 1e-12 * force);
    const rom::Vec<2> payload_drag = rom::drag_of<2>(loads.density, 1.0, loads.airspeed);
    const rom::Vec<2> pulled =
        scene.payload.mass * (loads.acceleration + g * rom::Vec<2>::UnitY()) - payload_drag;
    EXPECT_NEAR((sum - pulled).norm(), 0.0, 1e-12 * force);
    // Without air that moves along: drag is the opening force and what their own inertia and weight take.
    if (!added_mass) {
        EXPECT_NEAR((drag - pulled - own).norm(), 0.0, 1e-12 * force);
    }
    EXPECT_GT(each[0], 1.5 * each[1]);
}

TEST(RomSequence, WhatTheCanopiesPullIsTogetherTheOpeningForce) {
    const Scene scene = read_text(with("count = 2\nlag = [0, \"1 s\"]\n"), {"payload.mass=300 kg"});
    expect_balance(scene, nullptr);
    AddedMassSpec air = *scene.aerodynamics.added_mass;
    for (const AddedMassMomentum momentum : {AddedMassMomentum::inertia_only, AddedMassMomentum::accreting}) {
        air.momentum = momentum;
        expect_balance(scene, &air);
    }
}

TEST(RomSequence, ThePeakOfOneCanopyIsFoundBetweenTheRows) {
    const RunRecord record =
        run_rom(read_text(with("count = 2\nlag = [0, \"1 s\"]\n"), {"payload.mass=300 kg"}));
    const double peak = metric_of_sequence(record, "peak_canopy_force_N"),
                 rows = std::ranges::max(record.find_channel("canopy_force")->values);
    EXPECT_GE(peak, rows * (1.0 - 1e-12));
    EXPECT_NEAR(peak, rows, 1e-3 * peak);  // steps of the integrator hold four rows each
    const std::string& note = record.find_metric("peak_canopy_force_N")->note;
    EXPECT_TRUE(note.starts_with("1 of 2 USAF C-9, lag 0 s, at t = ")) << note;
    EXPECT_LT(peak, metric_of_sequence(record, "peak_force_N"));
}

TEST(RomSequence, LagEasesThePayloadAndLoadsTheFirstCanopy) {
    // One of three canopies that is alone for a while takes more than a third of the peak that all three
    // together would have had, while the sum of all falls.
    const auto run = [](const char* lag) {
        return run_rom(read_text(with(std::string("count = 3\n") + lag), {"payload.mass=450 kg"}));
    };
    const RunRecord together = run(""), late = run("lag = [0, \"0.6 s\", \"1.2 s\"]\n");
    EXPECT_LT(metric_of_sequence(late, "peak_force_N"), metric_of_sequence(together, "peak_force_N"));
    EXPECT_GT(metric_of_sequence(late, "peak_canopy_force_N"),
              1.05 * metric_of_sequence(together, "peak_canopy_force_N"));
    EXPECT_NEAR(metric_of_sequence(together, "peak_canopy_force_N"),
                metric_of_sequence(together, "peak_force_N") / 3.0,
                1e-9 * metric_of_sequence(together, "peak_force_N"));
}

TEST(RomSequence, OneCanopyAtATimeHasNoForceOfItsOwn) {
    EXPECT_FALSE(run_rom(read_text(with(""))).find_metric("peak_canopy_force_N"));
    EXPECT_FALSE(run_rom(read_text(with(""))).find_channel("canopy_force"));
    // Let go before the next one is out.
    const std::string apart = edited(sequence, "cut = { after = \"main.full-open\", delay = \"0.25 s\" }",
                                     "cut = { height = \"310 m\" }");
    EXPECT_FALSE(run_rom(read_text(apart)).find_metric("max_canopy_force_N"));
    // Two at once: the main pulls most.
    const RunRecord both = run_rom(read_text(sequence));
    EXPECT_TRUE(both.find_metric("peak_canopy_force_N")->note.starts_with("main at t = "));
    EXPECT_LT(metric_of_sequence(both, "peak_canopy_force_N"), metric_of_sequence(both, "peak_force_N"));
}

TEST(RomSequence, TheOneThatOpensFirstCarriesMore) {
    const RunRecord lag =
        run_rom(read_text(with("count = 2\nlag = [0, \"1 s\"]\n"), {"payload.mass=300 kg"}));
    const auto& time = lag.find_channel("time")->values;
    const auto& each = lag.find_channel("canopy_force")->values;
    const auto& all = lag.find_channel("force")->values;
    const double snatch_to_full = 4.0 * 8.53 / 21.0;
    EXPECT_NEAR(time_of(lag, "full-open"), snatch_to_full + 1.0, 1e-12);  // the last of them
    double most = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (time[i] < snatch_to_full && all[i] > 0.0) most = std::max(most, each[i] / all[i]);
        if (time[i] > snatch_to_full + 1.0) {
            EXPECT_NEAR(each[i], 0.5 * all[i], 1e-12 * all[i]);
        }
    }
    // At 1.2 s the first has 0.5 of its drag area and the second, a second behind, still 0.04.
    EXPECT_GT(most, 0.85);
}

TEST(RomSequence, EverythingHappensAtItsTime) {
    const RunRecord record = run_rom(read_text(sequence));
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    // Up and down again without drag: apogee at v/g. The root is found to 1e-8 of its time.
    EXPECT_NEAR(time_of(record, "drogue.line-stretch"), 50.0 / g + 2.0, 1e-7);
    EXPECT_NEAR(time_of(record, "drogue.full-open"), time_of(record, "drogue.line-stretch") + 0.5, 1e-12);
    EXPECT_NEAR(record.find_event("main.line-stretch")->altitude, 300.0, 1e-6);
    EXPECT_NEAR(time_of(record, "main.full-open"), time_of(record, "main.line-stretch") + 1.0, 1e-12);
    EXPECT_NEAR(time_of(record, "drogue.cut"), time_of(record, "main.full-open") + 0.25, 1e-12);
    // m g = 1/2 rho C_D S v^2 with the drogue's kilogram gone, to what a steady descent may still be off.
    const double steady = std::sqrt(2.0 * 104.0 * g / read_text(sequence).parachutes[1].drag_area);
    EXPECT_NEAR(metric_of_sequence(record, "descent_rate_m_s"), steady, steady_descent_remaining * steady);
    // The drogue, with both parachutes' mass below it, fell from the apogee to 300 m: as fast as it ever
    // will.
    const double under_drogue = std::sqrt(2.0 * 105.0 * g / 2.0);
    EXPECT_NEAR(metric_of_sequence(record, "drogue_descent_rate_m_s"), under_drogue, 1e-3 * under_drogue);
    EXPECT_NE(record.find_metric("drogue_descent_rate_m_s")->note.find("; steady"), std::string::npos);
    EXPECT_FALSE(record.metric("main_descent_rate_m_s"));  // that is descent_rate_m_s
    // The force is that on the payload: packs that are closed ride on it.
    EXPECT_NEAR(record.find_channel("force")->values.back(), 100.0 * g, 0.01 * 100.0 * g);
}

TEST(RomSequence, TheOrderOfTheTablesIsNone) {
    Scene turned = read_text(sequence);
    std::swap(turned.parachutes[0], turned.parachutes[1]);
    const RunRecord a = run_rom(read_text(sequence)), b = run_rom(turned);
    for (const char* key : {"peak_force_N", "main_peak_force_N", "drogue_peak_force_N", "descent_rate_m_s"})
        EXPECT_NEAR(metric_of_sequence(a, key), metric_of_sequence(b, key),
                    1e-12 * metric_of_sequence(b, key))
            << key;
    EXPECT_EQ(a.events.size(), b.events.size());
}

TEST(RomSequence, AHeightIsMetOnTheWayDown) {
    // From 200 m the climb goes through 300 m, up to 327 m, and comes back.
    const RunRecord record = run_rom(read_text(sequence, {"release.altitude=200 m"}));
    EXPECT_GT(time_of(record, "main.line-stretch"), 50.0 / g);
    EXPECT_NEAR(record.find_event("main.line-stretch")->altitude, 300.0, 1e-6);
}

TEST(RomSequence, ADynamicPressureThatIsMetForAShortWhileIsSeen) {
    // Below 1 Pa, 1.41 m/s, for 0.29 s about apogee; a parabola asks for no step as short as that.
    std::string text =
        edited(sequence, "when = { height = \"300 m\" }", "when = { dynamic_pressure = \"1 Pa\" }");
    text = edited(text, "cut = { after = \"main.full-open\", delay = \"0.25 s\" }\n", "");
    const RunRecord record = run_rom(read_text(text));
    EXPECT_NEAR(time_of(record, "main.line-stretch"), (50.0 - std::sqrt(2.0)) / g, 1e-6);
}

TEST(RomSequence, DynamicPressureAndSteadyDescentAreMetInFlight) {
    std::string text =
        edited(sequence, "when = { height = \"300 m\" }", "when = { dynamic_pressure = \"600 Pa\" }");
    text = edited(text, "cut = { after = \"main.full-open\", delay = \"0.25 s\" }\n", "");
    text = edited(text, "when = { at = \"apogee\", delay = \"2 s\" }", "when = { time = \"12 s\" }");
    RunRecord record = run_rom(read_text(text));
    // At 12 s it falls at 12 g - 50 = 67.7 m/s, 2290 Pa; under the drogue that falls to 600 Pa: 34.6 m/s. Met
    // at once at release, where q is 1250 Pa, it would not be; at apogee q is 0.
    EXPECT_LT(time_of(record, "main.line-stretch"), 50.0 / g);
    EXPECT_NEAR(record.find_event("main.line-stretch")->speed, std::sqrt(2.0 * 600.0), 1e-6);
    text = edited(text, "when = { dynamic_pressure = \"600 Pa\" }",
                  "when = { at = \"steady-descent\", delay = \"1 s\" }");
    record = run_rom(read_text(text, {"parachute.drogue.deploy.when.time=0 s"}));
    EXPECT_NEAR(time_of(record, "main.line-stretch"), time_of(record, "steady-descent") + 1.0, 1e-12);
    EXPECT_NEAR(record.find_event("main.line-stretch")->speed, std::sqrt(2.0 * 105.0 * g / 2.0), 0.2);
}

TEST(RomSequence, AMortarThrowsThePackToTheEndOfItsLines) {
    // Without air both fall alike: lines of 7.31 + 1.22 m are drawn out in their length over the muzzle
    // speed, and momentum is that of a free fall at snatch. 1e-7: integration, on metres and seconds.
    std::string text = edited(sequence, "density = \"1 kg/m^3\"", "density = \"1e-12 kg/m^3\"");
    text = edited(text, "by = \"line-stretch\", when = { at = \"apogee\", delay = \"2 s\" }",
                  "by = \"mortar\", muzzle_speed = \"30 m/s\", when = { at = \"apogee\", delay = \"2 s\" }");
    Scene scene = read_text(text);
    scene.stop = {Trigger::Kind::time, 9.0, 0.0};
    const RunRecord record = run_rom(scene);
    const double fired = 50.0 / g + 2.0, taut = time_of(record, "drogue.line-stretch");
    EXPECT_NEAR(taut, fired + (7.31 + 1.22) / 30.0, 1e-7);
    // 104 kg of payload with the main recoil against 1 kg of pack.
    EXPECT_NEAR(record.find_event("drogue.line-stretch")->speed, g * (taut - 50.0 / g) + 30.0 / 105.0, 1e-6);
    const double snatch = time_of(record, "drogue.snatch");
    EXPECT_NEAR(record.find_event("drogue.snatch")->speed, g * (snatch - 50.0 / g), 1e-6);
}

/// The text of a sequence whose main waits for something that never comes.
std::string without_main(const std::string& when) {
    return edited(edited(sequence, "when = { height = \"300 m\" }", "when = { " + when + " }"),
                  "cut = { after = \"main.full-open\", delay = \"0.25 s\" }\n", "");
}

bool warns(const RunRecord& record, const std::string& what) {
    return std::ranges::any_of(record.warnings, [&](const Warning& w) { return w.what == what; });
}

TEST(RomSequence, AParachuteThatNeverOpensIsNamed) {
    // A height of 0 is met on the ground only, 2 kPa never in a fall under the drogue after they were passed
    // on the way up, 1000 s after landing. The ground is what the scene stops at, or comes before it.
    for (const char* when :
         {"height = \"0 ft\"", "time = \"1000 s\"", "at = \"steady-descent\", delay = \"900 s\""})
        for (const char* stop : {"ground", "steady-descent"}) {
            const RunRecord record =
                run_rom(read_text(without_main(when), {std::string("stop.at=\"") + stop + "\""}));
            EXPECT_EQ(record.status.code, StatusCode::not_opened) << when << stop << record.status.detail;
            EXPECT_NE(record.status.detail.find("main never opened (deploy.when, "), std::string::npos)
                << record.status.detail;
            EXPECT_TRUE(warns(record, "main never opened")) << when;
            ASSERT_TRUE(record.find_metric("unopened_parachutes")) << when;
            EXPECT_EQ(metric_of_sequence(record, "unopened_parachutes"), 1.0);
            EXPECT_EQ(record.find_metric("unopened_parachutes")->note, "main");
        }
    const RunRecord opened = run_rom(read_text(sequence, {"stop.at=\"ground\""}));
    EXPECT_EQ(opened.status.code, StatusCode::completed);
    EXPECT_FALSE(opened.find_metric("unopened_parachutes"));
}

TEST(RomSequence, AStopBeforeTheDeploymentIsNoFailure) {
    for (const char* stop : {"stop.time=12 s", "stop.height=400 m"}) {
        const RunRecord record = run_rom(read_text(sequence, {stop}));
        EXPECT_EQ(record.find_event("main.line-stretch"), nullptr);
        EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
        EXPECT_FALSE(record.find_metric("unopened_parachutes"));
    }
    // The ground by another name is the ground.
    const RunRecord landed = run_rom(read_text(without_main("height = 0"), {"stop.height=0"}));
    EXPECT_EQ(landed.status.code, StatusCode::not_opened) << landed.status.detail;
}

TEST(RomSequence, AReefingLineThatIsNotCutBeforeTheGroundIsAFailureAndAHalfFullCanopyAWarning) {
    const RunRecord reefed = run_rom(read_text(edited(with(one_stage), "time = \"20 s\"", "at = \"ground\""),
                                               {"parachute.reefing.1.until.delay=100 s"}));
    EXPECT_EQ(reefed.status.code, StatusCode::not_opened);
    EXPECT_NE(reefed.status.detail.find("(reefing.1.until, line-stretch and 100 s, was due at 100 s)"),
              std::string::npos)
        << reefed.status.detail;
    // From 20 m at 21 m/s it is down within a second; filling takes 1.6 s.
    const RunRecord low =
        run_rom(read_text(edited(with(""), "time = \"20 s\"", "at = \"ground\""), {"release.height=20 m"}));
    EXPECT_EQ(low.status.code, StatusCode::completed) << low.status.detail;
    EXPECT_TRUE(warns(low, "on the ground before the canopy was full"));
    ASSERT_EQ(low.missing.size(), 3u);  // nor is the ground an excuse for the metrics
    EXPECT_EQ(low.missing[0].metric, "filling_time_s");
    EXPECT_EQ(low.missing[1].metric, "peak_force_N");  // it might have pulled harder yet
    EXPECT_EQ(low.missing[2].metric, "descent_rate_m_s");
    EXPECT_TRUE(std::ranges::none_of(low.missing, &MissingMetric::not_reached));
}

TEST(RomSequence, MetricsThatTheStopComesBeforeAreNotReached) {
    const auto missing = [](const char* stop) {
        std::map<std::string, bool> by_key;
        for (const MissingMetric& row : run_rom(read_text(with(""), {stop})).missing)
            by_key[row.metric] = row.not_reached;
        return by_key;
    };
    using Missing = std::map<std::string, bool>;
    const Missing landing{{"flight_time_s", true},
                          {"landing_vertical_speed_m_s", true},
                          {"landing_energy_J", true},
                          {"drift_m", true}};
    const auto and_landing = [&](Missing others) {
        others.insert(landing.begin(), landing.end());
        return others;
    };
    const Missing all =
        and_landing({{"filling_time_s", true}, {"peak_force_N", true}, {"descent_rate_m_s", true}});
    EXPECT_EQ(missing("stop.time=0.5 s"), all);
    EXPECT_EQ(missing("stop.at=\"line-stretch\""), all);
    EXPECT_EQ(missing("stop.at=\"full-open\""), and_landing({{"descent_rate_m_s", true}}));
    EXPECT_EQ(missing("stop.at=\"steady-descent\""), landing);
    EXPECT_EQ(missing("stop.at=\"ground\""), Missing{});
}

/// A reefed C-9 without added mass, whose line is cut after `delay`, in air of one density.
RunRecord reefed_for(const std::string& delay, std::initializer_list<std::string> more = {}) {
    std::vector<std::string> edits{
        "parachute.reefing=[{ drag_area_ratio = 0.1, until = { at = \"line-stretch\", delay = \"" + delay +
            "\" } }]",
        "environment.atmosphere={ density = 1.225 }", "rom.rtol=1e-10"};
    edits.insert(edits.end(), more);
    Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-reefed.toml", edits);
    scene.aerodynamics.added_mass.reset();
    return run_rom(scene);
}

const MissingMetric* find_missing(const RunRecord& record, const char* key) {
    const auto found = std::ranges::find(record.missing, key, &MissingMetric::metric);
    return found == record.missing.end() ? nullptr : &*found;
}

TEST(RomSequence, AReefedStageFallsAtItsOwnTerminalVelocity) {
    // (C_D S)_r = 0.1 (C_D S)_0 carries the system at sqrt(2 m g/(rho (C_D S)_r)). Twenty seconds are nine
    // v/g: exp(-18) of what it is off at first is left, and the integrator's own error.
    const RunRecord record = reefed_for("20 s", {"release.height=2000 m", "environment.ground=0 m"});
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const double area = 0.1 * 42.56, v = std::sqrt(2.0 * (152.4 + 5.19) * g / (1.225 * area));
    EXPECT_NEAR(metric_of_sequence(record, "stage_1_descent_rate_m_s"), v, 1e-6 * v);
    EXPECT_NE(record.find_metric("stage_1_descent_rate_m_s")->note.find("; steady"), std::string::npos);
    EXPECT_FALSE(record.metric("stage_2_descent_rate_m_s"));  // that is descent_rate_m_s
}

TEST(RomSequence, AReefedStageThatIsCutEarlySaysThatItIsNotSteady) {
    // The mean over the time since it was full: the altitude lost over that time, by the record's own events.
    const RunRecord record = reefed_for("2 s", {"release.speed=60 m/s"});
    const Event *full = record.find_event("reefed-open"), *cut = record.find_event("disreef");
    ASSERT_TRUE(full && cut);
    const Metric* rate = record.find_metric("stage_1_descent_rate_m_s");
    ASSERT_NE(rate, nullptr);
    EXPECT_NE(rate->note.find("not steady"), std::string::npos) << rate->note;
    EXPECT_NEAR(rate->value, (full->altitude - cut->altitude) / (cut->time - full->time), 1e-9 * rate->value);
    // However short that time is: in a hundredth of a second nothing changes much, and nothing is steady.
    const RunRecord soon = reefed_for(fmt::format("{} s", full->time + 0.01), {"release.speed=60 m/s"});
    const Metric* short_one = soon.find_metric("stage_1_descent_rate_m_s");
    ASSERT_NE(short_one, nullptr);
    EXPECT_NE(short_one->note.find("mean over the last 0.01 s"), std::string::npos) << short_one->note;
    EXPECT_NE(short_one->note.find("not steady"), std::string::npos) << short_one->note;
}

TEST(RomSequence, AStageWithoutARateSaysWhy) {
    const RunRecord early = reefed_for("0.05 s");
    const MissingMetric* row = find_missing(early, "stage_1_descent_rate_m_s");
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->why, "the stage ended before its drag area was full");
    const RunRecord stopped = reefed_for("4 s", {"stop={ time = 3 }"});
    row = find_missing(stopped, "stage_1_descent_rate_m_s");
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->why, "the run stopped before that stage ended");
    EXPECT_TRUE(row->not_reached);
}

/// Stopped while the canopy fills, the largest force until there is no peak: at 1 s of 1.6 s it is a third of
/// that of the whole opening.
void expect_no_peak_of_half_an_opening(RunRecord (*fly)(const Scene&)) {
    const Scene scene =
        read_text(with(""), {"stop.time=1 s", "full.mesh.gore_rows=6", "full.mesh.line_elements=4"});
    const RunRecord half = fly(scene);
    for (const char* key :
         {"peak_force_N", "peak_force_ratio", "time_to_peak_force_s", "opening_shock_coefficient"})
        EXPECT_FALSE(half.find_metric(key)) << key;
    EXPECT_EQ(half.find_event("peak-force"), nullptr);
    EXPECT_TRUE(warns(half, "no peak force"));
    ASSERT_TRUE(half.metric("max_force_N"));
    Scene longer = scene;
    longer.stop = {Trigger::Kind::full_open, 0.0, 0.0};
    const RunRecord whole = fly(longer);
    ASSERT_TRUE(whole.metric("peak_force_N"));
    EXPECT_FALSE(warns(whole, "no peak force"));
    EXPECT_LT(*half.metric("max_force_N"), 0.5 * *whole.metric("peak_force_N"));
}

TEST(RomSequence, HalfAnOpeningHasNoPeak) {
    expect_no_peak_of_half_an_opening([](const Scene& scene) { return run_rom(scene); });
}

TEST(RomSequence, HalfAnOpeningOfTheFullModelHasNoPeak) {
    expect_no_peak_of_half_an_opening([](const Scene& scene) { return run_full(scene); });
}

TEST(RomSequence, AStageThatIsOverHasItsPeakWhileTheNextFills) {
    // One stage, cut at 4 s: half a second later the second one fills.
    for (RunRecord (*fly)(const Scene&) : {+[](const Scene& scene) { return run_rom(scene); },
                                           +[](const Scene& scene) { return run_full(scene); }}) {
        Scene scene = read_text(with(one_stage), {"full.mesh.gore_rows=6", "full.mesh.line_elements=4"});
        scene.stop = {Trigger::Kind::time, 0.0, 0.0};
        scene.stop.value = 3.9;
        const RunRecord held = fly(scene);
        EXPECT_TRUE(held.metric("peak_force_N"));
        EXPECT_TRUE(held.metric("stage_1_peak_force_N"));
        scene.stop.value = 4.3;
        const RunRecord cut = fly(scene);
        EXPECT_TRUE(cut.metric("stage_1_peak_force_N"));
        EXPECT_FALSE(cut.metric("stage_2_peak_force_N"));
        EXPECT_FALSE(cut.metric("peak_force_N"));
    }
}

TEST(RomSequence, WhatHappensAtTheVeryEndHasHappened) {
    // The cutter fires at 4 s, and there the run ends.
    Scene scene = read_text(with(one_stage));
    scene.stop = {Trigger::Kind::time, 4.0, 0.0};
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(time_of(record, "disreef"), 4.0);
    EXPECT_EQ(last(record, "time"), 4.0);
}

TEST(RomSequence, AStopWhileAPackIsDrawnOutTakesNothingFromTheOneBefore) {
    // Between the cut of the drogue, at 4 s, and the snatch of the main: the drogue's peak is what it was, to
    // the last bit, whether or not the main's lines are taut already (from 4.87 s on, until 4.89 s).
    const auto run_to = [](const std::string& stop) {
        return run_rom(read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-drogue.toml", {"stop=" + stop}));
    };
    const RunRecord at_cut = run_to("{time=4}");
    for (const char* stop : {"{time=4.5}", "{time=4.88}", "{altitude='880 m'}"}) {
        const RunRecord record = run_to(stop);
        ASSERT_EQ(record.status.code, StatusCode::completed) << stop;
        EXPECT_EQ(metric_of_sequence(record, "drogue_peak_force_N"),
                  metric_of_sequence(at_cut, "drogue_peak_force_N"))
            << stop;
        EXPECT_EQ(metric_of_sequence(record, "peak_force_N"), metric_of_sequence(at_cut, "peak_force_N"));
        EXPECT_FALSE(record.metric("main_snatch_force_N")) << stop;
    }
    EXPECT_EQ(last(run_to("{time=4.88}"), "time"), 4.88);
    EXPECT_GT(last(run_to("{time=4.88}"), "force"), 100.0);  // they are taut
    EXPECT_NEAR(last(run_to("{altitude='880 m'}"), "altitude"), 880.0, 1e-6);
}

TEST(RomSequence, ASnatchInFlightIsAResult) {
    const RunRecord at_once = run_rom(read_text(with("")));
    const RunRecord later = run_rom(read_text(
        edited(with(""), "by = \"line-stretch\"", "by = \"line-stretch\", when = { time = \"1 s\" }")));
    const auto standing = [](const RunRecord& record, const char* key) {
        return std::ranges::find(record.metrics, key, &Metric::key)->kind;
    };
    for (const char* key : {"snatch_speed_m_s", "froude_number"}) {
        EXPECT_EQ(standing(at_once, key), MetricKind::input) << key;
        EXPECT_EQ(standing(later, key), MetricKind::result) << key;
    }
    // A second of free fall from 21 m/s.
    EXPECT_NEAR(metric_of_sequence(later, "snatch_speed_m_s"), 21.0 + g, 1e-9);
    EXPECT_EQ(metric_of_sequence(later, "snatch_time_s"), 1.0);
}

TEST(RomSequence, AClusterHasTheMassRatioOfEach) {
    const RunRecord one = run_rom(read_text(with("")));
    const RunRecord three = run_rom(read_text(with("count = 3\n")));
    EXPECT_NEAR(metric_of_sequence(three, "mass_ratio"), metric_of_sequence(one, "mass_ratio") / 3.0, 1e-12);
}

TEST(RomSequence, ACutAtTheEndOfTheInitialPhaseIsContinuous) {
    // Just before filling begins the line has no effect; just after it the rest of one filling is left, at
    // the speed of that instant: nothing slows this payload. What has grown in 1 us is worth 2e-5 of it,
    // half a diameter of transit would be 0.5.
    const double end = 0.5 * 8.53 / 21.0;
    const auto full_open = [](double cut) {
        const RunRecord record = run_rom(
            read_text(with(one_stage), {fmt::format("parachute.reefing.1.until.delay=\"{:.9f} s\"", cut),
                                        "payload.mass=1e6", "environment.gravity=1e-9"}));
        return time_of(record, "full-open") / 8.53 * 21.0;
    };
    EXPECT_NEAR(full_open(end + 1e-6), 4.0, 1e-4);
    EXPECT_NEAR(full_open(end - 1e-6), 4.0, 1e-4);
}

TEST(RomSequence, NoCanopyFillsAtRest) {
    // n D0/v_s of what rounding leaves at an apogee straight up is ages: refused at 0 and at 1e-14 m/s alike.
    const std::string there = edited(edited(sequence, "at = \"apogee\", delay = \"2 s\"", "at = \"apogee\""),
                                     "fill_time = { time = \"0.5 s\" }\ninitial_phase = \"0 s\"\ncut",
                                     "fill_time = { n = 8 }\ncut");
    for (const char* speed : {"50 m/s", "50.1 m/s", "37 m/s"}) {
        const RunRecord record = run_rom(read_text(there, {std::string("release.speed=\"") + speed + "\""}));
        EXPECT_EQ(record.status.code, StatusCode::refused) << speed;
        EXPECT_TRUE(record.status.detail.starts_with("drogue: a snatch at ")) << record.status.detail;
        EXPECT_NE(record.status.detail.find("deploy it later"), std::string::npos) << record.status.detail;
    }
    // A second later it opens, and each that is slow is named, whichever comes last.
    const RunRecord later = run_rom(read_text(there, {"parachute.drogue.deploy.when.delay=\"0.1 s\""}));
    EXPECT_NE(later.status.code, StatusCode::refused) << later.status.detail;
    EXPECT_TRUE(std::ranges::any_of(later.warnings, [](const Warning& w) {
        return w.what.starts_with("drogue: too slow to inflate: 0.98");
    }));
}

TEST(RomSequence, APayloadWithoutAParachuteHasNoDescentRate) {
    const auto landing = [](const char* cut) {
        return run_rom(
            read_text(with(one_stage), {std::string("parachute.cut={") + cut + "}", "stop={at=\"ground\"}",
                                        "payload.drag_area=\"3 m^2\"", "release.height=\"3000 m\""}));
    };
    // Reefed until 4 s, at rest in the air long before 60 s, by its own drag after the cut.
    for (const auto& [cut, early] : {std::pair{"time=3", true}, {"time=60", false}}) {
        const RunRecord record = landing(cut);
        EXPECT_FALSE(record.find_metric("descent_rate_m_s")) << cut;
        EXPECT_TRUE(warns(record, "the payload landed without a parachute")) << cut;
        EXPECT_EQ(std::ranges::any_of(
                      record.warnings,
                      [](const Warning& w) { return w.what.ends_with("was cut before it was full"); }),
                  early)
            << cut;
        EXPECT_FALSE(warns(record, not_steady_within_run)) << cut;
    }
}

TEST(RomSequence, TheOrderOfTheTablesMeansNothing) {
    const Scene first = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/rocket-dual-deploy.toml");
    Scene second = first;
    std::ranges::reverse(second.parachutes);
    const RunRecord a = run_rom(first), b = run_rom(second);
    EXPECT_EQ(a.find_channel("force")->values, b.find_channel("force")->values);
    const auto said = [](const RunRecord& record) {
        std::vector<std::string> all;
        for (const Warning& warning : record.warnings)
            all.push_back(warning.what);
        std::ranges::sort(all);
        return all;
    };
    EXPECT_EQ(said(a), said(b));
    EXPECT_EQ(&landing_parachute(first), &first.parachutes[1]);
    EXPECT_EQ(&landing_parachute(second), &second.parachutes[0]);
    second.parachutes[0].cut = Trigger{};
    EXPECT_EQ(&landing_parachute(second), &second.parachutes[1]);
}

}  // namespace
}  // namespace twinchute
