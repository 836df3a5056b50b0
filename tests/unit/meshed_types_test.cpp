// Which types of canopy the full model may mesh as flat circular ones, and what it says of the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/needs.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

using Keys = std::vector<std::string>;

Scene of_type(const std::string& type) {
    return read_text(good_scene, {"parachute.type=" + type});
}

TEST(MeshedTypes, EachTypeSaysWhatIsMeshedForIt) {
    // Solid canopies that are sewn of full gores; whatever else has slots, arms, ribs or an open middle.
    const std::set<std::string> stand_ins{"conical",           "biconical",         "triconical",
                                          "extended-skirt-10", "extended-skirt-14", "hemispherical"};
    for (const std::string& name : canopy_type_names(TWINCHUTE_SOURCE_DIR "/data")) {
        const Scene scene = of_type(name);
        const Parachute& chute = scene.parachutes.front();
        EXPECT_FALSE(chute.type->meshed.why.empty()) << name;
        const Keys lacking = fullsim::full_fidelity().unsupported_keys(scene);
        const bool refused = name != "flat-circular" && !stand_ins.contains(name);
        EXPECT_EQ(lacking, refused ? Keys{"parachute.type"} : Keys{}) << name;
        EXPECT_EQ(stand_in(chute).has_value(), stand_ins.contains(name)) << name;
        EXPECT_TRUE(rom::rom_fidelity().unsupported_keys(scene).empty()) << name;
    }
}

TEST(MeshedTypes, ARefusalNamesTheTypeAndItsReason) {
    EXPECT_EQ(unsupported_text(of_type("cross"), {"parachute.type"}),
              "it lacks the physics of 'parachute.type' (cross: two crossed strips with lines along their "
              "ends, open between the arms)");
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
