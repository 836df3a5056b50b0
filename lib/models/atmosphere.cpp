#include "lib/models/atmosphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/interpolation.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

constexpr double gas_constant = 8314.32 / 28.9644;  // [J/(kg K)] of dry air, US76
constexpr double earth_radius = 6356766.0;          // [m] of US76, at 45 deg latitude

/// Sutherland's law with the constants of US76 (Eq. 51): [Pa s] for T in [K].
double sutherland_viscosity(double temperature) {
    return 1.458e-6 * std::sqrt(temperature) * temperature / (temperature + 110.4);
}

struct Layer {
    double base;         // [m] geopotential
    double temperature;  // [K] at the base
    double lapse;        // [K/m]
    double pressure;     // [Pa] at the base
};

/// Pressure inside a layer (US76, Eqs 33a and 33b).
double layer_pressure(const Layer& layer, double geopotential) {
    const double exponent = standard_gravity / gas_constant;
    const double rise = geopotential - layer.base;
    if (layer.lapse == 0.0) return layer.pressure * std::exp(-exponent * rise / layer.temperature);
    const double temperature = layer.temperature + layer.lapse * rise;
    return layer.pressure * std::pow(layer.temperature / temperature, exponent / layer.lapse);
}

/// The seven layers below 86 km, pressures carried up from 101325 Pa. Above, where this model ends, the
/// temperature stays: a flight that strays there meets thin air, not a negative temperature.
std::array<Layer, 8> make_layers() {
    std::array<Layer, 8> layers{{{0.0, 288.15, -6.5e-3, 101325.0},
                                 {11e3, 216.65, 0.0, 0.0},
                                 {20e3, 216.65, 1.0e-3, 0.0},
                                 {32e3, 228.65, 2.8e-3, 0.0},
                                 {47e3, 270.65, 0.0, 0.0},
                                 {51e3, 270.65, -2.8e-3, 0.0},
                                 {71e3, 214.65, -2.0e-3, 0.0},
                                 {84852.0, 186.946, 0.0, 0.0}}};
    for (std::size_t i = 1; i < layers.size(); ++i)
        layers[i].pressure = layer_pressure(layers[i - 1], layers[i].base);
    return layers;
}

/// Gas law and viscosity for a pressure [Pa] and a temperature [K].
AirState air_of(double pressure, double temperature) {
    return {pressure / (gas_constant * temperature), pressure, temperature,
            sutherland_viscosity(temperature)};
}

/// With an offset the altitude stays what an altimeter calls pressure altitude: the pressure is the
/// standard's at that altitude, the temperature is shifted, the density follows from the gas law (the
/// way performance charts count a hot day, "ISA + 15"). The levels of such an air really lie further
/// apart, in proportion to its temperature.
AirState us76(const Atmosphere& choice, double altitude) {
    static const std::array<Layer, 8> layers = make_layers();
    const double geopotential = earth_radius * altitude / (earth_radius + altitude);
    std::size_t i = 0;
    while (i + 1 < layers.size() && geopotential >= layers[i + 1].base)
        ++i;
    const Layer& layer = layers[i];
    const double temperature = layer.temperature + layer.lapse * (geopotential - layer.base);
    return air_of(layer_pressure(layer, geopotential), temperature + choice.temperature_offset);
}

AirState constant(const Atmosphere& choice, double) {
    AirState air;
    air.density = choice.constant_density;
    air.temperature = 288.15;
    air.pressure = air.density * gas_constant * air.temperature;
    air.viscosity = sutherland_viscosity(air.temperature);
    return air;
}

/// Between levels the temperature is linear in altitude and so is the logarithm of pressure or density:
/// exact where the air is isothermal, and monotone, so that no layer can be invented. Above the levels the
/// logarithm goes on and the temperature stays: a lapse that went on would end at 0 K. Below the first, where
/// no scene may be but trial steps of a solver go, both go on.
AirState table(const Atmosphere& choice, double altitude) {
    const AirTable& levels = choice.table;
    const Between place(levels.altitude, altitude);
    const double temperature = place.held_above(levels.temperature);
    const double value = std::exp(place.linear(levels.logarithm));
    const bool dense = levels.beside == AirTable::Beside::density;
    return air_of(dense ? value * gas_constant * temperature : value, temperature);
}

constexpr std::array<AtmosphereModel, 3> atmospheres{{
    {"us76", "US Standard Atmosphere 1976 (NOAA-S/T 76-1562), hydrostatic part", -5000.0, 86000.0, us76},
    {"constant", "uniform density; viscosity of air at 288.15 K", -1e9, 1e9, constant, false},
    {"table", "measured levels; temperature and log pressure or density linear in altitude", -5000.0, 86000.0,
     table},
}};

}  // namespace

double speed_of_sound(double temperature) {
    constexpr double heat_capacity_ratio = 1.4;
    return std::sqrt(heat_capacity_ratio * gas_constant * temperature);
}

double Atmosphere::reach(double altitude) const {
    return reach_among(std::span(table.altitude), altitude);
}

std::optional<double> Atmosphere::speed_of_sound(double altitude) const {
    if (!model->has_temperature) return std::nullopt;
    return twinchute::speed_of_sound(at(altitude).temperature);
}

std::span<const AtmosphereModel> atmosphere_models() {
    return atmospheres;
}

const AtmosphereModel* find_atmosphere(std::string_view name) {
    const auto row = std::ranges::find(atmospheres, name, &AtmosphereModel::name);
    return row == atmospheres.end() ? nullptr : &*row;
}

}  // namespace twinchute
