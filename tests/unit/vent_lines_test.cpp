// Annular canopies and vent lines: constructed areas and masses against closed forms, the canopy that is
// drawn out against its vent lines, layouts, and what is refused.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/simulation.hpp"
#include "lib/models/meridian.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/largest_strain.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double nominal = 0.25 * pi * 8.53 * 8.53;  // [m^2] of the C-9
constexpr double cord = 462.0 * 0.25 * pi * 16e-6;   // [kg/m] of its lines and tapes: 4 mm of 462 kg/m^3

/// In the C-9's size and of its materials, with the proportions of data/parachutes/annular-example.toml.
Parachute annular(int gores = 28) {
    Parachute chute = test::canopy_of_type("annular", gores);
    chute.risers = 1;
    chute.vent_diameter = 0.611 * 8.53;
    chute.line_length = 1.25 * 8.53;
    chute.projected_diameter_ratio = 0.94;
    chute.vent_lines.emplace();
    chute.vent_lines->length = 0.319 * 8.53;
    chute.vent_lines->joint = 0.2 * 8.53;
    return chute;
}

/// A gore of one cone around an open middle by hand: half as wide as radius times sin(delta), with S0 over n
/// as its area.
struct Frustum {
    double vent, skirt, seam;  // radii, and vent to skirt along the seam [m]

    Frustum(const Parachute& chute, double slope) {
        const double delta = pi / chute.gores;
        const double along = std::hypot(std::cos(delta) * std::cos(slope), std::sin(slope)) / std::cos(slope);
        vent = 0.611 * 8.53 * std::sqrt(0.5 * pi / (chute.gores * std::sin(2.0 * delta)));
        skirt = std::sqrt(vent * vent + nominal / (chute.gores * std::sin(delta) * along));
        seam = (skirt - vent) / std::cos(slope);
    }
};

const double slope = 45.1 * pi / 180.0;

std::vector<Cable> vent_lines_of(const Mesh& mesh) {
    std::vector<Cable> lines;
    std::ranges::copy_if(mesh.cables, std::back_inserter(lines),
                         [](const Cable& c) { return c.kind == CableKind::vent_line; });
    return lines;
}

TEST(AnnularCanopy, FabricHasTheNominalAreaWithoutTheMiddle) {
    for (const int gores : {6, 28})
        for (const MeshCounts& counts :
             {MeshCounts{1, 3, 2, 1}, MeshCounts{2, 9, 2, 1}, MeshCounts{4, 17, 2, 1, Grading::uniform}}) {
            const Parachute chute = annular(gores);
            EXPECT_NEAR(make_constructed_mesh(chute, counts, 152.4).fabric_area(), nominal, 1e-10) << gores;
            const GoreOutline outline = canopy_geometry(chute).outline(chute);
            const Frustum by_hand(chute, slope);
            EXPECT_NEAR(outline.seam_point(outline.vent).radius, by_hand.vent, 1e-12);
            EXPECT_NEAR(outline.seam_point(outline.skirt).radius, by_hand.skirt, 1e-12);
        }
}

TEST(AnnularCanopy, ItsSkirtIsThatOfTheHandbooksDrawing) {
    // 1.04 D0 across; a gore 0.304 D0 long, as wide as round arcs, makes 1.004 S0 of that.
    const Frustum by_hand(annular(), slope);
    EXPECT_NEAR(2.0 * by_hand.skirt / 8.53, 1.04, 0.005);
    EXPECT_NEAR(by_hand.seam / 8.53, 0.304, 0.003);
}

TEST(AnnularCanopy, WeighsWhatItsMaterialsWeigh) {
    const Parachute chute = annular();
    const Frustum by_hand(chute, slope);
    const double chords = 2.0 * std::sin(pi / 28.0) * (by_hand.vent + by_hand.skirt);
    // Risers of 1.22 m as strong as 28 lines.
    const double length = 28.0 * (by_hand.seam + chords + 1.25 * 8.53 + 0.319 * 8.53 + 1.22);
    EXPECT_NEAR(make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4).parachute_mass(),
                533.0 * 1e-4 * nominal + cord * length, 1e-10);
}

TEST(AnnularCanopy, PanelsOfOneSlopeAreOnePanel) {
    const GorePanel one[] = {{1.0, 0.6, 0.6}}, two[] = {{1.0, 0.6, 0.6}, {2.0, 0.6, 0.6}};
    const Meridian a = open_meridian(one, 12, 30.0, 1.7), b = open_meridian(two, 12, 30.0, 1.7);
    EXPECT_NEAR(a.length(), b.length(), 1e-12);
    // The first third of the seam from the middle's edge.
    const double edge = 1.7 / std::cos(0.6);
    EXPECT_NEAR(b.edges().front(), edge + (a.length() - edge) / 3.0, 1e-12);
}

TEST(VentLines, HangTheVentOfACanopyThatIsDrawnOut) {
    for (const int columns : {1, 2, 4}) {
        const Parachute chute = annular();
        const double mouth = mouth_area_at_line_stretch(chute);
        const Mesh mesh = make_gore_mesh(chute, {columns, 9, 25, 2}, 152.4, Vec3::UnitZ(), mouth, 0.0);
        EXPECT_LT(largest_strain(mesh), 1e-12) << columns;
        // Straight from the vent's seams to the joints, and just taut.
        const std::vector<Cable> lines = vent_lines_of(mesh);
        ASSERT_EQ(lines.size() % 28, 0u);
        double length = 0.0;
        for (const Cable& c : lines) {
            EXPECT_NEAR((mesh.position[c.node[0]] - mesh.position[c.node[1]]).norm(), c.rest_length, 1e-12);
            length += c.rest_length;
        }
        EXPECT_NEAR(length, 28.0 * 0.319 * 8.53, 1e-10);
        // Suspension lines are straight through the joints, as long as they are.
        double suspension = 0.0;
        for (const Cable& c : mesh.cables)
            if (c.kind == CableKind::line) {
                EXPECT_NEAR((mesh.position[c.node[0]] - mesh.position[c.node[1]]).norm(), c.rest_length,
                            1e-12);
                suspension += c.rest_length;
            }
        EXPECT_NEAR(suspension, 28.0 * 1.25 * 8.53, 1e-10);
        // The vent hangs a - b above the skirt, lines of a being tied b below it, but for the tilt of the
        // lines.
        const double above = mesh.position[mesh.seam_rings.front().front()].z() -
                             mesh.position[mesh.seam_rings.back().front()].z();
        EXPECT_NEAR(above / ((0.319 - 0.2) * 8.53), 1.0, 0.02);
    }
}

TEST(VentLines, ThatAreLongEnoughLeaveTheCanopyAsItIs) {
    Parachute chute = annular();
    const double mouth = mouth_area_at_line_stretch(chute);
    const auto drawn_out = [&] {
        return make_gore_mesh(chute, {2, 9, 25, 2}, 152.4, Vec3::UnitZ(), mouth, 900.0);
    };
    chute.vent_lines->length = 0.2 * 8.53 + Frustum(chute, slope).seam + 0.5;
    const Mesh with = drawn_out();
    chute.vent_lines.reset();
    const Mesh without = drawn_out();
    ASSERT_EQ(with.canopy_nodes, without.canopy_nodes);
    for (NodeIndex i = 0; i < with.canopy_nodes; ++i)
        EXPECT_EQ(with.position[i], without.position[i]);
    EXPECT_GT(with.parachute_mass(), without.parachute_mass());
}

TEST(VentLines, APullDownRatioIsALength) {
    Parachute chute = annular();
    const Frustum by_hand(chute, slope);
    for (const double ratio : {0.0, 0.608, 1.0}) {
        chute.vent_lines = VentLines{VentLines::Model::pull_down, {}, ratio, 1.7, {}};
        EXPECT_NEAR(vent_line_length(chute, 1.0, 1.0 + by_hand.seam), 1.7 + (1.0 - ratio) * by_hand.seam,
                    1e-12);
        chute.vent_lines->joint.reset();  // at the links
        EXPECT_NEAR(vent_line_length(chute, 1.0, 1.0 + by_hand.seam),
                    1.25 * 8.53 + (1.0 - ratio) * by_hand.seam, 1e-12);
    }
}

TEST(VentLines, AtTheLinksMakeRisersAsStrongAsAllLines) {
    Parachute chute = annular();
    chute.vent_lines = VentLines{VentLines::Model::pull_down, {}, 0.6, {}, {}};
    const Mesh mesh = make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4);
    for (const Cable& c : mesh.cables)
        if (c.kind == CableKind::riser) {
            EXPECT_EQ(c.strands, 56.0);
        }
    std::map<NodeIndex, int> ends;
    int most = 0;
    for (const Cable& c : vent_lines_of(mesh))
        most = std::max(most, ++ends[c.node[1]]);
    EXPECT_EQ(most, 28);  // at the one link
}

TEST(VentLines, AcrossTheVentTieOppositeSeams) {
    for (const char* type : {"flat-circular", "conical"}) {
        Parachute chute = test::canopy_of_type(type);
        const double without = make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4).parachute_mass();
        chute.vent_lines = VentLines{VentLines::Model::across, {}, {}, {}, {}};
        const Mesh mesh = make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4);
        const std::vector<Cable> lines = vent_lines_of(mesh);
        ASSERT_EQ(lines.size(), 14u) << type;
        const double across = 2.0 * polygon_radius(0.853, 28);
        for (const Cable& c : lines) {
            EXPECT_DOUBLE_EQ(c.rest_length, across) << type;
            // Through the axis, as far as the constructed vent is wide.
            const Vec3 middle = 0.5 * (mesh.position[c.node[0]] + mesh.position[c.node[1]]);
            EXPECT_LT(middle.head<2>().norm(), 1e-12) << type;
            EXPECT_NEAR((mesh.position[c.node[0]] - mesh.position[c.node[1]]).norm(), across, 1e-12) << type;
        }
        EXPECT_NEAR(mesh.parachute_mass() - without, 14.0 * across * cord, 1e-12) << type;
    }
}

TEST(VentLines, MayHaveACordOfTheirOwn) {
    Parachute chute = annular();
    const double with_line_cord = make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4).parachute_mass();
    chute.vent_lines->cord = chute.line;
    chute.vent_lines->cord.name = "twice as heavy";
    chute.vent_lines->cord.density *= 2.0;
    EXPECT_NEAR(make_constructed_mesh(chute, {2, 9, 25, 2}, 152.4).parachute_mass() - with_line_cord,
                28.0 * 0.319 * 8.53 * cord, 1e-10);
}

TEST(VentLines, TakeTheUnstructuredLayout) {
    const Parachute chute = annular();
    std::string why;
    EXPECT_FALSE(find_gores(
        make_gore_mesh(chute, {2, 9, 25, 2}, 152.4, Vec3::UnitZ(), mouth_area_at_line_stretch(chute), 0.0),
        &why));
    EXPECT_EQ(why, "vent lines tie seams to lines or to each other");
    Parachute bare = chute;
    bare.vent_lines.reset();
    EXPECT_TRUE(find_gores(
        make_gore_mesh(bare, {2, 9, 25, 2}, 152.4, Vec3::UnitZ(), mouth_area_at_line_stretch(bare), 0.0)));
}

Scene annular_scene(DeployBy by) {
    Scene scene = by == DeployBy::static_line ? test::packed_c9(by) : test::c9_scene();
    const Deployment deploy = scene.parachutes.front().deploy;
    Parachute chute = annular();
    chute.deploy = deploy;
    chute.deploy.by = by;
    scene.parachutes.front() = chute;
    scene.full.mesh = {2, 5, 8, 1};
    return scene;
}

TEST(VentLines, LayoutsAgreeFromEachStart) {
    // As the reference to rounding, which grows over 200 steps of taut and slack lines.
    for (const DeployBy by : {DeployBy::line_stretch, DeployBy::inflated, DeployBy::static_line})
        for (const int substeps : {1, 4}) {
            Scene scene = annular_scene(by);
            scene.full.line_substeps = substeps;
            Simulation fast(scene),
                reference(scene, [](const Scene&, const Mesh&mesh, const NodeConstants&constants) {
                    return make_reference_layout(mesh, constants);
                });
            EXPECT_EQ(fast.layout().name(), "unstructured");
            for (Simulation* s : {&fast, &reference})
                for (int step = 0; step < 200; ++step) {
                    s->evaluate_forces();
                    s->step_to(1e9);
                }
            ASSERT_FALSE(fast.find_fault()) << fast.find_fault()->detail;
            EXPECT_NEAR(fast.system().time / reference.system().time, 1.0, 1e-9);
            const State &a = fast.synchronised_state(), &b = reference.synchronised_state();
            double apart = 0.0, moved = 0.0;
            for (NodeIndex i = 0; i < fast.mesh().node_count(); ++i) {
                apart = std::max(apart, (to_vec3(a.node[i].x) - to_vec3(b.node[i].x)).norm());
                moved = std::max(moved, to_vec3(a.node[i].v).norm());
            }
            EXPECT_LT(apart, 1e-8) << static_cast<int>(by) << substeps;
            EXPECT_GT(moved, 0.0);
        }
}

std::string refused(const std::vector<std::string>& keys) {
    try {
        test::read_text(test::good_scene, keys);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

TEST(VentLines, BadOnesAreRefusedByKey) {
    const auto expect = [](const std::vector<std::string>& keys, const char* text) {
        EXPECT_NE(refused(keys).find(text), std::string::npos)
            << keys.front() << keys.back() << refused(keys);
    };
    expect({"parachute.vent_lines.model=pull-down"}, "parachute.vent_lines.length: is missing");
    expect({"parachute.vent_lines.length=0"}, "parachute.vent_lines.length: ");
    expect({"parachute.vent_lines.length=9", "parachute.vent_lines.joint=7.4"},
           "parachute.vent_lines.joint: 7.4 m below the skirt lies beyond the link");
    expect({"parachute.vent_lines.model=across", "parachute.gores=27", "parachute.risers=3"},
           "\"across\" the vent of 27 gores");
    expect({"parachute.type=annular", "parachute.vent_diameter=5", "parachute.cone_angle=[1.6]"},
           "cone_angle.1: the first panel does not lead outward");
    // Of a --set, the later one stands in for what contradicts it: in one table both are refused.
    const auto in_table = [](const char* table) -> std::string {
        try {
            test::read_text(test::edited(test::good_scene, "design = \"usaf-c9\"",
                                         std::string("design = \"usaf-c9\"\nvent_lines = ") + table));
        } catch (const SceneError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(in_table("{ length = 3, pull_down_ratio = 0.5 }").find("stands beside"), std::string::npos)
        << in_table("{ length = 3, pull_down_ratio = 0.5 }");
    EXPECT_NE(in_table("{ model = \"across\", joint = 1 }").find("vent_lines.joint"), std::string::npos)
        << in_table("{ model = \"across\", joint = 1 }");
    EXPECT_EQ(in_table("{ length = 3, joint = 1 }"), "");
    expect({"parachute.vent_lines.length=3", "parachute.vent_lines.joint=1", "full.mesh.line_elements=1"},
           "full.mesh.line_elements: 1 has no node for the joint");
    EXPECT_EQ(refused({"parachute.vent_lines.model=across"}), "");
    EXPECT_EQ(refused({"parachute.vent_lines.pull_down_ratio=0.5"}), "");
    const Scene own = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-window.toml");
    ASSERT_TRUE(own.parachutes.front().mesh);
    try {
        read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-window.toml", {"parachute.vent_lines.model=across"});
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "parachute.vent_lines");
    }
}

TEST(VentLines, ThatWouldHoldTheVentBelowTheSkirtAreRefused) {
    Parachute chute = annular();
    for (const double length : {0.1, 1.0}) {
        chute.vent_lines->length = length;
        chute.vent_lines->joint = 8.0;
        try {
            make_gore_mesh(chute, {2, 9, 25, 2}, 152.4, Vec3::UnitZ(), mouth_area_at_line_stretch(chute),
                           0.0);
            FAIL() << length;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.key(), "parachute.vent_lines.length");
        }
    }
}

TEST(VentLines, PredictNoFillingAndNoSector) {
    Scene scene = annular_scene(DeployBy::line_stretch);
    EXPECT_TRUE(fullsim::full_fidelity().unsupported_keys(scene).empty());
    scene.parachutes.front().filling.model = find_filling("predicted");
    EXPECT_EQ(fullsim::full_fidelity().unsupported_keys(scene),
              std::vector<std::string>{"parachute.filling"});
    scene = annular_scene(DeployBy::line_stretch);
    scene.full.symmetry = Symmetry::sector;
    EXPECT_THROW(Simulation{scene}, SceneError);
}

}  // namespace
}  // namespace twinchute::fullsim
