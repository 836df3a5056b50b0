// Any lines as one --set each, over the demo scene: a scene, or a SceneError.
#include "lib/scene/data_files.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    const std::string directory = TWINCHUTE_SOURCE_DIR "/data/scenes";
    static const std::string scene = read_text_file(directory + "/c9-inflation.toml");
    std::vector<std::string> overrides;
    for (std::string_view text = fuzz::text_of(data, size); !text.empty() && overrides.size() < 8;) {
        const std::size_t end = text.find('\n');
        overrides.emplace_back(text.substr(0, end));
        text = end == text.npos ? "" : text.substr(end + 1);
    }
    try {
        read_scene_text(scene, "c9-inflation.toml", directory, overrides);
    } catch (const SceneError& error) {
        fuzz::require(!error.place().file.empty() && *error.what() != '\0', "an error has a place");
    }
    return 0;
}
