// Which types of canopy the full model meshes, what may stand in for others, and which it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "fullsim/forces/blocks.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/opening.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

using Keys = std::vector<std::string>;

Scene of_type(const std::string& type) {
    return read_text(good_scene, {"parachute.type=" + type});
}

TEST(MeshedTypes, EachTypeSaysWhatIsMeshedForIt) {
    // Canopies that are sewn of full gores, and those with narrow slots where the scene says how much of
    // them, and those around an open middle; crosses, without the vent of this scene; whatever
    // else has ribs or panels that are cut full is not.
    std::set<std::string> meshed(std::begin(panelled_types), std::end(panelled_types));
    meshed.insert("annular");
    meshed.insert("flat-circular");
    for (const std::string& name : canopy_type_names(TWINCHUTE_SOURCE_DIR "/data")) {
        const Scene scene = of_type(name);
        const Parachute& chute = scene.parachutes.front();
        EXPECT_FALSE(chute.type->meshed.why.empty()) << name;
        const Keys lacking = fullsim::full_fidelity().unsupported_keys(scene);
        const bool slots = std::ranges::count(slotted_types, name) > 0;
        EXPECT_EQ(lacking, name == "cross"         ? Keys{"parachute.vent_diameter"}
                           : slots                 ? Keys{"parachute.geometric_porosity"}
                           : meshed.contains(name) ? Keys{}
                                                   : Keys{"parachute.type"})
            << name;
        EXPECT_FALSE(stand_in(chute)) << name;
        EXPECT_TRUE(rom::rom_fidelity().unsupported_keys(scene).empty()) << name;
    }
}

TEST(MeshedTypes, SlotsAreWhatTheVentLeavesOfThePorosity) {
    for (const std::string type : slotted_types) {
        const auto with = [&](double porosity) {
            return read_text(good_scene, {"parachute.type=" + type,
                                          "parachute.geometric_porosity=" + std::to_string(porosity)});
        };
        const Scene scene = with(0.2);
        const Parachute& chute = scene.parachutes.front();
        EXPECT_TRUE(fullsim::full_fidelity().unsupported_keys(scene).empty()) << type;
        // A vent of d = 0.853 m in D0 = 8.53 m is 1 % of S0; the other 19 % are slots in 99 %.
        ASSERT_EQ(chute.vent_diameter, 0.1 * chute.nominal_diameter);
        EXPECT_NEAR(slot_share(chute), 0.19 / 0.99, 1e-12) << type;
        EXPECT_NEAR(meshed_fabric(chute).thickness, chute.fabric.thickness * 0.8 / 0.99, 1e-15) << type;
        Scene packed = scene;
        packed.parachutes.front().deploy.drag_coefficient = 0.1;
        EXPECT_NEAR(fullsim::fabric_drag_coefficient(packed), 0.1 * 0.8 / 0.99, 1e-15) << type;
        ASSERT_TRUE(smeared_slots(chute)) << type;
        EXPECT_NE(smeared_slots(chute)->what.find("80.8 %"), std::string::npos) << smeared_slots(chute)->what;
        // No more than the vent.
        EXPECT_EQ(fullsim::full_fidelity().unsupported_keys(with(0.01)),
                  Keys{"parachute.geometric_porosity"});
    }
    const Scene solid = read_text(good_scene, {"parachute.type=conical", "parachute.geometric_porosity=0.2"});
    EXPECT_EQ(slot_share(solid.parachutes.front()), 0.0);
    EXPECT_FALSE(smeared_slots(solid.parachutes.front()));
    EXPECT_EQ(meshed_fabric(solid.parachutes.front()), solid.parachutes.front().fabric);
}

TEST(MeshedTypes, ARefusalNamesTheTypeAndItsReason) {
    const CanopyType type = *of_type("rotafoil").parachutes.front().type;
    EXPECT_EQ(unsupported_text(of_type("rotafoil"), {"parachute.type"}),
              "it lacks the physics of 'parachute.type' (" + type.title + ": " + type.meshed.why + ")");
}

TEST(MeshedTypes, ASlottedTypeNeedsItsPorosity) {
    EXPECT_EQ(
        unsupported_text(of_type("ringslot"), {"parachute.geometric_porosity"}),
        "it needs 'parachute.geometric_porosity' (of vent and slots of a ringslot canopy; the vent alone "
        "has 1 %)");
}

TEST(MeshedTypes, GapsAreSaidAndLeak) {
    Scene scene = of_type("disk-gap-band");
    Parachute& chute = scene.parachutes.front();
    ASSERT_TRUE(has_gaps(chute));
    EXPECT_NE(open_gaps(chute).why.find("disk-gap-band canopies have gaps"), std::string::npos);
    EXPECT_EQ(slot_share(chute), 0.0);
    EXPECT_FALSE(has_gaps(of_type("conical").parachutes.front()));
    // The type's own proportions, with a polygon of n chords in place of each circle: a disk of the radius r,
    // and a gap and a band that stand on its edge.
    const double r = 5.765, n = chute.gores, around = 2.0 * n * r * std::sin(pi / n);
    const double whole = 0.5 * n * r * r * std::sin(2.0 * pi / n) + around * (0.69 + 1.94);
    EXPECT_NEAR(gap_share(chute), around * 0.69 / whole, 1e-12);
    const double S0 = 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;
    EXPECT_NEAR(fullsim::built_mesh(scene).gap_area(), gap_share(chute) * S0, 1e-12 * S0);
    EXPECT_EQ(gap_share(of_type("conical").parachutes.front()), 0.0);
    chute.filling.model = find_filling("predicted");
    EXPECT_TRUE(fullsim::full_fidelity().unsupported_keys(scene).empty());
    // Air leaves through the gap, and through more where the scene says so.
    chute.geometric_porosity = 0.0;
    EXPECT_EQ(filling_canopy(chute).sizes().geometric_porosity, gap_share(chute));
    chute.geometric_porosity = 0.2;
    EXPECT_EQ(filling_canopy(chute).sizes().geometric_porosity, 0.2);
    // Without a number of gores the disk is a circle, its edge 2 pi r: here to the 4e-7 that the sum of
    // sines leaves.
    chute.gores = chute.risers = 0;
    EXPECT_NEAR(gap_share(chute), 2.0 * r * 0.69 / (r * r + 2.0 * r * (0.69 + 1.94)), 1e-6);
}

TEST(MeshedTypes, ATypeThatSaysNothingIsRefused) {
    ScratchDir here;
    here.write("parachutes/types/mine.toml", "title = \"mine\"\n");
    const Scene scene = read_scene_text(edited(good_scene, "design =", "type = \"mine\"\ndesign ="),
                                        "test.toml", here.path());
    EXPECT_EQ(lacks_canopy(scene.parachutes.front()),
              "mine: the type's file does not say that a flat circular canopy may stand in for it");
    here.write("parachutes/types/mine.toml",
               "title = \"mine\"\nfull_model = { canopy = \"round\", why = \"it is\" }\n");
    EXPECT_THROW(read_scene_text(edited(good_scene, "design =", "type = \"mine\"\ndesign ="), "test.toml",
                                 here.path()),
                 SceneError);
}

/// The scene with a type of its own, whose file says this of the full model.
Scene with_own_type(const std::string& full_model, const std::string& keys = "") {
    ScratchDir here;
    here.write("parachutes/types/mine.toml", "title = \"mine\"\nfull_model = { " + full_model + " }\n");
    return read_scene_text(edited(good_scene, "design =", "type = \"mine\"\n" + keys + "design ="),
                           "test.toml", here.path());
}

std::string refusal(const std::string& full_model, const std::string& keys = "") {
    try {
        with_own_type(full_model, keys);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

TEST(MeshedTypes, AGapLiesBetweenPanelsOfFabric) {
    const auto with = [](const char* gaps) {
        return refusal(std::string("canopy = \"own\", why = \"mine\", cone_angle = [0, 1, 1, 1], "
                                   "gore_source = \"me\", gaps = ") +
                       gaps);
    };
    EXPECT_EQ(with("[2]"), "");
    for (const char* wrong : {"[1]", "[4]", "[1.5]", "[5]", "[0]"})
        EXPECT_NE(with(wrong).find("full_model.gaps"), std::string::npos) << wrong << with(wrong);
    EXPECT_NE(with("[2, 3]").find("panels 2 and 3 are gaps"), std::string::npos) << with("[2, 3]");
}

TEST(MeshedTypes, AFlatCircularCanopyMayStandInForAType) {
    const Scene scene = with_own_type("canopy = \"flat-circular\", why = \"a little deeper\"");
    ASSERT_TRUE(stand_in(scene.parachutes.front()));
    EXPECT_EQ(stand_in(scene.parachutes.front())->what, "a flat circular canopy stands in for a mine one");
    EXPECT_TRUE(gore_panels(scene.parachutes.front()).empty());
}

TEST(MeshedTypes, PanelsAreReadWithTheirSource) {
    const Scene scene = with_own_type(
        "canopy = \"own\", why = \"it is\", cone_angle = [\"0 deg\", \"90 deg\"], lower_angle = [\"45 deg\", "
        "\"90 deg\"], panel_length = [2, 1], gore_source = \"here\"");
    const auto panels = gore_panels(scene.parachutes.front());
    ASSERT_EQ(panels.size(), 2u);
    EXPECT_EQ(panels[0], (GorePanel{2.0, 0.0, 0.25 * pi}));
    EXPECT_EQ(panels[1], (GorePanel{1.0, 0.5 * pi, 0.5 * pi}));
    EXPECT_NE(refusal("canopy = \"own\", why = \"it is\", cone_angle = [0.1]").find("gore_source"),
              std::string::npos);
    EXPECT_NE(refusal("canopy = \"own\", why = \"it is\", cone_angle = [0.1], panel_length = [1, 2], "
                      "gore_source = \"here\"")
                  .find("panel_length: 2 of 1 panels"),
              std::string::npos);
}

TEST(MeshedTypes, AnglesOfOnesOwnStandInPlaceOfTheTypes) {
    const Scene own =
        read_text(good_scene, {"parachute.type=triconical", "parachute.cone_angle=[0.25, 0.5, 0.75]",
                               "parachute.panel_length=[3, 2, 1]"});
    const auto panels = gore_panels(own.parachutes.front());
    ASSERT_EQ(panels.size(), 3u);
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(panels[static_cast<std::size_t>(i)], (GorePanel{3.0 - i, 0.25 * (i + 1), 0.25 * (i + 1)}));
}

TEST(MeshedTypes, AnglesThatMakeNoCanopyAreRefusedByKey) {
    const auto refused = [](const std::vector<std::string>& keys) -> std::string {
        try {
            read_text(good_scene, keys);
        } catch (const SceneError& error) {
            return error.what();
        }
        return "";
    };
    const auto expect = [&](const std::vector<std::string>& keys, const char* text) {
        EXPECT_NE(refused(keys).find(text), std::string::npos) << refused(keys);
    };
    expect({"parachute.cone_angle=[0.1]"}, "cone_angle.1: there are no panels");
    expect({"parachute.type=ringslot", "parachute.panel_length=[1]"}, "panel_length.1: there are no panels");
    expect({"parachute.type=conical", "parachute.cone_angle=[0.1, 0.2]"}, "cone_angle.1: 2 of 1 panels");
    expect({"parachute.type=hemispherical", "parachute.cone_angle=[0.1]"}, "its panels are no cones");
    expect({"parachute.type=conical", "parachute.cone_angle=[1.57]"},
           "vent_diameter: the vent reaches beyond");
    expect({"parachute.type=biconical", "parachute.panel_length=[1, 20]"}, "vent_diameter: the vent reaches");
    expect({"parachute.type=biconical", "parachute.cone_angle=[0.1, 3]", "parachute.panel_length=[1, 1]"},
           "cone_angle.1: panel 2 closes the canopy");
    expect({"parachute.type=triconical", "full.mesh.gore_rows=2"}, "gore_rows: 2 for 3 panels");
    EXPECT_EQ(refused({"parachute.type=biconical", "full.mesh.gore_rows=2"}), "");
}

TEST(MeshedTypes, AMeshOfOnesOwnIsNeitherRefusedNorWarnedOf) {
    for (const char* type : {"cross", "conical"}) {
        const Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-window.toml",
                                       {std::string("parachute.type=") + type});
        ASSERT_TRUE(scene.parachutes.front().mesh);
        EXPECT_TRUE(fullsim::full_fidelity().unsupported_keys(scene).empty()) << type;
        EXPECT_FALSE(stand_in(scene.parachutes.front())) << type;
    }
}

}  // namespace
}  // namespace twinchute::test
