#include "lib/exchange/export_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/exchange/flight_map.hpp"
#include "lib/exchange/imported_scene.hpp"
#include "lib/math/vec.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/trigger.hpp"
#include "lib/solve/hand_over.hpp"

namespace twinchute::exchange {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view export_mark = "Exported by twinchute";

/// A format that --to names.
struct ExportFormat {
    std::string_view name, extension;
    bool on_map = false;  ///< it needs --position
};

constexpr ExportFormat export_formats[] = {
    {"rocketpy", ".py"}, {"kml", ".kml", true}, {"geojson", ".geojson", true}};

/// Nobody else's file is overwritten: one of ours says so at its head.
void check_export_target(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return;
    std::string head(256, '\0');
    if (fs::is_regular_file(file, ignored)) {  // a pipe would be waited for
        if (fs::is_empty(file, ignored)) return;
        std::ifstream stream(file, std::ios::binary);
        stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    }
    if (head.find(export_mark) == std::string::npos)
        throw UsageError(
            fmt::format("'{}' was not written by `twinchute export` (nothing else is overwritten), name "
                        "another file with --out",
                        file.string()));
}

/// RocketPy's trigger as Python, and what is to be said about it.
struct RocketPyTrigger {
    std::string python, comment;
};

RocketPyTrigger trigger_of(const Scene& scene, const Parachute& chute) {
    if (!chute.deploy_when || chute.deploy_when->kind == Trigger::Kind::release)
        return {"\"apogee\"",
                "the scene deploys at release, which RocketPy does not know: apogee in its place"};
    const Trigger& when = *chute.deploy_when;
    if (when.kind == Trigger::Kind::apogee) return {"\"apogee\"", ""};
    if (when.kind == Trigger::Kind::altitude)
        return {fmt::format("{:.6g}", when.value - scene.environment.ground), "m above ground"};
    throw UsageError(fmt::format(
        "{}: '{}' deploys by a condition that RocketPy does not have (it has apogee and a height), "
        "give deploy.when one of these",
        scene.file.string(), printable(chute.name)));
}

/// A metric of one parachute: with several, their names stand before it.
std::optional<double> metric_of(const RunRecord& record, const Scene& scene, const Parachute& chute,
                                const std::string& key) {
    if (scene.parachutes.size() == 1) return record.metric(key);
    return record.metric(metric_head(chute.name) + key);
}

std::string python_name(const std::string& name) {
    constexpr std::array<std::string_view, 35> keywords{
        "False", "None",     "True",  "and",    "as",   "assert", "async",  "await",    "break",
        "class", "continue", "def",   "del",    "elif", "else",   "except", "finally",  "for",
        "from",  "global",   "if",    "import", "in",   "is",     "lambda", "nonlocal", "not",
        "or",    "pass",     "raise", "return", "try",  "while",  "with",   "yield"};
    std::string out;
    for (const char c : name)
        out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    const bool is_name =
        !out.empty() && !(out[0] >= '0' && out[0] <= '9') && std::ranges::count(keywords, out) == 0;
    return is_name ? out : "parachute_" + out;
}

/// RocketPy flies under the parachute that opened last, and drops it where another opens.
bool opens_before_another(const Scene& scene, const RunRecord& record, const Parachute& chute) {
    const auto snatch = metric_of(record, scene, chute, "snatch_time_s");
    return snatch && std::ranges::any_of(scene.parachutes, [&](const Parachute& other) {
               return metric_of(record, scene, other, "snatch_time_s").value_or(*snatch) > *snatch;
           });
}

std::string parachute_text(const Scene& scene, const RunRecord& record, const Parachute& chute) {
    const RocketPyTrigger trigger = trigger_of(scene, chute);
    // A lag is a fall without drag, which a reefed canopy has.
    const std::string stage = chute.reefing.empty() ? "" : fmt::format("stage_{}_", chute.reefing.size() + 1);
    const std::optional<double> filling = metric_of(record, scene, chute, stage + "filling_time_s");
    const double delay = chute.deploy_when ? chute.deploy_when->delay : 0.0;
    std::string text;
    const auto left_out = [&](bool there, std::string_view what) {
        if (there) text += fmt::format("# left out: {}\n", what);
    };
    text += fmt::format("\n# {}\n", one_line(chute.name));
    left_out(!chute.reefing.empty(),
             "reefing; the parachute opens in one, within the filling time of its last stage");
    left_out(chute.cut.has_value(), "cut; RocketPy drops a parachute where the next one opens");
    left_out(!chute.cut && opens_before_another(scene, record, chute),
             "its drag once the next parachute is open; RocketPy then drops it, this scene keeps both");
    left_out(chute.deploy.starts_packed(), "deployment from the pack; its time is not in lag");
    left_out(chute.drag_area_mach_table.has_value(), "drag area by Mach number");
    left_out(!chute.lag.empty(), "lags within the cluster");
    left_out(chute.skips_reefing > 0, "canopies that skip their reefing");
    left_out(chute.calibration.has_value(), "calibration of the reduced-order model against full runs");
    left_out(!filling, "filling time: the parachute does not open in this scene");
    const double drag_area = chute.count * chute.cluster_drag_ratio * chute.drag_area;
    const std::string of_cluster = chute.count > 1 ? fmt::format(", {} canopies", chute.count) : "";
    text += fmt::format("{} = Parachute(\n    name={},\n", python_name(chute.name), toml_string(chute.name));
    text += fmt::format("    cd_s={:.6g},  # [m2] steady drag area{}\n", drag_area, of_cluster);
    text += fmt::format("    trigger={},{}\n", trigger.python,
                        trigger.comment.empty() ? "" : "  # " + trigger.comment);
    text += "    sampling_rate=100,  # [Hz] RocketPy needs one; our assumption\n";
    text += fmt::format(
        "    lag={:.6g},  # [s] delay {:.4g} s{}\n", delay + filling.value_or(0.0), delay,
        filling ? fmt::format(", then {:.4g} s of filling by the reduced-order model", *filling) : "");
    if (chute.projected_diameter_ratio > 0.0)
        // RocketPy's added mass is that of one canopy and goes by the cube.
        text += fmt::format(
            "    radius={:.6g},  # [m] half of D_p{}; for RocketPy's added mass, its version 1.11 or later\n",
            0.5 * chute.projected_diameter_ratio * chute.nominal_diameter * std::cbrt(chute.count),
            chute.count > 1 ? fmt::format(" times {}^(1/3)", chute.count) : "");
    return text + ")\n";
}

const ExportFormat& wanted_format(const Arguments& arguments) {
    const std::string to = arguments.value("to").value_or("");
    const auto format = std::ranges::find(export_formats, to, &ExportFormat::name);
    if (format == std::end(export_formats))
        throw UsageError(
            to.empty() ? "--to is missing (it names the format), e.g. --to rocketpy"
                       : fmt::format("'--to {}' is not understood (rocketpy, kml and geojson are), e.g. --to "
                                     "rocketpy",
                                     one_line(to)));
    return *format;
}

/// The point that --position names.
std::optional<LocalMap> wanted_map(const Arguments& arguments, const ExportFormat& format) {
    const auto text = arguments.value("position");
    if (!text) {
        if (format.on_map)
            throw UsageError(
                fmt::format("--position is missing (a scene has no geographic position), e.g. --to {} "
                            "--position=47.3,8.5",
                            format.name));
        return {};
    }
    const std::size_t comma = std::min(text->find(','), text->size());
    const auto number = [](std::string_view part, double largest) -> std::optional<double> {
        double value = 0.0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (error != std::errc{} || end != part.data() + part.size() || !(std::abs(value) <= largest))
            return {};
        return value;
    };
    const std::string_view all = *text;
    const auto latitude = number(all.substr(0, comma), 85.0);
    const auto longitude = number(all.substr(std::min(comma + 1, all.size())), 360.0);
    if (!latitude || !longitude || !format.on_map)
        throw UsageError(
            format.on_map
                ? fmt::format("'--position {}' is not understood (latitude and longitude of the release in "
                              "degrees are wanted, to 85 deg from the equator), e.g. --position=47.3,8.5",
                              one_line(*text))
                : fmt::format("--position is of no use to '{}' (it draws no map), leave it out",
                              format.name));
    return LocalMap(*latitude * pi / 180.0, *longitude * pi / 180.0);
}

std::optional<fs::path> wanted_export_file(const Arguments& arguments, const ExportFormat& format) {
    const auto text = arguments.value("out");
    if (!text) return {};
    const fs::path out = *text;
    if (out.extension() != format.extension || out.stem().empty())
        throw UsageError(
            fmt::format("'--out {}' is not understood (the name of a {} file is wanted), e.g. --out drop{}",
                        one_line(*text), format.extension, format.extension));
    check_export_target(out);
    return out;
}

ExitCode run_export(const Arguments& arguments, const Fidelity& rom) {
    const ExportFormat& format = wanted_format(arguments);
    const std::optional<LocalMap> map = wanted_map(arguments, format);
    const std::optional<fs::path> out = wanted_export_file(arguments, format);
    const std::vector<Scene> scenes = scenes_of(arguments);
    if (!scenes.front().case_name.empty())
        throw UsageError(
            fmt::format("{}: a series of {} cases where one scene is wanted (one file is made), "
                        "write a scene without [[case]]",
                        scenes.front().file.string(), scenes.size()));
    const Scene& scene = scenes.front();
    require_physics(scene, rom, std::array{&rom});
    if (!map)
        for (const Parachute& chute : scene.parachutes)
            trigger_of(scene, chute);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    Run run;
    const std::array others{&rom};
    const RunRecord record = run_scene(rom, scene, run, others);
    const std::string text = !map                   ? rocketpy_text(scene, record)
                             : format.name == "kml" ? flight_kml(record, *map)
                                                    : flight_geojson(record, *map);
    if (out) {
        replace_file(*out, text);
        if (!arguments.has("quiet")) print(fmt::format("exported  {}\n", printable(out->string())));
    } else if (!arguments.has("quiet")) {
        print(text);
    }
    return exit_code(record.status.code);
}

}  // namespace

std::string rocketpy_text(const Scene& scene, const RunRecord& record) {
    double parachutes = 0.0;
    for (const Parachute& chute : scene.parachutes)
        parachutes += chute.count * chute.mass;
    std::string text = fmt::format("# {} from the scene '{}'.\n", export_mark, one_line(scene.name));
    text += fmt::format(
        "# RocketPy flies the mass of the rocket without propellant: here {:.6g} kg, of which {:.4g} kg "
        "parachutes.\n",
        scene.payload.mass + parachutes, parachutes);
    text +=
        "# Left out, RocketPy opens a parachute at once: growth of the drag area, snatch and opening force";
    text += scene.payload.drag_area ? ", drag of the payload below a parachute.\n" : ".\n";
    if (scene.aerodynamics.added_mass)
        text += "# Left out: added mass as this scene has it; RocketPy has its own, from radius.\n";
    text += "from rocketpy import Parachute\n";
    for (const Parachute& chute : scene.parachutes)
        text += parachute_text(scene, record, chute);
    return text;
}

Command export_command(const Fidelity& rom) {
    Command command;
    command.name = "export";
    command.summary = "parachutes as Python for RocketPy, or the flight as KML or GeoJSON";
    command.operand = "SCENE";
    command.example = "twinchute export data/scenes/rocket-dual-deploy.toml --to rocketpy";
    command.options = {
        {"to", "FORMAT",
         "rocketpy; kml or geojson: trajectory, events and landing point of the reduced-order model"},
        {"position", "LAT,LON", "of the release, in degrees, for kml and geojson, e.g. --position=47.3,8.5"},
        {"out", "FILE", "write there, a .py, .kml or .geojson file, instead of standard output"},
        {"set", "KEY=VALUE", "override a key of the scene, e.g. payload.mass='150 kg'", true},
        {"check", "", "validate the scene and run nothing"},
        {"quiet", "", "print nothing but errors"},
    };
    command.run = [&rom](const Arguments& arguments) { return run_export(arguments, rom); };
    return command;
}

}  // namespace twinchute::exchange
