// The canopy's fabric as springs and dashpots along the edges of its triangles (paper, 2.1).
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include "fullsim/elements/fabric_spring.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/spring.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

struct alignas(32) SpringGroup {
    std::array<LaneNodes, 2> node;
    Lanes inverse_length;  // 1/l0 [1/m]
    Lanes stiffness;       // EA [N]
    Lanes hardening;       // (H - 1)/(2 e_m): EA (e + hardening e^2) up to e_m, of slope H beyond
    Lanes dashpot;         // (beta E/l0 + b1 rho c1) A [N s/m] (paper, Eq. 3)
};

class SpringElements : public SpanLanes<SpringGroup> {
public:
    HWY_INLINE SpringElements(const std::vector<NodeRecord>& node, NodeForces::View on_node,
                              const SpringGroup& group)
        : SpanLanes(node, on_node, group) {}

    HWY_INLINE Lanes hardening() const { return g_.hardening; }
};

class FabricSprings final : public ForceModel {
public:
    FabricSprings(const Mesh& mesh, double repulsion, double bulk_viscosity, double beta)
        : repulsion_(repulsion),
          mesh_(mesh),
          edges_(fabric_edges(mesh)),
          dummy_(mesh.dummy()),
          bulk_viscosity_(bulk_viscosity),
          beta_(beta) {}

    Block block() const override { return Block::fabric_springs; }
    std::size_t elements() const override { return edges_.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<SpringGroup>& groups) const {
        state.damping_power +=
            law::spring_forces_of<true, false>(
                LanesView<SpringElements>(state.node, state.force.view(), groups), {repulsion_, true})
                .dissipated;
    }

    std::size_t bytes() const override { return edges_.capacity() * sizeof(FabricEdge); }
    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        for (const FabricEdge& e : edges_) {
            const SpringConstants c = constants(e);
            const double unstrained = c.stiffness / e.rest_length;
            // Any edge may come taut any time, unless all are folded.
            const double tangent = state.folded
                                       ? repulsion_ * unstrained
                                       : unstrained * law::spring_tangent(strain(state, e), c.hardening);
            const double damping = state.folded ? 0.0 : c.dashpot;
            for (int end = 0; end < 2; ++end) {
                const double columns = 1.0 + sums.over(e.node[1 - end], e.node[end]);
                sums.stiffness[e.node[end]] += columns * tangent;
                sums.damping[e.node[end]] += columns * damping;
            }
        }
    }

    double energy(const State& state) const override {
        double total = 0.0;
        for (const FabricEdge& e : edges_) {
            const SpringConstants c = constants(e);
            total +=
                c.stiffness * e.rest_length * law::spring_energy(strain(state, e), c.hardening, repulsion_);
        }
        return total;
    }

    StrainExtremum extreme(const State& state) const override {
        StrainExtremum most{-1.0};
        for (std::size_t i = 0; i < edges_.size(); ++i)
            if (const double s = strain(state, edges_[i]); s > most.strain) most = {s, i};
        return most;
    }

    std::string element_name(std::size_t i) const override { return fmt::format("fabric edge {}", i); }

private:
    std::vector<SpringGroup> make_groups() const {
        std::vector<SpringGroup> groups;
        for (std::size_t first = 0; first < edges_.size(); first += lane_count) {
            SpringGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= edges_.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? dummy_ : edges_[first + k].node[end];
                const SpringConstants c =
                    padding ? SpringConstants{1.0, 0.0, 0.0, 0.0} : constants(edges_[first + k]);
                g.inverse_length[k] = c.inverse_length;
                g.stiffness[k] = c.stiffness;
                g.hardening[k] = c.hardening;
                g.dashpot[k] = c.dashpot;
            }
            groups.push_back(g);
        }
        return groups;
    }

    SpringConstants constants(const FabricEdge& e) const {
        return fabric_spring_constants(mesh_.fabric_of(e.sheet), e, bulk_viscosity_, beta_);
    }

    static double strain(const State& state, const FabricEdge& e) {
        const Vec3 d = to_vec3(state.node[e.node[1]].x) - to_vec3(state.node[e.node[0]].x);
        return law::span_strain(1.0 / e.rest_length, d);
    }

    double repulsion_;  // of folded fabric over the stiffness in tension [-]
    const Mesh& mesh_;
    std::vector<FabricEdge> edges_;
    NodeIndex dummy_;
    double bulk_viscosity_, beta_;  // [-], [s]
    GroupsOnDemand<SpringGroup> groups_;
};

}  // namespace

std::vector<FabricEdge> fabric_edges(const Mesh& mesh) {
    std::map<std::pair<NodeIndex, NodeIndex>, FabricEdge> found;
    const auto add = [&](const Triangle& t, int i, int j, double length) {
        FabricEdge& e = found[std::minmax(t.node[i], t.node[j])];
        const Fabric& fabric = mesh.fabric_of(t.sheet);
        if (e.rest_length == 0.0) e.sheet = t.sheet;
        e.node = {std::min(t.node[i], t.node[j]), std::max(t.node[i], t.node[j])};
        e.rest_length = length;
        const double share =
            t.sheet == e.sheet ? 1.0 : fabric.youngs_modulus / mesh.fabric_of(e.sheet).youngs_modulus;
        e.section += share * fabric.thickness * t.area() / length;
    };
    for (const Triangle& t : mesh.triangles) {
        add(t, 0, 1, t.a);
        add(t, 0, 2, std::hypot(t.b, t.c));
        add(t, 1, 2, std::hypot(t.b - t.a, t.c));
    }
    std::vector<FabricEdge> edges;
    edges.reserve(found.size());
    for (const auto& [nodes, edge] : found)
        edges.push_back(edge);

    // Gershgorin row sums of fabric and of cables, unstrained, and the row that sets the step.
    const std::size_t count = mesh.mass.size();
    std::vector<double> fabric(count, 0.0), cables(count, 0.0);
    for (const FabricEdge& e : edges)
        for (const NodeIndex i : e.node)
            fabric[i] += 2.0 * mesh.fabric_of(e.sheet).youngs_modulus * e.section / e.rest_length;
    for (const Cable& c : mesh.cables)
        for (const NodeIndex i : c.node)
            if (i < mesh.node_count())  // not a place on a body
                cables[i] += 2.0 * mesh.cord(c.kind).axial_stiffness() * c.strands / c.rest_length;
    double fastest = 0.0;
    for (std::size_t i = 0; i < count; ++i)
        fastest = std::max(fastest, (fabric[i] + cables[i]) / mesh.mass[i]);
    for (FabricEdge& e : edges) {
        e.hardening = largest_hardening;
        for (const NodeIndex i : e.node)
            e.hardening = std::min(e.hardening, (fastest * mesh.mass[i] - cables[i]) / fabric[i]);
        e.hardening = std::max(1.0, e.hardening);
    }
    return edges;
}

std::unique_ptr<const ForceModel> make_fabric_springs(const Mesh& mesh, double repulsion,
                                                      double bulk_viscosity, double beta) {
    return std::make_unique<FabricSprings>(mesh, repulsion, bulk_viscosity, beta);
}

}  // namespace twinchute::fullsim
