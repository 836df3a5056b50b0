// The equation of motion of the reduced-order model: payload and parachutes as one rigid body
// that moves through the air with a prescribed drag area (Knacke NWC TP 6575, 5.4; Ewing).
#pragma once

#include <algorithm>

#include "lib/models/atmosphere.hpp"
#include "lib/solve/canopies.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// What the air that moves with the canopy does to the equation of motion.
enum class Air { none, inertia_only, accreting };

template <int dimensions, Air air>
struct RigidComposite {
    Atmosphere atmosphere;
    const Canopies* canopies = nullptr;
    double gravity = 0.0;            ///< [m/s^2]
    double payload_mass = 0.0;       ///< [kg]
    double payload_drag_area = 0.0;  ///< [m^2]
    const AddedMassSpec* added_mass = nullptr;
    const Wind* wind = nullptr;  ///< in three dimensions only

    /// [kg] below the risers: packs that are still closed ride on the payload.
    double hung_mass() const { return payload_mass + canopies->packed_mass(); }

    /// Velocity relative to the air [m/s].
    Vec<dimensions> airspeed(const Motion<dimensions>& motion) const {
        return airspeed_of<dimensions>(motion.velocity, motion.altitude(), wind);
    }

    /// (m_l + m_p + M_a) dv/dt = (m_l + m_p) g + D [- (dM_a/dt) v_air while M_a grows, if accreting]:
    /// gravity weighs the material, not the air. Drag, m_p and M_a: of all canopies that are out.
    Vec<dimensions> acceleration(double t, const Motion<dimensions>& motion) const {
        const double rho = atmosphere.at(motion.altitude()).density;
        const double weighed = hung_mass() + canopies->out_mass();
        const Vec<dimensions> velocity = airspeed(motion);
        double inertia = weighed;
        Vec<dimensions> force =
            drag_of<dimensions>(rho, canopies->drag_area(t) + payload_drag_area, velocity);
        force[dimensions - 1] -= weighed * gravity;
        if constexpr (air != Air::none) {
            const ValueAndRate mass = canopies->added_mass(*added_mass, t, rho);
            inertia += mass.value;
            if constexpr (air == Air::accreting) force -= std::max(0.0, mass.rate) * velocity;
        }
        return force / inertia;
    }

    /// |m_l (a - g) - F_drag,payload| [N]: what all risers together pull on the payload.
    double opening_force(double t, const Motion<dimensions>& motion) const {
        Vec<dimensions> force = hung_mass() * acceleration(t, motion);
        force[dimensions - 1] += hung_mass() * gravity;
        const double rho = atmosphere.at(motion.altitude()).density;
        return (force - drag_of<dimensions>(rho, payload_drag_area, airspeed(motion))).norm();
    }
};

}  // namespace twinchute::rom
