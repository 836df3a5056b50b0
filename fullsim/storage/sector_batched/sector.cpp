#include "fullsim/storage/sector_batched/sector.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace twinchute::fullsim {
namespace {

/// Sectors differ; what() says in what.
struct Unlike : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void require(bool condition, const char* what) {
    if (!condition) throw Unlike(what);
}

bool same(double a, double b) {
    return std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b));
}

class Finder {
public:
    Finder(const Mesh& mesh, const Gores& gores) : mesh_(mesh), gores_(gores) {}

    Sector find() {
        require(mesh_.attachments.empty(), "the payload is a body, which turns as it likes");
        require(mesh_.static_line.cables.empty() && gores_.shared.size() == 1,
                "something but a link holds the gores together");
        collect_risers();
        const int risers = static_cast<int>(risers_.size());
        sector_.gores = risers > 1 ? gores_.count / risers : 1;
        sector_.count = gores_.count / sector_.gores;
        sector_.turn = 2.0 * pi / sector_.count;
        sector_.riser_share = risers > 1 ? 1.0 : 1.0 / sector_.count;
        number_nodes();
        require(mesh_.axis.head<2>().norm() <= 1e-9, "the axis is not vertical");
        for (int s = 1; s < sector_.count; ++s)
            compare_positions(s);
        collect_elements();
        return std::move(sector_);
    }

private:
    /// A link and the nodes from there to the payload.
    struct Riser {
        std::vector<NodeIndex> node;
        std::vector<Cable> cables;
    };

    void collect_risers() {
        for (const Cable& c : gores_.global_cables) {
            const bool starts = std::ranges::count(gores_.shared[0], c.node[0]) > 0;
            if (starts) risers_.push_back({{c.node[0]}, {}});
            require(!risers_.empty() && risers_.back().node.back() == c.node[0], "a riser that branches");
            risers_.back().node.push_back(c.node[1]);
            risers_.back().cables.push_back(c);
        }
        require(!risers_.empty() && gores_.count % static_cast<int>(risers_.size()) == 0,
                "risers that take different numbers of lines");
        const int each = gores_.count / static_cast<int>(risers_.size());
        for (int gore = 0; gore < gores_.count; ++gore)
            require(gores_.shared[0][gore] == risers_[gore / each].node.front(),
                    "lines that are not linked gore by gore");
        const Riser& first = risers_.front();
        for (const Riser& r : risers_) {
            require(r.node.size() == first.node.size() && r.node.back() == mesh_.payload(),
                    "a riser that does not end at the payload");
            for (std::size_t k = 0; k < r.cables.size(); ++k)
                require(same(r.cables[k].rest_length, first.cables[k].rest_length) &&
                            r.cables[k].strands == first.cables[k].strands &&
                            same(mesh_.mass[r.node[k]], mesh_.mass[first.node[k]]),
                        "risers differ");
        }
    }

    /// Nodes of a gore, by column line and row, the seam with its line last: mesh numbers of a column line
    /// have the same distance from their row's seam. (Any order is right; this one is fast.)
    std::vector<LocalNode> gore_order() const {
        struct Inner {
            NodeIndex column;
            std::size_t row;
            LocalNode node;
        };
        std::vector<Inner> inner;
        for (LocalNode n = 0; n < gores_.canopy; ++n) {
            if (std::ranges::count(gores_.neighbour, n)) continue;
            const NodeIndex i = gores_.node[n];
            std::size_t row = 0;
            for (std::size_t r = 0; r < mesh_.seam_rings.size(); ++r)
                if (mesh_.seam_rings[r][0] <= i) row = r;
            inner.push_back({i - mesh_.seam_rings[row][0], row, n});
        }
        std::ranges::sort(inner, [](const Inner& a, const Inner& b) {
            return std::pair(a.column, a.row) < std::pair(b.column, b.row);
        });
        std::vector<LocalNode> order;
        for (const Inner& i : inner)
            order.push_back(i.node);
        order.insert(order.end(), gores_.neighbour.begin(), gores_.neighbour.end());
        for (LocalNode n = gores_.canopy; n < gores_.own; ++n)
            order.push_back(n);
        return order;
    }

    void number_nodes() {
        const std::vector<LocalNode> order = gore_order();
        const std::size_t risers = risers_.size(), riser_nodes = risers_.front().node.size() - 1;
        sector_.own = static_cast<int>(sector_.gores * order.size() + riser_nodes);
        place_.assign(sector_.gores, std::vector<LocalNode>(gores_.own));
        for (int g = 0; g < sector_.gores; ++g)
            for (std::size_t k = 0; k < order.size(); ++k)
                place_[g][order[k]] = static_cast<LocalNode>(g * order.size() + k);
        link_ = static_cast<LocalNode>(sector_.gores * order.size());
        sector_.node.resize(static_cast<std::size_t>(sector_.count) * sector_.own);
        for (int s = 0; s < sector_.count; ++s) {
            NodeIndex* const node = sector_.node.data() + static_cast<std::size_t>(s) * sector_.own;
            for (int g = 0; g < sector_.gores; ++g)
                for (LocalNode n = 0; n < gores_.own; ++n)
                    node[place_[g][n]] = gores_.node[(s * sector_.gores + g) * gores_.own + n];
            for (std::size_t k = 0; k < riser_nodes; ++k)
                node[link_ + k] = risers_[risers > 1 ? s : 0].node[k];
        }
        sector_.on_axis.assign(sector_.own, false);
        if (risers == 1) std::fill(sector_.on_axis.begin() + link_, sector_.on_axis.end(), true);
        for (const LocalNode n : gores_.neighbour)
            sector_.seam.push_back(place_[0][n]);
    }

    void compare_positions(int s) const {
        const Eigen::AngleAxisd turned(s * sector_.turn, Vec3::UnitZ());
        const double extent = mesh_.position[sector_.node[0]].norm();
        for (LocalNode n = 0; n < sector_.own; ++n) {
            const Vec3 here = mesh_.position[sector_.node[s * sector_.own + n]];
            require((here - turned * mesh_.position[sector_.node[n]]).norm() <= 1e-9 * extent,
                    "nodes do not lie around the axis");
        }
    }

    /// A node of the sector as its gore `g` calls it.
    LocalNode local(int g, LocalNode n) const {
        if (n < gores_.own) return place_[g][n];
        const auto k = static_cast<std::size_t>(n - gores_.own);
        if (k >= gores_.neighbour.size()) return link_;
        return g + 1 < sector_.gores ? place_[g + 1][gores_.neighbour[k]]
                                     : sector_.first_halo() + static_cast<LocalNode>(k);
    }

    void collect_elements() {
        for (int g = 0; g < sector_.gores; ++g) {
            for (GoreTriangle t : gores_.triangles) {
                for (LocalNode& n : t.node)
                    n = local(g, n);
                sector_.triangles.push_back(t);
            }
            for (GoreCable c : gores_.cables) {
                for (LocalNode& n : c.node)
                    n = local(g, n);
                sector_.cables.push_back(c);
            }
        }
        LocalNode node = link_;
        for (const Cable& c : risers_.front().cables) {
            sector_.cables.push_back(
                {{node, node + 1}, c.rest_length, sector_.riser_share * c.strands, c.kind});
            ++node;
        }
    }

    const Mesh& mesh_;
    const Gores& gores_;
    std::vector<Riser> risers_;
    std::vector<std::vector<LocalNode>> place_;  // [gore][as the gore numbers it]
    LocalNode link_ = 0;
    Sector sector_;
};

}  // namespace

std::optional<Sector> find_sector(const Mesh& mesh, std::string* why) {
    const auto gores = find_gores(mesh, why);
    if (!gores) return std::nullopt;
    try {
        return Finder(mesh, *gores).find();
    } catch (const Unlike& difference) {
        if (why) *why = difference.what();
        return std::nullopt;
    }
}

}  // namespace twinchute::fullsim
