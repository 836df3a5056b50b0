// Paths that name nothing, or what cannot be read, on the command line: refused, with exit code 2, at once.
#include <sys/stat.h>

#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemPaths : public ShortScene {
protected:
    /// Runs a line in a shell, with the program as $T.
    Ended shell(const std::string& line) {
        return Process({"/usr/bin/env", std::string("T=") + TWINCHUTE_PROGRAM, "/bin/bash", "-c", line},
                       here_.path())
            .wait();
    }
    /// Refused in usage, naming `what`.
    void expect_refused(const Ended& ended, const std::string& what) {
        EXPECT_EQ(ended.code, 2) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_NE(ended.err.find(what), std::string::npos) << ended.err;
    }
};

TEST_F(SystemPaths, EveryOptionThatTakesAValueRefusesAnEmptyOne) {
    here_.write("rom/history.csv", "years of work");
    for (const std::string command : {"rom", "full", "compare", "size", "ladder", "mesh"})
        expect_refused(run({command, "scene.toml", "--out", ""}), "--out is given nothing");
    for (const std::string command : {"stability", "validate"})
        expect_refused(run({command, "--out", ""}), "--out is given nothing");
    for (const std::string option : {"--baseline", "--test", "--set", "--tolerance", "--fields"})
        expect_refused(run({"compare", "scene.toml", option, ""}), option + " is given nothing");
    expect_refused(run({"ladder", "scene.toml", "--reference", ""}), "--reference is given nothing");
    expect_refused(run({"report", ""}), "is empty");
    expect_refused(run({"rom", ""}), "is empty");
    EXPECT_EQ(text("rom/history.csv"), "years of work");
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"rom", "rom/history.csv", "scene.toml"}));
}

TEST_F(SystemPaths, TheCurrentFolderIsGuardedHoweverItIsCalled) {
    here_.write("rom/history.csv", "years of work");
    for (const std::string& out :
         Words{".", "./", "new/..", "rom/..", "../" + here_.path().filename().string()})
        expect_refused(run({"compare", "scene.toml", "--out", out}), "--out");
    // Results that lie in a folder among other things do not make it a folder of results.
    EXPECT_EQ(run({"rom", "scene.toml", "--quiet", "--out", "scene.out"}).code, 0);
    expect_refused(run({"compare", "scene.toml", "--out", "."}), "--out");
    EXPECT_EQ(text("rom/history.csv"), "years of work");
}

TEST_F(SystemPaths, ANamedPipeIsRefusedAndNotWaitedFor) {
    ASSERT_EQ(::mkfifo((here_ / "pipe.toml").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((here_ / "pipe.csv").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((here_ / "pipe.vtu").c_str(), 0600), 0);
    expect_refused(run({"rom", "pipe.toml"}), "pipe.toml: is a named pipe");
    expect_refused(run({"compare", "scene.toml", "--test", "pipe.csv"}), "pipe.csv: is a named pipe");
    expect_refused(run({"mesh", "scene.toml", "--out", "pipe.vtu"}), "pipe.vtu");
    here_.write("size.toml", "base = \"sizing/rocket-main.toml\"\n");
    expect_refused(run({"size", "size.toml", "--out", "pipe.toml"}), "pipe.toml");
    for (const std::string name : {"summary.json", "checkpoint.bin"}) {
        here_.write(name + ".out/notes", "work");
        ASSERT_EQ(::mkfifo((here_ / (name + ".out/" + name)).c_str(), 0600), 0);
        expect_refused(run({"rom", "scene.toml", "--out", name + ".out"}), name);
    }
}

TEST_F(SystemPaths, StandardInputAndProcessSubstitutionAreRead) {
    for (const char* line : {"cat scene.toml | $T rom /dev/stdin", "$T rom /dev/stdin < scene.toml",
                             "$T rom <(cat scene.toml)", "$T rom <(sleep 0.2; cat scene.toml)"}) {
        const Ended ended = shell(line);
        EXPECT_EQ(ended.code, 0) << line << ": " << ended.err;
        EXPECT_NE(ended.out.find("peak force"), std::string::npos) << line;
    }
}

/// A scene gives one record, whichever way it comes: only where it is from differs.
TEST_F(SystemPaths, ADashIsASceneFromStandardInput) {
    here_.write("here/wind.csv", "altitude,speed,from\nm,m/s,deg\n0,5,270\n1000,5,270\n");
    here_.write("here/windy.toml",
                "base = \"../scene.toml\"\nname = \"windy\"\n"
                "environment.wind = { table = \"wind.csv\" }\n");
    const json of_file = json::parse(shell("cd here; $T rom windy.toml --json").out),
               of_pipe = json::parse(shell("cd here; cat windy.toml | $T rom - --json").out);
    EXPECT_EQ(of_pipe["scene"]["file"], "<stdin>");
    EXPECT_EQ(of_pipe["scene"]["sha256"], of_file["scene"]["sha256"]);
    EXPECT_EQ(of_pipe["inputs"], of_file["inputs"]);
    EXPECT_EQ(of_pipe["metrics"], of_file["metrics"]);
    for (const char* line : {"$T rom - --sensitivity --quiet < scene.toml", "$T plan - --quiet < scene.toml",
                             "$T full - --quiet < scene.toml", "$T compare - --quiet --out both < scene.toml",
                             "printf 'base = \"sizing/rocket-main.toml\"' | $T size - --check --quiet",
                             "$T ladder - --check < scene.toml", "$T mesh - --quiet < scene.toml"})
        EXPECT_EQ(shell(line).err, "") << line;
    for (const char* file : {"scene.out/summary.json", "both/gap.json"})
        EXPECT_TRUE(std::filesystem::exists(here_ / file)) << file;
    const Ended wrong = shell("printf 'schema = 1\nmas = 3\n' | $T rom -");
    expect_refused(wrong, "<stdin>:2:1: mas: unknown key");
    expect_refused(shell("$T rom - < /dev/null"), "<stdin>");
    expect_refused(shell("$T rom - <&-"), "<stdin>: cannot be read");
    expect_refused(shell("$T rom - < ."), "<stdin>: cannot be read");
    expect_refused(shell("yes '# no end' | $T rom -"), "<stdin>: is too large");
    expect_refused(shell("$T calibrate - --to x.csv < scene.toml"), "save it as a file");
    expect_refused(shell("$T campaign - < scene.toml"), "here standard input is /dev/stdin");
}

TEST_F(SystemPaths, TheEnvironmentMayAskForAnInstructionSet) {
    const std::string full = " $T full scene.toml --quiet --set stop.time='\"0.02 s\"' --out ";
    ASSERT_EQ(shell("TWINCHUTE_INSTRUCTION_SET=generic" + full + "generic").code, 0);
    EXPECT_EQ(read("generic/summary.json")["provenance"]["instruction_set"], "generic, gore-batched");
    ASSERT_EQ(shell("TWINCHUTE_INSTRUCTION_SET=" + full + "widest").code, 0);
    EXPECT_NE(read("widest/summary.json")["provenance"]["instruction_set"], "generic, gore-batched");
    const std::set<std::string> before = tree_of(here_.path());
    expect_refused(shell("TWINCHUTE_INSTRUCTION_SET=AVX9" + full + "none"),
                   "AVX9: TWINCHUTE_INSTRUCTION_SET names no instruction set of this machine (it has ");
    expect_refused(shell("TWINCHUTE_INSTRUCTION_SET=AVX9 $T compare scene.toml --out none"), "AVX9");
    EXPECT_EQ(tree_of(here_.path()), before);
}

TEST_F(SystemPaths, ADataDirectoryThatIsNotThereIsAnError) {
    expect_refused(shell("TWINCHUTE_DATA=nowhere $T rom scene.toml"),
                   "nowhere: TWINCHUTE_DATA names no directory");
    expect_refused(shell("TWINCHUTE_DATA=scene.toml $T rom scene.toml"), "TWINCHUTE_DATA names no directory");
    expect_refused(shell("TWINCHUTE_DATA=nowhere $T list parachutes"), "TWINCHUTE_DATA names no directory");
    EXPECT_EQ(shell("TWINCHUTE_DATA= $T rom scene.toml").code, 0);
    EXPECT_EQ(shell("TWINCHUTE_DATA=. $T rom scene.toml").code, 0);
}

TEST_F(SystemPaths, MessagesNameTheOptionThatIsWrong) {
    const auto says = [&](Words words, const std::string& what) {
        words.insert(words.begin(), {"compare", "scene.toml", "--check"});
        expect_refused(run(words), what);
    };
    says({"--tolerance", "peak_forc=10%"},
         "twinchute: --tolerance: compare.tolerance.peak_forc: unknown metric");
    says({"--tolerance", "peak_force=10kg"}, "twinchute: --tolerance: compare.tolerance.peak_force: 'kg'");
    says({"--baseline", "b", "--baseline-tolerance", "peak_force=-1%"}, "twinchute: --baseline-tolerance: ");
    says({"--fields", "1e9"}, "twinchute: --fields: full.fields_rate: ");
    says({"--set", "compare.tolerance.peak_forc='1 %'"}, "twinchute: --set: compare.tolerance.peak_forc: ");
    says({"--set", "--fields full.fields_rate=1"},
         "twinchute: --set: '--fields full.fields_rate=1' is not key=value");
    // Their values are the command line's in a record, as those of --set are.
    run({"compare", "scene.toml", "--quiet", "--out", "out", "--tolerance", "max_force=1000%", "--fields",
         "4"});
    EXPECT_EQ(read("out/full/summary.json")["inputs"]["full.fields_rate"]["source"], "command line");
    EXPECT_EQ(read("out/full/summary.json")["inputs"]["compare.tolerance.max_force"]["source"],
              "command line");
}

}  // namespace
}  // namespace twinchute::test
