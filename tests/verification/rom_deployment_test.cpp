// The reduced-order model from release to snatch, against exact solutions of two point masses.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "rom/deployment.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/packed_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using namespace test;

constexpr double lines = 7.31 + 1.22;                  // [m] and risers
constexpr double crane_length = 12.2 + lines + 4.265;  // [m] 24.995: static line, lines, risers, D0/2
constexpr double payload = 152.4, parachute = 5.19;    // [kg]
constexpr double together = payload + parachute;

double metric(const RunRecord& record, const char* key) {
    const auto value = record.metric(key);
    EXPECT_TRUE(value) << key << ", " << record.status.detail;
    return value.value_or(std::nan(""));
}

void run_for(Scene& scene, double seconds) {
    scene.stop = {Trigger::Kind::time, seconds, 0.0};
}

/// x with f(x) = 0 for a rising f.
template <class F>
double root_of(F&& f, double low, double high) {
    for (int i = 0; i < 200; ++i)
        (f(0.5 * (low + high)) < 0.0 ? low : high) = 0.5 * (low + high);
    return low;
}

TEST(RomDeployment, CraneDropInAVacuum) {
    // Fall over 24.995 m, exactly; 1e-7 is the tolerance of the integration on metres and seconds. Until
    // lock-up the momentum of both bodies grows by their weight and by nothing else: a linear invariant,
    // which Runge-Kutta methods keep to round-off.
    Scene scene = crane_drop();
    take_away_air(scene);
    run_for(scene, 3.0);
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const double stretched = metric(record, "line_stretch_time_s"), snatch = metric(record, "snatch_time_s");
    EXPECT_NEAR(stretched, std::sqrt(2.0 * crane_length / g), 1e-7);
    EXPECT_NEAR(metric(record, "payload_snatch_speed_m_s"), std::sqrt(2.0 * g * crane_length), 1e-7);
    EXPECT_NEAR(record.find_event("line-stretch")->altitude, 85.0 - crane_length, 1e-6);
    const double momentum = payload * g * stretched + together * g * (snatch - stretched);
    EXPECT_NEAR(metric(record, "snatch_speed_m_s"), momentum / together, 1e-12 * momentum / together);
    // 22.1 m/s of the payload become 21.4 m/s of both; the weight adds 0.2 m/s while the lines stretch.
    EXPECT_NEAR(metric(record, "snatch_speed_m_s") - g * (snatch - stretched), 21.41, 0.005);
}

TEST(RomDeployment, ObliqueDropOnAStaticLineMeetsItsCircle) {
    // From a horizontal release the payload falls on a parabola: v^2 t^2 + g^2 t^4/4 = L^2 at line stretch.
    // The lines pull obliquely then; both components of the momentum are kept.
    Scene scene = crane_drop();
    take_away_air(scene);
    scene.release = {85.0, 12.0, 0.0, 0.7};
    run_for(scene, 3.0);
    const RunRecord record = run_rom(scene);
    const double v = 12.0;
    const double square =
        2.0 / (g * g) * (std::sqrt(std::pow(v, 4) + g * g * crane_length * crane_length) - v * v);
    const double stretched = metric(record, "line_stretch_time_s"), snatch = metric(record, "snatch_time_s");
    EXPECT_NEAR(stretched, std::sqrt(square), 1e-7);
    const double down = payload * g * stretched + together * g * (snatch - stretched);
    const double speed = std::hypot(payload * v, down) / together;
    EXPECT_NEAR(metric(record, "snatch_speed_m_s"), speed, 1e-12 * speed);
}

TEST(RomDeployment, ElasticSnatchFollowsItsClosedForm) {
    // Without gravity and air a payload of 20 m/s meets a parachute at rest: T = dv sqrt(k m_red) sin(w t)
    // until the quarter period. Lines of 9.7e8 Pa and of the 9.7e10 Pa that the paper prints. 1e-6: the
    // stretch, 0.2 m or 0.02 m, is integrated to 1e-8 m.
    for (const double modulus : {9.7e8, 9.7e10}) {
        Scene scene = crane_drop();
        take_away_air(scene);
        take_away_gravity(scene);
        scene.release.speed = 20.0;
        scene.parachutes.front().line.youngs_modulus = modulus;
        run_for(scene, 2.0);
        const RunRecord record = run_rom(scene);
        const double stiffness = 28 * modulus * pi * 4e-6 / lines, mass = payload * parachute / together;
        const double closed = 20.0 * std::sqrt(stiffness * mass);
        EXPECT_NEAR(metric(record, "snatch_force_N") / closed, 1.0, 1e-6) << modulus;
        EXPECT_NEAR(metric(record, "snatch_force_mass_spring_N") / closed, 1.0, 1e-9) << modulus;
        EXPECT_NEAR(metric(record, "line_stretch_time_s"), crane_length / 20.0, 1e-9);
        const double quarter = 0.5 * pi * std::sqrt(mass / stiffness);
        EXPECT_NEAR((metric(record, "snatch_time_s") - metric(record, "line_stretch_time_s")) / quarter, 1.0,
                    1e-6)
            << modulus;
        // EA mu of 28 lines of 4 mm: 12.19 kN and 5.806 g/m each.
        EXPECT_NEAR(metric(record, "snatch_force_wave_N"), 20.0 * 28 * pi * 4e-6 * std::sqrt(modulus * 462.0),
                    1e-6);
    }
}

TEST(RomDeployment, SnatchForceOfTheCraneDropIsTheClosedFormWithinHalfAPercent) {
    // Gravity moves both bodies alike; of the air only drag on the payload, 0.4 m2, makes a difference.
    for (const double drag_area : {0.0, 0.4}) {
        Scene scene = crane_drop();
        if (drag_area > 0.0) scene.payload.drag_area = drag_area;
        const RunRecord record = run_rom(scene);
        EXPECT_NEAR(metric(record, "snatch_force_N") / metric(record, "snatch_force_mass_spring_N"), 1.0,
                    drag_area > 0.0 ? 0.005 : 1e-5);
        EXPECT_EQ(metric(record, "max_force_N"), metric(record, "snatch_force_N"));
        EXPECT_LT(metric(record, "peak_force_N"), metric(record, "snatch_force_N"));
    }
}

TEST(RomDeployment, ImpulseCountsFromSnatch) {
    // Straight down and without drag on the payload F = m_l (g - dv/dt): the impulse from snatch to full open
    // is m_l (g t_f - change of speed). 1e-6: Simpson's rule on quarters of the steps.
    const RunRecord record = run_rom(crane_drop());
    const double change = record.find_event("full-open")->speed - metric(record, "snatch_speed_m_s");
    const double expected = payload * (g * metric(record, "filling_time_s") - change);
    EXPECT_NEAR(metric(record, "impulse_N_s") / expected, 1.0, 1e-6);
}

TEST(RomDeployment, FreePackFallsBackAsItsDragSays) {
    // No gravity, no drag on the payload: the pack slows down as v0/(1 + c v0 t), c = rho A/(2 m), and falls
    // back by v0 t - ln(1 + c v0 t)/c.
    Scene scene = free_deployment(0.5);
    take_away_gravity(scene);
    scene.release = {85.0, 60.0, 0.3, 1.0};
    scene.environment.ground = -900.0;
    run_for(scene, 1.0);
    const double c = 0.5 * 1.225 * 0.5 / parachute;
    const auto apart = [c](double t) { return 60.0 * t - std::log1p(c * 60.0 * t) / c; };
    const double expected = root_of([&](double t) { return apart(t) - lines; }, 0.0, 10.0);
    const RunRecord record = run_rom(scene);
    const double stretched = metric(record, "line_stretch_time_s");
    EXPECT_NEAR(stretched, expected, 1e-7);
    EXPECT_NEAR(metric(record, "payload_snatch_speed_m_s"), 60.0, 1e-9);
    const auto &t = record.find_channel("time")->values, &s = record.find_channel("separation")->values;
    for (std::size_t i = 0; i < t.size() && t[i] <= stretched; ++i)
        EXPECT_NEAR(s[i], apart(t[i]), 1e-5) << t[i];  // dense output of order 3 between the steps
}

TEST(RomDeployment, ExtractionByAConstantForce) {
    // F t^2/(2 m) = lines, in any direction; then, with the force still on, the lines stretch to
    // F'/k + sqrt((F'/k)^2 + dv^2 m/k), F' = F m_l/(m_l + m_p), m reduced.
    for (const double speed : {0.0, 30.0}) {
        Scene scene = extraction({0.0, 100.0}, {800.0, 800.0});
        take_away_air(scene);
        take_away_gravity(scene);
        scene.release = {85.0, speed, -0.4, 2.0};
        run_for(scene, 1.0);
        const RunRecord record = run_rom(scene);
        const double stretched = std::sqrt(2.0 * lines * parachute / 800.0);
        EXPECT_NEAR(metric(record, "line_stretch_time_s"), stretched, 1e-8);
        EXPECT_NEAR(metric(record, "payload_snatch_speed_m_s"), speed, 1e-9);
        const double k = line_stiffness(scene.parachutes.front()), dv = 800.0 * stretched / parachute;
        const double static_stretch = 800.0 * payload / together / k;
        const double stretch =
            static_stretch + std::hypot(static_stretch, dv * std::sqrt(payload * parachute / together / k));
        EXPECT_NEAR(metric(record, "snatch_force_N") / (k * stretch), 1.0, 1e-6);
        // Straight behind the release, so that it brakes both; up where the release is at rest.
        const double change = 800.0 * metric(record, "snatch_time_s") / together;
        EXPECT_NEAR(metric(record, "snatch_speed_m_s"), speed > 0.0 ? speed - change : change, 1e-9);
        if (speed == 0.0) {
            EXPECT_GT(last(record, "vertical_speed"), 0.0);
        }
    }
}

// Each pack is pulled by the force: two of them, of twice the payload, come out as one does.
TEST(RomDeployment, ExtractionPullsEachPackOfACluster) {
    Scene one = extraction({0.0, 0.1, 100.0}, {0.0, 800.0, 800.0});
    one.payload.drag_area = 0.0;
    run_for(one, 2.0);
    Scene two = one;
    two.payload.mass *= 2.0;
    two.parachutes.front().count = 2;
    const RunRecord single = run_rom(one), pair = run_rom(two);
    for (const char* key : {"line_stretch_time_s", "snatch_time_s", "snatch_speed_m_s"})
        EXPECT_NEAR(metric(pair, key) / metric(single, key), 1.0, 1e-7) << key;
    EXPECT_NEAR(metric(pair, "snatch_force_N") / metric(single, "snatch_force_N"), 2.0, 1e-6);
}

TEST(RomDeployment, ExtractionFollowsItsTableAndEndsWithIt) {
    // Nothing until 0.1 s, a ramp to 900 N at 0.3 s, then nothing: a jump that a step must not reach across.
    // On the ramp F = b (t - 0.1): x = b (t - 0.1)^3/(6 m); after it at constant speed. Exact for every
    // method of order 3 and more once it stops at the corners; 1e-9 s is what is left of the root's search.
    for (const char* method : {"bogacki-shampine", "zonneveld", "dormand-prince"}) {
        Scene scene = extraction({0.1, 0.3}, {0.0, 900.0});
        take_away_air(scene);
        take_away_gravity(scene);
        scene.rom.method = method;
        run_for(scene, 3.0);
        const double slope = 900.0 / 0.2, x = slope * std::pow(0.2, 3) / (6.0 * parachute),
                     v = slope * 0.2 * 0.2 / (2.0 * parachute);
        EXPECT_NEAR(metric(run_rom(scene), "line_stretch_time_s"), 0.3 + (lines - x) / v, 1e-9) << method;
        // `duration` cuts the table short.
        scene.parachutes.front().deploy.extraction.duration = 0.2;
        const double cut_x = slope * 1e-3 / (6.0 * parachute), cut_v = slope * 0.01 / (2.0 * parachute);
        EXPECT_NEAR(metric(run_rom(scene), "line_stretch_time_s"), 0.2 + (lines - cut_x) / cut_v, 1e-8)
            << method;
    }
}

TEST(RomDeployment, MovingFarEndIsAChangeOfFrame) {
    // In a vacuum an aircraft that flies on at the speed of the release sees the crane's drop: times and
    // forces are the same. 1e-7: the integrator sees other numbers.
    Scene crane = crane_drop();
    take_away_air(crane);
    run_for(crane, 3.0);
    Scene aircraft = crane;
    aircraft.parachutes.front().deploy.anchor_moves = true;
    aircraft.release = {85.0, 60.0, 0.0, 1.0};
    // Filling would differ: it goes by the speed through the air.
    for (Scene* scene : {&crane, &aircraft})
        scene->parachutes.front().initial_phase = {false, 0.1};
    const RunRecord a = run_rom(crane), b = run_rom(aircraft);
    for (const char* key : {"line_stretch_time_s", "snatch_time_s", "snatch_force_N"})
        EXPECT_NEAR(metric(b, key) / metric(a, key), 1.0, 1e-7) << key;
    EXPECT_NEAR(metric(b, "snatch_speed_m_s"), std::hypot(60.0, metric(a, "snatch_speed_m_s")), 1e-6);
}

TEST(RomDeployment, SpaceOfOneTwoAndThreeDimensionsTellTheSame) {
    // Three instantiations of one equation; 1e-6 as in RomReference.PlanarFallStraightDownIsTheVerticalFall.
    std::vector<Scene> scenes{crane_drop(), free_deployment(0.3), extraction({0.0, 1.0}, {900.0, 500.0})};
    for (Scene& scene : scenes) {
        scene.release.speed = 25.0;
        scene.payload.drag_area = 0.1;
        const RunRecord vertical = run_rom(scene);
        ASSERT_EQ(vertical.find_channel("east"), nullptr);
        Scene planar = scene, spatial = scene;
        planar.release.path_angle = 0.5 * pi - 1e-7;
        spatial.environment.wind = uniform_wind(Vec3::Zero());
        for (const char* key : {"line_stretch_time_s", "snatch_time_s", "snatch_speed_m_s",
                                "payload_snatch_speed_m_s", "snatch_force_N", "peak_force_N"})
            for (const Scene& other : {planar, spatial})
                EXPECT_NEAR(metric(run_rom(other), key) / metric(vertical, key), 1.0, 1e-6) << key;
    }
}

TEST(RomDeployment, HeadingTurnsThePathAndNothingElse) {
    std::vector<Scene> scenes{crane_drop(), free_deployment(0.3), extraction({0.0, 1.0}, {900.0, 500.0})};
    for (Scene& scene : scenes) {
        scene.release = {85.0, 40.0, 0.4, 0.5 * pi};
        const RunRecord east = run_rom(scene);
        scene.release.heading = 0.3;
        const RunRecord planar = run_rom(scene);
        scene.environment.wind = uniform_wind(Vec3::Zero());
        const RunRecord spatial = run_rom(scene);
        for (const char* key :
             {"line_stretch_time_s", "snatch_speed_m_s", "snatch_force_N", "peak_force_N"}) {
            EXPECT_EQ(metric(planar, key), metric(east, key)) << key;  // the plane's coordinates are the same
            EXPECT_NEAR(metric(spatial, key) / metric(east, key), 1.0, 1e-6) << key;
        }
        for (const RunRecord& record : {planar, spatial}) {
            EXPECT_NEAR(last(record, "east"), std::sin(0.3) * last(east, "east"), 1e-4);
            EXPECT_NEAR(last(record, "north"), std::cos(0.3) * last(east, "east"), 1e-4);
        }
    }
}

TEST(RomDeployment, UniformWindIsAChangeOfFrame) {
    // A free pack knows the air only: the same motion through it, seen from a ground that moves.
    Scene still = free_deployment(0.3);
    still.release = {85.0, 40.0, 0.4, 0.5 * pi};
    const RunRecord a = run_rom(still);
    Scene windy = still;
    const Vec3 wind(-3.0, 4.0, 0.0);
    windy.environment.wind = uniform_wind(wind);
    const Vec3 ground = Vec3(40.0 * std::cos(0.4), 0.0, -40.0 * std::sin(0.4)) + wind;
    windy.release.speed = ground.norm();
    windy.release.path_angle = std::asin(-ground.z() / ground.norm());
    windy.release.heading = std::atan2(ground.x(), ground.y());
    const RunRecord b = run_rom(windy);
    for (const char* key : {"line_stretch_time_s", "snatch_speed_m_s", "payload_snatch_speed_m_s",
                            "snatch_force_N", "peak_force_N"})
        EXPECT_NEAR(metric(b, key) / metric(a, key), 1.0, 1e-6) << key;
}

TEST(RomDeployment, ErrorFallsWithTheStepsAsTheMethodsOrder) {
    // Deployment, snatch, initial phase, filling and descent in one run: error of the payload's place at the
    // end against the number of steps. A boundary that a step reached across would leave order one; the root
    // of line stretch and lock-up, located by dense output, must not spoil the order either. 0.5 below the
    // order: error control spreads steps unevenly.
    const auto end_of = [](const char* method, double rtol) {
        Scene scene = crane_drop();
        scene.payload.drag_area = 0.4;
        scene.rom = {method, rtol};
        run_for(scene, 4.0);
        const RunRecord record = run_rom(scene);
        return std::pair{last(record, "altitude"), static_cast<double>(record.cost.steps)};
    };
    const double truth = end_of("dormand-prince", 1e-13).first;
    const struct {
        const char* method;
        int order;
        double coarse, fine;
    } rows[] = {{"heun-euler", 2, 1e-6, 1e-8},
                {"bogacki-shampine", 3, 1e-6, 1e-10},
                {"zonneveld", 4, 1e-6, 1e-10},
                {"dormand-prince", 5, 1e-6, 1e-10}};
    for (const auto& row : rows) {
        const auto [coarse, few] = end_of(row.method, row.coarse);
        const auto [fine, many] = end_of(row.method, row.fine);
        const double order =
            std::log(std::abs(coarse - truth) / std::abs(fine - truth)) / std::log(many / few);
        EXPECT_GT(order, row.order - 0.5)
            << row.method << ' ' << coarse - truth << ' ' << fine - truth << ' ' << few << ' ' << many;
        RecordProperty(row.method, std::to_string(order));
    }
}

TEST(RomDeployment, LinesThatNeverComeTautEndWithTheReason) {
    // Pack and payload of the same ballistic coefficient fall side by side.
    Scene scene = free_deployment(0.4 * parachute / payload);
    scene.payload.drag_area = 0.4;
    scene.environment.ground = 0.0;
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    const auto expect_unopened = [](const RunRecord& record, StatusCode code) {
        EXPECT_EQ(record.status.code, code) << record.status.detail;
        ASSERT_FALSE(record.warnings.empty());
        EXPECT_EQ(record.warnings.front().what, "the parachute did not deploy");
        EXPECT_NE(record.warnings.front().why.find("the lines never came taut"), std::string::npos);
        for (const char* key : {"line_stretch_time_s", "snatch_time_s", "snatch_speed_m_s", "snatch_force_N",
                                "peak_force_N", "filling_time_s", "froude_number", "mass_ratio"})
            EXPECT_FALSE(record.metric(key)) << key;
        EXPECT_EQ(record.metric("max_force_N"), 0.0);
        EXPECT_EQ(record.find_event("snatch"), nullptr);
    };
    const RunRecord landed = run_rom(scene);
    expect_unopened(landed, StatusCode::not_opened);
    EXPECT_NE(landed.status.detail.find("the lines never came taut"), std::string::npos);
    EXPECT_NEAR(metric(landed, "flight_time_s"), last(landed, "time"), 0.0);
    scene.stop = {Trigger::Kind::ground, 0.0, 0.0};
    expect_unopened(run_rom(scene), StatusCode::not_opened);
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
    expect_unopened(run_rom(scene), StatusCode::completed);
    scene.environment.ground = -40000.0;
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    const RunRecord falling = run_rom(scene);
    expect_unopened(falling, StatusCode::time_limit);
    EXPECT_NEAR(last(falling, "time"), longest_deployment, 1e-9);
}

TEST(RomDeployment, APackThatReachesTheGroundFirstEndsTheRun) {
    // Thrown upward, the payload leaves its pack behind and below.
    Scene scene = free_deployment(3.0);
    scene.environment.ground = 80.0;
    scene.release = {81.0, 9.0, -0.5 * pi, 0.0};
    scene.parachutes.front().line_length = 100.0;
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::not_opened);
    EXPECT_TRUE(
        record.status.detail.starts_with("the parachute reached the ground: the lines never came taut"))
        << record.status.detail;
    EXPECT_FALSE(record.metric("flight_time_s"));  // the payload has not landed
    EXPECT_NEAR(last(record, "altitude") - last(record, "separation"), 80.0, 1e-9);
}

TEST(RomDeployment, RefusesAnOpeningThatTheSnatchSpeedMakesImpossible) {
    // 0.5 D0/v_s = 0.2 s of initial phase against 0.1 s of filling: known only once the snatch speed is.
    Scene scene = crane_drop();
    scene.parachutes.front().fill_time = {find_fill_time("given"), 0.0, 0.0, 0.1};
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::refused);
    EXPECT_NE(record.status.detail.find("the initial phase is not shorter than the filling time"),
              std::string::npos)
        << record.status.detail;
}

TEST(RomDeployment, LacksADragAreaOnlyForAFreePack) {
    const Fidelity& row = rom::rom_fidelity();
    EXPECT_EQ(row.unsupported_keys(free_deployment(0.0)),
              std::vector<std::string>{"parachute.deploy.pack_drag_area"});
    EXPECT_TRUE(row.unsupported_keys(free_deployment(0.1)).empty());
    EXPECT_TRUE(row.unsupported_keys(crane_drop()).empty());
    EXPECT_TRUE(row.unsupported_keys(extraction({0.0, 1.0}, {9.0, 9.0})).empty());
}

TEST(RomInflated, FallsAsTanhFromTheRelease) {
    // The drag area is that of the steady canopy throughout: v = v_e tanh(g t/v_e), exactly.
    Scene scene = packed_scene();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.aerodynamics.added_mass.reset();
    run_for(scene, 3.0);
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed);
    const double v_e = std::sqrt(2.0 * together * g / (1.225 * 42.56));
    const auto &t = record.find_channel("time")->values, &v = record.find_channel("speed")->values;
    for (std::size_t i = 0; i < t.size(); ++i)
        EXPECT_NEAR(v[i], v_e * std::tanh(g * t[i] / v_e), 1e-6) << t[i];
    for (const char* key :
         {"snatch_time_s", "snatch_speed_m_s", "filling_time_s", "mass_ratio", "impulse_N_s"})
        EXPECT_FALSE(record.metric(key)) << key;
}

TEST(RomInflated, PeakCountsFromTheRelease) {
    // At 30 m/s drag is largest at once: the risers carry its share m_l/(m_l + m_p) of the payload.
    Scene scene = packed_scene();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.aerodynamics.added_mass.reset();
    scene.release.speed = 30.0;
    const RunRecord record = run_rom(scene);
    const double drag = 0.5 * 1.225 * 900.0 * 42.56;
    EXPECT_NEAR(metric(record, "peak_force_N"), payload / together * drag, 1e-9 * drag);
    EXPECT_EQ(record.find_event("peak-force")->time, 0.0);
}

TEST(RomInflated, ATurningPointOfTheSpeedIsNoSteadyDescent) {
    // Released level, the parachute slows down below its rate of descent before it falls: for a moment the
    // speed does not change at all.
    Scene scene = packed_scene();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release = {85.0, 30.0, 0.0, 0.0};
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed);
    const auto& v = record.find_channel("speed")->values;
    const double v_e = std::sqrt(2.0 * together * g / (1.225 * 42.56));
    EXPECT_LT(*std::ranges::min_element(v), 0.95 * v_e);
    EXPECT_NEAR(metric(record, "descent_rate_m_s"), v_e, 0.01 * v_e);
}

TEST(RomStop, AtThePeakEndsOnceTheForceHasFallen) {
    // A root of the force once the drag area is full.
    for (Scene scene : {c9_scene(), crane_drop()}) {
        scene.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
        const RunRecord record = run_rom(scene);
        EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
        EXPECT_NEAR(last(record, "force") / metric(record, "peak_force_N"), past_peak, 1e-6);
        EXPECT_GT(last(record, "time"), record.find_event("full-open")->time);
        scene.stop.delay = 0.5;
        EXPECT_NEAR(last(run_rom(scene), "time"), last(record, "time") + 0.5, 1e-12);
    }
    // A light payload's peak is over long before: the run ends at full open.
    Scene light = c9_scene();
    light.payload.mass = 10.0;
    light.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
    const RunRecord opened = run_rom(light);
    EXPECT_EQ(opened.status.code, StatusCode::completed);
    EXPECT_EQ(last(opened, "time"), opened.find_event("full-open")->time);
    // An inflated start falls off from its first instant: a root of the force.
    Scene scene = packed_scene();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 30.0;
    scene.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
    const RunRecord record = run_rom(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed);
    EXPECT_NEAR(last(record, "force") / metric(record, "peak_force_N"), past_peak, 1e-6);
    // Where the force never falls that far the steady descent ends the run.
    scene.release.speed = 1.0;
    const RunRecord slow = run_rom(scene);
    EXPECT_EQ(slow.status.code, StatusCode::completed);
    EXPECT_NE(slow.find_event("steady-descent"), nullptr);
}

}  // namespace
}  // namespace twinchute
