// Meshes of canopies whose gores are panels: areas and masses against closed forms, and their folding.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/mesh/gores.hpp"
#include "lib/models/meridian.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/largest_strain.hpp"

namespace twinchute::fullsim {
namespace {

using test::canopy_of_type;
using test::is_round;
using test::panelled_types;

constexpr double nominal = 0.25 * pi * 8.53 * 8.53,
                 vent_area = 0.25 * pi * 0.853 * 0.853;  // [m^2] of the C-9

Mesh constructed(const Parachute& chute, const MeshCounts& counts) {
    return make_constructed_mesh(chute, counts, 152.4);
}

/// Fabric that the vent cuts off [m^2]: its polygon, over the slope of the facets at the apex.
double tip(const Parachute& chute) {
    const double slope = gore_panels(chute).front().top, delta = pi / chute.gores;
    return vent_area * std::hypot(std::cos(delta) * std::cos(slope), std::sin(slope)) /
           (std::cos(delta) * std::cos(slope));
}

/// Disk-gap-band with its gores' unit of length [m]: a disk of n triangles of side 5.765, and gap and band
/// that stand on its edge as rectangles of 0.69 and 1.94, have the nominal area together.
struct DiskGapBand {
    double unit, edge;  ///< edge: of the disk, all gores together [m]

    explicit DiskGapBand(int gores) {
        const double delta = pi / gores, around = 2.0 * gores * std::sin(delta) * 5.765;
        const double disk = 0.5 * gores * std::sin(2.0 * delta) * 5.765 * 5.765;
        unit = std::sqrt(nominal / (disk + around * (0.69 + 1.94)));
        edge = around * unit;
    }
    double gap_area() const { return edge * 0.69 * unit; }  ///< [m^2]
};

double gap_area(const std::string& type, int gores) {
    return type == "disk-gap-band" ? DiskGapBand(gores).gap_area() : 0.0;
}

TEST(PanelledCanopy, ConesHaveTheNominalAreaLessTheVentsTipAndGaps) {
    for (const char* type : panelled_types) {
        if (is_round(type)) continue;
        for (const int gores : {8, 28})
            for (const Grading grading : {Grading::graded, Grading::uniform})
                for (const MeshCounts& counts : {MeshCounts{1, 3, 2, 1, grading},
                                                 {2, 7, 2, 1, grading},
                                                 {3, 17, 2, 1, grading},
                                                 {4, 18, 2, 1, grading}}) {
                    const Parachute chute = canopy_of_type(type, gores);
                    EXPECT_NEAR(constructed(chute, counts).fabric_area(),
                                nominal - tip(chute) - gap_area(type, gores), 1e-10)
                        << type << counts.gore_columns;
                }
    }
}

TEST(PanelledCanopy, AHemispheresAreaIsOfSecondOrder) {
    // Triangles cut the curved edge of the gore short: closed form n R^2 sin(delta) [F(u)] between the slopes
    // of vent and skirt, F = u sqrt(1 - k^2 u^2) + asin(k u)/k, u = cos(slope), k = sin(delta).
    const Parachute chute = canopy_of_type("hemispherical");
    const double delta = pi / 28.0, k = std::sin(delta);
    const double R = std::sqrt(nominal / (28.0 * (delta + std::sin(delta) * std::cos(delta))));
    const double u = std::sqrt(1.0 - std::pow(polygon_radius(0.853, 28) / R, 2));
    const double area =
        28.0 * R * R * std::sin(delta) * (u * std::sqrt(1.0 - k * k * u * u) + std::asin(k * u) / k);
    double before = 0.0;
    for (const int rows : {8, 16, 32, 64}) {
        const double error = area - constructed(chute, {2, rows, 2, 1, Grading::uniform}).fabric_area();
        EXPECT_GT(error, 0.0);
        if (before > 0.0) {
            EXPECT_NEAR(before / error, 4.0, 0.02) << rows;
        }
        before = error;
    }
    EXPECT_LT(before, 1e-4 * area);
}

TEST(PanelledCanopy, WeighsWhatItsMaterialsWeigh) {
    // By hand as for the flat circular one: fabric 533 * 1e-4 of its area, cords of 462 kg/m^3 and 4 mm.
    for (const char* type : panelled_types) {
        if (is_round(type)) continue;
        const Parachute chute = canopy_of_type(type);
        const Meridian meridian(gore_panels(chute), 28, nominal);
        const double chords = 2.0 * std::sin(pi / 28.0), vent = polygon_radius(0.853, 28);
        const double seam = meridian.length() - meridian.seam_at(vent);
        const double cord = 462.0 * 0.25 * pi * 16e-6;
        const double length =
            28.0 * (7.31 + 1.22 + seam + chords * (meridian.at(meridian.length()).radius + vent));
        EXPECT_NEAR(constructed(chute, {2, 17, 31, 5}).parachute_mass(),
                    533.0 * 1e-4 * (nominal - tip(chute) - gap_area(type, 28)) + cord * length, 1e-10)
            << type;
    }
}

TEST(PanelledCanopy, SlotsWeighNothing) {
    // Fabric 533 * 1e-4 of its area, of which slots are the part that the vent leaves of 20 %.
    for (const char* type : test::slotted_types) {
        Parachute chute = canopy_of_type(type);
        const Mesh solid = constructed(chute, {2, 17, 31, 5});
        chute.geometric_porosity = 0.2;
        const Mesh slotted = constructed(chute, {2, 17, 31, 5});
        const double vent = std::pow(chute.vent_diameter / chute.nominal_diameter, 2);
        EXPECT_EQ(slotted.fabric_area(), solid.fabric_area()) << type;
        EXPECT_NEAR(solid.parachute_mass() - slotted.parachute_mass(),
                    533.0 * 1e-4 * solid.fabric_area() * (0.2 - vent) / (1.0 - vent), 1e-10)
            << type;
    }
}

TEST(PanelledCanopy, ConesAreConstructedWithoutStrain) {
    for (const char* type : panelled_types) {
        const Mesh mesh = constructed(canopy_of_type(type), {2, 17, 2, 1});
        // Chords of a curved meridian are shorter than its arc by 1 - (h/R)^2/24: 4e-4 of 17 rows.
        EXPECT_LT(std::abs(largest_strain(mesh)), is_round(type) ? 1e-3 : 1e-12) << type;
    }
}

TEST(PanelledCanopy, RowsLieOnTheEdgesOfPanels) {
    for (const char* type : panelled_types)
        for (const int rows : {3, 4, 17}) {
            const Parachute chute = canopy_of_type(type);
            const Mesh mesh = constructed(chute, {2, rows, 2, 1});
            const GoreOutline outline = canopy_geometry(chute).outline(chute);
            EXPECT_EQ(outline.corners.size() + 1, gore_panels(chute).size());
            std::vector<double> seam{outline.vent};
            for (const Cable& c : mesh.cables)
                if (c.kind == CableKind::radial && static_cast<int>(seam.size()) <= rows)
                    seam.push_back(seam.back() + c.rest_length);
            EXPECT_TRUE(std::ranges::is_sorted(seam)) << type;
            for (const double corner : outline.corners) {
                const auto nearest =
                    std::ranges::min_element(seam, {}, [&](double s) { return std::abs(s - corner); });
                EXPECT_NEAR(*nearest, corner, 1e-12) << type << rows;
            }
            EXPECT_NEAR(seam.back(), outline.skirt, 1e-12);
        }
}

TEST(PanelledCanopy, TapesAloneBridgeAGap) {
    // One row, as wide as the gap is, whatever the number of rows: no triangle has nodes on both sides, each
    // seam has a tape there, and nothing else runs across.
    for (const Grading grading : {Grading::graded, Grading::uniform})
        for (const int rows : {3, 4, 7, 17, 40}) {
            const Parachute chute = canopy_of_type("disk-gap-band");
            const Mesh mesh = constructed(chute, {2, rows, 2, 1, grading});
            const DiskGapBand sizes(28);
            const double below = (5.765 + 0.5 * 0.69) * sizes.unit;  // the gap's middle, apex to there
            const double apex = mesh.position[mesh.seam_rings.front().front()].z();
            // The disk lies flat at the apex's height, the band hangs below the gap.
            const auto in_band = [&](NodeIndex i) { return mesh.position[i].z() < apex - 1e-6; };
            double depth = 0.0;
            for (const NodeIndex i : mesh.seam_rings.back())
                depth = std::max(depth, apex - mesh.position[i].z());
            EXPECT_NEAR(depth, (0.69 + 1.94) * sizes.unit, 1e-10);
            for (const Triangle& t : mesh.triangles)
                EXPECT_TRUE(in_band(t.node[0]) == in_band(t.node[1]) &&
                            in_band(t.node[1]) == in_band(t.node[2]));
            int across = 0;
            for (const Cable& c : mesh.cables) {
                if (c.kind >= CableKind::line || in_band(c.node[0]) == in_band(c.node[1])) continue;
                ++across;
                EXPECT_EQ(c.kind, CableKind::radial);
                EXPECT_NEAR(c.rest_length, 0.69 * sizes.unit, 1e-10);
            }
            EXPECT_EQ(across, 28) << rows;
            const GoreOutline outline = canopy_geometry(chute).outline(chute);
            EXPECT_TRUE(outline.in_gap(below)) << rows;
            EXPECT_FALSE(outline.in_gap(5.76 * sizes.unit) || outline.in_gap(6.46 * sizes.unit));
        }
}

TEST(PanelledCanopy, OneFlatPanelIsTheFlatCircularCanopy) {
    Parachute flat = canopy_of_type("conical");
    flat.cone_angle = {0.0};
    Parachute disc = flat;
    disc.type.reset();
    disc.cone_angle.clear();
    ASSERT_NE(&canopy_geometry(flat), &canopy_geometry(disc));
    // Columns and how far apart nodes may be [m]. On a graded mesh the fans at the vent are stretched by
    // about 1e-5, to which the canopy of panels is smaller. Without pleats the flat one is stretched by the
    // mean of the column's width, the other by its tautest triangle, at the vent.
    struct Case {
        int columns;
        Grading grading;
        double apart;
    };
    for (const Case& c : {Case{2, Grading::uniform, 1e-9},
                          {2, Grading::graded, 1e-4},
                          {4, Grading::graded, 1e-4},
                          {1, Grading::graded, 0.02},
                          {3, Grading::graded, 0.02}}) {
        const auto folded = [&](const Parachute& chute) {
            return make_gore_mesh(chute, {c.columns, 17, 5, 2, c.grading}, 152.4, Vec3::UnitZ(),
                                  mouth_area_at_line_stretch(chute), 900.0);
        };
        const Mesh a = folded(flat), b = folded(disc);
        ASSERT_EQ(a.node_count(), b.node_count());
        double apart = 0.0;
        for (NodeIndex i = 0; i < a.node_count(); ++i)
            apart = std::max(apart, (a.position[i] - b.position[i]).norm());
        EXPECT_LT(apart, c.apart) << c.columns;
    }
}

TEST(PanelledCanopy, AFoldedCanopyHasItsMouthAndNoStretchedFabric) {
    for (const char* type : panelled_types)
        for (const int gores : {8, 28})
            for (const Grading grading : {Grading::graded, Grading::uniform})
                for (const int columns : {1, 2, 3, 4}) {
                    const Parachute chute = canopy_of_type(type, gores);
                    const double mouth = mouth_area_at_line_stretch(chute);
                    const Mesh mesh =
                        make_gore_mesh(chute, {columns, 17, 2, 1, grading}, 152.4, Vec3::UnitZ(), mouth, 0.0);
                    const double strain = largest_strain(mesh);
                    EXPECT_LT(strain, 1e-12) << type << gores << columns;
                    // The tautest one is just taut, or was on the other diagonal of its panel.
                    EXPECT_GT(strain, -1e-3) << type << gores << columns;
                    double twice = 0.0;
                    const auto& ring = mesh.seam_rings.back();
                    const int nodes = gores * columns;
                    for (int k = 0; k < nodes; ++k) {
                        const Vec3 &p = mesh.position[ring.front() + k],
                                   &q = mesh.position[ring.front() + (k + 1) % nodes];
                        twice += p.x() * q.y() - p.y() * q.x();
                    }
                    EXPECT_NEAR(0.5 * std::abs(twice), mouth, 1e-8) << type << gores << columns;
                    // Seams hang straight, all but as long as they are: cos(pi/gores) without pleats.
                    double along = 0.0, cut = 0.0;
                    for (const Cable& c : mesh.cables)
                        if (c.kind == CableKind::radial) {
                            along += (mesh.position[c.node[0]] - mesh.position[c.node[1]]).norm();
                            cut += c.rest_length;
                        }
                    RecordProperty(std::string(type) + std::to_string(columns), std::to_string(along / cut));
                    EXPECT_GT(along / cut, gores == 8 ? 0.85 : 0.985) << type << gores << columns;
                }
}

TEST(PanelledCanopy, GoresAreAlike) {
    for (const char* type : panelled_types)
        for (const int columns : {1, 2, 4}) {
            const Parachute chute = canopy_of_type(type);
            std::string why;
            EXPECT_TRUE(find_gores(make_gore_mesh(chute, {columns, 9, 5, 2}, 152.4, Vec3::UnitZ(),
                                                  mouth_area_at_line_stretch(chute), 900.0),
                                   &why))
                << type << columns << why;
        }
}

}  // namespace
}  // namespace twinchute::fullsim
