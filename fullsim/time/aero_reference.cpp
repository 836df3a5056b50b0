#include "fullsim/time/aero_reference.hpp"

#include <cmath>

namespace twinchute::fullsim {

Vec3 reference_velocity(const NodeSums& sums, const Vec3& payload, double system_mass, double air_mass) {
    const Vec3 all = (system_mass * sums.system_velocity + air_mass * sums.canopy_area_velocity) /
                     (system_mass + air_mass);
    const Vec3 axis = (sums.canopy_position - payload).normalized();
    return sums.canopy_velocity + (all - sums.canopy_velocity).dot(axis) * axis;
}

double air_mass_in_reference(double added_mass, double time_since_full_open, double time_scale) {
    constexpr double approach = 0.5 / time_scale_of_c9;
    return time_since_full_open > 0.0
               ? added_mass * -std::expm1(-time_since_full_open / (approach * time_scale))
               : 0.0;
}

void update_air(State& state, const Environment& environment, NodeIndex payload, double system_mass,
                double air_mass) {
    AeroState& air = state.air;
    const Vec3 position = to_vec3(state.node[payload].x);
    const AirState at = environment.atmosphere.at(position.z());
    air.density = at.density;
    air.viscosity = at.viscosity;
    if (environment.wind) {
        air.wind = environment.wind->at(state.sums.canopy_position.z());
        air.wind_at_payload = environment.wind->at(position.z());
    }
    const Vec3 relative = air.wind - reference_velocity(state.sums, position, system_mass, air_mass);
    air.airspeed = relative.norm();
    if (air.airspeed > smallest_airspeed) air.direction = relative / air.airspeed;
    air.dynamic_pressure = 0.5 * air.density * air.airspeed * air.airspeed;
}

}  // namespace twinchute::fullsim
