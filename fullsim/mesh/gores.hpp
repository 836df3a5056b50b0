// A parachute as one gore sees it: the same elements over and over, which a kernel can work on side by side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fullsim/forces/spring.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// A node as a gore numbers it. Its own come first, those of its canopy before those of its line; then the
/// neighbour's, on the seam to the next gore; then shared nodes, which all gores or some of them share.
using LocalNode = std::int32_t;

struct GoreTriangle {
    std::array<LocalNode, 3> node;
    double a, b, c;  ///< [m] as Triangle
};

struct GoreCable {
    std::array<LocalNode, 2> node;
    double rest_length;  ///< [m]
    double strands;
    CableKind kind;
};

struct GoreEdge {
    std::array<LocalNode, 2> node;
    double rest_length, section, hardening;  ///< as FabricEdge
};

/// One gore for all, and how its nodes are called in the mesh.
struct Gores {
    int count = 0;   ///< of gores
    int own = 0;     ///< nodes of a gore
    int canopy = 0;  ///< of those, on the canopy,
    int inner = 0;   ///< and of these, the first without a line
    int local_nodes() const { return own + static_cast<int>(neighbour.size() + shared.size()); }

    std::vector<NodeIndex> node;       ///< [gore * own + local node]
    std::vector<LocalNode> neighbour;  ///< own nodes that the gore before sees as local node own + k
    std::vector<std::vector<NodeIndex>>
        shared;  ///< [k][gore]: the shared node that is local own + neighbours + k

    std::vector<GoreTriangle> triangles;
    std::vector<GoreCable> cables;  ///< tapes, then the line from the skirt to a shared node, node after node
    std::vector<GoreCable> static_line;  ///< cords from the vent to a static line
    std::vector<GoreEdge> edges;         ///< of the fabric

    // Global structure, which belongs to no gore: links, risers, the payload, a static line.
    std::vector<NodeIndex> global;          ///< nodes of the system, without static line, in mesh order
    std::vector<Cable> global_cables;       ///< risers
    std::vector<Cable> global_static_line;  ///< of a static line, from the apex on
};

/// The gores of a mesh, if they are alike: the same elements in the same order, the same measures and masses
/// to 1e-12. Otherwise nothing, and `why` says what differs.
std::optional<Gores> find_gores(const Mesh& mesh, std::string* why = nullptr);

}  // namespace twinchute::fullsim
