#include "fullsim/mesh/gore_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/mesh/folded_canopy.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

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
          canopy_(canopy_with_mouth(
              chute.gores, pleats(), mouth_area / (pattern_.skirt_radius * pattern_.skirt_radius),
              closed_stretch(chute.gores, counts.gore_columns, pattern_.skirt_radius, chute.fabric, load))) {
        lay_out_rows();
        mesh_.fabric = chute.fabric;
        mesh_.cords = {chute.tapes.radial, chute.tapes.skirt, chute.tapes.vent,
                       chute.line,         chute.line,        chute.line};
        mesh_.axis = axis;
        across_ = axis.unitOrthogonal();
        along_ = axis.cross(across_);
    }

    Mesh build(double payload_mass, bool as_built) {
        if (as_built)
            lay_canopy_flat();
        else
            place_canopy();
        mesh_.line_stretch = as_built ? 1.0 : line_stretch_;
        sew_gores();
        sew_tapes();
        rig_lines();
        lump_masses(mesh_, payload_mass);
        mesh_.position.shrink_to_fit();
        mesh_.triangles.shrink_to_fit();
        mesh_.cables.shrink_to_fit();
        return std::move(mesh_);
    }

private:
    /// Pleat lines a gore. Those of a graded canopy with an even number of columns are its seams and middles,
    /// however many columns there are: no triangle at the vent lies across a pleat.
    int pleats() const {
        return counts_.grading == Grading::graded && counts_.gore_columns % 2 == 0 ? 2 : counts_.gore_columns;
    }

    /// The point of a column line at unit seam length; panels between pleats are flat.
    Vec3 closed_point(int gore, int column) const {
        if (pleats() == counts_.gore_columns) return canopy_.point(gore, column);
        const int half = counts_.gore_columns / 2;
        const Vec3 middle = canopy_.point(gore, 1);
        const Vec3 seam = column < half ? canopy_.point(gore, 0) : canopy_.point(gore + 1, 0);
        const double angle = pattern_.half_angle * std::abs(column - half) / half;
        return middle + std::tan(angle) / std::tan(pattern_.half_angle) * (seam - middle);
    }

    /// A ring of canopy nodes.
    struct Row {
        double radius;        // seam length from the apex [m]
        double start_radius;  // the same where the node starts [m]
        int columns;          // elements across a gore
        NodeIndex first_node;
    };

    /// By how much the first row of a graded mesh is longer than the last ones [m]: four times the vent's
    /// edge, which suits two elements across. More of them are so much the narrower; where all are narrow for
    /// their height, those at the vent are lengthened in proportion, the same on meshes that are finer by as
    /// much in both directions. At most so much that rows, longer by `all` times that together, give half of
    /// the seam away.
    double lengthening_of_the_first(double seam, double all) const {
        if (counts_.grading == Grading::uniform) return 0.0;
        const double edge_per_radius = 2.0 * std::sin(pattern_.half_angle);
        const double width = pattern_.skirt_radius * edge_per_radius / counts_.gore_columns;
        const double slender = seam / counts_.gore_rows / width;
        const double factor = std::clamp(slender, 1.0, std::max(1.0, 0.5 * counts_.gore_columns));
        return std::min(4.0 * factor * pattern_.vent_radius * edge_per_radius, 0.5 * seam / all);
    }

    /// Rings from vent to skirt. On a graded mesh elements near the vent are longer than the rest, by less
    /// from row to row: the smaller the width of an element, the longer it has to be to oscillate no faster
    /// than its neighbours.
    void lay_out_rows() {
        const bool graded = counts_.grading == Grading::graded;
        const double seam = pattern_.skirt_radius - pattern_.vent_radius;
        const auto elongation_rate = [](int row) { return std::pow(row + 1.0, -1.5); };
        double all = 0.0;
        for (int row = 0; row < counts_.gore_rows; ++row)
            all += elongation_rate(row);
        const double first = lengthening_of_the_first(seam, all);
        const double plain = (seam - first * all) / counts_.gore_rows;
        double added = 0.0;
        NodeIndex node = 0;
        for (int row = 0; row <= counts_.gore_rows; ++row) {
            const double radius =
                row < counts_.gore_rows ? pattern_.vent_radius + plain * row + added : pattern_.skirt_radius;
            const int columns = graded && row == 0 ? 1 : counts_.gore_columns;
            rows_.push_back({radius, radius, columns, node});
            added += first * elongation_rate(row);
            node += chute_.gores * columns;
        }
        if (rows_[0].columns < rows_[1].columns) rows_[0].start_radius = loose_vent();
    }

    NodeIndex canopy_node(int gore, int row, int column) const {
        const Row& r = rows_[row];
        return r.first_node + (gore * r.columns + column) % (chute_.gores * r.columns);
    }

    double loose_vent() const {
        const Row& below = rows_[1];
        const int columns = below.columns;
        const Vec3 vent = 0.5 * (canopy_.point(0, 0) + canopy_.point(1, 0));
        const Vec3 foot =
            0.5 * below.radius * (closed_point(0, columns / 2) + closed_point(0, (columns + 1) / 2));
        return loose_vent_radius(vent, foot,
                                 (below.radius - rows_[0].radius) * std::cos(pattern_.half_angle));
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
        for (const Row& row : rows_) {
            mesh_.seam_rings.emplace_back();
            for (int gore = 0; gore < chute_.gores; ++gore)
                for (int column = 0; column < row.columns; ++column) {
                    if (column == 0) mesh_.seam_rings.back().push_back(mesh_.node_count());
                    mesh_.position.push_back(world(row.start_radius * closed_point(gore, column)));
                }
        }
        mesh_.canopy_nodes = mesh_.node_count();
    }

    /// Gore beside gore, as they are cut: they close to a disc, the apex on the axis. Lines are straight.
    void lay_canopy_flat() {
        across_ = Vec3::UnitX();
        along_ = Vec3::UnitY();
        link_height_ = chute_.riser_length;
        const double line = chute_.line_length, reach = pattern_.skirt_radius;
        apex_height_ = link_height_ + std::sqrt(line * line - reach * reach);
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            const int columns = rows_[row].columns;
            mesh_.seam_rings.emplace_back();
            for (int gore = 0; gore < chute_.gores; ++gore)
                for (int column = 0; column < columns; ++column) {
                    if (column == 0) mesh_.seam_rings.back().push_back(mesh_.node_count());
                    const double radius = pattern_point(static_cast<int>(row), column).norm();
                    const double azimuth = 2.0 * pi * (gore * columns + column) / (chute_.gores * columns);
                    mesh_.position.push_back(
                        world({radius * std::cos(azimuth), radius * std::sin(azimuth), 0.0}));
                }
        }
        mesh_.canopy_nodes = mesh_.node_count();
    }

    Eigen::Vector2d pattern_point(int row, int column) const {
        const double angle = pattern_.half_angle * (2.0 * column / rows_[row].columns - 1.0);
        return rows_[row].radius * std::cos(pattern_.half_angle) * Eigen::Vector2d(std::tan(angle), 1.0);
    }

    void sew_gores() {
        for (int gore = 0; gore < chute_.gores; ++gore)
            for (int row = 0; row < counts_.gore_rows; ++row) {
                const int columns = rows_[row].columns;
                if (columns < rows_[row + 1].columns) {
                    sew_fans(gore, row);
                    continue;
                }
                for (int column = 0; column < columns; ++column)
                    // Mirrored diagonals, so that a gore is as symmetric as its cut; a middle column
                    // has no mirror image and takes turns.
                    sew_panel(gore, row, column,
                              2 * column + 1 == columns ? row % 2 == 0 : 2 * column < columns);
            }
    }

    /// A row of one element above, of several below: half of the lower edges fan out from either seam, and
    /// a triangle that stands on its tip closes the middle.
    void sew_fans(int gore, int row) {
        const int columns = rows_[row + 1].columns, middle = (columns + 1) / 2;
        for (int column = 0; column < columns; ++column) {
            if (column == middle) sew_triangle(gore, {{{row, 0}, {row + 1, middle}, {row, 1}}});
            sew_triangle(gore, {{{row, column < middle ? 0 : 1}, {row + 1, column}, {row + 1, column + 1}}});
        }
    }

    /// Of a row and a column line of that row.
    struct Corner {
        int row, column;
    };

    void sew_panel(int gore, int row, int column, bool rising) {
        // Counter-clockwise seen from outside: azimuth grows with the column, rows go down.
        const Corner q[4] = {{row, column}, {row + 1, column}, {row + 1, column + 1}, {row, column + 1}};
        const int split[2][2][3] = {{{0, 1, 3}, {1, 2, 3}}, {{0, 1, 2}, {0, 2, 3}}};
        for (const auto& corners : split[rising ? 1 : 0])
            sew_triangle(gore, {q[corners[0]], q[corners[1]], q[corners[2]]});
    }

    void sew_triangle(int gore, const std::array<Corner, 3>& corner) {
        std::array<NodeIndex, 3> node;
        std::array<Eigen::Vector2d, 3> flat;
        for (int k = 0; k < 3; ++k) {
            node[k] = canopy_node(gore, corner[k].row, corner[k].column);
            flat[k] = pattern_point(corner[k].row, corner[k].column);
        }
        mesh_.triangles.push_back(flat_triangle(node, flat));
    }

    void add_cable(NodeIndex a, NodeIndex b, double length, CableKind kind, double strands = 1.0) {
        mesh_.cables.push_back({{a, b}, length, strands, kind});
    }

    void sew_tapes() {
        const int rows = counts_.gore_rows;
        for (int gore = 0; gore < chute_.gores; ++gore)
            for (int row = 0; row < rows; ++row)
                add_cable(canopy_node(gore, row, 0), canopy_node(gore, row + 1, 0),
                          rows_[row + 1].radius - rows_[row].radius, CableKind::radial);
        for (const auto& [row, kind] : {std::pair{rows, CableKind::skirt}, std::pair{0, CableKind::vent}}) {
            for (int gore = 0; gore < chute_.gores; ++gore) {
                for (int column = 0; column < rows_[row].columns; ++column)
                    add_cable(canopy_node(gore, row, column), canopy_node(gore, row, column + 1),
                              (pattern_point(row, column + 1) - pattern_point(row, column)).norm(), kind);
                if (kind == CableKind::skirt && !chute_.reefing.empty()) reef(gore);
            }
        }
    }

    /// The reefing line runs through rings on the seams. It is of the skirt tape's material.
    void reef(int gore) {
        mesh_.reefing_line.push_back(mesh_.cables.size());
        add_cable(canopy_node(gore, counts_.gore_rows, 0), canopy_node(gore + 1, counts_.gore_rows, 0),
                  reefing_line_length(chute_, 0) / chute_.gores, CableKind::skirt);
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
        // Links follow the lines: what no gore has is at the end.
        const NodeIndex first_link = mesh_.node_count() + chute_.gores * (counts_.line_elements - 1);
        for (int gore = 0; gore < chute_.gores; ++gore)
            add_chain(mesh_.seam_rings.back()[gore], first_link + gore / lines_per_riser, link_place,
                      chute_.line_length, counts_.line_elements, CableKind::line, 1.0);
        mesh_.position.insert(mesh_.position.end(), chute_.risers, link_place);
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
    std::vector<Row> rows_;  // vent to skirt
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
    return Builder(chute, counts, axis, mouth_area, load).build(payload_mass, false);
}

Mesh make_flat_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass) {
    // The mouth says nothing of a canopy that lies flat; any will do.
    return Builder(chute, counts, Vec3::UnitZ(), mouth_area_at_line_stretch(chute), 0.0)
        .build(payload_mass, true);
}

}  // namespace twinchute::fullsim
