// Any bytes as a scene file: a scene that survives being written and read again, or a SceneError with a
// place.
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    const std::string file = "fuzz.toml", directory = TWINCHUTE_SOURCE_DIR "/data/scenes";
    std::vector<Scene> scenes;
    try {
        scenes = read_scenes_text(fuzz::text_of(data, size), file, directory);
    } catch (const SceneError& error) {
        const SourcePlace& place = error.place();
        fuzz::require(!place.file.empty() && place.line > 0 && place.column > 0, "an error has a place");
        fuzz::require(*error.what() != '\0', "an error says something");
        return 0;
    }
    fuzz::require(!scenes.empty(), "a file without an error holds a scene");
    for (const Scene& scene : scenes) {
        const std::string written = write_scene(scene);
        try {
            const Scene again = read_scene_text(written, file, directory);
            fuzz::require(same_scene(scene, again), "a scene is the same when it is read again");
        } catch (const SceneError& error) {
            std::fprintf(stderr, "%s\n%s\n", error.what(), written.c_str());
            fuzz::require(false, "a scene that was written can be read");
        }
    }
    return 0;
}
