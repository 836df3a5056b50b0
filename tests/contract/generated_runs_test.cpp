// Random scenes made from the table of keys, run: every one ends in a named status, and whatever
// is reported is a finite number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fullsim/fidelity.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/storage/simd/sanitized.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/scene_generator.hpp"

namespace twinchute::test {
namespace {

// Sanitizers make a step thirty times as dear; what they look for shows in few runs.
constexpr int full_runs = is_sanitized ? 20 : 50, rom_runs = is_sanitized ? 200 : 1000;

void expect_sound(const RunRecord& record, const std::string& text) {
    ASSERT_FALSE(status_name(record.status.code).empty());
    ASSERT_FALSE(record.status.detail.empty()) << status_name(record.status.code) << '\n' << text;
    for (const Metric& metric : record.metrics)
        ASSERT_TRUE(std::isfinite(metric.value)) << metric.key << ", " << record.status.detail << '\n'
                                                 << text;
    for (const Channel& channel : record.channels)
        for (const double value : channel.values)
            ASSERT_TRUE(std::isfinite(value)) << channel.name << ", " << record.status.detail << '\n' << text;
    for (const Event& event : record.events)
        ASSERT_TRUE(std::isfinite(event.time) && std::isfinite(event.speed)) << event.name << '\n' << text;
}

/// Air that joins a canopy whose drag area begins to rise with infinite rate: a force that no method
/// integrates to the last digits, and which a run that asks for them has to give up on.
bool begins_infinitely_fast(const Scene& scene) {
    const auto& added = scene.aerodynamics.added_mass;
    return added && added->momentum == AddedMassMomentum::accreting &&
           std::ranges::any_of(scene.parachutes, [](const Parachute& p) {
               return p.drag_area_law == find_drag_area_law("power-0.5");
           });
}

class GeneratedRuns : public testing::Test {
protected:
    GeneratedRuns() { write_generated_tables(directory_); }
    ScratchDir directory_;
};

TEST_F(GeneratedRuns, RomEndsSoundly) {
    SceneGenerator generator(4);
    std::map<StatusCode, int> endings;
    int deployed = 0;
    for (int i = 0; i < rom_runs; ++i) {
        const std::string text = scene_of_lines(generator.valid());
        const Scene scene = read_scene_text(text, "generated.toml", directory_.path());
        if (!rom::rom_fidelity().unsupported_keys(scene).empty()) continue;
        const RunRecord record = run_rom(scene);
        deployed += scene.parachutes.front().deploy.starts_packed() && record.find_event("snatch") != nullptr;
        ++endings[record.status.code];
        if (record.status.code == StatusCode::solver_failed) {
            EXPECT_TRUE(begins_infinitely_fast(scene) && scene.rom.rtol < 1e-12)
                << record.status.detail << '\n'
                << text;
        }
        expect_sound(record, text);
        if (HasFatalFailure()) return;
    }
    for (const auto& [code, count] : endings)
        RecordProperty(std::string(status_name(code)), count);
    RecordProperty("deployed", deployed);
    EXPECT_GT(endings[StatusCode::completed], rom_runs / 4);
    EXPECT_GT(deployed, 0.15 * rom_runs);
    // A tolerance of 1e-14 by a method of order two takes more steps than there are, and so does a pack that
    // the air stops within a millisecond; nothing else may fail. Of 2000 runs one in 90 does; four standard
    // deviations more make the bound.
    constexpr double expected = rom_runs / 90.0;
    EXPECT_LT(endings[StatusCode::step_limit], expected + 4.0 * std::sqrt(expected));
}

TEST_F(GeneratedRuns, FullEndsSoundly) {
    SceneGenerator generator(5);
    std::map<StatusCode, int> endings;
    for (int made = 0; made < full_runs;) {
        const std::string text = scene_of_lines(generator.valid());
        Scene scene = read_scene_text(text, "generated.toml", directory_.path());
        scene.parachutes.front().mesh.reset();  // there is no such file
        if (scene.payload.body)                 // one that any number of risers reaches over
            scene.payload.body = {PayloadBody::Shape::cylinder,
                                  {0.5 * scene.parachutes.front().riser_length, 1.0}};
        double step = 0.0;
        try {
            if (!fullsim::full_fidelity().unsupported_keys(scene).empty()) continue;
            scene.full.mesh = {1, 3, 2, 1};  // 168 triangles where there are 28 gores
            // Random materials may ask for steps of nanoseconds: as far as 20 000 of them go.
            step = scene.full.time_step_factor * fullsim::Simulation(scene).bound().dt;
        } catch (const SceneError& error) {  // only the mesh shows how short is too short
            ASSERT_TRUE(error.key() == "parachute.vent_lines.length" ||
                        error.key() == "parachute.line_length" ||
                        error.key() == "parachute.reefing.1.line_length")
                << error.what();
            continue;
        }
        // A canopy that starts inflated settles first, for seconds, whatever the stop.
        if (scene.parachutes.front().deploy.by == DeployBy::inflated && step < 2e-5) continue;
        ++made;
        scene.stop = {Trigger::Kind::time, std::min(5.0, 2e4 * step), 0.0};
        const RunRecord record = run_full(scene);
        ++endings[record.status.code];
        expect_sound(record, text);
        if (HasFatalFailure()) return;
    }
    for (const auto& [code, count] : endings)
        RecordProperty(std::string(status_name(code)), count);
    // Random materials tear or ask for steps too small; a battery of those alone would show nothing.
    EXPECT_GT(endings[StatusCode::completed], full_runs / 5);
}

/// Changes of the shipped drogue and main: one or two of the first, one to three of the second, each out and
/// disreefed and cut at another time.
std::vector<std::string> random_stages(Random& random) {
    static const std::vector<std::string> means{"'line-stretch'", "'pilot',pilot_drag_area=0.5",
                                                "'mortar',muzzle_speed=25", "'inflated'"},
        conditions{"time=0.4", "altitude='950 m'", "after='drogue.full-open'", "after='drogue.cut'"},
        cuts{"time=1.5", "time=3", "after='main.line-stretch'", "after='main.full-open'", "time=100"};
    const std::string mean = random.one_of(means);
    const std::size_t count = 1 + random.below(3);
    std::vector<std::string> changes{
        "full.mesh={gore_columns=1,gore_rows=5,line_elements=4,riser_elements=2}",
        "stop={time=5}",
        fmt::format("payload.mass={}", 90 * count),
        fmt::format("parachute.drogue.count={}", 1 + random.below(2)),
        "parachute.drogue.cut={" + random.one_of(cuts) + "}",
        fmt::format("parachute.main.count={}", count),
        fmt::format("parachute.main.deploy={{by={},when={{{}}}}}", mean, random.one_of(conditions))};
    if (mean == "'inflated'") return changes;
    if (random.random_bool(0.5)) {
        std::string lags;
        for (std::size_t k = 0; k < count; ++k)
            lags += fmt::format("{}{}", k > 0 ? "," : "", random.number_in(0.0, 0.5));
        changes.push_back("parachute.main.lag=[" + lags + "]");
    }
    if (random.random_bool(0.6)) {
        changes.push_back(
            fmt::format("parachute.main.reefing=[{{drag_area_ratio=0.1,until={{at='{}',delay={}}}}}]",
                        random.random_bool(0.5) ? "line-stretch" : "full-open", random.number_in(0.0, 1.0)));
        if (random.random_bool(0.5)) changes.emplace_back("parachute.main.skips_reefing=1");
    }
    if (random.random_bool(0.3)) changes.emplace_back("parachute.main.cut={time=4}");
    return changes;
}

TEST(GeneratedStages, OfTheFullModelEndSoundly) {
    Random random(6);
    std::map<StatusCode, int> endings;
    for (int made = 0; made < (is_sanitized ? 4 : 16);) {
        const std::vector<std::string> changes = random_stages(random);
        const std::string text = fmt::format("{}", fmt::join(changes, "\n"));
        Scene scene;
        try {
            scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-drogue.toml", changes);
        } catch (const SceneError& error) {  // a drogue that is cut by what waits for that
            ASSERT_TRUE(error.key().find("cut") != std::string::npos) << error.what();
            continue;
        }
        ++made;
        const RunRecord record = run_full(scene);
        ++endings[record.status.code];
        EXPECT_FALSE(is_numerical_failure(record.status.code)) << record.status.detail << '\n' << text;
        expect_sound(record, text);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(endings[StatusCode::completed], is_sanitized ? 1 : 8);
}

}  // namespace
}  // namespace twinchute::test
