#include "lib/exchange/fall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/models/atmosphere.hpp"

namespace twinchute::exchange {
namespace {

constexpr double fall_gravity = 9.80665;  // [m/s^2]

/// [deg] from 0 to 360 of an angle [rad].
double compass(double angle) {
    const double degrees = std::fmod(angle * 180.0 / pi, 360.0);
    return degrees < 0.0 ? degrees + 360.0 : degrees;
}

}  // namespace

void add_ground_air(ImportedScene& scene, ImportedTable& environment, double ground, double temperature,
                    double pressure) {
    const AirState standard = Atmosphere{find_atmosphere("us76")}.at(ground);
    // At the standard's pressure, the temperature that gives p/(R T).
    const double offset = temperature * standard.pressure / pressure - standard.temperature;
    environment.add("atmosphere", fmt::format("{{ temperature_offset = {} }}", toml_quantity(offset, "K")),
                    fmt::format("{:.5g} K and {:.6g} Pa at the launch site", temperature, pressure));
    scene.assumptions.push_back(
        fmt::format("the air has the density of {:.5g} K and {:.6g} Pa at the launch site; above it goes on "
                    "as the standard "
                    "atmosphere, {:+.3g} K warmer at its pressure",
                    temperature, pressure, offset));
}

void add_uniform_wind(ImportedScene& scene, ImportedTable& environment, double speed, double from) {
    scene.uniform_wind = WindLevel{0.0, speed, from};
    environment.add("wind", fmt::format("{{ speed = {}, from = {} }}", toml_quantity(speed, "m/s"),
                                        toml_quantity(compass(from), "deg")));
}

void order_levels(std::vector<WindLevel>& levels) {
    std::ranges::stable_sort(levels, {}, &WindLevel::altitude);
    const auto same = [](const WindLevel& a, const WindLevel& b) { return a.altitude == b.altitude; };
    levels.erase(std::unique(levels.begin(), levels.end(), same), levels.end());
}

void add_velocity(ImportedTable& release, double horizontal, double upward, std::optional<double> heading) {
    const double speed = std::hypot(horizontal, upward);
    release.add("speed", speed, "m/s");
    if (speed == 0.0) return;
    release.add("path_angle", std::atan2(0.0 - upward, horizontal) * 180.0 / pi, "deg");
    if (heading)
        release.add("heading", compass(*heading), "deg");
    else if (horizontal > 0.0)
        release.add("heading", "\"90 deg\"", "assumed: the file does not say");
}

void add_opening(ImportedScene& scene, ImportedTable& parachute, const SmallOpening& opening) {
    parachute.add("deploy.by", "\"line-stretch\"",
                  opening.when.empty() ? "at release: " + opening.comment : std::string());
    if (!opening.when.empty()) parachute.add("deploy.when", opening.when, opening.comment);
    const double v = opening.airspeed.value_or(1e9), fall = 2.0 * fall_gravity * opening.diameter;
    if (v * v < fall) {
        const double time = (std::sqrt(v * v + fall) - v) / fall_gravity;
        parachute.add("fill_time.time", time, "s",
                      fmt::format("in which it falls one diameter from {:.3g} m/s", v));
        scene.assumptions.push_back(
            fmt::format("'{}' opens at {:.3g} m/s and fills while it falls one diameter: D0/v_s "
                        "is no measure so near to rest",
                        parachute.path.substr(parachute.path.find('.') + 1), v));
    } else {
        parachute.add(
            "fill_time.n",
            "{ value = 1, source = \"the middle of what fits measured openings of rockets, 0.3 to 1.4 "
            "(docs/validation.md)\", grade = \"C\" }");
    }
    parachute.add("initial_phase", "\"0 s\"", "the transit of half a diameter is part of that");
}

double airspeed_after(const ImportedScene& scene, double horizontal, double upward,
                      std::optional<double> heading, double delay) {
    double east = horizontal * std::sin(heading.value_or(0.5 * pi)),
           north = horizontal * std::cos(heading.value_or(0.5 * pi));
    if (scene.uniform_wind) {
        east += scene.uniform_wind->speed * std::sin(scene.uniform_wind->from);
        north += scene.uniform_wind->speed * std::cos(scene.uniform_wind->from);
    }
    return std::hypot(east, north, upward - fall_gravity * delay);
}

void add_common_assumptions(ImportedScene& scene, std::string_view program) {
    scene.assumptions.push_back(
        fmt::format("each parachute starts at line stretch where its trigger is met, and fills within "
                    "one diameter: {} opens it at once",
                    program));
    scene.assumptions.push_back(
        fmt::format("the rocket below its parachutes has no drag of its own, as with {}", program));
}

}  // namespace twinchute::exchange
