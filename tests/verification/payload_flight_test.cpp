// A payload that is a body, in whole runs: one that gives way beside the rigid one, drag by attitude.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fullsim/attitude.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/opening_tables.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::fullsim {
namespace {

Scene with_box(double a, double b, double c) {
    Scene scene = test::c9_scene();
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {a, b, c}};
    scene.full.mesh = {2, 5, 4, 2};
    scene.parachutes.front().risers = 4;
    return scene;
}

TEST(PayloadFlight, OfAStiffDeformableBodyIsThatOfARigidOne) {
    // An oblique opening, 1 GPa: strains of riser loads over edges of 0.3 m are 1e-5, what is left is what
    // half a second makes of that; the ledger closes as without a body.
    Scene scene = with_box(0.6, 0.4, 0.9);
    scene.release.path_angle = 0.9;
    scene.stop.value = 0.5;
    Scene soft = scene;
    soft.payload.body->elasticity = Elasticity{1e9, 0.3};
    const RunRecord rigid = test::run_full(scene), deformable = test::run_full(soft);
    ASSERT_EQ(deformable.status.code, StatusCode::completed) << deformable.status.detail;
    EXPECT_NEAR(test::last(deformable, "speed"), test::last(rigid, "speed"),
                1e-4 * test::last(rigid, "speed"));
    EXPECT_NEAR(*deformable.metric("max_force_N"), *rigid.metric("max_force_N"),
                5e-3 * *rigid.metric("max_force_N"));
    EXPECT_LT(std::abs(deformable.energy->residual_fraction), 1e-4);
}

TEST(PayloadFlight, OfABodyFollowsItsOwnCentreOfMass) {
    // The payload's node and the mean of the body's nodes move by the same forces: apart by rounding alone.
    Scene scene = with_box(0.6, 0.4, 0.9);
    scene.payload.body->elasticity = Elasticity{1e7, 0.3};
    scene.payload.drag_area = 0.5;
    scene.release.path_angle = 0.9;
    Simulation simulation(scene);
    const double before = simulation.ledger().elastic;
    for (int k = 0; k < 2000; ++k) {
        simulation.evaluate_forces();
        simulation.step_to(10.0);
    }
    const Mesh& mesh = simulation.mesh();
    const State& state = simulation.synchronised_state();
    const double mass = mesh.mass[static_cast<std::size_t>(mesh.payload())];
    const std::vector<double> masses = node_masses(mesh.body->solid, mass, mesh.body->lumped);
    Vec3 centre = Vec3::Zero(), velocity = Vec3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) {
        const NodeRecord& node = state.node[static_cast<std::size_t>(mesh.first_attachment()) + i];
        centre += masses[i] / mass * to_vec3(node.x);
        velocity += masses[i] / mass * to_vec3(node.v);
    }
    const NodeRecord& node = state.node[static_cast<std::size_t>(mesh.payload())];
    EXPECT_LT((centre - to_vec3(node.x)).norm(), 1e-9);
    EXPECT_LT((velocity - to_vec3(node.v)).norm(), 1e-9);
    EXPECT_NE(simulation.ledger().elastic, before);
    EXPECT_FALSE(simulation.find_fault());
}

TEST(PayloadFlight, IsDraggedByItsAttitude) {
    // The block alone, at a body turned by hand: 1/2 rho (C_D S) V^2 along the air, C_D S read at the angle.
    Scene scene = with_box(0.6, 0.4, 0.9);
    scene.payload.drag_area_table = AttitudeDrag("own.csv", {0.0, 0.5 * pi, pi}, {0.2, 1.0, 0.6});
    scene.payload.drag_area = 0.2;
    for (const bool deformable : {false, true}) {
        if (deformable) scene.payload.body->elasticity = Elasticity{1e8, 0.3};
        Simulation simulation(scene);
        simulation.evaluate_forces();
        const auto block = make_attitude_drag(simulation.mesh(), *scene.payload.drag_area_table);
        State state = simulation.synchronised_state();
        const auto payload = static_cast<std::size_t>(simulation.mesh().payload());
        const Vec3 v(3.0, -4.0, -12.0);
        state.node[payload].v = to_lanes(v);
        state.air.wind_at_payload = Vec3::Zero();
        state.air.density = 1.1;
        for (const double tilt : {0.0, 0.3, 0.5 * pi, 2.0, pi}) {
            // The axis is `tilt` away from where the air goes, -v; any body's x and y.
            const Vec3 across = v.unitOrthogonal();
            const Vec3 axis = std::cos(tilt) * -v.normalized() + std::sin(tilt) * across;
            const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis);
            state.body->attitude = attitude_of(turn);
            state.aero[payload].value = splat(0.0);
            block->add_forces(state);
            const double area =
                tilt <= 0.5 * pi ? 0.2 + 0.8 * tilt / (0.5 * pi) : 1.0 - 0.4 * (tilt - 0.5 * pi) / (0.5 * pi);
            const Vec3 exact = -0.5 * 1.1 * area * v.norm() * v;
            EXPECT_LT((to_vec3(state.aero[payload].value) - exact).norm(), 1e-7 * exact.norm()) << tilt;
        }
    }
}

TEST(PayloadFlight, OfOneDragAreaInAllAttitudesIsThatOfTheNumber) {
    // A table that is the same everywhere changes no bit of a run's answer but by the order of its products.
    Scene scene = with_box(0.6, 0.4, 0.9);
    scene.payload.drag_area = 0.5;
    scene.stop.value = 0.2;
    Scene table = scene;
    table.payload.drag_area_table = AttitudeDrag("own.csv", {0.0, 0.5 * pi}, {0.5, 0.5});
    const double number = test::last(test::run_full(scene), "speed");
    EXPECT_NEAR(test::last(test::run_full(table), "speed"), number, 1e-9 * number);
    table.payload.drag_area_table = AttitudeDrag("own.csv", {0.0, 0.5 * pi}, {0.9, 0.5});
    EXPECT_GT(std::abs(test::last(test::run_full(table), "speed") - number), 1e-4 * number);
}

TEST(PayloadFlight, OfAPointMassHangsStraight) {
    // Read from a scene: the reduced-order model takes angle 0.
    const ScratchDir directory;
    directory.write("crate.csv", "angle,drag_area\ndeg,m^2\n0,0.38\n45,0.55\n90,0.43\n");
    directory.write("scene.toml",
                    "base = \"c9-inflation.toml\"\n[payload]\ndrag_area_table = \"crate.csv\"\n");
    const Scene scene = read_scene(directory.path() / "scene.toml");
    EXPECT_EQ(scene.payload.drag_area, 0.38);
    Scene number = scene;
    number.payload.drag_area_table.reset();
    EXPECT_EQ(test::last(test::run_rom(scene), "speed"), test::last(test::run_rom(number), "speed"));
    // A value set later replaces the table; both in one file say the same thing twice.
    const Scene set = read_scene(directory.path() / "scene.toml", {"payload.drag_area=0.4"});
    EXPECT_EQ(set.payload.drag_area, 0.4);
    EXPECT_FALSE(set.payload.drag_area_table);
    directory.write(
        "both.toml",
        "base = \"c9-inflation.toml\"\n[payload]\ndrag_area_table = \"crate.csv\"\ndrag_area = 0.4\n");
    try {
        read_scene(directory.path() / "both.toml");
        ADD_FAILURE() << "accepted";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("both.toml:"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("stands beside"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace twinchute::fullsim
