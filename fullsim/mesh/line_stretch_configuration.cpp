#include "fullsim/mesh/line_stretch_configuration.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int most_corrections = 100;
constexpr double unstrained = 1e-12;

[[noreturn]] void refuse(const Scene& scene, std::string key, std::string problem, std::string why,
                         std::string hint) {
    throw SceneError({scene.file.string(), 0, 0}, std::move(key), std::move(problem), std::move(why),
                     std::move(hint));
}

/// The canopy of a file for the rows of canopy_geometries(). `imported` has to outlive it.
GivenCanopy given_canopy(const ImportedMesh& imported) {
    const Mesh& mesh = imported.mesh;
    GivenCanopy canopy{std::span(mesh.position).first(static_cast<std::size_t>(mesh.canopy_nodes)),
                       {},
                       imported.skirt.size(),
                       imported.vent.size(),
                       mesh.seam_rings};
    for (const ImportedLine& line : imported.lines)
        canopy.seam_end.push_back(mesh.position[line.node.front()]);
    return canopy;
}

class LineStretch {
public:
    LineStretch(const ImportedMesh& imported, const Vec3& axis) : imported_(imported), mesh_(imported.mesh) {
        mesh_.axis = axis;
    }

    Mesh constructed() { return along_axis(); }

    /// folded: nodes of the canopy, axes as in CanopyNodes [m].
    Mesh folded(const std::vector<Vec3>& folded, const Scene& scene, double load) {
        const double gores = static_cast<double>(imported_.lines.size());
        const double line_stretch = 1.0 + load / (gores * scene.parachutes.front().line.axial_stiffness());
        // Links and risers hang as they are made, a little longer; the canopy is as high above them as the
        // shortest line allows.
        mesh_.line_stretch = line_stretch;
        for (NodeIndex i = mesh_.canopy_nodes; i < mesh_.node_count(); ++i)
            mesh_.position[i] *= line_stretch;
        double apex = std::numeric_limits<double>::infinity();
        for (const ImportedLine& line : imported_.lines) {
            const Vec3 &skirt = folded[static_cast<std::size_t>(line.node.front())],
                       &link = mesh_.position[line.node.back()];
            const double length = line_stretch * line.length();
            const double across = (skirt - link).head<2>().norm();
            if (!(across < length))
                refuse(scene, scene.parachutes.front().mesh ? "parachute.mesh" : "parachute.line_length",
                       fmt::format("a line of {:.4g} m does not reach the mouth", length),
                       fmt::format("it lies {:.4g} m to the side of the link", across), "lengthen the lines");
            apex = std::min(apex, link.z() + std::sqrt(length * length - across * across) + skirt.z());
        }
        hang(folded, apex);
        // Where lines come together none of them is straight, and the canopy hangs a little lower.
        for (int k = 0; k < most_corrections; ++k) {
            const double too_long = longest_excess();
            if (too_long < unstrained * apex) break;
            hang(folded, apex -= too_long);
        }
        return along_axis();
    }

private:
    /// z along the axis.
    Mesh along_axis() {
        const Vec3 across = mesh_.axis.unitOrthogonal(), along = mesh_.axis.cross(across);
        for (Vec3& x : mesh_.position)
            x = Vec3(x.z() * mesh_.axis + x.x() * across + x.y() * along);
        return std::move(mesh_);
    }

    /// The canopy below its apex, and lines below the canopy: nodes between their ends where their part of
    /// the length is, those that several lines share in the middle of where each would have them.
    void hang(const std::vector<Vec3>& folded, double apex) {
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i) {
            const Vec3& p = folded[static_cast<std::size_t>(i)];
            mesh_.position[i] = {p.x(), p.y(), apex - p.z()};
        }
        std::map<NodeIndex, std::pair<Vec3, int>> between;
        for (const ImportedLine& line : imported_.lines) {
            const Vec3 start = mesh_.position[line.node.front()], end = mesh_.position[line.node.back()];
            const double whole = line.length();
            double length = 0.0;
            for (std::size_t k = 1; k + 1 < line.node.size(); ++k) {
                length += line.piece[k - 1];
                auto& [sum, count] = between.try_emplace(line.node[k], Vec3::Zero(), 0).first->second;
                sum += start + (end - start) * (length / whole);
                ++count;
            }
        }
        for (const auto& [i, places] : between)
            mesh_.position[i] = places.first / places.second;
    }

    /// [m] by which a piece of a line is longer than the load stretches it, at most.
    double longest_excess() const {
        double excess = 0.0;
        for (const ImportedLine& line : imported_.lines)
            for (std::size_t k = 0; k < line.piece.size(); ++k)
                excess = std::max(excess,
                                  (mesh_.position[line.node[k]] - mesh_.position[line.node[k + 1]]).norm() -
                                      mesh_.line_stretch * line.piece[k]);
        return excess;
    }

    const ImportedMesh& imported_;
    Mesh mesh_;
};

}  // namespace

Mesh drawn_out_with(const ImportedMesh& parachute, const std::vector<Vec3>& canopy, const Scene& scene,
                    const Vec3& axis, double load) {
    return LineStretch(parachute, axis).folded(canopy, scene, load);
}

Mesh line_stretch_configuration(const ImportedMesh& imported, const Scene& scene, const Vec3& axis,
                                double mouth_area, double load, bool inflated) {
    const Parachute& chute = scene.parachutes.front();
    const CanopyGeometry& geometry = canopy_geometry(chute);
    const GivenCanopy canopy = given_canopy(imported);
    LineStretch shape(imported, axis);
    const std::string why = geometry.mismatch(canopy);
    if (why.empty())
        return shape.folded(geometry.fold_given(canopy, {mouth_area, load, chute.fabric}), scene, load);
    if (inflated) return shape.constructed();
    refuse(scene, "parachute.deploy.by",
           fmt::format("'{}' cannot be folded", chute.mesh ? chute.mesh->name : "the mesh"), why,
           "mesh the canopy flat, or write deploy.by = \"inflated\"");
}

}  // namespace twinchute::fullsim
