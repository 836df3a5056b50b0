// A mesh that was written for Gmsh and read again is the same parachute: its lengths, its starts, its runs.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fullsim/canopy/folded_canopy.hpp"
#include "fullsim/mesh/gmsh_write.hpp"
#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/mesh/import_mesh.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/opening.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/mesh_sketch.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::fullsim {
namespace {

Parachute& chute_of(Scene& scene) {
    return scene.parachutes.front();
}

/// The scene with the text of a mesh in place of a generated one.
Scene with_mesh(Scene scene, const ScratchDir& directory, const std::string& text,
                const std::string& name = "own.msh") {
    directory.write(name, text);
    chute_of(scene).mesh = MeshFile{name, directory.path() / name};
    return scene;
}
Scene imported(const Scene& scene, const ScratchDir& directory, GmshVersion version = GmshVersion::v4_1) {
    return with_mesh(scene, directory, gmsh_text(built_mesh(scene), version, scene.name));
}

/// A scene of every way in which gores are meshed.
std::vector<Scene> all_meshes() {
    std::vector<Scene> scenes;
    for (const int columns : {1, 2, 3, 4})
        for (const Grading grading : {Grading::graded, Grading::uniform})
            for (const int risers : {1, 4}) {
                Scene scene = test::c9_scene();
                scene.full.mesh = {columns, 5, 3, 2, grading};
                chute_of(scene).risers = risers;
                scene.name = fmt::format("{} columns, {}, {} risers", columns, grading_name(grading), risers);
                scenes.push_back(scene);
            }
    return scenes;
}

/// With those that no start folds: a disk and a band with a gap between them.
std::vector<Scene> all_shapes() {
    std::vector<Scene> scenes = all_meshes();
    for (Scene scene : all_meshes()) {
        chute_of(scene).type = test::canopy_of_type("disk-gap-band").type;
        scene.name += ", disk-gap-band";
        scenes.push_back(scene);
    }
    return scenes;
}

/// Coordinates of 8 m carry 2e-15 m of rounding, and lengths made of them a few times that.
constexpr double rounding = 5e-14;  // [m]

TEST(ImportedMesh, HasTheLengthsOfTheOneThatWasWritten) {
    const ScratchDir directory;
    const auto expect_same = [](const std::vector<Triangle>& made, const std::vector<Triangle>& read) {
        ASSERT_EQ(read.size(), made.size());
        for (std::size_t i = 0; i < made.size(); ++i) {
            const Triangle &m = made[i], &r = read[i];
            ASSERT_EQ(r.node, m.node);
            EXPECT_NEAR(r.a, m.a, rounding);
            EXPECT_NEAR(r.b, m.b, rounding);
            EXPECT_NEAR(r.c, m.c, rounding);
        }
    };
    for (const Scene& scene : all_shapes()) {
        SCOPED_TRACE(scene.name);
        const Mesh made = start_mesh(scene, inflated(scene.parachutes.front()), Phase::open);
        const Mesh read = import_mesh(imported(scene, directory)).mesh;
        ASSERT_EQ(read.node_count(), made.node_count());
        EXPECT_EQ(read.canopy_nodes, made.canopy_nodes);
        EXPECT_EQ(read.seam_rings, made.seam_rings);
        expect_same(made.triangles, read.triangles);
        expect_same(made.gaps, read.gaps);
        ASSERT_EQ(read.cables.size(), made.cables.size());
        for (std::size_t i = 0; i < made.cables.size(); ++i) {
            const Cable &m = made.cables[i], &r = read.cables[i];
            ASSERT_EQ(r.node, m.node);
            EXPECT_EQ(r.kind, m.kind);
            EXPECT_EQ(r.strands, m.strands);
            EXPECT_NEAR(r.rest_length, m.rest_length, rounding);
        }
        for (std::size_t i = 0; i < made.mass.size(); ++i)
            EXPECT_NEAR(read.mass[i], made.mass[i], 1e-13 * made.mass[i]);
    }
}

TEST(ImportedMesh, StartsWhereTheGeneratedOneDoes) {
    // Drawn out under load, packed, open. Vent nodes of graded canopies start a little off: found by a square
    // root of a small difference, which leaves half of the digits of `rounding` over the vent's height of
    // decimetres.
    const ScratchDir directory;
    for (Scene scene : all_meshes()) {
        SCOPED_TRACE(scene.name);
        for (const DeployBy by : {DeployBy::line_stretch, DeployBy::inflated, DeployBy::static_line}) {
            Deployment& deploy = chute_of(scene).deploy;
            deploy.by = by;
            deploy.pack_ratio = 0.01;
            deploy.static_line_length = 12.2;
            scene.release.path_angle = 1.0;  // along no axis of the coordinates
            const auto start = [&](const Scene& s) {
                const Parachute& p = s.parachutes.front();
                return start_mesh(
                    s, by == DeployBy::inflated ? inflated(p) : make_inflation(s, p, 0.0, 21.0, 1.225),
                    Phase::initial);
            };
            const Mesh made = start(scene), read = start(imported(scene, directory));
            double worst = 0.0;
            for (std::size_t i = 0; i < made.position.size(); ++i)
                worst = std::max(worst, (made.position[i] - read.position[i]).norm());
            EXPECT_LT(worst, 1e-12);
            ASSERT_EQ(read.static_line.position.size(), made.static_line.position.size());
            for (std::size_t i = 0; i < made.static_line.position.size(); ++i)
                EXPECT_LT((made.static_line.position[i] - read.static_line.position[i]).norm(), 1e-12);
            for (std::size_t i = 0; i < made.static_line.mass.size(); ++i)
                EXPECT_NEAR(read.static_line.mass[i], made.static_line.mass[i], 1e-14);
        }
    }
}

TEST(ImportedMesh, WritesTheFileThatItWasReadFrom) {
    const ScratchDir directory;
    for (const Scene& scene : all_shapes()) {
        SCOPED_TRACE(scene.name);
        const std::string text = gmsh_text(built_mesh(scene), GmshVersion::v4_1, scene.name);
        const Scene read = with_mesh(scene, directory, text);
        EXPECT_EQ(gmsh_text(built_mesh(read), GmshVersion::v4_1, scene.name), text);
        // The older format says the same, to the last bit.
        const Scene older = imported(scene, directory, GmshVersion::v2_2);
        EXPECT_EQ(gmsh_text(built_mesh(older), GmshVersion::v4_1, scene.name), text);
    }
}

/// The constructed C-9 with two elements a line, each two lines of it made one from the middle on: the nodes
/// of both middles lie on what they share.
Mesh with_lines_that_come_together(const Scene& scene) {
    Mesh mesh = built_mesh(scene);
    std::vector<Cable*> upper, lower;  // from the skirt, to the link; line by line
    for (Cable& c : mesh.cables)
        if (c.kind == CableKind::line) (mesh.is_canopy(c.node[0]) ? upper : lower).push_back(&c);
    for (std::size_t k = 0; k < upper.size(); k += 2) {
        const NodeIndex fork = upper[k]->node[1], below = upper[k + 1]->node[1];
        const Vec3 link = mesh.position[lower[k]->node[1]];
        mesh.position[fork] = 0.5 * (mesh.position[fork] + mesh.position[below]);
        mesh.position[below] = 0.5 * (mesh.position[fork] + link);
        upper[k + 1]->node[1] = fork;
        lower[k]->node = {fork, below};
    }
    return mesh;
}

TEST(ImportedMesh, CarriesLinesThatComeTogether) {
    // The largest tension of lines is that of what two of them share: twice that of a line of the same
    // parachute without, but for the angle between both. The force on the payload is the same.
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 2, 2, Grading::graded};
    scene.release.speed = 8.0;
    scene.stop = {Trigger::Kind::time, 0.3, 0.0};
    const std::string text = gmsh_text(with_lines_that_come_together(scene), GmshVersion::v4_1, scene.name);
    const Scene together = with_mesh(scene, directory, text, "together.msh"),
                apart = imported(scene, directory);
    EXPECT_EQ(gmsh_text(built_mesh(together), GmshVersion::v4_1, scene.name), text);
    for (const DeployBy by : {DeployBy::line_stretch, DeployBy::inflated}) {
        const auto run = [by](Scene of) {
            chute_of(of).deploy.by = by;
            return test::run_full(of);
        };
        // No piece is longer than the load makes it, and hardly one is slack.
        Scene drawn_out = together;
        chute_of(drawn_out).deploy.by = by;
        const Mesh start = start_mesh(drawn_out, inflated(chute_of(drawn_out)), Phase::open);
        double longest = 0.0, shortest = infinity;
        for (const Cable& c : start.cables) {
            if (c.kind != CableKind::line) continue;
            const double ratio =
                (start.position[c.node[0]] - start.position[c.node[1]]).norm() / c.rest_length;
            longest = std::max(longest, ratio), shortest = std::min(shortest, ratio);
        }
        EXPECT_NEAR(longest, start.line_stretch, 1e-9);
        EXPECT_GT(shortest, 0.995);
        if (by == DeployBy::line_stretch) continue;
        const RunRecord one = run(together), other = run(apart);
        ASSERT_EQ(one.status.code, StatusCode::completed) << one.status.detail;
        EXPECT_NE(one.provenance.instruction_set.find("unstructured"), std::string::npos);
        for (const Warning& warning : one.warnings)
            EXPECT_EQ(warning.what.find("line_length"), std::string::npos) << warning.what;
        EXPECT_NEAR(*one.metric("max_force_N") / *other.metric("max_force_N"), 1.0, 0.01);
        EXPECT_NEAR(*one.metric("max_line_tension_N") / *other.metric("max_line_tension_N"), 2.0, 0.04);
        EXPECT_LT(std::abs(one.energy->residual_fraction), 1e-3);
    }
}

/// A file of the older format with its nodes numbered anew, at random, and its elements in another order.
std::string shuffled(const std::string& text) {
    std::vector<std::string> nodes, elements, head;
    std::istringstream in(text);
    std::vector<std::string>* section = &head;
    for (std::string line; std::getline(in, line);) {
        if (line == "$Nodes" || line == "$Elements") {
            section = line == "$Nodes" ? &nodes : &elements;
            std::getline(in, line);  // their number
        } else if (line.starts_with("$End")) {
            if (section == &head) head.push_back(line);
            section = &head;
        } else {
            section->push_back(line);
        }
    }
    std::mt19937 random(7);
    std::vector<int> tag(nodes.size());
    std::iota(tag.begin(), tag.end(), 1);
    std::ranges::shuffle(tag, random);
    std::ranges::shuffle(elements, random);
    std::vector<std::string> placed(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
        placed[static_cast<std::size_t>(tag[i]) - 1] =
            fmt::format("{}{}", tag[i], nodes[i].substr(nodes[i].find(' ')));
    std::string out = fmt::format("{}\n$Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n", fmt::join(head, "\n"),
                                  nodes.size(), fmt::join(placed, "\n"), elements.size());
    for (const std::string& line : elements) {
        std::istringstream words(line);
        std::vector<int> number{std::istream_iterator<int>(words), {}};
        for (std::size_t k = 5; k < number.size(); ++k)  // after tag, type, two tags of groups
            number[k] = tag[static_cast<std::size_t>(number[k]) - 1];
        out += fmt::format("{}\n", fmt::join(number, " "));
    }
    return out + "$EndElements\n";
}

TEST(ImportedMesh, HasNeighboursNearWhateverTheFilesOrder) {
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    scene.full.mesh = {4, 16, 3, 2, Grading::uniform};
    scene.full.contact = Contact::none;
    chute_of(scene).deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    scene.stop = {Trigger::Kind::time, 0.05, 0.0};
    const std::string text = gmsh_text(built_mesh(scene), GmshVersion::v2_2, scene.name);
    const Scene as_made = with_mesh(scene, directory, text, "as-made.msh"),
                mixed = with_mesh(scene, directory, shuffled(text), "mixed.msh");
    const Mesh a = import_mesh(as_made).mesh, b = import_mesh(mixed).mesh;
    ASSERT_EQ(a.canopy_nodes, b.canopy_nodes);
    EXPECT_NEAR(a.fabric_area(), b.fabric_area(), 1e-12 * a.fabric_area());
    // Numbers at random are a third of all apart in the mean. A front around the canopy has 112 nodes, of
    // 1904, and its neighbours are no further apart than two of them.
    double apart = 0.0;
    for (const Triangle& t : b.triangles)
        for (std::size_t c = 0; c < 3; ++c)
            apart += std::abs(t.node[c] - t.node[(c + 1) % 3]);
    EXPECT_LT(apart / (3.0 * static_cast<double>(b.triangles.size())), 2.0 * 112.0);
    EXPECT_TRUE(
        std::ranges::is_sorted(b.triangles, {}, [](const Triangle& t) { return std::ranges::min(t.node); }));
    // And it is that parachute: sums in another order, a start without slack. Not settled, which folds on the
    // way would take from rounding to 5e-6.
    const auto pull = [](const Scene& of) {
        Simulation simulation(of);
        for (double most = 0.0;; simulation.step_to(of.stop.value)) {
            simulation.evaluate_forces();
            most = std::max(most, simulation.system().riser_force.norm());
            if (simulation.system().time >= of.stop.value) return most;
        }
    };
    EXPECT_GT(pull(as_made), 1000.0);
    EXPECT_NEAR(pull(mixed), pull(as_made), 1e-9 * pull(as_made));
}

TEST(ImportedMesh, CarriesAReefingLine) {
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    chute_of(scene).reefing.push_back({0.1, {}, {}, {Trigger::Kind::time, 1.0, 0.0}});
    const Mesh made = unloaded_mesh(scene), read = unloaded_mesh(imported(scene, directory));
    ASSERT_EQ(read.reefing_line.size(), 28u);
    for (std::size_t k = 0; k < 28; ++k) {
        const Cable &m = made.cables[made.reefing_line[k]], &r = read.cables[read.reefing_line[k]];
        EXPECT_EQ(r.node, m.node);
        EXPECT_EQ(r.rest_length, m.rest_length);
        EXPECT_EQ(r.kind, m.kind);
    }
    EXPECT_NEAR(read.parachute_mass(), made.parachute_mass(), 1e-13);
}

TEST(ImportedMesh, FliesAsTheGeneratedOne) {
    // A smooth opening keeps differences of rounding small: 1e-6 of the peak and its time, as between layouts
    // (contract tests).
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 6, 2};
    scene.stop.value = 2.0;
    const RunRecord made = test::run_full(scene);
    const RunRecord read = test::run_full(imported(scene, directory));
    ASSERT_EQ(read.status.code, StatusCode::completed) << read.status.detail;
    for (const char* metric : {"peak_force_N", "time_to_peak_force_s", "impulse_N_s", "max_line_tension_N"}) {
        ASSERT_TRUE(made.metric(metric)) << metric;
        EXPECT_NEAR(*read.metric(metric), *made.metric(metric), 1e-6 * *made.metric(metric)) << metric;
    }
    EXPECT_LT(std::abs(read.energy->drag_work - made.energy->drag_work),
              1e-6 * std::abs(made.energy->drag_work));
    // One file always gives the same bits.
    const RunRecord again = test::run_full(imported(scene, directory, GmshVersion::v2_2));
    for (const char* metric : {"peak_force_N", "max_line_tension_N", "max_membrane_stress_N_m"})
        EXPECT_EQ(*again.metric(metric), *read.metric(metric)) << metric;
}

TEST(ImportedMesh, FliesReefedAsTheGeneratedOne) {
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 6, 2};
    chute_of(scene).reefing.push_back({0.1, {}, {}, {Trigger::Kind::time, 1.0, 0.0}});
    scene.stop.value = 1.5;
    const RunRecord made = test::run_full(scene), read = test::run_full(imported(scene, directory));
    ASSERT_EQ(read.status.code, StatusCode::completed) << read.status.detail;
    for (const char* metric : {"stage_1_peak_force_N", "max_line_tension_N", "max_reefing_line_tension_N"}) {
        ASSERT_TRUE(made.metric(metric)) << metric;
        EXPECT_NEAR(read.metric(metric).value_or(0.0), *made.metric(metric), 1e-6 * *made.metric(metric))
            << metric;
    }
}

TEST(ImportedMesh, GoresThatDifferRunInTheUnstructuredLayout) {
    // One diagonal the other way: the canopy is the same but for one panel, and so are its loads to a few
    // per mille (the wrinkled panel sees other folds); the layout is the one for any mesh.
    const ScratchDir directory;
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 6, 2};
    scene.stop.value = 2.0;
    Mesh mesh = built_mesh(scene);
    // Two triangles with a common edge ab, whose far corners c and d they are turned to.
    Triangle& one = mesh.triangles[20];
    Triangle* two = nullptr;
    NodeIndex far = -1;
    for (Triangle& t : mesh.triangles) {
        int common = 0;
        for (const NodeIndex i : t.node) {
            const bool shared = std::ranges::count(one.node, i) > 0;
            common += shared;
            if (!shared) far = i;
        }
        if (&t != &one && common == 2 && std::ranges::count(t.node, one.node[0]) &&
            std::ranges::count(t.node, one.node[2])) {
            two = &t;
            break;
        }
    }
    ASSERT_NE(two, nullptr);
    // one = (a, c, b) with the common edge from b to a; two has far.
    const NodeIndex a = one.node[0], c = one.node[1], b = one.node[2];
    one.node = {a, c, far};
    two->node = {far, c, b};
    const Scene uneven = with_mesh(scene, directory, gmsh_text(mesh, GmshVersion::v4_1, "one panel turned"));
    const RunRecord made = test::run_full(scene), read = test::run_full(uneven);
    ASSERT_EQ(read.status.code, StatusCode::completed) << read.status.detail;
    EXPECT_NE(read.provenance.instruction_set.find("unstructured"), std::string::npos)
        << read.provenance.instruction_set;
    EXPECT_NEAR(*read.metric("peak_force_N"), *made.metric("peak_force_N"),
                5e-3 * *made.metric("peak_force_N"));
}

TEST(ImportedMesh, IsDrawnOutOfItsPack) {
    const ScratchDir directory;
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.stop = {Trigger::Kind::line_stretch, 0.0, 0.0};
    const RunRecord made = test::run_full(scene);
    const RunRecord read = test::run_full(imported(scene, directory));
    ASSERT_EQ(read.status.code, StatusCode::completed) << read.status.detail;
    // Folds are chaotic (noise of 1e-12 m tells after snatch), the fall under the static line is not: it
    // takes 1.6 s, of which the run sees a few milliseconds in the slapping of lines.
    EXPECT_NEAR(*read.metric("snatch_time_s"), *made.metric("snatch_time_s"),
                0.02 * *made.metric("snatch_time_s"));
    EXPECT_NEAR(*read.metric("snatch_speed_m_s"), *made.metric("snatch_speed_m_s"),
                0.02 * *made.metric("snatch_speed_m_s"));
}

TEST(ImportedMesh, AFlatCanopyFoldsWithoutGrowing) {
    // Any two points of the fabric come no further apart: folding is piecewise rigid. Over a gore of a
    // pleated canopy their distances along it stay (points on one panel).
    const FoldedCanopy closed = canopy_with_mouth(28, 2, 0.05, 1.0);
    const auto flat = [](double r, double azimuth) {
        return Vec3(r * std::cos(azimuth), r * std::sin(azimuth), 0.0);
    };
    double worst = 0.0;
    for (int k = 0; k < 4000; ++k) {
        const auto part = [&](int n) { return std::fmod(0.754877666 * n * (k + 1) + 0.1 * n, 1.0); };
        const double r = part(1), s = part(2), alpha = 2.0 * pi * part(3), beta = 2.0 * pi * part(5);
        const double before = (flat(r, alpha) - flat(s, beta)).norm();
        EXPECT_LE((closed.folded(r, alpha) - closed.folded(s, beta)).norm(), before + 1e-12);
        // On the first panel.
        const double near = alpha / 56.0, other = beta / 56.0;
        worst = std::max(worst, std::abs((flat(r, near) - flat(s, other)).norm() -
                                         (closed.folded(r, near) - closed.folded(s, other)).norm()));
    }
    EXPECT_LT(worst, 1e-13);
}

TEST(ImportedMesh, OnlyWhatLiesFlatIsFolded) {
    const ScratchDir directory;
    test::MeshSketch cone;
    cone.node(1).x.z() = 6.0;
    Scene scene = with_mesh(test::c9_scene(), directory, cone.text());
    const auto refused = [&](const Scene& s, const char* why) {
        try {
            unloaded_mesh(s);
            ADD_FAILURE() << "accepted";
        } catch (const SceneError& error) {
            EXPECT_EQ(error.key(), "parachute.deploy.by");
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
    };
    refused(scene, "does not lie flat");
    chute_of(scene).deploy.by = DeployBy::static_line;
    refused(scene, "does not lie flat");
    // Open it starts as it is made: the apex 6 m above the confluence, upward of a fall.
    chute_of(scene).deploy.by = DeployBy::inflated;
    const Mesh mesh = start_mesh(scene, inflated(chute_of(scene)), Phase::open);
    EXPECT_LT((mesh.position[0] - Vec3(0, 0, 6)).norm(), 1e-14);
    EXPECT_NEAR((mesh.position[1] - mesh.position[0]).norm(), std::sqrt(10.0), 1e-14);

    test::MeshSketch askew;
    askew.node(3).x = Vec3(1, 2.9, 5);
    refused(with_mesh(test::c9_scene(), directory, askew.text()), "equal angles");
    test::MeshSketch short_lines;
    for (const int i : {1, 2, 3, 4, 5})
        short_lines.node(i).x.z() = 1.2;
    for (const int i : {2, 3, 4, 5})
        short_lines.node(i).x *= 0.02;
    EXPECT_THROW(unloaded_mesh(with_mesh(test::c9_scene(), directory, short_lines.text())), SceneError);
}

}  // namespace
}  // namespace twinchute::fullsim
