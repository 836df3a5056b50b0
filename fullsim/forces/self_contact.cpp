// Self-contact: nodes of fabric and lines do not pass through triangles of fabric.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fullsim/forces/registry.hpp"
#include "fullsim/laws/self_contact.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {
namespace {

/// Choices of this toolkit (docs/theory/full-model.md).
constexpr double stiffness_share = 0.5;   // of the fabric's E t
constexpr double thickness_share = 0.03;  // of a triangle's edge
constexpr double thickness_now = 0.25;    // at most, of its longest edge as it is: a pack is small
constexpr double damping_share = 0.5;     // of sqrt(k m): viscosity of friction where slip is slow
constexpr double skin_share = 0.15;       // of the mean longest edge, from one search to the next
constexpr double touching = 1e-3;         // of the thickness: nearer than that a node has no side yet
constexpr double sliver = 0.3;            // area over longest edge squared, over the same without strain
constexpr double entering = 0.02;         // window below which a node has just come over the triangle
/// Shortening of a distance to a triangle's window per distance that nodes have moved: by the node, and by a
/// corner of the window, (1 + 2 e, -e, -e) of the triangle's.
constexpr double closing = 2.0 + 4.0 * window_half_width;

double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    // Ericson, Real-time collision detection, 5.1.5.
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return ap.squaredNorm();
    const Vec3 bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return bp.squaredNorm();
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
    const Vec3 cp = p - c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return cp.squaredNorm();
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
        return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
    const double sum = va + vb + vc;
    return (ap - (vb / sum) * ab - (vc / sum) * ac).squaredNorm();
}

class SelfContact final : public ForceModel {
public:
    SelfContact(const Mesh& mesh, double friction)
        : mesh_(mesh),
          friction_(friction),
          stiffness_(stiffness_share * mesh.fabric.youngs_modulus * mesh.fabric.thickness),
          neighbours_(static_cast<std::size_t>(mesh.node_count())) {
        const auto join = [&](NodeIndex a, NodeIndex b) {
            if (std::max(a, b) >= mesh_.node_count()) return;
            neighbours_[a].push_back(b);
            neighbours_[b].push_back(a);
        };
        for (const Triangle& t : mesh.triangles)
            for (int i = 0; i < 3; ++i)
                join(t.node[i], t.node[(i + 1) % 3]);
        for (const Triangle& t : mesh.triangles)
            fullness_.push_back(
                sliver * t.a * t.c /
                longest_edge_squared({Vec3(), {Vec3::Zero(), Vec3(t.a, 0.0, 0.0), Vec3(t.b, t.c, 0.0)}}));
        for (const Cable& c : mesh.cables)
            join(c.node[0], c.node[1]);
        for (auto& near : neighbours_) {
            std::ranges::sort(near);
            near.erase(std::unique(near.begin(), near.end()), near.end());
            near.shrink_to_fit();
        }
    }

    Block block() const override { return Block::self_contact; }
    std::size_t bytes() const override {
        std::size_t bytes = bytes_of(neighbours_) + bytes_of(fullness_);
        for (const auto& near : neighbours_)
            bytes += bytes_of(near);
        return bytes;
    }

    void add_forces(State& state) const override {
        SelfContactState& contact = state.contact;
        double closer = closer_since_search(state);
        if (contact.searched_at.empty() || closer > contact.skin) {
            search(state);
            closer = 0.0;
        }
        const NodeForces::View force = state.force.view();
        for (const std::int32_t k : contact.by_slack) {
            NearPair& pair = contact.pairs[k];
            if (pair.slack > closer) break;
            const auto at = where(state, pair);
            if (!at) {
                if (pair.side != 0) let_go(state, pair);
                continue;
            }
            if (at->window <= 0.0) {
                pair.side = 0;
                continue;
            }
            const double thickest = thickness_of(state, pair.triangle);
            if (pair.side == 0) {
                if (!decide(state, k, *at, thickest)) continue;
                state.energy.ramp += energy_of(state, pair);  // of a node that a neighbour hands over
            }
            const double overlap = overlap_of(*at, pair.side, pair.thickness);
            if (overlap <= 0.0) {
                pair.thickness = std::max(pair.thickness, std::min(thickest, pair.side * at->gap));
                continue;
            }
            if (at->window > 0.5)
                contact.deepest =
                    std::max(contact.deepest, (overlap - pair.thickness) / edge_of(pair.triangle));
            const Triangle& t = mesh_.triangles[pair.triangle];
            const SelfContactForce f =
                self_contact_force(law_of(pair), *at, pair.side, overlap, velocities(state, pair));
            force[pair.node].value += to_lanes(f.on.node);
            for (int i = 0; i < 3; ++i)
                force[t.node[i]].value += to_lanes(f.on.corner[i]);
            state.damping_power += f.dissipated;
        }
    }

    /// Counts pairs that touch, and those that are within another thickness of it.
    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        for (const NearPair& pair : state.contact.pairs) {
            const auto at = where(state, pair);
            if (!at || at->window <= 0.0) continue;
            const double thickness = std::max(pair.thickness, thickness_share * edge_of(pair.triangle));
            if ((pair.side == 0 ? std::abs(at->gap) : pair.side * at->gap) > 2.0 * thickness) continue;
            const double overlap =
                pair.side == 0 ? 0.0 : std::max(0.0, overlap_of(*at, pair.side, pair.thickness));
            const double steepest =
                std::sqrt(std::max({at->gradient[0].squaredNorm(), at->gradient[1].squaredNorm(),
                                    at->gradient[2].squaredNorm()}));
            const SelfContactLaw law = law_of(pair);
            const double stiffness = (1.0 + friction_) * self_contact_tangent(stiffness_, overlap, steepest);
            const double damping = friction_ > 0.0 ? law.viscosity : 0.0;
            const Triangle& t = mesh_.triangles[pair.triangle];
            const std::array<NodeIndex, 4> node{pair.node, t.node[0], t.node[1], t.node[2]};
            const std::array<double, 4> share{1.0, std::abs(at->share[0]), std::abs(at->share[1]),
                                              std::abs(at->share[2])};
            for (int i = 0; i < 4; ++i) {
                double columns = 0.0;
                for (int j = 0; j < 4; ++j)
                    columns += share[j] * sums.over(node[j], node[i]);
                sums.stiffness[node[i]] += share[i] * columns * stiffness;
                sums.damping[node[i]] += share[i] * columns * damping;
            }
        }
    }

    double energy(const State& state) const override {
        double total = 0.0;
        for (const NearPair& pair : state.contact.pairs)
            total += energy_of(state, pair);
        return total;
    }

private:
    static Vec3 place(const State& state, NodeIndex i) { return to_vec3(state.node[i].x); }
    NodeAndTriangle places(const State& state, const NearPair& pair) const {
        const auto& n = mesh_.triangles[pair.triangle].node;
        return {place(state, pair.node), {place(state, n[0]), place(state, n[1]), place(state, n[2])}};
    }
    NodeAndTriangle velocities(const State& state, const NearPair& pair) const {
        const auto& n = mesh_.triangles[pair.triangle].node;
        const auto v = [&](NodeIndex i) { return to_vec3(state.node[i].v); };
        return {v(pair.node), {v(n[0]), v(n[1]), v(n[2])}};
    }
    static double longest_edge_squared(const NodeAndTriangle& x) {
        const auto& c = x.corner;
        return std::max(
            {(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()});
    }
    /// None over a sliver, which has no normal to speak of.
    std::optional<OverTriangle> where(const State& state, const NearPair& pair) const {
        const NodeAndTriangle x = places(state, pair);
        const OverTriangle at = over_triangle(x);
        if (!(at.twice_area > fullness_[pair.triangle] * longest_edge_squared(x))) return std::nullopt;
        return at;
    }
    double gap_of(const State& state, const NearPair& pair) const {
        return over_triangle(places(state, pair)).gap;
    }
    /// [m] of the unstrained triangle
    double edge_of(std::int32_t triangle) const {
        const Triangle& t = mesh_.triangles[triangle];
        return std::sqrt(t.a * t.c);
    }
    double thickness_of(const State& state, std::int32_t triangle) const {
        const NodeAndTriangle x = places(state, {0, triangle});
        return std::min(thickness_share * edge_of(triangle),
                        thickness_now * std::sqrt(longest_edge_squared(x)));
    }
    SelfContactLaw law_of(const NearPair& pair) const {
        const auto& n = mesh_.triangles[pair.triangle].node;
        const double lightest =
            std::min({mesh_.mass[pair.node], mesh_.mass[n[0]], mesh_.mass[n[1]], mesh_.mass[n[2]]});
        return {stiffness_, friction_, damping_share * std::sqrt(stiffness_ * lightest)};
    }
    double energy_of(const State& state, const NearPair& pair) const {
        if (pair.side == 0) return 0.0;
        const OverTriangle at = over_triangle(places(state, pair));
        if (!(at.twice_area > 0.0)) return 0.0;
        const double overlap = std::max(0.0, overlap_of(at, pair.side, pair.thickness));
        return 0.5 * stiffness_ * at.window * overlap * overlap;
    }
    /// The pair holds nothing any more; its energy is lost.
    void let_go(State& state, NearPair& pair) const {
        const double energy = energy_of(state, pair);
        if (energy > 0.0) ++state.contact.passed;
        state.energy.damping += energy;
        pair.side = 0;
        pair.thickness = 0.0;
    }

    /// The side on which the node has to stay: that on which it is over a neighbour of the triangle, or where
    /// it is. Without a force now. False where it cannot be told yet.
    bool decide(State& state, std::int32_t k, const OverTriangle& at, double thickest) const {
        std::vector<NearPair>& pairs = state.contact.pairs;
        NearPair& pair = pairs[k];
        if (std::abs(at.gap) < touching * thickest) return false;
        const int here = at.gap > 0.0 ? 1 : -1;
        pair.thickness = std::min(thickest, std::abs(at.gap));
        if (const NearPair* next = over_neighbour(pairs, k)) {
            const bool enters = at.window < entering;
            if (next->side != here) {
                // Where fabric lies across fabric already, neither side is right: it may pass until it is
                // apart.
                if (!enters) return false;
                const Vec3 other = over_triangle(places(state, *next)).normal;
                if (!(other.dot(at.normal) > 0.0)) return false;  // a sharp fold: the neighbour lies between
            }
            if (enters) pair.thickness = next->thickness;
            pair.side = next->side;
            return true;
        }
        pair.side = here;
        return true;
    }
    /// Pair of the same node with a triangle that shares an edge with that of pair k, else a corner.
    const NearPair* over_neighbour(const std::vector<NearPair>& pairs, std::int32_t k) const {
        const NearPair* found = nullptr;
        int shared_most = 0;
        const auto look = [&](const NearPair& other) {
            if (other.node != pairs[k].node) return false;
            if (other.side == 0) return true;
            const auto &a = mesh_.triangles[pairs[k].triangle].node,
                       &b = mesh_.triangles[other.triangle].node;
            const auto shared = static_cast<int>(
                std::ranges::count_if(a, [&](NodeIndex i) { return std::ranges::count(b, i) > 0; }));
            if (shared > shared_most) {
                shared_most = shared;
                found = &other;
            }
            return true;
        };
        for (std::int32_t i = k - 1; i >= 0 && look(pairs[i]); --i) {
        }
        for (std::size_t i = k + 1; i < pairs.size() && look(pairs[i]); ++i) {
        }
        return found;
    }

    /// [m] by which a node and a triangle may have come closer since the search.
    double closer_since_search(const State& state) const {
        const Vec3& centre = state.sums.canopy_position;
        double most = 0.0;
        const std::vector<Vec3>& at = state.contact.searched_at;
        for (std::size_t i = 0; i < at.size(); ++i)
            most = std::max(most, (place(state, static_cast<NodeIndex>(i)) - centre - at[i]).squaredNorm());
        return closing * std::sqrt(most);
    }

    /// Finds pairs anew, by bins; those that stay keep their side and thickness.
    void search(State& state) const {
        SelfContactState& contact = state.contact;
        ++contact.searches;
        const auto nodes = static_cast<std::size_t>(mesh_.payload());
        const std::size_t triangles = mesh_.triangles.size();
        contact.searched_at.resize(nodes);
        for (std::size_t i = 0; i < nodes; ++i)
            contact.searched_at[i] = place(state, static_cast<NodeIndex>(i)) - state.sums.canopy_position;
        const std::vector<Vec3>& x = contact.searched_at;

        std::vector<double> longest(triangles);
        double mean = 0.0;
        for (std::size_t t = 0; t < triangles; ++t) {
            const auto& n = mesh_.triangles[t].node;
            longest[t] = std::sqrt(longest_edge_squared({Vec3(), {x[n[0]], x[n[1]], x[n[2]]}}));
            mean += longest[t] / static_cast<double>(triangles);
        }
        contact.skin = skin_share * mean;
        if (!std::isfinite(mean)) {  // the run is lost, and its checks will say so
            contact.pairs.clear();
            contact.by_slack.clear();
            return;
        }
        const auto thickness = [&](std::size_t t) {
            return std::min(thickness_share * edge_of(static_cast<std::int32_t>(t)),
                            thickness_now * longest[t]);
        };
        /// Corners of the triangle over which its window is open.
        const auto widened = [&](std::size_t t) {
            const auto& n = mesh_.triangles[t].node;
            const Vec3 sum = x[n[0]] + x[n[1]] + x[n[2]];
            std::array<Vec3, 3> corner;
            for (int i = 0; i < 3; ++i)
                corner[i] = (1.0 + 3.0 * window_half_width) * x[n[i]] - window_half_width * sum;
            return corner;
        };

        // Bins that hold the triangles whose boxes, with their reach, overlap them.
        struct Box {
            Vec3 low, high;
        };
        std::vector<Box> boxes(triangles);
        Vec3 low = Vec3::Constant(infinity), high = -low;
        double size = 0.0;
        for (std::size_t t = 0; t < triangles; ++t) {
            const auto corner = widened(t);
            const Vec3 margin = Vec3::Constant(thickness(t) + contact.skin);
            boxes[t] = {corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]) - margin,
                        corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]) + margin};
            low = low.cwiseMin(boxes[t].low), high = high.cwiseMax(boxes[t].high);
            size += (boxes[t].high - boxes[t].low).maxCoeff() / static_cast<double>(triangles);
        }
        const double most_bins = 8.0 * static_cast<double>(triangles) + 64.0;
        const auto counts_of = [&] { return Vec3(((high - low) / size).array().floor() + 1.0); };
        while (counts_of().prod() > most_bins)
            size *= 1.25;
        const Vec3 counts = counts_of();
        const auto bin = [&](const Vec3& p) {
            return Eigen::Vector3i(
                (((p - low) / size).array().floor()).max(0.0).min(counts.array() - 1.0).cast<int>());
        };
        const auto nx = static_cast<int>(counts.x()), ny = static_cast<int>(counts.y()),
                   nz = static_cast<int>(counts.z());
        const auto index = [&](int i, int j, int k) {
            return (static_cast<std::size_t>(i) * static_cast<std::size_t>(ny) +
                    static_cast<std::size_t>(j)) *
                       static_cast<std::size_t>(nz) +
                   static_cast<std::size_t>(k);
        };
        std::vector<std::int32_t> first(
            static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz) + 2,
            0);
        const auto each_bin = [&](std::size_t t, auto&& visit) {
            const Eigen::Vector3i a = bin(boxes[t].low), b = bin(boxes[t].high);
            for (int i = a.x(); i <= b.x(); ++i)
                for (int j = a.y(); j <= b.y(); ++j)
                    for (int k = a.z(); k <= b.z(); ++k)
                        visit(index(i, j, k));
        };
        for (std::size_t t = 0; t < triangles; ++t)
            each_bin(t, [&](std::size_t b) { ++first[b + 2]; });
        for (std::size_t b = 2; b < first.size(); ++b)
            first[b] += first[b - 1];
        std::vector<std::int32_t> in_bins(static_cast<std::size_t>(first.back()));
        for (std::size_t t = 0; t < triangles; ++t)
            each_bin(t, [&](std::size_t b) { in_bins[first[b + 1]++] = static_cast<std::int32_t>(t); });

        std::vector<NearPair> before = std::exchange(contact.pairs, {});
        contact.pairs.reserve(before.size());
        auto old = before.begin();
        const auto drop_until = [&](NodeIndex node, std::int32_t triangle) {
            for (; old != before.end() && std::pair(old->node, old->triangle) < std::pair(node, triangle);
                 ++old)
                if (old->side != 0) let_go(state, *old);
        };
        for (std::size_t i = 0; i < nodes; ++i) {
            if (!((x[i].array() >= low.array()).all() && (x[i].array() <= high.array()).all())) continue;
            const auto node = static_cast<NodeIndex>(i);
            const Eigen::Vector3i at = bin(x[i]);
            const std::size_t b = index(at.x(), at.y(), at.z());
            for (std::int32_t m = first[b]; m < first[b + 1]; ++m) {
                const std::int32_t t = in_bins[m];
                const Box& box = boxes[t];
                if (!((x[i].array() >= box.low.array()).all() && (x[i].array() <= box.high.array()).all()))
                    continue;
                if (touches(node, mesh_.triangles[t].node)) continue;
                const auto corner = widened(static_cast<std::size_t>(t));
                const double distance = std::sqrt(squared_distance(x[i], corner[0], corner[1], corner[2]));
                const double slack = std::max(0.0, distance - thickness(static_cast<std::size_t>(t)));
                if (slack > contact.skin) continue;
                drop_until(node, t);
                NearPair pair{node, t};
                if (old != before.end() && old->node == node && old->triangle == t) pair = *old++;
                // One that is behind the triangle is held, however far.
                pair.slack = pair.side == 0 || pair.side * gap_of(state, pair) > 0.0 ? slack : 0.0;
                contact.pairs.push_back(pair);
            }
        }
        drop_until(std::numeric_limits<NodeIndex>::max(), 0);
        order_by_slack(contact);
    }
    /// Whether the node is a corner or one edge, or cable, from one.
    bool touches(NodeIndex node, const std::array<NodeIndex, 3>& corner) const {
        const std::vector<NodeIndex>& near = neighbours_[node];
        return std::ranges::any_of(
            corner, [&](NodeIndex c) { return c == node || std::ranges::binary_search(near, c); });
    }

    const Mesh& mesh_;
    double friction_;   // [-]
    double stiffness_;  // [N/m]
    std::vector<std::vector<NodeIndex>> neighbours_;
    std::vector<double> fullness_;  // [-] by triangle: a sliver has less
};

}  // namespace

std::unique_ptr<const ForceModel> make_self_contact(const Mesh& mesh, double friction) {
    return std::make_unique<SelfContact>(mesh, friction);
}

}  // namespace twinchute::fullsim
