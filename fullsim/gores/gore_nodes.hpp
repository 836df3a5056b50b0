// Where the nodes of gores in lanes lie, and their traffic with the records of a state.
#pragma once

#include <array>
#include <vector>

#include "fullsim/gores/kernels.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/state.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Arrays of a frame and the traffic between them and the state's node records.
class GoreNodes {
public:
    /// The first so many of the frame's arrays, x first; the others stay null. `gores` has to live as long.
    GoreNodes(const Gores& gores, int lanes, int arrays);

    GoreFrame frame;
    std::size_t bytes() const { return bytes_of(memory_); }

    /// A component of a node of a gore.
    double& at(double* array, LocalNode node, int gore, int component) const {
        return array[frame.at(gore / frame.lanes, node) + static_cast<std::size_t>(component) * frame.lanes +
                     gore % frame.lanes];
    }

    /// From and to a state: positions and velocities, those half a step before, too.
    void load(const State& state) const;
    void store(State& state) const;

    /// Positions and velocities of nodes that gores share, which belong to the state.
    void receive_guests(const State& state) const;
    /// What gores did to nodes that they share goes to the state's forces.
    void send_guests(double* array, std::vector<NodeVector>& forces) const;

private:
    LocalNode first_guest() const { return static_cast<LocalNode>(gores_.own + gores_.neighbour.size()); }

    struct alignas(64) Line : std::array<double, 8> {};  // of a cache

    const Gores& gores_;
    std::vector<Line> memory_;
};

}  // namespace twinchute::fullsim
