// A Gmsh file as that of a parachute: its elements by the groups of gmsh_groups, each checked by itself.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fullsim/mesh/gmsh_read.hpp"
#include "fullsim/mesh/gmsh_write.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// An index of GmshMesh::nodes.
using FileNode = std::int32_t;

class ImportFile {
public:
    /// Both have to outlive it. Throws SceneError with the line of the file: groups that are unknown, missing
    /// or of another dimension, elements without a size, two elements on the same nodes.
    ImportFile(const GmshMesh& mesh, const Scene& scene);

    const std::string& name() const { return mesh_.file; }
    const std::vector<GmshNode>& nodes() const { return mesh_.nodes; }
    const std::vector<GmshElement>& elements() const { return mesh_.elements; }
    const std::vector<const GmshElement*>& elements_of(GmshGroupIndex group) const { return of_[group]; }
    const GmshNode& node(FileNode i) const { return mesh_.nodes[static_cast<std::size_t>(i)]; }
    const Vec3& position(FileNode i) const { return node(i).position; }  ///< [m]

    /// Throw SceneError at a line of the file, or at an element.
    [[noreturn]] void refuse(int line, std::string problem, std::string why, std::string hint) const;
    [[noreturn]] void refuse(const GmshElement& e, std::string_view problem, std::string why,
                             std::string hint) const;

private:
    void sort_by_group(bool reefed);
    void check_element(const GmshElement& e) const;
    void check_duplicates() const;

    const GmshMesh& mesh_;
    std::array<std::vector<const GmshElement*>, gmsh_groups.size()> of_;  // elements by group
};

}  // namespace twinchute::fullsim
