#include "rom/batch_lanes.hpp"

#include <algorithm>
#include <cmath>

#include "lib/math/wide_loops.hpp"
#include "lib/solve/dense_output.hpp"

namespace twinchute::rom {
namespace {

/// Rates of one lane, and what its risers pull.
struct LaneLoads {
    double ahead_rate, climb_rate;  ///< [m/s^2]
    double force;                   ///< [N]
};

/// The equation of motion of RigidComposite at s in a stage, of canopies that batches take; `ratio` of the
/// drag area to the steady one, `power` its power of 1.5. Typed again for this layout, and held to it by
/// tests.
[[gnu::always_inline]] inline LaneLoads loads_of(const LaneData& d, std::size_t l, double s, double ratio,
                                                 double power, double z, double vx, double vz) {
    const double h = z - d.level[l];
    const double rho = d.density[l] + h * (d.slope[l] + h * d.bend[l]);
    const double half = 0.5 * rho * std::sqrt(vx * vx + vz * vz);
    const double ramp = d.ramp_begin[l] + s * d.ramp_rise[l];
    const double mass = d.weighed[l] + rho * power * (d.still[l] + ramp * d.ramping[l]);
    const double ease = 1.0 / mass, drag = half * (d.steady_area[l] * ratio + d.payload_area[l]) * ease;
    const double ax = -drag * vx, az = -drag * vz - d.weighed[l] * d.gravity[l] * ease;
    const double own = half * d.payload_area[l];
    const double fx = d.hung[l] * ax + own * vx, fz = d.hung[l] * (az + d.gravity[l]) + own * vz;
    return {ax, az, std::sqrt(fx * fx + fz * fz)};
}

}  // namespace

TWINCHUTE_WIDE_LOOPS
void stage_rates(const LaneData& data, double s, const Growth& growth, const double* state, double* rates) {
    const double *z = state, *vx = state + batch_lanes, *vz = state + 2 * batch_lanes;
    double* __restrict dz = rates, * __restrict ax = rates + batch_lanes, * __restrict az = rates + 2 * batch_lanes;
    for (std::size_t l = 0; l < batch_lanes; ++l) {
        const LaneLoads now = loads_of(data, l, s, growth.ratio[l], growth.power[l], z[l], vx[l], vz[l]);
        dz[l] = data.duration[l] * vz[l];
        ax[l] = data.duration[l] * now.ahead_rate;
        az[l] = data.duration[l] * now.climb_rate;
    }
}

TWINCHUTE_WIDE_LOOPS
void look(const LaneData& data, double s, const Growth& growth, Node& node) {
    double *__restrict ax = node.ahead_rate.data(), *__restrict az = node.climb_rate.data(),
                      *__restrict force = node.force.data(),
                      *__restrict acceleration = node.acceleration.data();
    for (std::size_t l = 0; l < batch_lanes; ++l) {
        const LaneLoads now = loads_of(data, l, s, growth.ratio[l], growth.power[l], node.altitude[l],
                                       node.ahead[l], node.climb[l]);
        ax[l] = now.ahead_rate, az[l] = now.climb_rate, force[l] = now.force;
        acceleration[l] = std::sqrt(now.ahead_rate * now.ahead_rate + now.climb_rate * now.climb_rate);
    }
}

InnerPlace inner_place(double share) {
    // Dense output is linear in the ends of its step: what it makes of one of them alone is its weight.
    const auto with = [&](int one) {
        const auto is = [&](int i) { return i == one ? 1.0 : 0.0; };
        const std::array begin{0.0, is(1)}, begin_rate{is(1), is(2)}, end{is(0), is(3)},
            end_rate{is(3), is(4)};
        std::array<double, 2> state{};
        interpolate_step({0.0, 1.0, begin, begin_rate, end, end_rate}, 1, share, state);
        return state;
    };
    const auto way = with(0), begin = with(1), begin_rate = with(2), end = with(3), end_rate = with(4);
    return {way[1], begin[1], begin_rate[1], end[1], end_rate[1],
            way[0], begin[0], begin_rate[0], end[0], end_rate[0]};
}

TWINCHUTE_WIDE_LOOPS
void look_inside(const LaneData& data, double s, const Growth& growth, const Node& from, const Node& to,
                 const InnerPlace& place, Row& force, Row& acceleration) {
    const InnerPlace p = place;
    double* __restrict pull = force.data(), * __restrict slowing = acceleration.data();
    for (std::size_t l = 0; l < batch_lanes; ++l) {
        const double length = to.time[l] - from.time[l];
        // The way ahead is not integrated: that of a cubic through velocities and rates.
        const double ahead_way = 0.5 * (from.ahead[l] + to.ahead[l]) +
                                 length / 12.0 * (from.ahead_rate[l] - to.ahead_rate[l]),
                     climb_way = (to.altitude[l] - from.altitude[l]) / length;
        const double vx = p.way * ahead_way + p.begin * from.ahead[l] + p.end * to.ahead[l] +
                          length * (p.begin_rate * from.ahead_rate[l] + p.end_rate * to.ahead_rate[l]);
        const double vz = p.way * climb_way + p.begin * from.climb[l] + p.end * to.climb[l] +
                          length * (p.begin_rate * from.climb_rate[l] + p.end_rate * to.climb_rate[l]);
        const double z =
            from.altitude[l] +
            length * (p.p_way * climb_way + p.p_begin * from.climb[l] + p.p_end * to.climb[l] +
                      length * (p.p_begin_rate * from.climb_rate[l] + p.p_end_rate * to.climb_rate[l]));
        const LaneLoads now = loads_of(data, l, s, growth.ratio[l], growth.power[l], z, vx, vz);
        pull[l] = now.force;
        slowing[l] = std::sqrt(now.ahead_rate * now.ahead_rate + now.climb_rate * now.climb_rate);
    }
}

TWINCHUTE_WIDE_LOOPS
bool find_turns(const Flags& watched, const Row* before, const Row& from, const Row& to, const Row& time,
                bool last, Maxima& maxima, Flags& turns) {
    constexpr double near = 0.9;  // of the largest: what is less has no say
    double* __restrict largest = maxima.value.data(), * __restrict at = maxima.at.data();
    std::int64_t* __restrict found = turns.data();
    const double* earlier = before ? before->data() : from.data();
    const std::int64_t no_earlier = before ? 0 : 1, to_the_end = last ? 1 : 0;
    for (std::size_t l = 0; l < batch_lanes; ++l) {
        const double begin = from[l], end = to[l];
        const std::int64_t raised = watched[l] & static_cast<std::int64_t>(end > largest[l]);
        at[l] = raised ? time[l] : at[l];
        largest[l] = raised ? end : largest[l];
        const std::int64_t falls = end <= begin, rose = no_earlier | (earlier[l] < begin);
        const std::int64_t counts =
            watched[l] & static_cast<std::int64_t>((begin > end ? begin : end) >= near * largest[l]);
        found[l] = counts & ((falls & rose) | (~falls & to_the_end));
    }
    std::int64_t any = 0;
    for (std::size_t l = 0; l < batch_lanes; ++l)
        any |= found[l];
    return any != 0;
}

}  // namespace twinchute::rom
