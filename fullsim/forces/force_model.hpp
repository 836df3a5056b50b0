// Interface of a force block: one virtual call per block and step, plain loops inside. A block holds
// constants only; all that varies is in State.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "fullsim/forces/blocks.hpp"
#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// Row sums for the critical time step: sum over elements of the norms of their stiffness and damping
/// blocks in the row of each node, the block of column j times w_j/w_i (Gershgorin).
struct GershgorinSums {
    std::vector<double> stiffness;    ///< K_i [N/m]
    std::vector<double> damping;      ///< C_i [N s/m]
    std::vector<double> weight = {};  ///< w > 0 by node; empty where all are alike

    /// w_j/w_i
    double over(NodeIndex j, NodeIndex i) const { return weight.empty() ? 1.0 : weight[j] / weight[i]; }
};

/// The most strained element of a block.
struct StrainExtremum {
    double strain = 0.0;      ///< [-] largest tensile strain; of springs and cables as low as -1, folded
    std::size_t element = 0;  ///< its number within the block
};

class NodeLoad;

class ForceModel {
public:
    virtual ~ForceModel() = default;

    virtual Block block() const = 0;
    /// Prepares the state for its bound on the step, before forces are evaluated for the first time.
    virtual void prepare(State&) const {}
    std::string_view name() const { return block_name(block()); }
    /// Adds its forces at state.time to state.force or state.aero, and what it dissipates [W] to
    /// state.damping_power; state.largest grows with the loads of suspension lines and fabric.
    virtual void add_forces(State& state) const = 0;
    /// Adds its share to the row sums of the current tangent.
    virtual void add_row_sums(const State&, GershgorinSums&) const {}
    /// Stored energy [J].
    virtual double energy(const State&) const { return 0.0; }
    virtual StrainExtremum extreme(const State&) const { return {}; }
    /// An element in words, e.g. "fabric triangle 17".
    virtual std::string element_name(std::size_t) const { return std::string(name()); }
    /// Itself where it is one, whose work a layout's node update does.
    virtual const NodeLoad* node_load() const { return nullptr; }
    /// It acts on no node before this one.
    virtual NodeIndex first_node() const { return 0; }
    /// Element evaluations in one add_forces.
    virtual std::size_t elements() const { return 0; }
    /// Memory of the constants that it keeps for itself [bytes].
    virtual std::size_t bytes() const { return 0; }
};

using ForceModels = std::vector<std::unique_ptr<const ForceModel>>;

/// The model of a block, or null.
inline const ForceModel* find_block(const ForceModels& models, Block block) {
    const auto found = std::ranges::find(models, block, &ForceModel::block);
    return found == models.end() ? nullptr : found->get();
}

}  // namespace twinchute::fullsim
