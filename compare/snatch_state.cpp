#include "compare/snatch_state.hpp"

#include <cmath>

#include "compare/histories.hpp"
#include "lib/scene/assemble.hpp"

namespace twinchute::compare {
namespace {

/// A channel at time t within the record, linear between its rows, where it jumps what follows; nothing where
/// the record has none of that name.
std::optional<double> channel_at(const RunRecord& record, const char* name, double t) {
    const std::optional<Curve> curve = curve_of(record, name);
    if (!curve) return {};
    return value_after(*curve, t);
}

/// Difference quotient over the 10 ms around t: histories of the full model have a row every 5 ms. Over the
/// 5 ms after t where the speed jumps there, as lines do to it that lock up without weight.
double rate_at(const RunRecord& record, const char* name, double t) {
    constexpr double reach = 5e-3;
    const std::optional<Curve> curve = curve_of(record, name), speed = curve_of(record, "speed");
    if (!curve) return 0.0;
    const bool jumps = speed && value_before(*speed, t) != value_after(*speed, t);
    const double from = jumps ? t : t - reach, to = t + reach;
    return (value_before(*curve, to) - value_after(*curve, from)) / (to - from);
}

}  // namespace

std::optional<SnatchState> snatch_state(const RunRecord& record, const Release& release) {
    const Event* snatch = record.find_event("snatch");
    const auto airspeed = record.metric("snatch_speed_m_s");
    if (snatch == nullptr || !airspeed) return {};
    const double t = snatch->time;
    SnatchState state;
    state.time = t;
    state.airspeed = *airspeed;
    state.place = {channel_at(record, "east", t).value_or(0.0), channel_at(record, "north", t).value_or(0.0),
                   snatch->altitude};
    // The event knows how fast, the history which way.
    Vec3 velocity(rate_at(record, "east", t), rate_at(record, "north", t),
                  channel_at(record, "vertical_speed", t).value_or(-snatch->speed));
    if (!(velocity.norm() > 0.0)) velocity = -release.speed * Vec3::UnitZ();
    state.payload_velocity = velocity.norm() > 0.0 ? Vec3(snatch->speed * velocity.normalized()) : velocity;
    return state;
}

Scene from_snatch(const Scene& packed, const SnatchState& state) {
    Scene scene = packed;
    const double altitude = state.place.z();
    const Vec3 wind = packed.environment.wind ? packed.environment.wind->at(altitude) : Vec3(Vec3::Zero());
    const Vec3 through_air = state.payload_velocity - wind;
    const Vec3 velocity = through_air.norm() > 0.0
                              ? Vec3(through_air * (state.airspeed / through_air.norm()) + wind)
                              : Vec3(wind - state.airspeed * Vec3::UnitZ());
    const Release at_rest{altitude, 0.0, 0.5 * pi, packed.release.heading};
    scene.release = carried_by(velocity, at_rest);
    scene.parachutes.front().deploy = {};
    scene.full.noise.reset();
    if (scene.stop.kind == Trigger::Kind::time) scene.stop.value -= state.time;
    return scene;
}

}  // namespace twinchute::compare
