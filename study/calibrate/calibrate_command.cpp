#include "study/calibrate/calibrate_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/calibration.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;

ExitCode run_calibrate(const Arguments& arguments, const Fidelity& rom) {
    if (!arguments.has("to"))
        throw UsageError("--to is missing (it names the test that inputs are fitted to), e.g. --to drop.csv");
    if (arguments.operand == "-")
        throw UsageError(
            "'-' is no scene to calibrate (calibrated.toml names the file that it is based on), save it as a "
            "file");
    CalibrationSettings settings;
    for (const std::string& text : arguments.values("vary"))
        settings.vary.push_back(read_vary(text));
    const std::vector<Scene> scenes = scenes_of(arguments);
    const Scene& scene = scenes.front();
    if (!scene.case_name.empty())
        throw UsageError(
            fmt::format("{}: a series of {} cases where one scene is wanted (tests are of one canopy), "
                        "write a scene without [[case]]",
                        scene.file.string(), scenes.size()));
    require_calibratable(scene, rom);
    std::vector<DropTest> tests;
    for (const std::string& name : arguments.values("to"))
        tests.push_back(read_drop_test(name, scene));
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    const fs::path directory =
        arguments.value("out").value_or(default_output_dir(arguments.operand).string());
    check_output_dir(directory);
    const Interrupt interrupt;
    settings.stop = interrupt.token();
    const SceneWith scene_with = [&](const std::vector<std::string>& more) {
        return scenes_of(arguments, more).front();
    };
    Calibration calibration = calibrate(scene_with, tests, rom, settings);
    if (calibration.interrupted) return ExitCode::interrupted;  // half a fit says nothing

    const std::string json = write_calibration(calibration, scene_with, scene, tests, directory);
    if (arguments.has("json"))
        print(json);
    else if (!arguments.has("quiet"))
        print(calibration_text(calibration, scene, tests, output_style()) +
              fmt::format("scene     {}\nreport    {}\n", printable((directory / "calibrated.toml").string()),
                          printable((directory / "report.html").string())));
    return calibration.is_consistent() ? ExitCode::done : ExitCode::verdict;
}

}  // namespace

void require_calibratable(const Scene& scene, const Fidelity& rom) {
    require_physics(scene, rom, {});
    if (has_calibration(scene))
        throw UsageError(fmt::format(
            "{}: is calibrated already (parachute.calibration), calibrate the scene that it is based on",
            scene.file.string()));
}

StudyWork calibration_work(SceneWith scene_with, Scene scene, std::vector<DropTest> tests,
                           const Fidelity& rom, std::vector<Vary> vary, std::optional<fs::path> directory) {
    return [=, &rom](const std::stop_token& stop, const std::function<void(const Progress&)>&) {
        CalibrationSettings settings;
        settings.vary = vary;
        settings.stop = stop;
        const Calibration found = calibrate(scene_with, tests, rom, settings);
        if (found.interrupted) return StudyResult{.json = {}, .page = {}, .interrupted = true};
        StudyResult result{calibration_json(found, scene, tests), calibration_page(found, scene, tests)};
        if (directory) result.scene_text = calibrated_scene(found, scene, tests, *directory);
        return result;
    };
}

std::string write_calibration(Calibration& calibration, const SceneWith& scene_with, const Scene& scene,
                              const std::vector<DropTest>& tests, const fs::path& directory) {
    FileBatch batch;
    if (is_of_records(tests))
        batch.add(directory / calibration_table_name, calibration_table(calibration, scene_with, tests));
    std::string json = calibration_json(calibration, scene, tests);
    batch.add(directory / "calibrated.toml", calibrated_scene(calibration, scene, tests, directory));
    batch.add(directory / "report.html", calibration_page(calibration, scene, tests));
    batch.add(directory / "calibration.json", json, FileBatch::Kind::marker);
    batch.commit();
    return json;
}

Command calibrate_command(const Fidelity& rom) {
    Command command;
    command.name = "calibrate";
    command.summary = "inputs of a scene from tests, with their uncertainty";
    command.operand = "SCENE.toml";  // calibrated.toml refers to it: no standard input
    command.example =
        "twinchute calibrate data/calibration/c9-drop.toml --to data/calibration/c9-drop-a.toml";
    command.options = scene_options("write the results there instead of ./<scene file>.out");
    command.options.insert(
        command.options.begin(),
        {{"to", "FILE",
          "test to fit to: a CSV file, a TOML file that describes a test, or the directory of a record",
          true},
         {"vary", "KEY[=LO..HI]",
          "fit this input, inside these bounds, in place of fill constant, drag area, initial drag-area "
          "ratio "
          "and exponent",
          true}});
    command.run = [&rom](const Arguments& arguments) { return run_calibrate(arguments, rom); };
    return command;
}

}  // namespace twinchute::study
