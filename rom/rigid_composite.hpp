// The equation of motion of the reduced-order model: payload and parachutes as one rigid body
// that moves through the air with a prescribed drag area (Knacke NWC TP 6575, 5.4; Ewing).
#pragma once

#include <algorithm>

#include "lib/models/atmosphere.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "rom/canopy_force.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// Payload and all canopies that are out, moving as one body, with the air that moves along.
template <int dimensions>
struct RigidComposite {
    Atmosphere atmosphere;
    const OpeningSequence* canopies = nullptr;
    double gravity = 0.0;                       ///< [m/s^2]
    double payload_mass = 0.0;                  ///< [kg]
    double payload_drag_area = 0.0;             ///< [m^2]
    const AddedMassSpec* added_mass = nullptr;  ///< null: none
    bool by_mach = false;                       ///< the drag area of a canopy goes by the Mach number
    const Wind* wind = nullptr;                 ///< in three dimensions only

    /// [kg] below the risers: packs that are still closed ride on the payload.
    double hung_mass() const { return payload_mass + canopies->packed_mass(); }

    /// Velocity relative to the air [m/s] at the payload.
    Vec<dimensions> airspeed(const Motion<dimensions>& motion) const {
        return airspeed_of<dimensions>(motion.velocity, motion.altitude(), wind);
    }
    /// Airspeed at the canopy, which trails behind the payload and meets the wind of its own altitude.
    Vec<dimensions> canopy_airspeed(const Motion<dimensions>& motion, const Vec<dimensions>& airspeed) const {
        if (dimensions < 3 || !wind || wind->levels.size() < 2) return airspeed;
        const double speed = airspeed.norm();
        if (!(speed > 0.0)) return airspeed;
        const double above = -canopies->distance() * airspeed[dimensions - 1] / speed;
        return airspeed_of<dimensions>(motion.velocity, motion.altitude() + above, wind);
    }

    /// C_D S [m^2] of all canopies that are out, in air that the payload meets with `airspeed` [m/s].
    double canopy_drag_area(double t, const Motion<dimensions>& motion,
                            const Vec<dimensions>& airspeed) const {
        return by_mach ? canopies->drag_area(t, mach_number(motion, airspeed)) : canopies->drag_area(t);
    }
    /// Where a drag area goes by it; otherwise 0: air may be without a temperature.
    double mach_number(const Motion<dimensions>& motion, const Vec<dimensions>& airspeed) const {
        return by_mach ? airspeed.norm() / *atmosphere.speed_of_sound(motion.altitude()) : 0.0;
    }
    bool accretes() const { return added_mass && added_mass->momentum == AddedMassMomentum::accreting; }

    /// Loads on the composite at one moment.
    struct Loads {
        double density, drag_area, added_mass;   ///< [kg/m^3], [m^2] of all canopies that are out, [kg]
        Vec<dimensions> airspeed, acceleration;  ///< [m/s] at the payload, [m/s^2]
    };

    /// (m_l + m_p + M_a) dv/dt = (m_l + m_p) g + D [- (dM_a/dt) v_air while M_a grows, if accreting]:
    /// gravity weighs the material, not the air. Drag, m_p and M_a: of all canopies that are out.
    Loads loads(double t, const Motion<dimensions>& motion) const {
        Loads now{atmosphere.at(motion.altitude()).density, 0.0, 0.0, airspeed(motion), {}};
        now.drag_area = canopy_drag_area(t, motion, now.airspeed);
        const double weighed = hung_mass() + canopies->out_mass();
        const Vec<dimensions> velocity = canopy_airspeed(motion, now.airspeed);
        Vec<dimensions> force = drag_of<dimensions>(now.density, now.drag_area, velocity) +
                                drag_of<dimensions>(now.density, payload_drag_area, now.airspeed);
        force[dimensions - 1] -= weighed * gravity;
        if (added_mass) {
            const ValueAndRate mass = canopies->added_mass(*added_mass, t, now.density);
            now.added_mass = mass.value;
            if (accretes()) force -= std::max(0.0, mass.rate) * velocity;
        }
        now.acceleration = force / (weighed + now.added_mass);
        return now;
    }
    /// Loads with canopies that fill by themselves, `filled` for all of them together: the air within has
    /// been brought to speed by their drag, what is apparent takes its momentum while it grows.
    Loads loads(double t, const Motion<dimensions>& motion, const Filled& filled) const {
        Loads now{atmosphere.at(motion.altitude()).density, 0.0, 0.0, airspeed(motion), {}};
        const double mach = mach_number(motion, now.airspeed);
        now.drag_area = filled.drag_area;
        double capture = 0.0;
        for (const Canopy& c : canopies->all()) {
            if (!c.is_out() || c.fills_itself()) continue;
            now.drag_area += c.count * OpeningSequence::drag_area_of(c, t, mach);
            if (added_mass) {
                const ValueAndRate mass = OpeningSequence::added_mass_of(c, *added_mass, t, now.density);
                now.added_mass += c.count * mass.value;
                capture += c.count * mass.rate;
            }
        }
        now.added_mass += filled.added_mass;
        capture = (accretes() ? std::max(0.0, capture) : 0.0) + filled.capture;
        const double weighed = hung_mass() + canopies->out_mass();
        const Vec<dimensions> velocity = canopy_airspeed(motion, now.airspeed);
        Vec<dimensions> force = drag_of<dimensions>(now.density, now.drag_area, velocity) +
                                drag_of<dimensions>(now.density, payload_drag_area, now.airspeed) -
                                capture * velocity;
        force[dimensions - 1] -= weighed * gravity;
        now.acceleration = force / (weighed + now.added_mass);
        return now;
    }
    Vec<dimensions> acceleration(double t, const Motion<dimensions>& motion) const {
        return loads(t, motion).acceleration;
    }

    /// |m_l (a - g) - F_drag,payload| [N]: what all risers together pull on the payload.
    double opening_force(const Loads& now) const {
        Vec<dimensions> force = hung_mass() * now.acceleration;
        force[dimensions - 1] += hung_mass() * gravity;
        return (force - drag_of<dimensions>(now.density, payload_drag_area, now.airspeed)).norm();
    }
};

}  // namespace twinchute::rom
