// Loads on a parachute until snatch only: fabric drag, deployment resistance of its folds, extraction.
#include "fullsim/elements/fabric_spring.hpp"
#include "fullsim/elements/membrane.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/spring.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

/// 1/2 rho C_D |A.e| V^2 e on each triangle, a third to each corner: V e is the air's velocity relative to
/// the triangle's own mean (paper, 3.2.1; Eqs 11 and 12 with phi = 0).
class FabricDragBlock final : public ForceModel {
public:
    FabricDragBlock(const Mesh& mesh, double coefficient) : mesh_(mesh), coefficient_(coefficient) {}

    Block block() const override { return Block::fabric_drag; }
    std::size_t elements() const override { return mesh_.triangles.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return corner_groups(mesh_); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<CornerGroup>& groups) const {
        const FabricDragPass pass{0.5 * state.air.density * coefficient_,
                                  {state.air.wind.x(), state.air.wind.y(), state.air.wind.z()}};
        state.air.projected_area =
            law::fabric_drag_forces(
                LanesView<TriangleLanes<CornerGroup>>(state.node, state.aero.view(), groups), pass)
                .positive_area;
    }

private:
    const Mesh& mesh_;
    double coefficient_;
    GroupsOnDemand<CornerGroup> groups_;
};

struct alignas(32) FoldGroup {
    std::array<LaneNodes, 2> node;
    Lanes inverse_length;  // [1/m]
    Lanes force;           // [N]
};

class FoldElements : public SpanLanes<FoldGroup> {
public:
    HWY_INLINE FoldElements(const std::vector<NodeRecord>& node, NodeForces::View on_node, const Group& group)
        : SpanLanes(node, on_node, group) {}

    HWY_INLINE Lanes fold_force() const { return g_.force; }
};

/// A force per width that holds folded fabric against being drawn out, so that the lines come first (paper,
/// 5.2): along every edge shorter than unfolded, while it lengthens. It only takes energy. The paper's acts
/// at rest, too; that would draw a pack together into a point.
class DeploymentResistance final : public ForceModel {
public:
    DeploymentResistance(const Mesh& mesh, double resistance) : mesh_(mesh), resistance_(resistance) {}

    Block block() const override { return Block::deployment_resistance; }
    std::size_t elements() const override { return edges().size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<FoldGroup>& groups) const {
        state.damping_power += law::spring_forces_of<false, true>(
                                   LanesView<FoldElements>(state.node, state.force.view(), groups), {})
                                   .dissipated;
    }

    void add_row_sums(const State&, GershgorinSums& sums) const override {
        for (const FabricEdge& e : edges())
            for (int end = 0; end < 2; ++end) {
                const double columns = 1.0 + sums.over(e.node[1 - end], e.node[end]);
                sums.damping[e.node[end]] += columns * force(e) / full_fold_speed;
            }
    }

private:
    std::vector<FoldGroup> make_groups() const {
        const std::vector<FabricEdge>& all = edges();
        std::vector<FoldGroup> groups;
        for (std::size_t first = 0; first < all.size(); first += lane_count) {
            FoldGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= all.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? mesh_.dummy() : all[first + k].node[end];
                g.inverse_length[k] = padding ? 1.0 : 1.0 / all[first + k].rest_length;
                g.force[k] = padding ? 0.0 : force(all[first + k]);
            }
            groups.push_back(g);
        }
        return groups;
    }

    const std::vector<FabricEdge>& edges() const {
        return edges_.get([this] { return fabric_edges(mesh_); });
    }
    /// [N]
    double force(const FabricEdge& e) const { return fold_force(mesh_.fabric_of(e.sheet), e, resistance_); }

    const Mesh& mesh_;
    double resistance_;  // [N/m]
    GroupsOnDemand<FabricEdge> edges_;
    GroupsOnDemand<FoldGroup> groups_;
};

/// The force that draws the parachute out (AeroState::extraction; paper, 2.1): on the vent's seams or on the
/// whole canopy by area.
class Extraction final : public ForceModel {
public:
    Extraction(const Mesh& mesh, bool on_apex) {
        if (on_apex) {
            const auto& vent = mesh.seam_rings.front();
            for (const NodeIndex i : vent)
                shares_.push_back({i, 1.0 / static_cast<double>(vent.size())});
        } else {
            const double area = mesh.fabric_area();
            for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
                shares_.push_back({i, mesh.tributary_area[i] / area});
        }
    }

    Block block() const override { return Block::extraction; }
    std::size_t bytes() const override { return shares_.capacity() * sizeof(Share); }

    void add_forces(State& state) const override {
        if (state.air.extraction.isZero(0.0)) return;
        const Lanes force = to_lanes(state.air.extraction);
        Lanes power = splat(0.0);
        for (const Share& s : shares_) {
            state.force[s.node].value += s.part * force;
            power += s.part * force * state.node[s.node].v;
        }
        state.external_power += sum3(power);
    }

private:
    struct Share {
        NodeIndex node;
        double part;  // [-]
    };
    std::vector<Share> shares_;
};

}  // namespace

double fabric_drag_coefficient(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    return chute.deploy.drag_coefficient * (1.0 - slot_share(chute));
}

std::unique_ptr<const ForceModel> make_fabric_drag(const Mesh& mesh, double coefficient) {
    return std::make_unique<FabricDragBlock>(mesh, coefficient);
}

std::unique_ptr<const ForceModel> make_deployment_resistance(const Mesh& mesh, double resistance) {
    return std::make_unique<DeploymentResistance>(mesh, resistance);
}

std::unique_ptr<const ForceModel> make_extraction(const Mesh& mesh, bool on_apex) {
    return std::make_unique<Extraction>(mesh, on_apex);
}

}  // namespace twinchute::fullsim
