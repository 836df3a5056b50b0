#include "fullsim/mesh/gore_mesh.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/mesh/rigging.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int no_fabric = -1;  // sheet of a gap

constexpr CableKind kind_of(TapeLine line) {
    switch (line) {
        case TapeLine::seam:
            return CableKind::radial;
        case TapeLine::skirt:
            return CableKind::skirt;
        case TapeLine::vent:
            break;
    }
    return CableKind::vent;
}

class Builder {
public:
    Builder(const Parachute& chute, const MeshCounts& counts)
        : chute_(chute),
          counts_(counts),
          geometry_(canopy_geometry(chute)),
          outline_(geometry_.outline(chute)),
          grading_(meshed_grading(chute, counts)) {
        lay_out_rows();
        for (std::size_t row = 0; row + 1 < rows_.size(); ++row)
            sheets_.push_back(outline_.in_gap(0.5 * (rows_[row].seam + rows_[row + 1].seam))
                                  ? no_fabric
                                  : sheet_of(mesh_, meshed_fabric(chute, panel_of(rows_[row]))));
        mesh_.cords.fill(chute.line);
        for (const Tape& tape : geometry_.tapes)
            mesh_.cords[static_cast<std::size_t>(kind_of(tape.line))] = chute.tapes.*tape.cord;
        if (!chute.vent_lines) return;
        if (!chute.vent_lines->cord.name.empty())
            mesh_.cords[static_cast<std::size_t>(CableKind::vent_line)] = chute.vent_lines->cord;
        vent_line_ = vent_line_length(chute, outline_.vent, outline_.skirt);
        mesh_.vent_held_down = holds_vent_down(chute);
    }

    Mesh at_line_stretch(double payload_mass, const Vec3& axis, double mouth_area, double load) {
        mesh_.axis = axis;
        mesh_.line_stretch = 1.0 + load / (chute_.gores * chute_.line.axial_stiffness());
        const Vec3 across = axis.unitOrthogonal();
        const CanopyNodes shape =
            geometry_.fold(outline_, rows_, {mouth_area, load, mesh_.fabric_of(sheets_.back())});
        if (const double radius = std::hypot(shape.skirt.x(), shape.skirt.y()); radius >= chute_.line_length)
            throw SceneError(
                {}, "parachute.line_length",
                fmt::format("{:.4g} m does not reach from the skirt to the axis", chute_.line_length),
                fmt::format("as the scene begins the skirt has a radius of {:.4g} m", radius),
                "about D0 is common");
        if (!chute_.reefing.empty() && chute_.deploy.by == DeployBy::line_stretch) {
            const int skirt = counts_.gore_rows;
            const double around = chute_.gores * (shape.node(skirt, 1, 0) - shape.node(skirt, 0, 0)).norm();
            if (const double line = chute_.reefing.front().line_length.value_or(around);
                line < around * (1.0 - 1e-6))
                throw SceneError(
                    {}, "parachute.reefing.1.line_length",
                    fmt::format("{:.4g} m does not go around the mouth", line),
                    fmt::format("as the scene begins it is {:.4g} m from seam to seam around the skirt",
                                around),
                    "lengthen the line, or lower initial_drag_area_ratio");
        }
        place_canopy(shape, across, axis.cross(across), mesh_.vent_held_down);
        return build(payload_mass);
    }

    Mesh constructed(double payload_mass) {
        place_canopy(constructed_shape(outline_, rows_), Vec3::UnitX(), Vec3::UnitY(), false);
        return build(payload_mass);
    }

private:
    Mesh build(double payload_mass) {
        sew_gores();
        sew_tapes();
        rig_lines();
        lump_masses(mesh_, payload_mass);
        mesh_.position.shrink_to_fit();
        mesh_.triangles.shrink_to_fit();
        mesh_.cables.shrink_to_fit();
        return std::move(mesh_);
    }

    /// Excess length of the first row of a graded mesh over the last ones [m]: four times the vent's
    /// edge, which suits two elements across. More of them are so much the narrower; where all are narrow for
    /// their height, those at the vent are lengthened in proportion, the same on meshes that are finer by as
    /// much in both directions. At most so much that rows, longer by `all` times that together, give half of
    /// the seam away.
    double excess_of_first(double seam, double all) const {
        if (grading_ == Grading::uniform) return 0.0;
        const double edge_per_radius = 2.0 * std::sin(outline_.half_angle);
        const double width =
            outline_.seam_point(outline_.skirt).radius * edge_per_radius / counts_.gore_columns;
        const double slender = seam / counts_.gore_rows / width;
        const double factor = std::clamp(slender, 1.0, std::max(1.0, 0.5 * counts_.gore_columns));
        return std::min(4.0 * factor * outline_.seam_point(outline_.vent).radius * edge_per_radius,
                        0.5 * seam / all);
    }

    /// Rows from vent to skirt. On a graded mesh elements near the vent are longer than the rest, by less
    /// from row to row: the smaller the width of an element, the longer it has to be to oscillate no faster
    /// than its neighbours.
    void lay_out_rows() {
        const double seam = outline_.skirt - outline_.vent;
        const auto excess = [](int row) { return std::pow(row + 1.0, -1.5); };
        double all = 0.0;
        for (int row = 0; row < counts_.gore_rows; ++row)
            all += excess(row);
        const double first = excess_of_first(seam, all);
        const double plain = (seam - first * all) / counts_.gore_rows;
        double added = 0.0;
        for (int row = 0; row < counts_.gore_rows; ++row) {
            const bool narrow = row == 0 && grading_ == Grading::graded;
            rows_.push_back({outline_.vent + plain * row + added, narrow ? 1 : counts_.gore_columns});
            added += first * excess(row);
        }
        rows_.push_back({outline_.skirt, counts_.gore_columns});
        move_rows_to_corners();
    }

    /// The row nearest to each corner of the cut goes there, the rows between are stretched alike. A gap is
    /// one row.
    void move_rows_to_corners() {
        const int last = counts_.gore_rows, corners = static_cast<int>(outline_.corners.size());
        int before = 0;
        for (int k = 0; k < corners; ++k) {
            const double corner = outline_.corners[static_cast<std::size_t>(k)];
            int nearest = before + 1;
            const bool ends_gap = k > 0 && outline_.in_gap(0.5 * (rows_[before].seam + corner));
            while (!ends_gap && nearest < last - corners + k &&
                   std::abs(rows_[nearest + 1].seam - corner) < std::abs(rows_[nearest].seam - corner))
                ++nearest;
            const double from = rows_[before].seam, to = rows_[nearest].seam;
            for (int row = before + 1; row < nearest; ++row)
                rows_[row].seam = from + (rows_[row].seam - from) * (corner - from) / (to - from);
            for (int row = nearest + 1; row < last; ++row)
                rows_[row].seam = outline_.skirt - (outline_.skirt - rows_[row].seam) *
                                                       (outline_.skirt - corner) / (outline_.skirt - to);
            rows_[nearest].seam = corner;
            before = nearest;
        }
    }

    /// Panel of the fabric below a row.
    std::size_t panel_of(const NodeRow& row) const {
        return static_cast<std::size_t>(
            std::ranges::count_if(outline_.corners, [&](double corner) { return corner <= row.seam; }));
    }

    NodeIndex canopy_node(int gore, int row, int column) const {
        const int columns = rows_[row].columns;
        return mesh_.seam_rings[row].front() + (gore * columns + column) % (chute_.gores * columns);
    }

    /// Share of a suspension line from the skirt to where a vent line is tied to it.
    double joint_share() const {
        return chute_.vent_lines->joint.value_or(chute_.line_length) / chute_.line_length;
    }

    /// Factor on heights above the skirt with which the vent hangs on taut vent lines: 1 where they are long
    /// enough. One linear map of all fabric that lengthens nothing; what it takes off hangs in folds finer
    /// than the mesh.
    double height_share(const CanopyNodes& shape) const {
        const Vec3 vent = shape.node(0, 0, 0);
        const double skirt_radius = std::hypot(shape.skirt.x(), shape.skirt.y()), t = joint_share();
        const double line = mesh_.line_stretch * chute_.line_length;
        const double joint = -t * std::sqrt(line * line - skirt_radius * skirt_radius);  // above the skirt
        const double aside = std::hypot(vent.x(), vent.y()) - (1.0 - t) * skirt_radius;
        const double vent_height =
            joint + std::sqrt(vent_line_ * vent_line_ - aside * aside);  // NaN: too short
        if (!(vent_height > 0.0))
            throw SceneError({}, "parachute.vent_lines.length",
                             fmt::format("lines of {:.4g} m are too short", vent_line_),
                             fmt::format("tied {:.4g} m below the skirt, they would hold the vent below the "
                                         "skirt of the canopy as the scene begins",
                                         t * chute_.line_length),
                             "lengthen them, or tie them nearer to the skirt");
        return std::min(1.0, vent_height / (shape.skirt.z() - vent.z()));
    }

    /// across, along: directions of the shape's x and y. The payload is the origin. held: by vent lines.
    /// Lines that do not reach from the skirt to the axis have no height.
    void place_canopy(const CanopyNodes& shape, const Vec3& across, const Vec3& along, bool held) {
        // Lines are straight and as long as they are: that gives the apex its height.
        const double skirt_radius = std::hypot(shape.skirt.x(), shape.skirt.y());
        const double line = mesh_.line_stretch * chute_.line_length;
        link_height_ = mesh_.line_stretch * chute_.riser_length;
        const double apex = link_height_ +
                            std::sqrt(std::max(0.0, line * line - skirt_radius * skirt_radius)) +
                            shape.skirt.z();
        const double share = held ? height_share(shape) : 1.0, skirt = apex - shape.skirt.z();
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            mesh_.seam_rings.emplace_back();
            for (int gore = 0; gore < chute_.gores; ++gore)
                for (int column = 0; column < rows_[row].columns; ++column) {
                    if (column == 0) mesh_.seam_rings.back().push_back(mesh_.node_count());
                    const Vec3 p = shape.node(static_cast<int>(row), gore, column);
                    const double height =
                        share < 1.0 ? skirt + share * (shape.skirt.z() - p.z()) : apex - p.z();
                    mesh_.position.push_back(height * mesh_.axis + p.x() * across + p.y() * along);
                }
        }
        mesh_.canopy_nodes = mesh_.node_count();
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

    /// Corner at a row and a column line of that row.
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
        std::array<Vec3, 3> cut;
        for (int k = 0; k < 3; ++k) {
            node[k] = canopy_node(gore, corner[k].row, corner[k].column);
            cut[k] << cut_point(outline_, rows_[corner[k].row], corner[k].column), 0.0;
        }
        const int sheet =
            sheets_[static_cast<std::size_t>(std::min({corner[0].row, corner[1].row, corner[2].row}))];
        auto& surface = sheet == no_fabric ? mesh_.gaps : mesh_.triangles;
        surface.emplace_back(laid_flat(node, cut)).sheet = std::max(0, sheet);
    }

    void add_cable(NodeIndex a, NodeIndex b, double length, CableKind kind, double strands) {
        mesh_.cables.push_back({{a, b}, length, strands, kind});
    }

    void sew_tapes() {
        for (const Tape& tape : geometry_.tapes)
            if (tape.line == TapeLine::seam)
                sew_along_seams(tape);
            else
                sew_around(tape, tape.line == TapeLine::skirt ? counts_.gore_rows : 0);
    }

    void sew_along_seams(const Tape& tape) {
        for (int gore = 0; gore < chute_.gores; ++gore)
            for (int row = 0; row < counts_.gore_rows; ++row)
                add_cable(canopy_node(gore, row, 0), canopy_node(gore, row + 1, 0),
                          rows_[row + 1].seam - rows_[row].seam, kind_of(tape.line), tape.strands);
    }

    void sew_around(const Tape& tape, int row) {
        const NodeRow& at = rows_[row];
        for (int gore = 0; gore < chute_.gores; ++gore) {
            for (int column = 0; column < at.columns; ++column)
                add_cable(canopy_node(gore, row, column), canopy_node(gore, row, column + 1),
                          (cut_point(outline_, at, column + 1) - cut_point(outline_, at, column)).norm(),
                          kind_of(tape.line), tape.strands);
            if (tape.line == TapeLine::skirt && !chute_.reefing.empty()) reef(gore);
        }
    }

    /// The reefing line runs through rings on the seams. It is of the skirt tape's material.
    void reef(int gore) {
        mesh_.reefing_line.push_back(mesh_.cables.size());
        add_cable(canopy_node(gore, counts_.gore_rows, 0), canopy_node(gore + 1, counts_.gore_rows, 0),
                  reefing_line_length(chute_, 0) / chute_.gores, CableKind::skirt, 1.0);
    }

    void rig_lines() {
        const int lines_per_riser = chute_.gores / chute_.risers;
        const Vec3 link_place = link_height_ * mesh_.axis;
        // Links follow the lines: what no gore has is at the end.
        const NodeIndex first_link =
            mesh_.node_count() + chute_.gores * (counts_.line_elements - 1 +
                                                 (mesh_.vent_held_down ? vent_line_elements() - 1 : 0));
        std::vector<NodeIndex> joints;
        for (int gore = 0; gore < chute_.gores; ++gore)
            joints.push_back(rig_line(mesh_.seam_rings.back()[gore], first_link + gore / lines_per_riser));
        rig_vent_lines(joints);
        // As many strands as it carries lines, so that a riser is as strong as they are.
        const int tied_to_link = mesh_.vent_held_down && joint_elements() == counts_.line_elements ? 2 : 1;
        hang_risers(mesh_, chute_, counts_, link_place, tied_to_link * lines_per_riser);
    }

    /// Elements of a suspension line from the skirt to the joint of a vent line.
    int joint_elements() const {
        const int all = counts_.line_elements;
        if (!mesh_.vent_held_down || joint_share() == 1.0) return all;
        return std::clamp(static_cast<int>(std::lround(all * joint_share())), 1, all - 1);
    }
    /// Elements of a vent line, about as long as those of a suspension line.
    int vent_line_elements() const {
        return std::max(
            1, static_cast<int>(std::lround(vent_line_ / chute_.line_length * counts_.line_elements)));
    }

    /// A suspension line from the skirt to its link; the node at which a vent line is tied to it.
    NodeIndex rig_line(NodeIndex skirt, NodeIndex link) {
        const Vec3 end = link_height_ * mesh_.axis;
        const int below = counts_.line_elements - joint_elements();
        if (below == 0) {
            add_chain(mesh_, skirt, link, end, chute_.line_length, counts_.line_elements, CableKind::line,
                      1.0);
            return link;
        }
        const double t = joint_share();
        const Vec3 place = (1.0 - t) * mesh_.position[static_cast<std::size_t>(skirt)] + t * end;
        const NodeIndex joint = mesh_.node_count() + joint_elements() - 1;
        add_chain(mesh_, skirt, joint, place, t * chute_.line_length, joint_elements(), CableKind::line, 1.0);
        mesh_.position.push_back(place);
        add_chain(mesh_, joint, link, end, (1.0 - t) * chute_.line_length, below, CableKind::line, 1.0);
        return joint;
    }

    /// joints: of each gore's suspension line.
    void rig_vent_lines(const std::vector<NodeIndex>& joints) {
        if (!chute_.vent_lines) return;
        const std::vector<NodeIndex>& vent = mesh_.seam_rings.front();
        const auto gores = static_cast<std::size_t>(chute_.gores);
        if (!mesh_.vent_held_down) {
            for (std::size_t gore = 0; gore < gores / 2; ++gore)
                add_cable(vent[gore], vent[gore + gores / 2], vent_line_, CableKind::vent_line, 1.0);
            return;
        }
        for (std::size_t gore = 0; gore < gores; ++gore) {
            const bool at_link = joints[gore] >= mesh_.node_count();  // is not placed yet
            const Vec3 end = at_link ? Vec3(link_height_ * mesh_.axis)
                                     : mesh_.position[static_cast<std::size_t>(joints[gore])];
            add_chain(mesh_, vent[gore], joints[gore], end, vent_line_, vent_line_elements(),
                      CableKind::vent_line, 1.0);
        }
    }

    const Parachute& chute_;
    const MeshCounts& counts_;
    const CanopyGeometry& geometry_;
    GoreOutline outline_;
    Grading grading_;
    std::vector<NodeRow> rows_;  // vent to skirt
    std::vector<int> sheets_;    // of the fabric below each row but the last
    Mesh mesh_;
    double link_height_ = 0.0;  // [m] above the payload
    double vent_line_ = 0.0;    // [m] of each, as made
};

}  // namespace

Mesh make_gore_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass, const Vec3& axis,
                    double mouth_area, double load) {
    return Builder(chute, counts).at_line_stretch(payload_mass, axis, mouth_area, load);
}

Grading meshed_grading(const Parachute& chute, const MeshCounts& counts) {
    return has_open_middle(chute) || cross_arm_ratio(chute) > 0.0 ? Grading::uniform : counts.grading;
}

Mesh make_constructed_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass) {
    return Builder(chute, counts).constructed(payload_mass);
}

}  // namespace twinchute::fullsim
