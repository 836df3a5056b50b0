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

}  // namespace twinchute::fullsim::unstructured
