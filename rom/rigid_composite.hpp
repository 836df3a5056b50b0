// The equation of motion of the reduced-order model: payload and parachute as one rigid body
// that moves through the air with a prescribed drag area (Knacke NWC TP 6575, 5.4; Ewing).
#pragma once

#include <algorithm>

#include "lib/models/atmosphere.hpp"
#include "lib/models/inflation.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// What the air that moves with the canopy does to the equation of motion.
enum class Air { none, inertia_only, accreting };

template <int dimensions, Air air>
struct RigidComposite {
    Atmosphere atmosphere;
    Inflation inflation;
    double gravity = 0.0;            ///< [m/s^2]
    double payload_mass = 0.0;       ///< [kg]
    double parachute_mass = 0.0;     ///< [kg]
    double payload_drag_area = 0.0;  ///< [m^2]
    double steady_radius = 0.0;      ///< R_0 [m], for the added mass
    const AddedMassSpec* added_mass = nullptr;
    const Wind* wind = nullptr;  ///< in three dimensions only

    Phase phase = Phase::initial;  ///< set by the solver at each stage boundary

    double drag_area(double t) const {
        return inflation.steady_drag_area * inflation.drag_area_ratio(phase, t).value;
    }

    /// Velocity relative to the air [m/s].
    Vec<dimensions> airspeed(const Motion<dimensions>& motion) const {
        return airspeed_of<dimensions>(motion.velocity, motion.altitude(), wind);
    }

    /// (m_l + m_p + M_a) dv/dt = (m_l + m_p) g + D [- (dM_a/dt) v_air while M_a grows, if accreting]:
    /// gravity weighs the material, not the air.
    Vec<dimensions> acceleration(double t, const Motion<dimensions>& motion) const {
        const double rho = atmosphere.at(motion.altitude()).density;
        const double weighed = payload_mass + parachute_mass;
        const Vec<dimensions> velocity = airspeed(motion);
        double inertia = weighed;
        Vec<dimensions> force = drag_of<dimensions>(rho, drag_area(t) + payload_drag_area, velocity);
        force[dimensions - 1] -= weighed * gravity;
        if constexpr (air != Air::none) {
            const ValueAndRate mass = inflation.added_mass(*added_mass, phase, t, rho, steady_radius);
            inertia += mass.value;
            if constexpr (air == Air::accreting) force -= std::max(0.0, mass.rate) * velocity;
        }
        return force / inertia;
    }

    /// |m_l (a - g) - F_drag,payload| [N]: what the risers pull on the payload.
    double opening_force(double t, const Motion<dimensions>& motion) const {
        Vec<dimensions> force = payload_mass * acceleration(t, motion);
        force[dimensions - 1] += payload_mass * gravity;
        const double rho = atmosphere.at(motion.altitude()).density;
        return (force - drag_of<dimensions>(rho, payload_drag_area, airspeed(motion))).norm();
    }
};

}  // namespace twinchute::rom
