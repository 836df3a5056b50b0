// Contact between gores: what a pair holds against its geometry, and nothing where gores keep their order.
// That forces are the derivative of the energy, without net force or moment, is in
// force_blocks_contract_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

TEST(GoreContact, PairsAreTheSameInEachGore) {
    const int columns = 4, rows = 3;
    const Mesh mesh = test::coarse_c9(columns, rows);
    const auto pairs = gore_contacts(mesh);
    // A graded gore has one column at the vent: its seams. In each of the other rows its seams, and three
    // nodes with either.
    const std::size_t of_gore = 1 + rows * (1 + 2 * (columns - 1));
    ASSERT_EQ(pairs.size(), 28 * of_gore);
    // E t shared by the pairs of a row that end at a seam on one side, a quarter of it in all.
    const double modulus = mesh.fabric.youngs_modulus * mesh.fabric.thickness;
    EXPECT_DOUBLE_EQ(pairs.front().stiffness, 0.25 * modulus);
    EXPECT_DOUBLE_EQ(pairs.back().stiffness, 0.25 * modulus / columns);
    for (std::size_t k = 0; k < pairs.size(); ++k)
        EXPECT_EQ(pairs[k].stiffness, pairs[k % of_gore].stiffness);
}

TEST(GoreContact, HoldsNothingWhileGoresKeepTheirOrder) {
    // As the canopy starts, pleated or not; and opened wide.
    for (const int columns : {1, 2, 3, 4})
        for (const double wider : {1.0, 6.0}) {
            const Mesh mesh = test::coarse_c9(columns, 3);
            const auto block = make_gore_contact(mesh);
            State state = test::state_of(mesh);
            for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
                for (int c = 0; c < 2; ++c)
                    state.node[i].x[c] *= wider;
            block->add_forces(state);
            EXPECT_EQ(block->energy(state), 0.0) << columns << " columns";
            for (NodeIndex i = 0; i < mesh.node_count(); ++i)
                EXPECT_EQ(to_vec3(state.force[i].value).norm(), 0.0);
        }
}

TEST(GoreContact, EveryOtherSeamPastTheNextOne) {
    // Gores of one column: seams alone. On the skirt every other one is turned by past its neighbour by an
    // angle: the axis stays where it is, and 14 pairs have a distance of -2 r sin(angle/2) around it. It does
    // not depend on anything along the axis.
    const Mesh mesh = test::coarse_c9(1, 3);
    const auto block = make_gore_contact(mesh);
    State state = test::state_of(mesh);
    const double gap = 2.0 * pi / 28.0, angle = 0.03;
    for (int gore = 0; gore < 28; gore += 2) {
        const NodeIndex i = mesh.seam_rings.back()[gore];
        const Vec3 x = Eigen::AngleAxisd(gap + angle, mesh.axis) * mesh.position[i];
        state.node[i].x = to_lanes(x + 0.1 * mesh.axis);
    }
    const Vec3& skirt = mesh.position[mesh.seam_rings.back()[1]];
    const double radius = std::hypot(skirt.x(), skirt.y()), behind = 2.0 * radius * std::sin(0.5 * angle);
    const double stiffness = gore_contacts(mesh).front().stiffness;
    // Places of some metres are rounded to 1e-15 m, behind is 1e-2 m.
    EXPECT_NEAR(block->energy(state), 14.0 * 0.5 * stiffness * behind * behind,
                1e-11 * stiffness * behind * behind);
    block->add_forces(state);
    // Apart, around the axis: K s cos(angle/2) each, since a node's own tangent is half the angle off.
    const NodeIndex on = mesh.seam_rings.back()[1];
    const Vec3 tangent = mesh.axis.cross(skirt).normalized();
    EXPECT_NEAR(to_vec3(state.force[on].value).dot(tangent), stiffness * behind * std::cos(0.5 * angle),
                1e-10 * stiffness * behind);
    EXPECT_NEAR(to_vec3(state.force[on].value).dot(mesh.axis), 0.0, 1e-10 * stiffness * behind);
}

TEST(GoreContact, IsRefusedWhereGoresHaveNoOrder) {
    // On a mesh of which rows are not known, and from a pack.
    for (const auto& [file, says] : {std::pair{"c9-window.toml", "\"gores\" with parachute.mesh"},
                                     std::pair{"paper/crane-drop.toml", "\"gores\" of a packed canopy"}}) {
        const std::string scene = std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + file;
        EXPECT_NO_THROW(read_scene(scene, {"full.contact='none'"}));
        try {
            read_scene(scene, {"full.contact='gores'"});
            FAIL() << "not refused";
        } catch (const SceneError& error) {
            EXPECT_EQ(error.key(), "full.contact");
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    }
}

TEST(GoreContact, NodesOnOppositeSidesOfTheAxisDoNotMeet) {
    // One seam pulled across the axis, to the far side: its neighbours are not behind it but beyond.
    const Mesh mesh = test::coarse_c9(1, 3);
    const auto block = make_gore_contact(mesh);
    State state = test::state_of(mesh);
    for (const int gore : {0, 14}) {  // both, so that the axis stays
        const NodeIndex i = mesh.seam_rings.back()[gore];
        state.node[i].x[0] *= -1.0;
        state.node[i].x[1] *= -1.0;
    }
    EXPECT_EQ(block->energy(state), 0.0);
}

}  // namespace
}  // namespace twinchute::fullsim
