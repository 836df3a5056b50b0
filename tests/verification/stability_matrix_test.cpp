// The stability matrix, and that a wrong build would fail it.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "compare/stability.hpp"
#include "compare/stability/base_scenes.hpp"
#include "compare/stability_command.hpp"
#include "fullsim/fidelity.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/write_scene.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

using namespace compare;

const Fidelity& fidelity_of(const StabilityCase& row) {
    return row.fidelity == "rom" ? rom::rom_fidelity() : fullsim::full_fidelity();
}

std::string title(const StabilityCell& cell) {
    return std::string(cell.row->fidelity) + ", " + cell.row->name + ", " + cell.method + ": " +
           std::string(cell_verdict_name(cell.verdict)) + ", " + cell.reason;
}

TEST(StabilityMatrix, StartsFromTheShippedC9) {
    // Built in code, since the matrix needs no file; the numbers are those of data/, which have their
    // sources.
    const Parachute built = c9_at_line_stretch().parachutes.front();
    const Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    const Parachute& shipped = scene.parachutes.front();
    for (double Parachute::*number :
         {&Parachute::nominal_diameter, &Parachute::drag_area, &Parachute::projected_diameter_ratio,
          &Parachute::mass, &Parachute::vent_diameter, &Parachute::line_length, &Parachute::riser_length})
        EXPECT_NEAR(built.*number, shipped.*number, 1e-12 * shipped.*number);
    EXPECT_EQ(built.gores, shipped.gores);
    EXPECT_EQ(built.fabric, shipped.fabric);
    EXPECT_EQ(built.line, shipped.line);
    EXPECT_EQ(built.tapes, shipped.tapes);
    EXPECT_EQ(c9_at_line_stretch().payload.mass, scene.payload.mass);
}

TEST(StabilityMatrix, NoQuickCellFails) {
    std::map<CellVerdict, int> count;
    std::set<std::string> stops;
    for (const StabilityCase& row : stability_cases()) {
        if (!row.quick) continue;
        for (const StabilityMethod& method : row.methods) {
            const StabilityCell cell = judge(row, method, fidelity_of(row)).value();
            EXPECT_FALSE(is_failure(cell.verdict)) << title(cell);
            ++count[cell.verdict];
            if (cell.verdict == CellVerdict::stopped) stops.insert(cell.status);
            if (cell.verdict == CellVerdict::stable) {
                EXPECT_GE(*cell.margin, 1.0) << title(cell);
            }
        }
    }
    EXPECT_GT(count[CellVerdict::stable], 80);
    EXPECT_GT(count[CellVerdict::refused], 10);
    // A failure of the integrator is named, and never given as an answer.
    EXPECT_TRUE(stops.contains("solver_failed"));
    EXPECT_TRUE(stops.contains("step_limit"));
}

TEST(StabilityMatrix, NoOtherCellFails) {
    int stable = 0;
    for (const StabilityCase& row : stability_cases()) {
        if (row.quick) continue;
        for (const StabilityMethod& method : row.methods) {
            const StabilityCell cell = judge(row, method, fidelity_of(row)).value();
            EXPECT_FALSE(is_failure(cell.verdict)) << title(cell);
            stable += cell.verdict == CellVerdict::stable;
        }
    }
    EXPECT_GT(stable, 60);
}

TEST(StabilityMatrix, RowsHaveNamesOfTheirOwnAndReasons) {
    std::set<std::string> names;
    for (const StabilityCase& row : stability_cases()) {
        EXPECT_TRUE(names.insert(std::string(row.fidelity) + row.name).second) << row.name;
        EXPECT_FALSE(row.why.empty()) << row.name;
        EXPECT_FALSE(row.methods.empty()) << row.name;
        // Whatever cannot be checked has to be refused.
        EXPECT_TRUE(row.check || row.causes == std::vector{StatusCode::refused}) << row.name;
    }
}

TEST(StabilityMatrix, EveryCaseCanBeWrittenAsASceneThatIsReadAlike) {
    // The matrix runs, and refuses, scenes that a user can write: the reader agrees on their text.
    // Materials are by name there, so that those of a case keep the shipped numbers.
    for (const StabilityCase& row : stability_cases()) {
        if (!row.asked.empty()) continue;
        for (const StabilityMethod& method : row.methods) {
            Scene scene = row.base();
            scene.name = row.name;
            if (row.change) row.change(scene);
            method.choose(scene);
            const auto refused = refusal(row, scene, fidelity_of(row));
            std::optional<std::string> read;
            try {
                const Scene back =
                    read_scene_text(write_scene(scene), "case.toml", TWINCHUTE_SOURCE_DIR "/data");
                EXPECT_EQ(back.release, scene.release) << row.name;
                EXPECT_EQ(back.full, scene.full) << row.name;
                EXPECT_EQ(back.rom, scene.rom) << row.name;
                if (!fidelity_of(row).unsupported_keys(back).empty()) read = "lacks";
            } catch (const SceneError& error) {
                read = error.what();
            }
            EXPECT_EQ(refused.has_value(), read.has_value())
                << row.name << ", " << method.name << ": " << refused.value_or("-") << " / "
                << read.value_or("-");
        }
    }
}

/// Builds of the reduced-order model that are wrong, each in its own way: they heed no tolerance, release at
/// a thousandth more speed than the scene says, or into a gravity that is a thousandth stronger.
RunRecord run_wrong(Scene scene, Run& run, void (*change)(Scene&)) {
    change(scene);
    return rom::rom_fidelity().run(scene, run);
}
RunRecord sloppy(const Scene& scene, Run& run) {
    return run_wrong(scene, run, [](Scene& s) { s.rom.rtol = 1e-2; });
}
RunRecord too_fast(const Scene& scene, Run& run) {
    return run_wrong(scene, run, [](Scene& s) { s.release.speed *= 1.001; });
}
RunRecord too_heavy(const Scene& scene, Run& run) {
    return run_wrong(scene, run, [](Scene& s) { s.environment.gravity *= 1.001; });
}
const Fidelity wrong[] = {{"rom", "sloppy", &sloppy, rom::rom_fidelity().unsupported_keys},
                          {"rom", "too fast", &too_fast, rom::rom_fidelity().unsupported_keys},
                          {"rom", "too heavy", &too_heavy, rom::rom_fidelity().unsupported_keys}};

TEST(StabilityMatrix, EveryAnswerOfTheReducedOrderModelIsSeenWhenItIsWrong) {
    for (const StabilityCase& row : stability_cases()) {
        if (!row.quick || row.fidelity != "rom") continue;
        for (const StabilityMethod& method : row.methods) {
            if (judge(row, method, rom::rom_fidelity())->verdict != CellVerdict::stable) continue;
            bool seen = false;
            for (const Fidelity& build : wrong)
                seen = seen || judge(row, method, build)->verdict == CellVerdict::silently_wrong;
            EXPECT_TRUE(seen) << row.name << ", " << method.name;
        }
    }
}

/// Records of the full model that are wrong: energy from nowhere, a force that the step at hand drives up, a
/// payload that is faster than its forces made it.
RunRecord leaking(const Scene& scene, Run& run) {
    RunRecord record = fullsim::full_fidelity().run(scene, run);
    record.energy->residual_fraction += 0.01;
    return record;
}
RunRecord ringing(const Scene& scene, Run& run) {
    RunRecord record = fullsim::full_fidelity().run(scene, run);
    if (scene.full.time_step_factor > 0.9)
        record.add_metric("max_force_N", 1.01 * *record.metric("max_force_N"));
    return record;
}
RunRecord pushed(const Scene& scene, Run& run) {
    RunRecord record = fullsim::full_fidelity().run(scene, run);
    for (Channel& channel : record.channels)
        if (channel.name == "vertical_speed" || channel.name == "speed") channel.values.back() *= 1.1;
    return record;
}

TEST(StabilityMatrix, EveryAnswerOfTheFullModelIsSeenWhenItIsWrong) {
    const auto no_keys = fullsim::full_fidelity().unsupported_keys;
    const Fidelity leaks{"full", "leaking", &leaking, no_keys}, rings{"full", "ringing", &ringing, no_keys},
        is_pushed{"full", "pushed", &pushed, no_keys};
    for (const StabilityCase& row : stability_cases()) {
        if (!row.quick || row.fidelity != "full" || !row.check) continue;
        for (const StabilityMethod& method : row.methods) {
            if (judge(row, method, fullsim::full_fidelity())->verdict != CellVerdict::stable) continue;
            EXPECT_EQ(judge(row, method, leaks)->verdict, CellVerdict::silently_wrong) << row.name;
            EXPECT_EQ(judge(row, method, is_pushed)->verdict, CellVerdict::silently_wrong) << row.name;
            // That of the canopy that starts open is held by a closed form alone.
            if (row.name != "open canopy at rest") {
                EXPECT_EQ(judge(row, method, rings)->verdict, CellVerdict::silently_wrong) << row.name;
            }
        }
    }
}

/// Full models whose unstructured layout alone is wrong: a bound on the step that is one and a half times too
/// long; forces that are off by a thousandth.
RunRecord steps_too_long(const Scene& scene, Run& run) {
    Scene longer = scene;
    if (run.force_unstructured) longer.full.time_step_factor *= 1.5;
    return fullsim::full_fidelity().run(longer, run);
}
RunRecord pulls_too_hard(const Scene& scene, Run& run) {
    RunRecord record = fullsim::full_fidelity().run(scene, run);
    if (run.force_unstructured) record.add_metric("max_force_N", 1.001 * *record.metric("max_force_N"));
    return record;
}

TEST(StabilityMatrix, TheUnstructuredLayoutIsSeenWhenItAloneIsWrong) {
    const auto no_keys = fullsim::full_fidelity().unsupported_keys;
    const Fidelity too_long_steps{"full", "steps too long", &steps_too_long, no_keys},
        too_hard{"full", "pulls too hard", &pulls_too_hard, no_keys};
    int unstructured = 0;
    for (const StabilityCase& row : stability_cases()) {
        if (!row.quick || row.fidelity != "full" || !row.check) continue;
        for (const StabilityMethod& method : row.methods) {
            if (!method.force_unstructured) continue;
            const auto cell = judge(row, method, fullsim::full_fidelity());
            if (cell->verdict != CellVerdict::stable) continue;
            ++unstructured;
            EXPECT_TRUE(is_failure(judge(row, method, too_long_steps)->verdict)) << row.name;
            EXPECT_EQ(judge(row, method, too_hard)->verdict, CellVerdict::silently_wrong) << row.name;
        }
    }
    EXPECT_GE(unstructured, 3);
}

std::string layout_of(const Scene& scene, bool force_unstructured) {
    Run run;
    run.force_unstructured = force_unstructured;
    return fullsim::full_fidelity().run(scene, run).provenance.instruction_set;
}

TEST(StabilityMatrix, CasesOfTheFullModelRunUnstructuredUnlessTheyAreOfOneSector) {
    for (const StabilityCase& row : stability_cases()) {
        if (row.fidelity != "full") continue;
        bool unstructured = false, of_all_gores = false;
        for (const StabilityMethod& method : row.methods) {
            Scene scene = row.base();
            method.choose(scene);
            unstructured = unstructured || method.force_unstructured;
            of_all_gores = of_all_gores || scene.full.symmetry == Symmetry::none;
            EXPECT_FALSE(method.force_unstructured && scene.full.symmetry == Symmetry::sector) << row.name;
        }
        EXPECT_EQ(unstructured, of_all_gores) << row.name;
    }
    // And that is what it is in memory.
    Scene scene = c9_coarse();
    scene.stop = {Trigger::Kind::time, 0.01, 0.0};
    for (const bool any : {false, true}) {
        const std::string layout = layout_of(scene, any);
        EXPECT_TRUE(layout.ends_with(any ? ", unstructured" : ", gore-batched")) << layout;
    }
}

TEST(StabilityMatrix, AWrongBuildIsExitCodeOne) {
    const ScratchDir here;
    Arguments arguments;
    arguments.options = {{"quick", {}}, {"quiet", {}}, {"out", {(here / "out").string()}}};
    EXPECT_EQ(stability_command(fullsim::full_fidelity(), wrong[1]).run(arguments), ExitCode::verdict);
    EXPECT_TRUE(std::filesystem::is_regular_file(here / "out/stability.md"));
}

}  // namespace
}  // namespace twinchute
