// A run that goes on from any of its checkpoints ends with the bits of the run that was never cut off: in
// every layout and instruction set, every stage, every way to open. The run without checkpoints is the
// expectation, so that taking one changes nothing either; and nothing is allowed to differ.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "fullsim/run/run_fullsim.hpp"
#include "fullsim/serialize_state.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/sector_batched/kernels.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/random_drops.hpp"
#include "tests/support/same_run.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::fullsim {
namespace {

Scene coarse(const char* file, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"full.mesh.gore_rows=5", "full.mesh.gore_columns=1",
                               "full.mesh.line_elements=3", "full.mesh.riser_elements=2"});
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + file, more);
}

/// Output of a run beside its record.
struct Given {
    RunRecord record;
    std::vector<VtuGrid> fields;
    ShapeFrames frames;
    std::vector<std::string> saved;
    std::vector<std::size_t> fields_then;  ///< how many there were when each of these was saved
};

Given run(const Scene& scene, bool saves, const std::string& from = {}) {
    Given given;
    Run control;
    control.fields = [&](const VtuGrid& frame) { given.fields.push_back(frame); };
    control.frames = [&](ShapeFrames frames) { given.frames = std::move(frames); };
    if (saves)
        control.checkpoints.save = [&](std::string state) {
            given.saved.push_back(std::move(state));
            given.fields_then.push_back(given.fields.size());
        };
    control.checkpoints.from = from;
    given.record = run_fullsim(scene, control);
    return given;
}

struct Case {
    const char* name;
    const char* file;
    std::vector<std::string> more;
};

void PrintTo(const Case& one, std::ostream* out) {
    *out << one.name;
}

class Checkpoints : public testing::TestWithParam<Case> {};

TEST_P(Checkpoints, EachIsGoneOnFromToTheSameBits) {
    Scene scene = coarse(GetParam().file, GetParam().more);
    scene.full.checkpoint_interval = 1e-9;  // at every step at which there may be one
    scene.full.fields_rate = 40.0;
    const Given whole = run(scene, false), saving = run(scene, true);
    ASSERT_FALSE(is_numerical_failure(whole.record.status.code)) << whole.record.status.detail;
    ASSERT_EQ(test::run_difference(whole.record, saving.record), "");
    // One in 50 steps.
    ASSERT_NEAR(static_cast<double>(saving.saved.size()), static_cast<double>(whole.record.cost.steps) / 50.0,
                2.0);
    const std::size_t looks = 7;
    for (std::size_t look = 0; look < looks; ++look) {
        const std::size_t at = look * (saving.saved.size() - 1) / (looks - 1);
        SCOPED_TRACE(fmt::format("checkpoint {} of {}", at, saving.saved.size()));
        Given rest = run(scene, false, saving.saved[at]);
        EXPECT_EQ(test::run_difference(whole.record, rest.record), "");
        ASSERT_EQ(rest.record.cost.resumed_at.size(), 1u);
        EXPECT_EQ(rest.frames, whole.frames);
        const std::size_t before = saving.fields_then[at];
        ASSERT_EQ(before + rest.fields.size(), whole.fields.size());
        for (std::size_t i = 0; i < rest.fields.size(); ++i)
            EXPECT_EQ(vtu_text(rest.fields[i]), vtu_text(whole.fields[before + i])) << i;
    }
}

/// Every start, structure, layout, and whatever else has a memory of its own.
INSTANTIATE_TEST_SUITE_P(
    Runs, Checkpoints,
    testing::Values(
        Case{"line stretch", "c9-inflation.toml", {"stop.time=2.5"}},
        Case{"steady descent", "c9-inflation.toml", {"full.output_rate=20"}},
        Case{
            "uniform mesh, graded time", "c9-inflation.toml", {"full.mesh.grading='uniform'", "stop.time=1"}},
        Case{"noise, accreting air, mass damping",
             "c9-inflation.toml",
             {"full.noise={amplitude=1e-3,seed=7}", "aerodynamics.added_mass.momentum='accreting'",
              "full.alpha=1", "payload.drag_area=0.4", "stop.time=1"}},
        Case{"sector", "c9-inflation.toml", {"full.symmetry='sector'", "stop.time=2"}},
        Case{"sector of seven gores",
             "c9-inflation.toml",
             {"full.symmetry='sector'", "parachute.risers=4", "stop.time=1"}},
        Case{
            "thirty gores", "c9-inflation.toml", {"parachute.gores=30", "parachute.risers=3", "stop.time=1"}},
        Case{"predicted filling",
             "c9-inflation.toml",
             {"parachute.filling={model='predicted',initial_mouth=0.02,lowest_mouth=0.02,highest_mouth=0.02}",
              "stop.time=1.5"}},
        Case{"predicted filling from the pack",
             "paper/crane-drop.toml",
             {"parachute.filling={model='predicted',initial_mouth=0.02,lowest_mouth=0.02,highest_mouth=0.02}",
              "stop.at='full-open'"}},
        Case{"wind", "c9-crosswind.toml", {"stop.time=1"}},
        Case{"reefed", "c9-reefed.toml", {"full.output_rate=50"}},
        Case{"reefed predicted filling",
             "c9-reefed.toml",
             {"parachute.filling={model='predicted',initial_mouth=0.02,lowest_mouth=0.02,highest_mouth=0.02}",
              "parachute.reefing=[{drag_area_ratio=0.1,until={at='full-open',delay=0.5}}]",
              "stop.at='full-open'", "stop.delay='0.2 s'"}},
        Case{"from the pack", "paper/crane-drop.toml", {"stop.delay='50 ms'", "stop.at='full-open'"}},
        Case{"open from the start",
             "c9-inflation.toml",
             {"parachute.deploy={by='inflated'}", "release.speed=12", "stop.time=1"}},
        Case{"cluster, open from the start, on a body",
             "c9-inflation.toml",
             {"parachute.deploy={by='inflated'}", "parachute.count=2", "payload.mass=300", "release.speed=12",
              "parachute.risers=1", "payload.body={shape='box',size=[1,1,0.5],sling_length=1.2}",
              "stop.time=1"}},
        Case{"cluster",
             "c9-inflation.toml",
             {"parachute.count=2", "parachute.lag=[0,0.2]", "payload.mass=300", "stop.time=2.5"}},
        Case{"cluster from the packs",
             "paper/crane-drop.toml",
             {"parachute.count=2", "payload.mass=300", "stop.at='line-stretch'", "stop.delay='0.1 s'"}},
        Case{"a drogue, nothing, then the main from its pack",
             "c9-drogue.toml",
             {"full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}",
              "parachute.drogue.cut={time=0.9}",
              "parachute.main.deploy={by='pilot',pilot_drag_area=0.5,when={after='drogue.cut',delay=0.2}}",
              "stop={time=2.2}"}},
        Case{"two parachutes out at once",
             "c9-drogue.toml",
             {"full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}",
              "parachute.drogue.cut={time=1.6}", "parachute.main.deploy={by='line-stretch',when={time=1}}",
              "stop={time=2}"}},
        Case{"a crate under a drogue, alone, under the main",
             "c9-drogue.toml",
             {"full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}",
              "payload.body={shape='box',size=[0.3,0.4,0.2]}", "parachute.drogue.cut={time=0.9}",
              "parachute.main.deploy={by='line-stretch',when={time=1.2}}", "stop={time=1.6}"}},
        Case{"a drogue, then two mains from their packs",
             "c9-drogue.toml",
             {"full.mesh={gore_columns=2,gore_rows=7,line_elements=10,riser_elements=2}",
              "parachute.main.count=2", "payload.mass=180", "parachute.drogue.cut={time=1}",
              "parachute.main.lag=[0,0.1]",
              "parachute.main.reefing=[{drag_area_ratio=0.1,until={at='line-stretch',delay=0.2}}]",
              "stop.at='line-stretch'", "stop.delay='0.3 s'"}},
        Case{"elements carry the pack",
             "paper/crane-drop.toml",
             {"full.structure='fe'", "stop.at='line-stretch'", "stop.delay='0.1 s'"}}),
    [](const auto& one) {
        std::string name = one.param.name;
        std::erase_if(name, [](char c) { return c == ',' || c == ' '; });
        return name;
    });

// --- runs that are repeated with shorter steps --------------------------------------------

constexpr double too_long = 1.5;  // of the stable step: snatch adds 0.7 to 2 % to the energy of this drop

/// A parachute torn out of its pack, with a factor of its step that is the scene's own or nobody's.
Scene torn_out(double factor, InputOrigin origin) {
    const ScratchDir here;
    test::write_drop_data(here.path());
    Scene scene = read_scene_text(test::DropGenerator(1, 0, true).drop().text, "drop 0", here.path());
    scene.stop = {Trigger::Kind::time, 0.3, 0.0};
    scene.full.time_step_factor = factor;
    scene.full.fields_rate = 100.0;
    for (Input& input : scene.inputs)
        if (input.key == "full.time_step_factor") input.value = factor, input.origin = origin;
    return scene;
}

/// Fields from where a run began anew.
std::vector<std::string> last_fields(const Given& given) {
    std::vector<std::string> last;
    double time = -1.0;
    for (const VtuGrid& frame : given.fields) {
        if (*frame.time <= time) last.clear();
        time = *frame.time;
        last.push_back(vtu_text(frame));
    }
    return last;
}

TEST(RepeatedRuns, HaveHalfTheStepThatNobodyChose) {
    const Given chosen = run(torn_out(too_long, InputOrigin::given), false);
    ASSERT_EQ(chosen.record.status.code, StatusCode::energy_grew) << chosen.record.status.detail;
    // Its bits are those of a scene that says half.
    const Given half = run(torn_out(0.5 * too_long, InputOrigin::given), false);
    Given repeated = run(torn_out(too_long, InputOrigin::fallback), false);
    ASSERT_EQ(repeated.record.status.code, StatusCode::completed) << repeated.record.status.detail;
    EXPECT_LT(half.fields.size(), repeated.fields.size());
    EXPECT_EQ(last_fields(repeated), last_fields(half));
    EXPECT_EQ(repeated.frames, half.frames);
    // And it says so.
    const Warning said = repeated.record.warnings.back();
    repeated.record.warnings.pop_back();
    EXPECT_NE(said.what.find("full.time_step_factor = 0.75"), std::string::npos) << said.what;
    EXPECT_NE(said.why.find(chosen.record.status.detail), std::string::npos) << said.why;
    const auto factor = std::ranges::find(repeated.record.inputs, "full.time_step_factor", &Input::key);
    EXPECT_EQ(factor->origin, InputOrigin::fallback);
    factor->origin = InputOrigin::given;
    EXPECT_EQ(test::run_difference(repeated.record, half.record), "");
}

TEST(RepeatedRuns, GoOnFromTheCheckpointsOfEitherAttempt) {
    Scene scene = torn_out(too_long, InputOrigin::fallback);
    scene.full.checkpoint_interval = 1e-9;
    Given whole = run(scene, true);
    ASSERT_EQ(whole.record.status.code, StatusCode::completed) << whole.record.status.detail;
    whole.record.warnings.back().suggestion.clear();  // how long it took
    for (const std::size_t at : {std::size_t{1}, whole.saved.size() - 2}) {
        Given rest = run(scene, false, whole.saved[at]);
        rest.record.warnings.back().suggestion.clear();
        EXPECT_EQ(test::run_difference(whole.record, rest.record), "") << at;
        EXPECT_EQ(rest.frames, whole.frames) << at;
        ASSERT_FALSE(rest.fields.empty());
        EXPECT_EQ(vtu_text(rest.fields.back()), vtu_text(whole.fields.back())) << at;
    }
}

// --- the state of a simulation ------------------------------------------------------------

std::string serialized(Simulation& simulation) {
    Archive archive;
    simulation.serialize(archive);
    return archive.take();
}

/// Node by node, without what clocks measured.
std::string state_of(const Simulation& simulation) {
    State state = simulation.synchronised_state();
    Archive archive;
    serialize(archive, state);
    return archive.take();
}

void fly(Simulation& simulation, int steps) {
    for (int i = 0; i < steps; ++i) {
        simulation.evaluate_forces();
        const SystemState& s = simulation.system();
        if (s.stage == Stage::deployment && simulation.lines_are_taut()) {
            ASSERT_FALSE(simulation.snatch());
        } else if (s.stage == Stage::springs && simulation.mouth_is_open()) {
            simulation.begin_ramp();
        } else if (s.time >= simulation.ramp_end()) {
            simulation.end_ramp();
        } else if (s.stage != Stage::deployment && s.time >= simulation.inflation().end_of(s.phase)) {
            simulation.begin(s.phase == Phase::initial ? Phase::filling : Phase::open);
        }
        const double phase_end = s.stage == Stage::deployment ? 1e9 : simulation.inflation().end_of(s.phase);
        simulation.step_to(std::min({1e9, phase_end, simulation.ramp_end()}));
    }
}

/// Expects a state to be read back to the same bytes, and to go on to the same bits.
void expect_same_rest(const Scene& scene, const Simulation::LayoutMaker& layout, int steps, int rounds,
                      std::size_t stages = 1) {
    Simulation simulation(scene, layout);
    std::set<Stage> seen;
    for (int round = 0; round < rounds; ++round) {
        seen.insert(simulation.system().stage);
        SCOPED_TRACE(
            fmt::format("step {}, {}", simulation.system().step, stage_name(simulation.system().stage)));
        const std::string bytes = serialized(simulation);
        Simulation other(scene, layout);
        Archive archive(bytes, "a test");
        other.serialize(archive);
        archive.end();
        ASSERT_EQ(serialized(other), bytes);
        fly(simulation, steps);
        fly(other, steps);
        ASSERT_EQ(state_of(other), state_of(simulation));
        ASSERT_EQ(other.step().dt, simulation.step().dt);
    }
    EXPECT_EQ(seen.size(), stages) << "stages that were written";
}

TEST(CheckpointsOfLayouts, GoOnInEachLayoutAndInstructionSet) {
    // Thirty gores leave lanes without one. From line stretch into filling, where the weights of rows are
    // made anew while the added mass grows: 3000 steps.
    Scene scene = coarse("c9-inflation.toml", {"parachute.gores=30", "parachute.risers=3"});
    for (const unstructured::Kernels& kernels : unstructured::all_kernels()) {
        SCOPED_TRACE(fmt::format("unstructured, {}", kernels.instruction_set));
        expect_same_rest(
            scene,
            [&](const Scene& s, const Mesh& m, const NodeConstants& c) {
                return make_unstructured_layout(s, m, c, &kernels);
            },
            500, 6);
    }
    for (const GoreKernels& kernels : all_gore_kernels()) {
        SCOPED_TRACE(fmt::format("gores, {}", kernels.instruction_set));
        expect_same_rest(
            scene,
            [&](const Scene& s, const Mesh& m, const NodeConstants& c) {
                return make_gore_layout(s, m, c, &kernels);
            },
            500, 6);
    }
    expect_same_rest(
        scene,
        [](const Scene&, const Mesh& m, const NodeConstants& c) { return make_reference_layout(m, c); }, 200,
        3);
    scene.full.line_substeps = 1;
    for (const SectorKernels& kernels : all_sector_kernels()) {
        SCOPED_TRACE(fmt::format("sector, {}", kernels.instruction_set));
        expect_same_rest(
            scene,
            [&](const Scene& s, const Mesh& m, const NodeConstants& c) {
                return make_sector_layout(s, m, c, nullptr, &kernels);
            },
            500, 6);
    }
}

TEST(CheckpointsOfLayouts, GoOnInEachStage) {
    Scene scene = coarse("paper/crane-drop.toml", {"full.beta=1e-7", "parachute.deploy.length='3 m'"});
    expect_same_rest(scene, Simulation::layout_of_one_thread, 500, 60, 4);
}

TEST(CheckpointsOfLayouts, RefuseAnotherMeshLayoutAndInstructionSet) {
    const Scene scene = coarse("c9-inflation.toml");
    const auto unstructured = [](std::size_t which) {
        return [which](const Scene& s, const Mesh& m, const NodeConstants& c) {
            return make_unstructured_layout(s, m, c, &unstructured::all_kernels()[which]);
        };
    };
    Simulation simulation(scene, unstructured(0));
    fly(simulation, 100);
    const std::string bytes = serialized(simulation);
    const auto why_not = [&](Simulation&& other) {
        try {
            Archive archive(bytes, "a test");
            other.serialize(archive);
        } catch (const RecordError& error) {
            return std::string(error.what());
        }
        return std::string("it is read");
    };
    EXPECT_NE(why_not(Simulation(coarse("c9-inflation.toml", {"full.mesh.gore_rows=6"}), unstructured(0)))
                  .find("is of another mesh"),
              std::string::npos);
    EXPECT_NE(why_not(Simulation(scene)).find("is of another layout of nodes and elements"),
              std::string::npos);
    if (unstructured::all_kernels().size() > 1) {
        EXPECT_NE(why_not(Simulation(scene, unstructured(1))).find("is of another instruction set"),
                  std::string::npos);
    }
}

}  // namespace
}  // namespace twinchute::fullsim
