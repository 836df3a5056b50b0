// The cross: cut, mesh and folded shape against closed forms, its symmetry, and what is refused.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fullsim/canopy/cross.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/cross_mesh.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::fullsim {
namespace {

/// cross-example at line stretch, with other values of some keys.
Scene cross_scene(const std::vector<std::string>& keys = {}) {
    return test::read_text(test::edited(test::good_scene, "usaf-c9", "cross-example"), keys);
}

Mesh built(const Scene& scene) {
    return built_mesh(scene);
}

TEST(CrossMesh, HasTheAreaAndTheMassOfItsStrips) {
    // S0 = 2 w L - w^2 = pi/4 D0^2, by hand: L = D0 sqrt(pi/4/(2 r - r^2)), w = r L. Two strips have a tape
    // of length L under each of their lines, the edge is 4 L long, four ties are D0/6. Sums of some thousand
    // terms: 1e-10.
    for (const double ratio : {0.264, 0.333, 0.6})
        for (const int lines : {8, 12, 28})
            for (const int columns : {2, 4}) {
                SCOPED_TRACE(std::to_string(ratio) + " " + std::to_string(lines));
                const Scene scene = cross_scene({"parachute.arm_ratio=" + std::to_string(ratio),
                                                 "parachute.gores=" + std::to_string(lines),
                                                 "full.mesh.gore_columns=" + std::to_string(columns)});
                const Parachute& chute = scene.parachutes.front();
                const Mesh mesh = built(scene);
                const double S0 = 0.25 * pi * 36.0,
                             L = 6.0 * std::sqrt(0.25 * pi / (2 * ratio - ratio * ratio));
                const CrossOutline outline = cross_outline(chute);
                EXPECT_NEAR(outline.length, L, 1e-12);
                EXPECT_NEAR(outline.area(), S0, 1e-12 * S0);
                EXPECT_NEAR(2 * outline.width * L - outline.width * outline.width, S0, 1e-12 * S0);
                EXPECT_NEAR(mesh.fabric_area(), S0, 1e-10 * S0);
                const double cord = chute.line.density * 0.25 * pi * std::pow(chute.line.diameter, 2);
                const double expected = chute.fabric.density * chute.fabric.thickness * S0 +
                                        cord * (0.5 * lines * L + 4.0 * L + 4.0 * 1.0 + lines * (6.0 + 1.0));
                EXPECT_NEAR(mesh.parachute_mass(), expected, 1e-10 * expected);
                double lumped = 0.0;
                for (const double m : mesh.mass)
                    lumped += m;
                EXPECT_NEAR(lumped - scene.payload.mass, expected, 1e-10 * expected);
            }
}

TEST(CrossMesh, TurnsOntoItselfByAQuarter) {
    const Mesh mesh = built(cross_scene());
    using Place = std::array<double, 2>;
    const auto place = [&](NodeIndex i) {
        const Vec3& x = mesh.position[static_cast<std::size_t>(i)];
        return Place{x.x() + 0.0, x.y() + 0.0};  // no -0
    };
    std::map<Place, NodeIndex> at;
    for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
        EXPECT_TRUE(at.emplace(place(i), i).second) << "two nodes at one place, " << i;
    // Exactly: places of all arms are the same numbers.
    const auto turned = [&](NodeIndex i) { return at.at({-place(i)[1] + 0.0, place(i)[0]}); };
    const auto mirrored = [&](NodeIndex i) { return at.at({-place(i)[0] + 0.0, place(i)[1]}); };
    std::set<std::set<NodeIndex>> triangles;
    for (const Triangle& t : mesh.triangles) {
        triangles.insert({t.node.begin(), t.node.end()});
        EXPECT_GT(t.c, 0.0);  // counter-clockwise, seen from outside
    }
    ASSERT_EQ(triangles.size(), mesh.triangles.size());
    std::multiset<std::set<NodeIndex>> cables;
    for (const Cable& c : mesh.cables)
        if (is_tape(c.kind)) cables.insert({c.node[0], c.node[1]});
    for (const Triangle& t : mesh.triangles) {
        const auto& [a, b, c] = t.node;
        EXPECT_TRUE(triangles.contains({turned(a), turned(b), turned(c)}));
        EXPECT_TRUE(triangles.contains({mirrored(a), mirrored(b), mirrored(c)}));
    }
    for (const std::set<NodeIndex>& c : std::set(cables.begin(), cables.end())) {
        const NodeIndex a = *c.begin(), b = *c.rbegin();
        EXPECT_EQ(cables.count({turned(a), turned(b)}), cables.count({a, b}));
        EXPECT_EQ(cables.count({mirrored(a), mirrored(b)}), cables.count({a, b}));
    }
    // The lines' feet stand in the order of their azimuths, as many on each arm.
    const std::vector<NodeIndex>& feet = mesh.seam_rings.back();
    ASSERT_EQ(feet.size(), 24u);
    for (std::size_t k = 0; k < feet.size(); ++k)
        EXPECT_EQ(turned(feet[k]), feet[(k + 6) % 24]);
    EXPECT_EQ(mesh.seam_rings.front().size(), 1u);
    EXPECT_EQ(place(mesh.seam_rings.front().front()), (Place{0.0, 0.0}));
}

/// Largest stretch of the fabric in any direction, from the flat triangle to where its nodes are.
double largest_stretch(const Mesh& mesh) {
    double largest = 0.0;
    for (const Triangle& t : mesh.triangles) {
        const auto x = [&](int k) { return mesh.position[static_cast<std::size_t>(t.node[k])]; };
        Eigen::Matrix2d cut;
        cut << t.a, t.b, 0.0, t.c;
        Eigen::Matrix<double, 3, 2> now;
        now << x(1) - x(0), x(2) - x(0);
        const Eigen::Matrix<double, 3, 2> gradient = now * cut.inverse();
        largest = std::max(largest, gradient.jacobiSvd().singularValues()[0]);
    }
    return largest;
}

TEST(CrossMesh, IsDrawnOutWithoutStrain) {
    // A narrow mouth, and two for which ties are taut.
    for (const char* share : {"0.04", "0.3", "0.8"}) {
        const Scene scene = cross_scene({std::string("parachute.initial_drag_area_ratio=") + share});
        SCOPED_TRACE(share);
        const Parachute& chute = scene.parachutes.front();
        const Mesh mesh = unloaded_mesh(scene);
        EXPECT_NEAR(largest_stretch(mesh), 1.0, 1e-12);  // along the arms it is as long as it was cut
        for (const Cable& c : mesh.cables) {
            const double length = (mesh.position[static_cast<std::size_t>(c.node[1])] -
                                   mesh.position[static_cast<std::size_t>(c.node[0])])
                                      .norm();
            EXPECT_LT(length, c.rest_length * (1.0 + 1e-9)) << cable_kind_name(c.kind);
        }
        // Released straight down, the axis is up: the polygon of the feet is the mouth.
        ASSERT_NEAR(mesh.axis.z(), 1.0, 1e-12);
        double twice = 0.0;
        const auto& feet = mesh.seam_rings.back();
        for (std::size_t k = 0; k < feet.size(); ++k) {
            const Vec3 &p = mesh.position[static_cast<std::size_t>(feet[k])],
                       &q = mesh.position[static_cast<std::size_t>(feet[(k + 1) % feet.size()])];
            twice += p.x() * q.y() - p.y() * q.x();
        }
        const double mouth = mouth_area_at_line_stretch(chute);
        EXPECT_NEAR(0.5 * twice, mouth, 1e-10 * mouth);
    }
}

TEST(CrossMesh, IsFoldedAsAPyramidThatTiesCutOff) {
    const CrossOutline loose{1.0, 3.0, 4, 10.0};
    EXPECT_DOUBLE_EQ(loose.mouth(), 7.0);  // a square of 3 m less four corners of 1/2 m^2 each
    const std::vector<Vec3> flat{{1.5, 0.5, 9.0}, {0.0, -1.5, 9.0}};
    const auto open = folded_cross(loose, flat, 100.0);
    EXPECT_EQ(open[0], Vec3(1.5, 0.5, 0.0));
    EXPECT_EQ(open[1], Vec3(0.0, -1.5, 0.0));
    // A quarter of the mouth: half as wide, cos 30 deg as deep as it is long.
    const auto half = folded_cross(loose, flat, 1.75);
    EXPECT_NEAR((half[0] - Vec3(0.75, 0.25, 1.5 * std::sqrt(0.75))).norm(), 0.0, 1e-15);
    // Ties of sqrt(2)/2 m let arms of 1 m lead outward by 1/2, 60 deg down; the octagon of sides 1 and
    // sqrt(2)/2 has 4 h^2 + 8 h c + 2 c^2 = 1 + 2 + 1/2 m^2 of mouth, and leaves the square flat.
    const CrossOutline tied{1.0, 3.0, 4, std::sqrt(0.5)};
    const auto box = folded_cross(tied, flat, 3.5);
    EXPECT_NEAR((box[0] - Vec3(1.0, 0.5, std::sqrt(0.75))).norm(), 0.0, 1e-15);
    EXPECT_NEAR((box[1] - Vec3(0.0, -1.0, std::sqrt(0.75))).norm(), 0.0, 1e-15);
}

TEST(CrossMesh, ScalesWithItsDiameter) {
    // A cross of twice the diameter has four times the area, twice the length and the same ratio.
    const CrossOutline small = cross_outline(cross_scene().parachutes.front());
    const CrossOutline large =
        cross_outline(cross_scene({"parachute.nominal_diameter='12 m'"}).parachutes.front());
    EXPECT_NEAR(large.area(), 4.0 * small.area(), 1e-12 * large.area());
    EXPECT_NEAR(large.width / large.length, 0.3, 1e-15);
}

TEST(CrossMesh, TiesJoinTheCornersOfNeighbours) {
    for (const double given : {0.0, 0.4}) {
        Scene scene = cross_scene();
        scene.parachutes.front().corner_tie = given;
        const Mesh mesh = built(scene);
        const std::vector<NodeIndex>& feet = mesh.seam_rings.back();
        int found = 0;
        for (const Cable& c : mesh.cables)
            for (std::size_t arm = 0; arm < 4; ++arm)
                if (c.node[0] == feet[6 * arm + 5] && c.node[1] == feet[(6 * arm + 6) % 24]) {
                    ++found;
                    EXPECT_EQ(c.kind, CableKind::skirt);
                    EXPECT_EQ(c.rest_length, given > 0.0 ? given : 1.0);  // D0/6
                }
        EXPECT_EQ(found, 4);
    }
}

TEST(CrossMesh, PanelsAreTheMiddleAndTheArms) {
    // Twice the thickness in the middle, where strips that are sewn onto each other lie double: w^2 more of
    // fabric mass, by hand.
    Scene scene = cross_scene();
    Parachute& chute = scene.parachutes.front();
    const double once = built(scene).parachute_mass();
    chute.panel.resize(2);
    EXPECT_EQ(built(scene).sheets(), 1);
    chute.panel[0].fabric = chute.fabric;
    chute.panel[0].fabric.thickness *= 2.0;
    chute.panel[0].fabric.name = "double";
    const Mesh mesh = built(scene);
    const CrossOutline outline = cross_outline(chute);
    ASSERT_EQ(mesh.sheets(), 2);
    const double added = chute.fabric.density * chute.fabric.thickness * outline.width * outline.width;
    EXPECT_NEAR(mesh.parachute_mass() - once, added, 1e-10 * once);
    EXPECT_NEAR(
        mesh.fabric_mass(),
        chute.fabric.density * chute.fabric.thickness * (outline.area() + outline.width * outline.width),
        1e-10);
}

TEST(CrossMesh, WhatItCannotDoIsRefusedByKey) {
    using Keys = std::vector<std::string>;
    const auto refused = [](const Keys& keys) {
        const Scene scene = cross_scene(keys);
        const Keys unsupported = full_fidelity().unsupported_keys(scene);
        return unsupported.empty() ? std::string() : unsupported_text(scene, unsupported);
    };
    EXPECT_EQ(refused({}), "");
    const auto expect = [&](const Keys& keys, const std::string& text) {
        EXPECT_NE(refused(keys).find(text), std::string::npos) << refused(keys);
    };
    expect({"parachute.vent_diameter='0.6 m'"}, "'parachute.vent_diameter' (a cross has no vent)");
    expect({"parachute.gores=18", "parachute.risers=2"}, "'parachute.gores' (each of the four arms");
    expect({"parachute.gores=4"}, "'parachute.gores' (each of the four arms");
    expect({"full.mesh.gore_columns=1"}, "'full.mesh.gore_columns' (elements between two lines");
    expect({"parachute.reefing=[{drag_area_ratio=0.2, until={at='line-stretch', delay=1}}]"},
           "'parachute.reefing' (a reefing line slides");
    expect({"full.contact='gores'"}, "full.contact' (a cross has no gores)");
    expect({"full.symmetry='sector'"}, "full.symmetry' (a cross has no gores)");
    Scene predicted = cross_scene();
    predicted.parachutes.front().filling.model = find_filling("predicted");
    EXPECT_EQ(full_fidelity().unsupported_keys(predicted), Keys{"parachute.filling"});
    // Seven lines on each arm have three elements between them, an even number across: that is a mesh.
    EXPECT_EQ(refused({"parachute.gores=28", "full.mesh.gore_columns=1"}), "");
    // Arms and panels of what has none.
    const auto complaint = [](const std::vector<std::string>& keys) {
        return test::complaint(test::good_scene, keys);
    };
    EXPECT_NE(complaint({"parachute.arm_ratio=0.3"}).find("arm_ratio: there are no arms"), std::string::npos)
        << complaint({"parachute.arm_ratio=0.3"});
    EXPECT_NE(complaint({"parachute.corner_tie=1"}).find("corner_tie: there are no arms"), std::string::npos)
        << complaint({"parachute.corner_tie=1"});
    EXPECT_NE(complaint({"parachute.panel=[{}]"}).find("panel: 1 for 0 panels"), std::string::npos)
        << complaint({"parachute.panel=[{}]"});
}

}  // namespace
}  // namespace twinchute::fullsim
