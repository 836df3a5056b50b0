#include "lib/cli/single_verb.hpp"

#include <fmt/format.h>

#include <optional>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"

namespace twinchute {
namespace {

ExitCode run_single(const Fidelity& fidelity, DefaultOutput output,
                    const std::vector<const Fidelity*>& others, const Arguments& arguments) {
    const std::vector<Scene> scenes = scenes_of(arguments, fields_overrides(arguments, fidelity));
    const int threads = threads_of(arguments);
    for (const Scene& scene : scenes)
        require_physics(scene, fidelity, others);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    std::optional<std::filesystem::path> directory = arguments.value("out");
    if (!directory && output == DefaultOutput::directory) directory = default_output_dir(arguments.operand);
    if (directory) check_output_dir(*directory);

    const Interrupt interrupt;  // until the records are safe
    ExitCode code = ExitCode::done;
    std::vector<std::string> summaries;
    for (const Scene& scene : scenes) {
        const std::filesystem::path place = directory_of(scene, directory.value_or(""));
        FileBatch batch;
        FieldFiles fields(batch, place);
        ShapeFrames frames;
        const RunRecord record =
            run_watched(fidelity, scene, interrupt.token(), arguments.has("quiet"), threads,
                        directory ? &fields : nullptr, directory ? &frames : nullptr);
        if (directory && record.status.code != StatusCode::refused) {
            add_record(batch, record, place, frames);
            batch.commit();
        }
        if (arguments.has("json")) {
            summaries.push_back(summary_json(record));
        } else if (!arguments.has("quiet")) {
            print((&scene == &scenes.front() ? "" : "\n") +
                  record_text(record, fidelity.title, output_style()));
            if (directory) print(fmt::format("record    {}\n", printable((place / "summary.json").string())));
            print(fields_text(fields));
        }
        code = gravest(code, exit_code(record.status.code));
        if (code == ExitCode::interrupted) break;
    }
    if (arguments.has("json")) print(joined_json(scenes, summaries));
    return code;
}

}  // namespace

Verb single_verb(const Fidelity& fidelity, std::string summary, DefaultOutput output,
                 std::vector<const Fidelity*> others) {
    Verb verb;
    verb.name = fidelity.name;
    verb.summary = std::move(summary);
    verb.operand = "SCENE";
    verb.example = fmt::format("twinchute {} data/scenes/c9-inflation.toml", fidelity.name);
    verb.options =
        scene_options(output == DefaultOutput::none ? "also write the record there"
                                                    : "write the record there instead of ./<scene file>.out");
    if (fidelity.gives_fields) verb.options.insert(verb.options.begin() + 1, fields_option());
    if (fidelity.has_threads) verb.options.insert(verb.options.begin() + 1, threads_option());
    verb.run = [&fidelity, output, others = std::move(others)](const Arguments& arguments) {
        return run_single(fidelity, output, others, arguments);
    };
    return verb;
}

}  // namespace twinchute
