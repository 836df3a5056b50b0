// A packed scene begun anew at the snatch that a run of it came to.
#pragma once

#include <optional>

#include "lib/math/vec.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// Where a run was at its snatch. The payload's place and path, the speed of the whole system.
struct SnatchState {
    double time = 0.0;                     ///< [s] since release
    Vec3 place = Vec3::Zero();             ///< [m] of the payload; altitude above sea level
    Vec3 payload_velocity = Vec3::Zero();  ///< [m/s] over ground
    double airspeed = 0.0;                 ///< v_s [m/s] of the centre of mass
};

/// From events, history and metrics of a record; nothing where the parachute never came to snatch.
std::optional<SnatchState> snatch_state(const RunRecord& record, const Release& release);

/// Scene from line stretch on, along the payload's path through the air with the airspeed of the
/// whole. Without noise: that of a pack says nothing of a canopy drawn out.
Scene from_snatch(const Scene& packed, const SnatchState& state);

}  // namespace twinchute::compare
