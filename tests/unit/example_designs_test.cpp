// Every design in data/parachutes/ through the full model, from each way that it starts; and a design for
// each type that the full model meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/canopy_types.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::fullsim {
namespace {

std::set<std::string> design_names() {
    std::set<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator(TWINCHUTE_SOURCE_DIR "/data/parachutes"))
        if (file.path().extension() == ".toml") names.insert(file.path().stem().string());
    return names;
}

Scene with_design(const std::string& design, const std::string& deploy) {
    std::string text = test::edited(test::good_scene, "design = \"usaf-c9\"", "design = \"" + design + "\"");
    text = test::edited(text, "deploy = { by = \"line-stretch\" }", "deploy = " + deploy);
    return read_scene_text(text, "test.toml", TWINCHUTE_SOURCE_DIR "/data/scenes");
}

TEST(ExampleDesigns, EachMeshedTypeHasOne) {
    std::set<std::string> shown;
    for (const std::string& name : design_names())
        if (const auto type = with_design(name, "{ by = \"line-stretch\" }").parachutes.front().type)
            shown.insert(type->name);
    shown.insert("flat-circular");  // usaf-c9, which names no type
    for (const std::string& name : canopy_type_names(TWINCHUTE_SOURCE_DIR "/data")) {
        const CanopyType type = read_canopy_type(name, "parachute.type", {}, TWINCHUTE_SOURCE_DIR "/data");
        if (type.meshed.shape == MeshedCanopy::Shape::own) {
            EXPECT_TRUE(shown.contains(name)) << name;
        }
    }
}

TEST(ExampleDesigns, WeighWhatTheirMeshWeighs) {
    for (const std::string& name : design_names()) {
        const Scene scene = with_design(name, "{ by = \"line-stretch\" }");
        // A hundredth: masses are printed to three digits; that of the C-9 has lines in place of risers, 3 %.
        EXPECT_NEAR(built_mesh(scene).parachute_mass() / scene.parachutes.front().mass, 1.0,
                    name == "usaf-c9" ? 0.035 : 0.01)
            << name;
    }
}

TEST(ExampleDesigns, FlyFromEachStart) {
    for (const std::string& name : design_names())
        for (const char* deploy :
             {"{ by = \"line-stretch\" }", "{ by = \"inflated\" }", "{ by = \"static-line\", length = 6 }",
              "{ by = \"extraction\", force = 300 }"}) {
            SCOPED_TRACE(name + " " + deploy);
            Scene scene = with_design(name, deploy);
            // An open hemisphere falls into its first shape: at 0.95 of the bound its impacts lose 0.2 % of
            // the energy that changed hands, which ends the run by name.
            scene.full.time_step_factor = 0.5;
            ASSERT_TRUE(full_fidelity().unsupported_keys(scene).empty());
            Simulation simulation(scene);
            for (int step = 0; step < 300; ++step) {
                simulation.evaluate_forces();
                simulation.step_to(1e9);
            }
            const auto fault = simulation.find_fault();
            ASSERT_FALSE(fault) << fault->detail;
            EXPECT_GT(simulation.system().time, 0.0);
            // Nobody holds the payload yet, or the lines do: it has neither stopped nor run away.
            const double speed = to_vec3(simulation.payload().v).norm();
            EXPECT_GT(speed, 15.0);
            EXPECT_LT(speed, 22.0);
        }
}

}  // namespace
}  // namespace twinchute::fullsim
