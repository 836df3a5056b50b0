#include "lib/cli/scene_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "lib/cli/progress.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_id.hpp"
#include "lib/solve/hand_over.hpp"

namespace twinchute {

std::vector<Option> scene_options(std::string out_meaning) {
    return {
        {"out", "DIR", std::move(out_meaning)},
        {"set", "KEY=VALUE", "override a key of the scene, e.g. payload.mass='150 kg'", true},
        {"check", "", "validate the scene and run nothing"},
        {"json", "", "print the summary as JSON and nothing else"},
        {"quiet", "", "print nothing but errors"},
    };
}

Option plain_csv_option() {
    return {"plain-csv", "",
            "write history.csv and events.csv without the line of units, which summary.json then holds"};
}

Option units_option() {
    return {
        "units",
        "SYSTEM",
        "units of the terminal and of report pages, si or us (lbf, ft, ft/s, psf, ...); JSON and CSV stay SI",
        false,
        {"si", "us"}};
}

void choose_units(const Arguments& arguments) {
    const std::string system = arguments.value("units").value_or("si");
    if (system != "si" && system != "us")
        throw UsageError(
            fmt::format("'--units {}' is not understood (si or us is wanted), e.g. --units us", system));
    choose_display_units(system == "us" ? DisplayUnits::us : DisplayUnits::si);
}

CsvHead csv_head(const Arguments& arguments) {
    return arguments.has("plain-csv") ? CsvHead::names : CsvHead::names_and_units;
}

Option fields_option() {
    return {"fields", "RATE", "also write the fields for VTK, frames per simulated second, e.g. 50", false};
}

std::vector<std::string> fields_overrides(const Arguments& arguments, const Fidelity& fidelity) {
    const std::optional<std::string> text = arguments.value("fields");
    if (!text || !fidelity.gives_fields) return {};
    double rate = 0.0;
    const char* const end = text->data() + text->size();
    const auto [rest, error] = std::from_chars(text->data(), end, rate);
    if (error != std::errc{} || rest != end || !std::isfinite(rate) || rate <= 0.0)
        throw UsageError(
            fmt::format("'--fields {}' is not understood (frames per simulated second are wanted, a "
                        "positive number), e.g. --fields 50",
                        *text));
    return {fmt::format("--fields {}.fields_rate={}", fidelity.name, rate)};
}

Option threads_option() {
    return {"threads", "N", "threads that the full model may use, 1 unless given; the answer is the same",
            false};
}

int threads_of(const Arguments& arguments) {
    return whole_number(arguments, "threads", 1, 256, 2);
}

int whole_number(const Arguments& arguments, std::string_view option, int fallback, int max, int example) {
    const std::optional<std::string> text = arguments.value(option);
    if (!text) return fallback;
    int number = 0;
    const char* const end = text->data() + text->size();
    const auto [rest, error] = std::from_chars(text->data(), end, number);
    if (error != std::errc{} || rest != end || number < 1 || number > max)
        throw UsageError(fmt::format(
            "'--{0} {1}' is not understood (a whole number from 1 to {2} is wanted), e.g. --{0} {3}", option,
            *text, max, example));
    return number;
}

std::vector<Scene> scenes_of(const Arguments& arguments, const std::vector<std::string>& more_overrides) {
    std::vector<std::string> overrides = arguments.values("set");
    for (std::string& text : overrides)
        text.insert(0, "--set ");
    overrides.insert(overrides.end(), more_overrides.begin(), more_overrides.end());
    return read_scenes(arguments.operand, overrides);
}

Option parachute_option() {
    return {"parachute", "NAME", "of a scene with several parachutes: which one"};
}

Scene with_one_parachute(Scene scene, const Arguments& arguments) {
    const auto name = arguments.value("parachute");
    if (!name && scene.parachutes.size() == 1) return scene;
    std::vector<std::string_view> names;
    for (const Parachute& chute : scene.parachutes)
        names.push_back(chute.name);
    if (!name)
        throw UsageError(fmt::format("{}: the scene has several parachutes ({}), name one with --parachute",
                                     scene.file.string(), joined(names)));
    const auto chute = std::ranges::find(scene.parachutes, *name, &Parachute::name);
    if (chute == scene.parachutes.end())
        throw UsageError(fmt::format("{}: there is no parachute '{}', {}", scene.file.string(), *name,
                                     suggest(*name, names)));
    scene.parachutes = std::vector{*chute};
    return scene;
}

std::filesystem::path directory_of(const Scene& scene, const std::filesystem::path& directory) {
    return scene.case_name.empty() ? directory : directory / scene.case_name;
}

std::string joined_json(const std::vector<Scene>& scenes, const std::vector<std::string>& texts) {
    if (scenes.front().case_name.empty()) return texts.front();
    std::string all = "[";
    for (const std::string& text : texts)
        all += (all.size() > 1 ? ",\n" : "\n") + text;
    return all + "]\n";
}

void print_each(const Arguments& arguments, const std::vector<Scene>& scenes,
                const std::vector<std::string>& texts) {
    if (arguments.has("json")) {
        print(joined_json(scenes, texts));
    } else if (!arguments.has("quiet")) {
        for (const std::string& text : texts)
            print((&text == &texts.front() ? "" : "\n") + text);
    }
}

ExitCode gravest(ExitCode one, ExitCode other) {
    return std::max(one, other);
}

void require_physics(const Scene& scene, const Fidelity& fidelity, std::span<const Fidelity* const> others) {
    const std::vector<std::string> lacking = fidelity.unsupported_keys(scene);
    if (lacking.empty()) return;
    const std::string& key = lacking.front();
    const auto able = std::ranges::find_if(others, [&](const Fidelity* other) {
        return other->name != fidelity.name && std::ranges::count(other->unsupported_keys(scene), key) == 0;
    });
    const bool given = std::ranges::count(scene.inputs, key, &Input::key) != 0;
    const std::string way_out = able != others.end()
                                    ? fmt::format("run it with `twinchute {}`", (*able)->name)
                                : given ? fmt::format("take '{}' out of the scene", key)
                                        : fmt::format("give '{}'", key);
    throw UsageError(fmt::format("{}: '{}' cannot run this scene ({}), {}", scene.file.string(),
                                 fidelity.name, unsupported_text(scene, lacking), way_out));
}

void say_valid(const std::vector<Scene>& scenes, const Arguments& arguments) {
    std::vector<std::string> texts;
    for (const Scene& scene : scenes) {
        texts.push_back(json_text({{"generator", "twinchute"},
                                   {"scene", scene_json(scene_id(scene))},
                                   {"valid", true},
                                   {"warnings", warnings_json(scene.warnings)}}));
        if (arguments.has("json") || arguments.has("quiet")) continue;
        print(printable(fmt::format("{}: the scene '{}' is valid; nothing was run", scene.file.string(),
                                    scene.name)) +
              "\n" + warnings_text(scene.warnings, "", output_style()));
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
}

RunRecord run_watched(const Fidelity& fidelity, const Scene& scene, std::stop_token stop, bool quiet,
                      int threads, FieldFiles* fields, ShapeFrames* frames, Checkpoints checkpoints,
                      std::span<const Fidelity* const> others) {
    ProgressLine line(fidelity.name, !quiet && progress_is_seen());
    Run run{std::move(stop), line.reporter()};
    run.threads = threads;
    run.checkpoints = std::move(checkpoints);
    if (fields) run.fields = [fields](const VtuGrid& frame) { fields->add(frame); };
    if (frames) run.frames = [frames](ShapeFrames shape) { *frames = std::move(shape); };
    RunRecord record = run_scene(fidelity, scene, run, others);
    if (fields) fields->finish();
    return record;
}

std::string fields_text(const FieldFiles& fields) {
    if (fields.count() == 0) return {};
    return fmt::format("fields    {} ({} {})\n", printable(fields.collection().string()), fields.count(),
                       fields.count() == 1 ? "frame" : "frames");
}

void print(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace twinchute
