// The force blocks: their names in the order of the registry, and how each is made.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

enum class Block {
    membrane,
    fabric_springs,
    tapes,
    lines,
    static_line,
    gore_contact,
    self_contact,
    payload_tetrahedra,
    canopy_pressure,
    fabric_drag,
    deployment_resistance,
    extraction,
    line_drag,
    breathing_damping,
    payload_drag,
    accretion,
    mass_damping
};
inline constexpr int block_count = static_cast<int>(Block::mass_damping) + 1;

/// As in records and plans, e.g. "canopy pressure".
std::string_view block_name(Block block);

class ForceModel;
struct State;

std::unique_ptr<const ForceModel> make_membrane(const Mesh& mesh, double bulk_viscosity);
/// Fabric as springs and dashpots along its edges (paper, 2.1). repulsion: of folded fabric over its
/// stiffness in tension; beta: [s].
std::unique_ptr<const ForceModel> make_fabric_springs(const Mesh& mesh, double repulsion,
                                                      double bulk_viscosity, double beta);
/// EA [N], and (beta E/l0 + b1 rho c1) A [N s/m] with the wave speed c1 = sqrt(E/rho) (paper, Eq. 3).
struct CableConstants {
    double stiffness, dashpot;
};
CableConstants cable_constants(const Mesh& mesh, const Cable& cable, double bulk_viscosity, double beta);
double cable_strain(const State& state, const Cable& cable);  ///< engineering [-]
/// [N] in each of a cable's strands, elastic; none where it is slack.
double strand_tension(const State& state, const Mesh& mesh, const Cable& cable);
/// All that a mesh has, tapes alone, or lines and risers alone.
std::unique_ptr<const ForceModel> make_cable(const Mesh& mesh, double bulk_viscosity, double beta = 0.0);
std::unique_ptr<const ForceModel> make_tapes(const Mesh& mesh, double bulk_viscosity, double beta);
std::unique_ptr<const ForceModel> make_lines(const Mesh& mesh, double bulk_viscosity, double beta);
/// Cables of a list, which is kept by reference, for a block.
std::unique_ptr<const ForceModel> make_cables(const Mesh& mesh, const std::vector<Cable>& cables, Block block,
                                              double bulk_viscosity, double beta);
/// Neighbouring gores of a generated mesh keep their fabric apart (fullsim/mesh/gore_contacts.hpp).
std::unique_ptr<const ForceModel> make_gore_contact(const Mesh& mesh);
/// Nodes of fabric and lines do not pass through fabric (fullsim/laws/self_contact.hpp). friction:
/// coefficient
/// [-].
std::unique_ptr<const ForceModel> make_self_contact(const Mesh& mesh, double friction);
std::unique_ptr<const ForceModel> make_static_line(const Mesh& mesh, double bulk_viscosity, double beta);
/// Drag of the canopy as a piece of fabric, until snatch (paper, 3.2.1).
std::unique_ptr<const ForceModel> make_fabric_drag(const Mesh& mesh, double coefficient);
/// [-] of the area between vent and skirt: parachute.deploy.drag_coefficient is that of fabric, not of slots.
double fabric_drag_coefficient(const Scene& scene);
/// resistance: [N/m] of width.
std::unique_ptr<const ForceModel> make_deployment_resistance(const Mesh& mesh, double resistance);
/// AeroState::extraction on the vent's seams, or on the whole canopy by area.
std::unique_ptr<const ForceModel> make_extraction(const Mesh& mesh, bool on_apex);
/// Pressure along e_r and across it, and the flag remainder (paper, Eqs 11-12).
std::unique_ptr<const ForceModel> make_canopy_pressure(const Mesh& mesh, double smallest_area);
/// Cylinder drag of the suspension lines (paper, Eq. 10).
std::unique_ptr<const ForceModel> make_line_drag(const Mesh& mesh);
/// Air resists fabric that moves relative to the canopy mean.
std::unique_ptr<const ForceModel> make_breathing_damping(const Mesh& mesh, double k);
/// Rayleigh damping -alpha m_i (v_i - v_system) (paper, Eq. 4).
std::unique_ptr<const ForceModel> make_mass_damping(const Mesh& mesh, double alpha);
std::unique_ptr<const ForceModel> make_payload_drag(const Mesh& mesh, double drag_area);
/// Drag of a body, by the angle between its axis and the relative airflow. The table is kept by reference.
std::unique_ptr<const ForceModel> make_attitude_drag(const Mesh& mesh, const AttitudeDrag& table);
/// Momentum of the air that joins the canopy, for accreting added mass.
std::unique_ptr<const ForceModel> make_accretion(const Mesh& mesh);

}  // namespace twinchute::fullsim
