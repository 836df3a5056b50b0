// A payload that is a rigid body under parachutes that come out one after the other: it tumbles while none is
// out, each takes its part of inertia and angular momentum, and risers begin where it has turned to.
#include <fmt/format.h>
#include <gsl/gsl_sf_elljac.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "fullsim/attitude.hpp"
#include "fullsim/body.hpp"
#include "fullsim/cluster.hpp"
#include "fullsim/fidelity.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/solve/fidelity.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/momentum.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

/// The shipped drogue, on four risers, and main, over a crate on a mesh that runs in a second.
Scene over_a_crate(const std::vector<std::string>& changes = {}) {
    std::vector<std::string> all{"full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}",
                                 "full.checkpoint_interval=0", "parachute.drogue.riser_length='0.8 m'",
                                 "payload.body={shape='box',size=[0.6,0.9,0.3]}"};
    all.insert(all.end(), changes.begin(), changes.end());
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-drogue.toml", all);
}

Scene in_vacuum(Scene scene) {
    scene.environment.atmosphere = test::c9_scene().environment.atmosphere;  // of one density,
    scene.environment.atmosphere.constant_density = 0.0;
    scene.environment.gravity = 1e-30;
    scene.aerodynamics = {};
    return scene;
}

/// Release of a payload that turns at `spin` [rad/s] about its own axes.
PayloadFlight turning(const Scene& scene, const Vec3& spin) {
    PayloadFlight payload = released_payload(scene);
    payload.body->momentum =
        turn_of(payload.body->attitude) * Vec3(spin.cwiseProduct(*moments_of_payload(scene)));
    return payload;
}

TEST(BodyAlone, TumblesAsEulerSays) {
    // Moments of a box: m (b^2 + c^2)/12. Landau and Lifshitz, Mechanics, 37, with axes in rising order of
    // their moments, started in the plane of the least and the largest; the integrator's 1e-10, for a hundred
    // of its steps or so.
    const Scene scene = over_a_crate();
    const double m = scene.payload.mass / 12.0;
    const Vec3 moments(m * (0.81 + 0.09), m * (0.36 + 0.09), m * (0.36 + 0.81));
    EXPECT_LT((*moments_of_payload(scene) - moments).norm(), 1e-12 * moments.norm());
    const double least = moments.y(), middle = moments.x(), largest = moments.z();
    const double slow = 1.5, fast = 3.0, time = 6.0;  // [rad/s] about these
    const PayloadFlight start = turning(scene, {0.0, slow, fast}), end = fly_free(scene, start, time);
    const double twice = least * slow * slow + largest * fast * fast,
                 square = std::pow(least * slow, 2) + std::pow(largest * fast, 2);
    ASSERT_GT(square, twice * middle);
    const double u =
        time * std::sqrt((largest - middle) * (square - twice * least) / (least * middle * largest));
    const double modulus =
        (middle - least) * (twice * largest - square) / ((largest - middle) * (square - twice * least));
    double sn = 0.0, cn = 0.0, dn = 0.0;
    gsl_sf_elljac_e(u, modulus, &sn, &cn, &dn);
    const double across = std::sqrt((twice * largest - square) / (middle * (largest - middle)));
    const Vec3 own = (turn_of(end.body->attitude).conjugate() * end.body->momentum).cwiseQuotient(moments);
    // The axes y, x, -z are as right-handed as x, y, z.
    EXPECT_NEAR(own.y(), slow * cn, 1e-7);
    EXPECT_NEAR(std::abs(own.x()), std::abs(across * sn), 1e-7);
    EXPECT_NEAR(own.z(), fast * dn, 1e-7);
    EXPECT_GT(std::abs(across * sn), 0.1);
    EXPECT_EQ(end.body->momentum, start.body->momentum);
    EXPECT_NEAR(turn_of(end.body->attitude).norm(), 1.0, 1e-15);
    // It turns about a fixed axis by rate times time.
    const PayloadFlight spun = fly_free(scene, turning(scene, {0.0, 0.0, 0.5}), 2.0);
    EXPECT_NEAR(turn_of(spun.body->attitude).angularDistance(turn_of(start.body->attitude)), 1.0, 1e-9);
}

TEST(BodyAlone, DragsAsItsAttitudeSays) {
    // Level flight, the body's axis turned out of the way back by so much.
    Scene scene = over_a_crate();
    scene.release.path_angle = 0.0;
    scene.payload.drag_area_table.emplace("", std::vector{0.0, 0.5 * pi, pi}, std::vector{0.4, 1.0, 0.6});
    scene.payload.drag_area = 0.4;
    PayloadFlight payload = released_payload(scene);
    const double q = 0.5 * scene.environment.atmosphere.at(scene.release.altitude).density *
                     payload.velocity.squaredNorm();
    for (const auto& [angle, area] : {std::pair{0.0, 0.4}, {0.25 * pi, 0.7}, {0.5 * pi, 1.0}, {pi, 0.6}}) {
        const Vec3 axis = -payload.velocity.normalized();
        const Eigen::Quaterniond turn =
            Eigen::AngleAxisd(angle, Vec3::UnitZ()) * Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis);
        payload.body->attitude = attitude_of(turn);
        const Vec3 expected = q * area / payload.mass * axis - scene.environment.gravity * Vec3::UnitZ();
        EXPECT_LT((free_acceleration(scene, payload) - expected).norm(), 1e-12 * expected.norm()) << angle;
    }
    // A tumbling one meets all of them: over half a turn of an even turning across the air the mean of a
    // table that is linear in the angle, 0.75, 0.7 for 0 to pi/2 and 0.8 beyond; its speed hardly changes
    // meanwhile.
    scene.payload.mass = 1e5;
    scene.environment.gravity = 0.0;
    payload = turning(scene, {0.0, pi / 0.1, 0.0});
    payload.mass = 1e5;
    const double before = payload.velocity.norm(), after = fly_free(scene, payload, 0.1).velocity.norm();
    EXPECT_NEAR((before - after) / (0.1 * q * 0.75 / payload.mass), 1.0, 1e-3);
}

TEST(BodyInStages, OutFromTheReleaseIsARunWithoutStages) {
    // As of a cluster (Stages.AClusterThatIsOutFromTheReleaseIsOneWithoutStages): a bound of the step that
    // knows the air from the first is 0.6 % longer, so that steps are others: forces and angles by 1e-4.
    for (const char* risers : {"parachute.risers=1", "parachute.risers=4"}) {
        Scene plain =
            read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml",
                       {"payload.body={shape='box',size=[0.6,0.9,0.3]}", risers,
                        "full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}"});
        plain.release.path_angle = 0.6;
        plain.stop = {Trigger::Kind::time, 0.1, 0.0};
        Scene staged = plain;
        staged.parachutes.front().deploy_when = Trigger{Trigger::Kind::time, 0.0, 0.0};
        const RunRecord a = test::run_full(plain), b = test::run_full(staged);
        ASSERT_EQ(b.status.code, StatusCode::completed) << b.status.detail;
        EXPECT_NEAR(static_cast<double>(b.cost.steps) / static_cast<double>(a.cost.steps), 0.994, 0.003);
        EXPECT_NEAR(*a.metric("max_force_N"), *b.metric("max_force_N"), 1e-4 * *a.metric("max_force_N"));
        const auto &tilt_a = a.find_channel("payload_tilt")->values,
                   &tilt_b = b.find_channel("payload_tilt")->values;
        ASSERT_EQ(tilt_a.size(), tilt_b.size());
        EXPECT_NEAR(tilt_a.front(), 0.5 * pi - 0.6, 1e-9);
        EXPECT_GT(std::abs(tilt_a.back() - tilt_a.front()), 1e-5);
        EXPECT_NEAR(tilt_a.back(), tilt_b.back(), 1e-6);
    }
}

/// [kg m^2/s] of all that is out, with its payload, about the centre of mass, and the size of its terms.
Vec3 angular_momentum(const Cluster& cluster, double& size) {
    Vec3 angular = Vec3::Zero(), linear = Vec3::Zero(), centre = Vec3::Zero();
    double mass = 0.0;
    size = 0.0;
    for (const std::size_t k : cluster.out()) {
        const test::Momentum one = test::momentum_of(cluster[k]);
        const NodeConstants& constants = cluster[k].constants();
        angular += one.angular + cluster[k].system().body->half_momentum;
        linear += one.linear;
        centre += constants.system_mass * cluster[k].system().sums.system_position;
        mass += constants.system_mass;
        size += one.turning;
    }
    return angular - (centre / mass).cross(linear);
}

/// All of them carry the same attitude and an even part of the same angular momentum.
void expect_one_body(const Cluster& cluster) {
    const SystemState& first = cluster.front().system();
    for (const std::size_t k : cluster.out()) {
        EXPECT_EQ(cluster[k].system().body->attitude, first.body->attitude) << k;
        EXPECT_EQ(cluster[k].system().body->momentum, first.body->momentum) << k;
    }
}

TEST(BodyInStages, AngularMomentumIsKeptAsParachutesJoinAndLeave) {
    // In vacuum, about the centre of mass of all that is out. Noise lets the drogue turn the crate, so that
    // the main's mortar throws from where it has turned to.
    Scene scene = in_vacuum(
        over_a_crate({"parachute.drogue.deploy={by='line-stretch'}", "parachute.main.risers=1",
                      "parachute.main.deploy={by='mortar',muzzle_speed='20 m/s',when={time=0.1}}"}));
    scene.release.altitude = 0.0;
    scene.full.line_substeps = 1;
    scene.full.noise = Noise{1e-3, 3};
    Cluster cluster(scene);
    const double all = cluster.payload().mass;
    const auto fly = [&](double seconds) {
        const double end = cluster.time() + seconds;
        while (cluster.time() < end) {
            cluster.step_to(end);
            ASSERT_FALSE(cluster.fault()) << cluster.fault()->detail;
            cluster.evaluate_forces();  // once at each instant: those of a join or a leave have been
        }
        expect_one_body(cluster);
    };
    const auto kept_over = [&](double seconds) {
        double size = 0.0;
        const Vec3 before = angular_momentum(cluster, size);
        fly(seconds);
        const Vec3 after = angular_momentum(cluster, size);
        EXPECT_LT((after - before).norm(), 1e-9 * size);
    };
    const std::size_t drogue = cluster.join(0, all - scene.parachutes[0].mass);
    EXPECT_EQ(cluster.payload().body->momentum, Vec3::Zero());
    kept_over(0.1);
    const PayloadFlight before = cluster.payload();
    ASSERT_GT(before.body->momentum.norm(), 1e-6);

    const std::size_t main = cluster.join(1, all - scene.parachutes[0].mass - scene.parachutes[1].mass);
    const PayloadFlight thrown = cluster.payload();
    EXPECT_EQ(thrown.body->attitude, before.body->attitude);
    expect_one_body(cluster);
    // The pack and the payload throw each other from the end of the risers.
    const Simulation& canopy = cluster[main];
    const State& state = canopy.synchronised_state();
    const Vec3 end = canopy.riser_end();
    EXPECT_GT((end - thrown.position).norm(), 0.14);
    Vec3 kick = Vec3::Zero();
    for (NodeIndex i = 0; i < canopy.mesh().payload(); ++i)
        kick += canopy.mesh().mass[static_cast<std::size_t>(i)] *
                (to_vec3(state.node[static_cast<std::size_t>(i)].v) - before.velocity);
    EXPECT_GT(kick.norm(), 19.0 * scene.parachutes[1].mass * 0.9);
    EXPECT_LT((thrown.body->momentum - before.body->momentum + (end - thrown.position).cross(kick)).norm(),
              1e-9 * 0.15 * kick.norm());
    kept_over(0.05);

    const Vec3 spin = cluster.front().payload_spin();
    cluster.leave(drogue);
    EXPECT_LT((cluster.front().payload_spin() - spin).norm(), 1e-12 * spin.norm());
    expect_one_body(cluster);
    kept_over(0.05);
    const PayloadFlight last = cluster.payload();
    cluster.leave(main);
    ASSERT_TRUE(cluster.out().empty());
    EXPECT_EQ(cluster.payload().body->attitude, last.body->attitude);
    EXPECT_EQ(cluster.payload().body->momentum, last.body->momentum);
    cluster.step_to(cluster.time() + 0.1);
    EXPECT_EQ(cluster.payload().body->momentum, last.body->momentum);
    EXPECT_GT(turn_of(cluster.payload().body->attitude).angularDistance(turn_of(last.body->attitude)), 1e-6);
}

TEST(BodyInStages, TheLedgerOfEachBeginsWithItsPartOfTheTurning) {
    // A crate turns at 10 rad/s as the main comes out of its pack; then another takes half of it, which is
    // work from outside. Rounding of the kinetic energy.
    const Scene scene = over_a_crate();
    const PayloadFlight at = turning(scene, {3.0, 5.0, -8.0});
    const Scene one = scene_in_flight(scene, 1, at);
    Simulation canopy(one);
    PayloadPart part{canopy.payload_node_mass(), at.velocity, moments_of_payload(scene), at.body};
    canopy.begin_at(at.position, part, 0);
    canopy.evaluate_forces();
    const Vec3 spin = canopy.payload_spin();
    const double energy = 0.5 * spin.dot(at.body->momentum), moving = 0.5 * one.payload.mass * 70.0 * 70.0;
    EXPECT_GT(energy, 100.0);
    EXPECT_LT(std::abs(residual(canopy.ledger())), 1e-12 * moving);
    *part.moments *= 0.5;
    part.body->momentum *= 0.5;
    part.body->half_momentum = part.body->momentum;
    canopy.bear(part);
    EXPECT_LT((canopy.payload_spin() - spin).norm(), 1e-12 * spin.norm());
    EXPECT_LT(std::abs(residual(canopy.ledger())), 1e-12 * moving);
    EXPECT_NEAR(canopy.ledger().external_work, -0.5 * energy, 1e-9 * energy);
}

TEST(BodyInStages, RisersBeginWhereTheCrateHasTurnedTo) {
    // At any attitude, on one riser and four, in the pack and drawn out: risers end on the crate, and none is
    // longer than its load makes it.
    for (const char* risers : {"parachute.main.risers=1", "parachute.main.risers=4"})
        for (const char* by : {"mortar', muzzle_speed='20 m/s", "line-stretch"}) {
            const Scene scene = over_a_crate(
                {risers, fmt::format("parachute.main.deploy={{by='{}',when={{time=0.1}}}}", by)});
            PayloadFlight at = released_payload(scene);
            for (const double angle : {0.0, 0.3, 1.0, 2.5}) {
                SCOPED_TRACE(fmt::format("{} {} {}", risers, by, angle));
                const Eigen::Quaterniond turn = Eigen::AngleAxisd(angle, Vec3(1.0, 2.0, 0.5).normalized()) *
                                                turn_of(released_payload(scene).body->attitude);
                at.body->attitude = attitude_of(turn);
                const Scene one = scene_in_flight(scene, 1, at);
                const Simulation canopy(one);
                const Mesh& mesh = canopy.mesh();
                const State& state = canopy.synchronised_state();
                // Half of the height over the centre, at the middle or at the corners of the upper face.
                for (std::size_t k = 0; k < mesh.attachments.size(); ++k) {
                    const Vec3 own = turn.conjugate() * mesh.attachments[k];
                    EXPECT_NEAR(own.z(), 0.15, 1e-12);
                    EXPECT_NEAR(std::abs(own.x()), mesh.attachments.size() == 1 ? 0.0 : 0.3, 1e-12);
                }
                const bool packed = scene.parachutes[1].deploy.starts_packed();
                for (const Cable& cable : mesh.cables) {
                    if (cable.kind != CableKind::riser) continue;
                    const double length = to_vec3(state.node[static_cast<std::size_t>(cable.node[0])].x -
                                                  state.node[static_cast<std::size_t>(cable.node[1])].x)
                                              .norm();
                    EXPECT_LT(length, cable.rest_length * (packed ? 1.0 : mesh.line_stretch) * (1.0 + 1e-9));
                }
                // The parachute trails straight behind the middle of the attachments.
                const Vec3 beside =
                    canopy.riser_end() - at.position - (canopy.system().sums.canopy_position - at.position);
                EXPECT_LT(beside.cross(mesh.axis).norm(), packed ? 0.05 : 0.02);
            }
        }
}

TEST(BodyInStages, TheLedgerClosesAndTheCrateIsSeenToTurn) {
    const Scene scene = over_a_crate({"stop={time=6}"});
    const RunRecord record = test::run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_LT(std::abs(record.energy->residual_fraction), 1e-3);
    const auto& tilt = record.find_channel("payload_tilt")->values;
    // It falls unturned for half a second, from hanging straight behind a flight 30 deg below the horizon.
    const auto& time = record.find_channel("time")->values;
    for (std::size_t k = 0; k < time.size() && time[k] < 0.5; ++k)
        EXPECT_NEAR(tilt[k], pi / 3.0, 1e-9) << time[k];
    EXPECT_GT(std::abs(tilt.back() - pi / 3.0), 0.1);
    EXPECT_TRUE(std::ranges::any_of(record.left_out, [](const auto& left) {
        return left.what == "the inertia of packs on the payload";
    }));
    // Forces are those over a point mass, but for risers that begin at corners: within a tenth.
    Scene point = scene;
    point.payload.body.reset();
    const RunRecord other = test::run_full(point);
    EXPECT_FALSE(other.find_channel("payload_tilt"));
    EXPECT_NEAR(*record.metric("drogue_peak_force_N") / *other.metric("drogue_peak_force_N"), 1.0, 0.1);
}

TEST(BodyInStages, ACanopyOpensInFlightOverACrateThatHasTurned) {
    // It has settled over a crate that hangs straight, and is set on the one that has turned by 16 deg: the
    // first force at that dynamic pressure is that over a point mass, its risers bear it.
    const auto first_force = [](const Scene& scene) {
        const RunRecord record = test::run_full(scene);
        EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
        const auto &time = record.find_channel("time")->values,
                   &force = record.find_channel("force_raw")->values,
                   &pressure = record.find_channel("dynamic_pressure")->values;
        const auto begins = std::ranges::upper_bound(time, record.find_event("main.full-open")->time);
        const auto row = static_cast<std::size_t>(begins - time.begin());
        return force.at(row) / pressure.at(row);
    };
    const Scene crate = over_a_crate({"parachute.main.deploy={by='inflated',when={time=1}}",
                                      "parachute.main.risers=1", "parachute.drogue.cut={time=0.9}",
                                      "parachute.drogue.deploy={by='line-stretch'}", "stop={time=1.1}"});
    Scene point = crate;
    point.payload.body.reset();
    EXPECT_NEAR(first_force(crate) / first_force(point), 1.0, 0.01);

    PayloadFlight at = released_payload(crate);
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(0.28, Vec3(1.0, 2.0, 0.5).normalized()) * turn_of(at.body->attitude);
    at.body->attitude = attitude_of(turn);
    // The parachute is set there as it is: its risers are as long as over the crate that hangs straight.
    const auto risers_over = [&](const PayloadFlight& payload, bool straight) {
        Scene one = scene_in_flight(crate, 1, payload);
        if (straight) one.release.attitude.reset();
        Simulation canopy(one);
        canopy.settle([] { return false; });
        EXPECT_TRUE(canopy.has_settled());
        const Vec3 end = canopy.riser_end() - payload.position;
        if (!straight) {
            EXPECT_LT((end - turn_of(payload.body->attitude) * Vec3(0.0, 0.0, 0.15)).norm(), 1e-12);
        }
        const State& state = canopy.synchronised_state();
        std::vector<double> lengths;
        for (const Cable& cable : canopy.mesh().cables)
            if (cable.kind == CableKind::riser)
                lengths.push_back(to_vec3(state.node[static_cast<std::size_t>(cable.node[0])].x -
                                          state.node[static_cast<std::size_t>(cable.node[1])].x)
                                      .norm() /
                                  cable.rest_length);
        return lengths;
    };
    const std::vector<double> turned = risers_over(at, false), straight = risers_over(at, true);
    ASSERT_EQ(turned.size(), straight.size());
    for (std::size_t k = 0; k < turned.size(); ++k) {
        EXPECT_GT(straight[k], 1.01);
        EXPECT_NEAR(turned[k], straight[k], 1e-9) << k;
    }
}

TEST(BodyInStages, PartsOfTheCrateHaveTogetherTheDragOfItsAttitude) {
    Scene scene = over_a_crate({"parachute.main.deploy={by='line-stretch',when={time=0.1}}"});
    scene.payload.drag_area_table.emplace("", std::vector{0.0, 0.5 * pi}, std::vector{0.4, 1.0});
    scene.payload.drag_area = 0.4;
    scene.aerodynamics = {};
    Cluster cluster(scene);
    const double all = cluster.payload().mass;
    // It falls unturned, and the air comes from another side with time.
    while (cluster.time() < 2.0)
        cluster.step_to(2.0);
    cluster.join(0, all - scene.parachutes[0].mass);
    cluster.join(1, all - scene.parachutes[0].mass - scene.parachutes[1].mass);
    const PayloadFlight payload = cluster.payload();
    const double angle = attitude_in_air(body_axis(*payload.body), payload.velocity);
    EXPECT_GT(angle, 0.1);
    const double density = scene.environment.atmosphere.at(payload.position.z()).density;
    Vec3 sum = Vec3::Zero();
    for (const std::size_t k : cluster.out())
        sum += to_vec3(cluster[k].payload_drag());
    const Vec3 expected =
        -0.5 * density * (0.4 + 0.6 * angle / (0.5 * pi)) * payload.velocity.norm() * payload.velocity;
    EXPECT_LT((sum - expected).norm(), 1e-9 * expected.norm());
}

TEST(BodyInStages, WhatCannotBeIsRefusedByKey) {
    const auto lacking = [](const std::vector<std::string>& changes) {
        const Scene scene = over_a_crate(changes);
        return std::pair{full_fidelity().unsupported_keys(scene),
                         unsupported_text(scene, full_fidelity().unsupported_keys(scene))};
    };
    EXPECT_TRUE(lacking({}).first.empty());
    EXPECT_EQ(lacking({"payload.body.elasticity={youngs_modulus=1e9,poisson_ratio=0.3}"}).first,
              std::vector<std::string>{"payload.body.elasticity"});
    const auto open = lacking({"parachute.main.deploy={by='inflated',when={time=1}}"});
    EXPECT_EQ(open.first, std::vector<std::string>{"parachute.main.deploy.by"});
    EXPECT_NE(open.second.find("over a payload.body that has turned a canopy starts open on one riser alone"),
              std::string::npos);
    EXPECT_TRUE(lacking({"parachute.main.deploy={by='inflated',when={time=1}}", "parachute.main.risers=1"})
                    .first.empty());
    Scene released = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml",
                                {"payload.body={shape='box',size=[0.6,0.9,0.3]}", "parachute.risers=4",
                                 "parachute.deploy={by='inflated'}", "parachute.cut={time=2}"});
    EXPECT_TRUE(full_fidelity().unsupported_keys(released).empty());  // it hangs straight
    const auto several = lacking({"parachute.main.count=2"});
    EXPECT_EQ(several.first, std::vector<std::string>{"parachute.main.risers"});
    EXPECT_NE(several.second.find("meet at one point of payload.body: write 1"), std::string::npos);
    EXPECT_TRUE(lacking({"parachute.main.count=2", "parachute.main.risers=1"}).first.empty());
}

}  // namespace
}  // namespace twinchute::fullsim
