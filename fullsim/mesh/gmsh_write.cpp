#include "fullsim/mesh/gmsh_write.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace twinchute::fullsim {
namespace {

constexpr int gmsh_types[] = {0, 15, 1, 2};  // by number of corners

/// Elements of one group.
struct Block {
    GmshGroupIndex group;
    std::vector<std::vector<NodeIndex>> elements;

    int dimension() const { return gmsh_groups[group].dimension; }
    int tag() const { return static_cast<int>(group) + 1; }
    int type() const { return gmsh_types[elements.front().size()]; }
};

GmshGroupIndex group_of(const Mesh& mesh, std::size_t cable) {
    if (std::ranges::binary_search(mesh.reefing_line, cable)) return group_reefing;
    const CableKind kind = mesh.cables[cable].kind;
    return is_tape(kind) ? group_tape : kind == CableKind::line ? group_line : group_riser;
}

std::vector<Block> blocks_of(const Mesh& mesh) {
    std::vector<Block> blocks;
    for (std::size_t g = 0; g < gmsh_groups.size(); ++g)
        blocks.push_back({static_cast<GmshGroupIndex>(g), {}});
    for (const Triangle& t : mesh.triangles)
        blocks[group_canopy].elements.push_back({t.node.begin(), t.node.end()});
    for (std::size_t i = 0; i < mesh.cables.size(); ++i)
        blocks[group_of(mesh, i)].elements.push_back(
            {mesh.cables[i].node.begin(), mesh.cables[i].node.end()});
    blocks[group_payload].elements.push_back({mesh.payload()});
    blocks[group_confluence].elements.push_back({mesh.payload()});
    std::erase_if(blocks, [](const Block& b) { return b.elements.empty(); });
    return blocks;
}

class Writer {
public:
    Writer(const Mesh& mesh, GmshVersion version)
        : mesh_(mesh), modern_(version == GmshVersion::v4_1), blocks_(blocks_of(mesh)) {
        for (const Block& b : blocks_)
            elements_ += b.elements.size();
    }

    std::string write(std::string_view title) {
        add("$MeshFormat\n{} 0 8\n$EndMeshFormat\n", modern_ ? "4.1" : "2.2");
        add("$Comments\ntwinchute: {}\nThe parachute as it is made, without strain: metres, the confluence "
            "at "
            "the origin, the apex on z.\n$EndComments\n",
            title);
        add("$PhysicalNames\n{}\n", blocks_.size());
        for (const Block& b : blocks_)
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
                Vec3 low = mesh_.position[b.elements.front().front()], high = low;
                for (const auto& element : b.elements)
                    for (const NodeIndex i : element) {
                        low = low.cwiseMin(mesh_.position[i]);
                        high = high.cwiseMax(mesh_.position[i]);
                    }
                add("{} {} {} {}", b.tag(), low.x(), low.y(), low.z());
                if (dimension == 0)
                    add(" 1 {}\n", b.tag());
                else
                    add(" {} {} {} 1 {} 0\n", high.x(), high.y(), high.z(), b.tag());
            }
        add("$EndEntities\n");
    }

    void write_nodes() {
        const int count = mesh_.node_count();
        if (modern_) {
            // Canopy, then lines and risers; the payload's node is that of a point.
            const int canopy = mesh_.canopy_nodes, rest = count - 1 - canopy;
            add("$Nodes\n3 {} 1 {}\n", count, count);
            write_block(2, group_canopy, 0, canopy);
            write_block(1, group_line, canopy, rest);
            write_block(0, group_confluence, count - 1, 1);
        } else {
            add("$Nodes\n{}\n", count);
            for (int i = 0; i < count; ++i)
                add("{} {} {} {}\n", i + 1, mesh_.position[i].x(), mesh_.position[i].y(),
                    mesh_.position[i].z());
        }
        add("$EndNodes\n");
    }
    void write_block(int dimension, GmshGroupIndex group, int first, int count) {
        add("{} {} 0 {}\n", dimension, static_cast<int>(group) + 1, count);
        for (int i = first; i < first + count; ++i)
            add("{}\n", i + 1);
        for (int i = first; i < first + count; ++i)
            add("{} {} {}\n", mesh_.position[i].x(), mesh_.position[i].y(), mesh_.position[i].z());
    }

    void write_elements() {
        add("$Elements\n");
        if (modern_)
            add("{} {} 1 {}\n", blocks_.size(), elements_, elements_);
        else
            add("{}\n", elements_);
        std::size_t tag = 0;
        for (const Block& b : blocks_) {
            if (modern_) add("{} {} {} {}\n", b.dimension(), b.tag(), b.type(), b.elements.size());
            for (const auto& element : b.elements) {
                add("{}", ++tag);
                // Two tags: the physical group and the entity.
                if (!modern_) add(" {} 2 {} {}", b.type(), b.tag(), b.tag());
                for (const NodeIndex i : element)
                    add(" {}", i + 1);
                add("\n");
            }
        }
        add("$EndElements\n");
    }

    const Mesh& mesh_;
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
