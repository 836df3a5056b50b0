#include "rom/size/size_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/write_scene.hpp"
#include "rom/fidelity.hpp"
#include "rom/size/size.hpp"
#include "rom/size/size_text.hpp"

namespace twinchute::rom {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "# Sized by twinchute";

/// Nobody else's file is overwritten: a scene of ours says so in its first line.
void check_target(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return;
    std::string head(mark.size(), '\0');
    if (fs::is_regular_file(file, ignored)) {  // a pipe would be waited for
        if (fs::is_empty(file, ignored)) return;
        std::ifstream stream(file, std::ios::binary);
        stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    }
    if (head != mark)
        throw UsageError(
            fmt::format("'{}' was not written by `twinchute size` (nothing else is overwritten), name "
                        "another file with --out",
                        file.string()));
}

std::optional<fs::path> wanted_file(const Arguments& arguments, const std::vector<Scene>& scenes) {
    const auto text = arguments.value("out");
    if (!text) return {};
    fs::path file = *text;
    if (file.extension() != ".toml" || file.stem().empty())
        throw UsageError(fmt::format(
            "'--out {}' is not understood (the name of a .toml file is wanted), e.g. --out sized.toml",
            *text));
    for (const Scene& scene : scenes)
        check_target(directory_of(scene, file.parent_path()) / file.filename());
    return file;
}

void write(const Scene& scene, const Candidate& best, const fs::path& out) {
    FileBatch batch;
    batch.add(directory_of(scene, out.parent_path()) / out.filename(), sized_scene_text(scene, best));
    batch.commit();
}

ExitCode run_size(const Arguments& arguments) {
    choose_units(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments);
    for (const Scene& scene : scenes)
        require_sizable(scene);
    const std::optional<fs::path> out = wanted_file(arguments, scenes);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    const Interrupt interrupt;
    const std::stop_token stop = interrupt.token();
    ExitCode code = ExitCode::done;
    std::vector<std::string> texts;
    for (const Scene& scene : scenes) {
        std::optional<Sized> sized;
        try {
            sized = size_scene(scene, stop);
        } catch (const Interrupted&) {
            return ExitCode::interrupted;  // half a search says nothing
        }
        const Candidate* best = sized->best();
        const bool meets = best != nullptr && best->meets();
        if (!meets) code = gravest(code, ExitCode::verdict);
        if (out && meets) write(scene, *best, *out);
        if (arguments.has("json")) {
            texts.push_back(json_text(size_json(scene, *sized)));
        } else if (!arguments.has("quiet")) {
            print((&scene == &scenes.front() ? "" : "\n") + size_text(scene, *sized, output_style()));
            if (out)
                print(meets ? fmt::format(
                                  "scene     {}\n",
                                  printable(
                                      (directory_of(scene, out->parent_path()) / out->filename()).string()))
                            : "scene     none was written: the limits are not met\n");
        }
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
    return code;
}

}  // namespace

void require_sizable(const Scene& scene) {
    require_physics(scene, rom_fidelity(), {});
    if (!scene.size)
        throw UsageError(
            fmt::format("{}: there is no [size] (it holds the limits), add e.g. [size] with "
                        "max_descent_rate = \"6 m/s\"",
                        scene.file.string()));
    for (const std::string& name : scene.size->vary)
        if (const std::string why = find_vary(name)->why_unavailable(scene); !why.empty())
            throw UsageError(fmt::format("{}: size.vary: '{}' cannot vary ({}), add it or take the word out",
                                         scene.file.string(), name, why));
}

std::string sized_scene_text(const Scene& scene, const Candidate& best) {
    Scene sized = best.found->scene;
    sized.name += ", sized";
    return fmt::format("{} from the scene '{}'.\n", mark, printable(scene.name)) + write_scene(sized);
}

Command size_command() {
    Command command;
    command.name = "size";
    command.summary = "diameter or release speed that meets a descent rate, a force and a deceleration";
    command.operand = "SCENE";
    command.example = "twinchute size data/scenes/sizing/rocket-main.toml";
    command.options = scene_options("write the sized scene there");
    command.options.insert(command.options.begin() + 1, units_option());
    command.options.front().value = "FILE";
    command.run = &run_size;
    return command;
}

}  // namespace twinchute::rom
