#include "fullsim/mesh/import_mesh.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "fullsim/mesh/canopy_edges.hpp"
#include "fullsim/mesh/import_payload.hpp"
#include "fullsim/mesh/node_order.hpp"
#include "fullsim/mesh/seam_rings.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr std::size_t largest_mesh_file = std::size_t{256} << 20;  // [bytes]

double whole_azimuth(const Vec3& x) {
    const double angle = std::atan2(x.y(), x.x());
    // A direction along x within round-off is the first.
    return angle < -1e-9 ? angle + 2.0 * pi : std::max(0.0, angle);
}

class Importer {
public:
    Importer(const GmshMesh& mesh, const Scene& scene)
        : file_(mesh, scene),
          scene_(scene),
          chute_(scene.parachutes.front()),
          payload_(import_payload(file_, takes_body())) {}

    ImportedMesh import() {
        number_nodes();
        sew_fabric();
        edges_.emplace(file_, out_.mesh, in_file_);
        attach_lines();
        attach_risers();
        find_vent();
        sew_tapes();
        rig_vent_lines();
        cut_to_length();
        if (takes_body()) make_body();
        find_rings();
        measure();
        // As its nodes lie; until here they have been in the order of the file.
        if (!std::ranges::is_sorted(in_file_.begin(), in_file_.begin() + out_.mesh.canopy_nodes))
            std::ranges::stable_sort(out_.mesh.triangles, {},
                                     [](const Triangle& t) { return std::ranges::min(t.node); });
        out_.payload = std::move(payload_.solid);
        return std::move(out_);
    }

private:
    /// At a key of the scene.
    [[noreturn]] void refuse_key(std::string key, std::string problem, std::string why,
                                 std::string hint) const {
        throw SceneError({scene_.file.string(), 0, 0}, std::move(key), std::move(problem), std::move(why),
                         std::move(hint));
    }

    /// The payload is the file's body, not a point mass or what the scene's sizes say.
    bool takes_body() const {
        return scene_.payload.body && scene_.payload.body->shape == PayloadBody::Shape::mesh;
    }
    std::int64_t tag(NodeIndex i) const { return file_.node(in_file_[static_cast<std::size_t>(i)]).tag; }
    NodeIndex node(const GmshElement& e, int corner) const {
        return number_[static_cast<std::size_t>(e.node[static_cast<std::size_t>(corner)])];
    }

    /// Canopy, then lines and risers, the payload last; each in the order of the file's tags, the canopy's in
    /// that of canopy_order().
    void number_nodes() {
        enum Owner : std::uint8_t { nobody, body, other, canopy };
        std::vector<Owner> owner(file_.nodes().size(), nobody);
        for (const GmshElement& e : file_.elements()) {
            if (e.corners == 1) continue;  // a point holds nothing: it only names a node
            const Owner mine = e.corners == 4 ? body : e.corners == 3 ? canopy : other;
            for (int c = 0; c < e.corners; ++c) {
                Owner& who = owner[static_cast<std::size_t>(e.node[static_cast<std::size_t>(c)])];
                who = std::max(who, mine);
            }
        }
        for (std::size_t i = 0; i < owner.size(); ++i)
            if (owner[i] == nobody)
                file_.refuse(file_.nodes()[i].line,
                             fmt::format("node {} floats freely", file_.nodes()[i].tag),
                             "no triangle or edge of a group has it", "take it out, or save groups only");
        for (const GmshElement* e : file_.elements_of(group_confluence))
            if (owner[static_cast<std::size_t>(e->node[0])] == canopy)
                file_.refuse(*e, "is a confluence on the canopy", "lines and risers lie between",
                             "put it where the risers meet");
        number_.assign(owner.size(), -1);
        const auto add = [&](FileNode i, const Vec3& position) {
            number_[static_cast<std::size_t>(i)] = out_.mesh.node_count();
            in_file_.push_back(i);
            out_.mesh.position.push_back(position);
        };
        const auto owned_by = [&](Owner who) {
            std::vector<FileNode> nodes;
            for (FileNode i = 0; i < static_cast<FileNode>(owner.size()); ++i)
                if (owner[static_cast<std::size_t>(i)] == who &&
                    !std::ranges::binary_search(payload_.confluences, i))
                    nodes.push_back(i);
            return nodes;
        };
        for (const FileNode i : canopy_order(file_, owned_by(canopy)))
            add(i, file_.position(i) - payload_.origin);
        out_.mesh.canopy_nodes = out_.mesh.node_count();
        for (const FileNode i : owned_by(other))
            add(i, file_.position(i) - payload_.origin);
        add(payload_.confluences.front(), Vec3::Zero());
        for (const FileNode i : payload_.confluences)
            number_[static_cast<std::size_t>(i)] = out_.mesh.payload();
    }

    void sew_fabric() {
        Vec3 area = Vec3::Zero();
        const auto add = [&](const GmshElement& e, std::vector<Triangle>& to) {
            to.push_back({{node(e, 0), node(e, 1), node(e, 2)}, 0, 0.0, 0.0, 0.0});
            const Vec3& p = file_.position(e.node[0]);
            area += (file_.position(e.node[1]) - p).cross(file_.position(e.node[2]) - p);
        };
        for (const GmshElement* e : file_.elements_of(group_canopy))
            add(*e, out_.mesh.triangles);
        for (const GmshElement* e : file_.elements_of(group_gap))
            add(*e, out_.mesh.gaps);
        double height = 0.0;
        for (NodeIndex i = 0; i < out_.mesh.canopy_nodes; ++i)
            height += out_.mesh.position[i].z();
        if (!(height > 0.0))
            file_.refuse(*file_.elements_of(group_canopy).front(),
                         "and its canopy do not lie above the confluence",
                         "z points from the confluence to the apex", "turn the mesh");
        // Counter-clockwise seen from outside, whichever way the whole surface was drawn.
        if (area.z() < 0.0)
            for (auto* surface : {&out_.mesh.triangles, &out_.mesh.gaps})
                for (Triangle& t : *surface)
                    std::swap(t.node[1], t.node[2]);
    }

    void add_cable(const GmshElement& e, CableKind kind, double strands) {
        out_.mesh.cables.push_back({{node(e, 0), node(e, 1)}, length_of(e), strands, kind});
        for (int c = 0; c < 2; ++c)
            if (node(e, c) == out_.mesh.payload()) ends_.push_back(e.node[static_cast<std::size_t>(c)]);
    }
    /// [m]
    double length_of(const GmshElement& e) const {
        const auto at = [&](std::size_t c) { return Vec3(file_.position(e.node[c]) - payload_.origin); };
        return (at(1) - at(0)).norm();
    }

    using EdgesAt = std::map<NodeIndex, std::vector<const GmshElement*>>;

    /// Edges of a group by their nodes.
    EdgesAt edges_at(GmshGroupIndex group) const {
        EdgesAt at;
        for (const GmshElement* e : file_.elements_of(group))
            for (int c = 0; c < 2; ++c)
                at[node(*e, c)].push_back(e);
        return at;
    }
    NodeIndex other_end(const GmshElement& e, NodeIndex i) const {
        return node(e, 0) == i ? node(e, 1) : node(e, 0);
    }

    bool ends_lines(NodeIndex i, const EdgesAt& risers) const {
        return i == out_.mesh.payload() || risers.contains(i);
    }

    /// Edge by which each node of lines hangs on a riser or on the confluence.
    std::map<NodeIndex, const GmshElement*> edges_below(const EdgesAt& lines, const EdgesAt& risers) const {
        std::map<NodeIndex, const GmshElement*> below;
        std::vector<NodeIndex> order;
        for (const auto& [i, at] : lines)
            if (ends_lines(i, risers)) order.push_back(i);
        for (std::size_t k = 0; k < order.size(); ++k) {
            const NodeIndex here = order[k];
            const auto from = below.find(here);
            for (const GmshElement* e : lines.at(here)) {
                const NodeIndex end = other_end(*e, here);
                if ((from != below.end() && e == from->second) || out_.mesh.is_canopy(end)) continue;
                if (ends_lines(end, risers) || !below.emplace(end, e).second)
                    file_.refuse(*e, "closes a ring of lines", "each line has one way to the confluence",
                                 "take one of its edges out");
                order.push_back(end);
            }
        }
        return below;
    }

    /// The line from `foot` on the canopy, `first` its first edge, to a riser or to the confluence.
    ImportedLine follow_line(NodeIndex foot, const GmshElement* first,
                             const std::map<NodeIndex, const GmshElement*>& below, const EdgesAt& risers,
                             std::set<const GmshElement*>& used) const {
        ImportedLine line{{foot}, {}};
        for (const GmshElement* here = first;;) {
            used.insert(here);
            line.piece.push_back(length_of(*here));
            const NodeIndex end = other_end(*here, line.node.back());
            line.node.push_back(end);
            if (ends_lines(end, risers)) return line;
            if (out_.mesh.is_canopy(end))
                file_.refuse(*here, "leads from the canopy back to it", "a line leads to the confluence",
                             "take it for a tape");
            const auto next = below.find(end);
            if (next == below.end())
                file_.refuse(*here, "ends at nothing",
                             fmt::format("node {} does not hang on a riser or the confluence", tag(end)),
                             "lines lead from the skirt to a riser or to the confluence");
            here = next->second;
        }
    }

    /// Every line runs from the skirt to a riser or to the confluence; several may come together on the way.
    void attach_lines() {
        const EdgesAt lines = edges_at(group_line), risers = edges_at(group_riser);
        const auto below = edges_below(lines, risers);
        std::set<const GmshElement*> used;
        for (const auto& [foot, first] : lines) {
            if (!out_.mesh.is_canopy(foot)) continue;
            const int loop = edges_->loop_of(foot);
            for (const GmshElement* e : first) {
                if (loop < 0)
                    file_.refuse(*e, "ends inside the canopy",
                                 fmt::format("node {} is on none of its edges", tag(foot)),
                                 "tie lines to the skirt");
                if (skirt_ < 0) skirt_ = loop;
                if (loop != skirt_)
                    file_.refuse(*e, "is not tied to the skirt, where other lines are",
                                 fmt::format("node {} is on another edge of the canopy", tag(foot)),
                                 "tie all lines to one edge");
                out_.lines.push_back(follow_line(foot, e, below, risers, used));
            }
        }
        const auto& elements = file_.elements_of(group_line);
        for (const GmshElement* e : elements)
            if (!used.contains(e))
                file_.refuse(*e, "is not tied to the skirt", "no node of its line is on the canopy",
                             "let the line end on a node of the canopy's edge");
        if (out_.lines.size() < 3)
            file_.refuse(*elements.front(), fmt::format("is of one of {} lines", out_.lines.size()),
                         "a canopy hangs on three at least", "tie more lines to the skirt");
        std::ranges::stable_sort(out_.lines, {}, [&](const ImportedLine& line) {
            return whole_azimuth(out_.mesh.position[line.node.front()]);
        });
    }

    /// Risers are a tree that grows from the confluence; each is as strong as the lines that it carries.
    void attach_risers() {
        const EdgesAt risers = edges_at(group_riser), lines = edges_at(group_line);
        std::vector<int> carried(out_.mesh.position.size(), 0);  // lines that end at a node, then above it
        for (const auto& [i, at] : lines)
            if (ends_lines(i, risers)) carried[i] = static_cast<int>(at.size());
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
                    file_.refuse(*e, "closes a ring of risers", "each line has one way to the confluence",
                                 "take one of its edges out");
                if (out_.mesh.is_canopy(end))
                    file_.refuse(*e, "is a riser on the canopy", "lines lie between",
                                 "put it into the group line");
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
                file_.refuse(*e, "carries no line", fmt::format("none ends at or above node {}", tag(end)),
                             "take it out, or tie lines to it");
        }
        for (const GmshElement* e : file_.elements_of(group_riser))
            if (!strands.contains(e))
                file_.refuse(*e, "does not lead to the confluence", "no riser joins it to that point",
                             "close the gap");
        for (const GmshElement* e : file_.elements_of(group_line))
            add_cable(*e, CableKind::line, 1.0);
        for (const GmshElement* e : file_.elements_of(group_riser))
            add_cable(*e, CableKind::riser, strands[e]);
    }

    void sew_tapes() {
        std::vector<Cable> others = std::exchange(out_.mesh.cables, {});
        for (const CableKind kind : {CableKind::radial, CableKind::skirt, CableKind::vent})
            for (const GmshElement* e : file_.elements_of(group_tape)) {
                const NodeIndex a = node(*e, 0), b = node(*e, 1);
                if (!edges_->contains(a, b))
                    file_.refuse(*e, "is a tape off the canopy's edges",
                                 "tapes are sewn on between two nodes",
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
                refuse_key(tape.key, "is missing", fmt::format("{} has such a tape", file_.name()),
                           "name its material");
        sew_reefing();
        out_.mesh.cables.insert(out_.mesh.cables.end(), others.begin(), others.end());
    }

    /// On the skirt, around the vent, or along a seam.
    CableKind tape_kind(NodeIndex a, NodeIndex b) const {
        if (edges_->on_loop(a, b, skirt_)) return CableKind::skirt;
        return edges_->on_loop(a, b, vent_) ? CableKind::vent : CableKind::radial;
    }

    void sew_reefing() {
        if (chute_.reefing.empty()) return;
        if (chute_.tapes.skirt.name.empty())
            refuse_key("parachute.tapes.skirt", "is missing", "the reefing line is of its material",
                       "name its material");
        for (const GmshElement* e : file_.elements_of(group_reefing)) {
            for (int c = 0; c < 2; ++c)
                if (edges_->loop_of(node(*e, c)) != skirt_)
                    file_.refuse(*e, "is a reefing line off the skirt",
                                 fmt::format("node {} is not on it", tag(node(*e, c))),
                                 "let it run around the mouth");
            out_.mesh.reefing_line.push_back(out_.mesh.cables.size());
            add_cable(*e, CableKind::skirt, 1.0);
        }
    }

    /// Straight across the vent, of the lines' material.
    void rig_vent_lines() {
        for (const GmshElement* e : file_.elements_of(group_vent_line)) {
            for (int c = 0; c < 2; ++c)
                if (vent_ < 0 || node(*e, c) >= out_.mesh.canopy_nodes ||
                    edges_->loop_of(node(*e, c)) != vent_)
                    file_.refuse(*e, "is a vent line off the vent",
                                 fmt::format("node {} is not on its edge", tag(node(*e, c))),
                                 "let each cross the vent in one edge");
            add_cable(*e, CableKind::vent_line, 1.0);
        }
    }

    /// The file's lengths are those without strain; that of the reefing line is the scene's.
    void cut_to_length() {
        Mesh& mesh = out_.mesh;
        for (auto* surface : {&mesh.triangles, &mesh.gaps})
            for (Triangle& t : *surface)
                t = laid_flat(t.node,
                              {mesh.position[t.node[0]], mesh.position[t.node[1]], mesh.position[t.node[2]]});
        for (const std::size_t c : mesh.reefing_line)
            mesh.cables[c].rest_length =
                reefing_line_length(chute_, 0) / static_cast<double>(mesh.reefing_line.size());
        mesh.fabric = chute_.fabric;
        mesh.cords = {chute_.tapes.radial, chute_.tapes.skirt, chute_.tapes.vent, chute_.line,
                      chute_.line,         chute_.line,        chute_.line};
        lump_masses(mesh, scene_.payload.mass);
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
            if (!(mesh.mass[static_cast<std::size_t>(i)] > 0.0))
                file_.refuse(file_.node(in_file_[static_cast<std::size_t>(i)]).line,
                             fmt::format("node {} in a gap holds nothing", tag(i)),
                             "no fabric and no tape meets it", "mesh the gap from edge to edge");
    }

    /// About its centre of mass.
    void make_body() {
        BodyMesh& body = out_.mesh.body.emplace();
        body.solid = payload_.solid;
        const Vec3 centre = lump(solid_of(body.solid), scene_.payload.mass).centre;
        for (Vec3& x : body.solid.node)
            x -= centre;
        body.middle = -centre;
        body.lumped = lump(solid_of(body.solid), scene_.payload.mass);
        body.deformable = scene_.payload.body->elasticity.has_value();
        for (const FileNode i : ends_)
            body.end.push_back(
                static_cast<int>(std::ranges::find(payload_.solid_node, i) - payload_.solid_node.begin()));
    }

    const std::vector<NodeIndex>& loop(int k) const { return edges_->loops()[static_cast<std::size_t>(k)]; }
    double off_axis(NodeIndex i) const { return out_.mesh.position[i].head<2>().norm(); }

    /// The opening nearest to the axis; others are windows.
    void find_vent() {
        double nearest = std::numeric_limits<double>::infinity();
        for (int k = 0; k < static_cast<int>(edges_->loops().size()); ++k) {
            if (k == skirt_) continue;
            double sum = 0.0;
            for (const NodeIndex i : loop(k))
                sum += off_axis(i);
            const double distance = sum / static_cast<double>(loop(k).size());
            if (distance < nearest) nearest = distance, vent_ = k;
        }
    }

    /// Rings across the seams where radial tapes lead from every line up to the vent, in as many steps; else
    /// the two ends of such rings.
    void find_rings() {
        const auto by_azimuth = [&](std::vector<NodeIndex> nodes) {
            std::ranges::stable_sort(nodes, {},
                                     [&](NodeIndex i) { return whole_azimuth(out_.mesh.position[i]); });
            return nodes;
        };
        out_.skirt = by_azimuth(loop(skirt_));
        if (vent_ >= 0) out_.vent = by_azimuth(loop(vent_));

        auto& rings = out_.mesh.seam_rings = seam_rings_of(out_.mesh, out_.lines);
        if (!rings.empty()) return;
        std::vector<NodeIndex> feet;
        for (const ImportedLine& line : out_.lines)
            if (feet.empty() || feet.back() != line.node.front()) feet.push_back(line.node.front());
        NodeIndex apex = 0;
        for (NodeIndex i = 1; i < out_.mesh.canopy_nodes; ++i)
            if (off_axis(i) < off_axis(apex)) apex = i;
        rings = {out_.vent.empty() ? std::vector<NodeIndex>{apex} : out_.vent, feet};
    }

    void measure() {
        out_.nominal_area = out_.mesh.fabric_area() + out_.mesh.gap_area();
        for (int k = 0; k < static_cast<int>(edges_->loops().size()); ++k) {
            if (k == skirt_) continue;
            const auto at = [&](std::size_t i) {
                return Vec3(out_.mesh.position[loop(k)[i % loop(k).size()]] - out_.mesh.position[loop(k)[0]]);
            };
            Vec3 twice = Vec3::Zero();  // the vector area of the opening
            for (std::size_t i = 0; i < loop(k).size(); ++i)
                twice += at(i).cross(at(i + 1));
            const double area = 0.5 * twice.norm();
            if (k == vent_) out_.vent_area = area;
            out_.nominal_area += area;
        }
    }

    ImportFile file_;
    const Scene& scene_;
    const Parachute& chute_;
    ImportedPayload payload_;
    ImportedMesh out_;
    std::vector<NodeIndex> number_;     // of the file's nodes in the mesh
    std::vector<FileNode> in_file_;     // and back
    std::vector<FileNode> ends_;        // of cables at the payload, in their order
    std::optional<CanopyEdges> edges_;  // from the time when there are triangles
    int skirt_ = -1;                    // loop that lines are tied to
    int vent_ = -1;                     // loop nearest to the axis; -1: none
};

}  // namespace

ImportedMesh import_mesh(const GmshMesh& file, const Scene& scene) {
    return Importer(file, scene).import();
}

ImportedMesh import_mesh(const Scene& scene) {
    const std::filesystem::path& file = scene.parachutes.front().mesh->file;
    return import_mesh(read_gmsh(read_text_file(file, largest_mesh_file), file.string()), scene);
}

}  // namespace twinchute::fullsim
