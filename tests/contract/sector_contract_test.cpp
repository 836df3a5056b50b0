// One sector with its sector-batched gives the answer of the unstructured layout, which is the reference: in
// symmetric states recorded on the way through runs, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "fullsim/run/frames.hpp"
#include "fullsim/run/observer.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/storage/sector_batched/kernels.hpp"
#include "fullsim/storage/sector_batched/sector.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/layout_answer.hpp"
#include "tests/support/predicted.hpp"

namespace twinchute::fullsim {
namespace {

using test::Answer, test::answer_of, test::expect_same;

/// Everything that may act from line stretch on, on a coarse mesh.
Scene everything(int gores, int risers, const MeshCounts& mesh) {
    Scene scene = test::c9_scene();
    scene.parachutes.front().gores = gores;
    scene.parachutes.front().risers = risers;
    scene.parachutes.front().initial_phase.transit = true;
    scene.payload.drag_area = 0.4;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    scene.full.alpha = 3.0;
    scene.full.beta = 1e-7;
    scene.full.mesh = mesh;
    scene.full.contact = Contact::gores;
    scene.full.symmetry = Symmetry::sector;
    return scene;
}

/// Two nodes that mirror each other differ by the rounding of the turn from one sector to the next: some
/// 1e-15 m of four metres. A triangle 0.1 m wide makes strains of 1e-14 of that, and they are 1e-3 and less:
/// 1e-11 of its forces.
constexpr double rounding = 1e-11;

/// A hundred states, evenly spaced in steps, from the first one on.
void compare_along(const Scene& scene, int steps) {
    Simulation simulation(scene);
    const NodeConstants& constants = simulation.constants();
    const double stiffest = test::stiffest_cable(scene);
    const NodeIndex payload = simulation.mesh().payload();
    for (int step = 0; step < steps; ++step) {
        simulation.evaluate_forces();
        if (simulation.is_reefed() && step == steps / 2)  // half way its line is cut
            simulation.disreef(simulation.inflation(), scene.parachutes.front().reefing.size());
        if (step % std::max(1, steps / 100) == 0) {
            const State& state = simulation.synchronised_state();
            const auto structure = make_structure(scene, simulation.mesh(), state.stage);
            const auto loads = make_loads(scene, simulation.mesh(), state.stage);
            const auto blocks = make_reference_layout(simulation.mesh(), constants);
            const Answer reference = answer_of(*blocks, state, constants, structure, loads);
            for (const SectorKernels& kernels : all_sector_kernels()) {
                SCOPED_TRACE(std::string(kernels.instruction_set) + " step " + std::to_string(step));
                std::string why;
                const auto sector = make_sector_layout(scene, simulation.mesh(), constants, &why, &kernels);
                ASSERT_TRUE(sector) << why;
                const Answer answer = answer_of(*sector, state, constants, structure, loads);
                expect_same(reference, answer, stiffest, rounding);
                // The velocity of the payload: to its last bits, worth more than 1e-11 of the force on so
                // heavy a node.
                const auto speed = [&](const Answer& a) { return a.state.v_half[payload].value[2]; };
                EXPECT_NEAR(speed(reference), speed(answer), 1e-15 * std::abs(speed(reference)));
            }
            if (testing::Test::HasFailure()) return;
        }
        const Inflation& inflation = simulation.inflation();
        if (simulation.system().time >= inflation.end_of(simulation.system().phase))
            simulation.begin(simulation.system().phase == Phase::initial ? Phase::filling : Phase::open);
        simulation.step_to(std::min(1e9, inflation.end_of(simulation.system().phase)));
    }
}

TEST(SectorsOfPredictedFilling, AgreeWithTheUnstructuredLayout) {
    compare_along(test::predicted(everything(28, 4, {2, 9, 8, 2, Grading::graded}), 0.02), 12'000);
}

TEST(SectorsOfPredictedFilling, AgreeWhereAirLeavesThroughAGap) {
    Scene scene = everything(28, 4, {2, 9, 8, 2, Grading::graded});
    scene.parachutes.front().type = test::canopy_of_type("disk-gap-band").type;
    compare_along(test::predicted(scene, 0.02), 6'000);
}

TEST(SectorsOfPredictedFilling, AgreeBehindAReefingLine) {
    Scene scene = test::predicted(everything(28, 4, {2, 9, 8, 2, Grading::graded}), 0.02);
    Reefing stage;
    stage.drag_area_ratio = 0.1;
    scene.parachutes.front().reefing = {stage};
    compare_along(scene, 12'000);
}

struct Case {
    const char* name;
    int gores, risers;
    MeshCounts mesh;
    int steps;
};

void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

class Sectors : public testing::TestWithParam<Case> {};

TEST_P(Sectors, AgreeWithTheUnstructuredLayout) {
    const Case& c = GetParam();
    compare_along(everything(c.gores, c.risers, c.mesh), c.steps);
}

constexpr Grading graded = Grading::graded, uniform = Grading::uniform;
// Registers are full and not; elements fit batches or are left to the remainder loop; one gore a sector and
// several.
const Case cases[] = {
    {"the_demo_under_one_riser", 28, 1, {2, 17, 31, 5, graded}, 20'000},
    {"the_demo", 28, 4, {2, 17, 31, 5, graded}, 3'000},
    {"uniform", 28, 1, {2, 17, 31, 5, uniform}, 3'000},
    {"one_column", 28, 1, {1, 9, 8, 2, graded}, 4'000},
    {"three_columns", 12, 2, {3, 6, 4, 1, graded}, 4'000},
    {"three_uniform_columns", 30, 3, {3, 7, 5, 3, uniform}, 4'000},
    {"four_columns", 12, 1, {4, 6, 1, 1, graded}, 4'000},
    {"gores_that_touch", 28, 4, {4, 6, 4, 2, graded}, 6'000},  // billows as wide as they are apart
    {"a_riser_for_each_gore", 6, 6, {2, 5, 3, 2, graded}, 4'000},
};

INSTANTIATE_TEST_SUITE_P(Meshes, Sectors, testing::ValuesIn(cases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Sector, AgreesOnAnOpenCanopy) {
    Scene scene = everything(28, 1, {2, 9, 8, 2, graded});
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    compare_along(scene, 4'000);
}

TEST(Sector, CoversTheMesh) {
    for (const int risers : {1, 4}) {
        const Mesh mesh = Simulation(everything(28, risers, {2, 5, 4, 3, graded})).mesh();
        std::string why;
        const auto sector = find_sector(mesh, &why);
        ASSERT_TRUE(sector) << why;
        EXPECT_EQ(sector->gores, risers == 1 ? 1 : 7);
        EXPECT_EQ(sector->triangles.size() * sector->count, mesh.triangles.size());
        std::vector<NodeIndex> all(sector->node);
        std::ranges::sort(all);
        all.erase(std::unique(all.begin(), all.end()), all.end());  // clang 14 has no std::ranges::unique
        ASSERT_EQ(all.size() + 1, mesh.position.size());
        for (std::size_t i = 0; i < all.size(); ++i)
            EXPECT_EQ(all[i], static_cast<NodeIndex>(i));
        double riser = 0.0, line = 0.0;  // strands times metres
        for (const GoreCable& c : sector->cables) {
            if (c.kind == CableKind::riser) riser += c.strands * c.rest_length;
            if (c.kind == CableKind::line) line += c.strands * c.rest_length;
        }
        EXPECT_NEAR(riser * sector->count, 28 * 1.22, 1e-9);
        EXPECT_NEAR(line * sector->count, 28 * 7.31, 1e-9);
    }
}

TEST(Sector, ShapesOfOneAreThoseOfAll) {
    // Stresses to one of their 255 steps, on whose edge rounding may fall; diameters to rounding.
    for (const int risers : {1, 4}) {
        const Scene scene = everything(28, risers, {2, 6, 3, 2});
        Simulation simulation(scene);
        ASSERT_EQ(simulation.sectors(), risers == 1 ? 28 : 4);
        while (simulation.system().time < 0.5) {
            simulation.evaluate_forces();
            simulation.step_to(0.5);
        }
        const State& state = simulation.synchronised_state();
        std::vector<ShapeFrame> frames;
        for (const int sectors : {1, simulation.sectors()}) {
            FrameRecorder recorder(simulation.mesh(), true, sectors);
            recorder.begin(state.time, {1.0, 2});
            recorder.observe(state);
            recorder.accept();
            frames.push_back(recorder.finish().frames.front());
        }
        ASSERT_GT(frames[0].stress_step, 0.0);
        EXPECT_NEAR(frames[1].stress_step, frames[0].stress_step, 1e-9 * frames[0].stress_step);
        ASSERT_EQ(frames[0].stress.size(), simulation.mesh().triangles.size());
        ASSERT_EQ(frames[1].stress.size(), frames[0].stress.size());
        for (std::size_t t = 0; t < frames[0].stress.size(); ++t)
            EXPECT_NEAR(frames[1].stress[t], frames[0].stress[t], 1) << t;
        EXPECT_EQ(frames[1].folds, frames[0].folds);
        EXPECT_EQ(frames[1].place, frames[0].place);
        const CanopyShape all = canopy_shape(state, simulation.mesh()),
                          one = canopy_shape(state, simulation.mesh(), simulation.sectors());
        EXPECT_NEAR(one.seam_diameter, all.seam_diameter, 1e-12 * all.seam_diameter);
        EXPECT_EQ(one.depth, all.depth);
    }
}

TEST(Sector, IsNotThereWhereTheMeshIsUneven) {
    const Scene scene = everything(28, 4, {2, 5, 4, 3, graded});
    const Simulation simulation(scene);
    const Mesh& sound = simulation.mesh();
    const auto expect_none = [&](const Mesh& mesh, const char* reason) {
        std::string why;
        EXPECT_FALSE(make_sector_layout(scene, mesh, simulation.constants(), &why));
        EXPECT_NE(why.find(reason), std::string::npos) << why;
    };
    Mesh mesh = sound;
    mesh.triangles[40].a *= 1.0 + 1e-9;
    expect_none(mesh, "triangles differ");
    // And the scene that asked for it is refused.
    try {
        make_layout(scene, mesh, simulation.constants());
        ADD_FAILURE() << "a layout of an uneven mesh";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "full.symmetry");
        EXPECT_NE(std::string(error.what()).find("triangles differ"), std::string::npos) << error.what();
    }
    mesh = sound;
    mesh.position[sound.seam_rings[2][9]].x() += 1e-6;
    expect_none(mesh, "nodes do not lie around the axis");
    mesh = sound;
    std::ranges::find(mesh.cables, CableKind::riser, &Cable::kind)->rest_length *= 1.001;
    expect_none(mesh, "risers differ");
}

}  // namespace
}  // namespace twinchute::fullsim
