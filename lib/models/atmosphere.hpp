// The air at rest: density and viscosity against altitude.
#pragma once

#include <span>
#include <string_view>

namespace twinchute {

struct AirState {
    double density = 0.0;      ///< [kg/m^3]
    double pressure = 0.0;     ///< [Pa]
    double temperature = 0.0;  ///< [K]
    double viscosity = 0.0;    ///< dynamic [Pa s]
};

struct Atmosphere;

/// A row of the table of atmospheres.
struct AtmosphereModel {
    std::string_view name;
    std::string_view source;
    double lowest, highest;  ///< [m] range of altitude above sea level
    AirState (*at)(const Atmosphere&, double altitude);
};

/// A choice of row with its parameters.
struct Atmosphere {
    const AtmosphereModel* model = nullptr;
    double constant_density = 0.0;  ///< [kg/m^3], for "constant"

    /// The air at an altitude [m] above sea level. Outside the row's range the nearest end's
    /// layer is continued; read_scene refuses releases out there.
    AirState at(double altitude) const { return model->at(*this, altitude); }
};

/// "us76" and "constant".
std::span<const AtmosphereModel> atmosphere_models();
const AtmosphereModel* find_atmosphere(std::string_view name);

/// [kg/m^3] US Standard Atmosphere 1976 at sea level.
inline constexpr double sea_level_density = 1.225;

}  // namespace twinchute
