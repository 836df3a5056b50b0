// Contact between neighbouring gores: fabric does not pass through fabric where folds of one gore meet those
// of the next.
#include <numeric>

#include <Eigen/Geometry>

#include "fullsim/elements/contact.hpp"
#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

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

class PairElements : public LanesElement<PairGroup> {
public:
    HWY_INLINE PairElements(const std::vector<NodeRecord>& node, NodeForces::View on_node, const Group& group)
        : LanesElement(node, on_node, group) {}

    HWY_INLINE Lanes stiffness() const { return g_.stiffness; }
    HWY_INLINE void arm_and_distance(Lanes3 centre, Lanes3& arm, Lanes3& d) const {
        const Lanes3 x0 = x(0);
        arm = x0 - centre, d = x(1) - x0;
    }
    HWY_INLINE void push_apart(Lanes3 apart, Lanes3 half_of_middle) const {
        add_force(0, apart - half_of_middle);
        subtract_force(1, apart + half_of_middle);
    }
};

ContactPass pass_around(const CanopyAxis& axis) {
    const Vec3 &c = axis.canopy, &u = axis.direction;
    return {{c.x(), c.y(), c.z()}, {u.x(), u.y(), u.z()}};
}

class GoreContact final : public ForceModel {
public:
    explicit GoreContact(const Mesh& mesh)
        : mesh_(mesh),
          canopy_mass_(std::accumulate(mesh.mass.begin(), mesh.mass.begin() + mesh.canopy_nodes, 0.0)) {}

    Block block() const override { return Block::gore_contact; }

    void add_forces(State& state) const override {
        const CanopyAxis axis = axis_of(state);
        const ElementSums sums = sweep(state, groups_.get([this] { return make_groups(); }), axis);
        const AxisReaction on = axis_reaction(axis, Vec3(sums.by_arm.data()), Vec3(sums.by_turning.data()));
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            state.force[i].value += to_lanes(mesh_.mass[i] / canopy_mass_ * on.canopy);
        state.contact_reaction = on.payload;
        state.force[mesh_.payload()].value += to_lanes(on.payload);
    }

    TWINCHUTE_FOR_EACH_CPU ElementSums sweep(State& state, const std::vector<PairGroup>& groups,
                                             const CanopyAxis& axis) const {
        return law::contact_forces(LanesView<PairElements>(state.node, state.force.view(), groups),
                                   pass_around(axis));
    }

    /// As if all pairs met: they may at any time.
    void add_row_sums(const State&, GershgorinSums& sums) const override {
        for_each_contact(mesh_, [&](const ContactPair<NodeIndex>& pair) {
            for (int end = 0; end < 2; ++end)
                sums.stiffness[pair.node[end]] +=
                    (1.0 + sums.over(pair.node[1 - end], pair.node[end])) * contact_tangent(pair.stiffness);
        });
    }

    double energy(const State& state) const override {
        NodeForces none;
        return law::contact_levels(LanesView<PairElements>(state.node, none.view(),
                                                           groups_.get([this] { return make_groups(); })),
                                   pass_around(axis_of(state)))
            .energy;
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
