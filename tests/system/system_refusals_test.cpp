// Results that cannot be written, and writing that is cut short. Promised: exit code 4, nothing
// half-written under its final name, earlier results untouched; a directory without summary.json
// is not a record; a signal ends a run with the record so far and exit code 130.
#include <sys/stat.h>

#include <chrono>
#include <map>
#include <thread>

#include "lib/cli/output_dir.hpp"
#include "tests/support/killed_process.hpp"
#include "tests/support/permissions.hpp"
#include "tests/support/program_test.hpp"
#include "tests/support/small_disk.hpp"

namespace twinchute::test {
namespace {

namespace fs = std::filesystem;

/// A fast run whose record differs from that of another mass.
Words rom(const std::string& mass, const fs::path& out) {
    return {TWINCHUTE_PROGRAM, "rom",        c9_inflation, "--quiet",
            "--out",           out.string(), "--set",      "payload.mass=" + mass};
}

/// A run of both fidelities of a moment.
Words quick_run(const std::string& command) {
    return {TWINCHUTE_PROGRAM, command,
            c9_inflation,      "--quiet",
            "--set",           "full.mesh.gore_columns=1",
            "--set",           "full.mesh.gore_rows=4",
            "--set",           "full.mesh.line_elements=4",
            "--set",           "stop.time=0.25"};
}

/// A full run that lasts until somebody ends it.
Words endless(const std::string& command) {
    return {TWINCHUTE_PROGRAM, command, c9_inflation, "--set", "stop.time=1000"};
}

Ended run(const Words& words, const fs::path& directory = "/", const std::function<bool()>& prepare = {}) {
    return Process(words, directory, {}, prepare).wait();
}

/// Every name below a directory, hidden ones included, with the bytes of the files.
std::map<std::string, std::string> everything_in(const fs::path& directory) {
    std::map<std::string, std::string> found;
    for (const std::string& name : tree_of(directory)) {
        const bool file = fs::is_regular_file(directory / name);
        found[name] = file ? content_of(directory / name) : "";
    }
    return found;
}

const std::string no_space = std::generic_category().message(ENOSPC);

// --- full disks -----------------------------------------------------------------------------

class FullDisk : public testing::Test {
protected:
    void SetUp() override {
        if (!disk_.mounted() && !disk_.borrow_shared_memory()) {
            GTEST_SKIP() << "no disk small enough to be filled: " << disk_.why()
                         << ", and /dev/shm is not a small tmpfs";
        }
        ASSERT_EQ(run(rom("100", disk_ / "out")).code, 0);
        before_ = everything_in(disk_ / "out");
        ASSERT_EQ(before_.size(), 4u);
    }
    void expect_refused(const Ended& ended, const std::string& reason = no_space) {
        EXPECT_EQ(ended.code, 4) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_TRUE(ended.err.starts_with("twinchute: cannot write '")) << ended.err;
        EXPECT_NE(ended.err.find(reason), std::string::npos) << ended.err;
    }

    SmallDisk disk_;
    std::map<std::string, std::string> before_;
};

TEST_F(FullDisk, HoweverMuchRoomIsLeftTheRecordIsTheOldOneOrTheNewOne) {
    int refused = 0, written = 0;
    for (std::size_t room = 0; room <= 512u << 10; room += 12u << 10) {
        disk_.leave(room);
        const Ended ended = run(rom("200", disk_ / "out"));
        const auto after = everything_in(disk_ / "out");
        if (ended.code == 0) {
            ++written;
            EXPECT_EQ(after.size(), 4u) << "room " << room;
            EXPECT_EQ(json::parse(after.at("summary.json"))["inputs"]["payload.mass"]["value"], 200);
            EXPECT_NE(after.at("history.csv"), before_.at("history.csv"));
            break;
        }
        ++refused;
        expect_refused(ended);
        EXPECT_TRUE(after == before_) << "room " << room;
    }
    EXPECT_GT(refused, 10);  // it was full before the first, between and within the files
    EXPECT_EQ(written, 1);   // and room enough was enough
}

TEST_F(FullDisk, ANewDirectoryDisappearsAgain) {
    disk_.leave(8u << 10);
    expect_refused(run(rom("200", disk_ / "new/and/deep")));
    EXPECT_FALSE(fs::exists(disk_ / "new"));
    EXPECT_TRUE(everything_in(disk_ / "out") == before_);
}

TEST_F(FullDisk, TheOtherCommandsKeepTheSamePromise) {
    for (const std::string command : {"full", "compare"}) {
        disk_.leave(4u << 20);  // a page takes less than 3 MB
        ASSERT_LT(run(quick_run(command) + Words{"--out", disk_ / command}).code, 2);
        const auto earlier = everything_in(disk_ / command);
        for (const std::size_t room : {0u, 12u << 10, 24u << 10}) {
            disk_.leave(room);
            expect_refused(
                run(quick_run(command) + Words{"--out", disk_ / command, "--set", "payload.mass=90"}));
            EXPECT_TRUE(everything_in(disk_ / command) == earlier) << command << ", room " << room;
        }
        fs::remove(disk_ / "ballast");
    }
}

TEST_F(FullDisk, FieldsThatDoNotFitEndTheRunAndLeaveTheEarlierOnes) {
    const Words out{"--out", disk_ / "full"};
    ASSERT_EQ(run(quick_run("full") + out + Words{"--fields", "4"}).code, 0);
    const auto earlier = everything_in(disk_ / "full");
    for (const std::size_t room : {0u, 64u << 10, 128u << 10}) {
        disk_.leave(room);
        expect_refused(run(quick_run("full") + out + Words{"--fields", "100"}));  // 26 frames of 45 kB
        EXPECT_TRUE(everything_in(disk_ / "full") == earlier) << "room " << room;
    }
}

TEST_F(FullDisk, StandardOutputIsAResultToo) {
    disk_.leave(4u << 10);
    const Ended ended =
        Process({TWINCHUTE_PROGRAM, "rom", c9_inflation, "--json"}, disk_.path(), (disk_ / "s.json").string())
            .wait();
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_NE(ended.err.find("standard output"), std::string::npos) << ended.err;
}

TEST(FullDiskOfNames, ADiskWithoutInodesIsAFullDisk) {
    const SmallDisk disk("size=512k,nr_inodes=4");  // the root, a directory, two files
    if (!disk.mounted()) GTEST_SKIP() << "no disk to run out of inodes: " << disk.why();
    const Ended ended = run(rom("100", disk / "out"));
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_NE(ended.err.find(no_space), std::string::npos) << ended.err;
    EXPECT_TRUE(tree_of(disk.path()).empty());
}

// --- places that take nothing ---------------------------------------------------------------

TEST(Unwritable, AReadOnlyFileSystemIsRefusedBeforeTheRun) {
    SmallDisk disk;
    if (!disk.mounted()) GTEST_SKIP() << "no file system to make read-only: " << disk.why();
    ASSERT_EQ(run(rom("100", disk / "out")).code, 0);
    const auto before = everything_in(disk.path());
    disk.make_read_only();
    for (const Words& words : {rom("200", disk / "out"), rom("200", disk / "new"),
                               endless("full") + Words{"--out", disk / "out"}, endless("compare")}) {
        const Ended ended = run(words, disk.path());  // compare writes into the current directory
        EXPECT_EQ(ended.code, 4) << ended.err;
        EXPECT_NE(ended.err.find(std::generic_category().message(EROFS)), std::string::npos) << ended.err;
    }
    EXPECT_TRUE(everything_in(disk.path()) == before);
}

TEST(Unwritable, AFolderWithoutPermissionIsRefusedBeforeTheRun) {
    const ScratchDir here;
    ASSERT_EQ(run(rom("100", here / "out")).code, 0);
    const auto before = everything_in(here.path());
    for (const std::string closed : {"out", ""}) {
        ASSERT_EQ(::chmod((here / closed).c_str(), 0555), 0);
        for (const Words& words :
             {rom("200", here / "out/new"), closed.empty() ? endless("full") : rom("200", here / "out")}) {
            const Ended ended = run(words, here.path(), without_override);
            if (ended.code == 127) GTEST_SKIP() << "root cannot give up its right to write anywhere";
            EXPECT_EQ(ended.code, 4) << ended.err;
            EXPECT_NE(ended.err.find(std::generic_category().message(EACCES)), std::string::npos)
                << ended.err;
        }
    }
    ::chmod(here.path().c_str(), 0755);
    ::chmod((here / "out").c_str(), 0755);
    EXPECT_TRUE(everything_in(here.path()) == before);
}

TEST(Unwritable, OneNameThatCannotBeReplacedCostsNoneOfTheOthers) {
    for (const std::string name : {"events.csv", "history.csv", "summary.json"}) {
        const SmallDisk disk;
        if (!disk.mounted()) GTEST_SKIP() << "no name to nail down: " << disk.why();
        ASSERT_EQ(run(rom("100", disk / "out")).code, 0);
        const auto before = everything_in(disk / "out");
        SmallDisk::nail_down(disk / ("out/" + name));
        const Ended ended = run(rom("200", disk / "out"));
        EXPECT_EQ(ended.code, 4) << ended.err;
        EXPECT_NE(ended.err.find(name), std::string::npos) << ended.err;
        EXPECT_TRUE(everything_in(disk / "out") == before) << name;
    }
}

// --- current directories --------------------------------------------------------------------

TEST(CurrentDirectory, OneThatIsGoneOrClosedStopsOnlyWhatIsWrittenThere) {
    const ScratchDir here;
    fs::create_directory(here / "closed");
    ::chmod((here / "closed").c_str(), 0555);
    const auto remove_it = [&] { return ::rmdir((here / "gone").c_str()) == 0; };
    for (const std::string name : {"gone", "closed"}) {
        const auto run_there = [&](const Words& words) {
            fs::create_directory(here / "gone");
            const Ended ended =
                run(words, here / name, name == "gone" ? std::function<bool()>(remove_it) : without_override);
            fs::remove(here / "gone");
            return ended;
        };
        const Ended printed = run_there({TWINCHUTE_PROGRAM, "rom", c9_inflation, "--json"});
        if (printed.code == 127) GTEST_SKIP() << "root cannot give up its right to write anywhere";
        EXPECT_EQ(printed.code, 0) << printed.err;
        EXPECT_EQ(json::parse(printed.out)["status"]["code"], "completed");
        EXPECT_EQ(run_there(rom("200", here / "elsewhere")).code, 0);  // an absolute --out is no concern
        const Ended refused = run_there(endless("full"));              // ./c9-inflation.out is
        EXPECT_EQ(refused.code, 4) << name << refused.err;
        EXPECT_TRUE(refused.err.starts_with("twinchute: cannot write '")) << refused.err;
    }
    EXPECT_EQ(run({TWINCHUTE_PROGRAM, "rom", "no-such.toml"}, here.path()).code, 2);
    EXPECT_EQ(tree_of(here / "closed"), std::set<std::string>{});
}

// --- interrupted ----------------------------------------------------------------------------

/// Promise to readers after the program was killed: a record is wholly the old or the new one,
/// and every file under its final name is whole.
void expect_whole(const fs::path& directory, const std::map<std::string, std::string>& old_files,
                  const std::map<std::string, std::string>& new_files, int step) {
    const bool is_record = fs::exists(directory / "summary.json");
    EXPECT_EQ(is_our_output(directory), is_record) << "step " << step;
    int of_the_old = 0, of_the_new = 0;
    for (const std::string name : {"history.csv", "events.csv", "summary.json"}) {
        if (!fs::exists(directory / name)) {
            EXPECT_FALSE(is_record) << name << " is missing beside summary.json, step " << step;
            continue;
        }
        const std::string text = content_of(directory / name);
        const auto old_text = old_files.find(name);
        const bool is_old = old_text != old_files.end() && text == old_text->second;
        // The new summary holds times of its own: whole when it can be read.
        const bool is_new =
            name == "summary.json"
                ? json::accept(text) && json::parse(text)["inputs"]["payload.mass"]["value"] == 200
                : text == new_files.at(name);
        EXPECT_TRUE(is_old || is_new) << name << " is half-written, step " << step;
        of_the_old += is_old;
        of_the_new += is_new && !is_old;
    }
    if (is_record) {
        EXPECT_TRUE(of_the_old == 3 || of_the_new == 3) << "a record of two runs, step " << step;
    }
}

TEST(Killed, BeforeAnyStepOfWritingLeavesWholeFilesOnly) {
    const ScratchDir here;
    ASSERT_EQ(run(rom("100", here / "old")).code, 0);
    ASSERT_EQ(run(rom("200", here / "new")).code, 0);
    const auto old_files = everything_in(here / "old"), new_files = everything_in(here / "new");
    for (const bool there_before : {true, false}) {
        const fs::path out = here / "out";
        int killed = 0;
        for (int step = 1;; ++step) {
            fs::remove_all(out);
            if (there_before) fs::copy(here / "old", out);
            const KilledAt where = kill_before_change(step, rom("200", out), here.path());
            if (where == KilledAt::untraceable) GTEST_SKIP() << "this machine lets no process trace another";
            if (where == KilledAt::never) break;
            ++killed;
            expect_whole(out, old_files, new_files, step);
        }
        EXPECT_GT(killed, 9);  // three files made, filled, flushed and renamed, at the least
        EXPECT_TRUE(is_our_output(out));
    }
}

class Interrupted : public ProgramTest, public testing::WithParamInterface<int> {
protected:
    /// Runs a command until it has computed for a while, then sends the signal.
    Ended interrupt(const std::string& command) {
        Process process(endless(command) + Words{"--out", "out"}, here_.path());
        EXPECT_TRUE(process.wait_until_handled(GetParam()));
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        ::kill(process.id(), GetParam());
        return process.wait();
    }
};

TEST_P(Interrupted, AFullRunLeavesTheRecordSoFar) {
    const Ended ended = interrupt("full");
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_EQ(ended.err, "");
    const json summary = read("out/summary.json");
    EXPECT_EQ(summary["status"]["code"], "interrupted");
    EXPECT_GT(summary["cost"]["steps"], 0);
    EXPECT_EQ(tree_of(here_ / "out"), (std::set<std::string>{"summary.json", "history.csv", "events.csv",
                                                             "run.html", "frames.bin", "checkpoint.bin"}));
    EXPECT_GT(content_of(here_ / "out/history.csv").size(), 200u);
    EXPECT_TRUE(is_our_output(here_ / "out"));
}

TEST_P(Interrupted, AComparisonKeepsTheFidelityThatWasDone) {
    const Ended ended = interrupt("compare");
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_EQ(read("out/rom/summary.json")["status"]["code"], "stopped_by_event");
    EXPECT_EQ(read("out/full/summary.json")["status"]["code"], "interrupted");
    EXPECT_TRUE(fs::exists(here_ / "out/gap.json"));
}

TEST_P(Interrupted, AskingTwiceEndsItAtOnceOrWithAWholeRecord) {
    Process process(endless("full") + Words{"--out", "out"}, here_.path());
    ASSERT_TRUE(process.send_when_handled(GetParam()));
    if (process.wait_until_handled(GetParam(), false)) ::kill(process.id(), GetParam());
    const Ended ended = process.wait();
    EXPECT_TRUE(ended.code == 128 + GetParam() || ended.code == 130) << ended.code;
    if (fs::exists(here_ / "out/summary.json")) {
        EXPECT_EQ(read("out/summary.json")["status"]["code"], "interrupted");
    }
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupted, testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace twinchute::test
