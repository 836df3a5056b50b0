// Storage of the nodes of the gore-batched layout, and their traffic with the records of a state.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "fullsim/mesh/gores.hpp"
#include "fullsim/state.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "lib/record/archive.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Arrays of a frame and the traffic between them and the state's node records.
class GoreNodes {
public:
    /// By what the air does to fabric, since pressure and fabric drag share an array unless both act; or row
    /// sums.
    enum class What { pushed, dragged, pushed_and_dragged, row_sums };
    /// All arrays of all nodes; of row sums x alone, its first two components, of the canopy and its halo
    /// nodes. `gores` has to live as long.
    GoreNodes(const Gores& gores, int lanes, What what);

    GoreFrame frame;
    std::size_t bytes() const {
        return bytes_of(memory_) + bytes_of(edge_) + bytes_of(first_) + bytes_of(halo_);
    }

    /// A component of a node of a gore.
    double& at(double* array, LocalNode node, int gore, int component) const {
        return array[first_[gore] + static_cast<std::size_t>(node) * frame.stride() +
                     static_cast<std::size_t>(component) * frame.lanes];
    }

    /// A component of an own node's velocity half a step before.
    double& half_at(LocalNode node, int gore, int component) const {
        const int block = gore / frame.lanes, lane = gore % frame.lanes;
        return frame
            .v_half[frame.half_at(block, node) + static_cast<std::size_t>(component * frame.lanes + lane)];
    }

    /// The frame when all blocks have seen the next gore and received their shared nodes.
    const GoreFrame& up_to_date(const State& state) const;

    /// From and to a state: positions and velocities, those half a step before, too.
    void load(const State& state) const;
    void store(State& state) const;
    /// An own node, and its number in the mesh.
    struct OwnNode {
        NodeIndex node;
        LocalNode local;
        int gore;
        std::size_t at;  ///< offset of its first component in an array
    };
    /// Own nodes of all gores, those alone that are marked by their number in the mesh where `marks` are
    /// given.
    std::vector<OwnNode> own_nodes(const std::vector<bool>* marks = nullptr) const;
    /// Positions and velocities of some, to a state.
    void store_places(State& state, std::span<const OwnNode> nodes) const;
    /// A force on an own node of a line [N].
    struct OnLine {
        LocalNode node;
        int gore;
        Lanes force;
    };
    /// Adds the forces of the state on some, which are cleared there: on the canopy to the forces of gores;
    /// on lines, whose forces are those of their cables alone, to those of the air, and says which.
    void scatter_add_contact(State& state, std::span<const OwnNode> nodes,
                             std::vector<OnLine>& on_lines) const;
    /// Adds the forces of the state on own nodes, which are cleared there. Not where `What` is pushed alone.
    void scatter_add_forces(State& state) const;
    /// Some of the canopy's nodes, by their numbers in the mesh: positions and velocities, and forces [N]
    /// that are added.
    void read(std::span<const NodeIndex> nodes, std::span<NodeRecord> to) const;
    void push(std::span<const NodeIndex> nodes, std::span<const Lanes> force) const;

    // The next gore's seam as gores see it. Within a block the kernels see to it. Between the last gore of
    // one and the first of the next it goes through a few lines of memory that one block writes and another
    // reads: a thread that fetched it from the other's arrays, number by number, would wait longer than it
    // works.
    /// Writes the forces that the block's last gore has added to its halo nodes into the exchange buffer,
    /// from these arrays, at most three.
    void send_halo_forces(int block, std::span<double* const> arrays) const;
    /// Scatter-adds the buffered halo forces to the first gore's own nodes.
    void receive_halo_forces(int block, std::span<double* const> arrays) const;
    /// Writes the current positions and velocities of the first gore's own nodes into the exchange buffer.
    void send_first_gore(int block) const;
    /// Gathers them into the halo of the last gore of the block before.
    void gather_halo(int block) const;
    /// The halo node of each canopy node, or -1.
    const std::vector<std::int32_t>& halo() const { return halo_; }

    // Nodes that gores share belong to the state. Who works on a block fetches and sums up there.
    /// Their positions and velocities, for the block.
    void gather_shared(const State& state, int block) const;
    /// Writes the forces of the block's gores on the shared nodes, in each of these arrays, at most two, into
    /// the exchange buffer and clears the arrays.
    void reduce_shared(int block, std::span<double* const> arrays) const;
    /// Adds the buffered forces of the first array, or of the second, to the state's forces.
    void scatter_add_shared(int which, NodeForces& forces) const;

    /// Every number, lanes without a gore among them.
    void serialize(Archive& archive) {
        archive.numbers("nodes of gores", numbers(memory_));
        archive.numbers("seams between blocks of gores", numbers(edge_));
    }

private:
    int last_gore(int block) const { return std::min((block + 1) * frame.lanes, gores_.count) - 1; }
    int before(int block) const { return (block > 0 ? block : frame.blocks) - 1; }
    int after(int block) const { return (block + 1) % frame.blocks; }
    double* handed(int block) const { return edge_.front().data() + block * edge_length_; }
    double* shown(int block) const { return handed(block) + 9 * gores_.neighbour.size(); }
    /// Exchange buffer of the `which`-th array.
    double* of_shared(int block, int which) const {
        return shown(block) + 6 * gores_.neighbour.size() + 3 * which * shared_[block].size();
    }
    void gather_halo_within(int block) const;
    LocalNode first_shared() const { return static_cast<LocalNode>(gores_.own + gores_.neighbour.size()); }

    struct alignas(128) Line : std::array<double, 16> {};  // two of a cache, which come together

    static std::span<double> numbers(std::vector<Line>& lines) {
        return {lines.front().data(), Line{}.size() * lines.size()};
    }

    /// Gores of a block that follow each other and share a node.
    struct Sharing {
        NodeIndex node;
        LocalNode local;
        int first, last;  // behind the last
    };

    const Gores& gores_;
    std::vector<std::vector<Sharing>> shared_;  // by block
    std::vector<Line> memory_;
    mutable std::vector<Line> edge_;  // of each block: what it hands over, shows, and does to shared nodes
    std::size_t edge_length_ = 0;
    std::vector<std::size_t> first_;  // where the first node of a gore is, by gore, and of lanes without one
    std::vector<std::int32_t> halo_;
    /// Where each node of the canopy is in an array; made when it is first asked for, by clusters alone.
    mutable std::vector<std::size_t> place_;
    const std::vector<std::size_t>& places() const;
};

}  // namespace twinchute::fullsim
