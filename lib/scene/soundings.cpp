#include "lib/scene/soundings.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/csv_table.hpp"

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

}  // namespace

AirTable read_air_table(std::string_view text, const std::string& file, const std::string& name) {
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
