// Verdicts of the stability matrix: what is wrong must not pass for stable, whoever gives the answer.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/stability/base_scenes.hpp"
#include "compare/stability_report.hpp"

namespace twinchute::compare {
namespace {

/// A fidelity that says what it is told to.
StatusCode ending = StatusCode::completed;
std::vector<bool> asked;  // whether each run was to be laid out as any mesh
RunRecord say(const Scene& scene, Run& run) {
    asked.push_back(run.force_unstructured);
    RunRecord record = begin_record(scene, "fake");
    record.status = {ending, "because it was told to"};
    record.cost.steps = 7;
    record.add_metric("peak_force_N", 100.0);
    return record;
}
std::vector<std::string> lacks_wind(const Scene& scene) {
    return scene.environment.wind ? std::vector<std::string>{"environment.wind"} : std::vector<std::string>{};
}
const Fidelity fake{"fake", "fake model", &say, &lacks_wind};

class CompareStability : public testing::Test {
protected:
    CompareStability() {
        ending = StatusCode::completed;
        row_.name = "a case";
        row_.why = "nothing";
        row_.fidelity = "fake";
        row_.base = c9_at_line_stretch;
        row_.check = peak_of(100.0);
    }
    static Check peak_of(double expected) {
        return [expected](const Trial& trial) -> std::vector<Finding> {
            const double found = *trial.record.metric("peak_force_N");
            return {{"peak", std::abs(found - expected) / expected, 1e-3}, {"nothing", 0.0, 1e-3}};
        };
    }
    StabilityCell cell() const {
        return judge(row_, {"as it is", [](Scene&) {}}, fake).value();
    }
    CellVerdict verdict() const { return cell().verdict; }

    StabilityCase row_;
};

TEST_F(CompareStability, ARightAnswerIsStableWithTheMarginOfItsWorstCheck) {
    row_.check = peak_of(100.05);
    const StabilityCell stable = cell();
    EXPECT_EQ(stable.verdict, CellVerdict::stable);
    EXPECT_NEAR(*stable.margin, 1e-3 * 100.05 / 0.05, 1e-6);
    EXPECT_EQ(stable.reason, "peak");
    EXPECT_EQ(stable.steps, 7);
    EXPECT_FALSE(is_failure(stable.verdict));
}

TEST_F(CompareStability, AWrongAnswerIsSilentlyWrong) {
    row_.check = peak_of(100.2);
    EXPECT_EQ(verdict(), CellVerdict::silently_wrong);
    EXPECT_TRUE(is_failure(verdict()));
    EXPECT_LT(*cell().margin, 1.0);
}

TEST_F(CompareStability, NotANumberIsWrongWhateverStandsBesideIt) {
    for (const bool first : {true, false}) {
        row_.check = [first](const Trial&) -> std::vector<Finding> {
            const Finding nan{"nan", std::nan(""), 1.0}, right{"right", 0.0, 1.0};
            return first ? std::vector{nan, right} : std::vector{right, nan};
        };
        EXPECT_EQ(verdict(), CellVerdict::silently_wrong) << first;
        EXPECT_EQ(cell().reason, "nan") << first;
    }
}

TEST_F(CompareStability, AnAnswerThatNothingWasHeldAgainstIsNotStable) {
    row_.check = {};
    EXPECT_EQ(verdict(), CellVerdict::silently_wrong);
    row_.check = [](const Trial&) { return std::vector<Finding>{}; };
    EXPECT_EQ(verdict(), CellVerdict::silently_wrong);
}

TEST_F(CompareStability, AStopIsTrueOnlyOfTheCasesThatNameIt) {
    ending = StatusCode::energy_grew;
    EXPECT_EQ(verdict(), CellVerdict::misnamed);
    row_.causes = {StatusCode::strain_limit};
    EXPECT_EQ(verdict(), CellVerdict::misnamed);
    row_.causes = {StatusCode::strain_limit, StatusCode::energy_grew};
    EXPECT_EQ(verdict(), CellVerdict::stopped);
    EXPECT_EQ(cell().status, "energy_grew");
    EXPECT_EQ(cell().reason, "because it was told to");
    // A guard that would have caught it does not excuse a wrong answer.
    ending = StatusCode::completed;
    row_.check = peak_of(90.0);
    EXPECT_EQ(verdict(), CellVerdict::silently_wrong);
}

TEST_F(CompareStability, RefusalsAreThoseOfTheReaderAndOfTheFidelity) {
    row_.causes = {StatusCode::refused};
    row_.check = {};
    row_.change = [](Scene& scene) { scene.release.speed = 0.0; };
    EXPECT_EQ(verdict(), CellVerdict::refused);
    EXPECT_TRUE(cell().reason.starts_with("release.airspeed: ")) << cell().reason;

    row_.change = [](Scene& scene) { scene.environment.wind = uniform_wind({1.0, 0.0, 0.0}); };
    EXPECT_EQ(verdict(), CellVerdict::refused);
    EXPECT_NE(cell().reason.find("environment.wind"), std::string::npos) << cell().reason;

    row_.change = {};
    row_.asked = "payload.mass=-1";
    EXPECT_EQ(verdict(), CellVerdict::refused);
    EXPECT_TRUE(cell().reason.starts_with("payload.mass: ")) << cell().reason;
    row_.causes = {};
    EXPECT_EQ(verdict(), CellVerdict::misnamed);  // what ought to be answered was refused
    row_.asked = "payload.mass=1";
    EXPECT_EQ(verdict(), CellVerdict::silently_wrong);  // it was not refused after all
}

TEST_F(CompareStability, AMethodsOwnCheckCountsBesideThatOfItsCase) {
    const StabilityMethod held{"held", [](Scene&) {}, false, peak_of(90.0)};
    EXPECT_EQ(judge(row_, held, fake)->verdict, CellVerdict::silently_wrong);
    EXPECT_EQ(judge(row_, held, fake)->findings.size(), 4u);
    // It is no check of the case: what ought to be refused is not saved by it.
    row_.check = {};
    const StabilityMethod right{"right", [](Scene&) {}, false, peak_of(100.0)};
    EXPECT_EQ(judge(row_, right, fake)->verdict, CellVerdict::silently_wrong);
}

TEST_F(CompareStability, AMethodsLayoutIsThatOfItsRunAndOfTheRunsItIsHeldAgainst) {
    for (const bool any : {false, true}) {
        asked.clear();
        row_.check = [](const Trial& trial) {
            trial.run(trial.scene);
            return std::vector<Finding>{{"nothing", 0.0, 1.0}};
        };
        EXPECT_TRUE(judge(row_, {"as it is", [](Scene&) {}, any}, fake));
        EXPECT_EQ(asked, (std::vector{any, any}));
    }
}

TEST_F(CompareStability, AStopRequestIsNoVerdict) {
    ending = StatusCode::interrupted;
    EXPECT_FALSE(judge(row_, {"as it is", [](Scene&) {}}, fake));
}

TEST_F(CompareStability, EveryReportHasEveryCell) {
    StabilityMatrix matrix{{cell()}};
    row_.name = "a | b, \"c\"";
    row_.check = peak_of(90.0);
    matrix.cells.push_back(cell());
    const Provenance provenance = current_provenance();

    const std::string csv = stability_csv(matrix);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
    EXPECT_NE(csv.find("\"a | b, \"\"c\"\"\""), std::string::npos) << csv;
    const std::string markdown = stability_markdown(matrix, provenance, "twinchute stability");
    EXPECT_NE(markdown.find(provenance.commit), std::string::npos);
    const std::string text = stability_terminal(matrix, {});
    EXPECT_NE(text.find("silently wrong"), std::string::npos);
    EXPECT_NE(text.find("1 stable, 1 silently wrong; 2 cells"), std::string::npos) << text;
    const auto json = nlohmann::json::parse(stability_json(matrix, provenance));
    EXPECT_EQ(json["generator"], "twinchute");
    ASSERT_EQ(json["cells"].size(), 2u);
    EXPECT_EQ(json["cells"][1]["verdict"], "silently wrong");
    EXPECT_NEAR(json["cells"][1]["error"], 1.0 / 9.0, 1e-12);
    matrix.interrupted = true;
    EXPECT_TRUE(stability_summary(matrix).ends_with("2 cells, interrupted"));
}

}  // namespace
}  // namespace twinchute::compare
