// Any bytes as a design of OpenRocket, or of RocketPy: a scene that can be read, or a SceneError that names
// the file.
#include "lib/cli/command.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    const std::string_view text = fuzz::text_of(data, size);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    std::string written;
    try {
        exchange::ImportedScene scene = first != std::string_view::npos && text[first] == '<'
                                            ? exchange::read_open_rocket(text, "f", {})
                                            : exchange::read_rocketpy(text, "f", {});
        for (const exchange::ImportedTable& table : scene.tables)
            if (table.path == "parachute") exchange::set_keys(scene, {"parachute.mass=0.1"});
        if (exchange::missing_values(scene).empty()) written = exchange::scene_text(scene, "f", "");
    } catch (const SceneError& error) {
        fuzz::require(error.place().file == "f", "an error names the file");
        return 0;
    }
    if (written.empty()) return 0;
    try {
        read_scene_text(written, "written", ".");
    } catch (const SceneError& error) {
        // A value may be out of range, but what is written is TOML of known keys.
        fuzz::require(std::string_view(error.what()).find("not valid TOML") == std::string_view::npos,
                      error.what());
        fuzz::require(std::string_view(error.what()).find("unknown key") == std::string_view::npos,
                      error.what());
    }
    return 0;
}
