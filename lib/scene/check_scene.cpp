// What has to fit together in a scene although every key is right on its own.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/assemble.hpp"

namespace twinchute {
namespace {

/// The complaint about a key, at its place.
class Complain {
public:
    explicit Complain(const Values& values) : values_(values) {}

    [[noreturn]] void about(const char* key, std::string problem, std::string why, std::string hint) const {
        throw SceneError(values_.place(key), key, std::move(problem), std::move(why), std::move(hint));
    }

private:
    const Values& values_;
};

void check_release(const Scene& scene, const Values& values, const Complain& complain) {
    const Environment& e = scene.environment;
    const double altitude = scene.release.altitude;
    const char* key = values.given("release.altitude") ? "release.altitude" : "release.height";
    if (altitude <= e.ground)
        complain.about(key, "the release is not above the ground",
                       fmt::format("altitude {} m, ground {} m", altitude, e.ground),
                       "raise the release or lower environment.ground");
    const AtmosphereModel& air = *e.atmosphere.model;
    if (altitude < air.lowest || altitude > air.highest)
        complain.about(key, fmt::format("{} m is outside the atmosphere", altitude),
                       fmt::format("'{}' reaches from {} to {} m", air.name, air.lowest, air.highest),
                       "release lower or choose another atmosphere");
    if (e.ground < air.lowest)
        complain.about("environment.ground", fmt::format("{} m is outside the atmosphere", e.ground),
                       fmt::format("'{}' reaches from {} to {} m", air.name, air.lowest, air.highest),
                       "raise the ground or choose another atmosphere");
}

void check_canopy(const Parachute& p, const Complain& complain) {
    if (p.vent_diameter >= p.nominal_diameter)
        complain.about("parachute.vent_diameter", "the vent is not smaller than the canopy",
                       fmt::format("vent {} m, D0 {} m", p.vent_diameter, p.nominal_diameter),
                       "about D0/10 is common");
    if (p.gores % p.risers != 0)
        complain.about("parachute.risers", fmt::format("{} does not divide {} gores", p.risers, p.gores),
                       "every link takes the same number of lines",
                       "choose a divisor of the number of gores");
    // No canopy comes near it: a key is likely in another unit.
    const double coefficient = p.drag_area / (0.25 * pi * p.nominal_diameter * p.nominal_diameter);
    if (coefficient > 5.0)
        complain.about("parachute.drag_area",
                       fmt::format("{} m^2 is a drag coefficient of {:.2f}", p.drag_area, coefficient),
                       fmt::format("on the nominal area of D0 = {} m", p.nominal_diameter),
                       "check drag_area and nominal_diameter");
}

/// A line-stretch start snatches at once, so that its times are known before anything runs.
void check_opening(const Scene& scene, const Values& values, const Complain& complain) {
    const Parachute& p = scene.parachutes.front();
    const double speed = scene.release.speed;
    const char* key = values.given("release.speed") ? "release.speed" : "release.airspeed";
    if (speed <= 0.0)
        complain.about(key, "a line-stretch start needs a speed", "lines and canopy are drawn out by the air",
                       "give the snatch speed");
    const double density = scene.environment.atmosphere.at(scene.release.altitude).density;
    const double filling = p.fill_time.seconds({p.nominal_diameter, speed, density});
    const double initial =
        p.initial_phase.transit ? 0.5 * p.nominal_diameter / speed : p.initial_phase.seconds;
    if (!(filling > 0.0) || !std::isfinite(filling))
        complain.about("parachute.fill_time.model", fmt::format("a filling time of {} s", filling),
                       "it has to be positive", "check fill_time and release.speed");
    if (initial >= filling) {
        const char* given = values.given("parachute.initial_phase") ? "parachute.initial_phase"
                            : p.fill_time.given > 0.0               ? "parachute.fill_time.time"
                                                                    : "parachute.fill_time.n";
        complain.about(given, "the initial phase is not shorter than the filling time",
                       fmt::format("t_i = {:.4g} s, t_f = {:.4g} s", initial, filling),
                       "shorten initial_phase or lengthen fill_time");
    }
}

}  // namespace

void check_scene(const Scene& scene, const Values& values) {
    const Complain complain(values);
    check_release(scene, values, complain);
    check_canopy(scene.parachutes.front(), complain);
    check_opening(scene, values, complain);
}

}  // namespace twinchute
