// A canopy that starts open has settled into the shape that it flies with: its first force is that of
// payload, parachute and added mass as one rigid body, whichever way it flies, and nothing rings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fullsim/cluster.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

Scene open_c9(double speed) {
    Scene scene = test::c9_scene();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.full.mesh = {2, 9, 5, 2};
    scene.release.speed = speed;
    scene.stop = {Trigger::Kind::time, 0.5, 0.0};
    return scene;
}

/// [m/s] of the open canopy of c9_scene with all that it carries: q C_D S carries the weight.
double steady_speed(const Scene& scene) {
    const double mass = scene.payload.mass + Simulation(scene).mesh().parachute_mass();
    return std::sqrt(2.0 * mass * test::g / (1.225 * scene.parachutes.front().drag_area));
}

double first(const RunRecord& record, const char* channel) {
    return record.find_channel(channel)->values.front();
}

bool says_unsettled(const RunRecord& record) {
    return std::ranges::any_of(record.warnings, [](const Warning& warning) {
        return warning.what.find("had not settled") != std::string::npos;
    });
}

/// [N] on the payload m_l of a rigid body m that falls straight down, with added mass M_a that has no weight:
/// m_l (D + M_a g)/(m + M_a).
double rigid_force(const Scene& scene, double speed) {
    Simulation start(scene);
    start.settle([] { return false; });
    const double added = start.system().added_mass, payload = start.payload_node_mass(),
                 all = scene.payload.mass + start.mesh().parachute_mass(),
                 drag = 0.5 * 1.225 * speed * speed * scene.parachutes.front().drag_area;
    EXPECT_GT(added, 0.2 * all);  // it is what makes the difference to m_l D/m
    return payload * (drag + added * test::g) / (all + added);
}

class Settling : public testing::TestWithParam<double> {};

TEST_P(Settling, TheFirstForceIsThatOfARigidBody) {
    // M_a of the settled shape. 1 %: what the relaxation leaves.
    const Scene scene = open_c9(GetParam());
    const RunRecord record = test::run_full(scene);
    EXPECT_NEAR(first(record, "force_raw") / rigid_force(scene, GetParam()), 1.0, 0.01);
    EXPECT_FALSE(says_unsettled(record));
}

TEST_P(Settling, NothingRingsAfterwards) {
    // Above the steady speed the force falls from its first value on; below it rises to the weight and no
    // further. Unsettled the peak is 2.3 times that at the steady speed.
    Scene scene = open_c9(GetParam());
    scene.stop.value = 1.5;
    const RunRecord record = test::run_full(scene);
    const double weight = scene.payload.mass * test::g;
    EXPECT_LT(*record.metric("peak_force_N"), 1.015 * std::max(weight, first(record, "force_raw")));
    EXPECT_LT(std::abs(record.energy->residual_fraction), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Speeds, Settling, testing::Values(5.0, 7.5, 15.0, 40.0),
                         [](const auto& one) { return "at" + std::to_string(static_cast<int>(one.param)); });

TEST(Settled, AtTheSteadySpeedTheForceStaysTheWeight) {
    Scene scene = open_c9(0.0);
    scene.release.speed = steady_speed(scene);
    scene.stop.value = 2.0;
    const std::vector<double> force = test::run_full(scene).find_channel("force_raw")->values;
    const auto [least, most] = std::ranges::minmax(force);
    // As at other speeds, where it is held against the rigid body's.
    const double weight = scene.payload.mass * test::g;
    EXPECT_NEAR(least / weight, 1.0, 0.015);
    EXPECT_NEAR(most / weight, 1.0, 0.015);
}

TEST(Settled, OnlyTheAirspeedMattersAndTheShapeIsTurnedAgainstIt) {
    // The first row: the same area and force to rounding, the axis of the canopy along the air; aslant, and
    // in a wind.
    const Scene down = open_c9(12.0);
    const RunRecord straight = test::run_full(down);
    Scene aslant = down, upwind = down;
    aslant.release.path_angle = 0.3;
    upwind.environment.wind = uniform_wind({4.0, -3.0, 0.0});
    upwind.release.speed = std::sqrt(144.0 - 25.0);
    for (const Scene& scene : {aslant, upwind}) {
        const RunRecord record = test::run_full(scene);
        for (const char* channel : {"projected_area", "force_raw"})
            EXPECT_NEAR(first(record, channel), first(straight, channel), 1e-9 * first(straight, channel))
                << channel;
        Cluster canopies(scene);
        canopies.settle(0, [] { return false; });
        const Vec3 axis =
            canopies.front().system().sums.canopy_position - to_vec3(canopies.front().payload().x);
        EXPECT_NEAR(axis.normalized().dot(-release_airspeed(scene).normalized()), 1.0, 1e-9);
        EXPECT_EQ(to_vec3(canopies.front().payload().x), Vec3(0.0, 0.0, scene.release.altitude));
    }
}

TEST(Settled, EveryLayoutSettlesAlike) {
    // They come to rest at other moments, by rounding: within what the relaxation leaves.
    const Scene scene = open_c9(12.0);
    Scene sector = scene;
    sector.full.symmetry = Symmetry::sector;
    twinchute::Run control;
    control.force_unstructured = true;
    const RunRecord gores = test::run_full(scene), one = test::run_full(sector),
                    any = run_fullsim(scene, control);
    ASSERT_NE(gores.provenance.instruction_set, any.provenance.instruction_set);
    for (const RunRecord& record : {one, any})
        for (const char* channel : {"projected_area", "force_raw"})
            EXPECT_NEAR(first(record, channel) / first(gores, channel), 1.0, 5e-3) << channel;
}

TEST(Settled, CanopiesThatComeOutInFlightHaveSettledToo) {
    // Alone, and two side by side.
    for (const char* count : {"1", "2"}) {
        const Scene scene = read_scene(
            TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml",
            {std::string("parachute.count=") + count, std::string("payload.mass=150"), "release.speed=10",
             "parachute.deploy={by='inflated',when={time='0.1 s'}}", "stop={time='0.3 s'}",
             "full.mesh={gore_columns=2,gore_rows=9,line_elements=5,riser_elements=2}"});
        const RunRecord record = test::run_full(scene);
        ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
        EXPECT_FALSE(says_unsettled(record));
        const auto& force = record.find_channel("force_raw")->values;
        const auto& time = record.find_channel("time")->values;
        const std::size_t out = static_cast<std::size_t>(std::ranges::upper_bound(time, 0.1) - time.begin());
        ASSERT_LT(out, time.size());
        EXPECT_GT(force[out], 0.0);
        // Faster than its steady speed: nothing after the first row with it is higher, but for the bounce of
        // canopies that lean, which settled upright (unsettled they pull 1.9 times as hard).
        EXPECT_NEAR(*record.metric("peak_force_N") / force[out], 1.0, *count == '1' ? 0.02 : 0.1);
    }
}

TEST(Settled, ABodyHangsInItsLegs) {
    Scene scene = open_c9(12.0);
    scene.parachutes.front().risers = 4;
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {1.0, 1.0, 0.5}};
    scene.release.path_angle = 1.0;
    const RunRecord record = test::run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_FALSE(says_unsettled(record));
    EXPECT_NEAR(*record.metric("peak_force_N") / first(record, "force_raw"), 1.0, 0.015);
}

TEST(Settled, AStartThatIsCutShortIsAsItWasMadeAndSaysSo) {
    const Scene scene = open_c9(12.0);
    Cluster canopies(scene);
    const Vec3 before = canopies.front().system().sums.canopy_position;
    canopies.settle(0, [] { return true; });
    EXPECT_EQ(canopies.front().system().sums.canopy_position, before);
    EXPECT_FALSE(canopies.front().has_settled());
    canopies.settle(0, [] { return false; });
    EXPECT_NE(canopies.front().system().sums.canopy_position, before);
    EXPECT_TRUE(canopies.front().has_settled());
    std::stop_source stop;
    stop.request_stop();
    EXPECT_TRUE(says_unsettled(test::run_full(scene, stop.get_token())));
}

TEST(Settled, WithoutAirNothingHasToSettle) {
    const Scene scene = open_c9(0.0);
    Cluster canopies(scene);
    const Vec3 before = canopies.front().system().sums.canopy_position;
    canopies.settle(0, [] { return false; });
    EXPECT_EQ(canopies.front().system().sums.canopy_position, before);
    EXPECT_TRUE(canopies.front().has_settled());
}

}  // namespace
}  // namespace twinchute::fullsim
