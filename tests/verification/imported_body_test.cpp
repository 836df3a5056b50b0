// A payload that was written for Gmsh and read again is the same body, on the same risers.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/gmsh_write.hpp"
#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/solve/opening.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::fullsim {
namespace {

const PayloadBody shapes[] = {{PayloadBody::Shape::box, {0.6, 0.4, 0.9}},
                              {PayloadBody::Shape::cylinder, {0.7, 1.0}}};

Scene scene_with(const PayloadBody& body, int risers) {
    Scene scene = test::c9_scene();
    scene.payload.body = body;
    scene.full.mesh = {2, 5, 4, 2};
    scene.parachutes.front().risers = risers;
    return scene;
}

std::string exported(const Scene& scene, GmshVersion version = GmshVersion::v4_1) {
    Mesh mesh = built_mesh(scene);
    attach_payload(scene, mesh, Hang::as_made);
    return gmsh_text(mesh, version, scene.name);
}

Scene with_body_mesh(Scene scene, const ScratchDir& directory, const std::string& text) {
    directory.write("own.msh", text);
    scene.parachutes.front().mesh = MeshFile{"own.msh", directory.path() / "own.msh"};
    scene.payload.body->shape = PayloadBody::Shape::mesh;
    scene.payload.body->size.clear();
    return scene;
}

TEST(ImportedBody, IsTheOneThatWasWritten) {
    // Mass by construction; inertia, volume and ends to the rounding of places of a metre, lengths to that of
    // 8 m.
    const ScratchDir directory;
    for (const PayloadBody& shape : shapes)
        for (const int risers : {1, 4})
            for (const GmshVersion version : {GmshVersion::v4_1, GmshVersion::v2_2}) {
                SCOPED_TRACE(fmt::format("{} lengths, {} risers", shape.size.size(), risers));
                const Scene scene = scene_with(shape, risers);
                Mesh made = built_mesh(scene);
                attach_payload(scene, made, Hang::as_made);
                const Mesh read =
                    import_mesh(with_body_mesh(scene, directory, exported(scene, version))).mesh;
                const Eigen::Matrix3d& inertia = made.body->lumped.inertia;
                EXPECT_NEAR(read.body->lumped.volume, made.body->lumped.volume, 1e-13);
                EXPECT_LT((read.body->lumped.inertia - inertia).norm(), 1e-13 * inertia.norm());
                ASSERT_EQ(read.body->end.size(), static_cast<std::size_t>(risers));
                for (std::size_t k = 0; k < read.body->end.size(); ++k)
                    EXPECT_LT((read.body->attachments()[k] - made.body->attachments()[k]).norm(), 1e-14);
                ASSERT_EQ(read.cables.size(), made.cables.size());
                for (std::size_t c = 0; c < made.cables.size(); ++c)
                    EXPECT_NEAR(read.cables[c].rest_length, made.cables[c].rest_length, 5e-14);
            }
}

TEST(ImportedBody, StartsAndFliesAsTheOneThatWasWritten) {
    // Drawn out, packed and open; half a second of an opening to what rounding of the start becomes.
    const ScratchDir directory;
    for (const PayloadBody& shape : shapes) {
        Scene scene = scene_with(shape, 4);
        scene.release.path_angle = 1.0;
        const Scene read = with_body_mesh(scene, directory, exported(scene));
        for (const DeployBy by : {DeployBy::line_stretch, DeployBy::inflated, DeployBy::free}) {
            const auto start = [&](Scene s) {
                s.parachutes.front().deploy.by = by;
                s.parachutes.front().deploy.pack_ratio = 0.01;
                return start_mesh(s, inflated(s.parachutes.front()), Phase::open);
            };
            const Mesh a = start(scene), b = start(read);
            ASSERT_EQ(a.position.size(), b.position.size());
            double worst = 0.0;
            for (std::size_t i = 0; i < a.position.size(); ++i)
                worst = std::max(worst, (a.position[i] - b.position[i]).norm());
            for (std::size_t i = 0; i < a.attachments.size(); ++i)
                worst = std::max(worst, (a.attachments[i] - b.attachments[i]).norm());
            // A pack is the parachute that was drawn out times 0.01: links that stand 1.22 m above one point
            // there, and 1.17 m above the body in the file.
            EXPECT_LT(worst, by == DeployBy::free ? 0.01 * 0.06 : 1e-12);
        }
        scene.stop.value = 0.3;
        Scene flown = read;
        flown.stop.value = 0.3;
        const RunRecord one = test::run_full(scene), other = test::run_full(flown);
        ASSERT_EQ(other.status.code, StatusCode::completed) << other.status.detail;
        EXPECT_NEAR(test::last(other, "speed"), test::last(one, "speed"), 1e-6 * test::last(one, "speed"));
    }
}

TEST(ImportedBody, OfAScenePutsRisersWhereTheyLeadInAnyOrder) {
    // The box of a scene on an imported parachute whose risers stand in another order: none crosses another.
    // The file of a point mass, with the elements of its risers backwards.
    const ScratchDir directory;
    Scene scene = scene_with(shapes[0], 4);
    Scene point = scene;
    point.payload.body.reset();
    std::string text = gmsh_text(built_mesh(point), GmshVersion::v2_2, scene.name);
    // Elements "tag 2-node-line 2 tags group entity a b" of the group riser (4): last first.
    std::vector<std::size_t> at;
    for (std::size_t from = text.find("$Elements");
         (from = text.find(" 1 2 4 4 ", from)) != std::string::npos; ++from)
        at.push_back(from);
    ASSERT_EQ(at.size(), 8u);
    std::vector<std::string> ends;
    for (const std::size_t from : at)
        ends.push_back(text.substr(from, text.find('\n', from) - from));
    for (std::size_t k = at.size(); k-- > 0;)
        text.replace(at[k], ends[k].size(), ends[at.size() - 1 - k]);
    directory.write("own.msh", text);
    scene.parachutes.front().mesh = MeshFile{"own.msh", directory.path() / "own.msh"};
    const Mesh mesh = start_mesh(scene, inflated(scene.parachutes.front()), Phase::open);
    const Eigen::Matrix3d frame = frame_along(mesh.axis);
    int risers = 0;
    for (const Cable& c : mesh.cables) {
        if (c.kind != CableKind::riser) continue;
        const NodeIndex place = std::max(c.node[0], c.node[1]);
        if (place < mesh.first_attachment()) continue;
        ++risers;
        // Up the riser to the link, and to the skirt by its first line.
        NodeIndex here = std::min(c.node[0], c.node[1]), before = place;
        while (!mesh.is_canopy(here)) {
            const auto up = std::ranges::find_if(mesh.cables, [&](const Cable& other) {
                return !is_tape(other.kind) && std::ranges::count(other.node, here) > 0 &&
                       std::ranges::count(other.node, before) == 0;
            });
            before = std::exchange(here, up->node[0] == here ? up->node[1] : up->node[0]);
        }
        const Vec3 tied =
            frame.transpose() * mesh.attachments[static_cast<std::size_t>(place - mesh.first_attachment())];
        const Vec3 skirt = frame.transpose() * mesh.position[static_cast<std::size_t>(here)];
        EXPECT_GT(tied.head<2>().normalized().dot(skirt.head<2>().normalized()), 0.5);
    }
    EXPECT_EQ(risers, 4);
}

}  // namespace
}  // namespace twinchute::fullsim
