// A parachute of four gores as a Gmsh file, to be drawn wrong in one place or another.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "lib/math/vec.hpp"

namespace twinchute::test {

/// Content of a Gmsh file, in the words of its formats. Groups have a tag of their own in any dimension.
struct MeshSketch {
    struct Node {
        int tag;
        Vec3 x;
    };
    struct Element {
        int tag, group;
        std::vector<int> nodes;
    };
    struct Group {
        int tag, dimension;
        std::string name;
    };
    std::vector<Group> groups{
        {1, 2, "canopy"}, {2, 1, "tape"}, {3, 1, "line"}, {4, 1, "riser"}, {5, 0, "confluence"}};
    /// A flat square with its apex, lines of one edge to a link, a riser.
    std::vector<Node> nodes{{1, {0, 0, 5}},  {2, {3, 0, 5}}, {3, {0, 3, 5}}, {4, {-3, 0, 5}},
                            {5, {0, -3, 5}}, {6, {0, 0, 1}}, {7, {0, 0, 0}}};
    std::vector<Element> elements{{11, 1, {1, 2, 3}}, {12, 1, {1, 3, 4}}, {13, 1, {1, 4, 5}},
                                  {14, 1, {1, 5, 2}}, {21, 2, {1, 2}},    {22, 2, {2, 3}},
                                  {31, 3, {2, 6}},    {32, 3, {3, 6}},    {33, 3, {4, 6}},
                                  {34, 3, {5, 6}},    {41, 4, {6, 7}},    {51, 5, {7}}};

    Node& node(int tag) { return *std::ranges::find(nodes, tag, &Node::tag); }
    Element& element(int tag) { return *std::ranges::find(elements, tag, &Element::tag); }

    /// In format "2.2" or "4.1". Elements keep their order, those of 4.1 by group.
    std::string text(std::string_view version = "2.2") const;
};

inline std::string MeshSketch::text(std::string_view version) const {
    constexpr int types[] = {0, 15, 1, 2, 4};
    std::string out =
        fmt::format("$MeshFormat\n{} 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", version, groups.size());
    for (const Group& g : groups)
        out += fmt::format("{} {} \"{}\"\n", g.dimension, g.tag, g.name);
    out += "$EndPhysicalNames\n";
    const auto place = [](const Node& n) { return fmt::format("{} {} {}", n.x.x(), n.x.y(), n.x.z()); };
    if (version != "4.1") {
        out += fmt::format("$Nodes\n{}\n", nodes.size());
        for (const Node& n : nodes)
            out += fmt::format("{} {}\n", n.tag, place(n));
        out += fmt::format("$EndNodes\n$Elements\n{}\n", elements.size());
        for (const Element& e : elements)
            out += fmt::format("{} {} 2 {} 1 {}\n", e.tag, types[e.nodes.size()], e.group,
                               fmt::join(e.nodes, " "));
        return out + "$EndElements\n";
    }
    // An entity for each group, under another tag.
    out += "$Entities\n";
    for (int d = 0; d < 4; ++d)
        out += fmt::format("{} ", std::ranges::count(groups, d, &Group::dimension));
    out += "\n";
    for (int d = 0; d < 4; ++d)
        for (const Group& g : groups)
            if (g.dimension == d)
                out += fmt::format("{} 0 0 0 {}1 {}{}\n", g.tag + 70, d > 0 ? "0 0 0 " : "", g.tag,
                                   d > 0 ? " 0" : "");
    // Two blocks, the later nodes first.
    const std::size_t half = nodes.size() / 2;
    out += fmt::format("$EndEntities\n$Nodes\n2 {} 1 99\n", nodes.size());
    for (const bool later : {true, false}) {
        const std::vector<Node> block(nodes.begin() + static_cast<long>(later ? half : 0),
                                      later ? nodes.end() : nodes.begin() + static_cast<long>(half));
        out += fmt::format("2 71 0 {}\n", block.size());
        for (const Node& n : block)
            out += fmt::format("{}\n", n.tag);
        for (const Node& n : block)
            out += place(n) + "\n";
    }
    out += fmt::format("$EndNodes\n$Elements\n{} {} 1 99\n", elements.size(), elements.size());
    for (const Element& e : elements)
        out += fmt::format("{} {} {} 1\n{} {}\n", e.nodes.size() - 1, e.group + 70, types[e.nodes.size()],
                           e.tag, fmt::join(e.nodes, " "));
    return out + "$EndElements\n";
}

}  // namespace twinchute::test
