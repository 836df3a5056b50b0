// A payload that is a body, under its parachute.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/opening.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

Scene with_box(Scene scene, double a, double b, double c) {
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {a, b, c}};
    scene.full.mesh = {2, 7, 6, 2};
    scene.parachutes.front().risers = 4;
    return scene;
}

TEST(PayloadBody, HangsOnItsRisersWithoutStrain) {
    // Drawn out under load: risers as long as a point mass has them, straight to the corners.
    for (const int risers : {1, 4}) {
        Scene scene = with_box(test::c9_scene(), 0.6, 0.4, 0.9);
        scene.parachutes.front().risers = risers;
        Scene point = scene;
        point.payload.body.reset();
        const Inflation inflation = make_inflation(scene, scene.parachutes.front(), 0.0, 21.0, 1.225);
        const Mesh body = start_mesh(scene, inflation, Phase::initial);
        const Mesh bare = start_mesh(point, inflation, Phase::initial);
        ASSERT_EQ(body.attachments.size(), static_cast<std::size_t>(risers));
        const auto place = [](const Mesh& mesh, NodeIndex i) {
            return i < mesh.node_count() ? mesh.position[i] : mesh.attachments[i - mesh.first_attachment()];
        };
        for (std::size_t c = 0; c < body.cables.size(); ++c) {
            const auto length = [&](const Mesh& mesh) {
                return (place(mesh, mesh.cables[c].node[1]) - place(mesh, mesh.cables[c].node[0])).norm();
            };
            EXPECT_NEAR(length(body), length(bare), 1e-12);
        }
        EXPECT_LT(body.position[body.payload()].norm(), 1e-15);
        double mass = 0.0;
        for (const double m : body.mass)
            mass += m;
        EXPECT_NEAR(mass, body.parachute_mass() + scene.payload.mass, 1e-10);
    }
}

TEST(PayloadBody, HangsWhereItsShapeAllows) {
    const auto places = [](const PayloadBody& body, int risers) {
        Scene scene = with_box(test::c9_scene(), 0.6, 0.4, 0.9);
        scene.payload.body = body;
        scene.parachutes.front().risers = risers;
        return start_mesh(scene, inflated(scene.parachutes.front()), Phase::open).body->attachments();
    };
    const PayloadBody box{PayloadBody::Shape::box, {0.6, 0.4, 0.9}};
    EXPECT_EQ(places(box, 1), (std::vector<Vec3>{{0.0, 0.0, 0.45}}));
    EXPECT_EQ(
        places(box, 4),
        (std::vector<Vec3>{{0.3, 0.2, 0.45}, {-0.3, 0.2, 0.45}, {-0.3, -0.2, 0.45}, {0.3, -0.2, 0.45}}));
    EXPECT_THROW(places(box, 7), SceneError);
    const PayloadBody drum{PayloadBody::Shape::cylinder, {0.8, 1.0}};
    const std::vector<Vec3> rim = places(drum, 7);
    ASSERT_EQ(rim.size(), 7u);
    for (std::size_t k = 0; k < rim.size(); ++k) {
        // Half a step after x, on the rim of the tetrahedra itself.
        const double angle = 2.0 * pi * (static_cast<double>(k) + 0.5) / 7.0;
        EXPECT_LT((rim[k] - Vec3(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.5)).norm(), 1e-15);
    }
}

TEST(PayloadBody, OfNoSizeIsAPointMass) {
    // Its places within 0.2 mm, in the same layout, lines with and without subcycles: what is left after half
    // a second of a smooth opening is the little that such a body can turn.
    Scene scene = with_box(test::c9_scene(), 2e-4, 2e-4, 2e-4);
    scene.stop.value = 0.5;
    for (const int most : {1, 4}) {
        scene.full.line_substeps = most;
        Scene point = scene;
        point.payload.body.reset();
        const RunRecord body = test::run_full(scene), bare = test::run_full(point);
        ASSERT_EQ(body.status.code, StatusCode::completed) << body.status.detail;
        EXPECT_EQ(body.cost.steps, bare.cost.steps);
        EXPECT_NEAR(*body.metric("max_force_N"), *bare.metric("max_force_N"),
                    1e-3 * *bare.metric("max_force_N"));
        EXPECT_NEAR(test::last(body, "speed"), test::last(bare, "speed"), 1e-4 * test::last(bare, "speed"));
    }
}

TEST(PayloadBody, LeavesLinesTheirSubcycles) {
    // In fewer steps, half as many once it is open. The peak moves by 2.3e-4 with a point mass in its place,
    // what of the energy does not add up is 1.6e-4.
    Scene scene = read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                             {"payload.body.shape='box'", "payload.body.size=[0.6, 0.4, 0.9]",
                              "parachute.risers=4", "full.contact='none'"});
    scene.stop = test::c9_scene().stop;
    scene.stop.value = 3.0;
    Scene plain = scene;
    plain.full.line_substeps = 1;
    const RunRecord subcycled = test::run_full(scene), whole = test::run_full(plain);
    ASSERT_EQ(subcycled.status.code, StatusCode::completed) << subcycled.status.detail;
    EXPECT_LT(subcycled.cost.steps, 0.75 * static_cast<double>(whole.cost.steps));
    EXPECT_NEAR(*subcycled.metric("max_force_N"), *whole.metric("max_force_N"),
                1e-3 * *whole.metric("max_force_N"));
    EXPECT_NEAR(test::last(subcycled, "speed"), test::last(whole, "speed"),
                1e-4 * test::last(whole, "speed"));
    EXPECT_LT(std::abs(subcycled.energy->residual_fraction), 3e-4);
}

TEST(PayloadBody, TheLedgerClosesWhileItSwings) {
    // An oblique release swings it by some degrees from the axis that it starts along; the residual is that
    // of sound runs, 1e-5 to 1e-4.
    Scene scene = with_box(test::c9_scene(), 0.6, 0.4, 0.9);
    scene.release.path_angle = 0.9;
    scene.stop.value = 2.0;
    Simulation simulation(scene);
    double most = 1.0, moved = 0.0;
    while (simulation.system().time < 1.0) {
        simulation.evaluate_forces();
        simulation.step_to(1.0);
        const BodyState& body = *simulation.system().body;
        const double tilt =
            1.0 - 2.0 * (body.attitude[1] * body.attitude[1] + body.attitude[2] * body.attitude[2]);
        most = std::min(most, tilt);
        moved = std::max(moved, body.momentum.norm());
    }
    EXPECT_GT(moved, 0.1);
    EXPECT_LT(most, std::cos(0.5 * pi - 0.9) - 0.02);
    const RunRecord record = test::run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_LT(std::abs(record.energy->residual_fraction), 1e-4);
    EXPECT_NE(record.provenance.instruction_set.find("gore-batched"), std::string::npos);
}

TEST(PayloadBody, IsDrawnOutWithItsPack) {
    for (const DeployBy by : {DeployBy::static_line, DeployBy::free}) {
        Scene scene = with_box(test::packed_c9(by), 0.6, 0.6, 0.9);
        scene.full.mesh = {2, 5, 4, 2};
        if (by == DeployBy::free) scene.release = {2000.0, 60.0, 0.5 * pi, 0.5 * pi};
        scene.environment.ground = -1000.0;
        scene.stop = {Trigger::Kind::line_stretch, 0.0, 0.1};
        const RunRecord record = test::run_full(scene);
        EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
        EXPECT_TRUE(record.find_event("snatch"));
    }
}

TEST(PayloadBody, RisersHaveToReachOverIt) {
    Scene scene = with_box(test::c9_scene(), 2.0, 2.0, 0.5);
    try {
        unloaded_mesh(scene);
        start_mesh(scene, inflated(scene.parachutes.front()), Phase::open);
        ADD_FAILURE() << "accepted";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "payload.body.size");
    }
}

TEST(PayloadBody, IsReadWithAllItsLengths) {
    const std::string file = std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml";
    const auto refused = [&](const std::vector<std::string>& overrides, const char* key, const char* says) {
        try {
            read_scene(file, overrides);
            ADD_FAILURE() << "accepted, wanted: " << says;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.key(), key);
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    };
    refused({"payload.body.shape='box'", "payload.body.size=[0.6, 0.4]"}, "payload.body.size",
            "2 lengths for a box");
    refused({"payload.body.shape='cylinder'"}, "payload.body.size", "0 lengths for a cylinder");
    refused({"payload.body.shape='mesh'", "payload.body.size=[1]"}, "payload.body.size",
            "1 lengths for a mesh");
    refused({"payload.body.shape='mesh'"}, "payload.body.shape", "'mesh' without parachute.mesh");
    refused({"payload.body.shape='ball'"}, "payload.body.shape", "unknown word 'ball'");
    const std::vector<std::string> box{"payload.body.shape='box'", "payload.body.size=['60 cm', 0.4, 0.9]"};
    std::vector<std::string> sector = box;
    sector.emplace_back("full.symmetry='sector'");
    refused(sector, "full.symmetry", "payload.body turns as it likes");
    const Scene scene = read_scene(file, box);
    EXPECT_EQ(scene.payload.body->size, (std::vector<double>{0.6, 0.4, 0.9}));
    // The reduced-order model says that it is none of its affair.
    const RunRecord rom = test::run_rom(scene);
    EXPECT_TRUE(std::ranges::any_of(rom.left_out, [](const auto& left) {
        return left.what == "turning of the payload" && left.why.find("point mass") != std::string::npos;
    }));
}

TEST(PayloadBody, IsNoPartOfAPointMass) {
    // Nothing of it where the scene has none.
    Scene scene = test::c9_scene();
    scene.full.mesh = {1, 4, 2, 1};
    const Simulation bare(scene);
    EXPECT_FALSE(bare.system().body);
    EXPECT_TRUE(bare.mesh().attachments.empty());
    EXPECT_EQ(bare.synchronised_state().node.size(), static_cast<std::size_t>(bare.mesh().dummy()) + 1);
}

}  // namespace
}  // namespace twinchute::fullsim
