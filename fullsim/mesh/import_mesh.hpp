// A parachute from a mesh of somebody's own: which of its elements is what, how long each is unstrained, and
// how all of it starts. docs/guide/meshes.md says what a file has to hold.
#pragma once

#include <string>
#include <vector>

#include "fullsim/mesh/gmsh_read.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// A line's nodes, from the skirt to the link.
using LineNodes = std::vector<NodeIndex>;

/// The parachute of a file.
struct ImportedMesh {
    Mesh mesh;  ///< at the places of the file: as it is made, the confluence at the origin
    std::vector<LineNodes> lines;
    std::vector<NodeIndex> skirt;  ///< around its edge, in the order of their azimuths
    std::vector<NodeIndex> vent;   ///< likewise around the opening nearest to the axis; empty: there is none
    /// Corners of the payload's tetrahedra [m], four each: about the confluence, like all places.
    std::vector<std::array<Vec3, 4>> payload;
    double nominal_area = 0.0;  ///< [m^2] of fabric and openings
    double vent_area = 0.0;     ///< [m^2] of the opening nearest to the axis
};

/// The parachute that a file makes with the materials of a scene. Throws SceneError with the line of the file
/// and the tag of the element or node that is wrong.
ImportedMesh import_mesh(const GmshMesh& file, const Scene& scene);

/// The same from the file that the scene names, read anew.
ImportedMesh import_mesh(const Scene& scene);

/// Where the scene says other sizes than the mesh has, and what of the mesh is not used.
std::vector<Warning> size_warnings(const ImportedMesh& imported, const Scene& scene);

}  // namespace twinchute::fullsim
