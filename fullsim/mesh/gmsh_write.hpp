// A mesh as Gmsh reads it, with named physical groups.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

enum class GmshVersion { v2_2, v4_1 };

/// The physical groups of a parachute in a Gmsh file, each with the dimension of its elements.
struct GmshGroupName {
    std::string_view name;
    int dimension;
};
enum GmshGroupIndex {
    group_canopy,
    group_tape,
    group_line,
    group_riser,
    group_reefing,
    group_gap,
    group_vent_line,
    group_payload,
    group_confluence
};
inline constexpr std::array<GmshGroupName, 9> gmsh_groups{{{"canopy", 2},
                                                           {"tape", 1},
                                                           {"line", 1},
                                                           {"riser", 1},
                                                           {"reefing", 1},
                                                           {"gap", 2},
                                                           {"vent_line", 1},
                                                           {"payload", 0},
                                                           {"confluence", 0}}};

/// The mesh at its positions, which have to be those of the parachute as it is made: a Gmsh file says no
/// other lengths than these. Numbers are written so that reading them gives the same bits; tags count nodes
/// and elements from 1 in the order of the mesh. A static line belongs to a start and not to the file.
/// title: what the mesh is of, for a comment.
std::string gmsh_text(const Mesh& mesh, GmshVersion version, std::string_view title);

}  // namespace twinchute::fullsim
