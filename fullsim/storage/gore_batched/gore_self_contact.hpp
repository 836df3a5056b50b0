// Self-contact in the gore-batched layout. Any node may meet any triangle: that is left to the block itself,
// on the records of the state, which gets the places of nodes from the gores and gives forces back to them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "fullsim/forces/self_contact.hpp"
#include "fullsim/storage/gore_batched/gore_nodes.hpp"

namespace twinchute::fullsim {

/// Contact of one stage. All arguments of the constructor are kept by reference.
class GoreSelfContact {
public:
    GoreSelfContact(const SelfContact& model, const Gores& gores, const GoreNodes& nodes,
                    const GoreKernels& kernels, NodeIndex payload);

    /// Adds the forces at state.time to those of gores.
    void push(State& state);
    /// Forces on lines in the last push, which are among those of the air.
    std::span<const GoreNodes::OnLine> on_lines() const { return on_lines_; }

    void add_row_sums(const State& state, GershgorinSums& sums) const;
    double energy(const State& state) const;  ///< [J]
    std::size_t bytes() const { return bytes_of(all_) + bytes_of(awake_) + bytes_of(looked_at_); }

private:
    double strayed_squared(const State& state) const;
    void note_look(const SelfContactState& contact);
    const State& with_places(const State& state) const;

    const SelfContact& model_;
    const Gores& gores_;
    const GoreNodes& nodes_;
    const GoreKernels& kernels_;
    NodeIndex payload_;
    std::vector<GoreNodes::OwnNode> all_, awake_;  // awake: may touch before the next look
    std::vector<double> looked_at_;                // SelfContactState's, as GoreKernels::farthest takes it
    std::vector<GoreNodes::OnLine> on_lines_;
    std::int64_t stored_at_ = -1;            // step whose places the records of the state have
    mutable std::unique_ptr<State> stored_;  // with the places of now, where they have not
};

}  // namespace twinchute::fullsim
