// The generated parachute against its cut pattern.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/forces/membrane.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

using test::c9_scene;

Mesh c9_mesh(MeshCounts counts, int risers, double load = 0.0) {
    Parachute chute = c9_scene().parachutes.front();
    chute.risers = risers;
    return make_gore_mesh(chute, counts, 152.4, Vec3::UnitZ(), mouth_area_at_line_stretch(chute), load);
}

TEST(GoreMesh, HasAboutThePapersCounts) {
    // Paper, 5.1: 1932 triangles and 1461 cables; the default mesh is within 3 %, the demo's has as many
    // triangles and 7 % fewer cables.
    const Mesh demo = c9_mesh({4, 9, 34, 5, Grading::graded}, 4);
    EXPECT_EQ(demo.triangles.size(), 1932u);
    EXPECT_EQ(demo.cables.size(), 28u * (9 + 4 + 1 + 34) + 4 * 5);
    EXPECT_NEAR(static_cast<double>(demo.cables.size()), 1461.0, 0.1 * 1461.0);
    for (const Grading grading : {Grading::graded, Grading::uniform}) {
        const Mesh mesh = c9_mesh({2, 17, 31, 5, grading}, 4);
        EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), 1932.0, 0.03 * 1932.0);
        EXPECT_NEAR(static_cast<double>(mesh.cables.size()), 1461.0, 0.03 * 1461.0);
        // One edge a gore is missing in a graded mesh's vent, and the triangle that stands on it.
        const unsigned missing = grading == Grading::graded ? 28 : 0;
        EXPECT_EQ(mesh.triangles.size(), 28u * 2 * 2 * 17 - missing);
        EXPECT_EQ(mesh.cables.size(), 28u * (17 + 2 + 2 + 31) + 4 * 5 - missing);
    }
}

TEST(GoreMesh, HasTheNominalAreaLessTheVent) {
    for (const Grading grading : {Grading::graded, Grading::uniform})
        for (const int columns : {1, 2, 3, 4})
            EXPECT_NEAR(c9_mesh({columns, 5, 2, 1, grading}, 1).fabric_area(),
                        0.25 * pi * (8.53 * 8.53 - 0.853 * 0.853), 1e-11)
                << columns;
}

TEST(GoreMesh, WeighsWhatItsMaterialsWeigh) {
    // By hand: fabric 533 * 1e-4 * area; cords of 462 kg/m^3 and 4 mm: 28 lines of 7.31 m, their 28
    // strands through 1.22 m of riser, 28 radial tapes, skirt and vent polygons.
    const double delta = pi / 28.0, polygon = 14.0 * std::sin(2.0 * delta);
    const double skirt = std::sqrt(0.25 * pi * 8.53 * 8.53 / polygon), vent = 0.1 * skirt;
    const double cord = 462.0 * 0.25 * pi * 16e-6;
    const double length = 28.0 * (7.31 + 1.22 + (skirt - vent) + 2.0 * std::sin(delta) * (skirt + vent));
    const double expected = 533.0 * 1e-4 * 0.25 * pi * 8.53 * 8.53 * 0.99 + cord * length;
    for (const auto& [risers, grading] :
         {std::pair{1, Grading::graded}, {4, Grading::graded}, {4, Grading::uniform}}) {
        const Mesh mesh = c9_mesh({2, 17, 31, 5, grading}, risers);
        EXPECT_NEAR(mesh.parachute_mass(), expected, 1e-10);
        double lumped = 0.0;
        for (const double m : mesh.mass)
            lumped += m;
        EXPECT_NEAR(lumped, expected + 152.4, 1e-9);
        EXPECT_GT(mesh.mass[mesh.payload()], 152.4);
    }
}

TEST(GoreMesh, PleatsLeaveTheFabricUnstrained) {
    for (const int columns : {2, 4, 6}) {
        const Mesh mesh = c9_mesh({columns, 7, 4, 2, Grading::uniform}, 1);
        double worst = 0.0;
        for (const Triangle& t : mesh.triangles) {
            const PlaneTensor e = green_strain(
                t, {mesh.position[t.node[0]], mesh.position[t.node[1]], mesh.position[t.node[2]]});
            worst = std::max({worst, std::abs(e.xx), std::abs(e.yy), std::abs(e.xy)});
        }
        EXPECT_LT(worst, 1e-12) << columns;  // an isometry, to round-off
    }
}

/// Larger principal strain of a triangle as the mesh starts.
double first_strain(const Mesh& mesh, const Triangle& t) {
    const PlaneTensor e =
        green_strain(t, {mesh.position[t.node[0]], mesh.position[t.node[1]], mesh.position[t.node[2]]});
    return 0.5 * (e.xx + e.yy) + std::hypot(0.5 * (e.xx - e.yy), e.xy);
}

TEST(GoreMesh, AGradedVentHangsLoose) {
    // Its one element a gore is folded together; with the seams left taut the fabric below it would be
    // strained by 0.4 %. All else lies in the same pleats as on a uniform mesh.
    for (const int columns : {2, 4, 6}) {
        const Mesh mesh = c9_mesh({columns, 17, 4, 2}, 1);
        const auto in_the_first_row = [&](const Triangle& t) {
            return std::ranges::any_of(t.node, [](NodeIndex i) { return i < 28; });
        };
        double loose = 0.0, pleated = 0.0;
        for (const Triangle& t : mesh.triangles)
            if (double& worst = in_the_first_row(t) ? loose : pleated; first_strain(mesh, t) > worst)
                worst = first_strain(mesh, t);
        EXPECT_LT(loose, 1e-4) << columns;
        EXPECT_LT(pleated, 1e-12) << columns;
    }
}

TEST(GoreMesh, GoresAreIdentical) {
    // A node of one gore is one of the next by as many numbers as its ring has nodes a gore, round the ring.
    for (const Grading grading : {Grading::graded, Grading::uniform})
        for (const int columns : {1, 2, 3}) {
            const Mesh mesh = c9_mesh({columns, 5, 2, 1, grading}, 1);
            std::vector<NodeIndex> next(mesh.canopy_nodes);
            ASSERT_EQ(mesh.seam_rings.size(), 6u);
            for (std::size_t row = 0; row < 6; ++row) {
                const auto& ring = mesh.seam_rings[row];
                ASSERT_EQ(ring.size(), 28u);
                const NodeIndex first = ring[0], shift = ring[1] - ring[0], count = 28 * shift;
                EXPECT_EQ(shift, row == 0 && grading == Grading::graded ? 1 : columns);
                for (NodeIndex i = 0; i < count; ++i)
                    next[first + i] = first + (i + shift) % count;
            }
            const std::size_t of_a_gore = mesh.triangles.size() / 28;
            ASSERT_EQ(mesh.triangles.size(), 28 * of_a_gore);
            for (std::size_t e = 0; e < mesh.triangles.size(); ++e) {
                const Triangle& here = mesh.triangles[e];
                const Triangle& there = mesh.triangles[(e + of_a_gore) % mesh.triangles.size()];
                for (int k = 0; k < 3; ++k)
                    EXPECT_EQ(there.node[k], next[here.node[k]]);
                EXPECT_TRUE(here.a == there.a && here.b == there.b && here.c == there.c);
            }
            for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
                EXPECT_NEAR(mesh.mass[next[i]], mesh.mass[i], 1e-16);
        }
}

TEST(GoreMesh, NoTriangleIsASliver) {
    // 4 sqrt(3) S over the sum of squared edges: 1 for an equilateral triangle, 0 for a sliver.
    const auto worst = [](MeshCounts counts) {
        const Mesh mesh = c9_mesh(counts, 1);
        double least = 1.0;
        for (const Triangle& t : mesh.triangles) {
            EXPECT_GT(t.area(), 0.0);
            const double edges = t.a * t.a + t.b * t.b + (t.b - t.a) * (t.b - t.a) + 2.0 * t.c * t.c;
            least = std::min(least, 4.0 * std::sqrt(3.0) * t.area() / edges);
        }
        return least;
    };
    EXPECT_GT(worst({2, 17, 31, 5, Grading::graded}), 0.29);
    EXPECT_GT(worst({1, 17, 31, 5, Grading::graded}), 0.28);
    EXPECT_GT(worst({3, 25, 31, 5, Grading::graded}), 0.2);
    EXPECT_GT(worst({4, 9, 34, 5, Grading::graded}), 0.13);  // the middle of the fan at the vent
    EXPECT_GT(worst({2, 17, 31, 5, Grading::uniform}), 0.29);
}

TEST(GoreMesh, GradingNeverGivesMoreThanHalfOfTheSeamAway) {
    for (const int gores : {3, 8, 28})
        for (const int rows : {2, 5, 40}) {
            Parachute chute = c9_scene().parachutes.front();
            chute.gores = gores;
            const Mesh mesh = make_gore_mesh(chute, {2, rows, 2, 1}, 152.4, Vec3::UnitZ(),
                                             mouth_area_at_line_stretch(chute), 0.0);
            double shortest = 1e9, longest = 0.0, sum = 0.0;
            for (const Cable& c : mesh.cables)
                if (c.kind == CableKind::radial) {
                    shortest = std::min(shortest, c.rest_length);
                    longest = std::max(longest, c.rest_length);
                    sum += c.rest_length / gores;
                }
            const GoreOutline cut = canopy_geometry(chute).outline(chute);
            EXPECT_NEAR(sum, cut.skirt - cut.vent, 1e-12);
            EXPECT_GE(shortest, 0.5 * sum / rows);
            EXPECT_LE(longest, 0.5 * sum / rows + 0.5 * sum);
            EXPECT_TRUE(std::ranges::all_of(mesh.position, [](const Vec3& x) { return x.allFinite(); }));
        }
}

TEST(GoreMesh, NarrowElementsHaveALongerRowAtTheVent) {
    // Rows are longer than plain ones by first/(k + 1)^1.5, so that the first two tell `first`: four edges of
    // the vent, times height over width of the cut's elements at the skirt where there are more than two
    // across.
    const Parachute chute = c9_scene().parachutes.front();
    const GoreOutline cut = canopy_geometry(chute).outline(chute);
    const double seam = cut.skirt - cut.vent, edge = 2.0 * cut.vent * std::sin(pi / 28.0);
    const auto first = [&](int columns, int rows) {
        std::vector<double> length;  // of a gore's radial tape, from the vent down
        for (const Cable& c : c9_mesh({columns, rows, 2, 1}, 1).cables)
            if (c.kind == CableKind::radial) length.push_back(c.rest_length);
        return (length[0] - length[1]) / (1.0 - std::pow(2.0, -1.5));
    };
    EXPECT_NEAR(first(2, 17), 4.0 * edge, 1e-12);  // the default
    EXPECT_NEAR(first(2, 9), 4.0 * edge, 1e-12);   // no narrower at the vent, however few rows
    EXPECT_NEAR(first(4, 18), 4.0 * edge, 1e-12);  // wider than they are high
    const double slender = (seam / 9.0) / (2.0 * cut.skirt * std::sin(pi / 28.0) / 4.0);
    EXPECT_NEAR(slender, 1.79, 0.01);  // 0.428 m high, 0.240 m wide
    for (const int finer : {1, 2, 3})
        EXPECT_NEAR(first(4 * finer, 9 * finer), slender * 4.0 * edge, 1e-12) << finer;
    EXPECT_NEAR(first(4, 7), 8.0 * edge, 1e-12);  // at most twice, as their elements are half as wide
}

TEST(GoreMesh, WithoutPleatsTheFabricHangsLooseOrCarriesTheLoad) {
    // One column cannot be pleated: unloaded, no principal strain is larger than round-off.
    const Mesh mesh = c9_mesh({1, 9, 4, 2}, 1);
    for (const Triangle& t : mesh.triangles)
        EXPECT_LT(first_strain(mesh, t), 5e-4);  // tan(delta)^2/2 = 0.6 % if the cut were ignored
}

TEST(GoreMesh, LinesCarryTheLoadThatItIsGiven) {
    const double load = 450.0;
    for (const int risers : {1, 4}) {
        const Mesh mesh = c9_mesh({2, 5, 8, 3}, risers, load);
        for (const Cable& c : mesh.cables) {
            if (c.kind != CableKind::line && c.kind != CableKind::riser) continue;
            const double strain =
                (mesh.position[c.node[1]] - mesh.position[c.node[0]]).norm() / c.rest_length - 1.0;
            EXPECT_NEAR(mesh.cord(c.kind).axial_stiffness() * c.strands * strain, load / 28.0 * c.strands,
                        1e-6);
        }
    }
}

TEST(GoreMesh, MouthHasTheWantedArea) {
    // Seen along the axis, the ring of all skirt nodes encloses (C_D S)_i/(C_D S)_0 of the steady
    // canopy's projected area: 0.04 pi (0.65 D0/2)^2.
    for (const int columns : {1, 2, 3, 4}) {
        const Mesh mesh = c9_mesh({columns, 4, 2, 1}, 1);
        const int ring = 28 * columns, first = mesh.seam_rings.back().front();
        double twice = 0.0;
        for (int i = 0; i < ring; ++i) {
            const Vec3 a = mesh.position[first + i], b = mesh.position[first + (i + 1) % ring];
            twice += a.x() * b.y() - a.y() * b.x();
        }
        EXPECT_NEAR(0.5 * std::abs(twice), 0.04 * 0.25 * pi * std::pow(0.65 * 8.53, 2), 1e-9) << columns;
    }
}

TEST(GoreMesh, IsOneClosedSheetThatFacesOutward) {
    for (const auto& [columns, grading] :
         {std::pair{2, Grading::graded}, {3, Grading::graded}, {2, Grading::uniform}}) {
        const Mesh mesh = c9_mesh({columns, 6, 2, 1, grading}, 1);
        std::map<std::pair<NodeIndex, NodeIndex>, int> directed;
        for (const Triangle& t : mesh.triangles)
            for (int k = 0; k < 3; ++k)
                ++directed[{t.node[k], t.node[(k + 1) % 3]}];
        int border = 0;
        for (const auto& [edge, count] : directed) {
            EXPECT_EQ(count, 1);  // never the same way round twice: one orientation everywhere
            border += directed.count({edge.second, edge.first}) == 0;
        }
        EXPECT_EQ(border, 28 * (columns + (grading == Grading::graded ? 1 : columns)));  // skirt and vent
        Vec3 outward = Vec3::Zero();
        for (const Triangle& t : mesh.triangles)
            outward += 0.5 * (mesh.position[t.node[1]] - mesh.position[t.node[0]])
                                 .cross(mesh.position[t.node[2]] - mesh.position[t.node[0]]);
        EXPECT_GT(outward.dot(mesh.axis), 0.0);
    }
}

TEST(GoreMesh, RisersShareTheLines) {
    const Mesh mesh = c9_mesh({1, 3, 2, 2}, 4);
    std::map<NodeIndex, int> lines_at;
    for (const Cable& c : mesh.cables)
        if (c.kind == CableKind::line) ++lines_at[c.node[1]];
    int links = 0, payload_risers = 0;
    for (const auto& [node, count] : lines_at)
        links += count == 7;
    for (const Cable& c : mesh.cables)
        payload_risers += c.kind == CableKind::riser && c.node[1] == mesh.payload();
    EXPECT_EQ(links, 4);
    EXPECT_EQ(payload_risers, 4);
    EXPECT_EQ(mesh.position[mesh.payload()], Vec3(0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace twinchute::fullsim
