#include "rom/sensitivity/rom_command.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/cli/fidelity_command.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/scene_id.hpp"
#include "rom/fidelity.hpp"
#include "rom/sensitivity/sensitivity.hpp"

namespace twinchute::rom {
namespace {

using nlohmann::ordered_json;

constexpr double doubtful = 0.01;  // [-] of an elasticity: no derivative to rely on
constexpr double nothing = 5e-5;   // [-] would be written 0.0000

std::string cell(const std::optional<Elasticity>& e) {
    if (!e) return "-";
    const double shown = std::abs(e->value) < nothing ? 0.0 : e->value;
    return fmt::format("{}{:.3f}", e->doubt > doubtful ? "~" : "", shown);
}

std::string sensitivity_text(const Scene& scene, const Sensitivity& s, const Style& style) {
    Table table;
    table.header = {"input", "value", ""};
    table.right = {false, true, false};
    for (const std::string& metric : s.metrics) {
        table.header.push_back(metric_words(metric));
        table.right.push_back(true);
    }
    bool any_doubt = false;
    for (const InputSensitivity& input : s.inputs) {
        if (input.largest() < nothing) continue;
        const Shown input_value = shown(input.value, input.unit);
        std::vector<std::string> cells{input.key, readable(input_value.value), std::string(input_value.unit)};
        for (const auto& e : input.of) {
            cells.push_back(cell(e));
            any_doubt = any_doubt || (e && e->doubt > doubtful);
        }
        table.rows.push_back(std::move(cells));
    }
    std::string text = fmt::format("{}  what the answers hang on, % per %\n\n", printable(scene.name));
    text += aligned(table, style);
    std::size_t none = 0;
    for (const InputSensitivity& input : s.inputs)
        none += input.largest() < nothing ? 1 : 0;
    if (none > 0) text += fmt::format("\n{} more inputs move nothing here\n", none);
    if (any_doubt) text += "~ a stage or a maximum changes nearby: no derivative to rely on\n";
    return text;
}

ordered_json sensitivity_json(const Scene& scene, const Sensitivity& s) {
    ordered_json json;
    json["generator"] = "twinchute";
    json["scene"] = scene_json(scene_id(scene));
    for (std::size_t m = 0; m < s.metrics.size(); ++m)
        json["metrics"][s.metrics[m]] = s.values[m];
    json["inputs"] = ordered_json::array();
    for (const InputSensitivity& input : s.inputs) {
        ordered_json row{{"key", input.key}, {"value", input.value}, {"unit", input.unit}};
        for (std::size_t m = 0; m < s.metrics.size(); ++m)
            if (const auto& e = input.of[m])
                row["elasticities"][s.metrics[m]] = {{"value", e->value}, {"doubt", e->doubt}};
        json["inputs"].push_back(std::move(row));
    }
    return json;
}

ExitCode run_sensitivity(const Arguments& arguments, const Fidelity& full) {
    if (arguments.has("out"))
        throw UsageError(
            "--out goes with a record, not with --sensitivity (which writes to standard output "
            "only), take one of them out");
    if (arguments.has("plain-csv"))
        throw UsageError(
            "--plain-csv is for the tables of a record (--sensitivity writes none), take one of them out");
    choose_units(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments);
    for (const Scene& scene : scenes)
        require_physics(scene, rom_fidelity(), std::array{&full});
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    const Interrupt interrupt;
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const SceneWith scene_with = [&](const std::vector<std::string>& more) {
            return scenes_of(arguments, more).at(i);
        };
        const Sensitivity s = sensitivity_of(scene_with, interrupt.token());
        if (interrupt.token().stop_requested()) return ExitCode::interrupted;
        if (arguments.has("json"))
            texts.push_back(json_text(sensitivity_json(scenes[i], s)));
        else if (!arguments.has("quiet"))
            print((i > 0 ? "\n" : "") + sensitivity_text(scenes[i], s, output_style()));
    }
    if (arguments.has("json")) print(joined_json(scenes, texts));
    return ExitCode::done;
}

}  // namespace

Command rom_command(const Fidelity& full, RunReports reports) {
    Command command = fidelity_command(rom_fidelity(), "quick run of the reduced-order model",
                                       DefaultOutput::none, {&full}, std::move(reports));
    command.options.push_back(
        {"sensitivity", "", "print how much the answers hang on each input, % per %, instead of the record"});
    command.run = [&full, run = std::move(command.run)](const Arguments& arguments) {
        return arguments.has("sensitivity") ? run_sensitivity(arguments, full) : run(arguments);
    };
    return command;
}

}  // namespace twinchute::rom
