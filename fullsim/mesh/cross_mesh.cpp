#include "fullsim/mesh/cross_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fullsim/canopy/cross.hpp"
#include "fullsim/mesh/rigging.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {
namespace {

constexpr int arms = 4;

class CrossBuilder {
public:
    CrossBuilder(const Parachute& chute, const MeshCounts& counts)
        : chute_(chute),
          counts_(counts),
          outline_(cross_outline(chute)),
          columns_((outline_.lines - 1) * counts.gore_columns),
          rows_(counts.gore_rows) {
        for (const std::size_t panel : {0, 1})
            sheet_[panel] = sheet_of(mesh_, meshed_fabric(chute, panel));
        mesh_.cords = {chute.tapes.radial, chute.tapes.skirt, chute.line, chute.line,
                       chute.line,         chute.line,        chute.line};
    }

    ImportedMesh build(double payload_mass) {
        place_canopy();
        sew_fabric();
        sew_tapes();
        rig_lines();
        lump_masses(mesh_, payload_mass);
        out_.nominal_area = mesh_.fabric_area();
        out_.mesh = std::move(mesh_);
        return std::move(out_);
    }

private:
    /// Node of the middle square, by its columns along x and y.
    NodeIndex square(int i, int j) const { return i * (columns_ + 1) + j; }

    /// Node of an arm: rows from the square's side, 0, outward, columns in the direction of rising azimuth.
    NodeIndex node(int arm, int row, int column) const {
        const int n = columns_;
        if (row == 0)
            return arm == 0   ? square(n, column)
                   : arm == 1 ? square(n - column, n)
                   : arm == 2 ? square(0, n - column)
                              : square(column, 0);
        return (n + 1) * (n + 1) + ((arm * rows_ + row - 1) * (n + 1) + column);
    }

    void place_canopy() {
        const int n = columns_;
        const double w = outline_.width, open = 0.5 * (outline_.length - w);
        const double corner = std::hypot(0.5 * w, 0.5 * outline_.length), line = chute_.line_length;
        const double height = chute_.riser_length + std::sqrt(std::max(0.0, line * line - corner * corner));
        const auto across = [&](int column) { return (column - 0.5 * n) * w / n; };
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n; ++j)
                mesh_.position.emplace_back(across(i), across(j), height);
        for (int arm = 0; arm < arms; ++arm)
            for (int row = 1; row <= rows_; ++row)
                for (int column = 0; column <= n; ++column) {
                    const double x = 0.5 * w + open * row / rows_, y = across(column);
                    const double turned[arms][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
                    mesh_.position.emplace_back(turned[arm][0], turned[arm][1], height);
                }
        mesh_.canopy_nodes = mesh_.node_count();

        mesh_.seam_rings.push_back({square(n / 2, n / 2)});
        for (int row = 0; row <= rows_; ++row) {
            std::vector<NodeIndex>& ring = mesh_.seam_rings.emplace_back();
            for (int arm = 0; arm < arms; ++arm)
                for (int k = 0; k < outline_.lines; ++k)
                    ring.push_back(node(arm, row, k * counts_.gore_columns));
        }
    }

    void sew_fabric() {
        const int n = columns_, half = n / 2;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                sew_cell({square(i, j), square(i + 1, j), square(i + 1, j + 1), square(i, j + 1)},
                         (i < half) == (j < half), sheet_[0]);
        for (int arm = 0; arm < arms; ++arm)
            for (int row = 0; row < rows_; ++row)
                for (int column = 0; column < n; ++column)
                    sew_cell({node(arm, row, column), node(arm, row + 1, column),
                              node(arm, row + 1, column + 1), node(arm, row, column + 1)},
                             column >= half, sheet_[1]);
    }

    /// Counter-clockwise; the diagonal leads from the first corner, or from the second.
    void sew_cell(const std::array<NodeIndex, 4>& q, bool from_first, int sheet) {
        const int split[2][2][3] = {{{0, 1, 3}, {1, 2, 3}}, {{0, 1, 2}, {0, 2, 3}}};
        for (const auto& corner : split[from_first ? 1 : 0]) {
            const std::array<NodeIndex, 3> at{q[corner[0]], q[corner[1]], q[corner[2]]};
            mesh_.triangles.push_back(laid_flat(at, {position(at[0]), position(at[1]), position(at[2])}));
            mesh_.triangles.back().sheet = sheet;
        }
    }

    const Vec3& position(NodeIndex i) const { return mesh_.position[static_cast<std::size_t>(i)]; }

    /// From node to node, as long as they lie apart.
    void sew_tape(const std::vector<NodeIndex>& nodes, CableKind kind) {
        for (std::size_t k = 1; k < nodes.size(); ++k)
            mesh_.cables.push_back(
                {{nodes[k - 1], nodes[k]}, (position(nodes[k]) - position(nodes[k - 1])).norm(), 1.0, kind});
    }

    void sew_tapes() {
        const int n = columns_;
        for (const int arm : {0, 1})  // and the one opposite
            for (int k = 0; k < outline_.lines; ++k) {
                const int column = k * counts_.gore_columns;
                std::vector<NodeIndex> along;
                for (int row = rows_; row > 0; --row)
                    along.push_back(node(arm, row, column));
                for (int i = 0; i <= n; ++i)
                    along.push_back(arm == 0 ? square(n - i, column) : square(n - column, n - i));
                for (int row = 1; row <= rows_; ++row)
                    along.push_back(node(arm + 2, row, n - column));
                sew_tape(along, CableKind::radial);
            }
        for (int arm = 0; arm < arms; ++arm) {
            std::vector<NodeIndex> around;
            for (int row = 0; row < rows_; ++row)
                around.push_back(node(arm, row, 0));
            for (int column = 0; column <= n; ++column)
                around.push_back(node(arm, rows_, column));
            for (int row = rows_ - 1; row >= 0; --row)
                around.push_back(node(arm, row, n));
            sew_tape(around, CableKind::skirt);
            mesh_.cables.push_back({{node(arm, rows_, n), node((arm + 1) % arms, rows_, 0)},
                                    outline_.tie,
                                    1.0,
                                    CableKind::skirt});
        }
    }

    void rig_lines() {
        const std::vector<NodeIndex>& feet = mesh_.seam_rings.back();
        const int elements = counts_.line_elements, lines = static_cast<int>(feet.size());
        const int lines_per_riser = lines / chute_.risers;
        const Vec3 link_place(0.0, 0.0, chute_.riser_length);
        const NodeIndex first_link = mesh_.node_count() + lines * (elements - 1);
        for (int k = 0; k < lines; ++k) {
            const NodeIndex foot = feet[static_cast<std::size_t>(k)], link = first_link + k / lines_per_riser;
            ImportedLine& line = out_.lines.emplace_back();
            line.piece.assign(static_cast<std::size_t>(elements), chute_.line_length / elements);
            line.node.push_back(foot);
            for (int i = 0; i + 1 < elements; ++i)
                line.node.push_back(mesh_.node_count() + i);
            line.node.push_back(link);
            add_chain(mesh_, foot, link, link_place, chute_.line_length, elements, CableKind::line, 1.0);
        }
        hang_risers(mesh_, chute_, counts_, link_place, lines_per_riser);
    }

    const Parachute& chute_;
    const MeshCounts& counts_;
    const CrossOutline outline_;
    const int columns_, rows_;  // elements across an arm, along it
    int sheet_[2] = {0, 0};     // of the middle square and of the arms
    Mesh mesh_;
    ImportedMesh out_;
};

}  // namespace

ImportedMesh make_cross_mesh(const Parachute& chute, const MeshCounts& counts, double payload_mass) {
    return CrossBuilder(chute, counts).build(payload_mass);
}

}  // namespace twinchute::fullsim
