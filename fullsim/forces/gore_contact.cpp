// Contact between neighbouring gores: cloth does not pass through cloth where folds of one gore meet those of
// the next.
#include <numeric>

#include <Eigen/Geometry>

#include "fullsim/forces/contact_kernel.hpp"
#include "fullsim/forces/gather.hpp"
#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {

using HWY_NAMESPACE::contact_arm;
using HWY_NAMESPACE::contact_push;

CanopyAxis canopy_axis(const Vec3& canopy, const Vec3& payload) {
    const Vec3 along = canopy - payload;
    const double length = along.norm();
    return {canopy, along / length, length};
}

AxisReaction axis_reaction(const CanopyAxis& axis, const Vec3& by_middle, const Vec3& by_turning) {
    const Vec3 across = (by_turning - by_turning.dot(axis.direction) * axis.direction) / axis.length;
    return {by_middle - across, across};
}

namespace {

struct alignas(32) PairGroup {
    std::array<LaneNodes, 2> node;
    Lanes stiffness;  // [N/m]
};

Lanes3 splat3(const Vec3& a) {
    return {splat(a.x()), splat(a.y()), splat(a.z())};
}
Vec3 sum_of(const Lanes3& a) {
    return {sum(a.x), sum(a.y), sum(a.z)};
}

class GoreContact final : public ForceModel {
public:
    explicit GoreContact(const Mesh& mesh)
        : mesh_(mesh),
          canopy_mass_(std::accumulate(mesh.mass.begin(), mesh.mass.begin() + mesh.canopy_nodes, 0.0)) {}

    std::string_view name() const override { return "gore contact"; }

    void add_forces(State& state) const override {
        const CanopyAxis axis = axis_of(state);
        Vec3 by_middle = Vec3::Zero(), by_turning = Vec3::Zero();
        sweep(state, groups_.get([this] { return make_groups(); }), axis, by_middle, by_turning);
        const AxisReaction on = axis_reaction(axis, by_middle, by_turning);
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            state.force[i].value += to_lanes(mesh_.mass[i] / canopy_mass_ * on.canopy);
        state.force[mesh_.payload()].value += to_lanes(on.payload);
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<PairGroup>& groups,
                                      const CanopyAxis& axis, Vec3& by_middle, Vec3& by_turning) const {
        const Lanes3 u = splat3(axis.direction), centre = splat3(axis.canopy);
        Lanes3 middles = splat3(Vec3::Zero()), turning = middles;
        const NodeForces::View on_node = state.force.view();
        for (const PairGroup& g : groups) {
            const Lanes3 x0 = gather_position(state.node, g.node[0]),
                         x1 = gather_position(state.node, g.node[1]);
            const auto arm = contact_arm(splat(0.0), u, x0 - centre, x1 - x0);
            if (sum(arm.behind) == 0.0) continue;  // all in order
            const auto push = contact_push(g.stiffness, u, arm);
            middles = middles + splat(2.0) * push.half_of_middle;
            turning = turning + push.by_turning;
            const CornerForces first(push.apart - push.half_of_middle),
                second(push.apart + push.half_of_middle);
            for (int k = 0; k < lane_count; ++k) {
                on_node[g.node[0][k]].value += first.row[k];
                on_node[g.node[1][k]].value -= second.row[k];
            }
        }
        by_middle = sum_of(middles);
        by_turning = sum_of(turning);
    }

    /// As if all pairs met: they may at any time.
    void add_row_sums(const State&, RowSums& sums) const override {
        for_each_contact(mesh_, [&](const ContactPair<NodeIndex>& pair) {
            for (int end = 0; end < 2; ++end)
                sums.stiffness[pair.node[end]] +=
                    (1.0 + sums.over(pair.node[1 - end], pair.node[end])) * contact_tangent(pair.stiffness);
        });
    }

    double energy(const State& state) const override {
        const CanopyAxis axis = axis_of(state);
        const Lanes3 u = splat3(axis.direction), centre = splat3(axis.canopy);
        Lanes total = splat(0.0);
        for (const PairGroup& g : groups_.get([this] { return make_groups(); })) {
            const Lanes3 x0 = gather_position(state.node, g.node[0]),
                         x1 = gather_position(state.node, g.node[1]);
            total += contact_push(g.stiffness, u, contact_arm(splat(0.0), u, x0 - centre, x1 - x0)).energy;
        }
        return sum(total);
    }

private:
    CanopyAxis axis_of(const State& state) const {
        Lanes sum = splat(0.0);
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            sum += mesh_.mass[i] * state.node[i].x;
        return canopy_axis(to_vec3(sum) / canopy_mass_, to_vec3(state.node[mesh_.payload()].x));
    }
    std::vector<PairGroup> make_groups() const {
        const auto pairs = gore_contacts(mesh_);
        std::vector<PairGroup> groups;
        for (std::size_t first = 0; first < pairs.size(); first += lane_count) {
            PairGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= pairs.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? mesh_.dummy() : pairs[first + k].node[end];
                g.stiffness[k] = padding ? 0.0 : pairs[first + k].stiffness;
            }
            groups.push_back(g);
        }
        return groups;
    }

    const Mesh& mesh_;
    double canopy_mass_;  // [kg]
    GroupsOnDemand<PairGroup> groups_;
};

}  // namespace

std::unique_ptr<const ForceModel> make_gore_contact(const Mesh& mesh) {
    return std::make_unique<GoreContact>(mesh);
}

}  // namespace twinchute::fullsim
