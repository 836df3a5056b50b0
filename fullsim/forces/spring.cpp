// The canopy's cloth as springs and dashpots along the edges of its triangles (paper, 2.1).
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include "fullsim/forces/gather.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/spring.hpp"

namespace twinchute::fullsim {
namespace {

struct alignas(32) Group {
    std::array<LaneNodes, 2> node;
    Lanes inverse_length;  // 1/l0 [1/m]
    Lanes stiffness;       // EA [N]
    Lanes growth;          // (H - 1)/(2 e_m): EA (e + growth e^2) up to e_m, of slope H beyond
    Lanes dashpot;         // (beta E/l0 + b1 rho c1) A [N s/m] (paper, Eq. 3)
};

/// [m^2] under every length's root: keeps the direction of an edge of no length from being 0/0.
constexpr double smallest_square = 1e-18;

class FabricSprings final : public ForceModel {
public:
    FabricSprings(const Mesh& mesh, double repulsion, double bulk_viscosity, double beta)
        : repulsion_(repulsion),
          modulus_(mesh.fabric.youngs_modulus),
          edges_(fabric_edges(mesh)),
          dummy_(mesh.dummy()),
          beta_(beta),
          impedance_(bulk_viscosity * std::sqrt(modulus_ * mesh.fabric.density)) {}

    std::string_view name() const override { return "fabric springs"; }
    std::size_t elements() const override { return edges_.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<Group>& groups) const {
        const Lanes zero = splat(0.0), full = splat(full_hardening_strain);
        Lanes dissipated = zero;
        const NodeForces::View on_node = state.force.view();
        for (const Group& g : groups) {
            const Lanes3 d = gather_position(state.node, g.node[1]) - gather_position(state.node, g.node[0]);
            const Lanes3 w = gather_velocity(state.node, g.node[1]) - gather_velocity(state.node, g.node[0]);
            const Lanes length = square_root(dot(d, d) + smallest_square);
            const Lanes inverse = 1.0 / length;
            const Lanes lengthening = dot(d, w) * inverse;
            const Lanes strain = length * g.inverse_length - 1.0;
            const Lanes low = strain < full ? strain : full;
            const Lanes pull = g.stiffness * (strain + g.growth * low * (low + 2.0 * (strain - low)));
            // Folded cloth repels a little, and without a dashpot: nothing of it is taut.
            const Lanes push = repulsion_ * g.stiffness * strain;
            const Lanes spring = strain > zero ? pull : push;
            const Lanes tension = strain > zero ? larger(pull + g.dashpot * lengthening, zero) : push;
            dissipated += (tension - spring) * lengthening;
            const CornerForces force(tension * inverse * d);
            for (int k = 0; k < lane_count; ++k) {
                on_node[g.node[0][k]].value += force.row[k];
                on_node[g.node[1][k]].value -= force.row[k];
            }
        }
        state.damping_power += sum(dissipated);
    }

    std::size_t bytes() const override { return edges_.capacity() * sizeof(FabricEdge); }
    void add_row_sums(const State& state, RowSums& sums) const override {
        for (const FabricEdge& e : edges_) {
            const double low = std::clamp(strain(state, e), 0.0, full_hardening_strain);
            const double unstrained = modulus_ * e.section / e.rest_length;
            // Any edge may come taut any time, unless all are folded.
            const double tangent = state.folded ? repulsion_ * unstrained
                                                : unstrained * (1.0 + 2.0 * spring_growth(e.hardening) * low);
            const double damping = state.folded ? 0.0 : dashpot(e);
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
            const double s = strain(state, e), scale = modulus_ * e.section * e.rest_length;
            if (s <= 0.0) {
                total += 0.5 * repulsion_ * scale * s * s;
                continue;
            }
            const double low = std::min(s, full_hardening_strain), high = s - low,
                         g = spring_growth(e.hardening);
            total += scale * (0.5 * s * s + g * low * (low * low / 3.0 + high * s));
        }
        return total;
    }

    Extreme extreme(const State& state) const override {
        Extreme most{-1.0};
        for (std::size_t i = 0; i < edges_.size(); ++i)
            if (const double s = strain(state, edges_[i]); s > most.strain) most = {s, i};
        return most;
    }

    std::string element_name(std::size_t i) const override { return fmt::format("fabric edge {}", i); }

private:
    std::vector<Group> make_groups() const {
        std::vector<Group> groups;
        for (std::size_t first = 0; first < edges_.size(); first += lane_count) {
            Group g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= edges_.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? dummy_ : edges_[first + k].node[end];
                g.inverse_length[k] = padding ? 1.0 : 1.0 / edges_[first + k].rest_length;
                g.stiffness[k] = padding ? 0.0 : modulus_ * edges_[first + k].section;
                g.growth[k] = padding ? 0.0 : spring_growth(edges_[first + k].hardening);
                g.dashpot[k] = padding ? 0.0 : dashpot(edges_[first + k]);
            }
            groups.push_back(g);
        }
        return groups;
    }

    /// [N s/m]
    double dashpot(const FabricEdge& e) const {
        return (beta_ * modulus_ / e.rest_length + impedance_) * e.section;
    }

    static double strain(const State& state, const FabricEdge& e) {
        return (to_vec3(state.node[e.node[1]].x) - to_vec3(state.node[e.node[0]].x)).norm() / e.rest_length -
               1.0;
    }

    double repulsion_;  // of folded cloth over the stiffness in tension [-]
    double modulus_;    // [Pa]
    std::vector<FabricEdge> edges_;
    NodeIndex dummy_;
    double beta_, impedance_;  // [s], [N s/m^3] per area of an edge
    GroupsOnDemand<Group> groups_;
};

}  // namespace

std::vector<FabricEdge> fabric_edges(const Mesh& mesh) {
    std::map<std::pair<NodeIndex, NodeIndex>, FabricEdge> found;
    const auto add = [&](NodeIndex i, NodeIndex j, double length, double area) {
        FabricEdge& e = found[std::minmax(i, j)];
        e.node = {std::min(i, j), std::max(i, j)};
        e.rest_length = length;
        e.section += mesh.fabric.thickness * area / length;
    };
    for (const Triangle& t : mesh.triangles) {
        add(t.node[0], t.node[1], t.a, t.area());
        add(t.node[0], t.node[2], std::hypot(t.b, t.c), t.area());
        add(t.node[1], t.node[2], std::hypot(t.b - t.a, t.c), t.area());
    }
    std::vector<FabricEdge> edges;
    edges.reserve(found.size());
    for (const auto& [nodes, edge] : found)
        edges.push_back(edge);

    // Gershgorin row sums of cloth and of cables, unstrained, and the row that sets the step.
    const std::size_t count = mesh.mass.size();
    std::vector<double> cloth(count, 0.0), cables(count, 0.0);
    for (const FabricEdge& e : edges)
        for (const NodeIndex i : e.node)
            cloth[i] += 2.0 * mesh.fabric.youngs_modulus * e.section / e.rest_length;
    for (const Cable& c : mesh.cables)
        for (const NodeIndex i : c.node)
            if (i < mesh.node_count())  // not a place on a body
                cables[i] += 2.0 * mesh.cord(c.kind).axial_stiffness() * c.strands / c.rest_length;
    double fastest = 0.0;
    for (std::size_t i = 0; i < count; ++i)
        fastest = std::max(fastest, (cloth[i] + cables[i]) / mesh.mass[i]);
    for (FabricEdge& e : edges) {
        e.hardening = largest_hardening;
        for (const NodeIndex i : e.node)
            e.hardening = std::min(e.hardening, (fastest * mesh.mass[i] - cables[i]) / cloth[i]);
        e.hardening = std::max(1.0, e.hardening);
    }
    return edges;
}

std::unique_ptr<const ForceModel> make_fabric_springs(const Mesh& mesh, double repulsion,
                                                      double bulk_viscosity, double beta) {
    return std::make_unique<FabricSprings>(mesh, repulsion, bulk_viscosity, beta);
}

}  // namespace twinchute::fullsim
