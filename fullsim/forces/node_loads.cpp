// Loads on nodes: breathing damping, Rayleigh mass damping, payload drag, accretion of air.
#include "fullsim/forces/node_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/body.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/laws/node.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

/// f_i = -k_b rho V S_i (v_i - v_mean), S_i the unstrained tributary area, v_mean with the same
/// weights: no net force, only dissipation.
class BreathingDamping final : public NodeLoad {
public:
    BreathingDamping(const Mesh& mesh, double k) : NodeLoad(mesh), k_(k) {}

    Block block() const override { return Block::breathing_damping; }
    void add_to(NodeLoads& loads, const State& state) const override {
        loads.breathing += k_ * state.air.density * state.air.airspeed * fabric_area();
        loads.canopy_mean = state.sums.canopy_area_velocity;
    }

private:
    double k_;
};

/// f_i = -alpha m_i (v_i - v_system) (paper, Eq. 4): damps motion about the mean, not the fall.
class MassDamping final : public NodeLoad {
public:
    MassDamping(const Mesh& mesh, double alpha) : NodeLoad(mesh), alpha_(alpha) {}

    Block block() const override { return Block::mass_damping; }
    void add_to(NodeLoads& loads, const State& state) const override {
        loads.mass_damping += alpha_;
        loads.system_mean = state.sums.system_velocity;
    }

private:
    double alpha_;  // [1/s]
};

/// -1/2 rho C_D S |v| v on the payload, v relative to the air (paper, 3.1).
class PayloadDrag final : public ForceModel {
public:
    PayloadDrag(const Mesh& mesh, double drag_area) : payload_(mesh.payload()), drag_area_(drag_area) {}

    Block block() const override { return Block::payload_drag; }
    NodeIndex first_node() const override { return payload_; }

    void add_forces(State& state) const override {
        const Vec3 v = to_vec3(state.node[payload_].v) - state.air.wind_at_payload;
        state.aero[payload_].value -= to_lanes(0.5 * state.air.density * drag_area_ * v.norm() * v);
    }

private:
    NodeIndex payload_;
    double drag_area_;  // [m^2]
};

/// Drag of a body as PayloadDrag, with C_D S of its attitude. The force acts at its centre of mass, without a
/// moment.
class AttitudeDragBlock final : public ForceModel {
public:
    AttitudeDragBlock(const Mesh& mesh, const AttitudeDrag& table)
        : payload_(mesh.payload()), table_(table), axes_(principal_axes(mesh.body->lumped)) {}

    Block block() const override { return Block::payload_drag; }
    NodeIndex first_node() const override { return payload_; }

    void add_forces(State& state) const override {
        const Vec3 v = to_vec3(state.node[payload_].v) - state.air.wind_at_payload;
        const double speed = v.norm();
        if (!(speed > 0.0)) return;
        const double drag_area = table_.drag_area(attitude_in_air(body_axis(*state.body, axes_), v));
        state.aero[payload_].value -= to_lanes(0.5 * state.air.density * drag_area * speed * v);
    }

private:
    NodeIndex payload_;
    const AttitudeDrag& table_;
    Eigen::Matrix3d axes_;
};

/// f_i = -(dM_a/dt) s_i (v_i - V_w) while the added mass grows, s_i the node's share of the fabric:
/// air that joins the canopy is brought to its speed. Booked as work of the added mass.
class Accretion final : public NodeLoad {
public:
    explicit Accretion(const Mesh& mesh) : NodeLoad(mesh) {}

    Block block() const override { return Block::accretion; }
    void add_to(NodeLoads& loads, const State& state) const override {
        loads.accretion += state.accretion();
        loads.wind = state.air.wind;
    }
};

}  // namespace

NodeLoads NodeLoad::now(const State& state) const {
    NodeLoads loads;
    add_to(loads, state);
    return loads;
}

void NodeLoad::add_forces(State& state) const {
    const NodeLoads loads = now(state);
    const Lanes on_fabric = to_lanes(loads.on_fabric), canopy_mean = to_lanes(loads.canopy_mean),
                wind = to_lanes(loads.wind), system_mean = to_lanes(loads.system_mean);
    Lanes dissipated = splat(0.0), power = splat(0.0);
    for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i) {
        const Lanes v = state.node[i].v;
        state.aero[i].value += share(i) * on_fabric;
        law::resist(share(i) * loads.breathing, v - canopy_mean, state.force[i].value, dissipated);
        law::accrete(share(i) * loads.accretion, wind, v, state.force[i].value, power);
    }
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i)
        law::resist(loads.mass_damping * mesh_.mass[i], state.node[i].v - system_mean, state.force[i].value,
                    dissipated);
    state.damping_power += sum3(dissipated);
    state.accretion_power += sum3(power);
}

void NodeLoad::add_row_sums(const State& state, GershgorinSums& sums) const {
    const NodeLoads loads = now(state);
    for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
        sums.damping[i] += share(i) * loads.damping_by_share();
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i)
        sums.damping[i] += loads.mass_damping * mesh_.mass[i];
}

std::unique_ptr<const ForceModel> make_attitude_drag(const Mesh& mesh, const AttitudeDrag& table) {
    return std::make_unique<AttitudeDragBlock>(mesh, table);
}

std::unique_ptr<const ForceModel> make_accretion(const Mesh& mesh) {
    return std::make_unique<Accretion>(mesh);
}

std::unique_ptr<const ForceModel> make_breathing_damping(const Mesh& mesh, double k) {
    return std::make_unique<BreathingDamping>(mesh, k);
}

std::unique_ptr<const ForceModel> make_mass_damping(const Mesh& mesh, double alpha) {
    return std::make_unique<MassDamping>(mesh, alpha);
}

std::unique_ptr<const ForceModel> make_payload_drag(const Mesh& mesh, double drag_area) {
    return std::make_unique<PayloadDrag>(mesh, drag_area);
}

}  // namespace twinchute::fullsim
