// Triangles of fabric by twos: two that share an edge read four corners and write to four, not six.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim::unstructured {

/// Two triangles of corners 0, 1, 2 and 0, 2, 3. Where a triangle has no partner, corner 3 is corner 0.
struct Quad {
    std::array<NodeIndex, 4> node;
    Triangle first;
    std::optional<Triangle> second;
};

/// Every triangle in one quad, in the order of their lowest nodes. Corners keep their turn, but another may
/// come first.
std::vector<Quad> quads_of(const std::vector<Triangle>& triangles);
/// Triangles of one sheet by twos.
std::vector<Quad> quads_of(const Mesh& mesh, int sheet);

/// Parts of a canopy that threads take at once, by the numbers of nodes: as many triangles in each. Those of
/// a part touch no node of another. Strips lie across the end of one part; they touch no node of each other.
/// All depends on the mesh alone. Small canopies, and those whose nodes are numbered without regard to their
/// places, are one part.
class Parts {
public:
    explicit Parts(const Mesh& mesh);

    std::size_t count() const { return ends_.size(); }
    /// First node of the next part.
    NodeIndex end(std::size_t part) const { return ends_[part]; }
    /// Parts, then strips: those across the end of a part come as many lists later.
    std::size_t lists() const { return 2 * count() - 1; }
    /// List that a quad of this mesh belongs to.
    std::size_t list_of(const Quad& quad) const;

private:
    std::vector<NodeIndex> ends_;
};

}  // namespace twinchute::fullsim::unstructured
