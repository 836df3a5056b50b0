// Reading Gmsh files, and every way in which it can be wrong: the line of the file, the tag, the reason.
#include "fullsim/mesh/import_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/mesh_sketch.hpp"
#include "tests/support/refused_mesh.hpp"

namespace twinchute::fullsim {
namespace {

using test::MeshSketch;

ImportedMesh import(const std::string& text, const Scene& scene = test::c9_scene()) {
    return import_mesh(read_gmsh(text, "own.msh"), scene);
}

/// Number of the only line of a text that begins so.
int line_of(const std::string& text, const std::string& begin) {
    const std::size_t at = ("\n" + text).find("\n" + begin);
    EXPECT_NE(at, std::string::npos) << begin;
    if (at == std::string::npos) return -1;
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

/// The text is refused at this line of its own for something that says all of `words`.
void expect_refused(const std::string& text, int line, const std::vector<std::string>& words,
                    const Scene& scene = test::c9_scene()) {
    test::expect_mesh_refused(text, line, words, scene);
}

TEST(ImportMesh, TakesBothFormatsForTheSame) {
    // By hand from MeshSketch: sides sqrt(9 + 9), lines sqrt(9 + 16), half of 3 x 3 each gore.
    for (const char* version : {"2.2", "4.1"}) {
        SCOPED_TRACE(version);
        const ImportedMesh got = import(MeshSketch().text(version));
        const Mesh& mesh = got.mesh;
        ASSERT_EQ(mesh.node_count(), 7);
        EXPECT_EQ(mesh.canopy_nodes, 5);
        EXPECT_EQ(mesh.position[1], Vec3(3, 0, 5));
        EXPECT_EQ(mesh.position[mesh.payload()], Vec3(0, 0, 0));
        ASSERT_EQ(mesh.triangles.size(), 4u);
        for (const Triangle& t : mesh.triangles)
            EXPECT_NEAR(t.area(), 4.5, 1e-14);
        ASSERT_EQ(mesh.cables.size(), 7u);
        const auto expect = [&](std::size_t i, CableKind kind, double length, double strands) {
            EXPECT_EQ(mesh.cables[i].kind, kind);
            EXPECT_NEAR(mesh.cables[i].rest_length, length, 1e-14);
            EXPECT_EQ(mesh.cables[i].strands, strands);
        };
        expect(0, CableKind::radial, 3.0, 1.0);
        expect(1, CableKind::skirt, std::sqrt(18.0), 1.0);
        for (std::size_t i = 2; i < 6; ++i)
            expect(i, CableKind::line, 5.0, 1.0);
        expect(6, CableKind::riser, 1.0, 4.0);  // as strong as its four lines
        EXPECT_EQ(got.nominal_area, mesh.fabric_area());
        EXPECT_EQ(got.lines.size(), 4u);
        EXPECT_EQ(got.lines[2].node, (std::vector<NodeIndex>{3, 5}));
        EXPECT_EQ(mesh.seam_rings.back().size(), 4u);
        EXPECT_EQ(mesh.seam_rings.front(), std::vector<NodeIndex>{0});  // no vent: the apex
    }
}

TEST(ImportMesh, FollowsLinesThatComeTogether) {
    // The lines of nodes 2 and 3 at 8, from there one strand of their cord; with the other two it makes three
    // on the riser.
    MeshSketch sketch;
    sketch.nodes.push_back({8, {1, 1, 3}});
    sketch.element(31).nodes = {2, 8};
    sketch.element(32).nodes = {3, 8};
    sketch.elements.push_back({35, 3, {8, 6}});
    for (const char* version : {"2.2", "4.1"}) {
        const ImportedMesh got = import(sketch.text(version));
        ASSERT_EQ(got.lines.size(), 4u);
        // From (3, 0, 5) to (1, 1, 3) and on to (0, 0, 1).
        const double own = 3.0, shared = std::sqrt(6.0);
        const NodeIndex link = got.lines[2].node.back(), fork = got.lines[0].node[1];
        EXPECT_EQ(got.lines[0].node, (std::vector<NodeIndex>{1, fork, link}));
        EXPECT_EQ(got.lines[1].node, (std::vector<NodeIndex>{2, fork, link}));
        EXPECT_EQ(got.lines[2].node, (std::vector<NodeIndex>{3, link}));
        for (const std::size_t k : {0u, 1u})
            EXPECT_NEAR(got.lines[k].length(), own + shared, 1e-14);
        for (const Cable& c : got.mesh.cables)
            EXPECT_EQ(c.strands, c.kind == CableKind::riser ? 3.0 : 1.0);
        EXPECT_EQ(std::ranges::count(got.mesh.cables, CableKind::line, &Cable::kind), 5);
    }
}

TEST(ImportMesh, TurnsTrianglesOutsideWhicheverWayTheyWereDrawn) {
    MeshSketch sketch;
    for (MeshSketch::Element& e : sketch.elements)
        if (e.group == 1) std::swap(e.nodes[1], e.nodes[2]);
    const Mesh mesh = import(sketch.text()).mesh;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 p = mesh.position[t.node[0]];
        EXPECT_GT((mesh.position[t.node[1]] - p).cross(mesh.position[t.node[2]] - p).z(), 0.0);
    }
}

TEST(ImportMesh, KnowsAVentAndItsTape) {
    // The apex taken apart into a square hole of 0.5 m2.
    MeshSketch sketch;
    sketch.nodes = {{1, {0.5, 0, 5}},  {2, {3, 0, 5}},    {3, {0, 3, 5}}, {4, {-3, 0, 5}},
                    {5, {0, -3, 5}},   {6, {0, 0, 1}},    {7, {0, 0, 0}}, {8, {0, 0.5, 5}},
                    {9, {-0.5, 0, 5}}, {10, {0, -0.5, 5}}};
    std::erase_if(sketch.elements, [](const auto& e) { return e.group <= 2; });
    const int ring[] = {1, 8, 9, 10}, edge[] = {2, 3, 4, 5};
    for (int g = 0; g < 4; ++g) {
        const int n = (g + 1) % 4;
        sketch.elements.push_back({60 + g, 1, {ring[g], edge[g], edge[n]}});
        sketch.elements.push_back({70 + g, 1, {ring[g], edge[n], ring[n]}});
        sketch.elements.push_back({80 + g, 2, {ring[g], edge[g]}});
        sketch.elements.push_back({90 + g, 2, {ring[g], ring[n]}});
    }
    const ImportedMesh got = import(sketch.text("4.1"));
    EXPECT_NEAR(got.vent_area, 0.5, 1e-14);
    EXPECT_NEAR(got.nominal_area, 18.0, 1e-13);
    EXPECT_EQ(std::ranges::count(got.mesh.cables, CableKind::vent, &Cable::kind), 4);
    EXPECT_EQ(std::ranges::count(got.mesh.cables, CableKind::radial, &Cable::kind), 4);
    ASSERT_EQ(got.mesh.seam_rings.size(), 2u);  // along the radial tapes
    EXPECT_EQ(got.mesh.seam_rings[0].size(), 4u);

    // Lines across it, one metre long, of the suspension lines' material.
    sketch.groups.push_back({6, 1, "vent_line"});
    sketch.elements.push_back({101, 6, {1, 9}});
    sketch.elements.push_back({102, 6, {8, 10}});
    const ImportedMesh held = import(sketch.text("4.1"));
    ASSERT_EQ(std::ranges::count(held.mesh.cables, CableKind::vent_line, &Cable::kind), 2);
    for (const Cable& c : held.mesh.cables)
        if (c.kind == CableKind::vent_line) {
            EXPECT_NEAR(c.rest_length, 1.0, 1e-14);
        }
    EXPECT_EQ(held.mesh.cord(CableKind::vent_line).name, held.mesh.cord(CableKind::line).name);
    sketch.element(102).nodes[1] = 2;  // at the skirt
    const std::string text = sketch.text();
    expect_refused(text, line_of(text, "102 1 "), {"line 102 is a vent line off the vent", "node 2"});
}

/// Square rings about the apex: a centre, a gap from 1.5 m to 2 m, a band.
MeshSketch with_gap() {
    MeshSketch sketch;
    sketch.groups.push_back({6, 2, "gap"});
    int tag = 8;
    for (const double r : {1.5, 2.0})
        for (const Vec3& x : {Vec3(r, 0, 5), Vec3(0, r, 5), Vec3(-r, 0, 5), Vec3(0, -r, 5)})
            sketch.nodes.push_back({tag++, x});
    std::erase_if(sketch.elements, [](const auto& e) { return e.group <= 2; });
    const std::array<std::array<int, 4>, 3> ring{{{8, 9, 10, 11}, {12, 13, 14, 15}, {2, 3, 4, 5}}};
    for (std::size_t g = 0; g < 4; ++g) {
        const std::size_t n = (g + 1) % 4;
        const int at = 100 + 10 * static_cast<int>(g);
        sketch.elements.push_back({at, 1, {1, ring[0][g], ring[0][n]}});
        sketch.elements.push_back({at + 1, 2, {1, ring[0][g]}});
        for (std::size_t k = 0; k < 2; ++k) {
            const int group = k == 0 ? 6 : 1, tags = at + 2 + 3 * static_cast<int>(k);
            sketch.elements.push_back({tags, group, {ring[k][g], ring[k + 1][g], ring[k + 1][n]}});
            sketch.elements.push_back({tags + 1, group, {ring[k][g], ring[k + 1][n], ring[k][n]}});
            sketch.elements.push_back({tags + 2, 2, {ring[k][g], ring[k + 1][g]}});
        }
    }
    return sketch;
}

TEST(ImportMesh, TakesAGapForNoFabric) {
    // A square of the half diagonal r has 2 r^2.
    for (const char* version : {"2.2", "4.1"}) {
        const ImportedMesh got = import(with_gap().text(version));
        EXPECT_NEAR(got.mesh.gap_area(), 2.0 * (4.0 - 2.25), 1e-13);
        EXPECT_NEAR(got.mesh.fabric_area(), 18.0 - 3.5, 1e-13);
        EXPECT_NEAR(got.nominal_area, 18.0, 1e-13);  // D0 counts it
        EXPECT_EQ(got.vent_area, 0.0);
        // Tapes run on across it: rings of seams from the apex to the skirt.
        EXPECT_EQ(std::ranges::count(got.mesh.cables, CableKind::radial, &Cable::kind), 12);
    }
}

TEST(ImportMesh, RefusesAGapWithoutFabricOnBothSides) {
    MeshSketch sketch = with_gap();
    for (auto& e : sketch.elements)  // the band too
        if (e.tag % 10 == 5 || e.tag % 10 == 6) e.group = 6;
    const std::string text = sketch.text();
    expect_refused(text, line_of(text, "105 2 "),
                   {"triangle 105 is a gap at the edge of the canopy", "fabric on both sides"});
    // Nor is a node inside of it held by anything.
    sketch = with_gap();
    sketch.nodes.push_back({16, {1.2, 1.0, 5}});
    MeshSketch::Element& outer = sketch.element(102);  // 8, 12, 13
    const std::vector<int> corner = outer.nodes;
    outer.nodes[2] = 16;
    sketch.elements.push_back({201, 6, {corner[1], corner[2], 16}});
    sketch.elements.push_back({202, 6, {corner[2], corner[0], 16}});
    const std::string floating = sketch.text();
    expect_refused(floating, line_of(floating, "16 1.2 "), {"node 16 in a gap holds nothing"});
    // Without the gap they are two canopies.
    sketch = with_gap();
    std::erase_if(sketch.elements, [](const auto& e) { return e.group == 6; });
    const std::string apart = sketch.text();
    expect_refused(apart, line_of(apart, "105 2 "), {"triangle 105 belongs to a second piece", "'gap'"});
}

// Wrong files. Words of a refusal come from the messages' own grammar: what, where, why.

TEST(ImportMesh, RefusesWhatIsNoGmshFileOfAKnownVersion) {
    const std::string good = MeshSketch().text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    expect_refused("", 1, {"is not a Gmsh file"});
    expect_refused("solid canopy\n", 1, {"is not a Gmsh file"});
    expect_refused(with("2.2 0 8", "4 0 8"), 2, {"unknown version '4'", "2.2 and 4.1 are known"});
    expect_refused(with("2.2 0 8", "2.2 1 8"), 2, {"binary", "Mesh.Binary = 0"});
    expect_refused(with("$EndNodes\n", "$EndNodes\nlost\n"), line_of(good, "$EndNodes") + 1,
                   {"outside of all sections"});
    expect_refused(good + "$Nodes\n1\n1 0 0 0\n$EndNodes\n", line_of(good, "$EndElements") + 1,
                   {"$Nodes stands here twice"});
}

TEST(ImportMesh, RefusesWhatIsCutOffWhereverThatIs) {
    // At every end of a line but the last: each section is needed.
    for (const char* version : {"2.2", "4.1"}) {
        const std::string good = MeshSketch().text(version);
        for (std::size_t at = good.find('\n'); at + 1 < good.size(); at = good.find('\n', at + 1))
            EXPECT_THROW(import(good.substr(0, at + 1)), SceneError) << good.substr(0, at);
    }
    const std::string good = MeshSketch().text();
    const std::size_t at = good.find("33 1 2 3");
    expect_refused(good.substr(0, at), line_of(good, "33 1 2 3") - 1, {"the file ends inside $Elements"});
    expect_refused(good.substr(0, at + 6), line_of(good, "33 1 2 3"), {"cut off"});
}

TEST(ImportMesh, RefusesNumbersThatAreNone) {
    for (const auto& [wrong, says] : {std::pair{"nan", "finite"},
                                      {"-inf", "finite"},
                                      {"1e999", "finite"},
                                      {"3,5", "'3,5' is not a number"},
                                      {"0x3", "'0x3' is not a number"}})
        for (const char* version : {"2.2", "4.1"}) {
            std::string text = MeshSketch().text(version);
            const std::size_t at = text.find("0 3 5\n");
            const int line =
                1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
            expect_refused(text.replace(at, 5, std::string("0 ") + wrong + " 5"), line, {says});
        }
}

TEST(ImportMesh, RefusesCountsThatDoNotFit) {
    const std::string good = MeshSketch().text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    const int end = line_of(good, "$EndNodes");
    expect_refused(with("$Nodes\n7", "$Nodes\n8"), end, {"$Nodes ends too early"});
    expect_refused(with("$Nodes\n7", "$Nodes\n6"), end - 1, {"more lines than it says"});
    expect_refused(with("$Nodes\n7", "$Nodes\n999999999999"), end, {"$Nodes ends too early"});
    expect_refused(with("$Nodes\n7", "$Nodes\n-7"), line_of(good, "$Nodes") + 1,
                   {"'-7' is not a number of nodes"});
    std::string modern = MeshSketch().text("4.1");
    modern.replace(modern.find("2 7 1 99"), 8, "2 9 1 99");
    expect_refused(modern, line_of(modern, "$EndNodes") - 1, {"7 nodes where the section says 9"});
}

struct Mistake {
    const char* what;
    std::function<void(MeshSketch&)> make;
    std::string at;  // begin of the line in format 2.2
    std::vector<std::string> words;
};

const std::vector<Mistake> mistakes{
    {"node twice",
     [](auto& s) {
         s.nodes.push_back({3, {9, 9, 9}});
     },
     "3 9 9 9",
     {"node 3 stands here twice"}},
    {"node far away", [](auto& s) { s.node(3).x.y() = 2e6; }, "3 0 2000000", {"node 3 lies beyond 1e+06 m"}},
    {"node missing",
     [](auto& s) { s.element(32).nodes[0] = 98; },
     "32 ",
     {"line 32 has the node 98, which is not there"}},
    {"element twice",
     [](auto& s) { s.element(33).tag = 32; },
     "32 1 2 3 1 4",
     {"element 32 stands here twice"}},
    {"quadrangle",
     [](auto& s) {
         s.groups[1].name = "tape";
         s.elements.push_back({61, 2, {1, 2}});
     },
     "61 ",
     {"line 61 lies on line 21", "same nodes"}},
    {"no group", [](auto& s) { s.element(33).group = 0; }, "33 ", {"line 33 is in no physical group"}},
    {"group without a name",
     [](auto& s) { s.element(33).group = 44; },
     "33 ",
     {"line 33 is in the group 44, which has no name"}},
    {"unknown group",
     [](auto& s) { s.groups[2].name = "lnie"; },
     "1 3 \"lnie\"",
     {"unknown group 'lnie'", "known: canopy, tape, line", "line"}},
    {"missing group",
     [](auto& s) { std::erase_if(s.elements, [](const auto& e) { return e.group == 3; }); },
     "$MeshFormat",
     {"the group 'line' has no elements"}},
    {"no confluence",
     [](auto& s) {
         s.groups.pop_back();
         s.elements.pop_back();
     },
     "$MeshFormat",
     {"the group 'confluence' is missing", "where the payload hangs"}},
    {"two confluences",
     [](auto& s) {
         s.elements.push_back({52, 5, {6}});
     },
     "52 ",
     {"point 52", "one more confluence"}},
    {"wrong dimension",
     [](auto& s) { s.groups[0].name = "tape"; },
     "2 1 \"tape\"",
     {"'tape' of dimension 2"}},
    {"floating node",
     [](auto& s) {
         s.nodes.push_back({8, {1, 1, 1}});
     },
     "8 ",
     {"node 8 floats freely"}},
    {"point alone holds nothing",
     [](auto& s) {
         s.nodes.push_back({8, {1, 1, 1}});
         s.element(51).nodes[0] = 8;
     },
     "8 ",
     {"node 8 floats freely"}},
    {"same node twice",
     [](auto& s) { s.element(32).nodes[0] = 6; },
     "32 ",
     {"line 32 has the same node twice"}},
    {"no length", [](auto& s) { s.node(6).x = Vec3(0, 0, 0); }, "41 ", {"line 41 has no length"}},
    {"no area", [](auto& s) { s.node(1).x = Vec3(1.5, 1.5, 5); }, "11 ", {"triangle 11 has no area"}},
    {"double triangle",
     [](auto& s) {
         s.elements.push_back({15, 1, {3, 1, 2}});
     },
     "15 ",
     {"triangle 15 lies on triangle 11"}},
    {"turned triangle",
     [](auto& s) { std::swap(s.element(12).nodes[0], s.element(12).nodes[1]); },
     "12 ",
     {"triangle 12 turns the other way round than triangle 11"}},
    {"second canopy",
     [](auto& s) {
         s.nodes.insert(s.nodes.end(), {{81, {9, 0, 5}}, {82, {9, 1, 5}}, {83, {8, 0, 5}}});
         s.elements.push_back({15, 1, {81, 82, 83}});
     },
     "15 ",
     {"triangle 15 belongs to a second piece"}},
    {"upside down",
     [](auto& s) {
         for (auto& n : s.nodes)
             n.x.z() *= -1.0;
     },
     "11 ",
     {"z points from the confluence"}},
    {"line not tied to the skirt",
     [](auto& s) {
         s.nodes.push_back({8, {3, 0, 4.9}});
         s.element(31).nodes[0] = 8;
     },
     "31 ",
     {"line 31 is not tied to the skirt", "no node of its line is on the canopy"}},
    {"line tied to the apex",
     [](auto& s) { s.element(31).nodes[0] = 1; },
     "31 ",
     {"line 31 ends inside the canopy", "node 1"}},
    {"line that ends at nothing",
     [](auto& s) {
         s.nodes.push_back({8, {3, 0, 4}});
         s.element(31).nodes[1] = 8;
     },
     "31 ",
     {"line 31 ends at nothing", "node 8"}},
    {"line back to the canopy",
     [](auto& s) {
         s.element(31).nodes = {2, 4};
     },
     "31 ",
     {"line 31 leads from the canopy back to it"}},
    {"two lines",
     [](auto& s) { std::erase_if(s.elements, [](const auto& e) { return e.tag == 33 || e.tag == 34; }); },
     "31 ",
     {"one of 2 lines"}},
    {"riser that carries nothing",
     [](auto& s) {
         s.nodes.push_back({8, {1, 0, 1}});
         s.elements.push_back({42, 4, {8, 7}});
     },
     "42 ",
     {"line 42 carries no line"}},
    {"riser that leads nowhere",
     [](auto& s) {
         s.nodes.push_back({8, {0, 0, 0.5}});
         s.element(41).nodes = {6, 8};
         s.element(34).nodes = {5, 7};
     },
     "41 ",
     {"line 41 does not lead to the confluence"}},
    {"ring of risers",
     [](auto& s) {
         s.nodes.push_back({8, {1, 0, 0.5}});
         s.elements.push_back({42, 4, {6, 8}});
         s.elements.push_back({43, 4, {8, 7}});
     },
     "42 ",
     {"closes a ring of risers"}},
    {"ring of lines",
     [](auto& s) {
         s.nodes.push_back({8, {1, 1, 3}});
         s.nodes.push_back({9, {1, 0, 2}});
         s.element(31).nodes = {2, 8};
         s.elements.push_back({35, 3, {8, 6}});
         s.elements.push_back({36, 3, {8, 9}});
         s.elements.push_back({37, 3, {9, 6}});
     },
     "36 ",
     {"closes a ring of lines"}},
    {"line between two risers",
     [](auto& s) {
         s.nodes.push_back({8, {1, 0, 0.5}});
         s.elements.push_back({42, 4, {8, 7}});
         s.elements.push_back({35, 3, {6, 8}});
     },
     "35 ",
     {"closes a ring of lines"}},
    {"branch that ends at nothing",
     [](auto& s) {
         s.nodes.push_back({8, {1, 1, 3}});
         s.elements.push_back({35, 3, {6, 8}});
     },
     "35 ",
     {"line 35 is not tied to the skirt"}},
    {"tape off the edges",
     [](auto& s) {
         s.element(22).nodes = {2, 4};
     },
     "22 ",
     {"line 22 is a tape off the canopy's edges"}},
    {"inverted tetrahedron",
     [](auto& s) {
         s.groups.push_back({6, 3, "payload"});
         s.nodes.insert(s.nodes.end(),
                        {{81, {0, 0, -1}}, {82, {1, 0, -1}}, {83, {0, 1, -1}}, {84, {0, 0, -2}}});
         s.elements.push_back({61, 6, {81, 82, 83, 84}});
     },
     "61 ",
     {"tetrahedron 61 is inverted", "-0.167 m^3"}},
    {"flat tetrahedron",
     [](auto& s) {
         s.groups.push_back({6, 3, "payload"});
         s.nodes.insert(s.nodes.end(),
                        {{81, {0, 0, -1}}, {82, {1, 0, -1}}, {83, {0, 1, -1}}, {84, {1, 1, -1}}});
         s.elements.push_back({61, 6, {81, 82, 83, 84}});
     },
     "61 ",
     {"tetrahedron 61 has no volume"}},
};

TEST(ImportMesh, RefusesEveryMistakeAtItsLineWithItsTag) {
    for (const Mistake& mistake : mistakes) {
        SCOPED_TRACE(mistake.what);
        MeshSketch sketch;
        mistake.make(sketch);
        const std::string text = sketch.text();
        int line = line_of(text, mistake.at);
        // Nodes stand before elements, and may begin alike.
        if (const std::string elements = text.substr(text.find("$Elements"));
            mistake.words.front().starts_with("node") == false &&
            elements.find("\n" + mistake.at) != std::string::npos)
            line = line_of(text, "$Elements") + line_of(elements, mistake.at) - 1;
        expect_refused(text, line, mistake.words);
        // The other format refuses it, too.
        EXPECT_THROW(import(sketch.text("4.1")), SceneError);
    }
}

TEST(ImportMesh, RefusesElementsOfOtherKinds) {
    // A quadrangle (3) and a triangle of second order (9), in both formats.
    for (const auto& [type, says] : {std::pair{"3", "a quadrangle (type 3)"},
                                     {"9", "second order (type 9)"},
                                     {"99", "an element of type 99"}}) {
        std::string text = MeshSketch().text();
        const int line = line_of(text, "11 2 2 1");
        text.replace(text.find("\n11 2 2 1") + 1, 8, fmt::format("11 {} 2 1", type));
        expect_refused(text, line, {says});
        std::string modern = MeshSketch().text("4.1");
        const int block = line_of(modern, "2 71 2 1");
        modern.replace(modern.find("\n2 71 2 1") + 1, 8, fmt::format("2 71 {} 1", type));
        expect_refused(modern, block, {says});
    }
}

TEST(ImportMesh, RefusesAnElementInTwoGroups) {
    std::string text = MeshSketch().text("4.1");
    text.replace(text.find("73 0 0 0 0 0 0 1 3 0"), 20, "73 0 0 0 0 0 0 2 3 2 0");
    expect_refused(text, line_of(text, "31 2 6"), {"line 31 is in 2 physical groups"});
}

TEST(ImportMesh, SaysWhichKeysOfTheSceneItNeeds) {
    Scene scene = test::c9_scene();
    scene.parachutes.front().tapes.skirt = {};
    try {
        import(MeshSketch().text(), scene);
        ADD_FAILURE() << "accepted";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "parachute.tapes.skirt");
    }
    scene = test::c9_scene();
    scene.parachutes.front().reefing.push_back({0.1, {}, {}, {Trigger::Kind::time, 1.0, 0.0}});
    expect_refused(MeshSketch().text(), 1, {"the group 'reefing' is missing", "parachute.reefing"}, scene);
    MeshSketch sketch;
    sketch.groups.push_back({6, 1, "reefing"});
    const int edge[] = {2, 3, 4, 5};
    for (int g = 0; g < 4; ++g)
        sketch.elements.push_back({61 + g, 6, {edge[g], edge[(g + 1) % 4]}});
    // pi D_p sqrt(0.1) with D_p = 0.65 8.53 m, in four parts; a cord without mass.
    const ImportedMesh got = import(sketch.text(), scene);
    ASSERT_EQ(got.mesh.reefing_line.size(), 4u);
    for (const std::size_t c : got.mesh.reefing_line) {
        EXPECT_NEAR(got.mesh.cables[c].rest_length, 0.25 * pi * 0.65 * 8.53 * std::sqrt(0.1), 1e-12);
        EXPECT_EQ(got.mesh.cable_mass(c), 0.0);
    }
}

TEST(ImportMesh, WarnsWhereTheSceneSaysOtherSizes) {
    // The square of 18 m2 is no C-9: D0 = 2 sqrt(18/pi) = 4.787 m; 4 lines of 5 m, a riser of 1 m.
    const Scene scene = test::c9_scene();
    const ImportedMesh got = import(MeshSketch().text(), scene);
    std::string all;
    for (const Warning& w : size_warnings(got, scene))
        all += w.what + "\n";
    for (const char* words :
         {"nominal_diameter says 8.53 m, the mesh has 4.787 m", "vent_diameter says 0.853 m",
          "gores says 28, the mesh has 4", "line_length says 7.31 m, the mesh has 5 m",
          "riser_length says 1.22 m, the mesh has 1 m"})
        EXPECT_NE(all.find(words), std::string::npos) << all;
    Scene same = scene;
    Parachute& chute = same.parachutes.front();
    chute.nominal_diameter = 4.79;
    chute.vent_diameter = 0.0;  // not said
    chute.gores = 4;
    chute.line_length = 5.0;
    chute.riser_length = 1.0;
    EXPECT_TRUE(size_warnings(got, same).empty());
    // A node on another, as in a surface that was never merged.
    ImportedMesh slit = got;
    slit.mesh.position[1] = slit.mesh.position[0];
    const std::vector<Warning> warnings = size_warnings(slit, same);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(warnings[0].what.starts_with("1 node of the canopy lies on another, the first at ("))
        << warnings[0].what;
}

}  // namespace
}  // namespace twinchute::fullsim
