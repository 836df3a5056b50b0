// Between nodes and lanes of elements: four elements read their corners' records, and add forces
// to them. Elements are added one after the other in mesh order, so the sum never changes.
#pragma once

#include <array>

#include "fullsim/state.hpp"

namespace twinchute::fullsim {

/// One corner of four elements.
using LaneNodes = std::array<NodeIndex, lane_count>;

inline Lanes3 columns(Lanes a, Lanes b, Lanes c, Lanes d) {
    transpose(a, b, c, d);
    return {a, b, c};
}

inline Lanes3 gather_position(const std::vector<NodeRecord>& node, const LaneNodes& i) {
    return columns(node[i[0]].x, node[i[1]].x, node[i[2]].x, node[i[3]].x);
}

inline Lanes3 gather_velocity(const std::vector<NodeRecord>& node, const LaneNodes& i) {
    return columns(node[i[0]].v, node[i[1]].v, node[i[2]].v, node[i[3]].v);
}

/// Rows of a force on one corner of four elements, ready to be added to nodes.
struct CornerForces {
    Lanes row[lane_count];
    explicit CornerForces(Lanes3 f) : row{f.x, f.y, f.z, splat(0.0)} {
        transpose(row[0], row[1], row[2], row[3]);
    }
};

}  // namespace twinchute::fullsim
