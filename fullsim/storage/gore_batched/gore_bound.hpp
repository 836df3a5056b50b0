// The critical time step of the gore-batched layout: row sums of all gores, and of what belongs to none.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "fullsim/forces/node_loads.hpp"
#include "fullsim/storage/gore_batched/gore_elements.hpp"
#include "fullsim/storage/gore_batched/gore_nodes.hpp"
#include "fullsim/time/critical_step.hpp"

namespace twinchute::fullsim {

/// Bound of one stage. All arguments of the constructor are kept by reference.
class GoreBound {
public:
    GoreBound(const NodeConstants& constants, const Gores& gores, const GoreKernels& kernels,
              const GoreElements& elements, const std::vector<GoreNode>& node);

    /// mass_damping: [1/s] as NodeLoads.
    void begin(const State& state, const ForceModels& structure, double mass_damping);

    // A bound: renew, add_rows of every block, steps.

    /// Weights of nodes and row sums that do not change, where that is due; the others begin at these.
    void renew(const State& state, double mass_damping);
    /// Row sums of the tangents of a block's membranes and springs.
    void add_rows(const GoreFrame& part, const MembranePass& fabric, const SpringPass& edges) const;
    /// Row sums of contact by node of the mesh, after those of blocks. mass_damping: [1/s] as NodeLoads.
    void add_contact(const GershgorinSums& of_contact, double mass_damping);
    CriticalSteps steps(std::span<const double> inverse_inertia, const NodeLoads& loads);

    /// Weights of the nodes of the mesh, renewed where that is due.
    const std::vector<double>& weights(const State& state) {
        weights_.renew(state);
        return weights_.by_node();
    }
    bool folded() const { return folded_; }  ///< the fabric, when the row sums were made

    std::size_t bytes_of_nodes() const { return rows_.bytes(); }
    std::size_t bytes_of_triangles() const { return bytes_of(triangle_rows_); }
    std::size_t bytes_of_springs() const { return bytes_of(spring_columns_); }

    void serialize(Archive& archive, const State& state, double mass_damping);

private:
    using NodeRows = std::array<double, 2>;  // stiffness [N/m], damping [N s/m]

    void set_rows(LocalNode n, const NodeRows& of_node) const;
    void add_rows(LocalNode n, const NodeRows& of_node) const;
    double weight(LocalNode n) const;
    void weigh_rows(const State& state, double mass_damping);
    void bound_cables(const State& state, double mass_damping);

    const NodeConstants& constants_;
    const Gores& gores_;
    const GoreKernels& kernels_;
    const GoreElements& elements_;
    const std::vector<GoreNode>& node_;
    GoreNodes rows_;
    PerronScaling weights_;
    bool folded_ = false;
    std::vector<WeighedRows> triangle_rows_;
    std::vector<std::array<double, 2>> spring_columns_;
    std::vector<NodeRows> slow_rows_, line_rows_;  // of each local node: tapes and cords, lines
    std::vector<double> node_damping_;             // [N s/m] of loads
    std::map<NodeIndex, NodeRows> global_rows_;    // of nodes that belong to no gore
    double line_step_ = 0.0;                       // [s] bound of line, link and riser nodes
    double static_line_step_ = 0.0;                // [s] of its nodes
    CriticalSteps contact_;                        // of nodes that touch fabric and are not of the canopy
};

}  // namespace twinchute::fullsim
