// The force blocks there are, as rows: what each needs, what it promises, and how it is built.
#pragma once

#include <span>

#include "fullsim/forces/force_model.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

std::unique_ptr<const ForceModel> make_membrane(const Mesh& mesh, double bulk_viscosity);
/// Cloth as springs and dashpots along its edges (paper, 2.1). repulsion: of folded cloth over its stiffness
/// in tension; beta: [s].
std::unique_ptr<const ForceModel> make_fabric_springs(const Mesh& mesh, double repulsion,
                                                      double bulk_viscosity, double beta);
/// EA [N], and (beta E/l0 + b1 rho c1) A [N s/m] with the wave speed c1 = sqrt(E/rho) (paper, Eq. 3).
struct CableConstants {
    double stiffness, dashpot;
};
CableConstants cable_constants(const Mesh& mesh, const Cable& cable, double bulk_viscosity, double beta);
/// All that a mesh has, tapes alone, or lines and risers alone.
std::unique_ptr<const ForceModel> make_cable(const Mesh& mesh, double bulk_viscosity, double beta = 0.0);
std::unique_ptr<const ForceModel> make_tapes(const Mesh& mesh, double bulk_viscosity, double beta);
std::unique_ptr<const ForceModel> make_lines(const Mesh& mesh, double bulk_viscosity, double beta);
/// Cables of a list, which is kept by reference.
std::unique_ptr<const ForceModel> make_cables(const Mesh& mesh, const std::vector<Cable>& cables,
                                              std::string_view name, double bulk_viscosity, double beta);
/// Neighbouring gores of a generated mesh keep their cloth apart (fullsim/mesh/gore_contacts.hpp).
std::unique_ptr<const ForceModel> make_gore_contact(const Mesh& mesh);
std::unique_ptr<const ForceModel> make_static_line(const Mesh& mesh, double bulk_viscosity, double beta);
/// Of the canopy as a piece of cloth, until snatch (paper, 3.2.1).
std::unique_ptr<const ForceModel> make_cloth_drag(const Mesh& mesh, double coefficient);
/// resistance: [N/m] of width.
std::unique_ptr<const ForceModel> make_fold_resistance(const Mesh& mesh, double resistance);
/// direction: unit vector. The history is kept by reference.
std::unique_ptr<const ForceModel> make_extraction(const Mesh& mesh, const ForceHistory& history, bool on_apex,
                                                  const Vec3& direction);
/// Pressure along e_r and across it, and the flag remainder (paper, Eqs 11-12).
std::unique_ptr<const ForceModel> make_canopy_pressure(const Mesh& mesh, double smallest_area);
/// Cylinder drag of the suspension lines (paper, Eq. 10).
std::unique_ptr<const ForceModel> make_line_drag(const Mesh& mesh);
/// Air resists fabric that moves relative to the canopy mean.
std::unique_ptr<const ForceModel> make_breathing_damping(const Mesh& mesh, double k);
/// Rayleigh damping -alpha m_i (v_i - v_system) (paper, Eq. 4).
std::unique_ptr<const ForceModel> make_mass_damping(const Mesh& mesh, double alpha);
std::unique_ptr<const ForceModel> make_payload_drag(const Mesh& mesh, double drag_area);
/// Of a body, by the angle between its axis and the way the air goes past it. The table is kept by reference.
std::unique_ptr<const ForceModel> make_attitude_drag(const Mesh& mesh, const AttitudeDrag& table);
/// Momentum of the air that joins the canopy, for accreting added mass.
std::unique_ptr<const ForceModel> make_accretion(const Mesh& mesh);

/// A row of the table of force blocks. The promises are what the contract tests hold it to.
struct ForceBlock {
    std::string_view name;
    std::string_view source;
    bool structural;  ///< holds the parachute together: forces derive from a stored energy plus viscosity
    bool without_net_force;  ///< its forces sum to zero
    bool zero_at_rest;    ///< no force on an unstrained parachute that moves as one, in still air of no speed
    bool dissipates;      ///< what it takes out of the motion is booked as damping
    bool fixed_in_space;  ///< its direction is prescribed; everything else turns with the parachute and the
                          ///< air
    bool subcycles;       ///< of lines and risers: evaluated in every subcycle (fullsim/time/subcycling.hpp)
    bool (*needed)(const Scene&, Stage);
    std::string (*why)(const Scene&);  ///< what in a scene makes it needed, or left out
    std::unique_ptr<const ForceModel> (*make)(const Scene&, const Mesh&);
};

std::span<const ForceBlock> force_blocks();
/// The row of that name.
const ForceBlock& force_block(std::string_view name);

/// The stages of a scene's run, in their order.
std::vector<Stage> stages_of(const Scene& scene);
/// Those in which it takes part; none: the scene leaves it out.
std::vector<Stage> stages_with(const ForceBlock& block, const Scene& scene);

/// The structural blocks of a scene in a stage of its run. They come first in every step, so that the riser
/// force can be read before anything else acts on the payload. Of `blocks`: all that there are, unless a test
/// wants fewer.
ForceModels make_structure(const Scene& scene, const Mesh& mesh, Stage stage = Stage::flight,
                           std::span<const ForceBlock> blocks = force_blocks());
/// The other blocks that the scene needs in that stage.
ForceModels make_loads(const Scene& scene, const Mesh& mesh, Stage stage = Stage::flight,
                       std::span<const ForceBlock> blocks = force_blocks());

}  // namespace twinchute::fullsim
