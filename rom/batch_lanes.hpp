// Inner loops of batches: a canopy that fills in still air, of all lanes at once.
#pragma once

#include <array>
#include <cstdint>

#include "rom/batch.hpp"

namespace twinchute::rom {

struct alignas(64) Row : std::array<double, batch_lanes> {};
struct alignas(64) Flags : std::array<std::int64_t, batch_lanes> {};

/// Data of the right-hand side, of a stage.
struct LaneData {
    Row weighed, hung;              ///< [kg] material of all, and of the payload
    Row gravity;                    ///< [m/s^2]
    Row steady_area, payload_area;  ///< [m^2]
    /// [m^3] Air mass over density is (still + ramping phi') r^1.5, r the drag area over the steady one.
    Row still, ramping;
    Row duration;               ///< [s] of the stage
    Row ramp_begin, ramp_rise;  ///< [-] phi' over the stage
    Row density, slope, bend;   ///< [kg/m^3, /m, /m^2] of the air about `level` [m], a parabola
    Row level;
};

/// Drag areas over the steady ones [-], and their powers of 1.5.
struct Growth {
    Row ratio, power;
};

/// State and rates of all lanes at one moment, and the quantities that are followed.
struct Node {
    Row time, altitude, ahead, climb;  ///< [s], [m], [m/s] horizontal and upward
    Row ahead_rate, climb_rate;        ///< [m/s^2]
    Row force, acceleration;           ///< [N], [m/s^2]
};

/// Rates over the stage's own time, of a state laid out by component: altitude, ahead, climb.
void stage_rates(const LaneData& data, double s, const Growth& growth, const double* state, double* rates);

/// Rates and followed quantities of a node at `s` whose state is there.
void look(const LaneData& data, double s, const Growth& growth, Node& node);

/// A place inside a step, with the weights of dense output there: of the way over the length of the step, and
/// of velocity and rate at both ends.
struct InnerPlace {
    double way, begin, begin_rate, end, end_rate;            ///< of the velocity
    double p_way, p_begin, p_begin_rate, p_end, p_end_rate;  ///< of the position, over the length
};
/// Weights of a place at this share of the step.
InnerPlace inner_place(double share);

/// The followed quantities at a place of the step between two nodes, where `s` and `growth` are.
void look_inside(const LaneData& data, double s, const Growth& growth, const Node& from, const Node& to,
                 const InnerPlace& place, Row& force, Row& acceleration);

/// Maxima of a quantity of all lanes.
struct Maxima {
    Row at, value;
};
/// Keeps what `to` has at its end. `turns`: lanes of `watched` with a maximum in this step or in the one
/// before, whose beginning had `before` (null: there is none); at the end of a stage (`last`) also those that
/// still rise. False where there are none.
bool find_turns(const Flags& watched, const Row* before, const Row& from, const Row& to, const Row& time,
                bool last, Maxima& maxima, Flags& turns);

}  // namespace twinchute::rom
