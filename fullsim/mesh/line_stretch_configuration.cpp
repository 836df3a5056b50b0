#include "fullsim/mesh/line_stretch_configuration.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fullsim/mesh/folded_canopy.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double flat = 1e-6;  // of the canopy's radius, and of angles

/// The pattern of a canopy that lies flat, all gores alike.
struct FlatPattern {
    int gores = 0;
    int columns = 0;           // edges of the skirt in a gore; even where they are not the same
    int pleats = 0;            // rays of a gore
    double first = 0.0;        // azimuth of the first seam [rad]
    double height = 0.0;       // of the canopy above the confluence [m]
    double radius = 0.0;       // of the skirt along a seam [m]
    bool narrow_vent = false;  // one element across a gore there
};

double azimuth_of(const Vec3& x) {
    return std::atan2(x.y(), x.x());
}
/// In [0, 2 pi), what is a whole turn by all but rounding taken for none.
double turned(double angle) {
    const double whole = angle - 2.0 * pi * std::floor(angle / (2.0 * pi));
    return 2.0 * pi - whole < 1e-12 ? 0.0 : whole;
}

class DrawOut {
public:
    DrawOut(const ImportedMesh& imported, const Scene& scene, const Vec3& axis)
        : imported_(imported), scene_(scene), mesh_(imported.mesh) {
        mesh_.axis = axis;
        across_ = axis.unitOrthogonal();
        along_ = axis.cross(across_);
    }

    Mesh as_built() {
        for (Vec3& x : mesh_.position)
            x = world(x);
        return std::move(mesh_);
    }

    /// Why the canopy cannot be folded; empty where it can.
    std::string find_pattern() {
        pattern_.gores = static_cast<int>(imported_.lines.size());
        const auto& position = imported_.mesh.position;
        double radius = 0.0;
        for (const ImportedLine& line : imported_.lines)
            radius = std::max(radius, position[line.node.front()].head<2>().norm());
        pattern_.radius = radius;
        pattern_.height = position[imported_.lines.front().node.front()].z();
        for (NodeIndex i = 0; i < imported_.mesh.canopy_nodes; ++i)
            if (std::abs(position[i].z() - pattern_.height) > flat * radius)
                return "the canopy does not lie flat across z";
        pattern_.first = azimuth_of(position[imported_.lines.front().node.front()]);
        for (int g = 0; g < pattern_.gores; ++g) {
            const Vec3& foot = position[imported_.lines[static_cast<std::size_t>(g)].node.front()];
            const double off = turned(azimuth_of(foot) - pattern_.first) - 2.0 * pi * g / pattern_.gores;
            if (std::abs(off) > flat || std::abs(foot.head<2>().norm() - radius) > flat * radius)
                return "lines are not tied at equal angles around z";
        }
        const auto each = [&](const std::vector<NodeIndex>& ring) {
            const int count = static_cast<int>(ring.size());
            return pattern_.gores > 0 && count % pattern_.gores == 0 ? count / pattern_.gores : 0;
        };
        pattern_.columns = std::max(2, each(imported_.skirt));
        if (each(imported_.skirt) == 1) pattern_.columns = 1;
        const int at_vent = each(imported_.vent);
        const bool uniform = at_vent == pattern_.columns;
        pattern_.pleats = pattern_.columns % 2 != 0 || uniform ? pattern_.columns : 2;
        pattern_.narrow_vent = at_vent == 1 && pattern_.columns > 1 && imported_.mesh.seam_rings.size() > 2;
        return {};
    }

    Mesh folded(double mouth_area, double load) {
        const Parachute& chute = scene_.parachutes.front();
        const double line_stretch = 1.0 + load / (pattern_.gores * chute.line.axial_stiffness());
        const double radius = pattern_.radius;
        const ClosedCanopy canopy =
            canopy_with_mouth(pattern_.gores, pattern_.pleats, mouth_area / (radius * radius),
                              closed_stretch(pattern_.gores, pattern_.columns, radius, chute.fabric, load));
        fold(canopy);
        if (pattern_.narrow_vent) loosen_vent(canopy);
        // Links and risers hang as they are made, a little longer; the canopy is as high above them as the
        // shortest line allows.
        mesh_.line_stretch = line_stretch;
        for (NodeIndex i = mesh_.canopy_nodes; i < mesh_.node_count(); ++i)
            mesh_.position[i] *= line_stretch;
        double apex = std::numeric_limits<double>::infinity();
        for (const ImportedLine& line : imported_.lines) {
            const Vec3 &skirt = mesh_.position[line.node.front()], &link = mesh_.position[line.node.back()];
            const double length = line_stretch * line.length();
            const double across = (skirt - link).head<2>().norm();
            if (!(across < length))
                refuse("parachute.mesh", fmt::format("a line of {:.4g} m does not reach the mouth", length),
                       fmt::format("it lies {:.4g} m to the side of the link", across),
                       "lengthen the lines of the mesh");
            apex = std::min(apex, link.z() + std::sqrt(length * length - across * across) - skirt.z());
        }
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            mesh_.position[i].z() += apex;
        for (const ImportedLine& line : imported_.lines)
            straighten(line);
        for (Vec3& x : mesh_.position)
            x = world(x);
        return std::move(mesh_);
    }

    [[noreturn]] void refuse(std::string key, std::string problem, std::string why, std::string hint) const {
        throw SceneError({scene_.file.string(), 0, 0}, std::move(key), std::move(problem), std::move(why),
                         std::move(hint));
    }

private:
    Vec3 world(const Vec3& p) const { return p.z() * mesh_.axis + p.x() * across_ + p.y() * along_; }

    /// The apex at the origin for now, the canopy below it.
    void fold(const ClosedCanopy& canopy) {
        const auto turn = Eigen::AngleAxisd(pattern_.first, Vec3::UnitZ()).toRotationMatrix();
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i) {
            const Vec3& x = imported_.mesh.position[i];
            Vec3 p = canopy.folded(x.head<2>().norm(), turned(azimuth_of(x) - pattern_.first));
            p.z() = -p.z();
            mesh_.position[i] = pattern_.first == 0.0 ? p : Vec3(turn * p);
        }
    }

    /// As loose_vent_radius says, for rings that differ in nothing but rounding.
    void loosen_vent(const ClosedCanopy& canopy) {
        const auto& rings = imported_.mesh.seam_rings;
        const auto& position = imported_.mesh.position;
        const double half_angle = pi / pattern_.gores;
        const double vent = position[rings[0][0]].head<2>().norm(),
                     below = position[rings[1][0]].head<2>().norm();
        const Vec3 middle = 0.5 * (canopy.point(0, 0) + canopy.point(1, 0));
        const auto unit = [&](int column) {
            const double length = ClosedCanopy::column_length(pattern_.gores, pattern_.columns, column);
            return canopy.folded(length, 2.0 * half_angle * column / pattern_.columns);
        };
        const Vec3 foot = 0.5 * below * (unit(pattern_.columns / 2) + unit((pattern_.columns + 1) / 2));
        const double loose = loose_vent_radius(middle, foot, (below - vent) * std::cos(half_angle));
        for (const NodeIndex i : rings[0])
            mesh_.position[i] *= loose / vent;
    }

    /// Nodes of a line between its ends, each where its part of the length is.
    void straighten(const ImportedLine& line) {
        const Vec3 start = mesh_.position[line.node.front()], end = mesh_.position[line.node.back()];
        const double whole = line.length();
        double length = 0.0;
        for (std::size_t k = 1; k + 1 < line.node.size(); ++k) {
            length += line.piece[k - 1];
            mesh_.position[line.node[k]] = start + (end - start) * (length / whole);
        }
    }

    const ImportedMesh& imported_;
    const Scene& scene_;
    Mesh mesh_;
    FlatPattern pattern_;
    Vec3 across_, along_;
};

}  // namespace

Mesh line_stretch_configuration(const ImportedMesh& imported, const Scene& scene, const Vec3& axis,
                                double mouth_area, double load, bool inflated) {
    DrawOut shape(imported, scene, axis);
    const std::string why = shape.find_pattern();
    if (why.empty()) return shape.folded(mouth_area, load);
    if (inflated) return shape.as_built();
    shape.refuse(
        "parachute.deploy.by",
        fmt::format("'{}' cannot be folded",
                    scene.parachutes.front().mesh ? scene.parachutes.front().mesh->name : "the mesh"),
        why, "mesh the canopy flat, or write deploy.by = \"inflated\"");
}

}  // namespace twinchute::fullsim
