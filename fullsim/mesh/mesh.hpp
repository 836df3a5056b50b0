// The discrete parachute: nodes, fabric triangles, cables, and which of them is what.
// Plain reference data that never changes during a run; what changes is in State.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "fullsim/solid.hpp"
#include "lib/math/vec.hpp"
#include "lib/models/material.hpp"

namespace twinchute::fullsim {

using NodeIndex = std::int32_t;

/// A fabric triangle; its corners turn counter-clockwise seen from outside the canopy.
struct Triangle {
    std::array<NodeIndex, 3> node;
    int sheet = 0;  ///< its fabric, see Mesh::fabric_of
    /// The unstrained triangle laid flat: corner 1 at (a, 0), corner 2 at (b, c) from corner 0 [m].
    double a, b, c;

    double area() const { return 0.5 * a * c; }  ///< [m^2]
};

/// The triangle of these corners, unstrained [m].
Triangle laid_flat(const std::array<NodeIndex, 3>& node, const std::array<Vec3, 3>& corner);

enum class CableKind : std::uint8_t { radial, skirt, vent, line, riser, static_line, vent_line };

std::string_view cable_kind_name(CableKind kind);
/// Sewn to the canopy.
constexpr bool is_tape(CableKind kind) {
    return kind <= CableKind::vent;
}

struct Cable {
    std::array<NodeIndex, 2> node;
    double rest_length;  ///< [m]
    double strands;      ///< cords of this section side by side
    CableKind kind;
};

/// A line from the apex to an anchor outside the system. Its nodes come last: they go when it lets go, and no
/// other number changes. First the apex, last the anchor.
struct StaticLine {
    std::vector<Vec3> position;  ///< [m] as Mesh::position
    std::vector<double> mass;    ///< [kg]; none at the anchor, which nothing accelerates
    std::vector<Cable> cables;
};

/// A payload that is a body, about its centre of mass, along the axes of the parachute as it is made: z to
/// the apex, x and y across.
struct BodyMesh {
    SolidMesh solid;
    Lumped lumped;            ///< its centre is the origin
    std::vector<int> end;     ///< node of the solid where each riser ends, in the order of Mesh::cables
    bool deformable = false;  ///< its nodes move by themselves; otherwise it is rigid
    /// Origin of Mesh::position in an imported body: the middle of its attachment nodes [m].
    std::optional<Vec3> middle = {};

    /// Where nodes move with it, or by themselves: ends of risers, all nodes of one that is deformable [m].
    std::vector<Vec3> attachments() const;
    /// Index among the attachment points of the one at which a riser ends.
    int place_of(std::size_t riser) const { return deformable ? end[riser] : static_cast<int>(riser); }
    /// And back: the node of the solid.
    int node_of(int place) const { return deformable ? place : end[static_cast<std::size_t>(place)]; }
};

class Mesh {
public:
    /// Nodes are numbered canopy first, then lines, links and risers, the payload last.
    int node_count() const { return static_cast<int>(position.size()); }
    NodeIndex payload() const { return node_count() - 1; }
    /// Takes the forces of padding elements.
    NodeIndex dummy() const { return node_count(); }
    /// Where risers are tied to a payload that is a body, and its other nodes where it is deformable: after
    /// the dummy, nothing but the body moves them.
    NodeIndex first_attachment() const { return node_count() + 1; }
    NodeIndex first_static_line_node() const {
        return first_attachment() + static_cast<NodeIndex>(attachments.size());
    }
    /// Where risers meet the payload [m], as position: one attachment point of a body, or the payload itself.
    Vec3 pivot() const { return attachments.size() == 1 ? attachments.front() : Vec3::Zero(); }
    bool is_canopy(NodeIndex i) const { return i < canopy_nodes; }
    const Cord& cord(CableKind kind) const { return cords[static_cast<std::size_t>(kind)]; }

    /// Mass of fabric and cables [kg], without the payload.
    double parachute_mass() const;
    /// Mass of one of the cables [kg]. A reefing line has none: it is light, and its length depends on its
    /// stage.
    double cable_mass(std::size_t index) const;
    /// Fabric area [m^2], the vent excluded.
    double fabric_area() const;
    double gap_area() const;     ///< [m^2]
    double fabric_mass() const;  ///< [kg]

    int sheets() const { return 1 + static_cast<int>(other_fabrics.size()); }
    const Fabric& fabric_of(int sheet) const {
        return sheet == 0 ? fabric : other_fabrics[static_cast<std::size_t>(sheet) - 1];
    }
    /// The fabric with the largest E t.
    const Fabric& stiffest_fabric() const;

    std::vector<Vec3> position;  ///< [m] at the start of a run, payload at the origin
    std::vector<double> mass;    ///< [kg] material mass lumped to each node
    /// [m^2] of unstrained fabric, canopy nodes alone; sums to fabric_area().
    std::vector<double> tributary_area;
    int canopy_nodes = 0;

    std::vector<Triangle> triangles;
    std::vector<Triangle> gaps;  ///< surfaces without fabric that close the gaps between panels, likewise
    std::vector<Cable> cables;
    Fabric fabric;                      ///< of sheet 0
    std::vector<Fabric> other_fabrics;  ///< of sheets 1, 2, ..., where panels have fabrics of their own
    std::array<Cord, 7> cords;          ///< by CableKind
    std::vector<Vec3> attachments;      ///< [m] of the body, as position; empty: the payload is a point mass
    /// Body of a payload that is not a point mass. An imported mesh has it before attach_payload, which makes
    /// a scene's.
    std::optional<BodyMesh> body;
    double line_stretch = 1.0;  ///< [-] of lines and risers at the start, by the load that they carry
    StaticLine static_line;     ///< empty where there is none
    /// Which of the cables are the reefing line, in rising order, from seam to seam around the mouth; empty
    /// where there is none.
    std::vector<std::size_t> reefing_line;
    bool vent_held_down = false;  ///< vent lines lead to suspension lines

    /// Seam nodes, one ring of `gores` for each row from vent to skirt.
    std::vector<std::vector<NodeIndex>> seam_rings;
    Vec3 axis = Vec3::UnitZ();  ///< from payload to apex at the start
};

/// Index of the sheet of a fabric; the first one is sheet 0 of the mesh, others are added to it.
int sheet_of(Mesh& mesh, const Fabric& fabric);

/// Lumps a third of each triangle and half of each cable to their nodes, and the payload to its own.
void lump_masses(Mesh& mesh, double payload_mass);

}  // namespace twinchute::fullsim
