#include "fullsim/mesh/gore_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace twinchute::fullsim {
namespace {

/// The closed canopy as seen from its apex: a fan of rays, one per column line, each as long as its
/// line of the cut pattern. Coordinates: z along the axis toward the payload, x and y across.
///
/// With an even number of columns it is pleated like an umbrella: every second ray, the seams among
/// them, lies on an inner cone, the others on an outer one, at such angles that no panel is strained.
/// An odd number leaves no such pleats: all rays lie on one cone, and what the cloth has too much of
/// around it hangs in folds finer than the mesh, which a tension field carries for nothing.
class ClosedCanopy {
public:
    /// seam_angle: between seams and axis [rad]; 0 is closed, pi/2 lies flat. stretch: along the rays [-].
    ClosedCanopy(int gores, int columns, double seam_angle, double stretch)
        : gores_(gores), columns_(columns), stretch_(stretch), inner_(seam_angle), outer_(seam_angle) {
        if (columns % 2 != 0) return;
        // Neighbouring rays keep the angle of the cut: A cos(outer) + B sin(outer) = cos(cut).
        const double cut = 2.0 * pi / (gores_ * columns_), azimuth = cut;
        const double A = std::cos(inner_), B = std::sin(inner_) * std::cos(azimuth);
        outer_ = std::atan2(B, A) + std::acos(std::min(1.0, std::cos(cut) / std::hypot(A, B)));
    }

    /// The point of column line `column` (0 is the seam) at unit seam length.
    Vec3 point(int gore, int column) const {
        const double azimuth = 2.0 * pi * (gore * columns_ + column) / (gores_ * columns_);
        const double cone = column % 2 == 0 ? inner_ : outer_;
        return stretch_ * column_length(gores_, columns_, column) *
               Vec3(std::sin(cone) * std::cos(azimuth), std::sin(cone) * std::sin(azimuth), std::cos(cone));
    }

    /// Area that the ring of all column lines encloses across the axis, at unit seam length.
    double mouth() const {
        double twice = 0.0;
        for (int gore = 0; gore < gores_; ++gore)
            for (int column = 0; column < columns_; ++column) {
                const Vec3 a = point(gore, column);
                const Vec3 b = column + 1 < columns_ ? point(gore, column + 1) : point(gore + 1, 0);
                twice += a.x() * b.y() - a.y() * b.x();
            }
        return 0.5 * twice;
    }

    /// Length of a column line of the cut pattern over that of the seam: columns are equal angles.
    static double column_length(int gores, int columns, int column) {
        const double delta = pi / gores;
        return std::cos(delta) / std::cos(delta * (2.0 * column / columns - 1.0));
    }

private:
    int gores_, columns_;
    double stretch_, inner_, outer_;
};

/// The canopy whose mouth at unit seam length has the wanted area: by bisection, the mouth opens
/// with the seam angle.
ClosedCanopy canopy_with_mouth(int gores, int columns, double mouth, double stretch) {
    double low = 0.0, high = 0.5 * pi;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (ClosedCanopy(gores, columns, middle, stretch).mouth() < mouth ? low : high) = middle;
    }
    return {gores, columns, 0.5 * (low + high), stretch};
}

/// Lays three points of the plane cut pattern out as Triangle wants them.
Triangle flat_triangle(std::array<NodeIndex, 3> node, const std::array<Eigen::Vector2d, 3>& p) {
    const Eigen::Vector2d e1 = p[1] - p[0], e2 = p[2] - p[0];
    const double a = e1.norm();
    return {node, a, e1.dot(e2) / a, std::abs(e1.x() * e2.y() - e1.y() * e2.x()) / a};
}

class Builder {
public:
    Builder(const Parachute& chute, const MeshCounts& counts, const Vec3& axis, double mouth_area,
            double load)
        : chute_(chute),
          counts_(counts),
          line_stretch_(1.0 + load / (chute.gores * chute.line.axial_stiffness())),
          pattern_(gore_pattern(chute)),
          canopy_(canopy_with_mouth(chute.gores, counts.gore_columns,
                                    mouth_area / (pattern_.skirt_radius * pattern_.skirt_radius),
                                    canopy_stretch(load))) {
        mesh_.fabric = chute.fabric;
        mesh_.cords = {chute.tapes.radial, chute.tapes.skirt, chute.tapes.vent,
                       chute.line,         chute.line,        chute.line};
        mesh_.axis = axis;
        across_ = axis.unitOrthogonal();
        along_ = axis.cross(across_);
    }

    Mesh build(double payload_mass) {
        place_canopy();
        sew_gores();
        sew_tapes();
        rig_lines();
        lump_masses(mesh_, payload_mass);
        return std::move(mesh_);
    }

private:
    /// Stretch of the rays [-]: none of a pleated canopy, whose seams are straight. Without pleats
    /// the cloth of a column is as long in its middle as along its edges, but was cut shorter there,
    /// by cos(delta/columns): the middle comes taut first and carries the load at the skirt.
    double canopy_stretch(double load) const {
        if (counts_.gore_columns % 2 == 0) return 1.0;
        const double around =
            2.0 * chute_.gores * pattern_.skirt_radius * std::sin(pattern_.half_angle);  // [m]
        const double strain = load / (around * chute_.fabric.youngs_modulus * chute_.fabric.thickness);
        return std::cos(pattern_.half_angle / counts_.gore_columns) * std::sqrt(1.0 + 2.0 * strain);
    }

    /// Seam length [m] from the apex to a row.
    double radius(int row) const {
        return pattern_.vent_radius +
               (pattern_.skirt_radius - pattern_.vent_radius) * row / static_cast<double>(counts_.gore_rows);
    }

    NodeIndex canopy_node(int gore, int row, int column) const {
        const int per_row = chute_.gores * counts_.gore_columns;
        return row * per_row + (gore * counts_.gore_columns + column) % per_row;
    }

    /// ClosedCanopy's coordinates, z from the apex toward the payload, to world with the payload at 0.
    Vec3 world(const Vec3& p) const {
        return (apex_height_ - p.z()) * mesh_.axis + p.x() * across_ + p.y() * along_;
    }

    void place_canopy() {
        // Lines are straight and as long as they are: that gives the apex its height.
        const Vec3 skirt = pattern_.skirt_radius * canopy_.point(0, 0);
        const double skirt_radius = std::hypot(skirt.x(), skirt.y());
        const double line = line_stretch_ * chute_.line_length;
        link_height_ = line_stretch_ * chute_.riser_length;
        apex_height_ = link_height_ + std::sqrt(line * line - skirt_radius * skirt_radius) + skirt.z();
        for (int row = 0; row <= counts_.gore_rows; ++row) {
            mesh_.seam_rings.emplace_back();
            for (int gore = 0; gore < chute_.gores; ++gore)
                for (int column = 0; column < counts_.gore_columns; ++column) {
                    if (column == 0)
                        mesh_.seam_rings.back().push_back(static_cast<NodeIndex>(mesh_.position.size()));
                    mesh_.position.push_back(world(radius(row) * canopy_.point(gore, column)));
                }
        }
        mesh_.canopy_nodes = mesh_.node_count();
    }

    Eigen::Vector2d pattern_point(int row, int column) const {
        const double angle = pattern_.half_angle * (2.0 * column / counts_.gore_columns - 1.0);
        return radius(row) * std::cos(pattern_.half_angle) * Eigen::Vector2d(std::tan(angle), 1.0);
    }

    void sew_gores() {
        for (int gore = 0; gore < chute_.gores; ++gore)
            for (int row = 0; row < counts_.gore_rows; ++row)
                for (int column = 0; column < counts_.gore_columns; ++column)
                    // Mirrored diagonals, so that a gore is as symmetric as its cut; a middle column
                    // has no mirror image and takes turns.
                    sew_panel(gore, row, column,
                              2 * column + 1 == counts_.gore_columns ? row % 2 == 0
                                                                     : 2 * column < counts_.gore_columns);
    }

    void sew_panel(int gore, int row, int column, bool rising) {
        struct Corner {
            int row, column;
        };
        // Counter-clockwise seen from outside: azimuth grows with the column, rows go down.
        const Corner q[4] = {{row, column}, {row + 1, column}, {row + 1, column + 1}, {row, column + 1}};
        const int split[2][2][3] = {{{0, 1, 3}, {1, 2, 3}}, {{0, 1, 2}, {0, 2, 3}}};
        for (const auto& corners : split[rising ? 1 : 0]) {
            std::array<NodeIndex, 3> node;
            std::array<Eigen::Vector2d, 3> flat;
            for (int k = 0; k < 3; ++k) {
                const Corner& corner = q[corners[k]];
                node[k] = canopy_node(gore, corner.row, corner.column);
                flat[k] = pattern_point(corner.row, corner.column);
            }
            mesh_.triangles.push_back(flat_triangle(node, flat));
        }
    }

    void add_cable(NodeIndex a, NodeIndex b, double length, CableKind kind, double strands = 1.0) {
        mesh_.cables.push_back({{a, b}, length, strands, kind});
    }

    void sew_tapes() {
        const int rows = counts_.gore_rows;
        for (int gore = 0; gore < chute_.gores; ++gore)
            for (int row = 0; row < rows; ++row)
                add_cable(canopy_node(gore, row, 0), canopy_node(gore, row + 1, 0),
                          radius(row + 1) - radius(row), CableKind::radial);
        for (const auto& [row, kind] : {std::pair{rows, CableKind::skirt}, std::pair{0, CableKind::vent}}) {
            for (int gore = 0; gore < chute_.gores; ++gore)
                for (int column = 0; column < counts_.gore_columns; ++column)
                    add_cable(canopy_node(gore, row, column), canopy_node(gore, row, column + 1),
                              (pattern_point(row, column + 1) - pattern_point(row, column)).norm(), kind);
        }
    }

    /// A chain of equal cables along a straight line, from a node to the node `to` at `end`.
    void add_chain(NodeIndex from, NodeIndex to, const Vec3& end, double length, int elements, CableKind kind,
                   double strands) {
        const Vec3 start = mesh_.position[from];
        for (int k = 1; k <= elements; ++k) {
            const NodeIndex next = k < elements ? mesh_.node_count() : to;
            if (k < elements)
                mesh_.position.push_back(start + (end - start) * k / static_cast<double>(elements));
            add_cable(from, next, length / elements, kind, strands);
            from = next;
        }
    }

    void rig_lines() {
        const int lines_per_riser = chute_.gores / chute_.risers;
        const Vec3 link_place = link_height_ * mesh_.axis;
        const NodeIndex first_link = mesh_.node_count();
        mesh_.position.insert(mesh_.position.end(), chute_.risers, link_place);
        for (int gore = 0; gore < chute_.gores; ++gore)
            add_chain(mesh_.seam_rings.back()[gore], first_link + gore / lines_per_riser, link_place,
                      chute_.line_length, counts_.line_elements, CableKind::line, 1.0);
        // The payload is the last node: its number is known before it is placed.
        const NodeIndex payload = mesh_.node_count() + chute_.risers * (counts_.riser_elements - 1);
        for (int r = 0; r < chute_.risers; ++r)
            // As many strands as it carries lines, so that a riser is as strong as they are.
            add_chain(first_link + r, payload, Vec3::Zero(), chute_.riser_length, counts_.riser_elements,
                      CableKind::riser, lines_per_riser);
        mesh_.position.push_back(Vec3::Zero());
    }

    const Parachute& chute_;
    const MeshCounts& counts_;
    double line_stretch_;  // of lines and risers [-]
    GorePattern pattern_;
    ClosedCanopy canopy_;
    Mesh mesh_;
    Vec3 across_, along_;
    double link_height_ = 0.0, apex_height_ = 0.0;
};

}  // namespace

GorePattern gore_pattern(const Parachute& chute) {
    const double delta = pi / chute.gores;
    // Area of a regular polygon of n sides over its circumradius squared.
    const double polygon = 0.5 * chute.gores * std::sin(2.0 * delta);
    const double nominal = 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;
    const double vent = 0.25 * pi * chute.vent_diameter * chute.vent_diameter;
    return {delta, std::sqrt(nominal / polygon), std::sqrt(vent / polygon)};
}

Mesh make_gore_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass, const Vec3& axis,
                    double mouth_area, double load) {
    return Builder(chute, counts, axis, mouth_area, load).build(payload_mass);
}

}  // namespace twinchute::fullsim
