// Runs of the full model that must not end well: each has a name, a place and a reason, and none
// reports what came after its last sound state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using test::run_full;

Scene coarse_opening() {
    Scene scene = test::c9_scene();
    scene.full.mesh = {1, 9, 8, 2};
    scene.stop = {Trigger::Kind::time, 1.0, 0.0};
    return scene;
}

void expect_finite(const RunRecord& record) {
    for (const Channel& channel : record.channels)
        for (const double value : channel.values)
            ASSERT_TRUE(std::isfinite(value)) << channel.name;
}

TEST(FullStops, AStepAboveTheLimitIsNamedAndItsNumbersAreDropped) {
    // The bound is 0.5 to 1 of the true limit, so four times the bound is at least twice the limit of
    // the open canopy; the slack one of the first tenths of a second can bear it.
    Scene scene = coarse_opening();
    scene.full.time_step_factor = 4.0;
    const RunRecord record = run_full(scene);
    EXPECT_TRUE(is_numerical_failure(record.status.code)) << status_name(record.status.code);
    EXPECT_LT(record.find_channel("time")->values.back(), 0.6);
    // Forces grow a thousandfold within the steps between two checks; none of that is reported. The canopy
    // still fills, so that its peak is not known.
    EXPECT_LT(record.metric("max_force_N").value(), 1e4);
    EXPECT_FALSE(record.metric("peak_force_N"));
    EXPECT_NE(record.status.detail.find("t = "), std::string::npos) << record.status.detail;
    expect_finite(record);
}

TEST(FullStops, NotANumberIsCaughtWithItsPlace) {
    Scene scene = coarse_opening();
    scene.full.time_step_factor = 4.0;
    scene.full.strain_limit = 1e300;  // nothing else may catch it first but the ledger
    const RunRecord record = run_full(scene);
    EXPECT_TRUE(record.status.code == StatusCode::not_finite ||
                record.status.code == StatusCode::energy_grew);
    expect_finite(record);
}

TEST(FullStops, StrainLimitNamesTheElement) {
    Scene scene = coarse_opening();
    scene.full.strain_limit = 0.005;  // lines reach 1.4 % at the peak
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
    const RunRecord record = run_full(scene);
    EXPECT_EQ(record.status.code, StatusCode::strain_limit);
    EXPECT_TRUE(record.status.detail.find("cable") != std::string::npos ||
                record.status.detail.find("triangle") != std::string::npos)
        << record.status.detail;
    EXPECT_GT(record.find_channel("time")->values.back(), 0.1);
}

TEST(FullStops, AnOpenCanopyAtRestIsNoFault) {
    // Nothing has moved and no energy has changed hands: what does not add up then is the rounding of
    // positions, 1e-24 J. It falls as v_e tanh(g t/v_e), v_e^2 = 2 m g/(rho C_D S), m of payload and
    // parachute. Tolerance: what the mesh may weigh more or less than parachute.mass before a run warns, and
    // the bounce on the lines.
    Scene scene = coarse_opening();
    scene.release.speed = 0.0;
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.aerodynamics.added_mass.reset();
    scene.aerodynamics.line_drag.reset();
    const RunRecord record = run_full(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const double v_e = std::sqrt(2.0 * (152.4 + 5.19) * standard_gravity / (1.225 * 42.56));
    EXPECT_NEAR(test::last(record, "speed") / (v_e * std::tanh(standard_gravity * 1.0 / v_e)), 1.0, 0.01);
}

TEST(FullStops, AStopRequestEndsCleanly) {
    std::stop_source source;
    source.request_stop();
    const RunRecord record = run_full(coarse_opening(), source.get_token());
    EXPECT_EQ(record.status.code, StatusCode::interrupted);
    EXPECT_LT(record.cost.steps, 60);
}

TEST(FullStops, GroundComesFirst) {
    Scene scene = coarse_opening();
    scene.release.altitude = 10.0;
    const RunRecord record = run_full(scene);
    EXPECT_EQ(record.status.code, StatusCode::stopped_by_event);
    ASSERT_NE(record.find_event("ground"), nullptr);
    EXPECT_NEAR(record.find_event("ground")->altitude, 0.0, 0.01);  // one step of fall
    scene.stop = {Trigger::Kind::ground, 0.0, 0.0};
    EXPECT_EQ(run_full(scene).status.code, StatusCode::completed);
}

TEST(FullStops, EventsComeExactlyAtTheirTimes) {
    Scene scene = coarse_opening();
    scene.stop = {Trigger::Kind::time, 1.8, 0.0};
    const RunRecord record = run_full(scene);
    const double speed = 21.0;
    EXPECT_EQ(record.find_event("end-of-initial-phase")->time, 0.5 * 8.53 / speed);
    EXPECT_DOUBLE_EQ(record.find_event("full-open")->time, 4.0 * 8.53 / speed);
    EXPECT_EQ(record.find_channel("time")->values.front(), 0.0);
    EXPECT_NEAR(record.find_channel("time")->values.back(), 1.8, 5e-3);
}

TEST(FullStops, StepsEndOnTheKinksOfATable) {
    // A row of the history at every step: those at 1/4, 1 and 5/4 of the filling are there to the bit.
    Scene scene = coarse_opening();
    Parachute& chute = scene.parachutes.front();
    chute.drag_area_table.emplace("t.csv", std::vector<double>{0.0, 0.25, 0.25, 1.0, 1.0, 1.25, 1.25, 1.5},
                                  std::vector<double>{0.04, 0.1, 0.1, 1.0, 1.0, 1.2, 1.2, 1.0});
    chute.fill_time = {find_fill_time("given"), 0.0, 0.0, 0.8};
    chute.initial_phase = {false, 0.1};
    scene.full.output_rate = 1e5;
    scene.stop = {Trigger::Kind::time, 1.2, 0.0};
    const RunRecord record = run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const auto &time = record.find_channel("time")->values, &area = record.find_channel("drag_area")->values;
    for (const auto& [kink, ratio] :
         {std::pair{0.1 + 0.25 * (0.8 - 0.1), 0.1}, {0.8, 1.0}, {0.1 + 1.25 * (0.8 - 0.1), 1.2}}) {
        const auto at = std::ranges::find(time, kink);
        ASSERT_NE(at, time.end()) << kink;
        EXPECT_NEAR(area[static_cast<std::size_t>(at - time.begin())], ratio * chute.drag_area, 1e-9);
    }
}

TEST(FullStops, ZeroStrengthPhysicsEqualsAbsentPhysics) {
    Scene scene = coarse_opening();
    scene.stop = {Trigger::Kind::time, 0.3, 0.0};
    scene.aerodynamics.breathing_damping = 0.0;
    scene.payload.drag_area = 0.0;
    const RunRecord zero = run_full(scene);
    scene.aerodynamics.breathing_damping.reset();
    scene.payload.drag_area.reset();
    const RunRecord absent = run_full(scene);
    EXPECT_DOUBLE_EQ(zero.find_channel("force_raw")->values.back(),
                     absent.find_channel("force_raw")->values.back());
    EXPECT_EQ(zero.cost.blocks.size(), absent.cost.blocks.size() + 2);
    EXPECT_EQ(zero.left_out.size() + 2, absent.left_out.size());
}

/// A piece of physics so weak that it cannot change anything, and the scene without it. Line drag has no
/// strength of its own: even without density, viscosity is left.
struct Vanishing {
    const char* name;
    bool packed;
    void (*weak)(Scene&);
    void (*absent)(Scene&);
};
constexpr double weakest = 1e-300;  // zero itself is what a scene says to leave the piece out
constexpr Vanishing vanishing[] = {
    {"breathing damping", false, [](Scene& s) { s.aerodynamics.breathing_damping = 0.0; },
     [](Scene& s) { s.aerodynamics.breathing_damping.reset(); }},
    {"payload drag", false, [](Scene& s) { s.payload.drag_area = 0.0; },
     [](Scene& s) { s.payload.drag_area.reset(); }},
    {"mass damping", false, [](Scene& s) { s.full.alpha = weakest; }, [](Scene& s) { s.full.alpha = 0.0; }},
    {"stiffness damping", false, [](Scene& s) { s.full.beta = weakest; },
     [](Scene& s) { s.full.beta = 0.0; }},
    {"bulk viscosity", false, [](Scene& s) { s.full.bulk_viscosity = weakest; },
     [](Scene& s) { s.full.bulk_viscosity = 0.0; }},
    {"noise", false,
     [](Scene& s) {
         s.full.noise = Noise{0.0, 1};
     },
     [](Scene& s) { s.full.noise.reset(); }},
    {"accretion without air", false,
     [](Scene& s) {
         s.environment.atmosphere.constant_density = weakest;
         s.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
     },
     [](Scene& s) {
         s.environment.atmosphere.constant_density = weakest;
         s.aerodynamics.added_mass.reset();
     }},
    {"fabric drag", true, [](Scene& s) { s.parachutes.front().deploy.drag_coefficient = weakest; },
     [](Scene& s) { s.parachutes.front().deploy.drag_coefficient = 0.0; }},
    {"deployment resistance", true,
     [](Scene& s) { s.parachutes.front().deploy.deployment_resistance = weakest; },
     [](Scene& s) { s.parachutes.front().deploy.deployment_resistance = 0.0; }},
};

TEST(FullStops, EachPieceThatVanishesEqualsItsAbsence) {
    for (const Vanishing& piece : vanishing) {
        Scene with = piece.packed ? test::packed_c9(DeployBy::static_line) : coarse_opening();
        // A pack without folds' resistance ends at 46 ms, by its ledger.
        with.stop = {Trigger::Kind::time, piece.packed ? 0.02 : 0.1, 0.0};
        Scene without = with;
        piece.weak(with);
        piece.absent(without);
        const RunRecord weak = run_full(with), absent = run_full(without);
        ASSERT_EQ(weak.status.code, StatusCode::completed) << piece.name << ": " << weak.status.detail;
        // A block more may add its zeros in another order: round-off, and no more, in every channel.
        for (const char* channel : {"force_raw", "altitude", "vertical_speed"}) {
            const auto& a = weak.find_channel(channel)->values;
            const auto& b = absent.find_channel(channel)->values;
            ASSERT_EQ(a.size(), b.size()) << piece.name;
            for (std::size_t i = 0; i < a.size(); ++i)
                ASSERT_NEAR(a[i], b[i], 1e-9 * (1.0 + std::abs(b[i])))
                    << piece.name << ' ' << channel << ' ' << i;
        }
        EXPECT_LE(weak.left_out.size(), absent.left_out.size()) << piece.name;
    }
}

TEST(FullStops, ABadMassIsSaid) {
    Scene scene = coarse_opening();
    scene.stop = {Trigger::Kind::time, 0.01, 0.0};
    scene.parachutes.front().mass = 6.0;
    const RunRecord record = run_full(scene);
    bool said = false;
    for (const Warning& w : record.warnings)
        said |= w.what.find("6.000 kg") != std::string::npos;
    EXPECT_TRUE(said);
}

/// A line-stretch start that is quick to run.
Scene coarse_stop() {
    Scene scene = test::c9_scene();
    scene.full.mesh = {1, 6, 10, 2};
    return scene;
}

TEST(Stops, AtAnAltitude) {
    Scene scene = coarse_stop();
    scene.stop = {Trigger::Kind::altitude, 280.0, 0.0};
    const RunRecord rom = test::run_rom(scene), full = test::run_full(scene);
    for (const RunRecord* r : {&rom, &full}) {
        EXPECT_EQ(r->status.code, StatusCode::completed) << r->status.detail;
        EXPECT_FALSE(r->metric("flight_time_s"));  // nothing has landed
    }
    EXPECT_NEAR(test::last(rom, "altitude"), 280.0, 1e-6);  // a root, to the integrator's tolerance
    // The full model ends with the step that crosses it, and its history is no denser than its rows.
    EXPECT_NEAR(test::last(full, "altitude"), 280.0, 21.0 / scene.full.output_rate);

    scene.stop.delay = 0.3;
    const RunRecord later = test::run_rom(scene);
    EXPECT_NEAR(test::last(later, "time"), test::last(rom, "time") + 0.3, 1e-6);
    EXPECT_EQ(later.status.code, StatusCode::completed) << later.status.detail;
}

TEST(Stops, AtLineStretchAndAtFullOpen) {
    Scene scene = coarse_stop();
    const double filling = 4.0 * 8.53 / 21.0;
    scene.stop = {Trigger::Kind::full_open, 0.0, 0.1};
    for (const RunRecord& r : {test::run_rom(scene), test::run_full(scene)}) {
        EXPECT_EQ(r.status.code, StatusCode::completed) << r.status.detail;
        EXPECT_NEAR(test::last(r, "time"), filling + 0.1, 1.0 / scene.full.output_rate);
    }
    scene.stop = {Trigger::Kind::line_stretch, 0.0, 0.05};
    for (const RunRecord& r : {test::run_rom(scene), test::run_full(scene)}) {
        EXPECT_EQ(r.status.code, StatusCode::completed) << r.status.detail;
        EXPECT_NEAR(test::last(r, "time"), 0.05, 1.0 / scene.full.output_rate);
    }
    // From the pack it is the snatch.
    Scene packed = test::packed_c9(DeployBy::static_line);
    packed.stop = {Trigger::Kind::line_stretch, 0.0, 0.0};
    for (const RunRecord& r : {test::run_rom(packed), test::run_full(packed)}) {
        EXPECT_EQ(r.status.code, StatusCode::completed) << r.status.detail;
        EXPECT_NEAR(test::last(r, "time"), r.metric("snatch_time_s").value(), 1.0 / scene.full.output_rate);
    }
}

TEST(FullResults, DoNotHangOnHowOftenTheHistoryIsWritten) {
    // The end of a run is its own row, and what is found from rows has as many as it needs: not a bit
    // differs.
    Scene scene = coarse_opening();
    scene.environment.wind = uniform_wind({3.0, 0.0, 0.0});
    scene.release.altitude = 61.3;  // lands between two rows
    scene.stop = {Trigger::Kind::ground, 0.0, 0.0};
    const RunRecord often = run_full(scene);
    ASSERT_EQ(often.status.code, StatusCode::completed) << often.status.detail;
    ASSERT_TRUE(often.metric("impulse_N_s"));
    for (const double rate : {10.0, 0.01}) {
        scene.full.output_rate = rate;
        const RunRecord seldom = run_full(scene);
        ASSERT_EQ(seldom.metrics.size(), often.metrics.size()) << rate;
        for (std::size_t i = 0; i < often.metrics.size(); ++i)
            EXPECT_EQ(seldom.metrics[i].value, often.metrics[i].value) << rate << " " << often.metrics[i].key;
        const auto& time = seldom.find_channel("time")->values;
        EXPECT_EQ(time.front(), 0.0);
        EXPECT_EQ(time.back(), *often.metric("flight_time_s"));
        // One a period, and the end, in the middle of one.
        EXPECT_EQ(time.size(), static_cast<std::size_t>(std::floor(time.back() * rate)) + 2) << rate;
    }
}

TEST(FullResults, OfAnEndAreThoseOfItsInstant) {
    // Full open is reached by the step that ends there, and the filling that the drag area has is whole.
    Scene scene = coarse_opening();
    scene.stop = {Trigger::Kind::full_open, 0.0, 0.0};
    const RunRecord record = run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_EQ(record.find_channel("time")->values.back(), record.find_event("full-open")->time);
    EXPECT_TRUE(record.metric("impulse_N_s"));
    const auto missing = std::ranges::find(record.missing, "filling_time_s", &MissingMetric::metric);
    ASSERT_NE(missing, record.missing.end());
    EXPECT_NE(missing->why.find("after full open"), std::string::npos) << missing->why;
}

TEST(FullResults, OfARunShorterThanTheFilterAreItsMeans) {
    // 2 ms of a canopy that starts open, filtered over 5 ms: the mean of all of it is what there is.
    Scene scene = coarse_opening();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    scene.stop = {Trigger::Kind::time, 2e-3, 0.0};
    const RunRecord record = run_full(scene);
    const auto& raw = record.find_channel("force_raw")->values;
    const auto [least, most] = std::ranges::minmax(raw);
    EXPECT_GE(*record.metric("max_force_N"), 0.99 * least);
    EXPECT_LE(*record.metric("max_force_N"), 1.01 * most);
    EXPECT_GT(*record.metric("max_deceleration_g"), 0.0);
    EXPECT_GT(least, 1000.0);
}

TEST(FullStops, ARippleIsNoPeak) {
    // Light air and a heavy load: the force still rises when the drag area is full, and bounces meanwhile.
    // Such a run ends at a force that has stayed low for a whole bounce; at the first dip it has a third
    // of this.
    Scene scene = coarse_opening();
    scene.environment.atmosphere = {find_atmosphere("us76")};
    scene.release = {20000.0, 30.0, 0.25 * pi, 0.5 * pi};
    scene.payload.mass = 1000.0;
    scene.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
    const double rom = *test::run_rom(scene).metric("peak_force_N");
    EXPECT_GT(*run_full(scene).metric("peak_force_N"), 0.9 * rom);
}

TEST(FullStops, APayloadThatFallsIntoItsCanopyEndsContactBetweenGores) {
    // Straight up it comes to rest above its canopy and falls into it. Contact between gores counts from the
    // axis between both, which has no direction then; without contact it goes on, with a warning.
    Scene scene = coarse_opening();
    scene.release.path_angle = -0.5 * pi;
    scene.stop = {Trigger::Kind::time, 4.0, 0.0};
    scene.full.contact = Contact::gores;
    const RunRecord met = run_full(scene);
    EXPECT_EQ(met.status.code, StatusCode::not_opened) << met.status.detail;
    EXPECT_EQ(met.metric("unopened_parachutes"), 1.0);
    EXPECT_LT(*met.metric("max_force_N"), 1000.0);  // lines that hang slack: 474 N, at the start
    scene.full.contact = Contact::none;
    const RunRecord through = run_full(scene);
    EXPECT_TRUE(std::ranges::any_of(through.warnings, [](const Warning& w) {
        return w.what.starts_with("the payload went through its canopy at t = ");
    })) << through.status.detail;
}

TEST(FullStops, LinesTooShortForAnOpenMouthAreRefused) {
    // The mouth of the open C-9 has a radius of 2.6 m, from which lines of 2 m do not come to the axis.
    // Nothing but a start asks for that: the flat canopy is wider still.
    Scene scene = coarse_opening();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    scene.stop = {Trigger::Kind::time, 0.01, 0.0};
    scene.parachutes.front().line_length = 3.0;
    EXPECT_EQ(run_full(scene).status.code, StatusCode::completed);
    scene.parachutes.front().line_length = 2.0;
    try {
        run_full(scene);
        ADD_FAILURE() << "not refused";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("parachute.line_length: 2 m does not reach"),
                  std::string::npos)
            << error.what();
    }
}

TEST(FullStops, AReefingLineShorterThanTheMouthIsRefused) {
    // Seams alone border the mouth here: 28 sides of the circle that the initial drag area asks for, 3.49 m
    // around. A line of 3 m would have to stretch by 16 % as it begins, and no lighter payload would spare it
    // that.
    for (const double line : {3.0, 3.6}) {
        Scene scene = coarse_opening();
        Reefing stage;
        stage.drag_area_ratio = 0.2;
        stage.until.kind = Trigger::Kind::time;
        stage.until.value = 1.0;
        stage.line_length = line;
        scene.parachutes.front().reefing = {stage};
        scene.stop = {Trigger::Kind::time, 0.01, 0.0};
        if (line > 3.5) {
            EXPECT_EQ(run_full(scene).status.code, StatusCode::completed) << line;
            continue;
        }
        EXPECT_THROW(run_full(scene), SceneError) << line;
    }
}

TEST(FullResults, ACanopyThatStaysClosedHasNoFillingTime) {
    // Without pressure nothing spreads it: its drag area is told, its shape is a bundle.
    Scene scene = coarse_opening();
    scene.aerodynamics.radial_pressure = 0.0;
    scene.stop = {Trigger::Kind::time, 4.0, 0.0};
    const RunRecord record = run_full(scene);
    EXPECT_FALSE(record.metric("filling_time_s")) << *record.metric("filling_time_s");
    const auto missing = std::ranges::find(record.missing, "filling_time_s", &MissingMetric::metric);
    ASSERT_NE(missing, record.missing.end());
    EXPECT_EQ(missing->why, "the canopy stayed closed");
}

}  // namespace
}  // namespace twinchute
