// Everything of a full run that changes with time, in plain arrays. Force blocks hold constants
// only, so that a state can be stored, compared and continued.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "fullsim/mesh/mesh.hpp"
#include "lib/math/lanes.hpp"
#include "lib/models/inflation.hpp"

namespace twinchute::fullsim {

/// Position and velocity of a node as one record of 64 bytes: what an element reads of a corner.
struct alignas(64) NodeRecord {
    Lanes x;  ///< [m] x east, y north, z up, 0
    Lanes v;  ///< [m/s] at the same time as x, extrapolated from the half step (paper, 2.3)
};

/// A vector of a node, padded to a lane group.
struct alignas(32) NodeVector {
    Lanes value;
};

/// A vector of each node, or of those from some node on: layouts that keep the forces on the nodes of canopy
/// and lines themselves leave these out.
class NodeForces {
public:
    /// Zero, and on the nodes from `first` to the last of `count` from here on.
    void clear(std::size_t count, std::size_t first = 0) {
        first_ = first;
        of_.assign(count - first, {splat(0.0)});
        // Frees the excess memory of another layout, or of a static line that has gone.
        if (of_.capacity() > of_.size()) of_.shrink_to_fit();
    }
    /// Number of all nodes, including those that are not held.
    std::size_t size() const { return first_ + of_.size(); }
    NodeVector& operator[](std::size_t node) { return of_[node - first_]; }
    const NodeVector& operator[](std::size_t node) const { return of_[node - first_]; }
    /// View for a loop, as cheap as a plain array: where node 0 would be is known, and no store of the loop
    /// can change it.
    class View {
    public:
        explicit View(NodeForces& forces)
            : zero_(reinterpret_cast<std::uintptr_t>(forces.of_.data()) -
                    forces.first_ * sizeof(NodeVector)) {}
        NodeVector& operator[](std::size_t node) const {
            // NOLINTNEXTLINE(performance-no-int-to-ptr): to subtract `first_` every time costs 3 % of a drop
            return *reinterpret_cast<NodeVector*>(zero_ + node * sizeof(NodeVector));
        }

    private:
        std::uintptr_t zero_;  // a number: no pointer may point there
    };
    View view() { return View(*this); }
    /// Forces on the nodes that are held, in the order of nodes.
    std::vector<NodeVector>& held() { return of_; }
    const std::vector<NodeVector>& held() const { return of_; }

private:
    std::size_t first_ = 0;
    std::vector<NodeVector> of_;
};

inline Vec3 to_vec3(Lanes a) {
    return {a[0], a[1], a[2]};
}
inline Lanes to_lanes(const Vec3& a) {
    return Lanes{a.x(), a.y(), a.z(), 0.0};
}

/// Stage of the structure and its loads, one after the other. A scene that starts drawn out begins in flight;
/// one without springs goes from deployment to flight.
enum class Stage {
    deployment,  ///< from the pack to snatch
    springs,     ///< the canopy begins to fill, its fabric still springs and dashpots
    ramp,        ///< finite elements take over
    flight       ///< finite elements alone
};

inline std::string_view stage_name(Stage stage) {
    switch (stage) {
        case Stage::deployment:
            return "deployment";
        case Stage::springs:
            return "springs";
        case Stage::ramp:
            return "ramp";
        case Stage::flight:
            break;
    }
    return "flight";
}

/// Sums over nodes that the aerodynamic reference needs; material mass only.
struct NodeSums {
    Vec3 canopy_position, canopy_velocity;  ///< means over canopy mass [m], [m/s]
    Vec3 system_position, system_velocity;  ///< means over all mass
    Vec3 canopy_area_velocity;              ///< mean over tributary area [m/s]
};

/// The air as the canopy meets it, evaluated at the start of every step.
struct AeroState {
    double density = 0.0;                 ///< [kg/m^3] at the payload's altitude
    double viscosity = 0.0;               ///< [Pa s]
    Vec3 wind = Vec3::Zero();             ///< [m/s] at the canopy; zero where the scene has none
    Vec3 wind_at_payload = Vec3::Zero();  ///< [m/s]
    Vec3 direction = Vec3::UnitZ();       ///< e_r: of the air relative to the canopy
    double airspeed = 0.0;                ///< V [m/s] at the reference velocity
    double dynamic_pressure = 0.0;        ///< q [Pa]
    double drag_area = 0.0;               ///< (C_D S)_t [m^2]
    double radial_pressure = 0.0;         ///< phi(t) [-]
    double projected_area = 0.0;          ///< S_p [m^2], sum of the positive element areas along e_r
    double signed_area = 0.0;             ///< [m^2] sum of all
    double pressure = 0.0;                ///< Delta P_a [Pa]
    bool pressure_capped = false;         ///< D/S_p was above c_max q
    Vec3 extraction = Vec3::Zero();       ///< [N] that draws the parachute out of its pack
};

/// Balance of the air in a canopy whose filling is predicted.
struct InflowState {
    bool has_been_full = false;     ///< its area has come to that of the steady canopy
    double volume = 0.0;            ///< [m^3] between fabric, mouth and vent
    double swept = 0.0;             ///< [m^3/s] its rate, by what the fabric sweeps past the mouth
    double mobility = 0.0;          ///< [m^4/kg] of that rate under pressure: sum over nodes of f_i^2/m_i
    double mouth = 0.0;             ///< [m^2]
    double ratio = 0.0;             ///< s [-] inflow over airspeed at the mouth
    double leak = 0.0;              ///< [m^3/s] through fabric and vent
    double steady_drag_area = 0.0;  ///< [m^2] (C_D S)_0, which the open canopy is to have
    double inside = 0.0;            ///< [Pa] pressure but for that of the air around as it makes way
    double last_inside = 0.0;       ///< [Pa] that at the beginning of the last step
    double displaced = 0.0;         ///< Q [m^3/s] that the fabric sweeps past its own mean velocity
    double other_pull = 0.0;        ///< [m^3/s^2] rate of Q but for the pressure's part, as it was
    double mean_pull = 0.0, mean_of_means = 0.0;  ///< [m^3/s^2] of the last steps
    double last_dt = 0.0;                         ///< [s] of the step before the last one
    double loss = 0.0;                            ///< [W] that the air takes out of the motion
    double noted_at = -1.0;                       ///< [s] since release: of Q, which is noted once a step
    std::array<double, 2> past_pressure{};        ///< [Pa] of the last step and of the one before

    /// Q at `time`, the beginning of a step; dt [s] of the step before. Velocities have been extrapolated by
    /// half of that step: of its acceleration there is as much more, and half a step less of the one before.
    ///
    /// A mean over five steps, and one that makes up for its lag: fabric and lines that ring at the bound of
    /// the step, answered a step later at full strength, would ring louder. A step that an event cuts short
    /// says little.
    void note_displaced(double now, double dt, double time) {
        if (time == noted_at) return;  // a change of stage evaluates forces anew
        noted_at = time;
        const double by_pressure =
            mobility * ((dt + 0.5 * last_dt) * past_pressure[0] - 0.5 * last_dt * past_pressure[1]);
        if (dt > 0.0) {
            const double newest = 0.2 / std::max(dt, last_dt);
            mean_pull += newest * (now - displaced - by_pressure - dt * mean_pull);
            mean_of_means += newest * dt * (mean_pull - mean_of_means);
            other_pull = 2.0 * mean_pull - mean_of_means;
        }
        displaced = now;
        last_dt = dt;
    }
    void end_step(double pressure) {
        last_inside = inside;
        past_pressure = {pressure, past_pressure[0]};
    }
};

/// Works since the start, as EnergyLedger signs them. The central difference scheme books them from half step
/// to half step: a work up to `time` is the booked one plus half a step of the last power.
struct EnergyTotals {
    double kinetic_start = 0.0, elastic_start = 0.0;                              // [J]
    double gravity_work = 0.0, drag_work = 0.0, damping = 0.0, added_mass = 0.0;  // [J] to time - dt/2
    double gravity_power = 0.0, drag_power = 0.0, damping_power = 0.0;            // [W] in the last step
    double external_work = 0.0, external_power = 0.0;  // of extraction force and anchor
    double air_loss = 0.0, air_loss_power = 0.0;       // where filling is predicted
    double ramp = 0.0;                                 // [J] see EnergyLedger
    bool weighs = false;         // whether a step is to say the kinetic energy that it began with,
    double kinetic = 0.0;        // [J] which is this
    double changed_hands = 0.0;  // [J] most so far, see energy_scale
};

/// The larger of both; once either is not a number, neither is the answer.
inline double nan_max(double a, double b) {
    return b > a || b != b ? b : a;
}

/// Largest loads in any evaluation of forces so far, of steps and of the subcycles within them. Elastic,
/// without what dashpots and bulk viscosity add.
struct LargestLoads {
    double line_tension = 0.0;   ///< [N] of suspension lines
    double fabric_stress = 0.0;  ///< [N/m] first principal stress resultant, second Piola-Kirchhoff
    double last_stress = 0.0;    ///< [N/m] the same of the last evaluation alone

    void add_tension(double tension) { line_tension = nan_max(line_tension, tension); }
    void add_stress(double stress) {
        last_stress = stress;
        fabric_stress = nan_max(fabric_stress, stress);
    }
};

/// How a payload that is a body has turned. Its place and velocity are those of the payload's node.
struct BodyState {
    std::array<double, 4> attitude{1.0, 0.0, 0.0, 0.0};  ///< unit quaternion w x y z, its axes to x y z
    Vec3 half_momentum = Vec3::Zero();  ///< angular, about its centre [kg m^2/s] at time - dt/2
    Vec3 momentum = Vec3::Zero();       ///< the same at time, extrapolated
    Vec3 torque = Vec3::Zero();         ///< [N m] about its centre, of the risers, at time
};

/// Forces of the risers on the payload in the subcycles of a step, all but its first.
struct RiserPulls {
    Vec3 sum = Vec3::Zero();  ///< [N]
    int count = 0;

    void add(Lanes pull) {
        sum += to_vec3(pull);
        ++count;
    }
};

/// A node near a triangle of fabric that it is no part of.
struct NearPair {
    NodeIndex node = 0;
    std::int32_t triangle = 0;
    int side = 0;            ///< of the triangle's normal, on which the node has to stay; 0: not decided yet
    double thickness = 0.0;  ///< [m] gap below which both push each other off
    double slack =
        0.0;  ///< [m] by which both have to come closer, since the last look, before they can touch
};

/// Near pairs side by side, as the kernels of self-contact want them (self_contact_kernels.hpp).
struct PairColumns {
    std::vector<std::int32_t> index;  ///< of the pairs, in SelfContactState
    std::vector<std::int32_t> node;   ///< offsets of node and corners
    std::vector<double> number;       ///< constants, side and thickness

    void clear() { index.clear(), node.clear(), number.clear(); }
};

/// Self-contact: which nodes are near which triangles, and on which side. Nodes are searched for new pairs
/// now and then, and more often looked at: pairs that cannot touch before the next look sleep.
struct SelfContactState {
    std::vector<NearPair> pairs;  ///< in the order of nodes, then triangles
    /// Nodes at the last look: all x, all y, all z [m] from the mean of the canopy, all weights [-], filled
    /// up with the last one; empty before the first search. A node far from all fabric may stray farther from
    /// where it is expected, and weighs less.
    std::vector<double> looked_at;
    double look_time = 0.0;                                       ///< [s]
    Eigen::Matrix3d velocity_gradient = Eigen::Matrix3d::Zero();  ///< [1/s] of the canopy at the last look
    std::int64_t searches = 0;
    double skin = 0.0;        ///< [m] more than that closer since the search, and another one is due
    double spent = 0.0;       ///< [m] of it, up to the last look
    std::int64_t passed = 0;  ///< nodes that went through fabric and were let go
    double deepest = 0.0;     ///< [-] farthest that a node was on the wrong side, over an edge
    bool listed = false;      ///< the columns below are those of the pairs; made anew after a checkpoint
    PairColumns all, awake;   ///< all pairs; those that may touch before the next look
    std::vector<std::uint32_t> attention = {};  ///< of the step, as the kernel says
    std::vector<double> measured = {};          ///< [m] of the last look
};

/// Everything that changes with time but nodes: current after every step at no cost.
struct SystemState {
    double time = 0.0;     ///< [s] since release
    double dt = 0.0;       ///< [s] length of the step that led here; 0 at the start
    double line_dt = 0.0;  ///< [s] of the last subcycle of lines in it; dt where they took none
    std::int64_t step = 0;
    Phase phase = Phase::initial;
    Stage stage = Stage::flight;
    /// Fabric is folded so far that no edge of it comes taut within the next step: what it does in tension
    /// sets no bound on that.
    bool folded = false;
    double fe_weight = 1.0;  ///< [-] share of their stiffness that the finite elements have

    double added_mass_rate = 0.0;        ///< dM_a/dt [kg/s]
    double added_mass = 0.0;             ///< M_a [kg]
    double largest_added_mass = 0.0;     ///< [kg] so far
    std::optional<BodyState> body = {};  ///< of the payload; absent: it is a point mass
    NodeSums sums;
    AeroState air;
    InflowState inflow;  ///< where filling is predicted
    EnergyTotals energy;
    /// [kg/s] of air that is brought to speed where it accretes: what a breathing canopy lets go of and takes
    /// in again has it already.
    double accretion() const {
        return added_mass < largest_added_mass ? 0.0 : std::max(0.0, added_mass_rate);
    }
    double accretion_power = 0.0;     ///< [W] of the force that brings new air to speed
    double damping_power = 0.0;       ///< [W] dissipated now
    double external_power = 0.0;      ///< [W] of forces from outside the system now
    Vec3 riser_force = Vec3::Zero();  ///< [N] that the risers apply to the payload
    RiserPulls in_subcycles;          ///< and what they did within the last step
    std::int64_t capped_steps = 0;    ///< steps in which the pressure cap acted
    LargestLoads largest;
    SelfContactState contact;  ///< where fabric and lines do not pass through fabric
};

/// Arrays over the nodes. A layout may keep nodes of canopy and lines elsewhere between two synchronisations
/// (Layout::store); payload and static line are always current.
struct NodeArrays {
    /// Nodes of the mesh, a dummy for padding, the attachment points of a body, nodes of the static line.
    std::vector<NodeRecord> node;
    std::vector<NodeVector> v_half;        ///< [m/s] at time - dt/2
    NodeForces force;                      ///< [N] structural and damping forces
    NodeForces aero;                       ///< [N] aerodynamic forces, booked as drag work
    Vec3 contact_reaction = Vec3::Zero();  ///< [N] of gore contact on the payload, one of `force`
};

struct State : SystemState, NodeArrays {};

/// Sets riser_force once the structure's forces are there, of which contact may be one.
inline void note_riser_force(State& state, NodeIndex payload) {
    state.riser_force = to_vec3(state.force[payload].value) - state.contact_reaction;
}

/// riser_force as a mean [N], and the time [s] of that. Where lines take subcycles, what the canopy does to
/// them comes as one impulse a step and runs through them as a wave: the end of a step is always the same
/// moment of it.
struct MeanForce {
    Vec3 value;
    double time;
};
inline MeanForce mean_riser_force(const SystemState& s) {
    return {(s.in_subcycles.sum + s.riser_force) / (1.0 + s.in_subcycles.count),
            s.time - 0.5 * s.in_subcycles.count * s.line_dt};
}

/// No force on any node, and nothing dissipated yet; from here on the state holds those from node `first` on.
inline void clear_forces(State& state, std::size_t first = 0) {
    for (NodeForces* forces : {&state.force, &state.aero})
        forces->clear(state.node.size(), first);
    state.damping_power = state.accretion_power = state.external_power = 0.0;
    state.contact_reaction = Vec3::Zero();
}

}  // namespace twinchute::fullsim
