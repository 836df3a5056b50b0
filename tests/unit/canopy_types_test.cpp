// The catalogue of canopy types, and what a type gives to a scene. Expected values:
// data/reference/parachute_types.csv, Knacke's Tables 5-1 to 5-3 and 5-6 and Fig. 5-51 by transcription.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "lib/math/vec.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

/// A canopy that only its type and its diameter describe.
const std::string typed_scene = R"(schema = 1
name = "typed"
[payload]
mass = 5
[release]
height = 200
speed = 20
path_angle = "90 deg"
[[parachute]]
type = "flat-circular"
nominal_diameter = 2
mass = 0.3
deploy = { by = "line-stretch" }
)";

CanopyType type_of(const std::string& name) {
    return read_canopy_type(name, "type", {}, TWINCHUTE_SOURCE_DIR "/data");
}

/// Cells of the CSV table, by the name of its row.
std::map<std::string, std::vector<std::string>> table_5() {
    std::ifstream file(TWINCHUTE_SOURCE_DIR "/data/reference/parachute_types.csv");
    std::map<std::string, std::vector<std::string>> rows;
    for (std::string line; std::getline(file, line);) {
        std::istringstream cells(line);
        std::vector<std::string> row;
        for (std::string cell; std::getline(cells, cell, ',');)
            row.push_back(cell);
        if (row.size() >= 10 && line[0] != '#') rows[row[0]] = row;
    }
    return rows;
}

void expect_range(const std::optional<TypeRange>& range, const std::string& low, const std::string& high,
                  double unit = 1.0) {
    ASSERT_EQ(range.has_value(), !low.empty());
    if (!range) return;
    // Read from decimal text on both sides; only degrees are converted, hence the last bits.
    EXPECT_NEAR(range->low / unit, std::stod(low), 1e-12);
    EXPECT_NEAR(range->high / unit, std::stod(high), 1e-12);
    EXPECT_FALSE(range->source.empty());
    EXPECT_NE(range->grade, "R");
}

TEST(CanopyTypes, KnackeTables5_1To5_3And5_6) {
    const std::map<std::string, std::string> files{
        {"flat_circular", "flat-circular"},
        {"conical", "conical"},
        {"biconical", "biconical"},
        {"triconical_polyconical", "triconical"},
        {"extended_skirt_10_flat", "extended-skirt-10"},
        {"extended_skirt_14.3_full", "extended-skirt-14"},
        {"hemispherical", "hemispherical"},
        {"guide_surface_ribbed", "guide-surface-ribbed"},
        {"guide_surface_ribless", "guide-surface-ribless"},
        {"annular", "annular"},
        {"cross", "cross"},
        {"flat_ribbon_FIST", "flat-ribbon"},
        {"conical_ribbon", "conical-ribbon"},
        {"ringslot", "ringslot"},
        {"ringsail", "ringsail"},
        {"rotafoil", "rotafoil"},
        {"vortex_ring", "vortex-ring"},
        {"sandia_RFD", "sandia-rfd"},
    };
    auto rows = table_5();
    rows.erase("type");  // the header
    ASSERT_EQ(rows.size(), files.size());
    for (const auto& [row, cell] : rows) {
        SCOPED_TRACE(row);
        const CanopyType type = type_of(files.at(row));
        const auto dash = cell[5].find('-');
        const std::string n = cell[8].substr(0, cell[8].find(' '));  // "5 (R: 4-6)": the recollection is left
        expect_range(type.projected_diameter_ratio, cell[1], cell[2]);
        expect_range(type.drag_coefficient, cell[3], cell[4]);
        expect_range(type.opening_force_coefficient, cell[5].substr(0, dash),
                     dash == std::string::npos ? cell[5] : cell[5].substr(dash + 1));
        expect_range(type.oscillation, cell[6], cell[7], pi / 180.0);
        expect_range(type.fill_constant, n, n);
        expect_range(type.growth_exponent, cell[9], cell[9]);
    }
}

TEST(CanopyTypes, GiveWhatASceneLeavesOut) {
    const Scene scene = read_text(typed_scene);
    const Parachute& p = scene.parachutes.front();
    // Middles of the ranges of Table 5-1, over the nominal area pi/4 2^2.
    EXPECT_NEAR(p.drag_area, 0.775 * pi, 1e-14);
    EXPECT_EQ(p.opening_force_coefficient, 1.7);
    EXPECT_NEAR(p.projected_diameter_ratio, 0.685, 1e-15);
    EXPECT_EQ(p.fill_time.model->name, "fill-constant");
    EXPECT_EQ(p.fill_time.n, 8.0);
    EXPECT_EQ(p.drag_area_law->name, "power-2");
    const Input* input = find_input(scene, "parachute.drag_coefficient");
    ASSERT_NE(input, nullptr);
    EXPECT_EQ(input->origin, InputOrigin::design);
    EXPECT_TRUE(input->source.starts_with("middle of 0.75 to 0.8, flat circular canopies: Knacke"))
        << input->source;
}

TEST(CanopyTypes, SceneAndDesignWin) {
    const std::string n = edited(typed_scene, "mass = 0.3", "mass = 0.3\nfill_time.n = 3\ndrag_area = 2");
    const Parachute p = read_text(n).parachutes.front();
    EXPECT_EQ(p.drag_area, 2.0);
    EXPECT_EQ(p.fill_time.n, 3.0);
    EXPECT_EQ(p.drag_area_law->name, "power-2");
    // The C-9's own C_D S and D_p/D0; it has no fill constant, so that one is of the type.
    const Parachute c9 =
        read_text(edited(typed_scene, "nominal_diameter = 2", "design = \"usaf-c9\"")).parachutes.front();
    EXPECT_EQ(c9.drag_area, 42.56);
    EXPECT_EQ(c9.projected_diameter_ratio, 0.65);
    EXPECT_EQ(c9.fill_time.n, 8.0);
}

TEST(CanopyTypes, FillConstantIsForItsOwnModelAlone) {
    const Parachute given =
        read_text(edited(typed_scene, "mass = 0.3", "mass = 0.3\nfill_time.time = 2")).parachutes.front();
    EXPECT_EQ(given.fill_time.model->name, "given");
    // n = 8 is no constant of t_f = n D0/v^0.85 in feet: 4 would be.
    EXPECT_NE(complaint(edited(typed_scene, "mass = 0.3", "mass = 0.3\nfill_time.model = \"knacke-0.85\""))
                  .find("parachute.fill_time.n: is missing"),
              std::string::npos);
}

TEST(CanopyTypes, DiameterFollowsFromTheDragArea) {
    const Scene scene = read_text(edited(typed_scene, "nominal_diameter = 2", "drag_area = \"10 ft^2\""));
    // D0 = sqrt(4 C_D S/(pi C_D0)), 10 ft^2 = 0.9290304 m^2 exactly, C_D0 = 0.775.
    EXPECT_NEAR(scene.parachutes.front().nominal_diameter, std::sqrt(4.0 * 0.9290304 / (pi * 0.775)), 1e-12);
    EXPECT_EQ(scene.parachutes.front().drag_area, 0.9290304);
}

TEST(CanopyTypes, ARecollectionIsNeverADefault) {
    const std::string bare = edited(typed_scene, "flat-circular", "disk-gap-band");
    EXPECT_NE(
        complaint(bare).find("parachute.drag_coefficient: is missing (of the type 'disk-gap-band' only 0.52 "
                             "to 0.58 is known, by recollection"),
        std::string::npos)
        << complaint(bare);
    const std::string given =
        edited(bare, "mass = 0.3", "mass = 0.3\ndrag_coefficient = 0.5\nfill_time.n = 10");
    EXPECT_FALSE(read_text(given).parachutes.front().opening_force_coefficient);  // 1.3 [R]
    for (const std::string& name : canopy_type_names())
        if (const CanopyType type = type_of(name);
            type.drag_coefficient && type.drag_coefficient->grade == "R") {
            EXPECT_NE(complaint(edited(typed_scene, "flat-circular", name)), "") << name;
        }
}

TEST(CanopyTypes, AreRefusedWhereTheyAreNotKnown) {
    EXPECT_NE(
        complaint(edited(typed_scene, "flat-circular", "flat-circulr")).find("did you mean 'flat-circular'?"),
        std::string::npos);
    EXPECT_NE(complaint(edited(typed_scene, "\"flat-circular\"", "7")), "");
}

TEST(CanopyTypes, AreWrittenAndReadBack) {
    const Scene scene = read_text(typed_scene);
    const Scene again = read_text(write_scene(scene));
    EXPECT_TRUE(same_scene(scene, again));
    EXPECT_EQ(again.parachutes.front().type->name, "flat-circular");
}

TEST(ParachuteParts, AreAskedForOnlyWhereTheyAreNeeded) {
    EXPECT_EQ(read_text(typed_scene).parachutes.front().gores, 0);
    const std::string packed =
        edited(typed_scene, "by = \"line-stretch\"", "by = \"static-line\", length = 3");
    EXPECT_NE(complaint(packed).find("parachute.gores: is missing (a parachute in its pack"),
              std::string::npos)
        << complaint(packed);
    const std::string air = edited(edited(typed_scene, "flat-circular", "ringslot"), "[payload]",
                                   "[aerodynamics]\nadded_mass = {}\n[payload]");
    EXPECT_NE(complaint(air).find("parachute.projected_diameter_ratio: is missing"), std::string::npos)
        << complaint(air);
}

}  // namespace
}  // namespace twinchute::test
