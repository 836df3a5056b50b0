// Air and wind, level by level, and forces against time, as a CSV file gives them.
#pragma once

#include <string>
#include <string_view>

#include "lib/models/atmosphere.hpp"
#include "lib/models/wind.hpp"
#include "lib/scene/deployment.hpp"

namespace twinchute {

/// Columns altitude, temperature, and pressure or density; or a sounding as it was published (see
/// published_sounding.hpp), its levels with pressure and temperature. `file` stands for it in messages,
/// `name` is what a scene calls it. Throws SceneError.
AirTable read_air_table(std::string_view text, const std::string& file, const std::string& name);

/// Columns altitude, and speed and from, or east, north and perhaps up; or a published sounding, its levels
/// with wind. Throws SceneError.
Wind read_wind_table(std::string_view text, const std::string& file, const std::string& name);

/// Columns time and force; nothing acts after `duration` [s] or the last row. Throws SceneError.
ForceHistory read_force_table(std::string_view text, const std::string& file, const std::string& name,
                              double duration);

}  // namespace twinchute
