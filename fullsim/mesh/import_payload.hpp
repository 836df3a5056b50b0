// The payload of a Gmsh file: a point, or a body of tetrahedra.
#pragma once

#include <vector>

#include "fullsim/mesh/import_file.hpp"
#include "fullsim/solid.hpp"

namespace twinchute::fullsim {

/// The payload of a file, and the nodes where it hangs.
struct ImportedPayload {
    SolidMesh solid;                    ///< its tetrahedra [m], about the origin
    std::vector<FileNode> solid_node;   ///< of the file, for each node of the solid
    std::vector<FileNode> confluences;  ///< of the file, in rising order; several where it is a body
    Vec3 origin = Vec3::Zero();         ///< in their middle [m], as the file has it
};

/// takes_body: the payload is the file's body, and not a point mass or of the scene's sizes. Throws
/// SceneError: tetrahedra in several pieces or none, confluences off them, several or none for a point mass.
ImportedPayload import_payload(const ImportFile& file, bool takes_body);

}  // namespace twinchute::fullsim
