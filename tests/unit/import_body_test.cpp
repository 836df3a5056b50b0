// The tetrahedra of a payload in a Gmsh file: the body that they are lumped into, and every way in which they
// can be wrong.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/run/fields.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/mesh_sketch.hpp"
#include "tests/support/refused_mesh.hpp"

namespace twinchute::fullsim {
namespace {

using test::MeshSketch;

Scene scene_with_body() {
    Scene scene = test::c9_scene();
    scene.payload.body = PayloadBody{PayloadBody::Shape::mesh, {}};
    return scene;
}

/// Two tetrahedra, tip to tip over a common face, below the confluence.
MeshSketch sketch_with_body() {
    MeshSketch s;
    s.groups.push_back({6, 3, "payload"});
    s.nodes.insert(s.nodes.end(), {{81, {1, 0, -1}}, {82, {0, 1, -1}}, {83, {-1, -1, -1}}, {84, {0, 0, -2}}});
    s.elements.push_back({61, 6, {7, 82, 81, 83}});
    s.elements.push_back({62, 6, {84, 81, 82, 83}});
    return s;
}

ImportedMesh import(const MeshSketch& sketch, const Scene& scene) {
    return import_mesh(read_gmsh(sketch.text(), "own.msh"), scene);
}

TEST(ImportBody, LumpsItsTetrahedra) {
    // By hand: 1/2 m^3 each, symmetric about z = -1; of one that stands on its face, about the middle plane,
    // int z^2 = V/20 (4 heights: 0, 0, 0 and 1 -> (1 + 1)) = V/10.
    const Scene scene = scene_with_body();
    const ImportedMesh got = import(sketch_with_body(), scene);
    ASSERT_TRUE(got.mesh.body);
    const BodyMesh& body = *got.mesh.body;
    EXPECT_NEAR(body.lumped.volume, 1.0, 1e-15);
    EXPECT_LT((*body.middle - Vec3(0, 0, 1)).norm(), 1e-15);
    const Eigen::Matrix3d second =
        0.5 * body.lumped.inertia.trace() * Eigen::Matrix3d::Identity() - body.lumped.inertia;
    EXPECT_NEAR(second(2, 2), 0.1 * scene.payload.mass, 1e-13 * scene.payload.mass);
    ASSERT_EQ(body.end.size(), 1u);
    EXPECT_LT((body.attachments()[0] - Vec3(0, 0, 1)).norm(), 1e-15);
    // The riser is as long as before, and nothing is left out.
    EXPECT_EQ(got.mesh.cables.back().rest_length, 1.0);
    for (const Warning& w : size_warnings(got, scene))
        EXPECT_EQ(w.what.find("left out"), std::string::npos) << w.what;
    // Without payload.body.shape = "mesh" it is left out, and said to be.
    const ImportedMesh bare = import(sketch_with_body(), test::c9_scene());
    EXPECT_FALSE(bare.mesh.body);
    EXPECT_TRUE(std::ranges::any_of(size_warnings(bare, test::c9_scene()), [](const Warning& w) {
        return w.what == "2 tetrahedra of the payload are left out";
    }));
}

TEST(ImportBody, TiesRisersWhereTheFileDoes) {
    // A second riser to another corner, named first in the file: each keeps its own end.
    MeshSketch s = sketch_with_body();
    s.nodes.push_back({8, {0.5, 0, 1}});
    s.elements.push_back({40, 4, {8, 81}});
    s.element(31).nodes = {2, 8};
    s.elements.push_back({52, 5, {81}});
    const ImportedMesh got = import(s, scene_with_body());
    const BodyMesh& body = *got.mesh.body;
    ASSERT_EQ(body.end.size(), 2u);
    std::size_t riser = 0;
    for (const Cable& c : got.mesh.cables) {
        if (std::ranges::count(c.node, got.mesh.payload()) == 0) continue;
        const NodeIndex link = c.node[0] == got.mesh.payload() ? c.node[1] : c.node[0];
        const Vec3 end = body.attachments()[riser++] - *body.middle;
        EXPECT_NEAR((got.mesh.position[link] - end).norm(), c.rest_length, 1e-14);
    }
    EXPECT_EQ(riser, 2u);
    // Hung as made, its centre beside the axis: everything lies to the body as in the file.
    Mesh hung = got.mesh;
    attach_payload(scene_with_body(), hung, Hang::as_made);
    for (const Cable& c : hung.cables) {
        const auto place = [&](NodeIndex i) {
            return i < hung.first_attachment() ? hung.position[i]
                                               : hung.attachments[i - hung.first_attachment()];
        };
        EXPECT_NEAR((place(c.node[1]) - place(c.node[0])).norm(), c.rest_length, 1e-14);
    }
    EXPECT_LT((hung.position[0] - hung.attachments[0] - (Vec3(0, 0, 5) - Vec3(1, 0, -1))).norm(), 1e-14);
}

TEST(ImportBody, IsDrawnWhicheverEndOfARiserIsNamedFirst) {
    // In fields risers lead to the middle of the body: no cell names a node that is not there.
    MeshSketch s = sketch_with_body();
    s.element(41).nodes = {7, 6};
    Scene scene = scene_with_body();
    Mesh mesh = import(s, scene).mesh;
    attach_payload(scene, mesh, Hang::drawn_out);
    const VtuGrid grid = mesh_grid(mesh);
    for (const auto i : grid.connectivity)
        EXPECT_LE(i, mesh.payload());
}

struct BodyMistake {
    const char* what;
    std::function<void(MeshSketch&)> make;
    const char* at;  // the element's line begins so
    std::vector<std::string> words;
};

const BodyMistake body_mistakes[] = {
    {"inverted",
     [](auto& s) {
         s.element(62).nodes = {84, 82, 81, 83};
     },
     "62 ",
     {"tetrahedron 62 is inverted", "-0.5 m^3"}},
    {"flat",
     [](auto& s) {
         s.node(84).x = {0, 0, -1};
     },
     "62 ",
     {"tetrahedron 62 has no volume"}},
    {"twice",
     [](auto& s) {
         s.elements.push_back({63, 6, {82, 83, 81, 7}});
     },
     "63 ",
     {"tetrahedron 63 lies on tetrahedron 61", "both have the same nodes"}},
    {"a second piece",
     [](auto& s) {
         s.nodes.insert(s.nodes.end(), {{91, {1, 0, -3}}, {92, {0, 1, -3}}, {93, {-1, -1, -3}}});
         s.elements.push_back({63, 6, {84, 92, 91, 93}});
     },
     "63 ",
     {"tetrahedron 63 belongs to a second piece of the payload", "tetrahedron 61"}},
    {"riser off the body",
     [](auto& s) {
         s.nodes.push_back({95, {0, 0.5, 0}});
         s.elements.push_back({42, 4, {6, 95}});
         s.elements.push_back({52, 5, {95}});
     },
     "52 ",
     {"point 52 is a confluence off the payload", "node 95"}},
    {"nothing hangs there",
     [](auto& s) {
         s.elements.push_back({52, 5, {84}});
     },
     "52 ",
     {"point 52 is a confluence that carries nothing"}},
};

void expect_refused(const MeshSketch& sketch, const char* at, const std::vector<std::string>& words,
                    const Scene& scene) {
    const std::string text = sketch.text();
    const std::size_t found = text.find(std::string("\n") + at, text.find("$Elements"));
    const auto before = std::count(text.begin(), text.begin() + static_cast<long>(found), '\n');
    test::expect_mesh_refused(text, 2 + static_cast<int>(before), words, scene);
    EXPECT_THROW(import_mesh(read_gmsh(sketch.text("4.1"), "own.msh"), scene), SceneError);
}

TEST(ImportBody, RefusesEveryMistakeWithItsElement) {
    for (const BodyMistake& mistake : body_mistakes) {
        SCOPED_TRACE(mistake.what);
        MeshSketch sketch = sketch_with_body();
        mistake.make(sketch);
        expect_refused(sketch, mistake.at, mistake.words, scene_with_body());
    }
}

TEST(ImportBody, NeedsTetrahedraAndOnePointWithoutThem) {
    try {
        import(MeshSketch(), scene_with_body());
        ADD_FAILURE() << "accepted";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("the group 'payload' has no tetrahedra"), std::string::npos)
            << error.what();
    }
    MeshSketch two = sketch_with_body();
    two.elements.push_back({52, 5, {81}});
    expect_refused(two, "52 ", {"is one more confluence", "payload.body.shape = \"mesh\""}, test::c9_scene());
}

}  // namespace
}  // namespace twinchute::fullsim
