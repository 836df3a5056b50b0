// Self-contact of a canopy: which pairs are searched for and looked at, runs that go on, what is refused.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>
#include <span>

#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/self_contact.hpp"
#include "fullsim/laws/self_contact.hpp"
#include "fullsim/serialize_state.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/sheets.hpp"

namespace twinchute::fullsim {
namespace {

Scene coarse_scene() {
    Scene scene = test::c9_scene();
    scene.full.contact = Contact::self;
    scene.full.contact_friction = 0.2;
    scene.full.mesh = {2, 7, 6, 2};
    return scene;
}

void take_steps(Simulation& simulation, int count) {
    for (int k = 0; k < count; ++k) {
        simulation.evaluate_forces();
        simulation.step_to(1.0);
    }
}

TEST(SelfContact, ARunGoesOnToTheSameBitsWithAnyNumberOfThreads) {
    const Scene scene = coarse_scene();
    Simulation whole(scene);
    EXPECT_EQ(whole.layout().name(), "gore-batched");
    take_steps(whole, 1500);
    Archive out;
    whole.serialize(out);
    const std::string bytes = out.take();
    Simulation resumed(scene, [](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
        return make_layout(s, mesh, constants, 2);
    });
    Archive in(bytes, "a test");
    resumed.serialize(in);
    in.end();
    ASSERT_GT(resumed.system().contact.pairs.size(), 0u);
    const auto searches = whole.system().contact.searches;
    EXPECT_EQ(whole.system().contact.looked_at, resumed.system().contact.looked_at);
    EXPECT_EQ(whole.system().contact.velocity_gradient, resumed.system().contact.velocity_gradient);
    EXPECT_GT(resumed.system().contact.velocity_gradient.norm(), 0.1);
    take_steps(whole, 1);
    take_steps(resumed, 1);
    EXPECT_EQ(whole.system().contact.awake.index, resumed.system().contact.awake.index);
    EXPECT_EQ(whole.system().contact.awake.number, resumed.system().contact.awake.number);
    take_steps(whole, 1500);
    take_steps(resumed, 1500);
    EXPECT_GT(whole.system().contact.searches, searches);  // pairs have been found anew in between
    EXPECT_EQ(whole.system().contact.searches, resumed.system().contact.searches);
    EXPECT_EQ(whole.unknowns(), resumed.unknowns());
    EXPECT_EQ(whole.system().energy.damping, resumed.system().energy.damping);
}

TEST(SelfContact, PairsThatSleepDoNotTouch) {
    const Scene scene = coarse_scene();
    Simulation simulation(scene);
    const Mesh& mesh = simulation.mesh();
    std::int64_t asleep = 0, held = 0;
    for (int look = 0; look < 300; ++look) {
        take_steps(simulation, 7);
        simulation.evaluate_forces();
        const State& s = simulation.synchronised_state();
        std::vector<bool> awake(s.contact.pairs.size());
        for (const std::int32_t k : s.contact.awake.index)
            awake[k] = true;
        for (std::size_t k = 0; k < awake.size(); ++k) {
            const NearPair& pair = s.contact.pairs[k];
            if (awake[k]) continue;
            ++asleep;
            if (pair.side == 0) continue;
            const auto& n = mesh.triangles[pair.triangle].node;
            const auto x = [&](NodeIndex i) { return to_vec3(s.node[i].x); };
            const OverTriangle at = over_triangle({x(pair.node), {x(n[0]), x(n[1]), x(n[2])}});
            const bool touches = at.window > 0.0 && overlap_of(at, pair.side, pair.thickness) > 0.0;
            EXPECT_FALSE(touches) << pair.node << ' ' << pair.triangle << ' ' << s.time;
            ++held;
        }
        simulation.step_to(1.0);
    }
    EXPECT_GT(asleep, 1000);
    EXPECT_GT(held, 100);
}

/// Two sheets that lie 5 cm apart, with other nodes.
Sheets parted_sheets(std::span<const Vec3> others) {
    Sheets two(0.0);
    two.add(6, 6, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.12, Vec3(0.013, 0.017, 0.05), Vec3::UnitX(), Vec3::UnitY());
    two.finish(others);
    return two;
}

/// Every pair of a node and a triangle of another sheet that touch is awake. Returns how many do.
int expect_awake_where_they_touch(const Sheets& sheets) {
    const Mesh& mesh = sheets.mesh;
    const SelfContactState& contact = sheets.state.contact;
    const auto x = [&](NodeIndex i) { return to_vec3(sheets.state.node[i].x); };
    std::set<std::pair<NodeIndex, std::int32_t>> awake;
    for (const std::int32_t k : contact.awake.index)
        awake.emplace(contact.pairs[k].node, contact.pairs[k].triangle);
    int touches = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const bool second = triangle.node[0] >= sheets.firsts[1];
        for (NodeIndex i = 0; i < mesh.payload(); ++i) {
            if (mesh.is_canopy(i) && (i >= sheets.firsts[1]) == second) continue;
            const auto& n = triangle.node;
            const OverTriangle at = over_triangle({x(i), {x(n[0]), x(n[1]), x(n[2])}});
            // The thickness of docs/theory/full-model.md.
            if (!(at.window > 0.0) || std::abs(at.gap) > 0.03 * std::sqrt(triangle.a * triangle.c)) continue;
            ++touches;
            EXPECT_TRUE(awake.contains({i, static_cast<std::int32_t>(t)}))
                << i << ' ' << t << ' ' << sheets.state.time;
        }
    }
    return touches;
}

TEST(SelfContact, MissesNoPairThatTouches) {
    // Sheets that are stretched, turned and crumpled through each other, and, every other time, four nodes
    // that shoot through them from afar.
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    const auto random = [&] { return Vec3(one(generator), one(generator), one(generator)); };
    std::vector<Vec3> afar;
    for (int k = 0; k < 4; ++k)
        afar.push_back(Vec3(0.3, 0.3, 0.0) + 0.7 * (2.0 + k) * random().normalized());
    Sheets sheets = parted_sheets(afar);
    const Mesh& mesh = sheets.mesh;
    const int steps_of_a_bout = 400;
    const double dt = 5e-4, pace = pi / (steps_of_a_bout * dt);
    int touches = 0;
    std::int64_t searches = 0;  // while no node shoots
    for (int bout = 0; bout < 8; ++bout) {
        const std::int64_t searches_before = sheets.state.contact.searches;
        Eigen::Matrix3d gradient;
        gradient << 0.4 * random(), 0.4 * random(), 0.4 * random();
        std::vector<Vec3> course;  // away from where each node was, and back
        for (NodeIndex i = 0; i < mesh.payload(); ++i) {
            const Vec3& x = mesh.position[i];
            if (mesh.is_canopy(i))
                course.emplace_back(gradient * x + 0.06 * random());
            else if (bout % 2 == 0)
                course.emplace_back(1.3 * (Vec3(0.3, 0.3, 0.0) + 0.25 * random() - x));
            else
                course.emplace_back(Vec3::Zero());
        }
        for (int k = 1; k <= steps_of_a_bout; ++k) {
            const double s = std::sin(pace * k * dt), rate = pace * std::cos(pace * k * dt);
            for (NodeIndex i = 0; i < mesh.payload(); ++i)
                sheets.put(i, mesh.position[i] + s * course[i], rate * course[i]);
            sheets.see_to_contact(dt);
            if (k % 3 == 0) touches += expect_awake_where_they_touch(sheets);
        }
        if (bout % 2 == 1) searches += sheets.state.contact.searches - searches_before;
    }
    EXPECT_GT(touches, 1000);
    EXPECT_LT(searches, 4 * steps_of_a_bout / 6);  // it does not always search
}

TEST(SelfContact, SeesSheetsThatAnEvenMotionBringsTogether) {
    // A third sheet stands upright: what lies flat has no motion that could be fitted to it across.
    Sheets sheets(0.0);
    sheets.add(6, 6, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    sheets.add(5, 5, 0.12, Vec3(0.013, 0.017, 0.05), Vec3::UnitX(), Vec3::UnitY());
    sheets.add(8, 8, 0.15, Vec3(1.5, -0.3, -0.6), Vec3::UnitY(), Vec3::UnitZ());
    sheets.finish();
    const double rate = 2.0;  // [1/s]
    int touches = 0;
    sheets.glide(
        490, 1e-3, [&](NodeIndex, const Vec3& x) { return Vec3(0.0, 0.0, -rate * x.z()); },
        [&] { touches += expect_awake_where_they_touch(sheets); });
    EXPECT_GT(touches, 1000);
    EXPECT_LT(sheets.state.contact.searches, 10);
}

TEST(SelfContact, SeesANodeThatFliesThroughFabricFromAfar) {
    // Beside which nothing moves that could call for a search.
    const std::vector<Vec3> afar{{0.27, 0.31, 1.0}};
    Sheets sheets = parted_sheets(afar);
    int touches = 0;
    sheets.glide(
        1100, 5e-4,
        [&](NodeIndex i, const Vec3&) { return Vec3(0.0, 0.0, sheets.mesh.is_canopy(i) ? 0.0 : -2.0); },
        [&] { touches += expect_awake_where_they_touch(sheets); });
    EXPECT_GT(touches, 5);
    EXPECT_LT(sheets.state.contact.searches, 20);
}

TEST(SelfContact, NeitherAnEvenStretchNorANodeFarFromFabricIsSearchedFor) {
    const std::vector<Vec3> afar{{0.3, 0.3, 1.0}};
    Sheets sheets = parted_sheets(afar);
    Eigen::Matrix3d gradient;
    gradient << 1.0, 0.3, 0.0, -0.5, 0.8, 0.2, 0.1, 0.0, 0.5;  // [1/s]
    sheets.glide(50, 1e-3,
                 [&](NodeIndex i, const Vec3& x) {  // corners of the sheets go 4 cm, of a skin of 2 cm
                     return sheets.mesh.is_canopy(i) ? Vec3(gradient * x) : Vec3(0.0, 0.0, -5.0);
                 });
    EXPECT_EQ(sheets.state.contact.searches, 1);
}

TEST(SelfContact, AsksForNoPlaceOfANodeThatSleeps) {
    // A layout that keeps nodes elsewhere hands over those that are awake: bits are those of a run in which
    // the records of all nodes are current in every step. Pleats are full triangles.
    Scene scene = coarse_scene();
    scene.full.mesh.gore_columns = 4;
    Simulation alone(scene), watched(scene);
    const ForceModels structure = make_structure(scene, alone.mesh(), alone.system().stage);
    const auto* contact = dynamic_cast<const SelfContact*>(find_block(structure, Block::self_contact));
    ASSERT_TRUE(contact);
    const auto nodes = static_cast<std::size_t>(alone.mesh().payload());
    const auto push_awake = [&](State& state) {
        clear_forces(state);
        contact->push_awake(state);
        std::vector<Vec3> forces;
        for (std::size_t i = 0; i < nodes; ++i)
            forces.push_back(to_vec3(state.force[i].value));
        return forces;
    };
    /// As SelfContact::sleeps_on takes it.
    const auto strayed_squared = [&](const State& now) {
        const std::vector<double>& before = now.contact.looked_at;
        const LinearMotion motion = SelfContact::motion(now);
        double most = 0.0;
        for (std::size_t i = 0, n = before.size() / 4; i < nodes; ++i)
            most = std::max(
                most, (before[3 * n + i] * (to_vec3(now.node[i].x) -
                                            motion.place_of({before[i], before[n + i], before[2 * n + i]})))
                          .squaredNorm());
        return most;
    };
    std::mt19937 generator(5);
    std::int64_t asleep = 0, pushed = 0, looks = 0;
    for (int k = 0; k < 6000; ++k) {
        take_steps(alone, 1);
        // Pairs are looked at where a node has gone so far that others may not sleep, and only there.
        const State& before = watched.synchronised_state();
        const double strayed = strayed_squared(before);
        const bool may_sleep = k > 0 && contact->sleeps_on(before, strayed * (1.0 + 1e-9));
        const bool may_look = k == 0 || !contact->sleeps_on(before, strayed * (1.0 - 1e-9));
        watched.evaluate_forces();
        const State& now = watched.synchronised_state();
        const bool looked = now.contact.look_time == now.time;
        ASSERT_TRUE(looked ? may_look : may_sleep) << k;
        looks += looked ? 1 : 0;
        watched.step_to(1.0);
        if (k % 97 != 0) continue;
        // Nor does it read one that is not marked, even where sides are undecided or those of neighbours
        // contradict, so that all of them are asked.
        State all = alone.synchronised_state();
        for (NearPair& pair : all.contact.pairs)
            pair.side *= static_cast<int>(generator() % 3) - 1;
        all.contact.looked_at.clear();
        contact->prepare(all);
        std::vector<bool> awake(all.node.size(), false);
        contact->mark_awake_nodes(all.contact, awake);
        State some = all;
        for (std::size_t i = 0; i < nodes; ++i) {
            if (awake[i]) continue;
            some.node[i] = {splat(std::nan("")), splat(std::nan(""))};
            ++asleep;
        }
        const std::vector<Vec3> expected = push_awake(all), found = push_awake(some);
        ASSERT_EQ(found, expected) << k;
        pushed += std::ranges::count_if(expected, [](const Vec3& f) { return !f.isZero(0.0); });
        for (std::size_t i = 0; i < all.contact.pairs.size(); ++i)
            ASSERT_EQ(some.contact.pairs[i].side, all.contact.pairs[i].side) << k;
    }
    EXPECT_GT(asleep, 1000);
    EXPECT_GT(pushed, 100);
    EXPECT_GT(looks, 20);
    EXPECT_EQ(alone.unknowns(), watched.unknowns());
    EXPECT_EQ(alone.system().contact.searches, watched.system().contact.searches);
}

TEST(SelfContact, IsKnownToTheBoundOfTheFirstStep) {
    // Folds of a canopy at line stretch are near each other.
    Scene scene = coarse_scene();
    const Simulation simulation(scene);
    EXPECT_EQ(simulation.system().contact.searches, 1);
    scene.full.contact = Contact::none;
    const Simulation without(scene);
    EXPECT_LT(simulation.bound().dt, without.bound().dt);
}

TEST(SelfContact, NeedsAStartThatIsDrawnOutAndTheWholeCanopy) {
    const std::filesystem::path scenes = TWINCHUTE_SOURCE_DIR "/data/scenes";
    const auto key_of = [&](const char* scene, std::vector<std::string> set) -> std::string {
        try {
            read_scene(scenes / scene, set);
        } catch (const SceneError& error) {
            return error.key();
        }
        return "";
    };
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact='self'", "full.symmetry='none'"}), "");
    EXPECT_EQ(key_of("c9-window.toml", {"full.contact='self'"}), "");  // an imported mesh
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact='self'", "full.symmetry='sector'"}),
              "full.symmetry");
    EXPECT_EQ(key_of("paper/crane-drop.toml", {"full.contact='self'"}), "full.contact");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact=self", "full.contact_friction=-0.1"}),
              "full.contact_friction");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact_friction=0.1"}), "full.contact_friction");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact=self", "full.contact_friction=0.1"}), "");
}

}  // namespace
}  // namespace twinchute::fullsim
