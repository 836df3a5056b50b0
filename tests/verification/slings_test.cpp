// Slings between a payload that is a body and the one point that parachutes hang on.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "fullsim/attitude.hpp"
#include "fullsim/run/sling_loads.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

const std::string c9 = TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml";

PayloadBody box_on_slings() {
    return {PayloadBody::Shape::box, {1.2, 0.8, 0.6}, 2.0};
}
PayloadBody drum_on_slings() {
    return {PayloadBody::Shape::cylinder, {0.7, 1.0}, 1.5};
}

RunRecord under(const PayloadBody& body, const Vec3& pull, const BodyState& turned = {}) {
    SlingLoads loads(sling_geometry(body));
    loads.observe(0.5, pull, turned);
    RunRecord record;
    loads.fill(record);
    return record;
}

TEST(SlingLoads, AreThoseOfTheLeastSquares) {
    // Four directions from the apex down to the corners: the tensions that hold a pull are, of springs alike,
    // the solution of least norm, here by a singular value decomposition of the directions.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (const PayloadBody& body : {box_on_slings(), drum_on_slings()}) {
        const bool box = body.shape == PayloadBody::Shape::box;
        const double x = box ? 0.6 : 0.35 * std::sqrt(0.5), y = box ? 0.4 : x, length = *body.sling_length;
        Eigen::Matrix<double, 3, 4> down;
        int k = 0;
        for (const double to_x : {x, -x})
            for (const double to_y : {y, -y})
                down.col(k++) = Vec3(to_x, to_y, -std::sqrt(length * length - x * x - y * y)) / length;
        for (int n = 0; n < 20; ++n) {
            const Vec3 pull(50.0 * number(random), 50.0 * number(random), 500.0 + 400.0 * number(random));
            const Eigen::Vector4d tension =
                down.jacobiSvd(Eigen::ComputeFullU | Eigen::ComputeFullV).solve(Vec3(-pull));
            const Eigen::AngleAxisd turn(2.0 * number(random), Vec3(1.0, 0.3, -2.0).normalized());
            const RunRecord record =
                under(body, turn * pull, BodyState{attitude_of(Eigen::Quaterniond(turn))});
            EXPECT_NEAR(*record.metric("max_sling_tension_N"), tension.maxCoeff(),
                        1e-12 * tension.maxCoeff());
            EXPECT_TRUE(tension.minCoeff() < 0.0 || record.warnings.empty());
        }
    }
}

TEST(SlingLoads, SlackOnesAreSaidBeyondTheConeOfSlings) {
    // A drum is pulled aside between two of its slings, which end 0.35 m/sqrt(2) from the axis on that side:
    // the two others are slack once the pull leaves the plane that they lie in.
    const double reach = 0.35, rise = std::sqrt(1.5 * 1.5 - reach * reach);
    for (const double share : {0.9, 1.1}) {
        const double aside = share * reach * std::sqrt(0.5) / rise;
        const RunRecord record = under(drum_on_slings(), Vec3(1000.0 * aside, 0.0, 1000.0));
        ASSERT_EQ(record.warnings.size(), share > 1.0 ? 1u : 0u) << share;
        for (const Warning& warning : record.warnings)
            EXPECT_NE(warning.what.find("slings would have been slack"), std::string::npos);
    }
    EXPECT_TRUE(under(drum_on_slings(), Vec3::Zero()).warnings.empty());  // a pack pulls nothing
}

TEST(Slings, RisersMeetAboveTheBody) {
    Scene scene =
        read_scene(c9, {"payload.body={shape='box',size=[1.2,0.8,0.6],sling_length=2}", "parachute.risers=1",
                        "full.mesh={gore_columns=2,gore_rows=7,"
                        "line_elements=10,riser_elements=2}"});
    const Simulation canopy(scene);
    const double rise = std::sqrt(4.0 - 0.36 - 0.16);
    EXPECT_NEAR((canopy.riser_end() - to_vec3(canopy.payload().x)).dot(canopy.mesh().axis), 0.3 + rise,
                1e-12);
    // Slings have no mass and no inertia: the body is the one without.
    Scene bare = scene;
    bare.payload.body->sling_length.reset();
    const Simulation other(bare);
    EXPECT_EQ(canopy.mesh().body->lumped.inertia, other.mesh().body->lumped.inertia);
    EXPECT_EQ(canopy.mesh().mass, other.mesh().mass);
}

TEST(Slings, ACrateBearsTheForceOfAClusterThroughFour) {
    // Two canopies side by side pull straight up: a quarter each, over the slings' cosine.
    const Scene scene = read_scene(c9, {"payload.body={shape='box',size=[1.2,0.8,0.6],sling_length=2}",
                                        "parachute.risers=1", "parachute.count=2", "payload.mass=300",
                                        "full.mesh={gore_columns=2,gore_rows=7,line_elements=10,"
                                        "riser_elements=2}",
                                        "stop={time=2}"});
    const RunRecord record = test::run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const auto& raw = record.find_channel("force_raw")->values;
    const double cosine = std::sqrt(4.0 - 0.36 - 0.16) / 2.0;
    // The largest of 200 rows a second is below that of all steps; the body tilts by a hundredth.
    EXPECT_NEAR(*record.metric("max_sling_tension_N") / (0.25 * std::ranges::max(raw) / cosine), 1.0, 0.05);
    EXPECT_GE(*record.metric("max_sling_tension_N"), 0.25 * *record.metric("max_force_N") / cosine);
    EXPECT_FALSE(test::run_full([&] {
                     Scene bare = scene;
                     bare.payload.body->sling_length.reset();
                     bare.stop.value = 0.05;
                     return bare;
                 }())
                     .metric("max_sling_tension_N"));
}

TEST(Slings, WhatDoesNotMeetIsRefused) {
    const auto refused = [](const char* body, const char* says, const char* risers = "parachute.risers=1") {
        try {
            read_scene(c9, {body, risers});
            ADD_FAILURE() << body;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.key(), "payload.body.sling_length");
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    };
    refused("payload.body={shape='box',size=[1.2,0.8,0.6],sling_length=0.7}", "slings of 0.7 m do not meet");
    refused("payload.body={shape='cylinder',size=[1.2,0.6],sling_length=0.6}", "slings of 0.6 m do not meet");
    refused("payload.body={shape='box',size=[1.2,0.8,0.6],sling_length=2}", "4 risers of 'USAF C-9'",
            "parachute.risers=4");
    refused(
        "payload.body={shape='box',size=[1.2,0.8,0.6],sling_length=2,elasticity={youngs_modulus=1e9,poisson_"
        "ratio=0.3}}",
        "slings on a deformable body");
    refused("payload.body={shape='mesh',sling_length=2}", "slings on a body of a mesh");
}

}  // namespace
}  // namespace twinchute::fullsim
