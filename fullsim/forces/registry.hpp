// The force blocks there are, as rows: what each needs, what it promises, and how it is built.
#pragma once

#include <span>

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
/// Momentum of the air that joins the canopy, for accreting added mass.
std::unique_ptr<const ForceModel> make_accretion(const Mesh& mesh);

/// A row of the table of force blocks. The promises are what the contract tests hold it to.
struct ForceBlock {
    std::string_view name;
    std::string_view source;
    bool structural;  ///< holds the parachute together: forces derive from a stored energy plus viscosity
    bool without_net_force;  ///< its forces sum to zero
    bool zero_at_rest;  ///< no force on an unstrained parachute that moves as one, in still air of no speed
    bool dissipates;    ///< what it takes out of the motion is booked as damping
    bool (*needed)(const Scene&);
    std::unique_ptr<const ForceModel> (*make)(const Scene&, const Mesh&);
};

std::span<const ForceBlock> force_blocks();

/// The structural blocks of a scene. They come first in every step, so that the riser force can be
/// read before anything else acts on the payload.
ForceModels make_structure(const Scene& scene, const Mesh& mesh);
/// The other blocks that the scene needs.
ForceModels make_loads(const Scene& scene, const Mesh& mesh);

}  // namespace twinchute::fullsim
