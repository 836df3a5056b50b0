#include "fullsim/step/aero_reference.hpp"

namespace twinchute::fullsim {

Vec3 reference_velocity(const NodeSums& sums, const Vec3& payload) {
    const Vec3 axis = (sums.canopy_position - payload).normalized();
    return sums.canopy_velocity + (sums.system_velocity - sums.canopy_velocity).dot(axis) * axis;
}

void update_air(State& state, const Atmosphere& atmosphere, NodeIndex payload) {
    AeroState& air = state.air;
    const Vec3 position = to_vec3(state.node[payload].x);
    const AirState at = atmosphere.at(position.z());
    air.density = at.density;
    air.viscosity = at.viscosity;
    const Vec3 relative = -reference_velocity(state.sums, position);
    air.airspeed = relative.norm();
    if (air.airspeed > smallest_airspeed) air.direction = relative / air.airspeed;
    air.dynamic_pressure = 0.5 * air.density * air.airspeed * air.airspeed;
}

}  // namespace twinchute::fullsim
