// Scenes written and read back, and what must not change a scene: time zone and current directory.
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>

#include "lib/scene/data_files.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

const std::filesystem::path data = TWINCHUTE_SOURCE_DIR "/data";

TEST(WriteScene, ReadsBackEveryShippedScene) {
    for (const std::string& name : data_names("scenes", data))
        for (const Scene& scene : read_scenes(data / "scenes" / (name + ".toml"))) {
            const std::string text = write_scene(scene);
            const Scene again = read_scene_text(text, "again.toml", data / "scenes");
            EXPECT_TRUE(same_scene(scene, again)) << name << "\n" << text;
        }
}

TEST(WriteScene, KeepsWhatIsAwkward) {
    const std::vector<std::string> overrides{"name='tab\\t \"quoted\" \\ \xC3\xA9'",
                                             "payload.mass=0.1",
                                             "release.speed=123456789e-7",
                                             "compare.tolerance.peak_force=7 %",
                                             "compare.tolerance.max_force=0.3 kN",
                                             "compare.tolerance.max_deceleration=0.1 g0",
                                             "compare.tolerance.load_factor='0.1'",
                                             "environment.wind={speed=0.0, from='1 deg'}",
                                             "full.fields_rate='50 Hz'",
                                             "full.mesh.grading='uniform'",
                                             "full.noise={amplitude=1e-13, seed=9000000000000000}"};
    const Scene scene = read_text(good_scene, overrides);
    const Scene again = read_text(write_scene(scene));
    EXPECT_TRUE(same_scene(scene, again)) << write_scene(scene);
    EXPECT_EQ(again.full.noise->seed, 9000000000000000u);
    EXPECT_EQ(again.full.fields_rate, 50.0);
    Scene other = scene;  // the comparison can fail
    other.full.noise->seed += 1;
    EXPECT_FALSE(same_scene(scene, other));
}

TEST(WriteScene, EscapesControlCharacters) {
    Scene scene = read_text(good_scene);
    scene.name = "a\n\x01\x7f\"\\b";
    EXPECT_EQ(read_text(write_scene(scene)).name, scene.name);
}

/// Sets TZ for the life of this object.
class TimeZone {
public:
    explicit TimeZone(const char* zone) {
        if (const char* before = std::getenv("TZ")) before_ = before;
        ::setenv("TZ", zone, 1);
        ::tzset();
    }
    ~TimeZone() {
        before_ ? ::setenv("TZ", before_->c_str(), 1) : ::unsetenv("TZ");
        ::tzset();
    }
    TimeZone(const TimeZone&) = delete;
    TimeZone& operator=(const TimeZone&) = delete;

private:
    std::optional<std::string> before_;
};

TEST(SceneReading, DoesNotDependOnTheTimeZone) {
    const std::string before = write_scene(read_scene(data / "scenes" / "c9-inflation.toml"));
    for (const char* zone : {"Pacific/Kiritimati", "Asia/Kathmandu", "America/St_Johns", "XYZ-3:17"}) {
        const TimeZone here(zone);
        EXPECT_EQ(write_scene(read_scene(data / "scenes" / "c9-inflation.toml")), before) << zone;
    }
}

TEST(SceneReading, DependsOnTheCurrentDirectoryForItsOwnPathOnly) {
    ScratchDir here;
    here.write("scenes/scene.toml",
               "base = \"base.toml\"\nenvironment.atmosphere = { table = \"air.csv\" }\n");
    here.write("scenes/base.toml", good_scene);
    here.write("scenes/air.csv", "altitude,temperature,pressure\nm,K,hPa\n-100,288,1010\n900,283,910\n");
    const Scene absolute = read_scene(here / "scenes/scene.toml");
    const auto before = std::filesystem::current_path();
    std::optional<Scene> from_root, from_inside, relative;
    std::filesystem::current_path("/");
    from_root = read_scene(here / "scenes/scene.toml");
    std::filesystem::current_path(here / "scenes");
    from_inside = read_scene(here / "scenes/scene.toml");
    relative = read_scene("scene.toml");
    std::filesystem::current_path(before);
    for (const auto& scene : {from_root, from_inside, relative}) {
        EXPECT_TRUE(same_scene(*scene, absolute));
        EXPECT_EQ(scene->sha256, absolute.sha256);
    }
    EXPECT_EQ(from_root->file, absolute.file);
    EXPECT_EQ(relative->file, "scene.toml");
}

}  // namespace
}  // namespace twinchute::test
