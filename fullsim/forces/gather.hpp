// Between nodes and lanes of elements: four elements read their corners' records, and add forces
// to them. Elements are added one after the other in mesh order, so the sum never changes.
#pragma once

#include <array>
#include <vector>

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

/// Elements or groups of them as a block walks through them: made when it first does, since a block whose
/// work another layout does still answers for its energy and its strains.
template <class Group>
class GroupsOnDemand {
public:
    template <class Make>
    const std::vector<Group>& get(Make&& make) const {
        if (!made_) groups_ = make();
        made_ = true;
        return groups_;
    }

private:
    mutable std::vector<Group> groups_;
    mutable bool made_ = false;
};

/// Corners of four triangles.
struct CornerGroup {
    std::array<LaneNodes, 3> node;
};

/// Corner groups of a mesh in its order, padded with the dummy.
inline std::vector<CornerGroup> corner_groups(const Mesh& mesh) {
    std::vector<CornerGroup> groups;
    for (std::size_t first = 0; first < mesh.triangles.size(); first += lane_count) {
        CornerGroup g{};
        for (int k = 0; k < lane_count; ++k)
            for (int corner = 0; corner < 3; ++corner)
                g.node[corner][k] =
                    first + k < mesh.triangles.size() ? mesh.triangles[first + k].node[corner] : mesh.dummy();
        groups.push_back(g);
    }
    return groups;
}

/// Rows of a force on one corner of four elements, ready to be added to nodes.
struct CornerForces {
    Lanes row[lane_count];
    explicit CornerForces(Lanes3 f) : row{f.x, f.y, f.z, splat(0.0)} {
        transpose(row[0], row[1], row[2], row[3]);
    }
};

}  // namespace twinchute::fullsim
