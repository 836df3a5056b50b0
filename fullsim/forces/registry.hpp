// The force blocks there are, and which of them a scene needs.
#pragma once

#include "fullsim/forces/force_model.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

std::unique_ptr<const ForceModel> make_membrane(const Mesh& mesh, double bulk_viscosity);
std::unique_ptr<const ForceModel> make_cable(const Mesh& mesh, double bulk_viscosity);
/// Pressure along e_r and across it, and the flag remainder (paper, Eqs 11-12).
std::unique_ptr<const ForceModel> make_canopy_pressure(const Mesh& mesh, double smallest_area);
/// Cylinder drag of the suspension lines (paper, Eq. 10).
std::unique_ptr<const ForceModel> make_line_drag(const Mesh& mesh);
/// Air resists fabric that moves relative to the canopy mean.
std::unique_ptr<const ForceModel> make_breathing_damping(const Mesh& mesh, double k);
/// Rayleigh damping -alpha m_i (v_i - v_system) (paper, Eq. 4).
std::unique_ptr<const ForceModel> make_mass_damping(const Mesh& mesh, double alpha);
std::unique_ptr<const ForceModel> make_payload_drag(const Mesh& mesh, double drag_area);

/// The structural blocks of a scene: what holds the parachute together. They come first in every
/// step, so that the riser force can be read before anything else acts on the payload.
ForceModels make_structure(const Scene& scene, const Mesh& mesh);
/// The other blocks: one per table that is present in the scene.
ForceModels make_loads(const Scene& scene, const Mesh& mesh);

}  // namespace twinchute::fullsim
