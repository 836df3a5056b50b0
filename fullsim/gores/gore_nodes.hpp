// Where the nodes of gores in lanes lie, and their traffic with the records of a state.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "fullsim/gores/kernels.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/state.hpp"
#include "lib/record/keeper.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Arrays of a frame and the traffic between them and the state's node records.
class GoreNodes {
public:
    /// By what the air does to cloth, since pressure and cloth drag share an array unless both act; or row
    /// sums.
    enum class What { pushed, dragged, pushed_and_dragged, row_sums };
    /// All arrays of all nodes; of row sums x alone, its first two components, of the canopy and its images.
    /// `gores` has to live as long.
    GoreNodes(const Gores& gores, int lanes, What what);

    GoreFrame frame;
    std::size_t bytes() const {
        return bytes_of(memory_) + bytes_of(edge_) + bytes_of(first_) + bytes_of(image_);
    }

    /// A component of a node of a gore.
    double& at(double* array, LocalNode node, int gore, int component) const {
        return array[first_[gore] + static_cast<std::size_t>(node) * frame.stride() +
                     static_cast<std::size_t>(component) * frame.lanes];
    }

    /// The same of an own node's velocity half a step before.
    double& half_at(LocalNode node, int gore, int component) const {
        const int block = gore / frame.lanes, lane = gore % frame.lanes;
        return frame
            .v_half[frame.half_at(block, node) + static_cast<std::size_t>(component * frame.lanes + lane)];
    }

    /// From and to a state: positions and velocities, those half a step before, too.
    void load(const State& state) const;
    void store(State& state) const;

    // The next gore's seam as gores see it. Within a block the kernels see to it. Between the last gore of
    // one and the first of the next it goes through a few lines of memory that one block writes and another
    // reads: a thread that fetched it from the other's arrays, number by number, would wait longer than it
    // works.
    /// What the block's last gore has added to its images, from these arrays, at most three.
    void hand_images(int block, std::span<double* const> arrays) const;
    /// What was handed over goes to the first gore's own nodes.
    void take_images(int block, std::span<double* const> arrays) const;
    /// Where the first gore's own nodes are now,
    void show_first_gore(int block) const;
    /// for the last gore of the block before.
    void see_next_gore(int block) const;
    /// The frame when all have.
    const GoreFrame& seen() const;
    /// The image of each canopy node, or -1.
    const std::vector<std::int32_t>& image() const { return image_; }

    /// Positions and velocities of nodes that gores share, which belong to the state.
    void receive_guests(const State& state) const;
    /// What gores did to nodes that they share goes to the state's forces.
    void send_guests(double* array, NodeForces& forces) const;

    /// Every number, lanes without a gore among them.
    void keep(Keeper& k) {
        k.numbers("nodes of gores", numbers(memory_));
        k.numbers("seams between blocks of gores", numbers(edge_));
    }

private:
    int last_gore(int block) const { return std::min((block + 1) * frame.lanes, gores_.count) - 1; }
    int before(int block) const { return (block > 0 ? block : frame.blocks) - 1; }
    int after(int block) const { return (block + 1) % frame.blocks; }
    double* handed(int block) const { return edge_.front().data() + block * edge_length_; }
    double* shown(int block) const { return handed(block) + 9 * gores_.neighbour.size(); }
    void show_within(int block) const;
    LocalNode first_guest() const { return static_cast<LocalNode>(gores_.own + gores_.neighbour.size()); }

    struct alignas(128) Line : std::array<double, 16> {};  // two of a cache, which come together

    static std::span<double> numbers(std::vector<Line>& lines) {
        return {lines.front().data(), Line{}.size() * lines.size()};
    }

    const Gores& gores_;
    std::vector<Line> memory_;
    mutable std::vector<Line> edge_;  // of each block: what is handed over, what is shown
    std::size_t edge_length_ = 0;
    std::vector<std::size_t> first_;  // where the first node of a gore is, by gore, and of lanes without one
    std::vector<std::int32_t> image_;
};

}  // namespace twinchute::fullsim
