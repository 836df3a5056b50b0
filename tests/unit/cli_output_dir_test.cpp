// Only our own results may be overwritten.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/write_error.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

constexpr const char* ours = R"({"generator": "twinchute", "schema": 1})";

TEST(CliOutputDir, TheDefaultIsNamedAfterTheSceneFile) {
    EXPECT_EQ(default_output_dir("data/scenes/c9-inflation.toml"), "./c9-inflation.out");
    // A name that is an option, a path or nothing at all must not become one.
    for (const char* name : {"--quiet.toml", "..", "/", "", "a b$(c).toml"}) {
        const auto directory = default_output_dir(name);
        EXPECT_EQ(directory.parent_path(), ".") << name;
        EXPECT_EQ(directory.string().find_first_of(" $()"), std::string::npos) << name;
        EXPECT_NE(directory.filename(), ".out") << name;
    }
}

TEST(CliOutputDir, AcceptsWhatIsNotThereEmptyOrOurs) {
    const ScratchDir scratch;
    EXPECT_NO_THROW(check_output_dir(scratch.path()));
    EXPECT_NO_THROW(check_output_dir(scratch / "not/there"));
    scratch.write("single/summary.json", ours);
    EXPECT_NO_THROW(check_output_dir(scratch / "single"));
    scratch.write("pair/gap.json", ours);
    EXPECT_NO_THROW(check_output_dir(scratch / "pair"));
    scratch.write("half/rom/summary.json", ours);
    EXPECT_NO_THROW(check_output_dir(scratch / "half"));
}

TEST(CliOutputDir, RefusesWhatSomebodyElseWrote) {
    const ScratchDir scratch;
    scratch.write("thesis/chapter.tex", "years of work");
    EXPECT_THROW(check_output_dir(scratch / "thesis"), UsageError);
    scratch.write("other/summary.json", R"({"generator": "another program"})");
    EXPECT_THROW(check_output_dir(scratch / "other"), UsageError);
    scratch.write("broken/summary.json", "{");
    EXPECT_THROW(check_output_dir(scratch / "broken"), UsageError);
    scratch.write("list/summary.json", R"(["twinchute"])");
    EXPECT_THROW(check_output_dir(scratch / "list"), UsageError);
}

TEST(CliOutputDir, ResultsBelowDoNotMakeAFolderOfOtherThingsOurs) {
    const ScratchDir scratch;
    scratch.write("work/c9.out/gap.json", ours);
    EXPECT_NO_THROW(check_output_dir(scratch / "work"));  // as an unfinished series is
    scratch.write("work/series.md", "# of all cases");
    EXPECT_NO_THROW(check_output_dir(scratch / "work"));
    scratch.write("work/report.md", "of somebody, since no run was killed here");
    EXPECT_THROW(check_output_dir(scratch / "work"), UsageError);
    scratch.write("home/c9.out/gap.json", ours);
    scratch.write("home/rom/history.csv", "years of work");
    EXPECT_THROW(check_output_dir(scratch / "home"), UsageError);
    EXPECT_NO_THROW(check_output_dir(scratch / "home/c9.out"));
}

TEST(CliOutputDir, WhatAPathComesToIsGuardedNotHowItIsWritten) {
    const ScratchDir scratch;
    scratch.write("home/rom/history.csv", "years of work");
    EXPECT_THROW(check_output_dir(scratch / "home/new/.."), UsageError);
    EXPECT_THROW(check_output_dir(scratch / "home/rom/.."), UsageError);
    EXPECT_NO_THROW(check_output_dir(scratch / "home/new/../other"));
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(scratch / "home");
    EXPECT_THROW(check_output_dir(""), UsageError);
    EXPECT_THROW(check_output_dir("."), UsageError);
    std::filesystem::current_path(before);
}

TEST(CliOutputDir, AcceptsWhatKilledRunsLeft) {
    const ScratchDir scratch;
    scratch.write("killed/checkpoint.bin", "twinchute checkpoint 1\nand the rest");
    EXPECT_NO_THROW(check_output_dir(scratch / "killed"));
    scratch.write("series/case/full/checkpoint.bin", "twinchute checkpoint 1\nand the rest");
    EXPECT_NO_THROW(check_output_dir(scratch / "series"));
    scratch.write("foreign/checkpoint.bin", "of somebody else");
    EXPECT_THROW(check_output_dir(scratch / "foreign"), UsageError);
    // A process that was waited for is gone.
    const pid_t gone = ::fork();
    if (gone == 0) ::_exit(0);
    ::waitpid(gone, nullptr, 0);
    const std::string before = "early/full/fields/.frame-000000.vtu.", after = "-0.tmp";
    scratch.write(before + std::to_string(gone) + after, "");
    EXPECT_NO_THROW(check_output_dir(scratch / "early"));
    scratch.write("early/notes.txt", "years of work");
    EXPECT_THROW(check_output_dir(scratch / "early"), UsageError);
    // One of a process that is still there is not given up.
    scratch.write("busy/.history.csv." + std::to_string(::getppid()) + "-3.tmp", "");
    EXPECT_THROW(check_output_dir(scratch / "busy"), UsageError);
}

TEST(Abandoned, AreTemporaryFilesOfProcessesThatAreGone) {
    const pid_t gone = ::fork();
    if (gone == 0) ::_exit(0);
    ::waitpid(gone, nullptr, 0);
    const std::string number = std::to_string(gone);
    EXPECT_TRUE(is_abandoned("d/.history.csv." + number + "-12.tmp"));
    EXPECT_TRUE(is_abandoned("d/.history.csv." + number + "-12.tmp.old"));
    const std::vector<std::string> others{
        "history.csv." + number + "-12.tmp",
        ".history.csv." + number + "-12",
        ".history.csv." + number + ".tmp",
        ".history.csv." + number + "-x.tmp",
        ".history.csv.-12.tmp",
        "." + number + "-12.tmp",
        ".tmp",
        ".history.csv." + std::to_string(::getpid()) + "-1.tmp",
        ".history.csv.1-1.tmp",  // the first process is always there
    };
    for (const std::string& name : others)
        EXPECT_FALSE(is_abandoned("d/" + name)) << name;
}

TEST(CliOutputDir, AFileInTheWayIsFoundBeforeAnythingRuns) {
    const ScratchDir scratch;
    scratch.write("file", "text");
    EXPECT_THROW(check_output_dir(scratch / "file"), WriteError);
    EXPECT_THROW(check_output_dir(scratch / "file/below"), WriteError);
}

}  // namespace
}  // namespace twinchute
