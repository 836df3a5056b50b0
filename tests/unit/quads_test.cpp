// Triangles by twos: what is paired, and that a triangle stays the same whichever corner comes first.
#include "fullsim/storage/unstructured/quads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace twinchute::fullsim {
namespace {

using unstructured::Quad, unstructured::quads_of;

/// Strains of an uneven patch of fabric have no symmetry that could hide a wrong corner.
Vec3 place(NodeIndex i, int columns) {
    const NodeIndex row = i / columns;
    const double x = i % columns, y = row;
    return {x + 0.2 * std::sin(3.0 * y + x), 0.7 * y + 0.1 * std::cos(2.0 * x + y), 0.0};
}

Triangle triangle(const std::array<NodeIndex, 3>& node, int columns = 4) {
    return laid_flat(node, {place(node[0], columns), place(node[1], columns), place(node[2], columns)});
}

/// Rows of squares of two triangles, each with another corner first.
std::vector<Triangle> patch(int rows, int columns) {
    std::vector<Triangle> all;
    for (int r = 0; r + 1 < rows; ++r)
        for (int c = 0; c + 1 < columns; ++c) {
            const NodeIndex i = r * columns + c;
            for (std::array<NodeIndex, 3> node :
                 {std::array{i, i + 1, i + columns + 1}, std::array{i, i + columns + 1, i + columns}}) {
                std::rotate(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(all.size() % 3),
                            node.end());
                all.push_back(triangle(node, columns));
            }
        }
    return all;
}

std::vector<Triangle> triangles_of(const std::vector<Quad>& quads) {
    std::vector<Triangle> all;
    for (const Quad& q : quads) {
        all.push_back(q.first);
        if (q.second) all.push_back(*q.second);
    }
    return all;
}

/// Squares of the unstrained edges [m^2] by their ends, in the order of the turn.
std::map<std::array<NodeIndex, 2>, double> edges_of(const Triangle& t) {
    const auto square = [](double x, double y) { return x * x + y * y; };
    return {{{t.node[0], t.node[1]}, square(t.a, 0.0)},
            {{t.node[1], t.node[2]}, square(t.b - t.a, t.c)},
            {{t.node[2], t.node[0]}, square(t.b, t.c)}};
}

TEST(Quads, HaveEveryTriangleOnceAndAsItWas) {
    for (const int columns : {2, 3, 4, 7}) {
        const std::vector<Triangle> before = patch(4, columns);
        const std::vector<Triangle> after = triangles_of(quads_of(before));
        ASSERT_EQ(after.size(), before.size());
        std::map<std::array<NodeIndex, 2>, double> expected, found;
        for (const Triangle& t : before)
            expected.merge(edges_of(t));
        for (const Triangle& t : after)
            found.merge(edges_of(t));
        ASSERT_EQ(found.size(), expected.size());  // inner edges both ways
        for (const auto& [ends, square] : expected) {
            ASSERT_TRUE(found.contains(ends));
            EXPECT_NEAR(found.at(ends), square, 1e-14 * square + 1e-15);  // rounding of lengths near 1
        }
    }
}

TEST(Quads, ShareAnEdge) {
    for (const Quad& q : quads_of(patch(4, 5))) {
        EXPECT_EQ(q.first.node, (std::array{q.node[0], q.node[1], q.node[2]}));
        if (!q.second) {
            EXPECT_EQ(q.node[3], q.node[0]);
            continue;
        }
        EXPECT_EQ(q.second->node, (std::array{q.node[0], q.node[2], q.node[3]}));
    }
}

TEST(Quads, LeaveFewTrianglesAlone) {
    // In the order of the triangles, and where no neighbour follows another.
    std::vector<Triangle> triangles = patch(9, 9);
    for (int turn = 0; turn < 2; ++turn) {
        const auto quads = quads_of(triangles);
        EXPECT_LE(std::ranges::count_if(quads, [](const Quad& q) { return !q.second; }), 8);  // of 128
        std::ranges::stable_sort(triangles, {}, [](const Triangle& t) { return t.node[0] * 37 % 101; });
    }
}

TEST(Quads, AreNotMadeAcrossASeamThatTurnsOrBranches) {
    // Two triangles that turn against each other; three on one edge, of which two pair; one by itself.
    EXPECT_EQ(quads_of({triangle({0, 1, 4}), triangle({0, 1, 5})}).size(), 2U);
    EXPECT_EQ(quads_of({triangle({0, 1, 4}), triangle({1, 0, 5}), triangle({1, 0, 6})}).size(), 2U);
    EXPECT_EQ(quads_of({triangle({0, 1, 4})}).size(), 1U);
    EXPECT_TRUE(quads_of({}).empty());
}

// Parts are what threads write to at once: a node of two of them would be a race.
TEST(Parts, ShareNoNodeWithEachOtherNorStripsAmongThemselves) {
    constexpr int rows = 200, columns = 60;
    Mesh mesh;
    mesh.canopy_nodes = rows * columns;
    mesh.triangles = patch(rows, columns);  // 23 482
    const unstructured::Parts parts(mesh);
    ASSERT_EQ(parts.count(), 8U);
    EXPECT_EQ(parts.end(7), mesh.canopy_nodes);
    std::vector<int> of_part(rows * columns, -1), of_strip(rows * columns, -1);
    std::vector<std::size_t> quads(parts.lists(), 0);
    for (const Quad& q : quads_of(mesh, 0)) {
        const std::size_t list = parts.list_of(q);
        ASSERT_LT(list, parts.lists());
        ++quads[list];
        const bool is_strip = list >= parts.count();
        const int number = static_cast<int>(list);
        for (const NodeIndex i : q.node) {
            int& owner = (is_strip ? of_strip : of_part)[static_cast<std::size_t>(i)];
            if (owner < 0) owner = number;
            EXPECT_EQ(owner, number) << "node " << i;
            if (!is_strip) {
                EXPECT_LT(i, parts.end(list));
            }
        }
    }
    // Strips are a row of squares each, the rest is shared out alike.
    for (std::size_t k = 0; k < parts.lists(); ++k)
        EXPECT_NEAR(static_cast<double>(quads[k]), k < 8 ? (11'741.0 - 7 * 59) / 8 : 59.0, 60.0) << k;
}

TEST(Parts, AreOneWhereItIsSmallOrInNoOrder) {
    Mesh small;
    small.canopy_nodes = 40 * 40;
    small.triangles = patch(40, 40);  // 3042
    EXPECT_EQ(unstructured::Parts(small).count(), 1U);
    EXPECT_EQ(unstructured::Parts(small).lists(), 1U);
    Mesh mixed;
    mixed.canopy_nodes = 100 * 100;
    mixed.triangles = patch(100, 100);
    ASSERT_EQ(unstructured::Parts(mixed).count(), 8U);
    for (Triangle& t : mixed.triangles)  // every second node from the other end
        for (NodeIndex& i : t.node)
            if (i % 2 != 0) i = mixed.canopy_nodes - i;
    EXPECT_EQ(unstructured::Parts(mixed).count(), 1U);
    const unstructured::Parts one(mixed);
    for (const Quad& q : quads_of(mixed, 0))
        EXPECT_EQ(one.list_of(q), 0U);
}

}  // namespace
}  // namespace twinchute::fullsim
