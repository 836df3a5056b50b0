// Rows of canopy geometries against theory: area, seams, constructed and folded shape.
#include "fullsim/canopy/canopy_geometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/canopy_types.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "tests/support/canopy_of_type.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int row_count = 7;

Parachute c9() {
    return test::c9_scene().parachutes.front();
}

GoreOutline c9_outline() {
    return canopy_geometry(c9()).outline(c9());
}

std::vector<NodeRow> rows_of(const GoreOutline& outline, int columns) {
    std::vector<NodeRow> rows;
    for (int k = 0; k < row_count; ++k)
        rows.push_back({outline.vent + (outline.skirt - outline.vent) * k / (row_count - 1.0), columns});
    return rows;
}

/// Edges of the cut along both diagonals, both seams and the row, against the same in a shape.
double largest_change(const CanopyNodes& shape, const GoreOutline& outline,
                      const std::vector<NodeRow>& rows) {
    struct Step {
        int row, column;
    };
    double largest = 0.0;
    for (int row = 0; row + 1 < row_count; ++row)
        for (int column = 0; column < rows[0].columns; ++column)
            for (const Step& to : {Step{0, 1}, {1, 0}, {1, 1}}) {
                const double cut = (cut_point(outline, rows[row + to.row], column + to.column) -
                                    cut_point(outline, rows[row], column))
                                       .norm();
                for (const int gore : {0, 3})
                    largest = std::max(largest, std::abs((shape.node(row + to.row, gore, column + to.column) -
                                                          shape.node(row, gore, column))
                                                             .norm() -
                                                         cut));
            }
    return largest;
}

TEST(CanopyGeometry, EveryTypeOfItsOwnShapeHasARow) {
    for (const std::string& name : canopy_type_names(TWINCHUTE_SOURCE_DIR "/data")) {
        Parachute chute = c9();
        chute.type = read_canopy_type(name, "parachute.type", {}, TWINCHUTE_SOURCE_DIR "/data");
        const bool own = chute.type->meshed.shape == MeshedCanopy::Shape::own;
        const bool panels = std::ranges::count(test::panelled_types, name) > 0 || name == "annular";
        const bool slots = std::ranges::count(test::slotted_types, name) > 0;
        const bool cross = name == "cross";
        EXPECT_EQ(own, panels || slots || name == "flat-circular" || cross) << name;
        EXPECT_EQ(cross_arm_ratio(chute) > 0.0, cross) << name;
        EXPECT_EQ(chute.type->meshed.slotted, slots) << name;
        EXPECT_EQ(chute.type->meshed.open_middle, name == "annular") << name;
        EXPECT_EQ(canopy_geometry(chute).name, panels ? "panels" : "flat-circular") << name;
        EXPECT_EQ(chute.type->meshed.gore.empty(), !panels) << name;
        EXPECT_EQ(chute.type->meshed.gore_source.empty(), !panels && !cross) << name;
        chute.mesh.emplace();  // has its own shape
        EXPECT_EQ(canopy_geometry(chute).name, "flat-circular") << name;
    }
    EXPECT_EQ(canopy_geometry(c9()).name, "flat-circular");  // no type is given
}

TEST(CanopyGeometry, EveryRowNamesItsSource) {
    for (const CanopyGeometry& row : canopy_geometries())
        EXPECT_FALSE(row.source.empty()) << row.name;
}

TEST(CanopyGeometry, GoresHaveTheNominalAreaTogether) {
    // Width over the centre line, by the trapezoidal rule: exact for straight seams.
    for (const int gores : {3, 8, 28}) {
        Parachute chute = c9();
        chute.gores = gores;
        for (const CanopyGeometry& geometry : canopy_geometries()) {
            const GoreOutline outline = geometry.outline(chute);
            double area = 0.0, width_before = 0.0, centre_before = 0.0;
            for (const NodeRow& row : rows_of(outline, 2)) {
                const Eigen::Vector2d seam = cut_point(outline, row, 2);
                const double width = seam.x() - cut_point(outline, row, 0).x();
                if (row.seam > outline.vent)
                    area += 0.5 * (width + width_before) * (seam.y() - centre_before);
                width_before = width;
                centre_before = seam.y();
            }
            EXPECT_NEAR(gores * area, 0.25 * pi * (8.53 * 8.53 - 0.853 * 0.853), 1e-12) << geometry.name;
        }
    }
}

TEST(CanopyGeometry, SeamsOfNeighboursAreAsLongAsTheirTape) {
    for (const CanopyGeometry& geometry : canopy_geometries()) {
        const GoreOutline outline = geometry.outline(c9());
        const std::vector<NodeRow> rows = rows_of(outline, 4);
        for (int row = 0; row + 1 < row_count; ++row)
            for (const int seam : {0, 4})  // sewn to the gore before and to the next one
                EXPECT_NEAR(
                    (cut_point(outline, rows[row + 1], seam) - cut_point(outline, rows[row], seam)).norm(),
                    rows[row + 1].seam - rows[row].seam, 1e-14);
    }
}

TEST(CanopyGeometry, TheConstructedShapeIsUnstrained) {
    for (const CanopyGeometry& geometry : canopy_geometries()) {
        const GoreOutline outline = geometry.outline(c9());
        const std::vector<NodeRow> rows = rows_of(outline, 4);
        const CanopyNodes shape = constructed_shape(outline, rows);
        EXPECT_LT(largest_change(shape, outline, rows), 1e-14) << geometry.name;
        EXPECT_LT((shape.skirt - shape.node(row_count - 1, 0, 0)).norm(), 1e-14) << geometry.name;
        // The last column line of a gore is the seam to the next one.
        EXPECT_LT((shape.node(2, 0, 4) - shape.node(2, 1, 0)).norm(), 1e-15) << geometry.name;
    }
}

TEST(CanopyGeometry, AFlatCircularCanopyIsConstructedPlane) {
    const GoreOutline outline = c9_outline();
    const std::vector<NodeRow> rows = rows_of(outline, 3);
    const CanopyNodes shape = constructed_shape(outline, rows);
    for (int row = 0; row < row_count; ++row)
        for (int gore = 0; gore < 28; ++gore) {
            for (int column = 0; column < 3; ++column)
                EXPECT_EQ(shape.node(row, gore, column).z(), 0.0);
            EXPECT_NEAR(shape.node(row, gore, 0).norm(), rows[row].seam, 1e-14);
        }
}

TEST(CanopyGeometry, AFoldedCanopyIsUnstrainedAndHasItsMouth) {
    const double mouth = mouth_area_at_line_stretch(c9());
    for (const CanopyGeometry& geometry : canopy_geometries()) {
        const GoreOutline outline = geometry.outline(c9());
        const std::vector<NodeRow> rows = rows_of(outline, 4);
        const CanopyNodes shape = geometry.fold(outline, rows, {mouth, 0.0, c9().fabric});
        EXPECT_LT(largest_change(shape, outline, rows), 1e-14) << geometry.name;
        EXPECT_LT((shape.skirt - shape.node(row_count - 1, 0, 0)).norm(), 1e-14) << geometry.name;
        double twice = 0.0;
        for (int k = 0; k < 28 * 4; ++k) {
            const Vec3 a = shape.node(row_count - 1, k / 4, k % 4),
                       b = shape.node(row_count - 1, (k + 1) / 4, (k + 1) % 4);
            twice += a.x() * b.y() - a.y() * b.x();
        }
        EXPECT_NEAR(0.5 * twice, mouth, 1e-12) << geometry.name;
    }
}

}  // namespace
}  // namespace twinchute::fullsim
