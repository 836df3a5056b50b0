// One sector of a parachute that a turn about its axis brings onto itself: what a run needs that is as
// symmetric as its mesh.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fullsim/mesh/gores.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// The smallest sector: one gore under a single riser, else the gores of one riser. Its nodes are numbered
/// one column of the canopy after the other, from vent to skirt and on along the line, link and riser at the
/// end: so that elements of a kind that follow each other have nodes that do. After its own nodes come the
/// payload, and the halo nodes of its first seam: the next sector's.
struct Sector {
    int count = 0;      ///< of sectors
    int gores = 0;      ///< in each of them
    double turn = 0.0;  ///< [rad] from one sector to the next, about the vertical
    int own = 0;        ///< nodes that move, without the payload
    double riser_share =
        1.0;  ///< of a riser that is this sector's: all of it, or its share of the only one [-]

    std::vector<NodeIndex> node;  ///< [sector * own + own node]: in the mesh; on the axis the same in all
    std::vector<bool> on_axis;    ///< own nodes that all sectors share
    std::vector<LocalNode> seam;  ///< own nodes whose halo nodes follow the payload
    std::vector<GoreTriangle> triangles;
    std::vector<GoreCable> cables;  ///< tapes, lines, and the riser with as many strands as are this sector's

    LocalNode payload() const { return own; }
    LocalNode first_halo() const { return own + 1; }
    int nodes() const { return own + 1 + static_cast<int>(seam.size()); }
};

/// The sector of a mesh, if all are alike and lie around the vertical through the payload; otherwise nothing,
/// and `why` says what differs.
std::optional<Sector> find_sector(const Mesh& mesh, std::string* why = nullptr);

}  // namespace twinchute::fullsim
