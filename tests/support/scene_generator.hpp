// Random scenes, from the table of keys itself: valid ones that use every key somewhere in its range
// and in some unit, and broken ones that differ from a valid one in a single place.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/units.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {

/// One key and its value as they stand in a line of their own.
struct SceneLine {
    std::string path;   ///< e.g. "payload.mass"
    std::string value;  ///< TOML

    bool of_parachute() const { return path.starts_with("parachute."); }
    std::string text() const {
        return fmt::format("{} = {}\n", of_parachute() ? path.substr(10) : path, value);
    }
};

/// A scene as lines: those of the top in any order, then those of [[parachute]].
inline std::string scene_of_lines(const std::vector<SceneLine>& lines) {
    std::string text, parachute = "[[parachute]]\n";
    for (const SceneLine& line : lines)
        (line.of_parachute() ? parachute : text) += line.text();
    return text + parachute;
}

/// The CSV files that generated scenes name, to lie where they are read from.
inline void write_generated_tables(const ScratchDir& directory) {
    directory.write("generated-air.csv",
                    "altitude,temperature,pressure\nm,K,hPa\n-1000,290,1139\n0,285,1013\n5000,250,540\n"
                    "30000,226,12\n86000,190,0.004\n");
    directory.write("generated-wind.csv",
                    "altitude,speed,from\nft,knot,deg\n0,5,270\n3000,25,280\n40000,90,250\n");
    directory.write("generated-froude.csv", "froude_number,fill_constant\n1,1\n0.1,30\n10,8\n1000,6\n");
    directory.write("generated-mass.csv", "fill_constant,mass_ratio\n1,%\n4,1\n9,200\n");
    directory.write("generated-growth.csv",
                    "fill_fraction,drag_area_ratio\n1,%\n0,2\n0.6,30\n1,100\n1.1,115\n1.4,100\n");
    directory.write("generated-attitude.csv", "angle,drag_area\ndeg,ft^2\n0,4\n45,9.5\n90,7\n");
    directory.write("generated-mach.csv", "mach_number,drag_area_factor\n1,%\n0,100\n0.9,110\n1.5,80\n");
    directory.write("generated-calibration.csv",
                    "run,payload_mass,airspeed,air_density,drag_area\n1,kg,m/s,kg/m^3,1\n1,50,15,1.2,0.95\n"
                    "2,200,30,1.1,1.02\n");
    directory.write("generated-mesh.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");  // read by a run alone
    directory.write("generated-force.csv", "time,force\nms,kN\n50,0.5\n300,2\n800,0.1\n");
}

class SceneGenerator : Random {
public:
    explicit SceneGenerator(std::uint64_t seed) : Random(seed) {}

    std::vector<SceneLine> valid();

    struct Broken {
        std::string what;  ///< the kind of mistake and where it is
        std::string text;
    };
    /// One mistake in a valid scene.
    Broken broken();

private:
    double number_of(const Key& key) {
        const double low = std::max(key.range.low, -1e12), high = std::min(key.range.high, 1e12);
        if (!key.range.above_low && random_bool(0.03)) return low;
        return key.range.below_high ? 0.999 * number_in(low, high) : number_in(low, high);
    }

    /// A bare number, or text in some unit of the kind; now and then with its source.
    std::string quantity(double value, std::string_view unit);
    std::string text();
    void decide(const Key& key, std::map<std::string, std::string, std::less<>>& words);
    void put(std::string_view path, std::string value) {
        lines_.push_back({std::string(path), std::move(value)});
    }
    void put_number(std::string_view path, double value) {
        put(path, quantity(value, find_key(scene_keys(), path)->unit));
    }
    void put_release(bool may_rest, bool straight_down);
    void put_extraction();
    void put_canopy();
    void put_vent_lines();
    void put_opening();
    void put_sequence(const std::string& by);
    void put_filling(const std::string& by);
    void put_limits(std::string_view stop);
    void put_tolerances();
    std::optional<std::string> spoiled(const Key& key, std::size_t kind);

    std::vector<SceneLine> lines_;
    double diameter_ = 0.0;           ///< D0 [m]
    std::optional<double> airspeed_;  ///< [m/s] at release, where the generator knows it
    bool has_wind_ = false;
    bool even_gores_ = true;  ///< as a design's
    std::string air_;         ///< model of the atmosphere
};

inline std::string SceneGenerator::quantity(double value, std::string_view unit) {
    static const std::map<std::string_view, std::vector<std::string>> units{
        {"m", {"m", "ft", "km", "cm", "inch", "nmi"}},
        {"kg", {"kg", "g", "lb", "lbm", "oz", "slug"}},
        {"m/s", {"m/s", "ft/s", "fps", "knot", "km/h", "mph"}},
        {"rad", {"rad", "deg", "degree", "arcmin"}},
        {"s", {"s", "ms", "min"}},
        {"m^2", {"m^2", "m2", "ft^2", "cm^2"}},
        {"kg/m^3", {"kg/m^3", "g/cm^3", "lb/ft^3"}},
        {"m/s^2", {"m/s^2", "ft/s^2", "g0"}},
        {"K", {"K", "mK"}},
        {"1", {"%", "percent"}},
        {"1/s", {"1/s", "Hz", "kHz"}},
        {"N", {"N", "kN", "lbf"}},
        {"N/m", {"N/m", "kN/m", "lbf/ft"}},
    };
    std::string written = fmt::format("{}", value);
    if (const auto list = units.find(unit); list != units.end() && random_bool(0.7)) {
        const std::string& chosen = one_of(list->second);
        const double number = value / to_si("1 " + chosen, unit);
        written = fmt::format("\"{}{}{}\"", number, random_bool(0.8) ? " " : "  ", chosen);
    }
    return random_bool(0.1) ? fmt::format("{{ value = {}, source = \"random\", grade = \"C\" }}", written)
                            : written;
}

inline std::string SceneGenerator::text() {
    static const std::vector<std::string> words{"C-9", "5.3", "\xC3\xA9", "\\\"x\\\"", "\\\\b", "= [", "#1"};
    std::string out = one_of(words);
    for (std::size_t i = below(4); i > 0; --i)
        out += " " + one_of(words);
    return "\"" + out + (random_bool(0.5) ? "\\t.\"" : "\"");
}

/// Decides on a key from its row alone, without other keys.
inline void SceneGenerator::decide(const Key& key, std::map<std::string, std::string, std::less<>>& words) {
    const std::string path(key.path);
    if (!key.only_with.empty() && !key.goes_with(words[std::string(selector_of(scene_keys(), key)->path)]))
        return;
    const bool needed = key.need == KeyNeed::required;
    if (!key.choices && !needed && random_bool(0.5)) return;
    std::string value;
    switch (key.kind) {
        case KeyKind::quantity:
            return put_number(path, number_of(key));
        case KeyKind::integer:
            value = fmt::format("{}", static_cast<long long>(std::floor(number_of(key))));
            break;
        case KeyKind::quantity_or_word:
        case KeyKind::word: {
            const std::string word(one_of(key.choices()));
            words[path] = word;
            if (word == key.fallback && random_bool(0.5)) return;
            value = '"' + word + '"';
            break;
        }
        case KeyKind::list:
            value = key.choices ? "[\"release_speed\", \"nominal_diameter\"]" : "[\"cross\", \"ringslot\"]";
            break;
        case KeyKind::mesh_file:
            value = "\"generated-mesh.msh\"";
            break;
        case KeyKind::csv_file:
            value = path.starts_with("environment.wind") ? "\"generated-wind.csv\""
                    : path.starts_with("payload")        ? "\"generated-attitude.csv\""
                                                         : "\"generated-air.csv\"";
            break;
        default:
            value = text();
    }
    put(path, std::move(value));
}

/// A force, or its history.
inline void SceneGenerator::put_extraction() {
    if (random_bool(0.5))
        put_number("parachute.deploy.force", number_of(*find_key(scene_keys(), "parachute.deploy.force")));
    else
        put("parachute.deploy.force_table", "\"generated-force.csv\"");
}

inline void SceneGenerator::put_release(bool may_rest, bool straight_down) {
    const double lowest = -1000.0, highest = 85000.0;
    double ground = 0.0;
    if (random_bool(0.5)) put_number("environment.ground", ground = number_in(lowest + 100.0, 20000.0));
    const double height = number_in(1.0, highest - ground);
    if (random_bool(0.5))
        put_number("release.altitude", ground + height);
    else
        put_number("release.height", height);
    const bool over_ground = random_bool(0.5);
    // A wind of up to 200 m/s may carry an airspeed.
    const double speed = may_rest && random_bool(0.3) ? 0.0 : number_in(0.05, over_ground ? 999.0 : 799.0);
    put_number(over_ground ? "release.speed" : "release.airspeed", speed);
    if (speed > 0.0 && (!over_ground || !has_wind_)) airspeed_ = speed;
    if (speed > 0.0)
        put_number("release.path_angle", straight_down ? 0.5 * pi : number_in(-0.5 * pi, 0.5 * pi));
    const bool stops = std::ranges::any_of(
        lines_, [](const SceneLine& line) { return line.path == "stop.at" || line.path == "stop.time"; });
    if (stops || random_bool(0.5)) return;
    const double above = height * number_in(0.01, 0.99);
    if (random_bool(0.5))
        put_number("stop.altitude", ground + above);
    else
        put_number("stop.height", above);
}

inline void SceneGenerator::put_canopy() {
    const bool design = random_bool(0.6);
    if (design) put("parachute.design", "\"usaf-c9\"");
    if (random_bool(0.3)) {
        put("parachute.type", one_of(std::vector<std::string>{"\"cross\"", "\"ringslot\""}));
        if (lines_.back().value == "\"cross\"" && random_bool(0.5))
            put_number(random_bool(0.5) ? "parachute.arm_ratio" : "parachute.corner_tie",
                       number_in(0.05, 0.95));
    } else if (random_bool(0.2)) {  // an angle and a length for each panel of the type
        put("parachute.type", "\"conical\"");
        if (random_bool(0.5)) put("parachute.panel", "[{ fabric = \"mil-c-7020-c9\" }]");
        put("parachute.cone_angle", fmt::format("[\"{:g} deg\"]", number_in(10.0, 35.0)));
        put("parachute.panel_length", fmt::format("[{:g}]", number_in(0.1, 10.0)));
    }
    const bool panels = lines_.back().path == "parachute.panel_length";
    const auto give = [&] { return !design || random_bool(0.4); };
    diameter_ = 8.53;
    if (give()) {  // what has to fit together comes together
        put_number("parachute.nominal_diameter", diameter_ = number_in(0.1, 199.0));
        put_number("parachute.vent_diameter", diameter_ * number_in(0.01, panels ? 0.5 : 0.9));
        const double area = 0.25 * pi * diameter_ * diameter_, coefficient = number_in(0.01, 3.0);
        if (random_bool(0.5))
            put_number("parachute.drag_area", std::min(coefficient * area, 9e4));
        else
            put_number("parachute.drag_coefficient", coefficient);
    }
    if (give()) {
        const std::size_t links = 1 + below(8), each = 1 + below(12);
        put("parachute.risers", fmt::format("{}", links));
        const std::size_t gores = std::max<std::size_t>(3, each) * links;
        put("parachute.gores", fmt::format("{}", gores));
        even_gores_ = gores % 2 == 0;
    }
    for (const Key& key : scene_keys()) {
        if (key.kind != KeyKind::data_file || key.folder != "materials" || !give()) continue;
        if (key.path == "parachute.vent_lines.cord" || key.path == "parachute.panel.fabric")
            continue;  // with a length alone; in put_canopy
        put(key.path, key.path == "parachute.fabric" ? "\"mil-c-7020-c9\"" : "\"mil-c-5040-type-ii\"");
    }
    for (const char* path :
         {"parachute.projected_diameter_ratio", "parachute.mass", "parachute.riser_length"})
        if (give()) put_number(path, number_of(*find_key(scene_keys(), path)));
    // Longer than the widest mouth, a triangle's at the largest ratios.
    put_number("parachute.line_length", diameter_ * number_in(1.0, 2.0));
    if (random_bool(0.3)) put_vent_lines();
}

/// With a vent line's length, which lines to the suspension lines need.
inline void SceneGenerator::put_vent_lines() {
    const bool across = even_gores_ && random_bool(0.3);
    if (across || random_bool(0.5))
        put("parachute.vent_lines.model", across ? "\"across\"" : "\"pull-down\"");
    if (across || random_bool(0.5))
        put_number("parachute.vent_lines.length", number_in(0.1, 900.0));
    else
        put_number("parachute.vent_lines.pull_down_ratio", number_in(0.0, 0.99));
    if (!across && random_bool(0.5))
        put_number("parachute.vent_lines.joint", diameter_ * number_in(0.01, 0.3));
    if (random_bool(0.5)) put("parachute.vent_lines.cord", "\"mil-c-5040-type-ii\"");
}

/// Filling time and initial phase: t_i has to be shorter than t_f.
inline void SceneGenerator::put_opening() {
    std::optional<double> filling;  // [s] where the generator knows it
    bool transit = false;           // fits
    if (random_bool(0.6)) {
        const double n = number_in(0.2, 199.0);
        put_number("parachute.fill_time.n", n);
        const bool corrected = random_bool(0.3);
        if (corrected) put_number("parachute.fill_time.density_exponent", number_in(-4.9, 4.9));
        if (!corrected && airspeed_) filling = n * diameter_ / *airspeed_;
        transit = !corrected && n > 0.6;
        if (random_bool(0.3)) {
            const bool cross = random_bool(0.5);
            put("parachute.fill_time.model", cross ? "\"knacke-0.9\"" : "\"knacke-0.85\"");
            const double power = cross ? 0.9 : 0.85;
            if (filling) filling = n * (diameter_ / 0.3048) / std::pow(*airspeed_ / 0.3048, power);
            transit = filling && 0.5 * diameter_ / *airspeed_ < 0.9 * *filling;
        } else if (random_bool(0.5)) {
            put("parachute.fill_time.model", "\"fill-constant\"");
        }
    } else if (random_bool(0.2)) {
        put("parachute.fill_time.table",
            random_bool(0.5) ? "\"generated-froude.csv\"" : "\"generated-mass.csv\"");
    } else if (random_bool(0.2)) {  // so small a canopy that the lightest payload lets it fill
        put_number("parachute.fill_time.volume", number_in(1e-7, 1e-6));
        put_number("parachute.fill_time.mouth_area", number_in(10.0, 20.0));
        put_number("parachute.permeability", number_in(0.0, 1e-3));
        if (random_bool(0.5)) put_number("parachute.fill_time.pressure_coefficient", number_in(0.0, 2.0));
    } else if (random_bool(0.3)) {
        const double porosity = number_in(0.001, 0.5);
        put("parachute.fill_time.model", "\"ribbon\"");
        put_number("parachute.geometric_porosity", porosity);
        if (airspeed_) filling = 65.0 * porosity * diameter_ / *airspeed_;
        transit = 65.0 * porosity > 0.6;
    } else {
        filling = number_in(0.001, 999.0);
        put_number("parachute.fill_time.time", *filling);
        transit = airspeed_ && 0.5 * diameter_ / *airspeed_ < 0.9 * *filling;
        if (random_bool(0.5)) put("parachute.fill_time.model", "\"given\"");
    }
    if (transit && random_bool(0.7)) {
        if (random_bool(0.5)) put("parachute.initial_phase", "\"transit\"");
        return;
    }
    put_number("parachute.initial_phase",
               filling && random_bool(0.7) ? std::min(900.0, 0.9 * share() * *filling) : 0.0);
}

/// Stages, and what deployment, cutters and the letting go wait for.
inline void SceneGenerator::put_sequence(const std::string& by) {
    static const std::vector<std::string> conditions{"at = \"apogee\"", "time = \"3 s\"",
                                                     "height = \"500 ft\"", "dynamic_pressure = 300",
                                                     "at = \"steady-descent\", delay = \"1 s\""};
    const auto is_put = [&](std::string_view path) {
        return std::ranges::any_of(lines_, [&](const SceneLine& line) { return line.path == path; });
    };
    // Where no model of the filling time has them yet; added masses go to a porosity of 0.5.
    if (!is_put("parachute.permeability") && random_bool(0.5))
        put_number("parachute.permeability", number_in(0.0, 2.0));
    if (!is_put("parachute.geometric_porosity") && random_bool(0.5))
        put_number("parachute.geometric_porosity", number_in(0.0, 0.5));
    if (random_bool(0.3)) {
        put("parachute.count", "2");
        if (by != "inflated" && random_bool(0.5)) put("parachute.lag", "[0, \"500 ms\"]");
    }
    if (by != "static-line" && random_bool(0.2))
        put("parachute.deploy.when", "{ " + one_of(conditions) + " }");
    if (random_bool(0.2)) put("parachute.cut", "{ " + one_of(conditions) + " }");
    if (!is_put("parachute.initial_drag_area_ratio") && !is_put("parachute.drag_area_law") &&
        !is_put("parachute.drag_area_exponent") && random_bool(0.3))
        return put("parachute.drag_area_table", "\"generated-growth.csv\"");
    if (by == "inflated" || is_put("parachute.initial_drag_area_ratio") || random_bool(0.6)) return;
    std::string stages;
    double ratio = 0.05;
    for (std::size_t i = 1 + below(3); i > 0; --i) {
        ratio += number_in(0.01, 0.3);
        stages += fmt::format("{}{{ drag_area_ratio = {}, until = {{ {} }} }}", stages.empty() ? "" : ", ",
                              ratio, one_of(conditions));
    }
    put("parachute.reefing", "[" + stages + "]");
    if (random_bool(0.2)) put("parachute.skips_reefing", "1");
}

/// A predicted filling, in place of what prescribes one; the lines have to fit its shapes.
inline void SceneGenerator::put_filling(const std::string& by) {
    if (random_bool(0.7) || by == "inflated") {
        if (random_bool(0.2)) put("parachute.filling.model", "\"prescribed\"");
        return;
    }
    std::erase_if(lines_, [](const SceneLine& line) {
        return prescribes_filling(line.path) || line.path == "parachute.drag_area_mach_table" ||
               line.path == "parachute.line_length" || line.path == "parachute.riser_length";
    });
    put_number("parachute.line_length", diameter_ * number_in(0.5, 2.0));
    put_number("parachute.riser_length", diameter_ * number_in(0.05, 0.5));
    static const std::vector<std::string> models{"\"predicted\"", "\"wolf\"", "\"mass-balance\""};
    put("parachute.filling.model", one_of(models));
    const double low = number_in(1e-4, 0.01), high = number_in(0.02, 0.4);
    if (random_bool(0.5)) put_number("parachute.filling.lowest_mouth", std::min(low, 0.002));
    if (random_bool(0.5)) put_number("parachute.filling.highest_mouth", std::max(high, 0.04));
    if (random_bool(0.5)) put_number("parachute.filling.initial_mouth", number_in(0.0021, 0.039));
    if (random_bool(0.5)) put_number("parachute.filling.entrance_loss", number_in(0.5, 20.0));
}

/// At least one limit; a descent rate only where the run may come to it.
inline void SceneGenerator::put_limits(std::string_view stop) {
    const bool early = stop == "peak-force" || stop == "full-open" || stop == "line-stretch";
    const bool rate = !early && random_bool(0.6);
    if (rate) put_number("size.max_descent_rate", number_in(1.0, 50.0));
    if (!rate || random_bool(0.5)) put_number("size.max_force", number_in(10.0, 1e6));
}

inline void SceneGenerator::put_tolerances() {
    for (const MetricRow& metric : judgeable_rows()) {
        if (!random_bool(0.1)) continue;
        const double value = number_in(0.0, 1000.0);
        const std::string_view own = metric.tolerance_unit() == "1" ? "" : metric.tolerance_unit();
        const std::string_view unit = random_bool(0.5) ? "%" : own;
        put("compare.tolerance." + std::string(metric.name), fmt::format("\"{} {}\"", value, unit));
    }
}

inline std::vector<SceneLine> SceneGenerator::valid() {
    static const std::set<std::string_view> by_hand{"schema",
                                                    "base",
                                                    "environment.ground",
                                                    "payload.diameter",
                                                    "payload.body.sling_length",
                                                    "size.max_descent_rate",
                                                    "size.max_force",
                                                    "size.parachute",
                                                    "series.test",
                                                    "release.altitude",
                                                    "release.height",
                                                    "release.speed",
                                                    "release.airspeed",
                                                    "release.path_angle",
                                                    "stop.altitude",
                                                    "stop.height",
                                                    "stop.then",
                                                    "full.symmetry",
                                                    "full.contact",
                                                    "parachute.count",
                                                    "parachute.skips_reefing",
                                                    "parachute.deploy.force",
                                                    "parachute.deploy.force_table",
                                                    "parachute.calibration",
                                                    "parachute.drag_area_table",
                                                    "parachute.drag_area_mach_table",
                                                    "parachute.initial_phase",
                                                    "parachute.arm_ratio",
                                                    "parachute.corner_tie",
                                                    "parachute.nominal_diameter",
                                                    "parachute.vent_diameter",
                                                    "parachute.drag_area",
                                                    "parachute.drag_coefficient",
                                                    "parachute.risers",
                                                    "parachute.gores",
                                                    "parachute.projected_diameter_ratio",
                                                    "parachute.mass",
                                                    "parachute.line_length",
                                                    "parachute.riser_length",
                                                    "parachute.permeability",
                                                    "parachute.geometric_porosity"};
    lines_.clear();
    airspeed_.reset();
    even_gores_ = true;
    has_wind_ = random_bool(0.4);
    put("schema", "1");
    std::map<std::string, std::string, std::less<>> words;
    std::vector<std::string> left_out;  // tables
    std::map<std::string_view, bool> taken;
    for (const Key& key : scene_keys()) {
        if (key.path.starts_with("uncertainty")) {  // of no run: by hand
            if (key.kind == KeyKind::table) left_out.push_back(std::string(key.path) + ".");
            continue;
        }
        if (key.path.starts_with("case") || key.kind == KeyKind::tolerance || key.kind == KeyKind::data_file)
            continue;
        if (key.has_members() || key.path.starts_with("parachute.reefing.")) {
            left_out.push_back(std::string(key.path) + ".");
            continue;
        }
        if (key.path == "parachute.deploy.when" || key.path == "parachute.cut" ||
            key.path == "parachute.vent_lines") {
            left_out.push_back(std::string(key.path) + ".");
            continue;
        }
        if (key.kind == KeyKind::table) {
            const bool is_wind = key.path == "environment.wind";
            const bool is_in_one =
                std::ranges::any_of(left_out, [&](const auto& table) { return key.path.starts_with(table); });
            if (key.need == KeyNeed::optional && (is_in_one || !(is_wind ? has_wind_ : random_bool(0.5))))
                left_out.push_back(std::string(key.path) + ".");
            continue;
        }
        if (by_hand.contains(key.path) || key.path.starts_with("parachute.fill_time.") ||
            key.path.starts_with("parachute.filling."))
            continue;
        if (std::ranges::any_of(left_out, [&](const auto& table) { return key.path.starts_with(table); }))
            continue;
        if (!key.instead_of.empty()) {  // one of a group, or none
            bool decided = true, mine = true;
            for (const std::string_view other : words_of(key.instead_of)) {
                if (by_hand.contains(other)) continue;
                const auto before = taken.find(other);
                decided = decided && before != taken.end();
                mine = mine && (before == taken.end() || !before->second);
            }
            mine = mine && (decided || random_bool(0.5));
            taken[key.path] = mine;
            if (!mine) continue;
        }
        decide(key, words);
    }
    const std::string& by = words["parachute.deploy.by"];
    if (by == "extraction") put_extraction();
    const bool disturbed =
        has_wind_ || by == "pilot" || by == "mortar" || by == "static-line" || by == "extraction" ||
        by == "free" ||
        std::ranges::none_of(left_out, [](const auto& table) { return table == "full.noise."; }) ||
        std::ranges::none_of(left_out, [](const auto& table) { return table == "payload.body."; });
    const bool sector = !disturbed && random_bool(0.5);
    if (sector || random_bool(0.3)) put("full.symmetry", sector ? "\"sector\"" : "\"none\"");
    put_release(by != "line-stretch", sector);
    put_canopy();
    put_opening();
    put_sequence(by);
    if (words["environment.atmosphere.model"] != "constant" && random_bool(0.3))
        put("parachute.drag_area_mach_table", "\"generated-mach.csv\"");
    put_filling(by);
    if (random_bool(0.2)) put("parachute.calibration", "\"generated-calibration.csv\"");
    const auto has = [&](std::string_view table) {
        return std::ranges::none_of(left_out, [&](const auto& out) { return out == table; });
    };
    if (has("aerodynamics.forebody_wake.") || random_bool(0.2))
        put_number("payload.diameter", number_in(0.1, 50.0));
    if (const std::string& shape = words["payload.body.shape"]; has("payload.body.") && shape != "mesh")
        put("payload.body.size", shape == "box" ? "[\"60 cm\", 0.5, \"2 ft\"]" : "[0.7, \"1 m\"]");
    else if (has("payload.body.") && std::ranges::none_of(lines_, [](const SceneLine& line) {
                 return line.path == "parachute.mesh";
             }))
        put("parachute.mesh", "\"generated-mesh.msh\"");
    const bool one_riser = std::ranges::any_of(
        lines_, [](const SceneLine& line) { return line.path == "parachute.risers" && line.value == "1"; });
    if (one_riser && has("payload.body.") && words["payload.body.shape"] != "mesh" &&
        !has("payload.body.elasticity.") && random_bool(0.5))
        put("payload.body.sling_length", "\"1.5 m\"");
    const bool packed = by != "line-stretch" && by != "inflated";
    const bool imported =
        std::ranges::any_of(lines_, [](const SceneLine& line) { return line.path == "parachute.mesh"; });
    if (imported)  // has its own shape
        std::erase_if(lines_, [](const SceneLine& line) {
            return line.path == "parachute.cone_angle" || line.path == "parachute.panel_length" ||
                   line.path == "parachute.arm_ratio" || line.path == "parachute.corner_tie" ||
                   line.path == "parachute.panel" || line.path.starts_with("parachute.vent_lines");
        });
    const auto jointed = [](const SceneLine& line) { return line.path == "parachute.vent_lines.joint"; };
    if (std::ranges::any_of(lines_, jointed))  // lies at a node
        for (SceneLine& line : lines_)
            if (line.path == "full.mesh.line_elements" && line.value == "1") line.value = "2";
    // Self-contact looks at the whole canopy.
    const bool one_sector =
        std::ranges::any_of(lines_, [](const SceneLine& line) { return line.path == "full.symmetry"; });
    if (random_bool(0.5) && !(imported && one_sector))
        put("full.contact", packed || random_bool(0.3)                      ? "\"none\""
                            : imported || (!one_sector && random_bool(0.3)) ? "\"self\""
                                                                            : "\"gores\"");
    const bool touches_itself = std::ranges::any_of(lines_, [](const SceneLine& line) {
        return line.path == "full.contact" && line.value == "\"self\"";
    });
    if (!touches_itself)
        std::erase_if(lines_, [](const SceneLine& line) { return line.path == "full.contact_friction"; });
    const std::string& stop = words["stop.at"];
    const bool is_cut =
        std::ranges::any_of(lines_, [](const SceneLine& line) { return line.path == "parachute.cut"; });
    if (!is_cut && stop != "ground" && stop != "line-stretch" && random_bool(0.3))
        put("stop.then", "\"rom\"");
    if (has("size.")) put_limits(words["stop.at"]);
    if (has("size.") && random_bool(0.3)) {
        const auto named = std::ranges::find(lines_, "parachute.name", &SceneLine::path);
        if (named != lines_.end()) put("size.parachute", std::string(named->value));
    }
    if (random_bool(0.3)) put_tolerances();
    if (random_bool(0.2)) {
        put("uncertainty.inputs", "[\"ln payload.mass\", \"environment.gravity\"]");
        put("uncertainty.covariance", "[0.01, -1e-5, 1e-6]");
    }
    for (const Key& key : scene_keys()) {  // a table without a key of its own
        if (key.kind != KeyKind::table || key.need != KeyNeed::optional || key.path == "case" ||
            key.path == "case.set" || key.path == "parachute.vent_lines")
            continue;
        const std::string inside = std::string(key.path) + ".";
        const bool out = std::ranges::find(left_out, inside) != left_out.end();
        const bool named =
            std::ranges::any_of(lines_, [&](const auto& line) { return line.path.starts_with(inside); });
        if (!out && !named) put(key.path, "{}");
    }
    for (std::size_t i = lines_.size(); i > 1; --i)
        std::swap(lines_[i - 1], lines_[below(i)]);
    return lines_;
}

/// A value that the key cannot have; nothing where this kind of mistake cannot be made with it.
inline std::optional<std::string> SceneGenerator::spoiled(const Key& key, std::size_t kind) {
    const bool measured = key.kind == KeyKind::quantity || key.kind == KeyKind::quantity_or_word;
    switch (kind) {
        case 0:
            if (measured) return "\"3 furlongz\"";
            break;
        case 1:
            if (measured) return key.unit == "m" ? "\"3 kg\"" : "\"3 m\"";
            break;
        case 2:
            if (!measured && key.kind != KeyKind::integer) break;
            if (std::isfinite(key.range.low) && random_bool(0.5))
                return fmt::format("{}", key.range.low - 1.0 - std::abs(key.range.low));
            if (std::isfinite(key.range.high))
                return fmt::format("{}", key.range.high + 1.0 + std::abs(key.range.high));
            break;
        case 3:
            if (measured)
                return one_of(std::vector<std::string>{"nan", "inf", "-inf", "\"nan\"", "\"1e999 m\""});
            break;
        case 4:
            if (key.kind == KeyKind::quantities) return "true";  // [1, 2] may be right
            return one_of(std::vector<std::string>{"true", "[1, 2]", "1979-05-27", "{ source = \"x\" }"});
        case 5:
            if (key.kind == KeyKind::word)
                return one_of(std::vector<std::string>{"\"no-such-word\"", "7", "\"\""});
            break;
        case 6:
            if (key.kind == KeyKind::data_file || key.kind == KeyKind::csv_file ||
                key.kind == KeyKind::mesh_file)
                return one_of(
                    std::vector<std::string>{"\"no-such-file\"", "\"../up\"", "\"/etc/passwd\"", "\"\""});
            break;
        case 7:
            return one_of(std::vector<std::string>{"", "\"", "5 kg", "{ value = ", "=", "[1"});
        default:
            break;
    }
    return std::nullopt;
}

inline SceneGenerator::Broken SceneGenerator::broken() {
    static const std::set<std::string_view> needed{"schema",
                                                   "name",
                                                   "payload.mass",
                                                   "release.altitude",
                                                   "release.height",
                                                   "release.speed",
                                                   "release.airspeed",
                                                   "release.path_angle",
                                                   "parachute.deploy.by",
                                                   "parachute.deploy.length",
                                                   "parachute.deploy.force",
                                                   "parachute.deploy.force_table"};
    for (;;) {
        std::vector<SceneLine> lines = valid();
        const std::size_t at = below(lines.size()), kind = below(12);
        SceneLine& line = lines[at];
        const Key* key = find_key(scene_keys(), line.path);
        if (!key || key->kind == KeyKind::table) continue;
        const std::string what = fmt::format("mistake {} in {}", kind, line.path);
        if (kind < 8) {
            const auto value = spoiled(*key, kind);
            if (!value) continue;
            line.value = *value;
        } else if (kind == 8) {
            line.path += "_x";
        } else if (kind == 9) {
            lines.push_back(line);
        } else if (kind == 10) {
            if (!needed.contains(line.path)) continue;
            lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
        } else {
            if (key->instead_of.empty()) continue;
            const Key& other = *find_key(scene_keys(), words_of(key->instead_of).front());
            lines.push_back(
                {std::string(other.path), other.choices ? '"' + std::string(other.choices()[0]) + '"' : "1"});
        }
        return {what, scene_of_lines(lines)};
    }
}

}  // namespace twinchute::test
