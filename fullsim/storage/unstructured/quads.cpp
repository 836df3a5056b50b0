#include "fullsim/storage/unstructured/quads.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

namespace twinchute::fullsim::unstructured {
namespace {

/// An edge as one triangle has it.
struct Side {
    NodeIndex low, high;
    std::size_t triangle;
    int corner;   // where it begins
    bool rising;  // from low to high
};

/// A triangle on the other side of an edge.
struct Neighbour {
    std::size_t triangle;
    int mine, theirs;  // corners where the edge begins
};
using Neighbours = std::array<std::optional<Neighbour>, 3>;

std::size_t at(int k) {
    return static_cast<std::size_t>(k % 3);
}

/// The triangle with another corner first.
Triangle turned(const Triangle& t, int first) {
    if (first == 0) return t;
    const std::array<std::array<double, 2>, 3> corner{{{0.0, 0.0}, {t.a, 0.0}, {t.b, t.c}}};
    const auto &p = corner[at(first)], &q = corner[at(first + 1)], &r = corner[at(first + 2)];
    const double x = q[0] - p[0], y = q[1] - p[1], a = std::hypot(x, y);
    return {{t.node[at(first)], t.node[at(first + 1)], t.node[at(first + 2)]},
            t.sheet,
            a,
            (x * (r[0] - p[0]) + y * (r[1] - p[1])) / a,
            t.a * t.c / a};
}

/// By edge. Where more than two triangles meet, or two that turn against each other, some have none.
std::vector<Neighbours> neighbours_of(const std::vector<Triangle>& triangles) {
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const NodeIndex from = triangles[i].node[at(c)], to = triangles[i].node[at(c + 1)];
            sides.push_back({std::min(from, to), std::max(from, to), i, c, from < to});
        }
    std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.low, s.high, s.triangle); });
    std::vector<Neighbours> all(triangles.size());
    for (std::size_t k = 0; k + 1 < sides.size(); ++k) {
        const Side &s = sides[k], &t = sides[k + 1];
        if (s.low != t.low || s.high != t.high || s.rising == t.rising) continue;
        all[s.triangle][at(s.corner)] = {t.triangle, s.corner, t.corner};
        all[t.triangle][at(t.corner)] = {s.triangle, t.corner, s.corner};
        ++k;
    }
    return all;
}

}  // namespace

std::vector<Quad> quads_of(const std::vector<Triangle>& triangles) {
    const std::vector<Neighbours> neighbours = neighbours_of(triangles);
    std::vector<int> choices;  // neighbours that are free
    for (const Neighbours& n : neighbours)
        choices.push_back(static_cast<int>(std::ranges::count_if(n, [](const auto& m) { return !!m; })));
    std::vector<bool> taken(triangles.size(), false);
    const auto take = [&](std::size_t i) {
        taken[i] = true;
        for (const auto& n : neighbours[i])
            if (n) --choices[n->triangle];
    };
    std::vector<Quad> quads;
    quads.reserve(triangles.size() / 2 + 1);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (taken[i]) continue;
        take(i);
        const Neighbour* partner = nullptr;  // which has the fewest others
        for (const auto& n : neighbours[i])
            if (n && !taken[n->triangle] && (!partner || choices[n->triangle] < choices[partner->triangle]))
                partner = &*n;
        if (!partner) {
            const Triangle& t = triangles[i];
            quads.push_back({{t.node[0], t.node[1], t.node[2], t.node[0]}, t, {}});
            continue;
        }
        take(partner->triangle);
        // Their edge leads from corner 2 to corner 0 of the first and from 0 to 1 of the second.
        const Triangle first = turned(triangles[i], partner->mine + 1),
                       second = turned(triangles[partner->triangle], partner->theirs);
        quads.push_back({{first.node[0], first.node[1], first.node[2], second.node[2]}, first, second});
    }
    std::ranges::stable_sort(quads, {}, [](const Quad& q) { return *std::ranges::min_element(q.node); });
    return quads;
}

std::vector<Quad> quads_of(const Mesh& mesh, int sheet) {
    std::vector<Triangle> triangles;
    std::ranges::copy_if(mesh.triangles, std::back_inserter(triangles),
                         [sheet](const Triangle& t) { return t.sheet == sheet; });
    return quads_of(triangles);
}

Parts::Parts(const Mesh& mesh) : ends_{mesh.canopy_nodes} {
    // A step waits for all threads three times.
    constexpr std::size_t triangles_of_part = 2000, most = 8;
    if (mesh.triangles.size() < 2 * triangles_of_part) return;
    struct Reach {
        NodeIndex lowest, highest;
    };
    std::vector<Reach> quads;
    for (int sheet = 0; sheet < mesh.sheets(); ++sheet)
        for (const Quad& q : quads_of(mesh, sheet))
            quads.push_back({std::ranges::min(q.node), std::ranges::max(q.node)});
    std::ranges::sort(quads, {}, &Reach::lowest);
    for (std::size_t parts = most; parts > 1 && ends_.size() == 1; parts /= 2) {
        if (mesh.triangles.size() < parts * triangles_of_part) continue;
        std::vector<NodeIndex> ends;
        for (std::size_t k = 1; k < parts; ++k)
            ends.push_back(quads[k * quads.size() / parts].lowest);
        ends.push_back(mesh.canopy_nodes);
        // Where no part is narrower than what lies across its ends, strips have no node in common, either;
        // two parts may be all strip.
        std::size_t across = 0;
        std::vector<NodeIndex> strip_begins(parts, mesh.canopy_nodes), strip_ends(parts, 0);
        for (const auto [lowest, highest] : quads) {
            const auto part = std::ranges::upper_bound(ends, lowest) - ends.begin();
            if (highest < ends[part]) continue;
            ++across;
            strip_begins[part] = std::min(strip_begins[part], lowest);
            strip_ends[part] = std::max(strip_ends[part], highest + 1);
        }
        bool apart = 4 * across < quads.size();
        for (std::size_t k = 0; k + 1 < parts; ++k)
            apart = apart && strip_ends[k] <= std::min(strip_begins[k + 1], ends[k + 1]);
        if (apart) ends_ = ends;
    }
}

std::size_t Parts::list_of(const Quad& quad) const {
    const auto [lowest, highest] = std::ranges::minmax(quad.node);
    const auto part = std::ranges::upper_bound(ends_, lowest) - ends_.begin();
    return static_cast<std::size_t>(part) + (highest < ends_[part] ? 0 : count());
}

}  // namespace twinchute::fullsim::unstructured
