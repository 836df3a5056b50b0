// Lines, risers, tapes and the static line: 2-node cables that pull and never push.
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include "fullsim/elements/cable.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

struct alignas(32) CableGroup {
    std::array<LaneNodes, 2> node;
    Lanes inverse_length;  // 1/l0 [1/m]
    Lanes stiffness;       // EA [N]
    Lanes dashpot;         // (beta E/l0 + b1 rho c1) A [N s/m] (paper, Eq. 3)
    Lanes line;            // 1 for a suspension line, else 0
};

class CableElements : public SpanLanes<CableGroup> {
public:
    HWY_INLINE CableElements(const std::vector<NodeRecord>& node, NodeForces::View on_node,
                             const CableGroup& group)
        : SpanLanes(node, on_node, group) {}

    /// Tensions of suspension lines alone.
    HWY_INLINE Lanes counted(Lanes load) const { return g_.line * load; }
};

/// Which kinds of cable.
using Which = bool (*)(CableKind);

bool any_kind(CableKind) {
    return true;
}
bool no_tape(CableKind kind) {
    return !is_tape(kind);
}

/// T = max(0, EA (l - l0)/l0 + (beta E/l0 + b1 rho c1) A dl/dt): engineering strain, no compression.
class CableBlock final : public ForceModel {
public:
    CableBlock(const Mesh& mesh, const std::vector<Cable>& cables, Block block, Which which,
               double bulk_viscosity, double beta)
        : mesh_(mesh),
          block_(block),
          on_fabric_(which == &is_tape),
          bulk_viscosity_(bulk_viscosity),
          beta_(beta) {
        const auto begin = std::ranges::find_if(cables, which, &Cable::kind);
        const auto end = std::ranges::find_if_not(begin, cables.end(), which, &Cable::kind);
        if (std::ranges::find_if(end, cables.end(), which, &Cable::kind) != cables.end())
            throw std::logic_error("tapes of a mesh come before its lines and risers");
        cables_ = {begin, end};
        first_ = static_cast<std::size_t>(begin - cables.begin());
    }

    Block block() const override { return block_; }
    std::size_t elements() const override { return cables_.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<CableGroup>& groups) const {
        const ElementSums sums =
            law::cable_forces(LanesView<CableElements>(state.node, state.force.view(), groups));
        state.damping_power += sums.dissipated;
        state.largest.add_tension(sums.largest_load);
    }

    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        if (on_fabric_ && state.folded) return;
        for (const Cable& c : cables_)
            for (int end = 0; end < 2; ++end) {
                // Both blocks of a row have the norm EA/l0; a slack cable may pull tight any time.
                const NodeIndex i = c.node[end];
                const double columns = 1.0 + sums.over(c.node[1 - end], i);
                sums.stiffness[i] += columns * stiffness(c) / c.rest_length;
                sums.damping[i] += columns * dashpot(c);
            }
    }

    double energy(const State& state) const override {
        double total = 0.0;
        for (const Cable& c : cables_)
            total += stiffness(c) * c.rest_length * law::cable_energy(cable_strain(state, c));
        return total;
    }

    StrainExtremum extreme(const State& state) const override {
        StrainExtremum most{-1.0};
        for (std::size_t i = 0; i < cables_.size(); ++i) {
            const double e = cable_strain(state, cables_[i]);
            if (e > most.strain) most = {e, i};
        }
        return most;
    }

    std::string element_name(std::size_t i) const override {
        return fmt::format("{} cable {}", cable_kind_name(cables_[i].kind), first_ + i);
    }

private:
    std::vector<CableGroup> make_groups() const {
        std::vector<CableGroup> groups;
        for (std::size_t first = 0; first < cables_.size(); first += lane_count) {
            CableGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                const bool padding = first + k >= cables_.size();
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = padding ? mesh_.dummy() : cables_[first + k].node[end];
                g.inverse_length[k] = padding ? 1.0 : 1.0 / cables_[first + k].rest_length;
                g.stiffness[k] = padding ? 0.0 : stiffness(cables_[first + k]);
                g.dashpot[k] = padding ? 0.0 : dashpot(cables_[first + k]);
                g.line[k] = !padding && cables_[first + k].kind == CableKind::line ? 1.0 : 0.0;
            }
            groups.push_back(g);
        }
        return groups;
    }

    double stiffness(const Cable& c) const { return mesh_.cord(c.kind).axial_stiffness() * c.strands; }
    double dashpot(const Cable& c) const { return cable_constants(mesh_, c, bulk_viscosity_, beta_).dashpot; }

    const Mesh& mesh_;
    std::span<const Cable> cables_;
    std::size_t first_ = 0;  // of them in the mesh
    Block block_;
    bool on_fabric_;  // folded with it
    double bulk_viscosity_, beta_;
    GroupsOnDemand<CableGroup> groups_;
};

}  // namespace

CableConstants cable_constants(const Mesh& mesh, const Cable& c, double bulk_viscosity, double beta) {
    const Cord& cord = mesh.cord(c.kind);
    const double stiffness = cord.axial_stiffness() * c.strands;
    const double impedance = std::sqrt(cord.youngs_modulus * cord.density) * cord.section() * c.strands;
    return {stiffness, bulk_viscosity * impedance + beta * stiffness / c.rest_length};
}

double cable_strain(const State& state, const Cable& c) {
    const Vec3 d = to_vec3(state.node[c.node[1]].x) - to_vec3(state.node[c.node[0]].x);
    return law::span_strain(1.0 / c.rest_length, d);
}

double strand_tension(const State& state, const Mesh& mesh, const Cable& c) {
    return std::max(0.0, mesh.cord(c.kind).axial_stiffness() * cable_strain(state, c));
}

std::unique_ptr<const ForceModel> make_cables(const Mesh& mesh, const std::vector<Cable>& cables, Block block,
                                              double bulk_viscosity, double beta) {
    return std::make_unique<CableBlock>(mesh, cables, block, any_kind, bulk_viscosity, beta);
}

std::unique_ptr<const ForceModel> make_cable(const Mesh& mesh, double bulk_viscosity, double beta) {
    return std::make_unique<CableBlock>(mesh, mesh.cables, Block::lines, any_kind, bulk_viscosity, beta);
}

std::unique_ptr<const ForceModel> make_tapes(const Mesh& mesh, double bulk_viscosity, double beta) {
    return std::make_unique<CableBlock>(mesh, mesh.cables, Block::tapes, is_tape, bulk_viscosity, beta);
}

std::unique_ptr<const ForceModel> make_lines(const Mesh& mesh, double bulk_viscosity, double beta) {
    return std::make_unique<CableBlock>(mesh, mesh.cables, Block::lines, no_tape, bulk_viscosity, beta);
}

std::unique_ptr<const ForceModel> make_static_line(const Mesh& mesh, double bulk_viscosity, double beta) {
    return std::make_unique<CableBlock>(mesh, mesh.static_line.cables, Block::static_line, any_kind,
                                        bulk_viscosity, beta);
}

}  // namespace twinchute::fullsim
