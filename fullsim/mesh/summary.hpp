// Summary of a mesh: counts, masses, areas, lengths.
#pragma once

#include <array>

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

inline constexpr std::size_t cable_kind_count = std::tuple_size_v<decltype(Mesh::cords)>;

struct MeshSummary {
    int nodes = 0;
    std::size_t triangles = 0;
    std::array<std::size_t, cable_kind_count> cables{};  ///< by CableKind, the reefing line apart
    std::size_t reefing_line = 0;                        ///< cables of it
    double fabric_mass = 0.0;                            ///< [kg]
    std::array<double, cable_kind_count> cable_mass{};   ///< [kg] by CableKind
    double total_mass = 0.0;                             ///< [kg] without the payload
    double fabric_area = 0.0;                            ///< [m^2] unstrained
    double gap_area = 0.0;                               ///< [m^2] without fabric, likewise
    double smallest_edge = 0.0;                          ///< [m] unstrained, of a triangle or a cable
};

MeshSummary summarise(const Mesh& mesh);

/// [m] of the box around all nodes: east, north, up.
Vec3 bounding_size(const Mesh& mesh);

}  // namespace twinchute::fullsim
