#include "fullsim/storage/gore_batched/gore_bound.hpp"

#include <algorithm>
#include <limits>

#include "fullsim/forces/gore_contact.hpp"

namespace twinchute::fullsim {

GoreBound::GoreBound(const NodeConstants& constants, const Gores& gores, const GoreKernels& kernels,
                     const GoreElements& elements, const std::vector<GoreNode>& node)
    : constants_(constants),
      gores_(gores),
      kernels_(kernels),
      elements_(elements),
      node_(node),
      rows_(gores, kernels.lanes, GoreNodes::What::row_sums) {}

void GoreBound::begin(const State& state, const ForceModels& structure, double mass_damping) {
    weights_.begin(state, constants_, structure, find_block(structure, Block::lines));
    weigh_rows(state, mass_damping);
}

void GoreBound::renew(const State& state, double mass_damping) {
    contact_ = {infinity, infinity, infinity};
    if (weights_.renew(state) || state.folded != folded_) weigh_rows(state, mass_damping);
    const GoreFrame& sums = rows_.frame;
    for (LocalNode n = 0; n < sums.nodes; ++n)
        set_rows(n, slow_rows_[n < sums.own ? n : n - sums.own + gores_.own]);
}

void GoreBound::add_rows(const GoreFrame& part, const MembranePass& fabric, const SpringPass& edges) const {
    if (elements_.membranes_act)
        kernels_.membrane_rows(part, elements_.membrane, triangle_rows_, fabric.weight, rows_.frame);
    if (elements_.springs_act)
        kernels_.spring_rows(part, elements_.springs, edges, spring_columns_, rows_.frame);
}

void GoreBound::add_contact(const GershgorinSums& of_contact, double mass_damping) {
    // Contact acts once a step, whatever lines do within it.
    const auto bound = [&](NodeIndex i, const NodeRows& of_lines) {
        const double k = of_contact.stiffness[i], mass = constants_.mass[i],
                     c = of_contact.damping[i] + mass_damping * mass;
        if (!(k > 0.0)) return;
        contact_.canopy = std::min(contact_.canopy, critical_step_of(k, c, mass));
        contact_.lines = std::min(contact_.lines, critical_step_of(of_lines[0], of_lines[1] + c, mass));
        contact_.all = std::min(contact_.all, critical_step_of(k + of_lines[0], of_lines[1] + c, mass));
    };
    for (LocalNode n = 0; n < gores_.own; ++n)
        for (int gore = 0; gore < gores_.count; ++gore) {
            const NodeIndex i = gores_.node[gore * gores_.own + n];
            if (n >= gores_.canopy) {
                bound(i, line_rows_[n]);
                continue;
            }
            rows_.at(rows_.frame.x, n, gore, 0) += of_contact.stiffness[i];
            rows_.at(rows_.frame.x, n, gore, 1) += of_contact.damping[i];
        }
    for (const auto& [i, of_lines] : global_rows_)
        bound(i, of_lines);
}

CriticalSteps GoreBound::steps(std::span<const double> inverse_inertia, const NodeLoads& loads) {
    const GoreFrame& sums = rows_.frame;
    kernels_.scatter_add_halo(sums, gores_.neighbour);
    for (LocalNode n = 0; n < gores_.canopy; ++n)
        node_damping_[n] = loads.damping_by_share() * node_[n].share + loads.mass_damping * node_[n].mass;
    const auto bound = [&](LocalNode first, LocalNode last) {
        return kernels_.critical_step(sums, inverse_inertia, node_damping_, first, last);
    };
    const double inner = std::min(bound(0, gores_.inner), static_line_step_);
    CriticalSteps steps;
    steps.canopy = std::min(inner, bound(gores_.inner, gores_.canopy));
    steps.lines = line_step_;
    for (LocalNode n = gores_.inner; n < gores_.canopy; ++n) {
        steps.lines = std::min(
            steps.lines, critical_step_of(line_rows_[n][0], line_rows_[n][1], 1.0 / inverse_inertia[n]));
        add_rows(n, line_rows_[n]);
    }
    steps.all = std::min({inner, bound(gores_.inner, gores_.canopy), line_step_});
    return {std::min(steps.all, contact_.all), std::min(steps.canopy, contact_.canopy),
            std::min(steps.lines, contact_.lines)};
}

void GoreBound::serialize(Archive& archive, const State& state, double mass_damping) {
    weights_.serialize(archive);
    if (archive.reads()) weigh_rows(state, mass_damping);
}

void GoreBound::set_rows(LocalNode n, const NodeRows& of_node) const {
    for (int block = 0; block < rows_.frame.blocks; ++block)
        for (int what = 0; what < 2; ++what)
            std::fill_n(rows_.frame.x + rows_.frame.at(block, n) +
                            static_cast<std::ptrdiff_t>(what) * rows_.frame.lanes,
                        rows_.frame.lanes, of_node[what]);
}

void GoreBound::add_rows(LocalNode n, const NodeRows& of_node) const {
    for (int gore = 0; gore < gores_.count; ++gore)
        for (int what = 0; what < 2; ++what)
            rows_.at(rows_.frame.x, n, gore, what) += of_node[what];
}

double GoreBound::weight(LocalNode n) const {
    const LocalNode first_shared = gores_.local_nodes() - static_cast<LocalNode>(gores_.shared.size());
    if (n >= first_shared) return weights_.by_node()[gores_.shared[n - first_shared].front()];
    return weights_.by_node()[gores_.node[n < gores_.own ? n : gores_.neighbour[n - gores_.own]]];
}

void GoreBound::weigh_rows(const State& state, double mass_damping) {
    folded_ = state.folded;
    triangle_rows_.clear();
    spring_columns_ = {};
    if (elements_.membranes_act) {
        triangle_rows_.reserve(gores_.triangles.size());
        for (const GoreTriangle& t : gores_.triangles) {
            const TriangleRows flat = unstrained_rows(elements_.law, {{}, 0, t.a, t.b, t.c});
            const std::array<double, 3> weights{weight(t.node[0]), weight(t.node[1]), weight(t.node[2])};
            WeighedRows weighed{};
            for (int i = 0; i < 3; ++i) {
                weighed.stiffness[i] = flat.stiffness(i, weights);
                weighed.damping[i] = flat.damping * weighed.stiffness[i];
            }
            triangle_rows_.push_back(weighed);
        }
    }
    if (elements_.springs_act)
        for (const GoreEdge& e : gores_.edges) {
            const double ratio = weight(e.node[1]) / weight(e.node[0]);
            spring_columns_.push_back({1.0 + ratio, 1.0 + 1.0 / ratio});
        }
    bound_cables(state, mass_damping);
}

/// Row sums that do not change: of cables, slack ones too, since they may pull tight any time. With them the
/// bounds of nodes that hold nothing else.
void GoreBound::bound_cables(const State& state, double mass_damping) {
    slow_rows_.assign(gores_.local_nodes(), {0.0, 0.0});
    line_rows_ = slow_rows_;
    node_damping_.assign(gores_.own, 0.0);
    const auto collect = [](const std::vector<CableElement>& cables, std::vector<NodeRows>& of_nodes,
                            auto&& weight_of) {
        for (const CableElement& c : cables)
            for (int end = 0; end < 2; ++end) {
                const LocalNode n = c.node[end];
                const double columns = 1.0 + weight_of(c.node[1 - end]) / weight_of(n);
                of_nodes[n][0] += columns * c.stiffness * c.inverse_length;
                of_nodes[n][1] += columns * c.dashpot;
            }
    };
    const auto weighed = [this](LocalNode n) { return weight(n); };
    const auto alike = [](LocalNode) { return 1.0; };
    if (!folded_) collect(elements_.tapes, slow_rows_, weighed);
    collect(elements_.cords, slow_rows_, weighed);
    for (const ContactElement& pair : elements_.contacts)
        for (int end = 0; end < 2; ++end)
            slow_rows_[pair.node[end]][0] +=
                (1.0 + weight(pair.node[1 - end]) / weight(pair.node[end])) * contact_tangent(pair.stiffness);
    collect(elements_.lines, line_rows_, alike);

    GershgorinSums global = no_rows(state, weights_.by_node());
    for (const auto& cables : elements_.global)
        cables->add_row_sums(state, global);
    for (std::size_t k = 0; k < gores_.shared.size(); ++k) {
        const std::size_t n = gores_.own + gores_.neighbour.size() + k;
        for (const NodeIndex i : gores_.shared[k]) {
            global.stiffness[i] += slow_rows_[n][0] + line_rows_[n][0];
            global.damping[i] += slow_rows_[n][1] + line_rows_[n][1];
        }
    }
    global_rows_.clear();
    for (const NodeIndex i : gores_.global)
        global_rows_[i] = {global.stiffness[i], global.damping[i]};
    line_step_ = static_line_step_ = std::numeric_limits<double>::infinity();
    for (LocalNode n = gores_.canopy; n < gores_.own; ++n)
        line_step_ = std::min(
            line_step_, critical_step_of(line_rows_[n][0], line_rows_[n][1] + mass_damping * node_[n].mass,
                                         node_[n].mass));
    for (const NodeIndex i : gores_.global)
        line_step_ =
            std::min(line_step_, critical_step_of(global.stiffness[i],
                                                  global.damping[i] + mass_damping * constants_.mass[i],
                                                  constants_.mass[i]));
    const auto& line = constants_.static_line_mass;
    const std::size_t first = constants_.first_static_line();
    for (std::size_t k = 0; k + 1 < line.size(); ++k)  // its anchor is not accelerated
        static_line_step_ = std::min(static_line_step_, critical_step_of(global.stiffness[first + k],
                                                                         global.damping[first + k], line[k]));
}

}  // namespace twinchute::fullsim
