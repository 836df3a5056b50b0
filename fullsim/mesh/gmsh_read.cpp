#include "fullsim/mesh/gmsh_read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "fullsim/mesh/gmsh_lines.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double farthest = 1e6;  // [m] of a node; no parachute is as large
constexpr std::int64_t lowest_tag = -GmshLines::largest;

/// Gmsh's kinds of elements; those of `corners` 0 are refused by their names.
struct Kind {
    int type;
    int corners;
    std::string_view name;
};
constexpr Kind kinds[] = {{15, 1, "point"},
                          {1, 2, "line"},
                          {2, 3, "triangle"},
                          {4, 4, "tetrahedron"},
                          {3, 0, "quadrangle"},
                          {5, 0, "hexahedron"},
                          {6, 0, "prism"},
                          {7, 0, "pyramid"},
                          {8, 0, "line of second order"},
                          {9, 0, "triangle of second order"},
                          {11, 0, "tetrahedron of second order"}};

using Tagged = std::pair<int, std::int64_t>;  // dimension and tag

class Reader {
public:
    Reader(std::string_view text, const std::string& file) : lines_(text, file) { mesh_.file = file; }

    GmshMesh read() {
        if (!lines_.next() || lines_.all() != "$MeshFormat")
            lines_.refuse("is not a Gmsh file", "its first line is not $MeshFormat",
                          "export the mesh as .msh, version 4.1 or 2.2, ASCII");
        read_format();
        while (lines_.next()) {
            const std::string section(lines_.all());
            if (!section.starts_with('$') || section.starts_with("$End") || section.size() > 64)
                lines_.refuse("a line outside of all sections", "", "a section begins with a $");
            const std::string name = section.substr(1);
            const auto part = std::ranges::find(parts_, name, &Part::name);
            if (part == std::end(parts_)) {
                skip(name);
                continue;
            }
            if (part->seen)
                lines_.refuse(fmt::format("{} stands here twice", section), "", "keep one of the two");
            part->seen = true;
            (this->*part->read)();
            end_of(name);
        }
        for (const Part& part : parts_)
            if (!part.seen && (part.needed || modern_))
                lines_.refuse(fmt::format("${} is missing", part.name), part.why,
                              "name groups with Physical ... in Gmsh and export again");
        name_groups();
        std::ranges::sort(mesh_.elements, {}, &GmshElement::tag);
        for (std::size_t i = 1; i < mesh_.elements.size(); ++i)
            if (const auto& e = mesh_.elements[i]; e.tag == mesh_.elements[i - 1].tag)
                refuse(
                    std::max(e.line, mesh_.elements[i - 1].line),
                    fmt::format("element {} stands here twice", e.tag),
                    fmt::format("the other one is in line {}", std::min(e.line, mesh_.elements[i - 1].line)),
                    "every element has a tag of its own");
        return std::move(mesh_);
    }

private:
    struct Part {
        std::string_view name;
        void (Reader::*read)();
        bool needed;  // by format 2.2 as well
        const char* why;
        bool seen = false;
    };

    [[noreturn]] void refuse(int line, std::string problem, std::string why, std::string hint) const {
        throw SceneError({mesh_.file, line, 1}, "", std::move(problem), std::move(why), std::move(hint));
    }

    void end_of(const std::string& name) {
        const std::string end = "$End" + name;
        if (!lines_.next()) lines_.cut_off(name);
        if (lines_.all() != end)
            lines_.refuse(fmt::format("{} belongs here", end), "the section has more lines than it says",
                          "export it again");
    }
    void skip(const std::string& name) {
        const std::string end = "$End" + name;
        while (lines_.next())
            if (lines_.all() == end) return;
        lines_.cut_off(name);
    }

    void read_format() {
        lines_.need("MeshFormat");
        const std::string version(lines_[0].substr(0, 20));
        if (version != "2.2" && version != "4.1")
            lines_.refuse(fmt::format("unknown version '{}' of the Gmsh format", version),
                          "2.2 and 4.1 are known", "export with Mesh.MshFileVersion = 4.1");
        modern_ = version == "4.1";
        lines_.need_fields(3, "the format");
        if (lines_.whole(1, "file type", 0, 1) == 1)
            lines_.refuse("a binary Gmsh file", "only ASCII shows its lines to messages and to readers",
                          "export with Mesh.Binary = 0", 1);
        end_of("MeshFormat");
    }

    void read_names() {
        lines_.need("PhysicalNames");
        const std::int64_t count = lines_.whole(0, "number of names", 0);
        for (std::int64_t i = 0; i < count; ++i) {
            lines_.need("PhysicalNames");
            lines_.need_fields(3, "a group");
            const int dimension = static_cast<int>(lines_.whole(0, "dimension", 0, 3));
            const Tagged group{dimension, lines_.whole(1, "tag of a group", 1)};
            std::string_view name = lines_.all();
            name.remove_prefix(std::min(name.find('"'), name.size()));
            if (name.size() < 3 || !name.ends_with('"'))
                lines_.refuse("a group without a name in quotes", "", "write e.g. 2 1 \"canopy\"", 2);
            name = name.substr(1, name.size() - 2);
            if (!group_of_.emplace(group, mesh_.groups.size()).second)
                lines_.refuse(
                    fmt::format("the group {} of dimension {} has two names", group.second, dimension), "",
                    "keep one of the two");
            mesh_.groups.push_back({dimension, std::string(name.substr(0, 80)), lines_.number()});
        }
    }

    void read_entities() {
        lines_.need("Entities");
        lines_.need_fields(4, "the count of entities");
        std::array<std::int64_t, 4> count{};
        for (int d = 0; d < 4; ++d)
            count[d] = lines_.whole(d, "number of entities", 0);
        for (int d = 0; d < 4; ++d)
            for (std::int64_t i = 0; i < count[d]; ++i) {
                lines_.need("Entities");
                const std::size_t box = d == 0 ? 3 : 6;  // a place, or two corners of a box
                lines_.need_fields(box + 2, "an entity");
                const Tagged entity{d, lines_.whole(0, "tag of an entity", lowest_tag)};
                const std::int64_t groups = lines_.whole(box + 1, "number of groups", 0, 1 << 20);
                lines_.need_fields(box + 2 + static_cast<std::size_t>(groups), "an entity");
                std::vector<std::int64_t>& of = groups_of_[entity];
                for (std::int64_t k = 0; k < groups; ++k)
                    // A negative one means the other orientation.
                    of.push_back(std::abs(
                        lines_.whole(box + 2 + static_cast<std::size_t>(k), "tag of a group", lowest_tag)));
            }
    }

    void add_node(std::int64_t tag, int line, std::size_t first) {
        for (std::size_t i = first; i < first + 3; ++i)
            if (std::abs(lines_.real(i)) > farthest)
                lines_.refuse(fmt::format("node {} lies beyond {:g} m", tag, farthest),
                              "coordinates are metres", "correct the mesh", i);
        mesh_.nodes.push_back(
            {tag, {lines_.real(first), lines_.real(first + 1), lines_.real(first + 2)}, line});
    }

    /// In the order of their tags, so that the order of blocks changes nothing.
    void sort_nodes() {
        std::ranges::stable_sort(mesh_.nodes, {}, &GmshNode::tag);
        node_of_.reserve(mesh_.nodes.size());
        for (std::size_t i = 0; i < mesh_.nodes.size(); ++i)
            if (const GmshNode& node = mesh_.nodes[i];
                !node_of_.emplace(node.tag, static_cast<std::int32_t>(i)).second)
                refuse(node.line, fmt::format("node {} stands here twice", node.tag),
                       fmt::format("the other one is in line {}", mesh_.nodes[i - 1].line),
                       "every node has a tag of its own");
    }

    void read_nodes() {
        lines_.need("Nodes");
        if (!modern_) {
            const std::int64_t count = lines_.whole(0, "number of nodes", 1);
            for (std::int64_t i = 0; i < count; ++i) {
                lines_.need("Nodes");
                lines_.need_fields(4, "a node");
                add_node(lines_.whole(0, "tag of a node", 1), lines_.number(), 1);
            }
            return sort_nodes();
        }
        lines_.need_fields(4, "the count of nodes");
        const std::int64_t blocks = lines_.whole(0, "number of blocks", 0);
        const std::int64_t count = lines_.whole(1, "number of nodes", 1);
        for (std::int64_t b = 0; b < blocks; ++b) {
            lines_.need("Nodes");
            lines_.need_fields(4, "a block of nodes");
            const std::int64_t in_block = lines_.whole(3, "number of nodes", 0);
            std::vector<std::pair<std::int64_t, int>> tags;
            for (std::int64_t i = 0; i < in_block; ++i) {
                lines_.need("Nodes");
                tags.emplace_back(lines_.whole(0, "tag of a node", 1), lines_.number());
            }
            for (const auto& [tag, line] : tags) {
                lines_.need("Nodes");
                lines_.need_fields(3, fmt::format("node {}", tag));
                add_node(tag, lines_.number(), 0);
            }
        }
        if (static_cast<std::int64_t>(mesh_.nodes.size()) != count)
            lines_.refuse(fmt::format("{} nodes where the section says {}", mesh_.nodes.size(), count), "",
                          "export it again");
        sort_nodes();
    }

    const Kind& kind_of(std::int64_t type, std::size_t field) const {
        const auto kind = std::ranges::find(kinds, type, &Kind::type);
        if (kind == std::end(kinds) || kind->corners == 0)
            lines_.refuse(kind == std::end(kinds) ? fmt::format("an element of type {}", type)
                                                  : fmt::format("a {} (type {})", kind->name, type),
                          "points, lines, triangles and tetrahedra of first order are known",
                          "mesh with Mesh.ElementOrder = 1 and without recombination", field);
        return *kind;
    }

    /// `groups`: tags of those that it is in.
    void add_element(std::int64_t tag, const Kind& kind, std::size_t first,
                     const std::vector<std::int64_t>& groups) {
        if (node_of_.empty()) lines_.refuse("$Elements before $Nodes", "", "export it again");
        lines_.need_fields(first + static_cast<std::size_t>(kind.corners),
                           fmt::format("{} {}", kind.name, tag));
        GmshElement e{tag, kind.corners, {}, 0, lines_.number()};
        for (int c = 0; c < kind.corners; ++c) {
            const std::size_t field = first + static_cast<std::size_t>(c);
            const std::int64_t node = lines_.whole(field, "tag of a node", 1);
            const auto found = node_of_.find(node);
            if (found == node_of_.end())
                lines_.refuse(fmt::format("{} {} has the node {}, which is not there", kind.name, tag, node),
                              "", "export the mesh with all its nodes", field);
            e.node[static_cast<std::size_t>(c)] = found->second;
        }
        if (groups.size() != 1)
            lines_.refuse(fmt::format("{} {} is in {}", kind.name, tag,
                                      groups.empty() ? "no physical group"
                                                     : fmt::format("{} physical groups", groups.size())),
                          "its group says what it is made of", "put it in exactly one");
        group_tags_.push_back({kind.corners - 1, groups.front()});
        e.group = group_tags_.size() - 1;  // until all names are known
        mesh_.elements.push_back(e);
    }

    void read_elements() {
        lines_.need("Elements");
        if (modern_) return read_element_blocks();
        const std::int64_t count = lines_.whole(0, "number of elements", 1);
        for (std::int64_t i = 0; i < count; ++i) {
            lines_.need("Elements");
            lines_.need_fields(3, "an element");
            const std::int64_t tag = lines_.whole(0, "tag of an element", 1);
            const Kind& kind = kind_of(lines_.whole(1, "type of an element", 1), 1);
            const std::int64_t tags = lines_.whole(2, "number of tags", 0, 1 << 20);
            lines_.need_fields(3 + static_cast<std::size_t>(tags), fmt::format("{} {}", kind.name, tag));
            // The first of the tags is the group's; 0 is none.
            std::vector<std::int64_t> groups;
            if (tags > 0)
                if (const std::int64_t group = lines_.whole(3, "tag of a group", lowest_tag))
                    groups.push_back(std::abs(group));
            add_element(tag, kind, 3 + static_cast<std::size_t>(tags), groups);
        }
    }

    void read_element_blocks() {
        lines_.need_fields(4, "the count of elements");
        const std::int64_t blocks = lines_.whole(0, "number of blocks", 0);
        const std::int64_t count = lines_.whole(1, "number of elements", 1);
        for (std::int64_t b = 0; b < blocks; ++b) {
            lines_.need("Elements");
            lines_.need_fields(4, "a block of elements");
            const Tagged entity{static_cast<int>(lines_.whole(0, "dimension", 0, 3)),
                                lines_.whole(1, "tag of an entity", lowest_tag)};
            const Kind& kind = kind_of(lines_.whole(2, "type of an element", 1), 2);
            const std::int64_t in_block = lines_.whole(3, "number of elements", 0);
            if (kind.corners - 1 != entity.first)
                lines_.refuse(fmt::format("a {} in an entity of dimension {}", kind.name, entity.first), "",
                              "export it again", 2);
            const auto groups = groups_of_.find(entity);
            if (groups == groups_of_.end())
                lines_.refuse(
                    fmt::format("the entity {} of dimension {} is not there", entity.second, entity.first),
                    "$Entities says which groups it is in, and stands before $Elements", "export it again",
                    1);
            for (std::int64_t i = 0; i < in_block; ++i) {
                lines_.need("Elements");
                add_element(lines_.whole(0, "tag of an element", 1), kind, 1, groups->second);
            }
        }
        if (static_cast<std::int64_t>(mesh_.elements.size()) != count)
            lines_.refuse(fmt::format("{} elements where the section says {}", mesh_.elements.size(), count),
                          "", "export it again");
    }

    /// From the tags of groups to their names.
    void name_groups() {
        for (GmshElement& e : mesh_.elements) {
            const Tagged group = group_tags_[e.group];
            const auto found = group_of_.find(group);
            if (found == group_of_.end())
                refuse(e.line,
                       fmt::format("{} {} is in the group {}, which has no name", gmsh_shape(e.corners),
                                   e.tag, group.second),
                       "its group says what it is made of", "name it, e.g. Physical Surface(\"canopy\")");
            e.group = found->second;
        }
    }

    GmshLines lines_;
    bool modern_ = true;  // format 4.1
    GmshMesh mesh_;
    std::map<Tagged, std::size_t> group_of_;                  // index of mesh_.groups
    std::map<Tagged, std::vector<std::int64_t>> groups_of_;   // of an entity
    std::unordered_map<std::int64_t, std::int32_t> node_of_;  // index by tag
    std::vector<Tagged> group_tags_;                          // of the elements
    Part parts_[4] = {{"PhysicalNames", &Reader::read_names, true, "groups say what elements are made of"},
                      {"Entities", &Reader::read_entities, false, "it says which groups elements are in"},
                      {"Nodes", &Reader::read_nodes, true, "there is no mesh without"},
                      {"Elements", &Reader::read_elements, true, "there is no mesh without"}};
};

}  // namespace

std::string_view gmsh_shape(int corners) {
    return std::ranges::find(kinds, corners, &Kind::corners)->name;
}

GmshMesh read_gmsh(std::string_view text, const std::string& file) {
    return Reader(text, file).read();
}

}  // namespace twinchute::fullsim
