// Self-contact: nodes of fabric and lines do not pass through triangles of fabric.
#include "fullsim/forces/self_contact.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/self_contact_kernels.hpp"
#include "fullsim/forces/triangle_bins.hpp"
#include "fullsim/laws/self_contact.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {
namespace {

using self_contact::thickness_now, self_contact::touching;

/// Choices of this toolkit (docs/theory/full-model.md).
constexpr double stiffness_share = 0.125;  // of the fabric's E t: stiffer costs steps and changes no answer
constexpr double thickness_share = 0.03;   // of a triangle's edge
constexpr double damping_share = 0.5;      // of sqrt(k m): viscosity of friction where slip is slow
constexpr double skin_share = 0.15;        // of the mean longest edge, from one search to the next
constexpr double reach_share = 0.12;       // of that, from one look to the next
constexpr double flat = 1e-6;              // of the spread of nodes: across a flat sheet no motion is fitted
constexpr double sliver = 0.3;             // area over longest edge squared, over the same without strain
constexpr double entering = 0.02;          // window below which a node has just come over the triangle
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

class PairsOfFabric final : public SelfContact {
public:
    PairsOfFabric(const Mesh& mesh, double friction)
        : mesh_(mesh),
          friction_(friction),
          stiffness_(stiffness_share * mesh.stiffest_fabric().youngs_modulus *
                     mesh.stiffest_fabric().thickness),
          neighbours_(static_cast<std::size_t>(mesh.node_count())) {
        const auto join = [&](NodeIndex a, NodeIndex b) {
            if (std::max(a, b) >= mesh_.node_count()) return;
            neighbours_[a].push_back(b);
            neighbours_[b].push_back(a);
        };
        for (const Triangle& t : mesh.triangles)
            for (int i = 0; i < 3; ++i)
                join(t.node[i], t.node[(i + 1) % 3]);
        for (const Triangle& t : mesh.triangles) {
            edge_.push_back(std::sqrt(t.a * t.c));
            thickest_ = std::max(thickest_, thickness_share * edge_.back());
            fullness_.push_back(
                sliver * t.a * t.c /
                longest_edge_squared({Vec3(), {Vec3::Zero(), Vec3(t.a, 0.0, 0.0), Vec3(t.b, t.c, 0.0)}}));
        }
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
        std::size_t bytes = bytes_of(neighbours_) + bytes_of(edge_) + bytes_of(fullness_);
        for (const auto& near : neighbours_)
            bytes += bytes_of(near);
        return bytes;
    }

    void prepare(State& state) const override {
        if (state.contact.looked_at.empty()) search(state);
    }
    void add_forces(State& state) const override {
        SelfContactState& contact = state.contact;
        if (!contact.listed) list(contact);
        const Approach approach(*this, state);
        // Not below: once a node is nowhere, the run is lost, and its checks will say so.
        if (contact.looked_at.empty() || !(approach.left_of(contact.skin - contact.spent) >= 0.0)) {
            search(state);
        } else if (approach.left_of(reach_share * contact.skin) < 0.0) {
            contact.spent = contact.skin - approach.left_of(contact.skin - contact.spent);
            look(state);
        }
        push_awake(state);
    }
    bool sleeps_on(const State& state, double strayed_squared) const override {
        const SelfContactState& contact = state.contact;
        const Approach approach(*this, state, strayed_squared);
        return contact.listed && approach.left_of(reach_share * contact.skin) >= 0.0 &&
               approach.left_of(contact.skin - contact.spent) >= 0.0;
    }
    void push_awake(State& state) const override {
        SelfContactState& contact = state.contact;
        PairColumns& awake = contact.awake;
        std::vector<std::uint32_t>& attention = contact.attention;
        attention.resize(awake.node.size() / (4 * lanes()));
        const self_contact::Pushed pushed =
            kernels_.push(records_of(state), reinterpret_cast<double*>(&state.force.view()[0]),
                          columns(awake), {stiffness_, friction_}, attention.data());
        state.damping_power += pushed.dissipated;
        contact.deepest = std::max(contact.deepest, thickness_share * pushed.deepest);
        // A side that one pair takes may tell another its own: until none does, so that forces follow from
        // places and sides, not from the order of pairs.
        for (bool changes = true; changes;) {
            changes = false;
            for (std::size_t g = 0; g < attention.size(); ++g)
                for (std::uint32_t left = attention[g]; left != 0; left &= left - 1) {
                    const std::size_t slot = g * lanes() + static_cast<std::size_t>(std::countr_zero(left));
                    const NearPair& pair = contact.pairs[awake.index[slot]];
                    const int before = pair.side;
                    attend(state, awake.index[slot]);
                    set_kept(awake, slot, pair);
                    changes = changes || pair.side != before;
                }
        }
    }

    void mark_awake_nodes(const SelfContactState& contact, std::vector<bool>& marks) const override {
        const auto mark = [&](const NearPair& pair) {
            marks[pair.node] = true;
            for (const NodeIndex i : mesh_.triangles[pair.triangle].node)
                marks[i] = true;
        };
        std::vector<bool> asks(marks.size(), false);  // about the side on which it is over a neighbour
        for (const std::int32_t k : contact.awake.index) {
            mark(contact.pairs[k]);
            asks[contact.pairs[k].node] = true;
        }
        for (const NearPair& pair : contact.pairs)
            if (pair.side != 0 && asks[pair.node]) mark(pair);
    }

    /// Counts pairs that touch, and those that are within another thickness of it.
    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        const Approach approach(*this, state);
        for (const NearPair& pair : state.contact.pairs) {
            if (approach.left_of(pair.slack) > thickness_share * edge_of(pair.triangle)) continue;
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
        const Approach approach(*this, state);
        for (const NearPair& pair : state.contact.pairs)
            if (approach.left_of(pair.slack) <= 0.0) total += energy_of(state, pair);
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
    /// [m] of the unstrained triangle
    double edge_of(std::int32_t triangle) const { return edge_[triangle]; }
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
        return self_contact_energy(stiffness_, at, overlap);
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

    /// Sees to a pair that the kernel does not push: it takes a side, is let go, or gets thicker.
    void attend(State& state, std::int32_t k) const {
        SelfContactState& contact = state.contact;
        NearPair& pair = contact.pairs[k];
        const auto at = where(state, pair);
        if (!at) {
            if (pair.side != 0) let_go(state, pair);
            return;
        }
        if (at->window <= 0.0) {
            pair.side = 0;
            return;
        }
        const double thickest = thickness_of(state, pair.triangle);
        if (pair.side != 0) {
            pair.thickness = std::max(pair.thickness, std::min(thickest, pair.side * at->gap));
            return;
        }
        if (!decide(state, k, *at, thickest)) return;
        const double overlap = overlap_of(*at, pair.side, pair.thickness);
        if (overlap <= 0.0) return;
        state.energy.ramp += energy_of(state, pair);  // of a node that a neighbour hands over
        const NodeForces::View force = state.force.view();
        const Triangle& t = mesh_.triangles[pair.triangle];
        const SelfContactForce f =
            self_contact_force(law_of(pair), *at, pair.side, overlap, velocities(state, pair));
        force[pair.node].value += to_lanes(f.on.node);
        for (int i = 0; i < 3; ++i)
            force[t.node[i]].value += to_lanes(f.on.corner[i]);
        state.damping_power += f.dissipated;
    }

    // --- which pairs are awake --------------------------------------------------------------

    static const double* records_of(const State& state) {
        return reinterpret_cast<const double*>(state.node.data());
    }
    std::size_t lanes() const { return static_cast<std::size_t>(kernels_.lanes); }
    self_contact::Pairs columns(const PairColumns& pairs) const {
        return {pairs.node.size() / (4 * lanes()), pairs.node.data(), pairs.number.data()};
    }
    double* number_of(PairColumns& columns, std::size_t slot, self_contact::PairNumber which) const {
        return &columns
                    .number[(slot / lanes() * self_contact::pair_numbers + which) * lanes() + slot % lanes()];
    }
    void set_kept(PairColumns& columns, std::size_t slot, const NearPair& pair) const {
        *number_of(columns, slot, self_contact::kept_side) = pair.side;
        *number_of(columns, slot, self_contact::kept_thickness) = pair.thickness;
    }
    /// Columns of the pairs in columns.index.
    void fill(PairColumns& columns, const std::vector<NearPair>& pairs) const {
        const std::size_t count = columns.index.size(), groups = (count + lanes() - 1) / lanes();
        columns.node.assign(groups * 4 * lanes(), 0);
        columns.number.assign(groups * self_contact::pair_numbers * lanes(), 0.0);
        for (std::size_t slot = 0; slot < groups * lanes(); ++slot) {
            *number_of(columns, slot, self_contact::fullness) = infinity;  // padding
            if (slot >= count) continue;
            const NearPair& pair = pairs[columns.index[slot]];
            const auto& corner = mesh_.triangles[pair.triangle].node;
            std::int32_t* node = &columns.node[slot / lanes() * 4 * lanes() + slot % lanes()];
            constexpr auto row = static_cast<std::int32_t>(sizeof(NodeVector));
            node[0] = pair.node * row;
            for (std::size_t i = 0; i < 3; ++i)
                node[(1 + i) * lanes()] = corner[i] * row;
            *number_of(columns, slot, self_contact::fullness) = fullness_[pair.triangle];
            *number_of(columns, slot, self_contact::most_thickness) =
                thickness_share * edge_of(pair.triangle);
            *number_of(columns, slot, self_contact::slow_viscosity) = law_of(pair).viscosity;
            set_kept(columns, slot, pair);
        }
    }
    /// Makes the columns anew: those that touch first, so that they push side by side, then those that may.
    void list(SelfContactState& contact) const {
        contact.all.index.resize(contact.pairs.size());
        std::iota(contact.all.index.begin(), contact.all.index.end(), 0);
        fill(contact.all, contact.pairs);
        wake(contact);
        contact.listed = true;
    }
    void wake(SelfContactState& contact) const {
        const double reach = reach_share * contact.skin;
        contact.awake.clear();
        std::vector<std::int32_t>& index = contact.awake.index;
        for (const bool touch : {true, false})
            for (std::size_t k = 0; k < contact.pairs.size(); ++k) {
                const double slack = contact.pairs[k].slack;
                if (slack <= reach && (slack <= 0.0) == touch) index.push_back(static_cast<std::int32_t>(k));
            }
        fill(contact.awake, contact.pairs);
    }

    /// How far a node and a triangle may have come closer since the last look: by the canopy's linear motion
    /// in proportion to their distance, and by what nodes stray from it.
    class Approach {
    public:
        Approach(const PairsOfFabric& of, const State& state)
            : Approach(of, state, of.strayed_squared(state)) {}
        Approach(const PairsOfFabric& of, const State& state, double strayed_squared)
            : shrinks_((state.time - state.contact.look_time) * state.contact.velocity_gradient.norm()),
              strays_(closing * std::sqrt(strayed_squared)),
              thickest_(of.thickest_) {}

        /// [m] at least by which they still have to come closer to touch, of `slack` [m] at the last look. No
        /// number where a node is nowhere.
        double left_of(double slack) const { return slack - shrinks_ * (slack + thickest_) - strays_; }

    private:
        double shrinks_;  // [-]
        double strays_;   // [m]
        double thickest_;
    };
    double strayed_squared(const State& state) const {
        const std::vector<double>& before = state.contact.looked_at;
        if (before.empty()) return 0.0;
        return kernels_.farthest(records_of(state), before.data(), before.size() / 4,
                                 static_cast<std::size_t>(mesh_.payload()) - 1, motion(state));
    }
    std::size_t rows_of_places() const {
        return (static_cast<std::size_t>(mesh_.payload()) + lanes() - 1) / lanes() * lanes();
    }
    void note_places(State& state) const {
        const std::size_t count = rows_of_places();
        std::vector<double>& at = state.contact.looked_at;
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 x = from_centre(state, std::min(static_cast<NodeIndex>(i), mesh_.payload() - 1));
            for (std::size_t c = 0; c < 3; ++c)
                at[c * count + i] = x[static_cast<Eigen::Index>(c)];
        }
        state.contact.look_time = state.time;
        state.contact.velocity_gradient = velocity_gradient(state);
    }
    /// [1/s] least squares over the nodes of the canopy.
    Eigen::Matrix3d velocity_gradient(const State& state) const {
        Vec3 centre = Vec3::Zero(), drift = Vec3::Zero();
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i) {
            centre += place(state, i) / mesh_.canopy_nodes;
            drift += to_vec3(state.node[i].v) / mesh_.canopy_nodes;
        }
        Eigen::Matrix3d motion = Eigen::Matrix3d::Zero(), spread = motion;
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i) {
            const Vec3 x = place(state, i) - centre;
            motion += (to_vec3(state.node[i].v) - drift) * x.transpose();
            spread += x * x.transpose();
        }
        spread.diagonal().array() += flat * spread.trace();
        return motion * spread.inverse();
    }
    static Vec3 from_centre(const State& state, NodeIndex i) {
        return place(state, i) - state.sums.canopy_position;
    }

    /// Which of the near pairs may touch soon.
    void look(State& state) const {
        SelfContactState& contact = state.contact;
        note_places(state);
        const std::size_t slots = contact.all.node.size() / 4;
        std::vector<double>& measured = contact.measured;
        measured.resize(2 * slots);
        double* const gap = measured.data() + slots;
        kernels_.measure(records_of(state), columns(contact.all), measured.data(), gap);
        for (std::size_t k = 0; k < contact.pairs.size(); ++k) {
            NearPair& pair = contact.pairs[k];
            // One that is behind the triangle is held, however far.
            const bool held = pair.side != 0 && !(pair.side * gap[k] > 0.0);
            pair.slack = held ? 0.0 : std::max(0.0, measured[k] - thickness_share * edge_of(pair.triangle));
        }
        wake(contact);
    }

    // --- which pairs are near -----------------------------------------------------------------

    /// Finds pairs anew; those that stay keep their side and thickness.
    void search(State& state) const {
        SelfContactState& contact = state.contact;
        ++contact.searches;
        contact.spent = 0.0;
        std::vector<Vec3> x(static_cast<std::size_t>(mesh_.payload()));
        for (std::size_t i = 0; i < x.size(); ++i)
            x[i] = from_centre(state, static_cast<NodeIndex>(i));
        std::vector<double> longest(mesh_.triangles.size());
        double mean = 0.0;
        for (std::size_t t = 0; t < longest.size(); ++t) {
            const auto& n = mesh_.triangles[t].node;
            longest[t] = std::sqrt(longest_edge_squared({Vec3(), {x[n[0]], x[n[1]], x[n[2]]}}));
            mean += longest[t] / static_cast<double>(longest.size());
        }
        contact.skin = skin_share * mean;
        contact.looked_at.resize(4 * rows_of_places(), 1.0);
        std::vector<NearPair> before = std::exchange(contact.pairs, {});
        if (std::isfinite(mean)) {
            contact.pairs.reserve(before.size());
            find_pairs(state, x, longest, before);
        }
        list(contact);
        look(state);
    }
    /// Corners of the triangle over which its window is open.
    std::array<Vec3, 3> widened(const std::vector<Vec3>& x, std::size_t t) const {
        const auto& n = mesh_.triangles[t].node;
        const Vec3 sum = x[n[0]] + x[n[1]] + x[n[2]];
        std::array<Vec3, 3> corner;
        for (int i = 0; i < 3; ++i)
            corner[i] = (1.0 + 3.0 * window_half_width) * x[n[i]] - window_half_width * sum;
        return corner;
    }
    /// x: places of the nodes, longest: edge of each triangle [m]; before: pairs of the last search.
    void find_pairs(State& state, const std::vector<Vec3>& x, const std::vector<double>& longest,
                    std::vector<NearPair>& before) const {
        SelfContactState& contact = state.contact;
        std::vector<double> reach(longest.size());  // [m] of a triangle until the next search
        std::vector<std::array<Vec3, 3>> corners(longest.size());
        std::vector<Box> boxes(longest.size());
        for (std::size_t t = 0; t < longest.size(); ++t) {
            reach[t] = contact.skin + std::min(thickness_share * edge_of(static_cast<std::int32_t>(t)),
                                               thickness_now * longest[t]);
            const auto& corner = corners[t] = widened(x, t);
            const Vec3 margin = Vec3::Constant(reach[t]);
            boxes[t] = {corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]) - margin,
                        corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]) + margin};
        }
        weigh(contact, x, corners);
        const TriangleBins bins(boxes);
        auto old = before.begin();
        const auto drop_until = [&](NodeIndex node, std::int32_t triangle) {
            for (; old != before.end() && std::pair(old->node, old->triangle) < std::pair(node, triangle);
                 ++old)
                if (old->side != 0) let_go(state, *old);
        };
        // By node: the last one that it is, or that it is one edge, or cable, from.
        std::vector<NodeIndex> touches(neighbours_.size(), -1);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto node = static_cast<NodeIndex>(i);
            touches[node] = node;
            for (const NodeIndex near : neighbours_[node])
                touches[near] = node;
            bins.each_that_holds(x[i], [&](std::int32_t t) {
                if (std::ranges::any_of(mesh_.triangles[t].node,
                                        [&](NodeIndex c) { return touches[c] == node; }))
                    return;
                const auto& corner = corners[t];
                if (squared_distance(x[i], corner[0], corner[1], corner[2]) > reach[t] * reach[t]) return;
                drop_until(node, t);
                const bool stays = old != before.end() && old->node == node && old->triangle == t;
                contact.pairs.push_back(stays ? *old++ : NearPair{node, t});
            });
        }
        drop_until(std::numeric_limits<NodeIndex>::max(), 0);
    }

    /// Weights of nodes by their distance from all fabric. A pair with one that is farther than the skin by d
    /// may come closer by 1 + d/skin times as much as others, `closing` M (1 + d/skin), where others stray M.
    /// Triangles take (closing - 1) M of that, the node has the rest.
    void weigh(SelfContactState& contact, const std::vector<Vec3>& x,
               const std::vector<std::array<Vec3, 3>>& corners) const {
        Box fabric{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
        for (const auto& corner : corners)
            for (const Vec3& c : corner)
                fabric = {fabric.low.cwiseMin(c), fabric.high.cwiseMax(c)};
        const std::size_t count = rows_of_places();
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3& at = x[std::min(i, x.size() - 1)];
            const double away = (at - at.cwiseMax(fabric.low).cwiseMin(fabric.high)).norm();
            const double d = std::max(0.0, away - contact.skin - thickest_);
            contact.looked_at[3 * count + i] = contact.skin / (contact.skin + closing * d);
        }
    }

    const Mesh& mesh_;
    const self_contact::Kernels& kernels_ = self_contact::all_kernels().front();
    double friction_;        // [-]
    double stiffness_;       // [N/m]
    double thickest_ = 0.0;  // [m] thickness of any triangle
    std::vector<std::vector<NodeIndex>> neighbours_;
    std::vector<double> edge_;      // [m] by triangle, unstrained
    std::vector<double> fullness_;  // [-] by triangle: a sliver has less
};

}  // namespace

LinearMotion SelfContact::motion(const State& state) {
    const SelfContactState& contact = state.contact;
    return {state.sums.canopy_position,
            Eigen::Matrix3d::Identity() + (state.time - contact.look_time) * contact.velocity_gradient};
}

std::unique_ptr<const ForceModel> make_self_contact(const Mesh& mesh, double friction) {
    return std::make_unique<PairsOfFabric>(mesh, friction);
}

}  // namespace twinchute::fullsim
