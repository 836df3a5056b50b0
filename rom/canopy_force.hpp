// Force of each of several canopies at the confluence.
#pragma once

#include <algorithm>

#include "lib/solve/opening_sequence.hpp"
#include "rom/motion.hpp"

namespace twinchute::rom {

/// Drag and air of one canopy that fills by itself.
struct Filled {
    double drag_area = 0.0;   ///< [m^2] on the canopies' airspeed
    double added_mass = 0.0;  ///< [kg] within and apparent
    double capture = 0.0;     ///< [kg/s] that joins the apparent mass
};

/// Air and motion that canopies flying as one body share at one moment.
template <int dimensions>
struct CanopyAir {
    double time = 0.0, density = 0.0, gravity = 0.0;  ///< [s] since release, [kg/m^3], [m/s^2]
    double mach = 0.0;                                ///< [-] where a drag area goes by it
    const AddedMassSpec* added_mass = nullptr;        ///< null: none
    bool accretes = false;                            ///< the air that joins takes momentum
    Vec<dimensions> airspeed, acceleration;           ///< [m/s] of the canopies, [m/s^2] of the body
};

/// [N] of one canopy that is out on the confluence, through its riser: its drag, less what its air takes (the
/// added mass times the acceleration, and what accretes), plus its own weight less its own inertia,
///   T_i = D_i - M_i a - (dM_i/dt) v + m_i (g - a),
/// Newton's law for one of the canopies of RigidComposite. Their sum is the opening force, in size and
/// direction, since that is the same law for all of them. What accretes is counted as there: none while the
/// air of all together shrinks, otherwise each canopy's part of the whole.
///
/// `filled`: what a canopy that fills by itself drags and carries along; null of any other.
template <int dimensions>
Vec<dimensions> canopy_force(const Canopy& canopy, const OpeningSequence& canopies,
                             const CanopyAir<dimensions>& air, const Filled* filled = nullptr) {
    const double area =
        filled ? filled->drag_area : OpeningSequence::drag_area_of(canopy, air.time, air.mach);
    Vec<dimensions> force = drag_of<dimensions>(air.density, area, air.airspeed);
    double inertia = canopy.chute->mass;
    if (filled) {
        inertia += filled->added_mass;
        force -= filled->capture * air.airspeed;
    } else if (air.added_mass) {
        const auto mass = OpeningSequence::added_mass_of(canopy, *air.added_mass, air.time, air.density);
        inertia += mass.value;
        if (air.accretes && canopies.added_mass(*air.added_mass, air.time, air.density).rate > 0.0)
            force -= mass.rate * air.airspeed;
    }
    force -= inertia * air.acceleration;
    force[dimensions - 1] -= canopy.chute->mass * air.gravity;
    return force;
}

/// The canopy that pulls most.
struct LargestPull {
    double force = 0.0;      ///< [N]
    std::size_t canopy = 0;  ///< of OpeningSequence::all()
    int canopies = 0;        ///< that pull
};

/// `filled_of(i)`: of canopy i, as canopy_force() takes it.
template <int dimensions, class FilledOf>
LargestPull largest_pull(const OpeningSequence& canopies, const CanopyAir<dimensions>& air,
                         const FilledOf& filled_of) {
    LargestPull largest;
    for (std::size_t i = 0; i < canopies.all().size(); ++i) {
        const Canopy& canopy = canopies.all()[i];
        if (!canopy.is_out()) continue;
        largest.canopies += canopy.count;
        const double force = canopy_force<dimensions>(canopy, canopies, air, filled_of(i)).norm();
        if (force > largest.force) largest.force = force, largest.canopy = i;
    }
    return largest;
}

/// Where none fills by itself.
template <int dimensions>
LargestPull largest_pull(const OpeningSequence& canopies, const CanopyAir<dimensions>& air) {
    return largest_pull<dimensions>(canopies, air, [](std::size_t) -> const Filled* { return nullptr; });
}

}  // namespace twinchute::rom
