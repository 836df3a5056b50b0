// A parachute from a mesh of somebody's own: which of its elements is what, how long each is unstrained, and
// how all of it starts. docs/guide/meshes.md says what a file has to hold.
#pragma once

#include <numeric>
#include <string>
#include <vector>

#include "fullsim/mesh/gmsh_read.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// A line from the skirt to the link.
struct ImportedLine {
    std::vector<NodeIndex> node;
    std::vector<double> piece;  ///< [m] from each node to the next, as made

    double length() const { return std::accumulate(piece.begin(), piece.end(), 0.0); }  ///< [m]
};

/// The parachute of a file.
struct ImportedMesh {
    /// At the places of the file: as it is made, the confluence at the origin. Where risers end at several
    /// nodes of a body these are the one node of the payload, in their middle.
    Mesh mesh;
    std::vector<ImportedLine> lines;
    std::vector<NodeIndex> skirt;  ///< around its edge, in the order of their azimuths
    std::vector<NodeIndex> vent;   ///< likewise around the opening nearest to the axis; empty: there is none
    SolidMesh payload;             ///< its tetrahedra [m], about the confluence, like all places
    double nominal_area = 0.0;     ///< [m^2] of fabric and openings
    double vent_area = 0.0;        ///< [m^2] of the opening nearest to the axis
};

/// The parachute that a file makes with the materials of a scene. Throws SceneError with the line of the file
/// and the tag of the element or node that is wrong.
ImportedMesh import_mesh(const GmshMesh& file, const Scene& scene);

/// Imports from the file that the scene names, which is read anew.
ImportedMesh import_mesh(const Scene& scene);

/// Where the scene says other sizes than the mesh has, and what of the mesh is not used.
std::vector<Warning> size_warnings(const ImportedMesh& imported, const Scene& scene);

}  // namespace twinchute::fullsim
