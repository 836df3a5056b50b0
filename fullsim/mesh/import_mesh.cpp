#include "fullsim/mesh/import_mesh.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "fullsim/mesh/gmsh_write.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr std::size_t largest_mesh_file = std::size_t{256} << 20;  // [bytes]
constexpr double flattest = 1e-9;     // area of a triangle over its longest edge squared
constexpr double noticeable = 0.005;  // of a size, between mesh and scene

using Edge = std::pair<NodeIndex, NodeIndex>;
Edge edge_of(NodeIndex a, NodeIndex b) {
    return {std::min(a, b), std::max(a, b)};
}

double whole_azimuth(const Vec3& x) {
    const double angle = std::atan2(x.y(), x.x());
    // What lies toward x by all but rounding is the first.
    return angle < -1e-9 ? angle + 2.0 * pi : std::max(0.0, angle);
}

/// Twice the vector area of a closed ring of points.
Vec3 twice_area(const std::vector<Vec3>& ring) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i)
        sum += ring[i].cross(ring[(i + 1) % ring.size()]);
    return sum;
}

/// Which things hang together.
class UnionFind {
public:
    explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

    std::size_t root(std::size_t i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t i, std::size_t k) { parent_[root(i)] = root(k); }

private:
    std::vector<std::size_t> parent_;
};

class Importer {
public:
    Importer(const GmshMesh& file, const Scene& scene)
        : file_(file), scene_(scene), chute_(scene.parachutes.front()) {}

    ImportedMesh import() {
        find_groups();
        for (const GmshElement& e : file_.elements)
            check_element(e);
        check_duplicates();
        find_solid();
        find_confluences();
        number_nodes();
        sew_fabric();
        find_edges();
        attach_lines();
        attach_risers();
        find_vent();
        sew_tapes();
        sew_reefing();
        cut_to_length();
        if (takes_body()) make_body();
        find_rings();
        measure();
        return std::move(out_);
    }

private:
    [[noreturn]] void refuse(int line, std::string problem, std::string why, std::string hint) const {
        throw SceneError({file_.file, line, 1}, "", std::move(problem), std::move(why), std::move(hint));
    }
    [[noreturn]] void refuse(const GmshElement& e, std::string_view problem, std::string why,
                             std::string hint) const {
        refuse(e.line, fmt::format("{} {} {}", gmsh_shape(e.corners), e.tag, problem), std::move(why),
               std::move(hint));
    }
    /// At a key of the scene.
    [[noreturn]] void refuse_key(std::string key, std::string problem, std::string why,
                                 std::string hint) const {
        throw SceneError({scene_.file.string(), 0, 0}, std::move(key), std::move(problem), std::move(why),
                         std::move(hint));
    }

    const Vec3& place(std::int32_t node) const {
        return file_.nodes[static_cast<std::size_t>(node)].position;
    }
    std::int64_t tag(NodeIndex i) const { return file_.nodes[static_cast<std::size_t>(in_file_[i])].tag; }
    GmshGroupIndex group_of(const GmshElement& e) const { return group_[e.group]; }
    std::vector<const GmshElement*> elements_of(GmshGroupIndex group) const {
        std::vector<const GmshElement*> some;
        for (const GmshElement& e : file_.elements)
            if (group_of(e) == group) some.push_back(&e);
        return some;
    }
    NodeIndex node(const GmshElement& e, int corner) const {
        return number_[static_cast<std::size_t>(e.node[static_cast<std::size_t>(corner)])];
    }

    void find_groups() {
        std::vector<std::string_view> known;
        for (const GmshGroupName& g : gmsh_groups)
            known.push_back(g.name);
        std::array<bool, gmsh_groups.size()> found{};
        for (const GmshGroup& g : file_.groups) {
            const auto row = std::ranges::find(gmsh_groups, g.name, &GmshGroupName::name);
            if (row == gmsh_groups.end())
                refuse(
                    g.line, fmt::format("unknown group '{}'", g.name),
                    fmt::format("known: {}", fmt::join(known, ", ")),
                    nearest(g.name, known).empty() ? "leave it out of the export" : suggest(g.name, known));
            const bool solid = g.name == "payload" && g.dimension == 3;
            if (row->dimension != g.dimension && !solid)
                refuse(g.line, fmt::format("the group '{}' of dimension {}", g.name, g.dimension),
                       fmt::format("it has dimension {}", row->dimension), "put other elements into it");
            group_.push_back(static_cast<GmshGroupIndex>(row - gmsh_groups.begin()));
            found[group_.back()] = true;
        }
        std::array<std::size_t, gmsh_groups.size()> count{};
        for (const GmshElement& e : file_.elements)
            ++count[group_of(e)];
        const auto need = [&](GmshGroupIndex group, const char* why) {
            if (count[group] == 0)
                refuse(1,
                       fmt::format("the group '{}' {}", gmsh_groups[group].name,
                                   found[group] ? "has no elements" : "is missing"),
                       why, "name it with Physical ... in Gmsh");
        };
        need(group_canopy, "its triangles are the fabric");
        need(group_line, "its edges are the suspension lines");
        need(group_confluence, "its point is where the payload hangs");
        if (!chute_.reefing.empty())
            need(group_reefing, "parachute.reefing holds the mouth together with it");
    }

    /// The payload is the file's body, not a point mass or what the scene's sizes say.
    bool takes_body() const {
        return scene_.payload.body && scene_.payload.body->shape == PayloadBody::Shape::mesh;
    }

    /// The tetrahedra of the payload, in one piece that faces hold together.
    void find_solid() {
        std::map<std::int32_t, int> number;
        std::map<std::array<int, 3>, std::size_t> across;  // a face, and the first tetrahedron that has it
        std::vector<const GmshElement*> of;
        for (const GmshElement* e : elements_of(group_payload))
            if (e->corners == 4) of.push_back(e);
        UnionFind pieces(of.size());
        for (std::size_t t = 0; t < of.size(); ++t) {
            std::array<int, 4>& corner = out_.payload.tetrahedron.emplace_back();
            for (std::size_t c = 0; c < 4; ++c) {
                const std::int32_t i = of[t]->node[c];
                const auto [at, is_new] = number.emplace(i, static_cast<int>(out_.payload.node.size()));
                if (is_new) {
                    out_.payload.node.push_back(place(i));
                    solid_in_file_.push_back(i);
                }
                corner[c] = at->second;
            }
            for (std::size_t left_out = 0; left_out < 4; ++left_out) {
                std::array<int, 3> face{};
                for (std::size_t c = 0, k = 0; c < 4; ++c)
                    if (c != left_out) face[k++] = corner[c];
                std::ranges::sort(face);
                pieces.join(t, across.emplace(face, t).first->second);
            }
        }
        for (std::size_t t = 0; t < of.size(); ++t)
            if (pieces.root(t) != pieces.root(0))
                refuse(*of[t], "belongs to a second piece of the payload",
                       fmt::format("no faces join it to tetrahedron {}", of.front()->tag),
                       "make one volume of the payload");
        if (takes_body() && of.empty())
            refuse(1, "the group 'payload' has no tetrahedra",
                   "payload.body.shape = \"mesh\" takes its body from it",
                   "mesh the payload as a volume, or give another shape");
    }

    /// The node where the payload hangs; of a body those where it does.
    void find_confluences() {
        const auto points = elements_of(group_confluence);
        if (points.size() > 1 && !takes_body())
            refuse(
                *points[1], "is one more confluence", "the payload hangs at one point",
                "keep one of them; a body of tetrahedra, payload.body.shape = \"mesh\", may hang at several");
        for (const GmshElement* e : points) {
            if (takes_body() && std::ranges::count(solid_in_file_, e->node[0]) == 0)
                refuse(*e, "is a confluence off the payload",
                       fmt::format("node {} is on none of its tetrahedra",
                                   file_.nodes[static_cast<std::size_t>(e->node[0])].tag),
                       "let risers end at nodes of the payload's mesh");
            confluences_.insert(e->node[0]);
        }
        for (const std::int32_t i : confluences_)
            origin_ += place(i) / static_cast<double>(confluences_.size());
        for (const GmshElement* e : elements_of(group_payload))
            if (e->corners == 1 && !confluences_.contains(e->node[0]))
                refuse(*e, "is a payload away from the confluence", "the payload hangs at that point",
                       "put both on the same node");
        if (!takes_body()) return;
        std::set<std::int32_t> tied;
        for (const GmshElement& e : file_.elements)
            if (e.corners == 2) tied.insert(e.node.begin(), e.node.begin() + 2);
        for (const GmshElement* e : points)
            if (!tied.contains(e->node[0]))
                refuse(*e, "is a confluence that carries nothing", "neither riser nor line ends there",
                       "take it out, or tie a riser to it");
    }

    void check_element(const GmshElement& e) const {
        for (int i = 0; i < e.corners; ++i)
            for (int k = 0; k < i; ++k)
                if (e.node[static_cast<std::size_t>(i)] == e.node[static_cast<std::size_t>(k)])
                    refuse(e, "has the same node twice", "it has no size", "take it out");
        if (e.corners == 2 && place(e.node[0]) == place(e.node[1]))
            refuse(e, "has no length", "both of its nodes lie at the same place", "take it out");
        if (e.corners == 4) {
            const Vec3& p = place(e.node[0]);
            const double six_volumes =
                (place(e.node[1]) - p).cross(place(e.node[2]) - p).dot(place(e.node[3]) - p);
            if (!(six_volumes > 0.0))
                refuse(e, six_volumes < 0.0 ? "is inverted" : "has no volume",
                       fmt::format("its volume is {:.3g} m^3", six_volumes / 6.0), "mesh the payload anew");
        }
        if (e.corners != 3) return;
        const Vec3 a = place(e.node[1]) - place(e.node[0]), b = place(e.node[2]) - place(e.node[0]);
        const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
        if (!(0.5 * a.cross(b).norm() > flattest * longest))
            refuse(e, "has no area", "its corners lie on a line", "mesh the canopy anew");
    }

    void check_duplicates() const {
        // By nodes; a reefing line may lie on a tape.
        std::map<std::pair<bool, std::array<std::int32_t, 4>>, const GmshElement*> seen;
        for (const GmshElement& e : file_.elements) {
            if (e.corners == 1) continue;
            std::pair<bool, std::array<std::int32_t, 4>> key{group_of(e) == group_reefing, {-1, -1, -1, -1}};
            std::copy_n(e.node.begin(), e.corners, key.second.begin());
            std::ranges::sort(key.second);
            const auto [other, is_new] = seen.emplace(key, &e);
            if (!is_new)
                refuse(e, fmt::format("lies on {} {}", gmsh_shape(e.corners), other->second->tag),
                       "both have the same nodes", "keep one of the two");
        }
    }

    /// Canopy, then lines and risers, the payload last; each in the order of the file's tags.
    void number_nodes() {
        enum : std::uint8_t { nobody, body, other, canopy };
        std::vector<std::uint8_t> of(file_.nodes.size(), nobody);
        for (const GmshElement& e : file_.elements)
            for (int c = 0; c < e.corners; ++c) {
                std::uint8_t& who = of[static_cast<std::size_t>(e.node[static_cast<std::size_t>(c)])];
                // A point holds nothing: it only names a node.
                const std::uint8_t mine = e.corners == 4 ? body : e.corners == 3 ? canopy : other;
                if (e.corners > 1) who = std::max(who, mine);
            }
        for (std::size_t i = 0; i < of.size(); ++i)
            if (of[i] == nobody)
                refuse(file_.nodes[i].line, fmt::format("node {} floats freely", file_.nodes[i].tag),
                       "no triangle or edge of a group has it", "take it out, or save groups only");
        for (const GmshElement* e : elements_of(group_confluence))
            if (of[static_cast<std::size_t>(e->node[0])] == canopy)
                refuse(*e, "is a confluence on the canopy", "lines and risers lie between",
                       "put it where the risers meet");
        number_.assign(of.size(), -1);
        const auto give = [&](std::int32_t i) {
            number_[static_cast<std::size_t>(i)] = static_cast<NodeIndex>(in_file_.size());
            in_file_.push_back(i);
            out_.mesh.position.push_back(place(i) - origin_);
        };
        for (const std::uint8_t who : {canopy, other}) {
            for (std::size_t i = 0; i < of.size(); ++i)
                if (of[i] == who && !confluences_.contains(static_cast<std::int32_t>(i)))
                    give(static_cast<std::int32_t>(i));
            if (who == canopy) out_.mesh.canopy_nodes = out_.mesh.node_count();
        }
        give(*confluences_.begin());
        out_.mesh.position.back() = Vec3::Zero();
        for (const std::int32_t i : confluences_)
            number_[static_cast<std::size_t>(i)] = out_.mesh.payload();
        for (Vec3& x : out_.payload.node)
            x -= origin_;
    }

    void sew_fabric() {
        Vec3 area = Vec3::Zero();
        for (const GmshElement* e : elements_of(group_canopy)) {
            out_.mesh.triangles.push_back({{node(*e, 0), node(*e, 1), node(*e, 2)}, 0.0, 0.0, 0.0});
            of_triangle_.push_back(e);
            const Vec3 &p = place(e->node[0]), &q = place(e->node[1]), &r = place(e->node[2]);
            area += (q - p).cross(r - p);
        }
        double height = 0.0;
        for (NodeIndex i = 0; i < out_.mesh.canopy_nodes; ++i)
            height += out_.mesh.position[i].z();
        if (!(height > 0.0))
            refuse(*of_triangle_.front(), "and its canopy do not lie above the confluence",
                   "z points from the confluence to the apex", "turn the mesh");
        // Counter-clockwise seen from outside, whichever way the whole surface was drawn.
        if (area.z() < 0.0)
            for (Triangle& t : out_.mesh.triangles)
                std::swap(t.node[1], t.node[2]);
    }

    /// The edges of the canopy: each between two triangles that turn the same way, or on an opening.
    void find_edges() {
        struct Sides {
            int there = -1, back = -1;  // triangle that runs along it from the lower node, and to it
        };
        std::map<Edge, Sides> sides;
        for (std::size_t t = 0; t < out_.mesh.triangles.size(); ++t)
            for (int c = 0; c < 3; ++c) {
                const NodeIndex a = out_.mesh.triangles[t].node[c],
                                b = out_.mesh.triangles[t].node[(c + 1) % 3];
                Sides& s = sides[edge_of(a, b)];
                int& mine = a < b ? s.there : s.back;
                if (mine >= 0)
                    refuse(*of_triangle_[t],
                           fmt::format("turns the other way round than triangle {}", of_triangle_[mine]->tag),
                           "both run along their common edge in one direction; or three triangles share it",
                           "orient the surface alike everywhere");
                mine = static_cast<int>(t);
            }
        std::vector<NodeIndex> next(out_.mesh.position.size(), -1);
        for (const auto& [edge, s] : sides) {
            edges_.insert(edge);
            if (s.there >= 0 && s.back >= 0) continue;
            // Around the opening the way the fabric does not go.
            const auto [from, to] = s.there >= 0 ? edge : Edge{edge.second, edge.first};
            if (next[from] >= 0)
                refuse(*of_triangle_[static_cast<std::size_t>(std::max(s.there, s.back))],
                       fmt::format("touches another piece of canopy in node {} alone", tag(from)), "",
                       "join the pieces along edges");
            next[from] = to;
        }
        require_one_piece();
        loop_of_.assign(next.size(), -1);
        for (NodeIndex first = 0; first < out_.mesh.canopy_nodes; ++first) {
            if (next[first] < 0 || loop_of_[first] >= 0) continue;
            std::vector<NodeIndex>& loop = loops_.emplace_back();
            for (NodeIndex i = first; loop_of_[i] < 0; i = next[i]) {
                loop_of_[i] = static_cast<int>(loops_.size()) - 1;
                loop.push_back(i);
            }
        }
    }

    void require_one_piece() const {
        UnionFind pieces(static_cast<std::size_t>(out_.mesh.canopy_nodes));
        const auto at = [](NodeIndex i) { return static_cast<std::size_t>(i); };
        for (const Triangle& t : out_.mesh.triangles)
            for (const NodeIndex i : t.node)
                pieces.join(at(i), at(t.node[0]));
        for (std::size_t t = 0; t < out_.mesh.triangles.size(); ++t)
            if (pieces.root(at(out_.mesh.triangles[t].node[0])) != pieces.root(0))
                refuse(*of_triangle_[t], "belongs to a second piece of canopy",
                       "no triangles join it to the first", "make one surface of the canopy");
    }

    void add_cable(const GmshElement& e, CableKind kind, double strands) {
        out_.mesh.cables.push_back({{node(e, 0), node(e, 1)}, length_of(e), strands, kind});
        for (int c = 0; c < 2; ++c)
            if (node(e, c) == out_.mesh.payload()) ends_.push_back(e.node[static_cast<std::size_t>(c)]);
    }
    /// [m]
    double length_of(const GmshElement& e) const {
        const auto at = [&](std::size_t c) { return Vec3(place(e.node[c]) - origin_); };
        return (at(1) - at(0)).norm();
    }

    /// Edges of a group by their nodes.
    std::map<NodeIndex, std::vector<const GmshElement*>> edges_at(GmshGroupIndex group) const {
        std::map<NodeIndex, std::vector<const GmshElement*>> at;
        for (const GmshElement* e : elements_of(group))
            for (int c = 0; c < 2; ++c)
                at[node(*e, c)].push_back(e);
        return at;
    }
    NodeIndex other_end(const GmshElement& e, NodeIndex i) const {
        return node(e, 0) == i ? node(e, 1) : node(e, 0);
    }

    /// Every line runs from the skirt, without a branch, to a riser or to the confluence.
    void attach_lines() {
        const auto lines = edges_at(group_line), risers = edges_at(group_riser);
        const NodeIndex confluence = out_.mesh.payload();
        std::map<const GmshElement*, bool> used;
        for (const auto& [foot, first] : lines) {
            if (!out_.mesh.is_canopy(foot)) continue;
            for (const GmshElement* e : first) {
                if (loop_of_[foot] < 0)
                    refuse(*e, "ends inside the canopy",
                           fmt::format("node {} is on none of its edges", tag(foot)),
                           "tie lines to the skirt");
                if (skirt_ < 0) skirt_ = loop_of_[foot];
                if (loop_of_[foot] != skirt_)
                    refuse(*e, "is not tied to the skirt, where other lines are",
                           fmt::format("node {} is on another edge of the canopy", tag(foot)),
                           "tie all lines to one edge");
                ImportedLine line{{foot}, {}};
                for (const GmshElement* here = e;;) {
                    if (used[here])
                        refuse(*here, "is part of two lines", "", "give each line edges of its own");
                    used[here] = true;
                    line.piece.push_back(length_of(*here));
                    line.node.push_back(other_end(*here, line.node.back()));
                    const NodeIndex end = line.node.back();
                    if (end == confluence || risers.contains(end)) break;
                    const auto& at = lines.at(end);
                    if (out_.mesh.is_canopy(end))
                        refuse(*here, "leads from the canopy back to it", "a line leads to the confluence",
                               "take it for a tape");
                    if (at.size() != 2)
                        refuse(*here, at.size() == 1 ? "ends at nothing" : "branches",
                               fmt::format("node {} is on no riser and is not the confluence", tag(end)),
                               "lines lead from the skirt to a riser or to the confluence");
                    here = at[0] == here ? at[1] : at[0];
                }
                out_.lines.push_back(std::move(line));
            }
        }
        for (const GmshElement* e : elements_of(group_line))
            if (!used[e])
                refuse(*e, "is not tied to the skirt", "no node of its line is on the canopy",
                       "let the line end on a node of the canopy's edge");
        if (out_.lines.size() < 3)
            refuse(*elements_of(group_line).front(), fmt::format("is of one of {} lines", out_.lines.size()),
                   "a canopy hangs on three at least", "tie more lines to the skirt");
        std::ranges::stable_sort(out_.lines, {}, [&](const ImportedLine& line) {
            return whole_azimuth(out_.mesh.position[line.node.front()]);
        });
    }

    /// Risers are a tree that grows from the confluence; each is as strong as the lines that it carries.
    void attach_risers() {
        const auto risers = edges_at(group_riser);
        std::vector<int> carried(out_.mesh.position.size(), 0);  // lines that end at a node, then above it
        for (const ImportedLine& line : out_.lines)
            ++carried[line.node.back()];
        std::vector<std::pair<NodeIndex, const GmshElement*>> order{{out_.mesh.payload(), nullptr}};
        std::vector<bool> seen(out_.mesh.position.size(), false);
        seen[out_.mesh.payload()] = true;
        for (std::size_t k = 0; k < order.size(); ++k) {
            const auto [here, from] = order[k];
            const auto at = risers.find(here);
            if (at == risers.end()) continue;
            for (const GmshElement* e : at->second) {
                if (e == from) continue;
                const NodeIndex end = other_end(*e, here);
                if (seen[end])
                    refuse(*e, "closes a ring of risers", "each line has one way to the confluence",
                           "take one of its edges out");
                if (out_.mesh.is_canopy(end))
                    refuse(*e, "is a riser on the canopy", "lines lie between", "put it into the group line");
                seen[end] = true;
                order.emplace_back(end, e);
            }
        }
        std::map<const GmshElement*, int> strands;
        for (std::size_t k = order.size(); k-- > 1;) {
            const auto [end, e] = order[k];
            strands[e] = carried[end];
            carried[other_end(*e, end)] += carried[end];
            if (carried[end] == 0)
                refuse(*e, "carries no line", fmt::format("none ends at or above node {}", tag(end)),
                       "take it out, or tie lines to it");
        }
        for (const GmshElement* e : elements_of(group_riser))
            if (!strands.contains(e))
                refuse(*e, "does not lead to the confluence", "no riser joins it to that point",
                       "close the gap");
        for (const GmshElement* e : elements_of(group_line))
            add_cable(*e, CableKind::line, 1.0);
        for (const GmshElement* e : elements_of(group_riser))
            add_cable(*e, CableKind::riser, strands[e]);
    }

    void sew_tapes() {
        std::vector<Cable> others = std::exchange(out_.mesh.cables, {});
        for (const CableKind kind : {CableKind::radial, CableKind::skirt, CableKind::vent})
            for (const GmshElement* e : elements_of(group_tape)) {
                const NodeIndex a = node(*e, 0), b = node(*e, 1);
                if (!edges_.contains(edge_of(a, b)))
                    refuse(*e, "is a tape off the canopy's edges", "tapes are sewn on between two nodes",
                           "let the canopy's mesh follow the tape");
                if (tape_kind(a, b) == kind) add_cable(*e, kind, 1.0);
            }
        struct Tape {
            CableKind kind;
            const char* key;
            const Cord& cord;
        };
        const Tapes& tapes = chute_.tapes;
        for (const Tape& tape : {Tape{CableKind::radial, "parachute.tapes.radial", tapes.radial},
                                 Tape{CableKind::skirt, "parachute.tapes.skirt", tapes.skirt},
                                 Tape{CableKind::vent, "parachute.tapes.vent", tapes.vent}})
            if (tape.cord.name.empty() && std::ranges::count(out_.mesh.cables, tape.kind, &Cable::kind) > 0)
                refuse_key(tape.key, "is missing", fmt::format("{} has such a tape", file_.file),
                           "name its material");
        out_.mesh.cables.insert(out_.mesh.cables.end(), others.begin(), others.end());
    }

    /// On the skirt, around the vent, or along a seam.
    CableKind tape_kind(NodeIndex a, NodeIndex b) const {
        const int loop = loop_of_[a];
        if (loop < 0 || loop_of_[b] != loop || (loop != skirt_ && loop != vent_)) return CableKind::radial;
        const std::vector<NodeIndex>& nodes = loops_[static_cast<std::size_t>(loop)];
        const auto at = std::ranges::find(nodes, a);
        const NodeIndex after = at + 1 == nodes.end() ? nodes.front() : *(at + 1);
        const NodeIndex before = at == nodes.begin() ? nodes.back() : *(at - 1);
        if (b != after && b != before) return CableKind::radial;  // across a narrow strip
        return loop == skirt_ ? CableKind::skirt : CableKind::vent;
    }

    void sew_reefing() {
        if (chute_.reefing.empty()) return;
        if (chute_.tapes.skirt.name.empty())
            refuse_key("parachute.tapes.skirt", "is missing", "the reefing line is of its material",
                       "name its material");
        for (const GmshElement* e : elements_of(group_reefing)) {
            for (int c = 0; c < 2; ++c)
                if (loop_of_[node(*e, c)] != skirt_)
                    refuse(*e, "is a reefing line off the skirt",
                           fmt::format("node {} is not on it", tag(node(*e, c))),
                           "let it run around the mouth");
            out_.mesh.reefing_line.push_back(out_.mesh.cables.size());
            add_cable(*e, CableKind::skirt, 1.0);
        }
    }

    /// The file's lengths are those without strain; that of the reefing line is the scene's.
    void cut_to_length() {
        Mesh& mesh = out_.mesh;
        for (Triangle& t : mesh.triangles) {
            const Vec3 e1 = mesh.position[t.node[1]] - mesh.position[t.node[0]];
            const Vec3 e2 = mesh.position[t.node[2]] - mesh.position[t.node[0]];
            t.a = e1.norm();
            t.b = e1.dot(e2) / t.a;
            t.c = e1.cross(e2).norm() / t.a;
        }
        for (const std::size_t c : mesh.reefing_line)
            mesh.cables[c].rest_length =
                reefing_line_length(chute_, 0) / static_cast<double>(mesh.reefing_line.size());
        mesh.fabric = chute_.fabric;
        mesh.cords = {chute_.tapes.radial, chute_.tapes.skirt, chute_.tapes.vent,
                      chute_.line,         chute_.line,        chute_.line};
        lump_masses(mesh, scene_.payload.mass);
    }

    /// About its centre of mass.
    void make_body() {
        BodyMesh& body = out_.mesh.body.emplace();
        body.solid = out_.payload;
        const Vec3 centre = lump(solid_of(body.solid), scene_.payload.mass).centre;
        for (Vec3& x : body.solid.node)
            x -= centre;
        body.middle = -centre;
        body.lumped = lump(solid_of(body.solid), scene_.payload.mass);
        body.deformable = scene_.payload.body->elasticity.has_value();
        for (const std::int32_t i : ends_)
            body.end.push_back(
                static_cast<int>(std::ranges::find(solid_in_file_, i) - solid_in_file_.begin()));
    }

    double off_axis(NodeIndex i) const { return out_.mesh.position[i].head<2>().norm(); }

    /// The opening nearest to the axis; others are windows.
    void find_vent() {
        const auto distance = [&](int loop) {
            double sum = 0.0;
            for (const NodeIndex i : loops_[static_cast<std::size_t>(loop)])
                sum += off_axis(i);
            return sum / static_cast<double>(loops_[static_cast<std::size_t>(loop)].size());
        };
        for (int k = 0; k < static_cast<int>(loops_.size()); ++k)
            if (k != skirt_ && (vent_ < 0 || distance(k) < distance(vent_))) vent_ = k;
    }

    /// Rings across the seams where radial tapes lead from every line up to the vent, in as many steps; else
    /// the two ends of such rings.
    void find_rings() {
        const auto by_azimuth = [&](std::vector<NodeIndex> loop) {
            std::ranges::stable_sort(loop, {},
                                     [&](NodeIndex i) { return whole_azimuth(out_.mesh.position[i]); });
            return loop;
        };
        out_.skirt = by_azimuth(loops_[static_cast<std::size_t>(skirt_)]);
        if (vent_ >= 0) out_.vent = by_azimuth(loops_[static_cast<std::size_t>(vent_)]);

        auto& rings = out_.mesh.seam_rings = seams();
        if (!rings.empty()) return;
        std::vector<NodeIndex> feet;
        for (const ImportedLine& line : out_.lines)
            if (feet.empty() || feet.back() != line.node.front()) feet.push_back(line.node.front());
        NodeIndex apex = 0;
        for (NodeIndex i = 1; i < out_.mesh.canopy_nodes; ++i)
            if (off_axis(i) < off_axis(apex)) apex = i;
        rings = {out_.vent.empty() ? std::vector<NodeIndex>{apex} : out_.vent, feet};
    }

    /// Empty where seams are not alike.
    std::vector<std::vector<NodeIndex>> seams() const {
        std::map<NodeIndex, std::vector<NodeIndex>> along;
        for (const Cable& c : out_.mesh.cables)
            if (c.kind == CableKind::radial) {
                along[c.node[0]].push_back(c.node[1]);
                along[c.node[1]].push_back(c.node[0]);
            }
        std::vector<std::vector<NodeIndex>> chains;
        for (const ImportedLine& line : out_.lines) {
            std::vector<NodeIndex> chain{line.node.front()};
            for (NodeIndex before = -1;;) {
                const auto at = along.find(chain.back());
                if (at == along.end()) return {};
                std::vector<NodeIndex> ahead = at->second;
                std::erase(ahead, before);
                if (ahead.empty()) break;
                if (ahead.size() > 1 || chain.size() > along.size()) return {};
                before = chain.back();
                chain.push_back(ahead.front());
            }
            if (!chains.empty() && chain.size() != chains.front().size()) return {};
            chains.push_back(std::move(chain));
        }
        std::vector<std::vector<NodeIndex>> rings(chains.front().size());
        for (std::size_t r = 0; r < rings.size(); ++r)
            for (const auto& chain : chains)
                rings[r].push_back(chain[chain.size() - 1 - r]);
        return rings;
    }

    void measure() {
        out_.nominal_area = out_.mesh.fabric_area();
        for (int k = 0; k < static_cast<int>(loops_.size()); ++k) {
            if (k == skirt_) continue;
            const std::vector<NodeIndex>& loop = loops_[static_cast<std::size_t>(k)];
            std::vector<Vec3> ring;
            for (const NodeIndex i : loop)
                ring.push_back(out_.mesh.position[i] - out_.mesh.position[loop.front()]);
            const double area = 0.5 * twice_area(ring).norm();
            if (k == vent_) out_.vent_area = area;
            out_.nominal_area += area;
        }
    }

    const GmshMesh& file_;
    const Scene& scene_;
    const Parachute& chute_;
    ImportedMesh out_;
    std::vector<GmshGroupIndex> group_;            // of GmshMesh::groups
    std::vector<NodeIndex> number_;                // of the file's nodes in the mesh
    std::vector<std::int32_t> in_file_;            // and back
    std::vector<std::int32_t> solid_in_file_;      // of the payload's nodes
    std::set<std::int32_t> confluences_;           // nodes of the file where the payload hangs
    Vec3 origin_ = Vec3::Zero();                   // in their middle [m]
    std::vector<std::int32_t> ends_;               // of cables at the payload, in their order
    std::vector<const GmshElement*> of_triangle_;  // of the mesh
    std::set<Edge> edges_;                         // of the canopy
    std::vector<std::vector<NodeIndex>> loops_;    // edges of openings and the skirt
    std::vector<int> loop_of_;                     // of each node; -1: on none
    int skirt_ = -1;                               // loop that lines are tied to
    int vent_ = -1;                                // loop nearest to the axis; -1: none
};

}  // namespace

ImportedMesh import_mesh(const GmshMesh& file, const Scene& scene) {
    return Importer(file, scene).import();
}

ImportedMesh import_mesh(const Scene& scene) {
    const std::filesystem::path& file = scene.parachutes.front().mesh->file;
    return import_mesh(read_gmsh(read_text_file(file, largest_mesh_file), file.string()), scene);
}

std::vector<Warning> size_warnings(const ImportedMesh& imported, const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    const auto total = [&](CableKind kind) {
        double length = 0.0;
        for (const Cable& c : imported.mesh.cables)
            if (c.kind == kind) length += c.rest_length;
        return length;
    };
    const double lines = static_cast<double>(imported.lines.size());
    double risers = 0.0;
    for (const Cable& c : imported.mesh.cables)
        risers += c.kind == CableKind::riser && std::ranges::count(c.node, imported.mesh.payload()) > 0;
    struct Size {
        const char* key;
        const char* unit;
        double said, meshed;
    };
    const auto diameter = [](double area) { return 2.0 * std::sqrt(area / pi); };
    const double riser_ends = std::max(1.0, risers);
    std::vector<Warning> warnings;
    for (const Size& s :
         {Size{"parachute.nominal_diameter", " m", chute.nominal_diameter, diameter(imported.nominal_area)},
          Size{"parachute.vent_diameter", " m", chute.vent_diameter, diameter(imported.vent_area)},
          Size{"parachute.gores", "", static_cast<double>(chute.gores), lines},
          Size{"parachute.line_length", " m", chute.line_length, total(CableKind::line) / lines},
          Size{"parachute.riser_length", " m", chute.riser_length, total(CableKind::riser) / riser_ends}})
        if (s.said > 0.0 && std::abs(s.meshed - s.said) > noticeable * s.said)
            warnings.push_back(
                {fmt::format("{} says {:.4g}{}, the mesh has {:.4g}{}", s.key, s.said, s.unit, s.meshed,
                             s.unit),
                 "the full model takes its structure from parachute.mesh, the reduced-order model "
                 "and coefficients take what the scene says",
                 "correct the scene, or the mesh"});
    if (const std::size_t count = imported.payload.tetrahedron.size(); count > 0 && !imported.mesh.body)
        warnings.push_back({fmt::format("{} tetrahedra of the payload are left out", count),
                            scene.payload.body ? "payload.body says another shape"
                                               : "the payload is a point mass at the confluence",
                            "take them with payload.body.shape = \"mesh\", or out of the export"});
    return warnings;
}

}  // namespace twinchute::fullsim
