// Every layout and every instruction set gives the answer of the indexed one, which is the reference: in
// states recorded on the way through whole runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fullsim/gores/kernels.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double dt = 1e-5;  // [s]

/// What a layout says of one state: sums, what a step makes of it, and the forces that one can tell from
/// that.
struct Answer {
    State state;
    double stable_step;
    std::vector<Vec3> force;  ///< [N], gravity included
};

Answer answer_of(Layout& layout, const State& state, const NodeConstants& c, const ForceModels& structure,
                 const ForceModels& loads) {
    Answer a{state, 0.0, {}};
    layout.begin(a.state, structure, loads);
    BlockClock clock;
    clock.begin(std::vector<std::string>(structure.size() + loads.size(), "any"));
    clock.begin_step(false);
    layout.evaluate(a.state, clock);
    a.stable_step = layout.stable_step(a.state);
    layout.advance(a.state, dt, a.state.added_mass + 1e-4);
    layout.store(a.state);
    for (std::size_t i = 0; i < c.mass.size(); ++i)
        a.force.push_back((c.mass[i] + c.share[i] * state.added_mass) / (0.5 * (dt + state.dt)) *
                          to_vec3(a.state.v_half[i].value - state.v_half[i].value));
    return a;
}

void expect_same(const Answer& reference, const Answer& other, double stiffest) {
    double largest = reference.state.riser_force.norm(), difference = 0.0;
    for (std::size_t i = 0; i + 1 < reference.force.size(); ++i) {  // the payload's tells its weight
        largest = std::max(largest, reference.force[i].norm());
        difference = std::max(difference, (reference.force[i] - other.force[i]).norm());
    }
    // A strain is a ratio near 1 less 1, good to 2e-16: in free fall, when hardly a force acts, that is what
    // is left of it times the stiffest cable's EA.
    EXPECT_LE(difference, 1e-12 * largest + 4e-16 * stiffest);
    const auto close = [](double a, double b, double scale, const char* what) {
        EXPECT_NEAR(a, b, 1e-12 * scale) << what;
    };
    const State &r = reference.state, &o = other.state;
    const double power = std::abs(r.energy.drag_power) + std::abs(r.energy.damping_power) +
                         std::abs(r.energy.gravity_power) + 1e-3;
    close(reference.stable_step, other.stable_step, reference.stable_step, "stable step");
    close(r.energy.drag_power, o.energy.drag_power, 10.0 * power, "drag power");
    close(r.energy.gravity_power, o.energy.gravity_power, power, "gravity power");
    // A small sum of large terms of both signs.
    close(r.energy.damping_power, o.energy.damping_power, 100.0 * power, "damping power");
    close(r.energy.external_power, o.energy.external_power, power, "external power");
    close(r.air.projected_area, o.air.projected_area, 60.0, "projected area");
    close(r.air.signed_area, o.air.signed_area, 60.0, "signed area");
    close(r.air.pressure, o.air.pressure, 10.0 * (r.air.pressure + 1e-3), "pressure");
    close(r.riser_force.norm(), o.riser_force.norm(), 10.0 * (r.riser_force.norm() + 1.0), "riser force");
    EXPECT_LT((r.sums.canopy_velocity - o.sums.canopy_velocity).norm(), 1e-12 * 100.0);
    EXPECT_LT((r.sums.system_position - o.sums.system_position).norm(), 1e-12 * 1000.0);
    EXPECT_LT((r.sums.canopy_area_velocity - o.sums.canopy_area_velocity).norm(), 1e-12 * 100.0);
}

/// EA [N] of a riser, which is as strong as its lines.
double stiffest_cable(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    return chute.line.axial_stiffness() * chute.gores / chute.risers;
}

/// Looks at a hundred states of a run, evenly spaced in steps, whatever stage they are in.
void compare_along(const Scene& scene, int steps, std::size_t stages = 1) {
    Simulation simulation(scene);
    const auto looks = std::max(1, steps / 100);
    std::vector<Stage> seen;
    for (int step = 0; step < steps; ++step) {
        simulation.evaluate_forces();
        const Stage stage = simulation.outline().stage;
        if (stage == Stage::deployment && simulation.lines_are_taut()) {
            ASSERT_FALSE(simulation.snatch());
        } else if (stage == Stage::springs && simulation.mouth_is_open()) {
            simulation.begin_ramp();
        } else if (simulation.outline().time >= simulation.ramp_end()) {
            simulation.end_ramp();
        }
        if (step % looks == 0) {
            const State& state = simulation.state();
            if (std::ranges::find(seen, state.stage) == seen.end()) seen.push_back(state.stage);
            const auto structure = make_structure(scene, simulation.mesh(), state.stage);
            const auto loads = make_loads(scene, simulation.mesh(), state.stage);
            const auto indexed = make_indexed_layout(simulation.mesh(), simulation.constants());
            const Answer reference = answer_of(*indexed, state, simulation.constants(), structure, loads);
            for (const GoreKernels& kernels : all_gore_kernels()) {
                SCOPED_TRACE(std::string(kernels.instruction_set) + " step " + std::to_string(step));
                const auto gores =
                    make_gore_layout(scene, simulation.mesh(), simulation.constants(), &kernels);
                ASSERT_TRUE(gores);
                expect_same(reference, answer_of(*gores, state, simulation.constants(), structure, loads),
                            stiffest_cable(scene));
            }
            if (testing::Test::HasFailure()) return;
        }
        simulation.step_to(std::min(1e9, simulation.ramp_end()));
    }
    EXPECT_EQ(seen.size(), stages) << "stages that are looked at";
}

Scene crane_drop(const std::vector<std::string>& more) {
    std::vector<std::string> overrides{"full.mesh.gore_rows=6", "full.mesh.line_elements=4",
                                       "full.mesh.riser_elements=2"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/paper/crane-drop.toml", overrides);
}

TEST(Layouts, AgreeOnAPackedDropInEveryStage) {
    compare_along(crane_drop({"full.beta=1e-7", "parachute.deploy.length='3 m'", "full.ramp_time='0.3 s'"}),
                  120'000, 4);
}

TEST(Layouts, AgreeOnAnExtraction) {
    // At the apex and over the canopy; damping from release on, payload drag, single columns.
    for (const bool on_apex : {true, false}) {
        Scene scene = crane_drop({"full.alpha_from='release'", "full.mesh.gore_columns=1"});
        Deployment& deploy = scene.parachutes.front().deploy;
        deploy.by = DeployBy::extraction;
        deploy.extraction = {"", {0.0, 1.0}, {300.0, 300.0}, 1.0};
        deploy.extraction_on_apex = on_apex;
        scene.payload.drag_area = 0.4;
        compare_along(scene, 2'000);
    }
}

TEST(Layouts, AgreeWhereElementsCarryThePack) {
    // Membranes and folds without springs, on the uniform mesh.
    compare_along(crane_drop({"full.structure='fe'", "full.mesh.grading='uniform'"}), 4'000);
}

TEST(Layouts, AgreeWhereGoresFillNoBlock) {
    // Thirty and twelve gores, odd and even columns; accreting air; an oblique start and an open canopy.
    Scene scene = crane_drop({"full.mesh.gore_columns=3"});
    scene.parachutes.front().gores = 30;
    scene.parachutes.front().risers = 3;
    scene.parachutes.front().deploy.by = DeployBy::line_stretch;
    scene.release.speed = 25.0;
    scene.release.path_angle = 1.0;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    compare_along(scene, 2'000);
    scene = crane_drop({"full.mesh.gore_columns=4"});
    scene.parachutes.front().gores = 12;
    scene.parachutes.front().risers = 1;
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    scene.release.path_angle = 1.5;
    compare_along(scene, 2'000);
}

TEST(Layouts, ASmoothOpeningIsTheSameInAll) {
    // The line-stretch demo is smooth: differences of rounding stay what they are. 1e-6 of the raw peak, its
    // time and the payload's place after 2 s.
    Scene scene =
        read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                   {"full.mesh.gore_columns=1", "full.mesh.gore_rows=9", "full.mesh.line_elements=8"});
    struct Outcome {
        double peak = 0.0, peak_time = 0.0, altitude = 0.0;
    };
    const auto fly = [&](const Simulation::LayoutMaker& layout) {
        Simulation simulation(scene, layout);
        Outcome outcome;
        while (simulation.outline().time < 2.0) {
            simulation.evaluate_forces();
            const State& now = simulation.outline();
            const double force = now.riser_force.norm();
            if (force > outcome.peak) outcome = {force, now.time, 0.0};
            if (now.time >= simulation.inflation().end_of(now.phase))
                simulation.begin(now.phase == Phase::initial ? Phase::filling : Phase::open);
            simulation.step_to(std::min(2.0, simulation.inflation().end_of(now.phase)));
        }
        outcome.altitude = simulation.outline().node[simulation.mesh().payload()].x[2];
        return outcome;
    };
    const Outcome reference = fly([](const Scene&, const Mesh& mesh, const NodeConstants& constants) {
        return make_indexed_layout(mesh, constants);
    });
    EXPECT_GT(reference.peak, 3.0 * scene.payload.mass * 9.8);
    for (const GoreKernels& kernels : all_gore_kernels()) {
        SCOPED_TRACE(kernels.instruction_set);
        const Outcome other = fly([&](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
            return make_gore_layout(s, mesh, constants, &kernels);
        });
        EXPECT_NEAR(other.peak, reference.peak, 1e-6 * reference.peak);
        EXPECT_NEAR(other.peak_time, reference.peak_time, 1e-6 * reference.peak_time);
        EXPECT_NEAR(other.altitude, reference.altitude, 1e-6 * reference.altitude);
    }
}

TEST(Layouts, AnUnevenMeshIsNotSideBySide) {
    Scene scene = crane_drop({});
    Simulation simulation(scene);
    Mesh mesh = simulation.mesh();
    std::string why;
    ASSERT_TRUE(find_gores(mesh));
    mesh.triangles[40].a *= 1.0 + 1e-9;
    EXPECT_FALSE(find_gores(mesh, &why));
    EXPECT_NE(why.find("triangles differ"), std::string::npos) << why;
    EXPECT_FALSE(make_gore_layout(scene, mesh, simulation.constants()));
}

TEST(Layouts, GoresCoverTheMesh) {
    const Mesh mesh = Simulation(crane_drop({})).mesh();
    const Gores gores = find_gores(mesh).value();
    EXPECT_EQ(gores.triangles.size() * gores.count, mesh.triangles.size());
    EXPECT_EQ(gores.cables.size() * gores.count + gores.trunk_cables.size(), mesh.cables.size());
    EXPECT_EQ(gores.edges.size() * gores.count, fabric_edges(mesh).size());
    std::vector<NodeIndex> all = gores.node;
    all.insert(all.end(), gores.trunk.begin(), gores.trunk.end());
    std::ranges::sort(all);
    ASSERT_EQ(all.size(), mesh.position.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(all[i], static_cast<NodeIndex>(i));
}

}  // namespace
}  // namespace twinchute::fullsim
