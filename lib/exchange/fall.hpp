// Parts of an imported scene that every program's file leads to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/exchange/imported_scene.hpp"

namespace twinchute::exchange {

/// The standard atmosphere with the offset that makes its density at the ground [m] that of a temperature [K]
/// and a pressure [Pa] stated there.
void add_ground_air(ImportedScene& scene, ImportedTable& environment, double ground, double temperature,
                    double pressure);

/// Wind of one speed [m/s] and direction [rad] it comes from, at all altitudes.
void add_uniform_wind(ImportedScene& scene, ImportedTable& environment, double speed, double from);

/// Sorts levels by altitude and keeps the first of those at one altitude.
void order_levels(std::vector<WindLevel>& levels);

/// Speed, path angle and heading of a release, from the horizontal and the upward speed [m/s] and the heading
/// [rad] from north, where it is known.
void add_velocity(ImportedTable& release, double horizontal, double upward, std::optional<double> heading);

/// Opening of a small parachute.
struct SmallOpening {
    std::string when;                ///< trigger, an inline table of TOML; empty: at release
    std::string comment;             ///< about the trigger
    double diameter = 0.0;           ///< D0 [m]
    std::optional<double> airspeed;  ///< [m/s] at line stretch, where it is known beforehand
};

/// Deployment at line stretch after its trigger, and filling within one diameter of fall. A canopy that opens
/// nearly at rest fills while it falls that far, not within D0/v_s.
void add_opening(ImportedScene& scene, ImportedTable& parachute, const SmallOpening& opening);

/// [m/s] through the air at a horizontal and an upward speed [m/s] and a heading [rad], `delay` [s] of free
/// fall later, in the scene's wind of one level.
double airspeed_after(const ImportedScene& scene, double horizontal, double upward,
                      std::optional<double> heading, double delay);

/// Adds assumptions that all such scenes share.
void add_common_assumptions(ImportedScene& scene, std::string_view program);

}  // namespace twinchute::exchange
