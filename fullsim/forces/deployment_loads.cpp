// What acts on a parachute only until snatch: drag of its cloth, resistance of its folds, extraction.
#include "fullsim/forces/gather.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/spring.hpp"

namespace twinchute::fullsim {
namespace {

/// 1/2 rho C_D |A.e| V^2 e on each triangle, a third to each corner: V e is the air's velocity relative to
/// the triangle's own mean (paper, 3.2.1; Eqs 11 and 12 with phi = 0).
class ClothDrag final : public ForceModel {
public:
    ClothDrag(const Mesh& mesh, double coefficient) : mesh_(mesh), coefficient_(coefficient) {}

    std::string_view name() const override { return "cloth drag"; }
    std::size_t elements() const override { return mesh_.triangles.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return corner_groups(mesh_); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<CornerGroup>& groups) const {
        const Vec3& w = state.air.wind;
        const Lanes3 wind{splat(w.x()), splat(w.y()), splat(w.z())};
        const Lanes third = splat(1.0 / 3.0), factor = splat(0.5 * state.air.density * coefficient_ / 3.0);
        Lanes across = splat(0.0);
        const NodeForces::View on_node = state.aero.view();
        for (const CornerGroup& g : groups) {
            const Lanes3 x0 = gather_position(state.node, g.node[0]);
            const Lanes3 e1 = gather_position(state.node, g.node[1]) - x0;
            const Lanes3 e2 = gather_position(state.node, g.node[2]) - x0;
            const Lanes3 area = splat(0.5) * cross(e1, e2);
            const Lanes3 velocity = wind - third * (gather_velocity(state.node, g.node[0]) +
                                                    gather_velocity(state.node, g.node[1]) +
                                                    gather_velocity(state.node, g.node[2]));
            const Lanes flow = dot(area, velocity);  // |A.e| V
            const Lanes swept = flow > splat(0.0) ? flow : -flow;
            across += swept * inverse_root(dot(velocity, velocity) + 1e-18);
            const CornerForces corner(factor * swept * velocity);
            for (int k = 0; k < lane_count; ++k)
                for (int c = 0; c < 3; ++c)
                    on_node[g.node[c][k]].value += corner.row[k];
        }
        state.air.projected_area = sum(across);
    }

private:
    const Mesh& mesh_;
    double coefficient_;
    GroupsOnDemand<CornerGroup> groups_;
};

struct alignas(32) EdgeGroup {
    std::array<LaneNodes, 2> node;
    Lanes rest_length;  // [m]
    Lanes force;        // [N]
};

/// A force per width that holds folded cloth against being drawn out, so that the lines come first (paper,
/// 5.2): along every edge shorter than unfolded, while it lengthens. It only takes energy. The paper's acts
/// at rest, too; that would draw a pack together into a point.
class FoldResistance final : public ForceModel {
public:
    FoldResistance(const Mesh& mesh, double resistance) : mesh_(mesh), resistance_(resistance) {}

    std::string_view name() const override { return "fold resistance"; }
    std::size_t elements() const override { return edges().size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<EdgeGroup>& groups) const {
        const Lanes zero = splat(0.0), one = splat(1.0);
        Lanes dissipated = zero;
        const NodeForces::View on_node = state.force.view();
        for (const EdgeGroup& g : groups) {
            const Lanes3 d = gather_position(state.node, g.node[1]) - gather_position(state.node, g.node[0]);
            const Lanes3 w = gather_velocity(state.node, g.node[1]) - gather_velocity(state.node, g.node[0]);
            const Lanes length = square_root(dot(d, d) + 1e-18);
            const Lanes inverse = 1.0 / length;
            const Lanes lengthening = larger(dot(d, w) * inverse, zero);
            const Lanes share = lengthening / splat(full_fold_speed);
            const Lanes folded = length < g.rest_length ? g.force : zero;
            const Lanes force = folded * (share < one ? share : one);
            dissipated += force * lengthening;
            const CornerForces pull(force * inverse * d);
            for (int k = 0; k < lane_count; ++k) {
                on_node[g.node[0][k]].value += pull.row[k];
                on_node[g.node[1][k]].value -= pull.row[k];
            }
        }
        state.damping_power += sum(dissipated);
    }

    void add_row_sums(const State&, RowSums& sums) const override {
        for (const FabricEdge& e : edges())
            for (int end = 0; end < 2; ++end) {
                const double columns = 1.0 + sums.over(e.node[1 - end], e.node[end]);
                sums.damping[e.node[end]] += columns * force(e) / full_fold_speed;
            }
    }

private:
    std::vector<EdgeGroup> make_groups() const {
        const std::vector<FabricEdge>& all = edges();
        std::vector<EdgeGroup> groups;
        for (std::size_t first = 0; first < all.size(); first += lane_count) {
            EdgeGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= all.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? mesh_.dummy() : all[first + k].node[end];
                g.rest_length[k] = padding ? 0.0 : all[first + k].rest_length;
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
    double force(const FabricEdge& e) const { return resistance_ * e.section / mesh_.fabric.thickness; }

    const Mesh& mesh_;
    double resistance_;  // [N/m]
    GroupsOnDemand<FabricEdge> edges_;
    GroupsOnDemand<EdgeGroup> groups_;
};

/// The prescribed force straight behind the release (paper, 2.1): on the vent's seams or on the whole canopy
/// by area.
class Extraction final : public ForceModel {
public:
    Extraction(const Mesh& mesh, const ForceHistory& history, bool on_apex, const Vec3& direction)
        : history_(history), direction_(direction) {
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

    std::string_view name() const override { return "extraction"; }
    std::size_t bytes() const override { return shares_.capacity() * sizeof(Share); }

    void add_forces(State& state) const override {
        const double now = history_.at(state.time);
        if (now == 0.0) return;
        const Lanes force = to_lanes(now * direction_);
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
    const ForceHistory& history_;
    Vec3 direction_;
    std::vector<Share> shares_;
};

}  // namespace

std::unique_ptr<const ForceModel> make_cloth_drag(const Mesh& mesh, double coefficient) {
    return std::make_unique<ClothDrag>(mesh, coefficient);
}

std::unique_ptr<const ForceModel> make_fold_resistance(const Mesh& mesh, double resistance) {
    return std::make_unique<FoldResistance>(mesh, resistance);
}

std::unique_ptr<const ForceModel> make_extraction(const Mesh& mesh, const ForceHistory& history, bool on_apex,
                                                  const Vec3& direction) {
    return std::make_unique<Extraction>(mesh, history, on_apex, direction);
}

}  // namespace twinchute::fullsim
