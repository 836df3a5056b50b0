// Flight of the payload under no canopy: a point mass with its own drag, or a rigid body that nothing turns.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fullsim/state.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// The payload at one instant.
struct PayloadFlight {
    double time = 0.0;                   ///< [s]
    Vec3 position, velocity;             ///< [m], [m/s] over ground
    double mass = 0.0;                   ///< [kg] with all packs that it carries
    Vec3 acceleration = Vec3::Zero();    ///< [m/s^2]
    std::optional<BodyState> body = {};  ///< how it turns, of a rigid payload.body
};

/// The payload as the scene releases it, with all its packs. A body hangs straight behind the first
/// parachute.
PayloadFlight released_payload(const Scene& scene);

/// Its acceleration [m/s^2]: weight and drag, at the attitude of a body where the scene has a table of it.
Vec3 free_acceleration(const Scene& scene, const PayloadFlight& payload);

/// Functions of the flight each of which ends it in the first moment at which it has changed its sign.
using FlightWatch = std::function<std::vector<double>(const PayloadFlight&)>;

/// On from `from` to `end` [s], or until one of `watch` changes its sign. Throws std::runtime_error where the
/// integrator fails.
PayloadFlight fly_free(const Scene& scene, const PayloadFlight& from, double end,
                       const FlightWatch& watch = {});

}  // namespace twinchute::fullsim
