// Canopies that share a payload in the full model: what one alone does with its share, the share of load that
// the reduced-order model gives each, and the laws of motion of all of them together.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fullsim/cluster.hpp"
#include "fullsim/fidelity.hpp"
#include "fullsim/time/energy.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/momentum.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

/// As many C-9 as that, each with the payload of one.
Scene cluster_of(int count) {
    Scene scene = test::c9_scene();
    scene.payload.mass *= count;
    scene.parachutes.front().count = count;
    scene.full.contact = Contact::gores;
    scene.full.line_substeps = 8;
    return scene;
}

/// The scene with a box on the one point where its canopies meet.
Scene on_a_box(Scene scene) {
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {1.2, 0.8, 0.6}};
    return scene;
}

void fly_until(Cluster& cluster, double end) {
    while (cluster.front().system().time < end) {
        cluster.evaluate_forces();
        for (std::size_t k = 0; k < cluster.size(); ++k) {
            Simulation& canopy = cluster[k];
            while (canopy.system().time >= canopy.inflation().end_of(canopy.system().phase))
                canopy.begin(canopy.inflation().after(canopy.system().phase));
        }
        double next = end;
        for (std::size_t k = 0; k < cluster.size(); ++k)
            next = std::min(next, cluster[k].inflation().end_of(cluster[k].system().phase));
        cluster.step_to(next);
        ASSERT_FALSE(cluster.fault()) << cluster.fault()->detail;
    }
}

TEST(Clusters, CanopiesStandClearOfEachOtherAtTheStart) {
    for (const int count : {2, 3, 5}) {
        const Scene scene = cluster_of(count);
        const Cluster cluster(scene);
        for (std::size_t i = 0; i < cluster.size(); ++i)
            for (std::size_t j = i + 1; j < cluster.size(); ++j) {
                const PressedNodes a = cluster[i].canopy_nodes(), b = cluster[j].canopy_nodes();
                std::vector<Lanes> on_a(a.node.size()), on_b(b.node.size());
                EXPECT_GT(press_apart(a, b, on_a, on_b).gap, 0.0) << i << ' ' << j << " of " << count;
            }
    }
}

TEST(Clusters, TheyCarryOnePayload) {
    // Its parts have one place and one velocity to the last bit, in steps with and without subcycles, and one
    // attitude where it turns.
    for (const int substeps : {1, 8})
        for (const bool turns : {false, true}) {
            Scene scene = cluster_of(3);
            scene.parachutes.front().lag = {0.0, 0.05, 0.1};
            scene.full.line_substeps = substeps;
            if (turns) scene = on_a_box(scene);
            Cluster cluster(scene);
            fly_until(cluster, 0.1);
            const SystemState& first = cluster.front().system();
            for (std::size_t k = 1; k < cluster.size(); ++k) {
                for (int c = 0; c < 3; ++c) {
                    EXPECT_EQ(cluster[k].payload().x[c], cluster.front().payload().x[c]);
                    EXPECT_EQ(cluster[k].payload().v[c], cluster.front().payload().v[c]);
                }
                ASSERT_EQ(cluster[k].system().body.has_value(), turns);
                if (!turns) continue;
                EXPECT_EQ(cluster[k].system().body->attitude, first.body->attitude);
                EXPECT_EQ(cluster[k].system().body->momentum, first.body->momentum);
                EXPECT_EQ(cluster[k].pivot(), cluster.front().pivot());
            }
            if (turns) {
                EXPECT_GT(first.body->momentum.norm(), 0.0);
            }
        }
}

TEST(Clusters, AngularMomentumIsKeptOverABodyThatTurns) {
    // In vacuum, about the centre of mass of all: gravity has no moment there. Canopies with noise pull
    // unevenly, the body turns; rounding is what is left.
    Scene scene = on_a_box(cluster_of(2));
    scene.full.line_substeps = 1;
    scene.release.path_angle = 0.3;
    scene.full.noise = Noise{1e-2, 3};
    scene.environment.atmosphere.constant_density = 0.0;
    scene.aerodynamics = {};
    Cluster cluster(scene);
    const auto momentum = [&](double* size) {
        Vec3 angular = Vec3::Zero(), linear = Vec3::Zero(), centre = Vec3::Zero();
        double mass = 0.0;
        *size = 0.0;
        for (std::size_t k = 0; k < cluster.size(); ++k) {
            const test::Momentum one = test::momentum_of(cluster[k]);
            angular += one.angular + cluster[k].system().body->half_momentum;
            linear += one.linear;
            centre += cluster[k].constants().system_mass * cluster[k].system().sums.system_position;
            mass += cluster[k].constants().system_mass;
            *size += one.turning;
        }
        return Vec3(angular - (centre / mass).cross(linear));
    };
    double size = 0.0;
    const Vec3 before = momentum(&size);
    while (cluster.front().system().time < 0.1) {
        cluster.evaluate_forces();
        cluster.step_to(0.1);
    }
    const Vec3 after = momentum(&size);
    EXPECT_NEAR((after - before).norm(), 0.0, 1e-9 * size);
    EXPECT_GT(cluster.front().system().body->momentum.norm(), 1e-5 * size);
    EXPECT_GT(cluster.planes().front().largest_force(), 1.0);
}

TEST(Clusters, TheLedgerOfEachPartOfABodyCloses) {
    // Force and torque of the others on its part are work from outside. One of two canopies fills half a
    // second later, and the body hangs far below the point where they meet: it swings and turns.
    Scene scene = on_a_box(cluster_of(2));
    scene.payload.body->size = {0.6, 0.6, 4.0};
    scene.full.mesh = {2, 9, 5, 2};
    scene.parachutes.front().lag = {0.0, 0.5};
    Cluster cluster(scene);
    fly_until(cluster, 1.8);
    EXPECT_GT(cluster.front().payload_spin().norm(), 0.1);
    for (std::size_t k = 0; k < cluster.size(); ++k) {
        const EnergyLedger ledger = cluster[k].ledger();
        EXPECT_LT(std::abs(residual(ledger)), 5e-5 * std::abs(ledger.drag_work)) << k;
    }
}

TEST(Clusters, ABodyTakesTheLoadThatAPointMassDoes) {
    // Straight down on one point above its centre: nothing turns it, and lines are as long as above a point
    // mass. It hangs 0.3 m lower, and rounding starts other folds: 0.5 %.
    Scene scene = cluster_of(2);
    scene.full.mesh = {2, 9, 5, 2};
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
    const RunRecord point = test::run_full(scene), box = test::run_full(on_a_box(scene));
    ASSERT_EQ(box.status.code, StatusCode::completed) << box.status.detail;
    for (const char* metric : {"peak_force_N", "peak_canopy_force_N"})
        EXPECT_NEAR(*box.metric(metric) / *point.metric(metric), 1.0, 0.005) << metric;
    EXPECT_LT(std::abs(box.energy->residual_fraction), 1e-3);
    // Drag that is the same in all attitudes is that of no attitude.
    Scene drags = on_a_box(scene), by_attitude = drags;
    drags.payload.drag_area = 5.0;
    by_attitude.payload.drag_area = 5.0;
    by_attitude.payload.drag_area_table.emplace("a.csv", std::vector<double>{0.0, pi},
                                                std::vector<double>{5.0, 5.0});
    const double slowed = *test::run_full(drags).metric("peak_force_N");
    EXPECT_LT(slowed, 0.99 * *box.metric("peak_force_N"));
    EXPECT_NEAR(*test::run_full(by_attitude).metric("peak_force_N"), slowed, 1e-9 * slowed);
    // Released aslant it turns, and the works on its parts add up.
    scene.release.path_angle = 0.8;
    const RunRecord aslant = test::run_full(on_a_box(scene));
    ASSERT_EQ(aslant.status.code, StatusCode::completed) << aslant.status.detail;
    EXPECT_LT(std::abs(aslant.energy->residual_fraction), 1e-3);
}

TEST(Clusters, MomentumIsThatOfAllForces) {
    // In vacuum nothing but gravity acts on the whole: its momentum grows by m g t, whatever the canopies do
    // to each other and to the payload; rounding of some thousand steps of 1000 nodes is all that is left.
    // Nodes that start 1 cm off pull at everything, in each canopy in another way, and press on the other
    // canopy.
    for (const int substeps : {1, 8}) {
        Scene scene = cluster_of(2);
        scene.full.line_substeps = substeps;
        scene.release.path_angle = 0.3;
        scene.full.noise = Noise{1e-2, 3};
        scene.environment.atmosphere.constant_density = 0.0;
        scene.aerodynamics = {};
        Cluster cluster(scene);
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            for (std::size_t k = 0; k < cluster.size(); ++k)
                sum += cluster[k].constants().system_mass * cluster[k].system().sums.system_velocity;
            return sum;
        };
        double mass = 0.0;
        for (std::size_t k = 0; k < cluster.size(); ++k)
            mass += cluster[k].constants().system_mass;
        const Vec3 before = momentum();
        double unlike = 0.0;  // [N] of what the risers of both pull
        // Half-way all begin anew with a first step, as they do where one of them comes to its snatch.
        for (const double end : {0.05, 0.1})
            while (cluster.front().system().time < end) {
                cluster.evaluate_forces();
                unlike = std::max(unlike,
                                  (cluster[0].system().riser_force - cluster[1].system().riser_force).norm());
                if (cluster.front().system().time == 0.05) {
                    cluster.front().start_anew();
                    cluster.start_anew_but(0);
                }
                cluster.step_to(end);
            }
        const Vec3 gained = momentum() - before;
        const double expected = mass * scene.environment.gravity * 0.1;
        EXPECT_NEAR(gained.z(), -expected, 1e-9 * expected) << substeps;
        EXPECT_NEAR(gained.head<2>().norm(), 0.0, 1e-9 * expected) << substeps;
        EXPECT_GT(unlike, 0.01);
        EXPECT_GT(cluster.planes().front().largest_force(), 1.0);
    }
}

TEST(Clusters, ASymmetricOneStaysSymmetricToRounding) {
    // Two canopies are each other's mirror image. What rounding makes of that grows with the folds of slack
    // fabric, which are chaotic: 6e-12 of the force at the start, where the turned meshes round differently;
    // a tenth of a second later no more than a thousand times that.
    const Scene scene = cluster_of(2);
    Cluster cluster(scene);
    fly_until(cluster, 0.1);
    const Vec3 a = cluster[0].system().riser_force, b = cluster[1].system().riser_force;
    EXPECT_NEAR(a.norm(), b.norm(), 1e-8 * a.norm());
    EXPECT_NEAR(a.z(), b.z(), 1e-8 * a.norm());
    EXPECT_NEAR((a + b).head<2>().norm(), 0.0, 1e-8 * a.norm());
    EXPECT_GT((a - b).norm(), 1e-3 * a.norm());  // they do lean apart
}

TEST(Clusters, LayoutsAndThreadsAgree) {
    // As layouts of one canopy do: products and sums join in one and not in the other. Threads change
    // nothing.
    Scene scene = cluster_of(2);
    scene.parachutes.front().lag = {0.0, 0.1};
    const auto unstructured = [](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
        return make_unstructured_layout(s, mesh, constants);
    };
    Cluster batched(scene), threaded(scene, Simulation::layout_of_one_thread, 2), any(scene, unstructured);
    for (Cluster* cluster : {&batched, &threaded, &any})
        fly_until(*cluster, 0.05);
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3 force = batched[k].system().riser_force;
        EXPECT_EQ(force, threaded[k].system().riser_force);
        EXPECT_LT((force - any[k].system().riser_force).norm(), 1e-7 * force.norm());
    }
}

TEST(Clusters, EachDescendsAsOneWithItsShareDoes) {
    // Drag areas are told, and what leans costs nothing of them: the rate of one alone. Found 0.2 % below.
    Scene one = cluster_of(1), two = cluster_of(2);
    for (Scene* scene : {&one, &two})
        scene->stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    const RunRecord alone = test::run_full(one), both = test::run_full(two);
    ASSERT_EQ(both.status.code, StatusCode::completed) << both.status.detail;
    EXPECT_NEAR(*both.metric("descent_rate_m_s"), *alone.metric("descent_rate_m_s"),
                0.01 * *alone.metric("descent_rate_m_s"));
    // Both open alike, so that the sum of their areas comes to 98 % when theirs do.
    ASSERT_TRUE(both.metric("filling_time_s"));
    EXPECT_NEAR(*both.metric("filling_time_s"), *both.metric("canopy_1_filling_time_s"),
                0.01 * *both.metric("canopy_1_filling_time_s"));
    // Each is as wide as one alone, but for what they press each other flat: found 3.5 %.
    EXPECT_NEAR(*both.metric("projected_diameter_ratio"), *alone.metric("projected_diameter_ratio"),
                0.06 * *alone.metric("projected_diameter_ratio"));
    // They do touch, and no node is a tenth of the shortest edge on the skirt, 18 cm, behind the plane.
    EXPECT_GT(*both.metric("max_canopy_contact_force_N"), 100.0);
    EXPECT_LT(*both.metric("max_canopy_contact_depth_m"), 0.018);
    EXPECT_LT(std::abs(both.energy->residual_fraction), 1e-3);  // as runs of one: 1e-5 to 1e-4
}

TEST(Clusters, TheFirstToOpenCarriesMore) {
    // One full before the other: the load of the first over the mean of all as in the reduced-order model,
    // whose canopies have no mass of fabric to lift and do not lean. Forces of the two are as far apart as
    // those of one canopy are at most (5 %, the tolerance of data/scenes/c9-inflation.toml); found 1.3
    // and 2.4.
    Scene scene = cluster_of(2);
    scene.parachutes.front().lag = {0.0, 0.5};
    scene.stop = {Trigger::Kind::time, 3.0, 0.0};
    const RunRecord full = test::run_full(scene), rom = test::run_rom(scene);
    ASSERT_EQ(full.status.code, StatusCode::completed) << full.status.detail;
    for (const char* metric : {"peak_force_N", "peak_canopy_force_N"})
        EXPECT_NEAR(*full.metric(metric), *rom.metric(metric), 0.05 * *rom.metric(metric)) << metric;
    EXPECT_EQ(*full.metric("canopy_1_peak_force_N"), *full.metric("peak_canopy_force_N"));
    EXPECT_GT(*full.metric("canopy_1_peak_force_N"), 2.0 * *full.metric("canopy_2_peak_force_N"));
    // Their drag area rises with the first, all is full with the last of them, later by the lag to the last
    // bit of the prescription.
    for (const char* event : {"end-of-initial-phase", "full-open"}) {
        EXPECT_NEAR(full.find_event(event)->time, rom.find_event(event)->time, 1e-9) << event;
        EXPECT_EQ(std::ranges::count(full.events, event, &Event::name), 1) << event;
    }
    // Channels of each add up to what the payload feels, but for their lean of some degrees.
    const auto &sum = full.find_channel("force_raw")->values,
               &first = full.find_channel("canopy_1_force")->values,
               &second = full.find_channel("canopy_2_force")->values;
    for (std::size_t i = 0; i < sum.size(); ++i)
        EXPECT_LE(sum[i], 1.3 * (first[i] + second[i]) + 50.0) << i;
}

TEST(Clusters, OneThatSkipsItsReefingCarriesTheOthers) {
    // The first of two fills at once, the other behind its line for 2 s. Loads as in the reduced-order model,
    // within what reefed openings of one canopy differ by (7 %, tests/verification/reefing_test.cpp).
    Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-reefed.toml",
                             {"parachute.count=2", "parachute.skips_reefing=1", "stop.time=5",
                              "parachute.reefing=[{drag_area_ratio=0.1,until={at='line-stretch',delay=2}}]"});
    scene.payload.mass *= 2.0;
    const RunRecord full = test::run_full(scene), rom = test::run_rom(scene);
    ASSERT_EQ(full.status.code, StatusCode::completed) << full.status.detail;
    for (const char* metric : {"stage_1_peak_force_N", "stage_2_peak_force_N", "peak_canopy_force_N"})
        EXPECT_NEAR(*full.metric(metric), *rom.metric(metric), 0.07 * *rom.metric(metric)) << metric;
    EXPECT_EQ(full.find_event("disreef")->time, 2.0);
    EXPECT_EQ(rom.find_event("disreef")->time, 2.0);
    // Both reefed, each pulls less than half of that.
    scene.parachutes.front().skips_reefing = 0;
    const RunRecord reefed = test::run_rom(scene);
    EXPECT_LT(*reefed.metric("peak_canopy_force_N"), 0.7 * *rom.metric("peak_canopy_force_N"));
    // All skip it: a cluster that is not reefed at all.
    Scene open = scene;
    scene.parachutes.front().skips_reefing = 2;
    open.parachutes.front().reefing.clear();
    EXPECT_EQ(*test::run_rom(scene).metric("max_force_N"), *test::run_rom(open).metric("max_force_N"));
    // So does one that is alone, in the full model, too.
    scene.parachutes.front().count = scene.parachutes.front().skips_reefing = open.parachutes.front().count =
        1;
    scene.stop.value = open.stop.value = 1.0;
    EXPECT_EQ(*test::run_full(scene).metric("max_force_N"), *test::run_full(open).metric("max_force_N"));
}

TEST(Clusters, ComeFromTheirPacks) {
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.parachutes.front().count = 2;
    scene.payload.mass *= 2.0;
    scene.stop = {Trigger::Kind::full_open, 0.0, 0.2};
    const RunRecord record = test::run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    ASSERT_TRUE(record.find_event("snatch"));
    EXPECT_GT(*record.metric("snatch_force_N"), 0.0);
    EXPECT_GT(*record.metric("canopy_2_peak_force_N"), 0.0);
    EXPECT_LT(std::abs(record.energy->residual_fraction), 5e-3);  // as packed runs of one
}

TEST(Clusters, StayOnTheirSidesAsTheyAreDrawnOut) {
    // Packs become strings of four metres, centimetres apart and not drawn out at the same time. No node
    // comes to be more than a tenth of an edge behind fabric of the other, as with any contact here, and the
    // energy adds up at the first attempt.
    for (const char* speed : {"30 m/s", "75 m/s"})
        for (const int seed : {1, 2}) {
            const std::string text = fmt::format(R"(schema = 1
name = "packs"
[payload]
mass = "180 kg"
drag_area = "0.5 m^2"
[release]
altitude = "900 m"
speed = "{}"
path_angle = "40 deg"
[[parachute]]
count = 2
design = "usaf-c9"
deploy = {{ by = "pilot", pilot_drag_area = "0.5 m^2" }}
fill_time.n = 8
[aerodynamics]
line_drag = {{ model = "cylinder" }}
[full]
mesh = {{ gore_columns = 2, gore_rows = 7, line_elements = 10, riser_elements = 2 }}
noise = {{ amplitude = 1e-3, seed = {} }}
[stop]
at = "line-stretch"
)",
                                                 speed, seed);
            const Scene scene = read_scene_text(text, "packs", TWINCHUTE_SOURCE_DIR, {});
            const RunRecord record = test::run_full(scene);
            ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
            for (const Warning& warning : record.warnings)
                EXPECT_FALSE(warning.what.starts_with("the run was repeated")) << warning.why;
            const auto force = record.metric("max_canopy_contact_force_N");
            ASSERT_TRUE(force);
            if (*force == 0.0) continue;
            const double rows = 7.0, edge = 0.5 * scene.parachutes.front().nominal_diameter / rows;
            EXPECT_LT(*record.metric("max_canopy_contact_depth_m"), 0.1 * edge);
        }
}

TEST(Clusters, CanopiesWithoutPlaceBesideEachOtherAreRefused) {
    Scene scene = cluster_of(9);
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    try {
        full_fidelity().unsupported_keys(scene);
        FAIL() << "nine open canopies have no place around a point";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "parachute.count");
    }
    scene.parachutes.front().deploy.by = DeployBy::line_stretch;
    EXPECT_TRUE(full_fidelity().unsupported_keys(scene).empty());
}

TEST(Clusters, WhatNeedsAnAxisIsRefused) {
    Scene scene = cluster_of(2);
    scene.full.symmetry = Symmetry::sector;
    EXPECT_EQ(full_fidelity().unsupported_keys(scene), std::vector<std::string>{"full.symmetry"});
    // A body turns under canopies that meet at one point of it.
    scene = on_a_box(cluster_of(2));
    EXPECT_TRUE(full_fidelity().unsupported_keys(scene).empty());
    scene.parachutes.front().risers = 4;
    const std::vector<std::string> lacking = full_fidelity().unsupported_keys(scene);
    EXPECT_EQ(lacking, std::vector<std::string>{"parachute.risers"});
    EXPECT_NE(unsupported_text(scene, lacking).find("meet at one point of payload.body: write 1"),
              std::string::npos);
    scene.parachutes.front().risers = 1;
    scene.payload.body->elasticity = Elasticity{1e9, 0.3};
    EXPECT_EQ(full_fidelity().unsupported_keys(scene), std::vector<std::string>{"payload.body.elasticity"});
}

}  // namespace
}  // namespace twinchute::fullsim
