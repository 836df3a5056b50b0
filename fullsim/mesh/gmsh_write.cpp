#include "fullsim/mesh/gmsh_write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace twinchute::fullsim {
namespace {

constexpr int gmsh_types[] = {0, 15, 1, 2, 4};  // by number of corners

/// Elements of one group on one entity. Their nodes are numbered as the file counts them, from 0.
struct Block {
    GmshGroupIndex group;
    std::vector<std::vector<NodeIndex>> elements;
    int entity = 0;  // tag

    int dimension() const { return static_cast<int>(elements.front().size()) - 1; }
    int tag() const { return static_cast<int>(group) + 1; }
    int type() const { return gmsh_types[elements.front().size()]; }
};

GmshGroupIndex group_of(const Mesh& mesh, std::size_t cable) {
    if (std::ranges::binary_search(mesh.reefing_line, cable)) return group_reefing;
    const CableKind kind = mesh.cables[cable].kind;
    if (is_tape(kind)) return group_tape;
    return kind == CableKind::line        ? group_line
           : kind == CableKind::vent_line ? group_vent_line
                                          : group_riser;
}

/// A body that the parachute hangs on.
const BodyMesh* body_of(const Mesh& mesh) {
    return mesh.attachments.empty() ? nullptr : &*mesh.body;
}

/// The number in the file of what a cable ends at: a body's nodes take the place of the payload's.
NodeIndex in_file(const Mesh& mesh, NodeIndex i) {
    return i < mesh.first_attachment() ? i : mesh.payload() + mesh.body->node_of(i - mesh.first_attachment());
}

std::vector<Block> blocks_of(const Mesh& mesh) {
    std::vector<Block> blocks;
    for (std::size_t g = 0; g < gmsh_groups.size(); ++g)
        blocks.push_back({static_cast<GmshGroupIndex>(g), {}, static_cast<int>(g) + 1});
    for (const Triangle& t : mesh.triangles)
        blocks[group_canopy].elements.push_back({t.node.begin(), t.node.end()});
    for (const Triangle& t : mesh.gaps)
        blocks[group_gap].elements.push_back({t.node.begin(), t.node.end()});
    for (std::size_t i = 0; i < mesh.cables.size(); ++i) {
        const auto& node = mesh.cables[i].node;
        blocks[group_of(mesh, i)].elements.push_back({in_file(mesh, node[0]), in_file(mesh, node[1])});
    }
    std::vector<NodeIndex> confluences{mesh.payload()};
    if (const BodyMesh* body = body_of(mesh)) {
        for (const auto& corner : body->solid.tetrahedron) {
            auto& t = blocks[group_payload].elements.emplace_back();
            for (const int c : corner)
                t.push_back(mesh.payload() + c);
        }
        confluences.clear();
        for (const int end : body->end)
            confluences.push_back(mesh.payload() + end);
        std::ranges::sort(confluences);
        confluences.erase(std::unique(confluences.begin(), confluences.end()), confluences.end());
    } else {
        blocks[group_payload].elements.push_back({mesh.payload()});
    }
    // An entity of dimension 0 has one point.
    for (const NodeIndex i : confluences) {
        Block& block = i == confluences.front() ? blocks[group_confluence] : blocks.emplace_back();
        block = {group_confluence, {{i}}, group_confluence + 1 + static_cast<int>(i - confluences.front())};
    }
    std::erase_if(blocks, [](const Block& b) { return b.elements.empty(); });
    return blocks;
}

/// Nodes as the file counts them [m].
std::vector<Vec3> nodes_of(const Mesh& mesh) {
    std::vector<Vec3> nodes = mesh.position;
    const BodyMesh* body = body_of(mesh);
    if (!body) return nodes;
    nodes.pop_back();
    nodes.insert(nodes.end(), body->solid.node.begin(), body->solid.node.end());
    return nodes;
}

class Writer {
public:
    Writer(const Mesh& mesh, GmshVersion version)
        : mesh_(mesh),
          nodes_(nodes_of(mesh)),
          modern_(version == GmshVersion::v4_1),
          blocks_(blocks_of(mesh)) {
        for (const Block& b : blocks_)
            elements_ += b.elements.size();
    }

    std::string write(std::string_view title) {
        add("$MeshFormat\n{} 0 8\n$EndMeshFormat\n", modern_ ? "4.1" : "2.2");
        add("$Comments\ntwinchute: {}\nThe parachute as it is made, without strain: metres, the {} "
            "at "
            "the origin, the apex on z.\n$EndComments\n",
            title, body_of(mesh_) ? "payload's centre" : "confluence");
        std::vector<Block> groups = blocks_;
        const auto same = [](const Block& a, const Block& b) { return a.group == b.group; };
        groups.erase(std::unique(groups.begin(), groups.end(), same), groups.end());
        add("$PhysicalNames\n{}\n", groups.size());
        for (const Block& b : groups)
            add("{} {} \"{}\"\n", b.dimension(), b.tag(), gmsh_groups[b.group].name);
        add("$EndPhysicalNames\n");
        if (modern_) write_entities();
        write_nodes();
        write_elements();
        return std::move(text_);
    }

private:
    template <class... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    }

    /// One for each group, under the group's tag.
    void write_entities() {
        std::array<int, 4> count{};
        for (const Block& b : blocks_)
            ++count[static_cast<std::size_t>(b.dimension())];
        add("$Entities\n{} {} {} {}\n", count[0], count[1], count[2], count[3]);
        for (int dimension = 0; dimension < 4; ++dimension)
            for (const Block& b : blocks_) {
                if (b.dimension() != dimension) continue;
                Vec3 low = nodes_[b.elements.front().front()], high = low;
                for (const auto& element : b.elements)
                    for (const NodeIndex i : element) {
                        low = low.cwiseMin(nodes_[i]);
                        high = high.cwiseMax(nodes_[i]);
                    }
                add("{} {} {} {}", b.entity, low.x(), low.y(), low.z());
                if (dimension == 0)
                    add(" 1 {}\n", b.tag());
                else
                    add(" {} {} {} 1 {} 0\n", high.x(), high.y(), high.z(), b.tag());
            }
        add("$EndEntities\n");
    }

    void write_nodes() {
        const int count = static_cast<int>(nodes_.size());
        if (modern_) {
            // Canopy, then lines and risers; the payload's node is that of a point, a body has its own.
            const int canopy = mesh_.canopy_nodes, rest = mesh_.payload() - canopy;
            add("$Nodes\n3 {} 1 {}\n", count, count);
            write_block(2, group_canopy, 0, canopy);
            write_block(1, group_line, canopy, rest);
            if (body_of(mesh_))
                write_block(3, group_payload, mesh_.payload(), count - mesh_.payload());
            else
                write_block(0, group_confluence, mesh_.payload(), 1);
        } else {
            add("$Nodes\n{}\n", count);
            for (int i = 0; i < count; ++i)
                add("{} {} {} {}\n", i + 1, nodes_[i].x(), nodes_[i].y(), nodes_[i].z());
        }
        add("$EndNodes\n");
    }
    void write_block(int dimension, GmshGroupIndex group, int first, int count) {
        add("{} {} 0 {}\n", dimension, static_cast<int>(group) + 1, count);
        for (int i = first; i < first + count; ++i)
            add("{}\n", i + 1);
        for (int i = first; i < first + count; ++i)
            add("{} {} {}\n", nodes_[i].x(), nodes_[i].y(), nodes_[i].z());
    }

    void write_elements() {
        add("$Elements\n");
        if (modern_)
            add("{} {} 1 {}\n", blocks_.size(), elements_, elements_);
        else
            add("{}\n", elements_);
        std::size_t tag = 0;
        for (const Block& b : blocks_) {
            if (modern_) add("{} {} {} {}\n", b.dimension(), b.entity, b.type(), b.elements.size());
            for (const auto& element : b.elements) {
                add("{}", ++tag);
                // Two tags: the physical group and the entity.
                if (!modern_) add(" {} 2 {} {}", b.type(), b.tag(), b.entity);
                for (const NodeIndex i : element)
                    add(" {}", i + 1);
                add("\n");
            }
        }
        add("$EndElements\n");
    }

    const Mesh& mesh_;
    std::vector<Vec3> nodes_;
    bool modern_;
    std::vector<Block> blocks_;
    std::size_t elements_ = 0;
    std::string text_;
};

}  // namespace

std::string gmsh_text(const Mesh& mesh, GmshVersion version, std::string_view title) {
    return Writer(mesh, version).write(title);
}

}  // namespace twinchute::fullsim
