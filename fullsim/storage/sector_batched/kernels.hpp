// Inner loops over the rows of a sector side by side: written once (kernels.cpp), compiled for every
// instruction set, chosen when the program starts. Nothing here knows of scenes or stages.
//
// Elements read their nodes where they lie and write what they do to them each into a row of its own, a
// *element_force*; nodes then add up the buffers that belong to them. So no two lanes ever add to the same
// place, and nothing is read that has just been written beside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "fullsim/elements/passes.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"

namespace twinchute::fullsim {

/// x, y and z of something, each in a row.
using Components = std::array<double*, 3>;

/// Elements of a kind on consecutive nodes, as many as a register has lanes: corner c of the k-th has
/// node[c] + k. What they do goes into buffers. Two interleaved registers have a batch each.
template <std::size_t corners, std::size_t buffers>
struct ElementBatch {
    std::array<std::int32_t, corners> node{};
    std::array<std::int32_t, buffers> element_force{};
};
/// Streams of triangles: [N] on corner 0, less that on corner 1, on corner 2, and [m^2] the area over which
/// pressure acts on each corner.
using TriangleBatch = ElementBatch<3, 4>;
/// [N] on end 0, less that on end 1; of line drag, on either end.
using CableBatch = ElementBatch<2, 1>;
/// [N] less that on node 0, on node 1, of pairs in contact.
using ContactBatch = ElementBatch<2, 2>;

/// Streams that the nodes of one register add up: places in `sources`.
struct NodeSources {
    std::int32_t plus = 0, minus = 0, push = 0, aero = 0;
    std::int32_t cord_plus = 0, cord_minus = 0, end = 0;
    bool extra = false;           ///< remainder elements act on one of them
    bool remainder_cord = false;  ///< remainder cords do
};

/// The first seam and its halo nodes, each in consecutive nodes.
struct SeamHalo {
    std::int32_t seam = 0, first = 0, nodes = 0;
    std::int32_t pull = 0, push = 0;   ///< buffers: what acts on the halo nodes, turned back
    double cosine = 1.0, sine = 0.0;   ///< of the turn from one sector to the next
    std::vector<NodeSources> sources;  ///< of each register, none behind the last where it has no partner
};

/// A remainder element works on copies of its nodes, and what it does to them is carried to the nodes one by
/// one.
struct NodeCopy {
    std::int32_t copy, node;
};
struct RemainderPull {
    std::int32_t from, to;  ///< element_force, node
    double sign;
};

/// Work plan of the sector, in nodes and buffers; made for one register width.
struct SectorPlan {
    std::vector<TriangleBatch> triangles;
    /// Cords: lines and risers, which may take subcycles. Lines: those of them that meet the air.
    std::vector<CableBatch> tapes, cords, lines;
    std::vector<ContactBatch> contacts;
    std::vector<NodeSources> own;  ///< of each register of own nodes, none behind the last likewise
    std::vector<std::int32_t>
        on_cord;  ///< first own nodes of interleaved registers that have a node on a cord
    SeamHalo halo;
    std::vector<std::int32_t> sources;
    std::vector<NodeCopy> copies, cord_copies;
    std::vector<RemainderPull> remainder_triangles, remainder_tapes, remainder_cords, remainder_contacts,
        remainder_pushes, remainder_lines;
};

/// Constants of elements, one row each, in the order of their batches; zero where a register is filled up.
struct TriangleConstants {
    const double *inverse_a, *inverse_c, *b_over_a;   // [1/m], [1/m], [-]
    const double *area, *viscosity;                   // [m^2], [N s/m]
    const double* half;                               // 1/2
    std::array<const double*, 3> stiffness, damping;  // rows of the unstrained triangle [N/m], [N s/m]
};
struct CableConstantsRow {
    const double *inverse_length, *stiffness, *dashpot;  // [1/m], EA [N], [N s/m]
    const double* length;                                // [m]
    const double* line;                                  // 1 for suspension lines, else 0
};
/// Constants of nodes.
struct NodeRows {
    const double *mass,
        *canopy_mass;              // [kg] all, of canopy nodes alone; zero where a node does not move here
    const double* inertia;         // [kg] the mass, or one where a node does not move here
    const double* share;           // [-] of the whole fabric's area
    const double *across, *along;  // 1 where a node may move across the axis, along it
    const double* on_cord;         // 1 where a cord acts, else 0
    const double *stiffness, *damping;            // row sums of tapes [N/m], [N s/m]
    const double *cord_stiffness, *cord_damping;  // and of cords
};

struct SectorFrame {
    Components x{}, v{}, v_half{};  ///< [m], [m/s] as GoreFrame
    /// Forces of remainder elements on nodes [N], [m^2], [N], and remainder cords [N].
    Components pull{}, push{}, aero{}, cord_pull{};
    /// [m/s^2] of nodes on cords by everything else, [1/kg] of all nodes: from the beginning of a step to its
    /// last subcycle.
    Components slow{};
    double* inverse = nullptr;
    Components element_force{};             ///< of elements
    std::array<double*, 2> element_rows{};  ///< the same for row sums: stiffness, damping
    std::array<double*, 2> row_extra{};
    TriangleConstants triangle{};
    CableConstantsRow tape{}, cord{};
    NodeRows node{};
    const double* line = nullptr;     ///< 1 for a cable that meets the air, else 0
    const double* contact = nullptr;  ///< stiffness of a pair [N/m]
};

/// One step of own nodes; of those on cords the first subcycle of `subcycles`, see subcycles.hpp.
struct SectorAdvance {
    double kick = 0.0, dt = 0.0;  ///< [s] between half steps, and of the step
    Subcycle first;
    bool only = true;                          ///< a step of one subcycle
    bool weighs = false;                       ///< as EnergyTotals
    double last_dt = 0.0, last_line_dt = 0.0;  ///< [s] of the step before, and of its last subcycle
    double gravity = 0.0;                      ///< [m/s^2]
    double added_mass = 0.0;                   ///< [kg] of the whole canopy, by share, as all of these:
    double pressure = 0.0;                     ///< [Pa]
    /// As NodeLoads, upwards where they have a direction; accretion from air at rest.
    double on_fabric = 0.0, breathing = 0.0, canopy_mean = 0.0, accretion = 0.0, mass_damping = 0.0,
           system_mean = 0.0;
};

/// A further one of nodes on cords. half_step: [s] half of the whole step in its last, else nothing.
struct SectorSubcycle {
    Subcycle step;
    double half_step = 0.0;
};

/// Sums over a sector, upwards where they have a direction. Positions and velocities: of what a step is over
/// for.
struct SectorSums {
    double canopy_position = 0.0, canopy_velocity = 0.0, other_position = 0.0, other_velocity = 0.0;
    double area_velocity = 0.0;
    double drag_power = 0.0, momentum = 0.0, share_square = 0.0, dissipated = 0.0, accretion_power = 0.0;
    double kinetic = 0.0;          ///< [J] as StepSums
    double largest_tension = 0.0;  ///< [N] of lines, in a further subcycle
};

/// Stable steps [s] of own nodes.
struct SectorBounds {
    double all, canopy;  ///< held by everything; by everything but cords
};

struct SectorKernels {
    std::string_view instruction_set;
    int lanes, unroll_factor;  ///< of a register, and number of interleaved registers
    using OfFabric = ElementSums (*)(const SectorFrame&, const SectorPlan&, const MembranePass&);
    /// Membranes and the air on them, by AirOnFabric, which is not none; e_r is along the axis.
    std::array<OfFabric, 3> triangles;
    /// No areas; the largest load is that of lines.
    ElementSums (*cables)(const SectorFrame&, const std::vector<CableBatch>&, const CableConstantsRow&);
    /// Contact between gores, around the axis.
    ElementSums (*contacts)(const SectorFrame&, const SectorPlan&, const ContactPass&);
    EnergyAndStrain (*contact_levels)(const SectorFrame&, const SectorPlan&, const ContactPass&);
    ElementSums (*line_drag)(const SectorFrame&, const SectorPlan&, const LineAir&);
    SectorSums (*advance)(const SectorFrame&, const SectorPlan&, const SectorAdvance&);
    /// Cords as they are, and the nodes on them.
    SectorSums (*subcycle)(const SectorFrame&, const SectorPlan&, const SectorSubcycle&);
    /// Puts halo nodes and copies where their nodes are.
    void (*refresh)(const SectorFrame&, const SectorPlan&);
    /// The least over own nodes; node damping by share of the fabric's area and by mass [N s/m], [1/s].
    SectorBounds (*critical_step)(const SectorFrame&, const SectorPlan&, double added_mass,
                                  double damping_by_share, double damping_by_mass);
    /// A sector's energy and its largest strain.
    EnergyAndStrain (*fabric_levels)(const SectorFrame&, const SectorPlan&, const MembranePass&);
    EnergyAndStrain (*cable_levels)(const SectorFrame&, const std::vector<CableBatch>&,
                                    const CableConstantsRow&);
    /// [J] of own nodes
    double (*kinetic)(const SectorFrame&, const SectorPlan&, double added_mass);
};

/// Kernels of the best instruction set that this machine has.
const SectorKernels& sector_kernels();
/// One for each instruction set that is compiled in and that this machine has, the best first.
std::span<const SectorKernels> all_sector_kernels();

}  // namespace twinchute::fullsim
