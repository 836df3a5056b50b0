// A scene made from another program's file: what was taken over, what was assumed, what was not taken over.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute::exchange {

/// One line below a table of the scene to be written.
struct ImportedKey {
    std::string key;
    std::string value;    ///< in TOML; empty: the file does not say it, and it has to be given by --set
    std::string comment;  ///< behind it; of a value that is missing: why
};

/// One table of the scene: "[payload]" and so on.
struct ImportedTable {
    std::string head;                ///< with its brackets; empty: top of the file
    std::string path;                ///< by which --set names it: "payload", "parachute.main"; empty: top
    std::vector<std::string> notes;  ///< comment lines above it
    std::vector<ImportedKey> keys = {};

    void add(std::string key, std::string value, std::string comment = {}) {
        keys.push_back({std::move(key), std::move(value), std::move(comment)});
    }
    void add(std::string key, double si, std::string_view unit, std::string comment = {});
};

/// Wind at one level, to be written as a table beside the scene.
struct WindLevel {
    double altitude = 0.0;  ///< [m] above sea level
    double speed = 0.0;     ///< [m/s]
    double from = 0.0;      ///< [rad] where it comes from, from north, clockwise
};

struct ImportedScene {
    std::string program;  ///< that wrote the file, with its version: "OpenRocket 24.12"
    std::string taken;    ///< part of the file that the scene is of: simulation, stage
    std::vector<ImportedTable> tables;
    std::vector<WindLevel> wind;                 ///< more than one level: a file beside the scene
    std::optional<WindLevel> uniform_wind = {};  ///< at all altitudes, as the scene says it
    std::vector<std::string> assumptions;        ///< one sentence each
    std::vector<std::string> left_out;           ///< of recovery, one entry each

    std::optional<double> stated_landing_speed;  ///< [m/s] downward, by the other program
    bool stated_over_ground = false;             ///< not downward, but with the drift in the wind
    std::string stated_by;                       ///< where the file states it

    /// The table of that path; made where there is none yet.
    ImportedTable& table(std::string_view path, std::string_view head);
};

/// Text of one TOML string, quotes included. Bytes that are not UTF-8 and control characters become '?'.
std::string toml_string(std::string_view text);
/// Foreign text for a comment or a terminal: one line of UTF-8 without control characters.
std::string one_line(std::string_view text);
/// Number with six significant digits and its unit as TOML writes both: "1.25 kg".
std::string toml_quantity(double si, std::string_view unit);

/// A name of a parachute that keys can carry, from a foreign one, and none of `taken`.
std::string parachute_name(std::string_view foreign, const std::vector<std::string>& taken);

/// Puts "KEY=VALUE" of --set in place of values, or beside them; a value of a table that the scene does not
/// have yet makes the table. Throws UsageError.
void set_keys(ImportedScene& scene, const std::vector<std::string>& assignments);

/// Keys that still have to be given, each as "payload.mass (why)".
std::vector<std::string> missing_values(const ImportedScene& scene);

/// The scene file. `file`: what it was made from; `wind_table`: name of the file beside it, where there is
/// one.
std::string scene_text(const ImportedScene& scene, std::string_view file, std::string_view wind_table);

/// First words of every scene that is written so.
inline constexpr std::string_view import_mark = "# Imported by twinchute";

/// The levels of the wind as a CSV table that scenes read.
std::string wind_table_text(const std::vector<WindLevel>& levels);

}  // namespace twinchute::exchange
