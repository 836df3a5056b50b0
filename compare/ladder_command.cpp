#include "compare/ladder_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "compare/ladder.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/scene/data_files.hpp"

namespace twinchute::compare {
namespace {

/// Where a comparison lies there, too: what brings the ladder into its page.
std::string report_hint(const std::filesystem::path& place) {
    std::error_code ignored;
    if (!std::filesystem::exists(place / "gap.json", ignored)) return {};
    return fmt::format("report    twinchute report {} shows it in report.html\n", printable(place.string()));
}

ExitCode run_ladder(const std::vector<const Fidelity*>& fidelities, const Arguments& arguments) {
    const std::vector<Scene> scenes = scenes_of(arguments);
    LadderOptions options;
    options.seeds = whole_number(arguments, "seeds", options.seeds, 1000, 3);
    options.quick = arguments.has("quick");
    options.threads = threads_of(arguments);
    if (const auto file = arguments.value("reference"))
        options.test = read_test_reference(read_text_file(*file), std::string(*file));
    for (const Scene& scene : scenes)
        for (const Fidelity* fidelity : fidelities)
            require_physics(scene, *fidelity, fidelities);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    const std::filesystem::path directory =
        arguments.value("out").value_or(default_output_dir(arguments.operand).string());
    check_output_dir(directory);

    const Interrupt interrupt;  // until the files are safe
    const bool quiet = arguments.has("quiet");
    ExitCode code = ExitCode::done;
    std::vector<std::string> texts;
    for (const Scene& scene : scenes) {
        const Ladder ladder =
            climb(scene, fidelities, options, [&](const Fidelity& fidelity, const Scene& changed) {
                return run_watched(fidelity, changed, interrupt.token(), quiet, options.threads, nullptr,
                                   nullptr, {}, fidelities);
            });
        const std::filesystem::path place = directory_of(scene, directory);
        FileBatch batch;
        add_ladder(batch, ladder, place);
        batch.commit();
        if (arguments.has("json")) {
            texts.push_back(ladder_json(ladder));
        } else if (!quiet) {
            if (&scene != &scenes.front()) print("\n");
            print(fmt::format("ladder    {}\n\n", printable((place / "ladder.md").string())));
            print(ladder_text(ladder, output_style()));
            print(report_hint(place));
        }
        code = gravest(code, exit_code(ladder));
        if (code == ExitCode::interrupted) break;
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
    return code;
}

}  // namespace

Command ladder_command(std::vector<const Fidelity*> fidelities) {
    Command command;
    command.name = "ladder";
    command.summary = "error against run time, from closed forms to the finest mesh";
    command.operand = "SCENE";
    command.example = "twinchute ladder data/scenes/c9-inflation.toml --quick";
    command.options = scene_options("write table and plot there instead of ./<scene file>.out");
    const auto at = command.options.begin() + 1;
    std::vector<Option> own{
        {"quick", "",
         fmt::format("leave out what costs more than {:g} runs of the scene as it is", quick_cost)},
        {"reference", "FILE.csv",
         "what a test measured: how far each level is from it, beside errors and gaps"},
        {"seeds", "N", "runs with noise of a packed start: medians over N seeds, 3 unless given"}};
    if (std::ranges::any_of(fidelities, &Fidelity::has_threads)) own.push_back(threads_option());
    command.options.insert(at, own.begin(), own.end());
    command.run = [fidelities = std::move(fidelities)](const Arguments& arguments) {
        return run_ladder(fidelities, arguments);
    };
    return command;
}

}  // namespace twinchute::compare
