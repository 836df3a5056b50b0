// A mesh as Gmsh writes it, formats 2.2 and 4.1 in ASCII: nodes, elements, named physical groups. What they
// mean to a parachute is import_mesh's business.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

struct GmshNode {
    std::int64_t tag = 0;
    Vec3 position = Vec3::Zero();  ///< [m], as the file says it
    int line = 0;                  ///< of the file, from 1
};

/// A point, a straight edge, a triangle or a tetrahedron.
struct GmshElement {
    std::int64_t tag = 0;
    int corners = 0;  ///< 1 to 4
    /// Indices of GmshMesh::nodes.
    std::array<std::int32_t, 4> node{};
    std::size_t group = 0;  ///< index of GmshMesh::groups
    int line = 0;           ///< of the file, from 1
};

struct GmshGroup {
    int dimension = 0;
    std::string name;
    int line = 0;
};

struct GmshMesh {
    std::string file;                   ///< as messages name it
    std::vector<GmshGroup> groups;      ///< in the order of the file
    std::vector<GmshNode> nodes;        ///< by tag
    std::vector<GmshElement> elements;  ///< by tag
};

/// Gmsh's name of what has so many corners: "point", "line", "triangle", "tetrahedron".
std::string_view gmsh_shape(int corners);

/// Source: Gmsh reference manual, "MSH file format" (4.1) and "MSH file format version 2 (legacy)". Sections
/// that say nothing of nodes, elements or groups are skipped. Every element belongs to exactly one named
/// group. Throws SceneError with the line of the file, and the tag of the node or element: unknown version,
/// binary, cut off, numbers that are none or not finite, tags that are missing or stand twice, elements of
/// other kinds than those above, elements in no group or in several.
GmshMesh read_gmsh(std::string_view text, const std::string& file);

}  // namespace twinchute::fullsim
