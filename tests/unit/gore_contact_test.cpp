// Contact between gores: what a pair holds against its geometry, and nothing where gores keep their order.
// That forces are the derivative of the energy, without net force or moment, is in
// force_blocks_contract_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/difference.hpp"
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
    // angle a: the axis stays where it is. 14 pairs, both nodes on one circle of radius r, have
    // b = r^2 sin(a), |w| = r cos(a/2) and p = 2 r sin(a/2), hence
    // E = K/2 r^2 sin(a)^2/(cos(a/2)^2 + 4 sin(a/2)^2), whatever there is along the axis.
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
    const double radius = std::hypot(skirt.x(), skirt.y()), stiffness = gore_contacts(mesh).front().stiffness;
    const auto energy = [&](double a) {
        const double c = std::cos(0.5 * a), s = std::sin(0.5 * a), sine = std::sin(a);
        return 0.5 * stiffness * radius * radius * sine * sine / (c * c + 4.0 * s * s);
    };
    // Places of some metres are rounded to 1e-15 m, what is behind is 1e-2 m.
    EXPECT_NEAR(block->energy(state), 14.0 * energy(angle), 1e-10 * energy(angle));
    block->add_forces(state);
    // Apart, around the axis: r times the tangential force is what the angle does to the energy.
    const NodeIndex on = mesh.seam_rings.back()[1];
    const Vec3 tangent = mesh.axis.cross(skirt).normalized();
    const double moment = test::central_difference(energy, angle, 1e-5);
    EXPECT_NEAR(radius * to_vec3(state.force[on].value).dot(tangent), moment, 1e-6 * moment);
    EXPECT_NEAR(to_vec3(state.force[on].value).dot(mesh.axis), 0.0, 1e-10 * moment / radius);
}

/// Closed at the mouth, with its nodes within a micrometre of the axis; off that axis by three metres, so
/// that all gores are on one side of it; folded over it; and shaken.
std::vector<State> states_out_of_order(const Mesh& mesh) {
    std::vector<State> states;
    for (const int kind : {0, 1, 2, 3}) {
        State state = test::state_of(mesh);
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i) {
            auto& x = state.node[i].x;
            const bool at_mouth = std::ranges::count(mesh.seam_rings.back(), i) > 0;
            if (kind == 0 && at_mouth) x[0] *= 1e-6, x[1] *= 1e-6;
            if (kind == 1) x[0] += 3.0 - 0.2 * x[2];
            if (kind == 2) x[0] = 0.5 * std::abs(x[0]) - 0.05 * x[0];
        }
        test::shake(state, kind == 0 ? 1e-7 : 0.2, 7u + static_cast<unsigned>(kind));
        states.push_back(state);
    }
    return states;
}

TEST(GoreContact, ForcesAreTheDerivativeOfOneEnergyWhereGoresHaveLostTheirOrder) {
    const Mesh mesh = test::coarse_c9(4, 3);
    const auto block = make_gore_contact(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    int kind = 0;
    for (State& state : states_out_of_order(mesh)) {
        test::clear_forces(state);
        block->add_forces(state);
        Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
        double largest = 0.0;
        for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
            const Vec3 f = to_vec3(state.force[i].value);
            force += f;
            moment += to_vec3(state.node[i].x).cross(f);
            largest = std::max(largest, f.norm());
        }
        ASSERT_GT(largest, 0.0) << kind;
        EXPECT_LT(force.norm(), 1e-10 * largest * mesh.node_count()) << kind;
        EXPECT_LT(moment.norm(), 1e-9 * largest * mesh.node_count()) << kind;
        for (int k = 0; k < 20; ++k) {
            std::vector<Vec3> along(mesh.node_count());
            double power = 0.0;
            for (NodeIndex i = 0; i < mesh.node_count(); ++i) {
                along[i] = Vec3(part(random), part(random), part(random));
                power += along[i].dot(to_vec3(state.force[i].value));
            }
            const auto energy = [&](double h) {
                State moved = state;
                for (NodeIndex i = 0; i < mesh.node_count(); ++i)
                    moved.node[i].x += to_lanes(h * along[i]);
                return block->energy(moved);
            };
            // Where pairs begin to meet within h the second derivative jumps by K: an error of K h a pair.
            const double h = kind == 0 ? 1e-9 : 1e-7;
            const double pairs = static_cast<double>(gore_contacts(mesh).size());
            EXPECT_NEAR(test::central_difference(energy, 0.0, h), -power,
                        1e-6 * std::abs(power) + 4.0 * gore_contacts(mesh).front().stiffness * h * pairs +
                            1e-15 * block->energy(state) / h)
                << kind;
        }
        ++kind;
    }
}

TEST(GoreContact, IsNoPullOfTheRisers) {
    // Its reaction on the payload, which an axis in the wrong place makes large, is none of the opening
    // force.
    const Mesh mesh = test::coarse_c9(2, 5);
    const auto block = make_gore_contact(mesh);
    for (State& state : states_out_of_order(mesh)) {
        block->add_forces(state);
        note_riser_force(state, mesh.payload());
        EXPECT_EQ(state.riser_force, Vec3::Zero());
        EXPECT_GT(to_vec3(state.force[mesh.payload()].value).norm(), 0.0);
    }
}

TEST(GoreContact, BringsNoEnergyAroundAClosedPath) {
    // A seam's node of the skirt goes around the whole axis and back through it: the work of its force, with
    // what the others are moved by (nothing), is nothing. The path is long in steps of a few millimetres.
    const Mesh mesh = test::coarse_c9(1, 3);
    const auto block = make_gore_contact(mesh);
    State state = test::state_of(mesh);
    const NodeIndex on = mesh.seam_rings.back()[3];
    const Vec3 start = mesh.position[on];
    const double radius = std::hypot(start.x(), start.y());
    constexpr int steps = 4000;
    const auto at = [&](int k) -> Vec3 {
        const double t = 2.0 * pi * k / steps;  // around the axis, passing through it twice
        const double r = radius * std::cos(2.0 * t);
        return {r * std::cos(t), r * std::sin(t), start.z()};
    };
    double work = 0.0, most = 0.0, jump = 0.0;
    Vec3 before = Vec3::Zero();
    for (int k = 0; k <= steps; ++k) {
        state.node[on].x = to_lanes(at(k));
        test::clear_forces(state);
        block->add_forces(state);
        const Vec3 force = to_vec3(state.force[on].value);
        if (k > 0) {
            work += 0.5 * (force + before).dot(at(k) - at(k - 1));
            jump = std::max(jump, (force - before).norm() / (at(k) - at(k - 1)).norm());
        }
        before = force;
        most = std::max(most, block->energy(state));
    }
    const double stiffness = gore_contacts(mesh).front().stiffness;
    EXPECT_GT(most, 0.01 * stiffness * radius * radius);  // it has been in contact
    EXPECT_LT(std::abs(work), 1e-4 * most);
    // Force follows place: two pairs, and the axis that the node shifts.
    EXPECT_LT(jump, 6.0 * stiffness);
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

}  // namespace
}  // namespace twinchute::fullsim
