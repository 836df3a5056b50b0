// The equations of motion until snatch: payload and parachute as two point masses, first apart, then joined
// by elastic lines.
#pragma once

#include <algorithm>

#include "lib/models/atmosphere.hpp"
#include "lib/scene/deployment.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// A force between two corners of its history: linear there, whatever it does beyond. [N], [N/s], [s]
struct ForcePiece {
    double value = 0.0, rate = 0.0, middle = 0.0;

    double at(double t) const { return value + rate * (t - middle); }
};

/// Distance and velocity of the parachute, seen from the payload.
template <int dimensions>
struct Separation {
    Vec<dimensions> distance, velocity;  ///< [m], [m/s] of the parachute less the payload's

    double length() const { return distance.norm(); }
    /// Separation speed [m/s].
    double speed() const { return distance.dot(velocity) / length(); }
};

/// Phase of a deployment, by what acts on the parachute before snatch.
enum class DeploymentPhase {
    static_line,  ///< held by the anchor of its static line: it moves as that does, lines pay out without
                  ///< force
    free_pack,    ///< in its pack: weight, drag and extraction force
    taut_lines    ///< pulled by elastic lines
};

/// State vector: the payload's position and velocity, then distance and velocity of the parachute from it.
/// The distance is a component of its own because it is small beside the altitude, and the lines' stretch
/// smaller.
template <int dimensions>
struct TwoBodies {
    Atmosphere atmosphere;
    const Wind* wind = nullptr;
    double gravity = 0.0;                       ///< [m/s^2]
    double payload_mass = 0.0;                  ///< [kg] with all that it carries and hangs under
    double payload_drag_area = 0.0;             ///< [m^2]
    double parachute_mass = 0.0;                ///< [kg]
    double pack_drag_area = 0.0;                ///< [m^2]
    double stiffness = 0.0;                     ///< [N/m] of all lines and risers
    double taut_distance = 0.0;                 ///< [m] between the two where the lines come taut
    Vec<dimensions> behind;                     ///< unit vector of the extraction force
    const OpeningSequence* canopies = nullptr;  ///< that the payload hangs under already
    const AddedMassSpec* added_mass = nullptr;  ///< of theirs
    bool by_mach = false;                       ///< their drag area goes by the Mach number

    DeploymentPhase phase = DeploymentPhase::free_pack;  ///< set at each stage boundary, as is the force
    ForcePiece extraction;

    static Separation<dimensions> separation_of(std::span<const double> y) {
        return {Vec<dimensions>(y.data() + 2 * dimensions), Vec<dimensions>(y.data() + 3 * dimensions)};
    }

    /// [N] of the lines. A stage of taut lines ends before they slacken.
    double tension(const Separation<dimensions>& s) const {
        return phase == DeploymentPhase::taut_lines ? stiffness * (s.length() - taut_distance) : 0.0;
    }

    /// [N] on a body with its velocity over ground, at its altitude. Without drag area no air is asked for.
    Vec<dimensions> drag(double drag_area, const Vec<dimensions>& velocity, double altitude) const {
        if (drag_area == 0.0) return Vec<dimensions>::Zero();
        return drag_of<dimensions>(atmosphere.at(altitude).density, drag_area,
                                   airspeed_of<dimensions>(velocity, altitude, wind));
    }

    /// Weight and other forces [N] on a body over its inertia; gravity weighs its mass.
    Vec<dimensions> acceleration_of(double mass, double inertia, const Vec<dimensions>& force) const {
        Vec<dimensions> a = force / inertia;
        a[dimensions - 1] -= gravity * (mass / inertia);
        return a;
    }

    Vec<dimensions> pull(const Separation<dimensions>& s) const {
        if (phase != DeploymentPhase::taut_lines) return Vec<dimensions>::Zero();
        return tension(s) / s.length() * s.distance;
    }

    /// C_D S [m^2] of all canopies that are out, in the air that the payload meets.
    double canopy_drag_area(double t, const Motion<dimensions>& m) const {
        return by_mach ? canopies->drag_area(t, mach_number(m)) : canopies->drag_area(t);
    }
    /// Mach number of the payload, where a drag area goes by it; otherwise 0.
    double mach_number(const Motion<dimensions>& m) const {
        if (!by_mach) return 0.0;
        return airspeed_of<dimensions>(m.velocity, m.altitude(), wind).norm() /
               *atmosphere.speed_of_sound(m.altitude());
    }

    /// The air that joins the canopies takes momentum.
    bool accretes() const { return added_mass && added_mass->momentum == AddedMassMomentum::accreting; }

    /// (m_l + M_a) dv/dt = m_l g + D_l + T e [- (dM_a/dt) v_air as RigidComposite], with the drag and added
    /// mass of canopies that are out.
    Vec<dimensions> payload_acceleration(double t, const Motion<dimensions>& m,
                                         const Separation<dimensions>& s) const {
        double inertia = payload_mass;
        Vec<dimensions> force =
            drag(payload_drag_area + canopy_drag_area(t, m), m.velocity, m.altitude()) + pull(s);
        if (added_mass) {
            const ValueAndRate air =
                canopies->added_mass(*added_mass, t, atmosphere.at(m.altitude()).density);
            inertia += air.value;
            if (accretes())
                force -= std::max(0.0, air.rate) * airspeed_of<dimensions>(m.velocity, m.altitude(), wind);
        }
        return acceleration_of(payload_mass, inertia, force);
    }

    /// m_p dv/dt = m_p g + D_p + F_extraction - T e; none while the static line holds it.
    Vec<dimensions> parachute_acceleration(double t, const Motion<dimensions>& m,
                                           const Separation<dimensions>& s) const {
        if (phase == DeploymentPhase::static_line) return Vec<dimensions>::Zero();
        return acceleration_of(
            parachute_mass, parachute_mass,
            drag(pack_drag_area, m.velocity + s.velocity, m.altitude() + s.distance[dimensions - 1]) +
                extraction.at(t) * behind - pull(s));
    }

    /// [N] What all risers together pull on a payload of `mass` [kg] with `drag_area` [m^2] of its own.
    double riser_force(double t, const Motion<dimensions>& m, const Separation<dimensions>& s, double mass,
                       double drag_area) const {
        if (canopies->out_mass() == 0.0) return tension(s);
        Vec<dimensions> force = mass * payload_acceleration(t, m, s);
        force[dimensions - 1] += mass * gravity;
        return (force - drag(drag_area, m.velocity, m.altitude())).norm();
    }

    /// The common velocity [m/s] of both once the lines hold them together: momentum is conserved.
    Vec<dimensions> locked_velocity(const Motion<dimensions>& m, const Separation<dimensions>& s) const {
        return m.velocity + parachute_mass / (payload_mass + parachute_mass) * s.velocity;
    }
};

}  // namespace twinchute::rom
