// The air at rest: density and viscosity against altitude.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

struct AirState {
    double density = 0.0;      ///< [kg/m^3]
    double pressure = 0.0;     ///< [Pa]
    double temperature = 0.0;  ///< [K]
    double viscosity = 0.0;    ///< dynamic [Pa s]
};

/// A measured atmosphere (a sounding): levels with rising altitudes, at least two.
struct AirTable {
    /// Quantity that was measured beside the temperature; the other follows from the gas law.
    enum class Beside { pressure, density };

    std::string file;                 ///< its name, as the scene gives it
    std::vector<double> altitude;     ///< [m] above sea level
    std::vector<double> temperature;  ///< [K]
    std::vector<double> logarithm;    ///< of the pressure [Pa] or of the density [kg/m^3]
    Beside beside = Beside::pressure;

    bool operator==(const AirTable&) const = default;
};

struct Atmosphere;

/// A row of the table of atmospheres.
struct AtmosphereModel {
    std::string_view name;
    std::string_view source;
    double lowest, highest;  ///< [m] range of altitude above sea level
    AirState (*at)(const Atmosphere&, double altitude);
    bool has_temperature = true;  ///< that of the air; otherwise one that its viscosity takes
};

/// A choice of row with its parameters.
struct Atmosphere {
    const AtmosphereModel* model = nullptr;
    double constant_density = 0.0;    ///< [kg/m^3], for "constant"
    double temperature_offset = 0.0;  ///< [K], for "us76"
    AirTable table = {};              ///< for "table"

    /// The air at an altitude [m] above sea level. Outside its range the nearest end's
    /// layer is continued; read_scene refuses releases out there.
    AirState at(double altitude) const { return model->at(*this, altitude); }

    /// [m] How far a step from an altitude may go, up or down, without leaping over a measured layer.
    double reach(double altitude) const;

    /// [m/s] at an altitude [m], sqrt(gamma R T) with gamma = 1.4 (US76, Eq. 50); none in air without a
    /// temperature.
    std::optional<double> speed_of_sound(double altitude) const;

    // Range of altitude [m]: the row's, or that of the table.
    double lowest() const { return table.altitude.empty() ? model->lowest : table.altitude.front(); }
    double highest() const { return table.altitude.empty() ? model->highest : table.altitude.back(); }

    bool operator==(const Atmosphere&) const = default;
};

/// [m/s] of air at a temperature [K].
double speed_of_sound(double temperature);

/// "us76", "constant" and "table".
std::span<const AtmosphereModel> atmosphere_models();
const AtmosphereModel* find_atmosphere(std::string_view name);

/// [kg/m^3] US Standard Atmosphere 1976 at sea level.
inline constexpr double sea_level_density = 1.225;

}  // namespace twinchute
