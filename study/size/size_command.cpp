#include "study/size/size_command.hpp"

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
#include "study/size/size_page.hpp"
#include "study/size/size_text.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;
using rom::Candidate;
using rom::find_vary;
using rom::Interrupted;
using rom::size_scene;
using rom::Sized;

/// Words by which a file of ours is known.
struct Mark {
    std::string_view words;
    std::size_t latest;  ///< place in the file: at its beginning or in its head
};
constexpr Mark scene_mark{"# Sized by twinchute", 0},
    page_mark{R"(name="generator" content="twinchute")", 900};

/// Nobody else's file is overwritten.
void check_target(const fs::path& file, const Mark& mark, std::string_view option) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return;
    std::string head;
    if (fs::is_regular_file(file, ignored)) {  // a pipe would be waited for
        if (fs::is_empty(file, ignored)) return;
        std::ifstream stream(file, std::ios::binary);
        head.resize(1024);
        stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    }
    if (head.find(mark.words) > mark.latest)
        throw UsageError(
            fmt::format("'{}' was not written by `twinchute size` (nothing else is overwritten), name "
                        "another file with --{}",
                        file.string(), option));
}

/// The file of an option for each scene; one a case of a series, in the directory of its name.
struct Target {
    std::optional<fs::path> file;

    Target(const Arguments& arguments, const std::vector<Scene>& scenes, std::string_view option,
           std::string_view extension, const Mark& mark) {
        const auto text = arguments.value(std::string(option));
        if (!text) return;
        file = *text;
        if (file->extension() != extension || file->stem().empty())
            throw UsageError(fmt::format(
                "'--{0} {1}' is not understood (the name of a {2} file is wanted), e.g. --{0} sized{2}",
                option, *text, extension));
        for (const Scene& scene : scenes)
            check_target(of(scene), mark, option);
    }

    fs::path of(const Scene& scene) const {
        return directory_of(scene, file->parent_path()) / file->filename();
    }
};

ExitCode run_size(const Arguments& arguments) {
    choose_units(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments);
    for (const Scene& scene : scenes)
        require_sizable(scene);
    const Target out(arguments, scenes, "out", ".toml", scene_mark),
        report(arguments, scenes, "report", ".html", page_mark);
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
        FileBatch batch;
        try {
            sized = size_scene(scene, stop);
            if (report.file) batch.add(report.of(scene), size_page(scene, *sized, stop));
        } catch (const Interrupted&) {
            return ExitCode::interrupted;  // half a search says nothing
        }
        const Candidate* best = sized->best();
        const bool meets = best != nullptr && best->meets();
        if (!meets) code = gravest(code, ExitCode::verdict);
        if (out.file && meets) batch.add(out.of(scene), sized_scene_text(scene, *best));
        batch.commit();
        if (arguments.has("json")) {
            texts.push_back(json_text(size_json(scene, *sized)));
        } else if (!arguments.has("quiet")) {
            print((&scene == &scenes.front() ? "" : "\n") + size_text(scene, *sized, output_style()));
            if (report.file) print(fmt::format("report    {}\n", printable(report.of(scene).string())));
            if (out.file)
                print(meets ? fmt::format("scene     {}\n", printable(out.of(scene).string()))
                            : "scene     none was written: the limits are not met\n");
        }
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
    return code;
}

}  // namespace

void require_sizable(const Scene& scene) {
    require_physics(scene, rom::rom_fidelity(), {});
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

nlohmann::ordered_json sized_json(const Scene& scene, const std::stop_token& stop) {
    require_sizable(scene);
    const Sized sized = size_scene(scene, stop);
    nlohmann::ordered_json json = size_json(scene, sized);
    for (std::size_t i = 0; i < sized.candidates.size(); ++i)
        if (sized.candidates[i].found)
            json["candidates"][i]["scene_text"] = sized_scene_text(scene, sized.candidates[i]);
    return json;
}

std::string sized_scene_text(const Scene& scene, const Candidate& best) {
    Scene sized = best.found->scene;
    sized.name += ", sized";
    return fmt::format("{} from the scene '{}'.\n", scene_mark.words, printable(scene.name)) +
           write_scene(sized);
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
    command.options.insert(command.options.begin() + 1,
                           {"report", "FILE", "write a page about the sizing there"});
    command.run = &run_size;
    return command;
}

}  // namespace twinchute::study
