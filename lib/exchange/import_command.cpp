#include "lib/exchange/import_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/exchange/packed_file.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/short_lived_directory.hpp"
#include "lib/scene/published_sounding.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {
namespace {

namespace fs = std::filesystem;

/// Nobody else's file is overwritten: a scene of ours says so in its first line.
void check_import_target(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return;
    std::string head(import_mark.size(), '\0');
    if (fs::is_regular_file(file, ignored)) {  // a pipe would be waited for
        if (fs::is_empty(file, ignored)) return;
        std::ifstream stream(file, std::ios::binary);
        stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    }
    if (head != import_mark)
        throw UsageError(
            fmt::format("'{}' was not written by `twinchute import` (nothing else is overwritten), name "
                        "another file with --out",
                        file.string()));
}

std::optional<fs::path> wanted_scene_file(const Arguments& arguments) {
    const auto text = arguments.value("out");
    if (!text) return {};
    const fs::path file = *text;
    if (file.extension() != ".toml" || file.stem().empty())
        throw UsageError(fmt::format(
            "'--out {}' is not understood (the name of a .toml file is wanted), e.g. --out rocket.toml",
            *text));
    check_import_target(file);
    return file;
}

ImportedScene read_any(const std::string& file, const ImportChoice& choice) {
    std::string text = read_packed_file(file, ".ork");
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const char c = first == std::string::npos ? '\0' : text[first];
    if (c == '<') return read_open_rocket(text, file, choice);
    if (c == '{' || c == '[') return read_rocketpy(text, file, choice);
    if (is_published_sounding(text))
        throw SceneError(
            {file, 0, 0}, "", "is a sounding", "scenes read soundings as they were published",
            fmt::format(
                "write atmosphere = {{ table = \"{}\" }} and wind = {{ table = \"{}\" }} in the scene",
                fs::path(file).filename().string(), fs::path(file).filename().string()));
    throw SceneError({file, 0, 0}, "", "is not understood",
                     "neither XML, as OpenRocket writes it, nor JSON, as RocketPy does",
                     "name an OpenRocket design (.ork) or a flight that RocketPy saved (.rpy)");
}

/// The imported scene, flown once.
struct Check {
    Scene scene;
    RunStatus status;
    std::optional<double> landing_speed, descent_rate;  ///< [m/s] at the ground: over it, and downward

    /// Against what the file states.
    std::optional<double> relative(const ImportedScene& imported) const {
        if (!landing_speed || !imported.stated_landing_speed) return {};
        return (imported.stated_over_ground ? *landing_speed : *descent_rate) /
                   *imported.stated_landing_speed -
               1.0;
    }
};

Check fly(const ImportedScene& imported, const std::string& text, const std::string& name,
          const fs::path& directory, const std::string& wind_table, const Fidelity& rom) {
    Check check;
    if (wind_table.empty()) {
        check.scene = read_scene_text(text, name, directory);
    } else {
        const ShortLivedDirectory beside;
        replace_file(beside.path() / wind_table, wind_table_text(imported.wind));
        check.scene = read_scene_text(text, name, beside.path());
    }
    Run run;
    const RunRecord record = rom.run(check.scene, run);
    check.status = record.status;
    const bool landed = std::ranges::any_of(record.events, [](const Event& e) { return e.name == "ground"; });
    const auto last_of = [&](std::string_view wanted) -> std::optional<double> {
        const auto channel = std::ranges::find(record.channels, wanted, &Channel::name);
        if (!landed || channel == record.channels.end() || channel->values.empty()) return {};
        return std::abs(channel->values.back());
    };
    check.landing_speed = last_of("speed");
    check.descent_rate = last_of("vertical_speed");
    return check;
}

std::string landing_text(const ImportedScene& imported, const Check& check) {
    if (!check.landing_speed) return fmt::format("landing   none: {}\n", printable(check.status.detail));
    std::string text =
        fmt::format("landing   {} m/s downward, {} m/s over ground, by the reduced-order model",
                    readable(*check.descent_rate), readable(*check.landing_speed));
    if (const auto relative = check.relative(imported))
        text += fmt::format("\n          {} states {} m/s {} ({}): {:+.1f} %", printable(imported.program),
                            readable(*imported.stated_landing_speed),
                            imported.stated_over_ground ? "over ground" : "downward", imported.stated_by,
                            100.0 * *relative);
    return text + "\n";
}

std::string import_text(const ImportedScene& imported, const Check& check, const Style& style) {
    std::string text = fmt::format("{}  from {}\n", style.paint(printable(check.scene.name), Colour::bold),
                                   printable(imported.program));
    if (!imported.taken.empty()) text += printable(imported.taken) + "\n";
    Table table;
    for (const ImportedTable& part : imported.tables)
        for (const ImportedKey& key : part.keys)
            table.rows.push_back(
                {part.path.empty() ? key.key : fmt::format("{}.{}", part.path, key.key),
                 printable(key.value.size() > 60 ? key.value.substr(0, 57) + "..." : key.value),
                 printable(key.comment)});
    if (imported.wind.size() > 1)
        table.rows.push_back({"environment.wind", fmt::format("{} levels", imported.wind.size()), ""});
    text += "\ntaken over\n" + aligned(table, style, 2);
    const auto list = [&](std::string_view head, const std::vector<std::string>& entries) {
        if (!entries.empty()) text += fmt::format("\n{}\n", head);
        for (const std::string& entry : entries)
            text += fmt::format("  - {}\n", printable(entry));
    };
    list("assumed", imported.assumptions);
    list("not taken over", imported.left_out);
    return text + "\n" + landing_text(imported, check);
}

std::string import_json(const ImportedScene& imported, const Check& check, const std::string& file,
                        const std::optional<fs::path>& out) {
    nlohmann::ordered_json json{
        {"generator", "twinchute"}, {"file", file}, {"program", imported.program}, {"taken", imported.taken}};
    if (out) json["scene"] = out->string();
    nlohmann::ordered_json keys = nlohmann::ordered_json::object();
    for (const ImportedTable& part : imported.tables)
        for (const ImportedKey& key : part.keys)
            keys[part.path.empty() ? key.key : fmt::format("{}.{}", part.path, key.key)] = key.value;
    json["keys"] = std::move(keys);
    json["assumptions"] = imported.assumptions;
    json["left_out"] = imported.left_out;
    json["status"] = status_json(check.status);
    if (check.landing_speed) json["landing_speed_m_s"] = *check.landing_speed;
    if (check.descent_rate) json["descent_rate_m_s"] = *check.descent_rate;
    if (imported.stated_landing_speed)
        json[imported.stated_over_ground ? "stated_landing_speed_m_s" : "stated_descent_rate_m_s"] =
            *imported.stated_landing_speed;
    if (const auto relative = check.relative(imported)) json["relative"] = *relative;
    return json_text(json);
}

ExitCode run_import(const Arguments& arguments, const Fidelity& rom) {
    const std::optional<fs::path> out = wanted_scene_file(arguments);
    ImportedScene imported =
        read_any(arguments.operand, {arguments.values("device"), arguments.value("simulation").value_or("")});
    set_keys(imported, arguments.values("set"));
    if (const auto missing = missing_values(imported); !missing.empty())
        throw UsageError(
            fmt::format("{}: a scene needs what this file does not say: {}. Give it with --set, e.g. --set "
                        "{}='...'",
                        arguments.operand, fmt::join(missing, "; "),
                        missing.front().substr(0, missing.front().find(' '))));
    std::string wind_table;
    if (imported.wind.size() > 1) {
        if (out) {
            wind_table = fmt::format("{}-wind.csv", out->stem().string());
            const fs::path beside = out->parent_path() / wind_table;
            if (fs::exists(beside) && !fs::exists(*out))
                throw UsageError(
                    fmt::format("'{}' is there already (the wind of this scene would go there), name "
                                "another file with --out",
                                beside.string()));
        } else {
            imported.left_out.push_back(
                "wind by altitude: it is a file beside the scene, which --out names; the air is "
                "at rest");
        }
    }
    const std::string text =
        scene_text(imported, fs::path(arguments.operand).filename().string(), wind_table);
    const std::string name = out ? out->string() : fmt::format("the scene made from {}", arguments.operand);
    const Check check = fly(imported, text, name, out ? out->parent_path() : fs::path(), wind_table, rom);
    if (const ExitCode code = exit_code(check.status.code);
        code == ExitCode::usage || code == ExitCode::numerical)
        throw UsageError(fmt::format("{}: the scene made from it does not run ({}), give keys with --set",
                                     arguments.operand, check.status.detail));
    if (out && !arguments.has("check")) {
        FileBatch batch;
        if (!wind_table.empty()) batch.add(out->parent_path() / wind_table, wind_table_text(imported.wind));
        batch.add(*out, text, FileBatch::Kind::marker);
        batch.commit();
    }
    if (arguments.has("json"))
        print(import_json(imported, check, arguments.operand, out));
    else if (!arguments.has("quiet") && !out && !arguments.has("check"))
        print(text);
    else if (!arguments.has("quiet"))
        print(import_text(imported, check, output_style()) +
              (arguments.has("check") ? "nothing was written\n"
                                      : fmt::format("scene     {}\n", printable(out->string()))));
    return exit_code(check.status.code);
}

}  // namespace

Command import_command(const Fidelity& rom) {
    Command command;
    command.name = "import";
    command.summary = "a scene from an OpenRocket design or RocketPy's parachutes";
    command.operand = "FILE";
    command.example = "twinchute import data/import/rocket-dual-deploy.ork";
    command.options = {
        {"out", "FILE",
         "write the scene there, a .toml file, and say what was taken over; without it print the scene"},
        {"device", "NAME",
         "take this recovery device, by its name in the file, in place of all that fall together", true},
        {"simulation", "NAME",
         "take conditions and stored flight of this simulation, not of the first that has a flight"},
        {"set", "KEY=VALUE", "give a key of the scene, e.g. payload.mass='1.2 kg'", true},
        {"check", "", "say what would be taken over and write nothing"},
        {"json", "", "print what was taken over as JSON and nothing else"},
        {"quiet", "", "print nothing but errors"},
    };
    command.run = [&rom](const Arguments& arguments) { return run_import(arguments, rom); };
    return command;
}

}  // namespace twinchute::exchange
