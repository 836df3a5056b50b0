// The fingerprint of a scene: another one for everything that a run sees, the same for what it does not.
#include <gtest/gtest.h>

#include <set>

#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_digest.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

Scene scene(const std::vector<std::string>& more = {}) {
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml", more);
}

TEST(SceneDigest, KnowsEveryKeyThatIsGiven) {
    std::set<std::string> seen{scene_digest(scene())};
    std::size_t count = 1;
    for (const char* key :
         {"payload.mass=153", "release.height='301 m'", "release.speed=20", "environment.gravity=9.8",
          "parachute.deploy.by='inflated'", "parachute.fill_time.n=4.1",
          "aerodynamics.breathing_damping.k=0.4", "stop.time=3", "stop.then='rom'", "rom.rtol=1e-7",
          "full.mesh.gore_rows=16", "full.symmetry='sector'", "full.contact='none'",
          "full.noise={amplitude=1e-3}", "full.noise={amplitude=1e-3,seed=2}", "full.output_rate=100",
          "full.fields_rate=10", "full.time_step_factor=0.9", "full.line_substeps=3"}) {
        EXPECT_TRUE(seen.insert(scene_digest(scene({key}))).second) << key;
        ++count;
    }
    EXPECT_EQ(seen.size(), count);
}

TEST(SceneDigest, KnowsWhatMaterialsAndTablesHold) {
    // A scene names them; what counts is what stands in them.
    Scene one = scene();
    const std::string before = scene_digest(one);
    one.parachutes.front().fabric.youngs_modulus *= 1.0 + 1e-15;
    EXPECT_NE(scene_digest(one), before);
    one = scene();
    one.parachutes.front().line.diameter *= 1.0 + 1e-15;
    EXPECT_NE(scene_digest(one), before);
    const ScratchDir here;
    here.write("scene.toml", "base = \"c9-inflation.toml\"\nenvironment.wind = { table = \"wind.csv\" }\n");
    std::set<std::string> seen;
    for (const char* speed : {"5", "6"}) {
        here.write("wind.csv", std::string("altitude,speed,from\nm,m/s,deg\n0,3,0\n400,") + speed + ",0\n");
        seen.insert(scene_digest(read_scene(here / "scene.toml")));
    }
    EXPECT_EQ(seen.size(), 2u);
}

TEST(SceneDigest, DoesNotKnowWhatNoRunSees) {
    const std::string before = scene_digest(scene());
    EXPECT_EQ(scene_digest(scene()), before);
    EXPECT_EQ(scene_digest(scene({"full.checkpoint_interval=7"})), before);
    EXPECT_EQ(scene_digest(scene({"compare.tolerance.peak_force='1 %'"})), before);
    Scene moved = scene();
    moved.file = "elsewhere.toml";
    EXPECT_EQ(scene_digest(moved), before);
}

}  // namespace
}  // namespace twinchute
