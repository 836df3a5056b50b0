#include "lib/scene/soundings.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/csv_table.hpp"
#include "lib/scene/published_sounding.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {
namespace {

constexpr CsvColumn altitude{"altitude", "m", {-5000.0, 86000.0}};

constexpr std::array<CsvColumn, 4> air_columns{{altitude,
                                                {"temperature", "K", {0.0, 2000.0, true}},
                                                {"pressure", "Pa", {0.0, 1e7, true}},
                                                {"density", "kg/m^3", {0.0, 100.0, true}}}};

constexpr std::array<CsvColumn, 6> wind_columns{{altitude,
                                                 {"speed", "m/s", {0.0, 200.0}},
                                                 {"from", "rad", {-2.0 * pi, 2.0 * pi}},
                                                 {"east", "m/s", {-200.0, 200.0}},
                                                 {"north", "m/s", {-200.0, 200.0}},
                                                 {"up", "m/s", {-100.0, 100.0}}}};

constexpr std::array<CsvColumn, 2> force_columns{{{"time", "s", {0.0, 36000.0}}, {"force", "N", {0.0, 1e7}}}};

/// Levels of a published sounding that have what is asked for; each has to lie above the one before.
template <class Has>
std::vector<SoundingLevel> levels_with(std::string_view text, const std::string& file, std::string_view what,
                                       Has&& has) {
    std::vector<SoundingLevel> levels;
    for (const SoundingLevel& level : read_published_sounding(text, file)) {
        if (!has(level)) continue;
        if (!levels.empty() && level.altitude <= levels.back().altitude) {
            const SoundingLevel& before = levels.back();
            const bool repeated = level.altitude == before.altitude && level.pressure == before.pressure &&
                                  level.temperature == before.temperature && level.speed == before.speed &&
                                  level.from == before.from;
            if (repeated) continue;  // one level under two names, such as a mandatory and a significant one
            throw SceneError({file, level.line, 1}, "", "height does not rise",
                             fmt::format("{:.1f} m after {:.1f} m in line {}", level.altitude,
                                         before.altitude, before.line),
                             "take one of the two lines out");
        }
        levels.push_back(level);
    }
    if (levels.size() < 2)
        throw SceneError({file, levels.empty() ? 1 : levels.front().line, 1}, "",
                         fmt::format("{} levels with {}", levels.size(), what),
                         "two are the fewest to go between", "name a sounding that has more");
    return levels;
}

AirTable published_air(std::string_view text, const std::string& file, const std::string& name) {
    AirTable air;
    air.file = name;
    air.beside = AirTable::Beside::pressure;
    for (const SoundingLevel& level : levels_with(text, file, "pressure and temperature", [](const auto& l) {
             return l.pressure && l.temperature;
         })) {
        air.altitude.push_back(level.altitude);
        air.temperature.push_back(*level.temperature);
        air.logarithm.push_back(std::log(*level.pressure));
    }
    return air;
}

Wind published_wind(std::string_view text, const std::string& file, const std::string& name) {
    Wind wind;
    wind.table = name;
    for (const SoundingLevel& level :
         levels_with(text, file, "wind", [](const auto& l) { return l.speed && l.from; }))
        wind.levels.push_back({level.altitude, wind_from(*level.speed, *level.from)});
    return wind;
}

}  // namespace

AirTable read_air_table(std::string_view text, const std::string& file, const std::string& name) {
    if (is_published_sounding(text)) return published_air(text, file, name);
    const CsvTable table = read_csv_table(text, file, air_columns);
    constexpr const char* hint = "the columns are altitude, temperature, and pressure or density";
    if (!table.has("temperature")) refuse_columns(file, "the column 'temperature' is missing", hint);
    if (table.has("pressure") == table.has("density"))
        refuse_columns(file,
                       table.has("pressure") ? "pressure and density say the same beside a temperature"
                                             : "neither pressure nor density is there",
                       hint);
    AirTable air;
    air.file = name;
    air.altitude = table.at("altitude");
    air.temperature = table.at("temperature");
    air.beside = table.has("density") ? AirTable::Beside::density : AirTable::Beside::pressure;
    for (const double value : table.at(table.has("density") ? "density" : "pressure"))
        air.logarithm.push_back(std::log(value));
    return air;
}

Wind read_wind_table(std::string_view text, const std::string& file, const std::string& name) {
    if (is_published_sounding(text)) return published_wind(text, file, name);
    const CsvTable table = read_csv_table(text, file, wind_columns);
    const bool polar = table.has("speed") && table.has("from");
    const bool cartesian = table.has("east") && table.has("north");
    const std::size_t columns = table.columns.size();
    const bool right = polar ? columns == 3 : cartesian && columns == (table.has("up") ? 4u : 3u);
    if (!right)
        refuse_columns(file, "these columns are not a wind",
                       "the columns are altitude, speed and from, or altitude, east, north and perhaps up");
    Wind wind;
    wind.table = name;
    for (std::size_t i = 0; i < table.at("altitude").size(); ++i) {
        const Vec3 velocity = polar ? wind_from(table.at("speed")[i], table.at("from")[i])
                                    : Vec3(table.at("east")[i], table.at("north")[i],
                                           table.has("up") ? table.at("up")[i] : 0.0);
        wind.levels.push_back({table.at("altitude")[i], velocity});
    }
    return wind;
}

ForceHistory read_force_table(std::string_view text, const std::string& file, const std::string& name,
                              double duration) {
    const CsvTable table = read_csv_table(text, file, force_columns);
    if (!table.has("force"))
        refuse_columns(file, "the column 'force' is missing", "the columns are time and force");
    return {name, table.at("time"), table.at("force"), duration};
}

}  // namespace twinchute
