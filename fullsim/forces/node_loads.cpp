// Loads on nodes: breathing damping, Rayleigh mass damping, payload drag, accretion of air.
#include <Eigen/Geometry>
#include <cmath>

#include "fullsim/body.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/laws/node.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

/// f_i = -k_b rho V S_i (v_i - v_mean), S_i the unstrained tributary area, v_mean with the same
/// weights: no net force, only dissipation.
class BreathingDamping final : public ForceModel {
public:
    BreathingDamping(const Mesh& mesh, double k)
        : k_(k), canopy_nodes_(mesh.canopy_nodes), area_(mesh.tributary_area) {}

    Block block() const override { return Block::breathing_damping; }

    void add_forces(State& state) const override {
        const double per_area = k_ * state.air.density * state.air.airspeed;
        const Lanes mean = to_lanes(state.sums.canopy_area_velocity);
        Lanes dissipated = splat(0.0);
        for (NodeIndex i = 0; i < canopy_nodes_; ++i) {
            law::resist(per_area * area_[i], state.node[i].v - mean, state.force[i].value, dissipated);
        }
        state.damping_power += sum3(dissipated);
    }

    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        for (NodeIndex i = 0; i < canopy_nodes_; ++i)
            sums.damping[i] += k_ * state.air.density * state.air.airspeed * area_[i];
    }

private:
    double k_;
    NodeIndex canopy_nodes_;
    const std::vector<double>& area_;  // [m^2]
};

/// f_i = -alpha m_i (v_i - v_system) (paper, Eq. 4): damps motion about the mean, not the fall.
class MassDamping final : public ForceModel {
public:
    MassDamping(const Mesh& mesh, double alpha) : alpha_(alpha), mass_(mesh.mass) {}

    Block block() const override { return Block::mass_damping; }

    void add_forces(State& state) const override {
        const Lanes mean = to_lanes(state.sums.system_velocity);
        Lanes dissipated = splat(0.0);
        for (std::size_t i = 0; i < mass_.size(); ++i) {
            law::resist(alpha_ * mass_[i], state.node[i].v - mean, state.force[i].value, dissipated);
        }
        state.damping_power += sum3(dissipated);
    }

    void add_row_sums(const State&, GershgorinSums& sums) const override {
        for (std::size_t i = 0; i < mass_.size(); ++i)
            sums.damping[i] += alpha_ * mass_[i];
    }

private:
    double alpha_;  // [1/s]
    const std::vector<double>& mass_;
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
        const Vec3 axis = body_axis(*state.body, axes_);
        // The air goes past it along -v; from both products the angle is right near 0 and pi, too.
        const double angle = std::atan2(axis.cross(v).norm(), -axis.dot(v));
        const double drag_area = table_.drag_area(angle);
        state.aero[payload_].value -= to_lanes(0.5 * state.air.density * drag_area * speed * v);
    }

private:
    NodeIndex payload_;
    const AttitudeDrag& table_;
    Eigen::Matrix3d axes_;
};

/// f_i = -(dM_a/dt) s_i (v_i - V_w) while the added mass grows, s_i the node's share of the fabric:
/// air that joins the canopy is brought to its speed. Booked as work of the added mass.
class Accretion final : public ForceModel {
public:
    explicit Accretion(const Mesh& mesh) {
        const double area = mesh.fabric_area();
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
            share_.push_back(mesh.tributary_area[i] / area);
    }

    Block block() const override { return Block::accretion; }
    std::size_t bytes() const override { return share_.capacity() * sizeof(double); }

    void add_forces(State& state) const override {
        if (state.accretion() == 0.0) return;
        const Lanes wind = to_lanes(state.air.wind);
        Lanes power = splat(0.0);
        for (std::size_t i = 0; i < share_.size(); ++i) {
            law::accrete(state.accretion() * share_[i], wind, state.node[i].v, state.force[i].value, power);
        }
        state.accretion_power += sum3(power);
    }

    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        if (state.accretion() == 0.0) return;
        for (std::size_t i = 0; i < share_.size(); ++i)
            sums.damping[i] += state.accretion() * share_[i];
    }

private:
    std::vector<double> share_;  // [-]
};

}  // namespace

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
