#include "fullsim/mesh/gores.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

namespace twinchute::fullsim {
namespace {

/// Gores differ; what() says in what.
struct Unlike : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void require(bool condition, std::string_view what) {
    if (!condition) throw Unlike(std::string(what));
}

bool same(double a, double b) {
    return std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b));
}

class Finder {
public:
    explicit Finder(const Mesh& mesh) : mesh_(mesh), place_(mesh.position.size()) {}

    Gores find() {
        require(!mesh_.seam_rings.empty(), "there are no seams");
        gores_.count = static_cast<int>(mesh_.seam_rings.front().size());
        require(std::ranges::find(mesh_.cables, CableKind::vent_line, &Cable::kind) == mesh_.cables.end(),
                "vent lines tie seams to lines or to each other");
        require(mesh_.other_fabrics.empty(), "panels have fabrics of their own");
        require(gores_.count >= 3, "fewer than three gores are each other's neighbours on both sides");
        number_canopy();
        number_lines();
        collect_global();
        for (int gore = 0; gore < gores_.count; ++gore)
            compare_nodes(gore);
        // Triangles and cables follow each other gore by gore, as the generator sews them.
        gores_.triangles =
            alike<GoreTriangle>(mesh_.triangles, "triangles", [&](const Triangle& t, int gore) {
                GoreTriangle local{{}, t.a, t.b, t.c};
                for (int k = 0; k < 3; ++k)
                    local.node[k] = local_node(t.node[k], gore);
                return local;
            });
        for (const CableKind kind : {CableKind::radial, CableKind::skirt, CableKind::vent, CableKind::line})
            std::ranges::copy(cables(of_kind(mesh_.cables, kind)), std::back_inserter(gores_.cables));
        require_one_line();
        number_static_line();
        number_edges();
        return std::move(gores_);
    }

private:
    struct Place {
        int gore = -1;  // none: global structure
        LocalNode local = -1;
    };

    static std::vector<Cable> of_kind(const std::vector<Cable>& cables, CableKind kind) {
        std::vector<Cable> some;
        std::ranges::copy_if(cables, std::back_inserter(some),
                             [&](const Cable& c) { return c.kind == kind; });
        return some;
    }

    /// Elements of a gore, of all that there are.
    int share(std::size_t all, std::string_view what) const {
        require(all % gores_.count == 0, fmt::format("{} {} on {} gores", all, what, gores_.count));
        return static_cast<int>(all) / gores_.count;
    }

    void give(NodeIndex node, int gore, LocalNode local) {
        require(place_[node].gore < 0, "a node lies in two gores");
        place_[node] = {gore, local};
    }

    /// Nodes in the order in which the gore's triangles meet them, the next gore's seam left out.
    void number_canopy() {
        const int each = share(mesh_.triangles.size(), "triangles");
        std::vector<int> seam_of(mesh_.position.size(), -1);
        for (const auto& ring : mesh_.seam_rings) {
            require(static_cast<int>(ring.size()) == gores_.count, "a ring without a seam node in each gore");
            for (int gore = 0; gore < gores_.count; ++gore)
                seam_of[ring[gore]] = gore;
        }
        std::vector<std::vector<NodeIndex>> met(gores_.count);
        std::vector<bool> taken(mesh_.position.size(), false);
        for (int gore = 0; gore < gores_.count; ++gore)
            for (int k = 0; k < each; ++k)
                for (const NodeIndex i : mesh_.triangles[gore * each + k].node) {
                    if (taken[i] || (seam_of[i] >= 0 && seam_of[i] != gore)) continue;
                    taken[i] = true;
                    met[gore].push_back(i);
                }
        // Lines end on the skirt's seam: that node last, so that those before it know nothing of lines.
        for (int gore = 0; gore < gores_.count; ++gore) {
            auto& nodes = met[gore];
            const auto skirt = std::ranges::find(nodes, mesh_.seam_rings.back()[gore]);
            require(skirt != nodes.end(), "a gore without its seam");
            std::rotate(skirt, skirt + 1, nodes.end());
        }
        gores_.canopy = static_cast<int>(met[0].size());
        gores_.inner = gores_.canopy - 1;
        for (int gore = 0; gore < gores_.count; ++gore) {
            require(static_cast<int>(met[gore].size()) == gores_.canopy, "gores of different nodes");
            for (LocalNode k = 0; k < gores_.canopy; ++k)
                give(met[gore][k], gore, k);
        }
        own_.resize(gores_.count);
        for (int gore = 0; gore < gores_.count; ++gore)
            own_[gore] = std::move(met[gore]);
    }

    /// Numbers the nodes of lines: a node that only the line of one gore touches is the gore's own.
    void number_lines() {
        const auto lines = of_kind(mesh_.cables, CableKind::line);
        const int each = share(lines.size(), "line elements");
        constexpr int nobody = -1, shared = -2;
        std::vector<int> user(mesh_.position.size(), nobody);
        for (int gore = 0; gore < gores_.count; ++gore)
            for (int k = 0; k < each; ++k)
                for (const NodeIndex i : lines[gore * each + k].node)
                    user[i] = user[i] == nobody || user[i] == gore ? gore : shared;
        for (const Cable& c : mesh_.cables)
            if (c.kind == CableKind::riser)
                for (const NodeIndex i : c.node)
                    if (i < mesh_.node_count()) user[i] = shared;
        for (int gore = 0; gore < gores_.count; ++gore)
            for (int k = 0; k < each; ++k)
                for (const NodeIndex i : lines[gore * each + k].node)
                    if (user[i] == gore && place_[i].gore < 0) {
                        give(i, gore, static_cast<LocalNode>(own_[gore].size()));
                        own_[gore].push_back(i);
                    }
        for (const Cable& c : lines)
            for (const NodeIndex i : c.node)
                require(!mesh_.is_canopy(i) || place_[i].local >= gores_.inner,
                        "a line that ends within the canopy");
        gores_.own = static_cast<int>(own_[0].size());
        for (const auto& nodes : own_) {
            require(static_cast<int>(nodes.size()) == gores_.own, "lines of different nodes");
            gores_.node.insert(gores_.node.end(), nodes.begin(), nodes.end());
        }
    }

    /// From the skirt through all of the gore's nodes that are not of the canopy, in their order.
    void require_one_line() const {
        const auto first_shared = static_cast<LocalNode>(gores_.own + gores_.neighbour.size());
        LocalNode here = gores_.inner;
        for (const GoreCable& c : gores_.cables) {
            if (is_tape(c.kind)) continue;
            require(c.node[0] == here && here < gores_.own, "lines that do not run from the skirt down");
            here = c.node[1];
            require((here == c.node[0] + 1 && here < gores_.own) || here >= first_shared,
                    "lines that do not run from node to node");
        }
        require(here >= first_shared, "lines that do not end at a link");
    }

    void collect_global() {
        for (NodeIndex i = 0; i < mesh_.node_count(); ++i)
            if (place_[i].gore < 0) gores_.global.push_back(i);
        gores_.global_cables = of_kind(mesh_.cables, CableKind::riser);
        for (const Cable& c : gores_.global_cables)
            for (const NodeIndex i : c.node)
                require(i >= mesh_.node_count() || place_[i].gore < 0, "a riser that ends on a gore");
        // First all that gores see of each other, so that no number depends on what comes later.
        for (const auto& ring : mesh_.seam_rings)
            gores_.neighbour.push_back(place_[ring[0]].local);
    }

    void compare_nodes(int gore) const {
        for (LocalNode k = 0; k < gores_.own; ++k) {
            const NodeIndex here = own_[gore][k], there = own_[0][k];
            require(same(mesh_.mass[here], mesh_.mass[there]), "nodes of different mass");
            if (mesh_.is_canopy(here) && mesh_.is_canopy(there))
                require(same(mesh_.tributary_area[here], mesh_.tributary_area[there]),
                        "nodes of different area");
        }
    }

    /// A node as `gore` numbers it. The number of a shared one differs from gore to gore.
    LocalNode local_node(NodeIndex node, int gore) {
        const Place at = node < mesh_.node_count() ? place_[node] : Place{};
        if (at.gore == gore) return at.local;
        if (at.gore < 0) return shared(node, gore);
        require(at.gore == (gore + 1) % gores_.count, "an element reaches beyond the next gore");
        const auto seam = std::ranges::find(gores_.neighbour, at.local);
        require(seam != gores_.neighbour.end(), "an element reaches across a seam");
        return gores_.own + static_cast<LocalNode>(seam - gores_.neighbour.begin());
    }

    LocalNode shared(NodeIndex node, int gore) {
        const auto first = static_cast<LocalNode>(gores_.own + gores_.neighbour.size());
        for (std::size_t k = 0; k < gores_.shared.size(); ++k)
            if (gores_.shared[k][gore] == node) return first + static_cast<LocalNode>(k);
        // Every gore counts its shared nodes in the order in which it meets them: the k-th of one is the k-th
        // of all.
        std::size_t k = 0;
        while (k < gores_.shared.size() && gores_.shared[k][gore] >= 0)
            ++k;
        if (k == gores_.shared.size()) gores_.shared.emplace_back(gores_.count, NodeIndex{-1});
        gores_.shared[k][gore] = node;
        return first + static_cast<LocalNode>(k);
    }

    static bool equal(const GoreTriangle& a, const GoreTriangle& b) {
        return a.node == b.node && same(a.a, b.a) && std::abs(a.b - b.b) <= 1e-12 * a.a && same(a.c, b.c);
    }
    static bool equal(const GoreCable& a, const GoreCable& b) {
        return a.node == b.node && same(a.rest_length, b.rest_length) && a.strands == b.strands;
    }
    static bool equal(const GoreEdge& a, const GoreEdge& b) {
        return a.node == b.node && same(a.rest_length, b.rest_length) && same(a.section, b.section) &&
               same(a.hardening, b.hardening);
    }

    /// The elements of one gore, after a look at those of all.
    template <class Local, class Element, class Localise>
    std::vector<Local> alike(const std::vector<Element>& all, std::string_view what, Localise&& localise) {
        const int each = share(all.size(), what);
        std::vector<Local> first;
        for (int gore = 0; gore < gores_.count; ++gore)
            for (int k = 0; k < each; ++k) {
                const Local local = localise(all[gore * each + k], gore);
                if (gore == 0)
                    first.push_back(local);
                else
                    require(equal(local, first[k]), fmt::format("{} differ from gore to gore", what));
            }
        return first;
    }

    std::vector<GoreCable> cables(const std::vector<Cable>& all) {
        return alike<GoreCable>(all, "cables", [&](const Cable& c, int gore) {
            return GoreCable{
                {local_node(c.node[0], gore), local_node(c.node[1], gore)}, c.rest_length, c.strands, c.kind};
        });
    }

    void number_static_line() {
        std::vector<Cable> cords;
        for (const Cable& c : mesh_.static_line.cables)
            (c.node[0] < mesh_.node_count() ? cords : gores_.global_static_line).push_back(c);
        gores_.static_line = cables(cords);
    }

    /// Edges come sorted by node, which no gore shares with the next: sorted again by local node.
    void number_edges() {
        std::vector<std::vector<GoreEdge>> of(gores_.count);
        for (const FabricEdge& e : fabric_edges(mesh_)) {
            const int a = place_[e.node[0]].gore, b = place_[e.node[1]].gore;
            const bool in_a = b == a || b == (a + 1) % gores_.count;
            const int gore = in_a ? a : b;
            GoreEdge local{{local_node(e.node[0], gore), local_node(e.node[1], gore)},
                           e.rest_length,
                           e.section,
                           e.hardening};
            // An edge on the seam to the next gore is the next gore's own.
            if (local.node[0] > local.node[1]) std::swap(local.node[0], local.node[1]);
            of[gore].push_back(local);
        }
        std::vector<GoreEdge> all;
        for (auto& edges : of) {
            std::ranges::sort(edges, {}, &GoreEdge::node);
            require(edges.size() == of[0].size(), "edges differ from gore to gore");
            all.insert(all.end(), edges.begin(), edges.end());
        }
        gores_.edges = alike<GoreEdge>(all, "edges", [](const GoreEdge& e, int) { return e; });
    }

    const Mesh& mesh_;
    std::vector<Place> place_;  // of each node of the mesh
    std::vector<std::vector<NodeIndex>> own_;
    Gores gores_;
};

}  // namespace

std::optional<Gores> find_gores(const Mesh& mesh, std::string* why) {
    try {
        return Finder(mesh).find();
    } catch (const Unlike& difference) {
        if (why) *why = difference.what();
        return std::nullopt;
    }
}

}  // namespace twinchute::fullsim
