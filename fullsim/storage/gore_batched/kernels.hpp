// Inner loops over gores side by side: written once (kernels.cpp), compiled for every instruction set, chosen
// when the program starts. Nothing here knows of scenes or stages.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "fullsim/elements/passes.hpp"
#include "fullsim/laws/linear_motion.hpp"
#include "fullsim/time/central_difference.hpp"

namespace twinchute::fullsim {

/// Where the nodes of all gores lie: [block][local node][array][x, y, z][lane], so that all of a node is in
/// one place and no two arrays are a multiple of a page apart. A block is as many gores as the processor
/// works on at once; lanes without a gore stand still (`live` is 0 there, 1 elsewhere).
struct GoreFrame {
    int gores = 0;
    int lanes = 0, blocks = 0, nodes = 0;      ///< per block: own, neighbour's and shared nodes
    int first = 0, last = 0;                   ///< blocks that a kernel works on: all, or a thread's share
    int own = 0, canopy = 0;                   ///< the first nodes of a block
    double *x = nullptr, *v = nullptr;         ///< [m], [m/s] at the same time, as NodeRecord
    double* v_half = nullptr;                  ///< [block][own node][x, y, z][lane] [m/s] half a step before
    double *force = nullptr, *aero = nullptr;  ///< [N] as State
    /// [m^2] area over which pressure acts on a node of the canopy. Lies in `aero`, where only lines have
    /// something then, unless fabric drag acts as well.
    double* push = nullptr;
    double* pull = nullptr;  ///< [block][x, y, z][lane] [N] of the line on the skirt, apart from `force`
    /// `aero` of the skirt, [x, y, z][lane] of each block: apart from `push`, or in its place in `aero`.
    double* skirt_aero = nullptr;
    std::size_t skirt_stride = 0;  ///< from a block to the next
    const double* live = nullptr;  ///< [block][lane]

    int components = 12;  ///< of a node: of four or five arrays, or the two that row sums are
    /// From a node to the next.
    std::size_t stride() const { return static_cast<std::size_t>(components) * lanes; }
    /// Offset of a node's first lane in an array.
    std::size_t at(int block, int node) const {
        return (static_cast<std::size_t>(block) * nodes + node) * stride();
    }
    /// Stride and offset in v_half, which holds no halo nodes and no shared nodes.
    std::size_t half_stride() const { return 3 * static_cast<std::size_t>(lanes); }
    std::size_t half_at(int block, int node) const {
        return (static_cast<std::size_t>(block) * own + node) * half_stride();
    }
};

using Node3 = std::array<std::int32_t, 3>;
using Node2 = std::array<std::int32_t, 2>;

/// Constants of a triangle, the same in every gore; as the unstructured layout's.
struct MembraneElement {
    Node3 node;
    double inverse_a, inverse_c, b_over_a;  // [1/m], [1/m], [-]
    double area;                            // [m^2] unstrained
    double viscosity;                       // eta [N s/m]
};

struct CableElement {
    Node2 node;
    double inverse_length, stiffness, dashpot;  // [1/m], EA [N], [N s/m]
};

struct SpringElement {
    Node2 node;
    double inverse_length, stiffness, hardening, dashpot;  // as SpringConstants
    double fold_force;                                     // [N] that holds it while folded
};

/// Nodes that keep their order around the axis (ContactPair).
struct ContactElement {
    Node2 node;
    double stiffness;  // [N/m]
};

/// Row sums of an unstrained triangle by corner, with the weights of its corners (PerronScaling).
struct WeighedRows {
    std::array<double, 3> stiffness, damping;  // [N/m], [N s/m]
};

/// A gore's line, element by element from the skirt to the link: each begins where the one before ends.
using LineElements = std::span<const CableElement>;

/// Constants of a node, the same in every gore.
struct GoreNode {
    double mass = 0.0;  ///< [kg]
    double share =
        0.0;  ///< of the fabric's area [-], hence of added mass, residual drag, distributed extraction
    double extraction = 0.0;  ///< share of the extraction force [-]
};

/// One step of all gores' own nodes.
struct GoreAdvance {
    std::span<const GoreNode> nodes;
    std::span<const double> inverse_inertia;  ///< [1/kg] of each node
    std::span<const std::int32_t> halo;       ///< of each canopy node: what the gore before sees of it; or -1
    /// Whether pressure pushes on nodes, and whether halo nodes have anything in `aero`: an array that is not
    /// touched is not waited for.
    bool pushed = false, halo_aero = false;
    int first_aero = 0;    ///< nodes before it have nothing in `aero`
    int first_pulled = 0;  ///< the skirt; after it come nodes of lines
    /// Whether the pulled nodes move as the others do. Otherwise they get the impulse of everything but
    /// lines, and keep its acceleration in `aero` for their subcycles.
    bool together = true;
    double first_kick = 0.0;                   ///< [s] of the first subcycle, for the works
    bool weighs = false;                       ///< as EnergyTotals
    double last_dt = 0.0, last_line_dt = 0.0;  ///< [s] of the step before, and of its last subcycle
    double kick = 0.0, dt = 0.0;               ///< [s] between half steps, and of the step
    double gravity = 0.0;                      ///< [m/s^2]
    double pressure = 0.0;                     ///< [Pa] on `push`
    bool loads_fabric = false;                 ///< by a force
    std::array<double, 3> on_fabric{};         ///< [N] on the canopy by share
    bool has_contact_reaction = false;         ///< by contacts,
    std::array<double, 3> contact_reaction{};  ///< [m/s^2] of the canopy, by what they push off on its axis
    std::array<double, 3> extraction{};        ///< [N]
    double breathing = 0.0, accretion = 0.0, mass_damping = 0.0;  ///< as NodeLoads
    std::array<double, 3> canopy_mean{}, wind{}, system_mean{};   ///< likewise [m/s]
};

struct GoreSums {
    std::array<double, 3> canopy_position{}, canopy_velocity{}, line_position{},
        line_velocity{};                                                   // times mass
    std::array<double, 3> area_velocity{};                                 // times share
    double drag_power = 0.0;                                               // [W]
    double momentum = 0.0;                                                 // [kg m/s] upwards
    double share_square = 0.0;                                             // sum of share times v^2 [m^2/s^2]
    double kinetic = 0.0;                                                  // [J] as StepSums
    double dissipated = 0.0, accretion_power = 0.0, external_power = 0.0;  // [W]
    double largest_tension = 0.0;                                          // [N] as FabricSums::largest_load
};

/// A subcycle of the skirt and the nodes of lines under lines alone.
struct GoreSubcycle {
    std::span<const GoreNode> nodes;
    std::span<const double> inverse_inertia;  ///< [1/kg] of each node
    LineElements lines;
    /// Whether what lines do is known: in the first subcycle.
    bool pulled = false;
    std::int32_t skirt_halo = -1;
    Subcycle step;
    double half_step = 0.0;  ///< [s] of the whole step, in its last subcycle; 0 in others
};

/// The loops, for one instruction set. Forces are added to the frame's; a sum does not depend on anything but
/// the frame's width and the blocks it runs over.
struct GoreKernels {
    std::string_view instruction_set;
    int lanes;
    using OfFabric = ElementSums (*)(const GoreFrame&, std::span<const MembraneElement>, const MembranePass&);
    /// Membranes with the air on them in one pass, and the air alone, by AirOnFabric.
    std::array<OfFabric, 3> membrane, air;
    EnergyAndStrain (*membrane_levels)(const GoreFrame&, std::span<const MembraneElement>,
                                       const MembranePass&);
    EnergyAndStrain (*spring_levels)(const GoreFrame&, std::span<const SpringElement>, const SpringPass&);
    EnergyAndStrain (*cable_levels)(const GoreFrame&, std::span<const CableElement>);
    /// [J] of own nodes.
    double (*kinetic_energy)(const GoreFrame&, std::span<const GoreNode>, double added_mass);
    /// The square of the farthest [m^2] that an own node is from where it is expected, times its weight; NaN
    /// where one is. before: [block][own node][x, y, z, weight][lane].
    double (*farthest)(const GoreFrame&, const double* before, const LinearMotion&);
    ElementSums (*fabric_drag)(const GoreFrame&, std::span<const MembraneElement>, const FabricDragPass&);
    ElementSums (*springs)(const GoreFrame&, std::span<const SpringElement>, const SpringPass&);
    ElementSums (*cables)(const GoreFrame&, std::span<const CableElement>);
    ElementSums (*contacts)(const GoreFrame&, std::span<const ContactElement>, const ContactPass&);
    EnergyAndStrain (*contact_levels)(const GoreFrame&, std::span<const ContactElement>, const ContactPass&);
    /// Lines alone, the air on them alone, or both. They *set* what acts on their nodes: `pull` of the skirt,
    /// `force` of all others, `aero` of all, zero without air; nothing else but fabric drag on the skirt acts
    /// there, and comes later.
    ElementSums (*lines)(const GoreFrame&, LineElements, const LineAir&);
    ElementSums (*line_drag)(const GoreFrame&, LineElements, const LineAir&);
    ElementSums (*lines_with_drag)(const GoreFrame&, LineElements, const LineAir&);
    /// Row sums of stiffness and damping for the critical time step are added to `rows`, a frame of the
    /// canopy and its halo nodes alone: x is the stiffness [N/m], y the damping [N s/m] of a node, z is not
    /// there. weight: share of their stiffness that membranes have.
    void (*membrane_rows)(const GoreFrame&, std::span<const MembraneElement>, std::span<const WeighedRows>,
                          double weight, const GoreFrame& rows);
    /// columns: 1 and the weight of the other end over its own, by end of each spring.
    void (*spring_rows)(const GoreFrame&, std::span<const SpringElement>, const SpringPass&,
                        std::span<const std::array<double, 2>> columns, const GoreFrame& rows);
    /// The least bound on the step [s] over own nodes from first to last; node_damping, by node: [N s/m] of
    /// loads on it.
    double (*critical_step)(const GoreFrame& rows, std::span<const double> inverse_inertia,
                            std::span<const double> node_damping, int first, int last);
    /// Takes what gores have added to halo nodes, and renews these, but for the lanes at which a block's
    /// first gore is the neighbour of another one's last: see GoreNodes.
    GoreSums (*advance)(const GoreFrame&, const GoreAdvance&);
    /// Sums of positions and velocities in the last, of what lines do where that was not known.
    GoreSums (*subcycle)(const GoreFrame&, const GoreSubcycle&);
    /// Row sums of halo nodes go to those of the nodes themselves.
    void (*scatter_add_halo)(const GoreFrame& rows, std::span<const std::int32_t> neighbour);
};

/// Kernels of the best instruction set that this machine has.
const GoreKernels& gore_kernels();
/// One for each instruction set that is compiled in and that this machine has, the best first.
std::span<const GoreKernels> all_gore_kernels();

}  // namespace twinchute::fullsim
