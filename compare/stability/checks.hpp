// Checks of answers of stiff and extreme cases: closed forms, invariants, and runs by other
// means. Errors and limits are shares of the value, so that margins can be compared.
#pragma once

#include "compare/stability.hpp"

namespace twinchute::compare {

/// All findings of all of them.
Check all_of(std::vector<Check> checks);

// Reduced-order model. Limits are a hundred times the scene's relative tolerance: that is what one step may
// leave, and the errors of a run's steps add up.

/// Peak force, and speed and altitude at the end, of the same scene at a tolerance of 1e-12 by a method that
/// is not the one on trial.
Check same_by_another_method();
/// Peak force and speed at full open of an opening by drag alone under Ludtke's law.
Check ludtke_closed_form();
/// Force dv sqrt(k m_red) and duration of the snatch between a moving payload and a parachute at rest. The
/// limit grows with the distance between the two over the stretch of the lines: a distance is known to the
/// relative tolerance, the force comes from its excess over the lines' length.
Check elastic_snatch();
/// Altitude and speed at the end of a fall in which the air, if any, does no more than the limit says.
Check fall_in_a_vacuum();
/// Altitude and speed at the end of a fall with a constant drag area: v_e tanh(g t/v_e + ...).
Check fall_with_constant_drag_area();
/// sqrt(2 W/(rho C_D S)) at the end; the limit has what the exponential approach still leaves.
Check terminal_speed();
/// Drag takes mechanical energy away and nothing brings any: without added mass it never grows.
Check energy_never_grows();
/// The run ends at the instant [s] that is known beforehand.
Check ends_at(std::function<double(const Scene&)> time);
/// An event is in the record.
Check has_event(std::string name);

// Full model.

/// Share that does not add up over the energy that changed hands, below the 0.2 % at which a run stops.
Check energy_closes();
/// Peak force and largest deceleration of the same scene in steps half as long, within 0.5 %, and no larger
/// line tension: what is above the limit of stability or at its edge hangs on the step more than that.
Check same_in_half_the_step();
/// Equal forces where the run is laid out as its mesh asks for, unless that one stops: arithmetic is the
/// same, so that what differs is rounding and what becomes of it.
Check same_in_the_layout_of_its_mesh();
/// Equal forces within the scatter of the scene itself, where that is larger: the range of the peak over
/// starts that differ by a micrometre. For lines that chatter on next to no mass.
Check same_within_its_scatter();
/// Steps from the first sign that a step is too long, an opening force more than 1 % of the peak away from
/// that of a run with `sound_factor`, to the stop; at most that many. Nothing where there is no such run.
std::optional<std::int64_t> steps_since_first_sign(const Trial& trial, double sound_factor);
/// A straight fall: the payload's momentum is the impulse of weight and opening force.
Check payload_momentum();
/// sqrt(2 W/(rho C_D S)) at the end, within the 0.5 % by which a descent is steady and the 2 % by which the
/// mesh may weigh more or less than parachute.mass.
Check terminal_speed_of_the_mesh();
/// v_e tanh(g t/v_e) of a canopy that starts open and at rest, without added mass, within the same.
Check fall_of_the_mesh();
/// The snatch speed of a drop on a static line of the length that the fall before it has: momentum shared by
/// payload and parachute, within 1 m/s (verification of deployments).
Check snatch_speed_of_a_drop();

}  // namespace twinchute::compare
