// Soundings as they are published: text lists of the University of Wyoming, and the FSL format, which NOAA's
// GSD and its RAOB archive write.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

/// One level, in SI; what was not measured there is absent.
struct SoundingLevel {
    int line = 0;           ///< of the file
    double altitude = 0.0;  ///< [m] geometric, above sea level; published are geopotential metres
    std::optional<double> pressure, temperature;  ///< [Pa], [K]
    std::optional<double> speed, from;            ///< [m/s]; [rad] where the wind comes from
};

/// Whether a text is such a sounding, by its content.
bool is_published_sounding(std::string_view text);

/// Levels that rise. `file` stands for it in messages. Throws SceneError with the line.
std::vector<SoundingLevel> read_published_sounding(std::string_view text, const std::string& file);

}  // namespace twinchute
