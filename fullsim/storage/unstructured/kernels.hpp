// Inner loops over elements that name their nodes: written once (kernels.cpp), compiled for every instruction
// set, chosen when the program starts. Nothing here knows of scenes or stages.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "fullsim/elements/passes.hpp"

namespace twinchute::fullsim::unstructured {

/// The state's arrays by node, as doubles.
struct Nodes {
    const double* record = nullptr;  ///< [m], [m/s] NodeRecord: 8 a node
    double* force = nullptr;         ///< [N] 4 a node, as State
    double* aero = nullptr;          ///< [N] likewise
    double* push = nullptr;          ///< [m^2] likewise: area over which pressure acts on a canopy node
};

/// Elements in groups as wide as the kernels, the last one filled up with elements of no effect.
struct Elements {
    std::size_t groups = 0;
    /// [group][corner][lane]: 32 times the number of a node, where its row of four doubles begins [B]. Of
    /// triangles the corners of a quad, half as many as lanes.
    const std::int32_t* node = nullptr;
    const double* constant = nullptr;  ///< [group][constant][lane]
};

// Constants of elements, in their order.
enum MembraneConstant { inverse_a, inverse_c, b_over_a, reference_area, viscosity, membrane_constants };
enum CableConstant { inverse_length, stiffness, dashpot, cable_constants };
enum SpringConstant {
    hardening = cable_constants,
    fold_force,
    spring_constants
};  ///< after those of a cable
enum PairConstant { pair_stiffness, pair_constants };

/// As GershgorinSums, by node.
struct Rows {
    double *stiffness = nullptr, *damping = nullptr;
    const double* weight = nullptr;
};

/// Inertia and damping of nodes, for the bound on the step.
struct Bound {
    std::span<const double> mass, share;   ///< [kg], [-] as NodeConstants
    double added_mass = 0.0;               ///< [kg] by share
    double by_share = 0.0, by_mass = 0.0;  ///< damping [N s/m], [1/s]
};

/// One step of nodes of the system.
struct Advance {
    std::size_t first = 0, last = 0;                              ///< those
    double* record = nullptr;                                     ///< as Nodes
    double* v_half = nullptr;                                     ///< [m/s] 4 a node
    std::span<const double> mass, share;                          ///< as NodeConstants
    std::size_t canopy = 0;                                       ///< nodes, the first ones
    std::size_t first_aero = 0;                                   ///< nodes before it have nothing in `aero`
    double added_mass = 0.0;                                      ///< [kg] by share
    double kick = 0.0, dt = 0.0;                                  ///< [s] between half steps, and of the step
    bool weighs = false;                                          ///< as EnergyTotals
    double last_dt = 0.0;                                         ///< [s] of the step before
    double gravity = 0.0;                                         ///< [m/s^2]
    std::array<double, 4> contact{};                              ///< [N/kg] on the canopy by mass
    double pressure = 0.0;                                        ///< [Pa] on `push`
    std::array<double, 4> on_fabric{};                            ///< [N] on the canopy by share
    double breathing = 0.0, accretion = 0.0, mass_damping = 0.0;  ///< as NodeLoads
    std::array<double, 4> canopy_mean{}, wind{}, system_mean{};   ///< likewise [m/s]
};

/// Nodes that take subcycles within a step.
struct Subcycled {
    std::span<const std::int32_t> node;           ///< numbers
    std::span<const double> inverse_inertia;      ///< [1/kg] of each
    const double* others = nullptr;               ///< [N] 4 each: of everything but lines and risers
    double *record = nullptr, *v_half = nullptr;  ///< as Advance
};

/// By component, times mass or share as StepSums.
struct Sums {
    using Row = std::array<double, 4>;
    Row canopy_position{}, canopy_velocity{}, other_position{}, other_velocity{}, area_velocity{};
    Row drag_power{}, momentum{}, share_square{}, dissipated{}, accretion_power{}, kinetic{};
};

/// The loops, for one instruction set.
struct Kernels {
    std::string_view instruction_set;
    int lanes;  ///< of a group
    using OfFabric = ElementSums (*)(Nodes, Elements, const MembranePass&);
    /// Membranes with the air on them in one pass, and the air alone, by AirOnFabric.
    std::array<OfFabric, 3> membrane, air;
    EnergyAndStrain (*membrane_levels)(Nodes, Elements, const MembranePass&);
    ElementSums (*fabric_drag)(Nodes, Elements, const FabricDragPass&);
    ElementSums (*springs)(Nodes, Elements, const SpringPass&);
    ElementSums (*cables)(Nodes, Elements);
    ElementSums (*line_drag)(Nodes, Elements, const LineAir&);
    ElementSums (*cables_with_drag)(Nodes, Elements, const LineAir&);
    ElementSums (*contacts)(Nodes, Elements, const ContactPass&);
    /// Each of these adds to the row sums.
    void (*membrane_rows)(Nodes, Elements, const MembranePass&, Rows);
    void (*spring_rows)(Nodes, Elements, const SpringPass&, Rows);
    void (*cable_rows)(Elements, Rows);
    /// The least bound on the step [s].
    double (*critical_step)(Rows, const Bound&);
    Sums (*advance)(Nodes, const Advance&);
    // Nodes outside the canopy, as NodeMover has it for one node (fullsim/time/node_mover.hpp):
    /// kick_alone. first_kick [s]: of the first subcycle, under nodes.force.
    Sums (*kick)(Nodes, const Advance&, const Subcycled&, double first_kick, double last_line_dt);
    /// end_subcycles, dt [s] of the step.
    Sums (*end_subcycles)(Nodes, const Subcycled&, double dt, std::span<const double> mass);
    /// move_in_subcycle, of canopy nodes, too. kick, dt [s] of the subcycle.
    void (*subcycle)(Nodes, const Subcycled&, double kick, double dt);
};

/// One for each instruction set that is compiled in and that this machine has, the best first.
std::span<const Kernels> all_kernels();

}  // namespace twinchute::fullsim::unstructured
