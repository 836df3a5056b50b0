#include "compare/snatch_state.hpp"

#include <algorithm>
#include <cmath>

#include "lib/scene/assemble.hpp"

namespace twinchute::compare {
namespace {

/// A channel at time t, linear between its rows; nothing where the record has none of that name.
std::optional<double> channel_at(const RunRecord& record, const char* name, double t) {
    const Channel *time = record.find_channel("time"), *channel = record.find_channel(name);
    if (time == nullptr || channel == nullptr || time->values.size() < 2) return {};
    const auto& x = time->values;
    const auto above = std::clamp<std::ptrdiff_t>(std::ranges::lower_bound(x, t) - x.begin(), 1,
                                                  static_cast<std::ptrdiff_t>(x.size()) - 1);
    const auto i = static_cast<std::size_t>(above);
    const double step = x[i] - x[i - 1];
    const double share = step > 0.0 ? std::clamp((t - x[i - 1]) / step, 0.0, 1.0) : 1.0;
    return channel->values[i - 1] + share * (channel->values[i] - channel->values[i - 1]);
}

/// Difference quotient over the 10 ms around t: histories of the full model have a row every 5 ms.
double rate_at(const RunRecord& record, const char* name, double t) {
    constexpr double reach = 5e-3;
    const auto before = channel_at(record, name, t - reach), after = channel_at(record, name, t + reach);
    return before && after ? (*after - *before) / (2.0 * reach) : 0.0;
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
