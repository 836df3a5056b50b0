// `twinchute ladder` as a script sees it. Exit codes and files are what the program promises; that errors
// fall with the tolerance is what a tolerance means.
#include <cmath>
#include <fstream>
#include <thread>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

const std::set<std::string> ladder_files{"ladder.csv", "ladder.json", "ladder.md", "ladder.svg"};

/// Few elements, and a short flight beyond the peak.
const Words coarse_ladder{"--quick",
                          "--set",
                          "full.mesh.gore_columns=1",
                          "--set",
                          "full.mesh.gore_rows=4",
                          "--set",
                          "full.mesh.line_elements=4",
                          "--set",
                          "stop.time=2"};

class SystemLadder : public ProgramTest {
protected:
    Ended run(const Words& words) const { return ProgramTest::run(Words{"ladder"} + words + coarse_ladder); }
    static json level(const json& ladder, const std::string& name) {
        for (const json& row : ladder["rungs"])
            if (row["name"] == name) return row;
        return {};
    }
};

TEST_F(SystemLadder, LeavesTableAndPlot) {
    const Ended ended = run({c9_inflation, "--out", "out"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    EXPECT_EQ(tree_of(here_ / "out"), ladder_files);
    const json ladder = read("out/ladder.json");
    EXPECT_EQ(ladder["generator"], "twinchute");
    EXPECT_TRUE(ended.out.ends_with(ladder["advice"].get<std::string>() + "\n"));
    const std::string csv = content_of(here_ / "out/ladder.csv"),
                      markdown = content_of(here_ / "out/ladder.md");
    for (const json& row : ladder["rungs"]) {
        const std::string name = row["name"];
        EXPECT_NE(csv.find(name), std::string::npos) << name;
        EXPECT_NE(markdown.find(name), std::string::npos) << name;
        EXPECT_EQ(row["status"]["code"], "completed") << name;
        EXPECT_GT(row["wall_s"], 0.0) << name;
    }
    // Dearer than four runs of the scene as it is.
    EXPECT_TRUE(level(ladder, "full, mesh x2").is_null());
    EXPECT_EQ(level(ladder, "full, mesh x1.5")["setting"],
              "full.mesh.gore_columns=2 full.mesh.gore_rows=6 full.mesh.line_elements=6 "
              "full.mesh.riser_elements=8");
}

TEST_F(SystemLadder, AWrongTestTableIsRefusedBeforeAnythingRuns) {
    for (const char* file : {"absent.csv", "wrong.csv"}) {
        std::ofstream(here_ / "wrong.csv") << "peak_force\nm\n5000\n";
        const Ended ended = run({c9_inflation, "--out", "out", "--reference", file});
        EXPECT_EQ(ended.code, 2) << ended.err;
        EXPECT_NE(ended.err.find(file), std::string::npos) << ended.err;
        EXPECT_FALSE(std::filesystem::exists(here_ / "out"));
    }
}

TEST_F(SystemLadder, ErrorsOfTheReducedOrderModelFallWithTheTolerance) {
    const Ended ended = run({c9_inflation, "--out", "out", "--json"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json ladder = json::parse(ended.out);
    const auto error_at = [&](int power) {
        return level(ladder, "rom, rtol 1e-" + std::to_string(power))["error"]["value"].get<double>();
    };
    // One error may be small by accident: two decades of tolerance are more than that. What a step commits
    // adds up over some tens of steps.
    for (int power = 5; power <= 11; power += 2)
        EXPECT_LT(error_at(power), error_at(power - 2)) << power;
    for (int power = 3; power <= 12; ++power)
        EXPECT_LT(error_at(power), 30 * std::pow(10.0, -power)) << power;
    // As the scene is: the numerical error that the model promises.
    const json given = level(ladder, "rom, rtol 1e-6");
    EXPECT_TRUE(given["as_given"]);
    EXPECT_LT(given["error"]["value"], 1e-5);
    EXPECT_FALSE(given["gap"].contains("rom"));
    EXPECT_TRUE(given["gap"].contains("full"));
}

TEST_F(SystemLadder, SameInputSameNumbers) {
    const auto numbers = [&] {
        const Ended ended = run({c9_inflation, "--json"});
        EXPECT_EQ(ended.code, 0) << ended.err;  // our own results may be written again
        json ladder = json::parse(ended.out);
        for (json& row : ladder["rungs"])
            for (const char* timing : {"wall_s", "runs", "on_pareto_front"})
                row.erase(timing);
        return ladder["rungs"];
    };
    EXPECT_EQ(numbers(), numbers());
}

TEST_F(SystemLadder, BadScenesAndUsageAreExitTwoAndWriteNothing) {
    for (const Words& words : {Words{c9_inflation, "--set", "payload.mass=-1"}, Words{"no-such-file.toml"},
                               Words{c9_inflation, "--seeds", "0"}, Words{c9_inflation, "--seeds", "three"},
                               Words{c9_inflation, "--rungs", "2"}, Words{}}) {
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << testing::PrintToString(words);
        EXPECT_EQ(ended.out, "");
        EXPECT_NE(ended.err, "");
    }
    EXPECT_EQ(run({c9_inflation, "--check"}).code, 0);
    EXPECT_TRUE(tree_of(here_.path()).empty());
}

TEST_F(SystemLadder, LevelsThatFailAreRows) {
    // No fabric stays below a strain of 1e-6 while it opens: every full run ends, as the scene itself does.
    const Ended ended = run({c9_inflation, "--out", "out", "--set", "full.strain_limit=1e-6"});
    EXPECT_EQ(ended.code, 3) << ended.err;
    const json ladder = read("out/ladder.json");
    EXPECT_EQ(level(ladder, "full, mesh x1")["status"]["code"], "strain_limit");
    EXPECT_EQ(level(ladder, "rom, rtol 1e-8")["status"]["code"], "completed");
    EXPECT_NE(ended.out.find("failed    full, mesh x1: strain_limit"), std::string::npos) << ended.out;
}

class SystemLadderSignal : public SystemLadder, public testing::WithParamInterface<int> {};

TEST_P(SystemLadderSignal, KeepsTheLevelsThatWereDone) {
    // Default mesh and an endless flight: the first full level is long enough, whatever the machine. The
    // ground ends the flights of the other model.
    Process process(program({"ladder", c9_inflation, "--out", "out", "--set", "stop.time=1000", "--set",
                             "release.height=5000"}),
                    here_.path());
    ASSERT_TRUE(process.wait_until_handled(GetParam()));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    ::kill(process.id(), GetParam());
    const Ended ended = process.wait();
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_EQ(tree_of(here_ / "out"), ladder_files);
    const json ladder = read("out/ladder.json");
    EXPECT_EQ(ladder["exit_code"], 130);
    EXPECT_EQ(ladder["rungs"].front()["status"]["code"], "completed");
    EXPECT_EQ(ladder["rungs"].back()["status"]["code"], "not_run");
}

INSTANTIATE_TEST_SUITE_P(Signals, SystemLadderSignal, testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace twinchute::test
