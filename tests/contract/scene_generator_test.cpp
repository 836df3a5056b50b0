// Promises of the table of keys, over random scenes made from it: whatever is inside it is
// read, whatever is outside is refused with its place, and a scene that is written reads back the same.
#include <gtest/gtest.h>

#include <set>

#include "fullsim/storage/simd/sanitized.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/support/scene_generator.hpp"

namespace twinchute::test {
namespace {

class GeneratedScenes : public testing::Test {
protected:
    GeneratedScenes() { write_generated_tables(directory_); }
    Scene read(const std::string& text) const {
        return read_scene_text(text, "generated.toml", directory_.path());
    }

    ScratchDir directory_;
};

TEST_F(GeneratedScenes, ValidOnesAreRead) {
    SceneGenerator generator(1);
    std::set<std::string> seen;
    for (int i = 0; i < 2000; ++i) {
        const auto lines = generator.valid();
        for (const SceneLine& line : lines)
            seen.insert(line.path);
        ASSERT_NO_THROW(read(scene_of_lines(lines))) << i << "\n" << scene_of_lines(lines);
    }
    for (const Key& key : scene_keys()) {
        const bool aside = key.path == "base" || key.path.starts_with("case") || key.kind == KeyKind::table ||
                           key.kind == KeyKind::tolerance || key.path.starts_with("parachute.reefing.") ||
                           key.path.starts_with("parachute.deploy.when.") ||
                           key.path.starts_with("parachute.cut.") || key.path == "parachute.panel.fabric" ||
                           key.path == "series.test";  // its columns are named as the metrics are
        EXPECT_TRUE(aside || seen.contains(std::string(key.path))) << key.path << " was never used";
    }
    // Some keys of these are written, as a list or a table in one line.
    for (const char* whole :
         {"parachute.reefing", "parachute.deploy.when", "parachute.cut", "parachute.panel"})
        EXPECT_TRUE(seen.contains(whole)) << whole;
    for (const MetricRow& metric : judgeable_rows())
        EXPECT_TRUE(seen.contains("compare.tolerance." + std::string(metric.name))) << metric.name;
}

TEST_F(GeneratedScenes, BrokenOnesAreRefusedWithTheirPlace) {
    SceneGenerator generator(2);
    for (int i = 0; i < (is_sanitized ? 500 : 2000); ++i) {
        const auto broken = generator.broken();
        try {
            read(broken.text);
            ADD_FAILURE() << broken.what << " was read:\n" << broken.text;
        } catch (const SceneError& error) {
            EXPECT_GT(error.place().line, 0) << broken.what << ": " << error.what();
            EXPECT_GT(error.place().column, 0) << broken.what << ": " << error.what();
            EXPECT_EQ(error.place().file, "generated.toml") << error.what();
        }
    }
}

TEST_F(GeneratedScenes, ReadBackWhatIsWritten) {
    SceneGenerator generator(3);
    for (int i = 0; i < (is_sanitized ? 200 : 500); ++i) {
        const Scene scene = read(scene_of_lines(generator.valid()));
        const std::string text = write_scene(scene);
        const Scene again = read(text);
        ASSERT_TRUE(same_scene(scene, again)) << i << "\n" << text;
        EXPECT_EQ(write_scene(again), text);
    }
}

}  // namespace
}  // namespace twinchute::test
