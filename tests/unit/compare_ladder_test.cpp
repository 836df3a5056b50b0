// A ladder of synthetic models whose errors are known exactly: what is an error, what is a gap, and what
// becomes of levels that fail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "compare/ladder.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/count.hpp"
#include "tests/support/synthetic_ladder.hpp"

namespace twinchute::compare {
namespace {

const LevelResult& level(const Ladder& ladder, const std::string& name) {
    const auto found =
        std::ranges::find_if(ladder.levels, [&](const LevelResult& r) { return r.level.name == name; });
    if (found == ladder.levels.end()) throw std::runtime_error("no level " + name);
    return *found;
}

TEST(CompareLadder, LevelsHaveNamesOfTheirOwn) {
    for (const bool packed : {false, true}) {
        const Scene scene = packed ? test::packed_c9(DeployBy::static_line) : test::c9_scene();
        std::set<std::string> names;
        int given = 0;
        for (const Level& r : ladder_levels(scene)) {
            EXPECT_TRUE(names.insert(r.name).second) << r.name;
            EXPECT_FALSE(r.why.empty()) << r.name;
            EXPECT_EQ(std::ranges::count(drawn_families(), r.family), 1) << r.name;
            // A level other than the scene as given says what it changes.
            EXPECT_EQ(setting_of(r, scene) == "as given", r.given) << r.name;
            given += r.given;
        }
        EXPECT_EQ(given, 2);  // one a fidelity
    }
}

TEST(CompareLadder, OnlyEffectsThatTheSceneHasAreLeftOut) {
    const auto effects_of = [](const Scene& scene) {
        std::set<std::string> names;
        for (const Level& r : ladder_levels(scene))
            if (r.family.ends_with("without an effect")) names.insert(r.name);
        return names;
    };
    Scene scene = test::c9_scene();
    EXPECT_EQ(effects_of(scene), (std::set<std::string>{"rom, no added mass", "full, no added mass",
                                                        "full, no line drag", "full, no breathing damping",
                                                        "full, no bulk viscosity", "full, one sector"}));
    scene.aerodynamics = {};
    scene.full.bulk_viscosity = 0.0;
    scene.full.noise = Noise{1e-4, 1};  // gores differ: no sector stands for all
    EXPECT_EQ(effects_of(scene), (std::set<std::string>{"full, no noise"}));
}

TEST(CompareLadder, AnErrorIsHeldAgainstTheSamePhysicsAndNothingElse) {
    const Ladder ladder = synthetic_ladder();
    for (const double rtol : {1e-3, 1e-6, 1e-8}) {
        const LevelResult& r = level(ladder, fmt::format("rom, rtol 1e{:.0f}", std::log10(rtol)));
        // Against the level of 1e-13: of 1 + rtol and 1 + 1e-13.
        EXPECT_NEAR(r.find("peak_force")->error.value(), rtol, 2e-13 + 1e-4 * rtol);
        EXPECT_NEAR(r.error.value().value, rtol, 2e-13 + 1e-4 * rtol);
        EXPECT_NEAR(r.gap_to("full").value().value, 0.25, 1.3 * rtol + 1e-8);  // 5000 over 4000
        EXPECT_FALSE(r.gap_to("rom"));
    }
    // Three meshes of one order give the limit, so that even the finest has an error.
    for (const auto& [name, h] :
         {std::pair{"full, mesh x0.5", 2.0}, {"full, mesh x1", 1.0}, {"full, mesh x2", 0.5}}) {
        const LevelResult& r = level(ladder, name);
        // Rows are whole numbers: 8.5 are 9, and one column is the fewest.
        const double expected = 0.08 * h * h;
        EXPECT_NEAR(r.error.value().value, expected, 0.06 * expected) << name;
        EXPECT_NEAR(r.gap_to("rom").value().value, std::abs(1 - 0.8 * (1 + expected)), 0.05 * expected)
            << name;
    }
    ASSERT_TRUE(ladder.gap);
    EXPECT_NEAR(ladder.gap->value, 0.25, 1e-6);
    EXPECT_EQ(ladder.gap->metric, "peak_force");
}

TEST(CompareLadder, EachOfSeveralParachutesIsJudged) {
    // Three times as wrong, and 100 N where the dear model says 72 N: worse than of all together.
    const RunOne with_drogue = [](const Fidelity& fidelity, const Scene& scene) {
        RunRecord record = synthetic(fidelity, scene);
        const bool quick = fidelity.name == "rom";
        record.events.push_back({"Pilot-1.full-open", 1.0, 0.0, 0.0});
        record.add_metric("pilot_1_peak_force_N", quick ? 100.0 * (1.0 + 3.0 * scene.rom.rtol) : 72.0);
        record.add_metric("other_peak_force_N",
                          1.0 + (quick ? 1e3 * scene.rom.rtol : 0.0));  // no parachute's
        return record;
    };
    const Ladder ladder = synthetic_ladder({}, test::c9_scene(), with_drogue);
    EXPECT_EQ(ladder.judged,
              (std::vector<std::string_view>{"filling_time", "peak_force", "pilot_1_peak_force"}));
    const LevelResult& r = level(ladder, "rom, rtol 1e-6");
    // Distance of 1 + 3e-6 from 1 + 3e-13, rounded to 1e-16.
    EXPECT_NEAR(r.error.value().value, 3e-6, 1e-12);
    EXPECT_EQ(r.error.value().metric, "pilot_1_peak_force");
    EXPECT_EQ(r.estimate.value().metric, "pilot_1_peak_force");
    EXPECT_EQ(ladder.gap.value().metric, "pilot_1_peak_force");
    EXPECT_NEAR(ladder.gap.value().value, 100.0 / 72.0 - 1.0, 1e-12);
}

TEST(CompareLadder, TheReferenceSaysHowItCameAbout) {
    const Ladder ladder = synthetic_ladder();
    for (const LadderReference& reference : ladder.references) {
        if (reference.row->name != "peak_force") continue;
        if (reference.fidelity == "full") {
            EXPECT_NEAR(reference.value, full_limit, 1e-6 * full_limit);
            EXPECT_NE(reference.how.find("Richardson"), std::string::npos);
            EXPECT_NE(reference.how.find("order 2"), std::string::npos) << reference.how;
        } else {
            EXPECT_EQ(reference.how, "rom, rtol 1e-13");
        }
    }
    const LevelResult& finest = level(ladder, "rom, rtol 1e-13");
    EXPECT_TRUE(finest.is_reference);
    EXPECT_FALSE(finest.error);  // it would be zero by definition
    EXPECT_NEAR(finest.estimate.value().value, 0.9e-12, 1e-14);
}

TEST(CompareLadder, WhatIsLeftOutIsAnEffectAndNoError) {
    const Ladder ladder = synthetic_ladder();
    for (const char* name : {"rom, no added mass", "full, no added mass"}) {
        EXPECT_FALSE(level(ladder, name).error) << name;
        EXPECT_NEAR(level(ladder, name).effect.value().value, 0.1, 1e-12) << name;
        EXPECT_FALSE(level(ladder, name).on_front) << name;
    }
    EXPECT_FALSE(level(ladder, "rom, rtol 1e-8").effect);
}

TEST(CompareLadder, AClosedFormHasAGapAndNoError) {
    // sqrt(2 m g/(rho C_D S)) of 152.4 + 5.19 kg on 42.56 m^2 in 1.225 kg/m^3 is 7.69965 m/s, by hand.
    const Ladder ladder = synthetic_ladder();
    const LevelResult& balance = level(ladder, "descent balance");
    EXPECT_NEAR(balance.find("descent_rate")->value, 7.69965, 1e-5);
    EXPECT_FALSE(balance.error);
    EXPECT_GT(balance.wall_s, 0.0);
    EXPECT_LT(balance.wall_s, 1e-3);
    const LevelResult& filling = level(ladder, "filling correlation");
    EXPECT_NEAR(filling.find("filling_time")->value, 4 * 8.53 / 21, 1e-12);
}

TEST(CompareLadder, TheFrontAndTheAdviceAreOfNumericalErrors) {
    const Ladder ladder = synthetic_ladder();
    for (const char* name : {"rom, rtol 1e-3", "rom, rtol 1e-8", "full, mesh x0.5", "full, mesh x3"})
        EXPECT_TRUE(level(ladder, name).on_front) << name;
    EXPECT_EQ(cheapest(ladder, "rom", 1e-2)->level.name, "rom, rtol 1e-3");
    EXPECT_EQ(cheapest(ladder, "full", 0.1)->level.name, "full, mesh x1");
    EXPECT_EQ(cheapest(ladder, "full", 1e-6), nullptr);
    EXPECT_NE(advice(ladder).find("no level of full"), std::string::npos);
}

TEST(CompareLadder, SeedsGiveMedianAndRange) {
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.full.mesh = test::c9_scene().full.mesh;
    LadderOptions options;
    options.seeds = 3;
    const Ladder ladder = synthetic_ladder(options, scene);
    const LevelResult& full = level(ladder, "full, mesh x1");
    EXPECT_EQ(full.seeds, 3);
    const LevelMetric& peak = *full.find("peak_force");  // 1.08 and 0.001, 0.002, 0.003 of noise
    EXPECT_NEAR(peak.low, full_limit * 1.081, 1e-6);
    EXPECT_NEAR(peak.value, full_limit * 1.082, 1e-6);
    EXPECT_NEAR(peak.high, full_limit * 1.083, 1e-6);
    EXPECT_EQ(level(ladder, "rom, rtol 1e-8").seeds, 1);
    EXPECT_EQ(level(ladder, "full, no noise").seeds, 1);
}

TEST(CompareLadder, QuickLeavesOutWhatIsDear) {
    LadderOptions options;
    options.quick = true;
    for (const LevelResult& r : synthetic_ladder(options).levels)
        EXPECT_LE(r.level.cost, quick_cost) << r.level.name;
    EXPECT_LT(synthetic_ladder(options).levels.size(), synthetic_ladder().levels.size());
}

/// The dear model breaks on meshes finer than the scene's.
RunRecord fragile(const Fidelity& fidelity, const Scene& scene) {
    RunRecord record = synthetic(fidelity, scene);
    if (fidelity.name == "full" && scene.full.mesh.gore_rows > 17)
        record.status = {StatusCode::energy_grew, "at \"0.5\" s, energy came from nowhere"};
    return record;
}

TEST(CompareLadder, TheDistanceToATestIsKeptApart) {
    // 4500 N lies between the synthetic limits, 5000 N and 4000 N: 1/9 above and below. Nothing else may move
    // by it.
    LadderOptions options;
    options.test = TestReference{"drop-7.csv", {{find_metric_row("peak_force"), 4500.0}}};
    const Ladder held = synthetic_ladder(options), free = synthetic_ladder();
    EXPECT_NEAR(level(held, "rom, rtol 1e-13").to_test->value, 500.0 / 4500.0, 1e-12);
    EXPECT_NEAR(level(held, "full, mesh x1").to_test->value, 1.0 - 4000.0 * 1.08 / 4500.0, 1e-12);
    EXPECT_TRUE(level(held, "full, no added mass").to_test);
    for (std::size_t i = 0; i < held.levels.size(); ++i) {
        EXPECT_FALSE(free.levels[i].to_test);
        EXPECT_EQ(held.levels[i].error.has_value(), free.levels[i].error.has_value());
        if (held.levels[i].error) {
            EXPECT_EQ(held.levels[i].error->value, free.levels[i].error->value);
        }
        for (const auto& [to, gap] : held.levels[i].gaps)
            EXPECT_EQ(gap.value, free.levels[i].gap_to(to)->value);
    }
    EXPECT_NE(ladder_csv(held).find(",distance_to_test\n"), std::string::npos);
    EXPECT_EQ(ladder_csv(free).find("distance_to_test"), std::string::npos);
    std::istringstream lines(ladder_csv(held));
    std::string first, line;
    std::getline(lines, first);
    while (std::getline(lines, line)) {
        if (line.find('"') != std::string::npos) continue;  // commas of names
        EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(first, ',')) << line;
    }
    EXPECT_NE(ladder_markdown(held).find("| to test |"), std::string::npos);
    EXPECT_NE(ladder_json(held).find("\"distance_to_test\""), std::string::npos);
}

TEST(TestReferences, AreHistoriesOrMetrics) {
    const TestReference history = read_test_reference("time,force\ns,kN\n0,1\n0.1,5.25\n0.2,4\n", "a.csv");
    ASSERT_EQ(history.values.size(), 1u);
    EXPECT_EQ(history.values[0].row->name, "peak_force");
    EXPECT_DOUBLE_EQ(history.values[0].value, 5250.0);
    const TestReference metrics = read_test_reference(
        "descent_rate,max_deceleration,mass_ratio\r\nft/s,g,1\r\n25,3.5,0.2\r\n", "b.csv");
    ASSERT_EQ(metrics.values.size(), 3u);
    EXPECT_DOUBLE_EQ(metrics.values[0].value, 7.62);
    EXPECT_DOUBLE_EQ(metrics.values[1].value, 3.5);
    EXPECT_DOUBLE_EQ(metrics.values[2].value, 0.2);
}

TEST(TestReferences, SayWhatIsWrongAndWhere) {
    const std::pair<const char*, const char*> wrong[] = {
        {"", "empty"},
        {"time\ns\n0\n1\n", "force"},
        {"time,force\ns,N\n1,5\n0,4\n", "c.csv:4"},  // does not rise
        {"peak_forse\nN\n5\n", "peak_forse"},
        {"main_peak_force\nN\n5\n", "one parachute"},
        {"peak_force\nm\n5\n", "c.csv:3"},
        {"peak_force\nN\nnan\n", "c.csv:3"},
        {"peak_force\nN\n", "three lines"},
        {"peak_force,descent_rate\nN,m/s\n5\n", "c.csv:3"},
        {"peak_force,peak_force\nN,N\n5,5\n", "twice"},
    };
    for (const auto& [text, said] : wrong) {
        try {
            read_test_reference(text, "c.csv");
            ADD_FAILURE() << text;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
        }
    }
}

TEST(CompareLadder, AFailureIsARowWithoutAnswers) {
    const Ladder ladder = synthetic_ladder({}, test::c9_scene(), fragile);
    const LevelResult& failed = level(ladder, "full, mesh x2");
    EXPECT_EQ(failed.status.code, StatusCode::energy_grew);
    EXPECT_TRUE(failed.metrics.empty());
    EXPECT_FALSE(failed.error);
    EXPECT_EQ(exit_code(ladder), ExitCode::done);
    EXPECT_EQ(level(ladder, "full, mesh x1").is_reference, true);  // the finest that is left
    for (const std::string& text : {ladder_csv(ladder), ladder_json(ladder), ladder_markdown(ladder)})
        EXPECT_NE(text.find("energy"), std::string::npos);
    EXPECT_NE(ladder_svg(ladder).find(">- full, mesh x2</text>"), std::string::npos);
}

TEST(CompareLadder, TheSceneAsItIsMustNotFail) {
    const auto broken = [](const Fidelity& fidelity, const Scene& scene) {
        RunRecord record = synthetic(fidelity, scene);
        if (fidelity.name == "full") record.status = {StatusCode::not_finite, "node 3"};
        return record;
    };
    EXPECT_EQ(exit_code(synthetic_ladder({}, test::c9_scene(), broken)), ExitCode::numerical);
}

TEST(CompareLadder, AnInterruptedLevelIsTheLastThatIsRun) {
    int runs_after = -1;
    const auto interrupted = [&](const Fidelity& fidelity, const Scene& scene) {
        RunRecord record = synthetic(fidelity, scene);
        if (runs_after >= 0) ++runs_after;
        if (fidelity.name == "full" && scene.full.mesh.gore_rows == 17 && runs_after < 0) {
            record.status = {StatusCode::interrupted, ""};
            runs_after = 0;
        }
        return record;
    };
    const Ladder ladder = synthetic_ladder({}, test::c9_scene(), interrupted);
    EXPECT_EQ(exit_code(ladder), ExitCode::interrupted);
    EXPECT_EQ(runs_after, 0);
    EXPECT_FALSE(level(ladder, "full, mesh x2").was_run);
    EXPECT_TRUE(level(ladder, "rom, rtol 1e-8").error);  // what was computed is there
}

/// Every element closes, in the right order. Attributes are quoted and hold no '>', which xml_text escapes.
void expect_well_formed(const std::string& xml) {
    std::vector<std::string> open;
    for (std::size_t at = 0; (at = xml.find('<', at)) != std::string::npos;) {
        const std::size_t end = xml.find('>', at);
        ASSERT_NE(end, std::string::npos);
        const std::string tag = xml.substr(at + 1, end - at - 1);
        EXPECT_EQ(test::count_of(tag, "\"") % 2, 0u) << tag;
        EXPECT_EQ(test::count_of(tag, "<"), 0u) << tag;
        const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
        if (tag.starts_with("/")) {
            ASSERT_FALSE(open.empty());
            EXPECT_EQ(open.back(), tag.substr(1));
            open.pop_back();
        } else if (!tag.ends_with("/")) {
            open.push_back(name);
        }
        at = end;
    }
    EXPECT_TRUE(open.empty());
}

TEST(CompareLadderFiles, ThePlotIsWellFormedAndHasEveryLevel) {
    Scene scene = test::c9_scene();
    scene.name = "<C-9> & \"friends\"";
    const Ladder ladder = synthetic_ladder({}, scene);
    const std::string svg = ladder_svg(ladder);
    expect_well_formed(svg);
    EXPECT_EQ(svg.find("<C-9>"), std::string::npos);
    for (const LevelResult& r : ladder.levels) {
        const bool drawn = svg.find("<title>" + r.level.name + ":") != std::string::npos;
        const bool excused = svg.find(">- " + r.level.name + "</text>") != std::string::npos;
        EXPECT_TRUE(drawn != excused) << r.level.name;
        EXPECT_TRUE(drawn || !r.error) << r.level.name;
    }
    EXPECT_NE(svg.find("run time [s]"), std::string::npos);
    EXPECT_NE(svg.find("gap between rom and full: 25 % (peak_force)"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("script"), std::string::npos);
}

TEST(CompareLadderFiles, TheCsvHasEveryLevelAndAsManyFieldsInEveryLine) {
    const Ladder ladder = synthetic_ladder({}, test::c9_scene(), fragile);
    std::istringstream lines(ladder_csv(ladder));
    std::string line;
    std::size_t fields = 0;
    std::set<std::string> levels;
    while (std::getline(lines, line)) {
        std::size_t commas = 0;
        bool quoted = false;
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            commas += c == ',' && !quoted;
        }
        if (fields == 0) fields = commas;
        EXPECT_EQ(commas, fields) << line;
        levels.insert(line.substr(0, line.starts_with('"') ? line.find('"', 1) + 1 : line.find(',')));
    }
    EXPECT_GE(fields, 20u);
    for (const LevelResult& r : ladder.levels) {
        const bool quoted = r.level.name.find(',') != std::string::npos;
        EXPECT_TRUE(levels.contains(quoted ? '"' + r.level.name + '"' : r.level.name)) << r.level.name;
    }
}

TEST(CompareLadderFiles, TheLastLineForTheTerminalIsTheAdvice) {
    const Ladder ladder = synthetic_ladder();
    const std::string text = ladder_text(ladder, {});
    EXPECT_TRUE(text.ends_with("\n" + advice(ladder) + "\n"));
    EXPECT_TRUE(advice(ladder).starts_with("to use: for 1 % rom, rtol 1e-3 ("));
}

}  // namespace
}  // namespace twinchute::compare
