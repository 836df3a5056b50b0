// Generated mesh of a cross: two strips that cross, with lines along the ends of their arms.
#pragma once

#include "fullsim/mesh/import_mesh.hpp"

namespace twinchute::fullsim {

/// A cross as it is made, flat, z up to its apex, the payload at the origin. Elements: those between two
/// lines across an arm, full.mesh.gore_columns, also across the middle square, whose diagonals run along
/// edges; full.mesh.gore_rows from that square to the end of an arm. Radial tapes lie under every line along
/// the whole strip, the skirt tape around the edge; ties of it join the corners of neighbouring arms. The
/// mesh turns onto itself by a quarter of a turn. Mesh::seam_rings: the apex, then the line's columns from
/// the middle square to the ends of the arms.
ImportedMesh make_cross_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass);

}  // namespace twinchute::fullsim
