// The program as a script sees it. Expected values are the tables of commands, files and exit codes
// that the program promises (`twinchute --help`, docs).
#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

/// A full run of a moment: few elements, short flight.
const Words a_moment{"--set", "stop.time=0.25",        "--set", "full.mesh.gore_columns=1",
                     "--set", "full.mesh.gore_rows=4", "--set", "full.mesh.line_elements=4"};

class SystemCli : public ProgramTest {
protected:
    Ended run_quick(const Words& words) const { return run(words + a_moment); }
};

TEST_F(SystemCli, HelpAndVersionSucceedForEveryCommand) {
    EXPECT_EQ(run({"--help"}).code, 0);
    const Ended version = run({"--version"});
    EXPECT_EQ(version.code, 0);
    for (const char* word : {"twinchute ", "commit ", "compiler "}) {
        EXPECT_NE(version.out.find(word), std::string::npos) << word;
    }
    for (const std::string command : {"compare", "rom", "full", "report", "ladder", "stability", "import",
                                      "export", "mesh", "plan", "list"}) {
        const Ended help = run({command, "-h"});
        EXPECT_EQ(help.code, 0);
        EXPECT_NE(help.out.find("example: twinchute " + command), std::string::npos) << help.out;
    }
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemCli, RomPrintsAndWritesNothing) {
    const Ended ended = run({"rom", c9_inflation});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.out.find("peak force"), std::string::npos);
    EXPECT_EQ(ended.out.find('\x1b'), std::string::npos);  // no colour into a file
    EXPECT_EQ(ended.err, "");                              // no progress line into a file
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemCli, RomWritesWhereItIsTold) {
    EXPECT_EQ(run({"rom", c9_inflation, "--out", "there", "--quiet"}).out, "");
    EXPECT_EQ(tree_of(here_.path()),
              (std::set<std::string>{"there", "there/summary.json", "there/history.csv", "there/events.csv",
                                     "there/run.html"}));
    EXPECT_EQ(read("there/summary.json")["fidelity"], "rom");
}

/// The tables are what they are with units, less the second line; whoever reads the record back gets its
/// units.
TEST_F(SystemCli, PlainCsvLeavesOutTheLineOfUnitsAndIsReadBack) {
    const auto lines = [&](const std::string& file) {
        const std::string all = text(file);
        const std::size_t first = all.find('\n') + 1, second = all.find('\n', first) + 1;
        return std::pair(all, all.substr(0, first) + all.substr(second));
    };
    EXPECT_EQ(run({"rom", c9_inflation, "--quiet", "--out", "units"}).code, 0);
    EXPECT_EQ(run({"rom", c9_inflation, "--quiet", "--out", "plain", "--plain-csv"}).code, 0);
    for (const std::string file : {"history.csv", "events.csv"})
        EXPECT_EQ(text("plain/" + file), lines("units/" + file).second) << file;
    EXPECT_EQ(read("plain/summary.json")["history_units"]["force"], "N");
    EXPECT_FALSE(read("units/summary.json").contains("history_units"));

    EXPECT_EQ(run_quick({"compare", c9_inflation, "--quiet", "--out", "both", "--plain-csv"}).err, "");
    EXPECT_NE(text("both/full/history.csv").find("\n0,"), std::string::npos);
    const std::string gap = text("both/gap.json"), page = text("both/report.html");
    const Ended again = run({"report", "both", "--quiet"});
    EXPECT_EQ(again.err, "");
    EXPECT_EQ(text("both/gap.json"), gap);
    EXPECT_EQ(text("both/report.html"), page);
    // A table that lost its units by other hands is refused.
    here_.write("units/history.csv", lines("units/history.csv").second);
    const Ended broken = run({"report", "units"});
    EXPECT_EQ(broken.code, 2);
    EXPECT_NE(broken.err.find("history.csv"), std::string::npos) << broken.err;
    EXPECT_EQ(run({"rom", c9_inflation, "--plain-csv"}).code, 2);  // no record, no table
    EXPECT_EQ(run({"rom", c9_inflation, "--plain-csv", "--sensitivity"}).code, 2);
}

TEST_F(SystemCli, ARecordNamesTheSceneFileWithoutItsDirectories) {
    const std::string directory = here_.path().string();
    here_.write("deep/scene.toml", content_of(c9_inflation));
    const std::string scene = directory + "/deep/scene.toml";
    EXPECT_EQ(run_quick({"compare", scene, "--quiet", "--out", "out"}).err, "");
    for (const std::string file : {"out/rom/summary.json", "out/full/summary.json", "out/gap.json",
                                   "out/report.html", "out/report.md"}) {
        EXPECT_EQ(text(file).find(directory), std::string::npos) << file;
        EXPECT_NE(text(file).find("scene.toml"), std::string::npos) << file;
    }
    for (const std::string command : {"plan", "mesh"})
        EXPECT_EQ(json::parse(run({command, scene, "--json"}).out)["scene"]["file"], "scene.toml");
}

TEST_F(SystemCli, JsonIsAllThatStandsOnStandardOutput) {
    const json summary = json::parse(run({"rom", c9_inflation, "--json"}).out);
    EXPECT_EQ(summary["status"]["code"], "completed");
    EXPECT_EQ(summary["inputs"]["payload.mass"]["value"], 152.4);
    const json gap = json::parse(run_quick({"compare", c9_inflation, "--json"}).out);
    EXPECT_TRUE(gap.contains("metrics"));
}

TEST_F(SystemCli, OverridesReachTheModel) {
    const json summary =
        json::parse(run({"rom", c9_inflation, "--json", "--set", "payload.mass='100 kg'"}).out);
    EXPECT_EQ(summary["inputs"]["payload.mass"]["value"], 100);
}

TEST_F(SystemCli, FullWritesItsRecordBesideTheSceneName) {
    const Ended ended = run_quick({"full", c9_inflation});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    EXPECT_EQ(read("c9-inflation.out/summary.json")["fidelity"], "full");
    EXPECT_EQ(run_quick({"full", c9_inflation}).code, 0);  // our own results may be written again
}

TEST_F(SystemCli, CompareWritesTheWholeReport) {
    const Ended ended = run_quick({"compare", c9_inflation, "--out", "out"});
    for (const char* file : {"gap.json", "report.html", "report.md", "junit.xml", "force.svg", "speed.svg",
                             "rom/summary.json", "rom/history.csv", "rom/events.csv", "full/summary.json",
                             "full/history.csv", "full/events.csv", "full/frames.bin"}) {
        EXPECT_TRUE(std::filesystem::is_regular_file(here_ / ("out/" + std::string(file))))
            << file << ended.err;
    }
}

TEST_F(SystemCli, ToleranceDecidesBetweenZeroAndOne) {
    // The whole opening on a coarse mesh: within a factor of two of the reduced-order model in what
    // both compute, and not equal to it.
    Words words{"compare", c9_inflation,           "--set", "full.mesh.gore_columns=1",
                "--set",   "full.mesh.gore_rows=4"};
    for (const char* metric : {"filling_time", "peak_force", "descent_rate"}) {
        words.insert(words.end(), {"--tolerance", std::string(metric) + "=50%"});
    }
    words.insert(words.end(), {"--out", "wide"});
    const Ended wide = run(words);
    EXPECT_EQ(wide.code, 0) << wide.out << wide.err;
    EXPECT_EQ(read("wide/gap.json")["verdict"], "within");

    const Ended none = run_quick({"compare", c9_inflation, "--out", "none", "--tolerance", "max_force=0%"});
    EXPECT_EQ(none.code, 1) << none.err;
    EXPECT_NE(none.out.find("exceeded"), std::string::npos);
    EXPECT_EQ(read("none/gap.json")["metrics"]["max_force_N"]["verdict"], "exceeded");
}

const std::string rocket_scene = shipped_scene("rocket-dual-deploy");

TEST_F(SystemCli, AParachuteThatNeverOpensEndsWithOne) {
    const Words never{rocket_scene, "--set", "parachute.main.deploy.when.height=0 ft"};
    const auto with = [&](Words words) {
        words.insert(words.begin() + 1, never.begin(), never.end());
        return run(words);
    };
    const Ended rom = with({"rom", "--out", "never"});
    EXPECT_EQ(rom.code, 1) << rom.out;
    EXPECT_NE(rom.out.find("not_opened: ground reached; main never opened (deploy.when, altitude "),
              std::string::npos)
        << rom.out;
    EXPECT_EQ(read("never/summary.json")["status"]["code"], "not_opened");
    EXPECT_EQ(read("never/summary.json")["metrics"]["unopened_parachutes"], 1.0);
    EXPECT_EQ(with({"rom", "--json"}).code, 1);
    EXPECT_EQ(with({"rom", "--set", "stop.time=20 s"}).code, 0);  // stopped before
}

TEST_F(SystemCli, ParachutesThatWaitForEachOtherAreRefusedByEveryCommand) {
    for (const std::string command : {"rom", "full", "compare", "plan", "size", "ladder"}) {
        const Ended ended =
            run({command, rocket_scene, "--set", "parachute.main.deploy.when={after=\"drogue.cut\"}", "--set",
                 "parachute.drogue.cut={after=\"main.full-open\"}"});
        EXPECT_EQ(ended.code, 2) << command;
        EXPECT_NE(ended.err.find("parachutes wait for each other (drogue.cut waits for main.full-open"),
                  std::string::npos)
            << command << ended.err;
    }
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemCli, CheckRunsNothing) {
    for (const std::string command : {"compare", "rom", "full", "mesh"}) {
        const Ended ended = run({command, c9_inflation, "--check"});
        EXPECT_EQ(ended.code, 0) << ended.err;
        EXPECT_NE(ended.out.find("valid"), std::string::npos);
        EXPECT_EQ(run({command, c9_inflation, "--check", "--set", "payload.mass=-1"}).code, 2);
    }
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemCli, BadUsageAndBadScenesAreExitTwoAndWriteNothing) {
    const std::vector<Words> wrong{
        {},
        {"simulate", c9_inflation},
        {"--frobnicate"},
        {"compare"},
        {"rom", c9_inflation, "--treads", "2"},
        {"rom", "no-such-file.toml"},
        {"rom", c9_inflation, "--set", "payload.mas=1"},
        {"full", c9_inflation, "--set", "full.symmetry=sector", "--set", "release.path_angle=1"},
        {"compare", c9_inflation, "--tolerance", "peak_force"},
        {"compare", c9_inflation, "--tolerance", "peak_force=5s"},
        {"compare", c9_inflation, "--tolerance", "no_such_metric=5%"},
        {"list", "no-such-topic"}};
    for (const Words& words : wrong) {
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << testing::PrintToString(words);
        EXPECT_EQ(ended.out, "") << testing::PrintToString(words);
        EXPECT_NE(ended.err, "") << testing::PrintToString(words);
    }
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemCli, ASceneErrorNamesFileLineAndColumn) {
    here_.write("broken.toml", "schema = 1\nname = \"x\"\n[payload]\nmasss = \"1 kg\"\n");
    const Ended ended = run({"rom", "broken.toml"});
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(ended.err.starts_with("broken.toml:4:1: ")) << ended.err;
    EXPECT_NE(ended.err.find("mass"), std::string::npos);
}

TEST_F(SystemCli, SomebodyElsesDirectoryIsRefusedBeforeAnythingRuns) {
    here_.write("thesis/chapter.tex", "years of work");
    EXPECT_EQ(run({"rom", c9_inflation, "--out", "thesis"}).code, 2);
    EXPECT_EQ(tree_of(here_ / "thesis"), (std::set<std::string>{"chapter.tex"}));
}

TEST_F(SystemCli, ResultsThatCannotBeWrittenAreExitFour) {
    here_.write("file", "not a directory");
    EXPECT_EQ(run({"rom", c9_inflation, "--out", "file/out"}).code, 4);
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"file"}));
    EXPECT_EQ(Process(program({"rom", c9_inflation, "--json"}), here_.path(), "/dev/full").wait().code, 4);
}

TEST_F(SystemCli, ANumericalFailureIsExitThreeWithARecord) {
    // No fabric stays below a strain of 1e-6 while it opens.
    const Ended ended = run_quick({"full", c9_inflation, "--out", "out", "--set", "full.strain_limit=1e-6"});
    EXPECT_EQ(ended.code, 3) << ended.err;
    EXPECT_EQ(read("out/summary.json")["status"]["code"], "strain_limit");
    const Ended both =
        run_quick({"compare", c9_inflation, "--out", "both", "--set", "full.strain_limit=1e-6"});
    EXPECT_EQ(both.code, 3) << both.err;
    EXPECT_NE(content_of(here_ / "both/junit.xml").find("<error type=\"strain_limit\""), std::string::npos);
    EXPECT_EQ(read("both/rom/summary.json")["status"]["code"], "completed");
}

TEST_F(SystemCli, AWarningOfFoldedGoresKnowsWhetherThereIsContact) {
    // Thrown upward an open canopy meets the air from above as it falls back, and folds: half of its area
    // is inside out. The payload falls into it, which contact between gores does not survive.
    for (const std::string contact : {"none", "gores"}) {
        Words words{"full", c9_inflation, "--out", contact};
        for (const char* key :
             {"parachute.deploy.by=inflated", "release.speed=30", "release.path_angle='-85 deg'"})
            words.insert(words.end(), {"--set", key});
        words.insert(words.end(), a_moment.begin(), a_moment.end());
        words.insert(words.end(), {"--set", "stop.time=3.2", "--set", "full.contact='" + contact + "'"});
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, contact == "gores" ? 1 : 0) << ended.err;
        EXPECT_NE(ended.out.find("gores are folded inside out"), std::string::npos) << ended.out;
        EXPECT_EQ(ended.out.find("fabric passes through fabric here") != std::string::npos,
                  contact == "none");
        EXPECT_EQ(ended.out.find("contact keeps neighbours in order") != std::string::npos,
                  contact == "gores");
    }
}

class SystemCliSignal : public SystemCli, public testing::WithParamInterface<int> {};

TEST_P(SystemCliSignal, EndsCleanlyWithTheRecordSoFar) {
    // Long enough to be running when the signal comes, whatever the machine.
    Process process(program({"full", c9_inflation, "--out", "out", "--set", "stop.time=10"}), here_.path());
    ASSERT_TRUE(process.send_when_handled(GetParam()));
    const Ended ended = process.wait();
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_EQ(read("out/summary.json")["status"]["code"], "interrupted");
}

INSTANTIATE_TEST_SUITE_P(Signals, SystemCliSignal, testing::Values(SIGINT, SIGTERM));

TEST_F(SystemCli, ListsComeFromTheTablesThatRun) {
    const Ended topics = run({"list"});
    EXPECT_EQ(topics.code, 0);
    for (const std::string topic : {"keys", "laws", "materials", "scenes", "metrics"}) {
        EXPECT_NE(topics.out.find(topic), std::string::npos);
        EXPECT_EQ(run({"list", topic}).code, 0) << topic;
        EXPECT_FALSE(json::parse(run({"list", topic, "--json"}).out).empty()) << topic;
    }
    EXPECT_NE(run({"list", "laws"}).out.find("ludtke"), std::string::npos);
    EXPECT_NE(run({"list", "keys"}).out.find("payload.mass"), std::string::npos);
    EXPECT_NE(run({"list", "metrics"}).out.find("peak_force_N"), std::string::npos);
}

TEST_F(SystemCli, TheSameInputGivesTheSameNumbers) {
    const Words words{"compare", c9_inflation, "--json", "--out"};
    auto metrics = [&](const std::string& directory) {
        Words all = words;
        all.push_back(directory);
        json gap = json::parse(run_quick(all).out);
        return std::pair{gap["metrics"].dump(), content_of(here_ / (directory + "/full/history.csv"))};
    };
    EXPECT_EQ(metrics("a"), metrics("b"));
}

}  // namespace
}  // namespace twinchute::test
