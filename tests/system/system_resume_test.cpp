// Runs that are cut off and go on: killed at any moment, interrupted, with broken or foreign checkpoints. The
// run that was left alone is the expectation, byte for byte.
#include <csignal>

#include "lib/cli/output_dir.hpp"
#include "lib/record/checkpoint.hpp"
#include "tests/support/killed_process.hpp"
#include "tests/support/killed_run.hpp"
#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

namespace fs = std::filesystem;

class Resume : public ShortScene {
protected:
    /// A run of about a second on a coarse mesh, reefed, with fields; a checkpoint every 20 ms.
    Resume() {
        here_.write("long.toml",
                    "base = \"c9-reefed.toml\"\n"
                    "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\n"
                    "full.checkpoint_interval = 0.02\nstop.time = 0.25\n"
                    "compare.tolerance.stage_1_peak_force = \"1000 %\"\n");
    }

    Words words(const std::string& command, const std::string& out, const std::string& file = "long.toml",
                const std::string& stop = "12") const {
        return {TWINCHUTE_PROGRAM,   command,    file, "--out", out, "--set",
                "stop.time=" + stop, "--fields", "2"};
    }
    Ended start(const Words& words) const { return Process(words, here_.path()).wait(); }

    /// A directory as a killed run leaves it, with a checkpoint in it.
    void kill_once(const std::string& out) {
        Process process(words("full", out), here_.path());
        kill_at_checkpoint(process, out);
    }
    /// As soon as there is one; a run that ends before fails the test.
    void kill_at_checkpoint(Process& process, const std::string& directory) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (!is_checkpoint(here_ / (directory + "/checkpoint.bin")) &&
               std::chrono::steady_clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        ::kill(process.id(), SIGKILL);
        ASSERT_EQ(process.wait().code, 128 + SIGKILL);
    }
    /// That --resume ends with exit code 2, changes nothing, and says this.
    void expect_refused(const Words& words, const std::string& out, const std::string& reason) {
        const auto before = files(out);
        Words more = words;
        more.emplace_back("--resume");
        const Ended ended = start(more);
        EXPECT_EQ(ended.code, 2) << ended.out;
        EXPECT_NE(ended.err.find(reason), std::string::npos) << ended.err;
        EXPECT_EQ(files(out), before);
    }
};

TEST_F(Resume, AfterSeveralKillsTheRecordIsTheSame) {
    ASSERT_EQ(start(words("full", "whole")).code, 0);
    kill_once("killed");  // with a checkpoint to go on from, however slow the machine
    Words again = words("full", "killed");
    again.emplace_back("--resume");
    Ended ended;
    // How many of four hit depends on the machine: what is left to run may be over before the next.
    EXPECT_GE(run_with_kills(again, here_.path(), 4, 0.3, 1, &ended), 1);
    ASSERT_EQ(ended.code, 0) << ended.err;
    // Nothing else is there: neither checkpoint nor what was unfinished when it was killed.
    EXPECT_EQ(record_files(here_ / "killed"), record_files(here_ / "whole"));
    EXPECT_NE(ended.out.find("resumed   full at t = "), std::string::npos) << ended.out;
    EXPECT_FALSE(read("killed/summary.json")["cost"]["resumed_at_s"].empty());
    EXPECT_FALSE(read("whole/summary.json")["cost"].contains("resumed_at_s"));
}

TEST_F(Resume, KilledBeforeAnyChangeOfAFile) {
    // Checkpoints, frames and the record itself: made, filled, flushed, renamed, removed.
    const Words brief = words("full", "killed", "long.toml", "0.5");
    ASSERT_EQ(start(words("full", "whole", "long.toml", "0.5")).code, 0);
    const auto whole = record_files(here_ / "whole");
    int killed = 0;
    for (int step = 1;; step += step < 12 ? 1 : 5) {
        fs::remove_all(here_ / "killed");
        const KilledAt where = kill_before_change(step, brief, here_.path());
        if (where == KilledAt::untraceable) GTEST_SKIP() << "this machine lets no process trace another";
        if (where == KilledAt::never) break;
        ++killed;
        Words again = brief;
        again.emplace_back("--resume");
        const Ended ended = start(again);
        ASSERT_EQ(ended.code, 0) << "change " << step << ": " << ended.err;
        ASSERT_EQ(record_files(here_ / "killed"), whole) << "change " << step;
    }
    EXPECT_GT(killed, 15);
}

TEST_F(Resume, ComparesTheSameAfterKills) {
    ASSERT_LE(start(words("compare", "whole")).code, 1);  // so coarse a mesh need not meet a tolerance
    Ended ended;
    // How many of three hit depends on the machine: what is left to run may be over before the next.
    EXPECT_GE(run_with_kills(words("compare", "killed"), here_.path(), 3, 0.2, 2, &ended), 1);
    ASSERT_LE(ended.code, 1) << ended.err;
    for (const char* side : {"rom", "full"})
        EXPECT_EQ(record_files(here_ / "killed" / side), record_files(here_ / "whole" / side)) << side;
    EXPECT_EQ(tree_of(here_ / "killed"), tree_of(here_ / "whole"));
}

TEST_F(Resume, WhatHasEndedIsNotRunAgain) {
    ASSERT_EQ(start(words("full", "out")).code, 0);
    const auto before = files("out");
    Words again = words("full", "out");
    again.emplace_back("--resume");
    const Ended ended = start(again);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.out.find("kept      it had ended before; nothing was run"), std::string::npos);
    EXPECT_EQ(files("out"), before);  // dates and costs, too
    // Another scene's results are replaced by nobody who asks to go on.
    expect_refused(words("full", "out", "long.toml", "11"), "out",
                   "is of another scene (they differ in stop.time)");
    expect_refused(words("full", "out", "scene.toml"), "out",
                   "is of another scene (the scene file has changed since)");
}

// A table keeps its name when its numbers change.
TEST_F(Resume, WhatHasEndedWithOtherTablesIsRefused) {
    const auto wind = [&](const char* speed) {
        here_.write("w.csv", std::string("altitude,east,north\nm,m/s,m/s\n0,1,1\n500,") + speed + ",2\n");
    };
    for (const std::string command : {"full", "compare"}) {
        wind("5");
        const Words all{TWINCHUTE_PROGRAM,
                        command,
                        "long.toml",
                        "--out",
                        command,
                        "--set",
                        "environment.wind.table=\"w.csv\""};
        const Ended first = start(all);
        ASSERT_LT(first.code, 2) << first.err;
        Words again = all;
        again.emplace_back("--resume");
        EXPECT_EQ(start(again).code, first.code) << command;
        wind("9");
        expect_refused(all, command, "is of another scene (a table, a material or a mesh has changed since)");
    }
}

TEST_F(Resume, ASeriesGoesOnWithItsCases) {
    here_.write("series.toml", scene("") +
                                   "full.checkpoint_interval = 0.02\n"
                                   "[[case]]\nname = \"a\"\nset = { \"stop.time\" = 0.1 }\n"
                                   "[[case]]\nname = \"b\"\nset = { \"stop.time\" = 10.0 }\n"
                                   "[[case]]\nname = \"c\"\nset = { \"stop.time\" = 0.2 }\n");
    const Words whole{TWINCHUTE_PROGRAM, "compare", "series.toml", "--out", "whole"};
    ASSERT_LE(start(whole).code,
              1);  // some histories of so coarse a mesh are further apart than is asked for
    for (const char* file : {"series.md", "series.csv", "series.svg"})
        EXPECT_TRUE(fs::exists(here_ / "whole" / file)) << file;
    // One case after the other, so that it is known which has ended; at once they come to the same bits.
    Words words{TWINCHUTE_PROGRAM, "compare", "series.toml", "--threads", "1", "--out", "killed"};
    {
        Process process(words, here_.path());
        kill_at_checkpoint(process, "killed/b/full");
    }
    ASSERT_TRUE(fs::exists(here_ / "killed/a/gap.json"));
    ASSERT_FALSE(fs::exists(here_ / "killed/c"));
    const auto first = files("killed/a/full");
    words.emplace_back("--resume");
    const Ended ended = start(words);
    ASSERT_LE(ended.code, 1) << ended.err;
    EXPECT_EQ(files("killed/a/full"), first);  // not run again
    for (const char* one : {"a", "b", "c"})
        for (const char* side : {"rom", "full"})
            EXPECT_EQ(record_files(here_ / "killed" / one / side), record_files(here_ / "whole" / one / side))
                << one << ", " << side;
    EXPECT_EQ(read("killed/b/full/summary.json")["cost"]["resumed_at_s"].size(), 1u);
    EXPECT_FALSE(read("killed/c/full/summary.json")["cost"].contains("resumed_at_s"));
}

TEST_F(Resume, AfterCtrlCItGoesOnFromWhereItStopped) {
    ASSERT_EQ(start(words("full", "whole")).code, 0);
    Words rare = words("full", "out");  // none in time, but the one that is made on the way out
    rare.insert(rare.end(), {"--set", "full.checkpoint_interval=1000"});
    Process process(rare, here_.path());
    ASSERT_TRUE(process.wait_until_handled(SIGINT));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    ::kill(process.id(), SIGINT);
    ASSERT_EQ(process.wait().code, 130);
    EXPECT_EQ(read("out/summary.json")["status"]["code"], "interrupted");
    const std::string history = text("out/history.csv");
    const double stopped = std::stod(history.substr(history.rfind('\n', history.size() - 2) + 1));
    ASSERT_GT(stopped, 0.0);
    Words again = words("full", "out");
    again.emplace_back("--resume");
    const Ended ended = start(again);
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(record_files(here_ / "out"), record_files(here_ / "whole"));
    const double resumed = read("out/summary.json")["cost"]["resumed_at_s"][0];
    EXPECT_GT(resumed, 0.0);
    EXPECT_LE(resumed, stopped);
    EXPECT_GT(resumed, 0.8 * stopped);  // the run goes on for a hundred steps at most
}

TEST_F(Resume, RefusesEveryKindOfBrokenCheckpoint) {
    kill_once("out");
    const std::string bytes = text("out/checkpoint.bin");
    const Words same = words("full", "out");
    const auto with = [&](const std::string& content, const std::string& reason) {
        here_.write("out/checkpoint.bin", content);
        expect_refused(same, "out", reason);
    };
    with(bytes.substr(0, bytes.size() / 2), "is not the checkpoint that was written");
    with(bytes.substr(0, 30), "ends too early");
    std::string flipped = bytes;
    flipped[bytes.size() / 2] ^= 1;
    with(flipped, "is not the checkpoint that was written");
    with("", "is no checkpoint of this version");
    with("twinchute checkpoint 2\n" + bytes.substr(23), "is no checkpoint of this version");
    Checkpoint other = read_checkpoint_bytes(bytes, "a test");
    other.of.program = "0.0.1";
    with(checkpoint_bytes(other), "is of another version of this program");
    other = read_checkpoint_bytes(bytes, "a test");
    other.state.resize(other.state.size() / 2);
    with(checkpoint_bytes(other), "ends too early");
    here_.write("out/checkpoint.bin", bytes);
    Words heavier = same;
    heavier.insert(heavier.end(), {"--set", "payload.mass=153"});
    expect_refused(heavier, "out", "is of another scene");
    Words finer = same;
    finer.insert(finer.end(), {"--set", "full.mesh.gore_rows=5"});
    expect_refused(finer, "out", "is of another scene");
    // A pipe in its place would be waited for.
    fs::remove(here_ / "out/checkpoint.bin");
    fs::create_directory(here_ / "out/checkpoint.bin");
    Words again = same;
    again.emplace_back("--resume");
    EXPECT_EQ(start(again).code, 2);
}

TEST_F(Resume, RefusesFramesThatAreNotThoseThatWereWritten) {
    kill_once("out");
    const Checkpoint checkpoint = read_checkpoint_bytes(text("out/checkpoint.bin"), "a test");
    ASSERT_FALSE(checkpoint.frames.empty());
    const fs::path frame = here_ / ("out/fields/" + checkpoint.frames.front().temporary);
    const std::string frame_text = content_of(frame);
    std::ofstream(frame) << "something else";
    expect_refused(words("full", "out"), "out", "is not the frame that was written");
    fs::remove(frame);
    expect_refused(words("full", "out"), "out", "is missing");
    std::ofstream(frame) << frame_text;
    Words again = words("full", "out");
    again.emplace_back("--resume");
    EXPECT_EQ(start(again).code, 0);
}

TEST_F(Resume, WithoutItARunBeginsFromRelease) {
    kill_once("out");
    here_.write("out/checkpoint.bin", "broken");
    const Ended ended = start(words("full", "out"));
    EXPECT_EQ(ended.code, 2);  // no results of ours are there, and nothing is overwritten
    kill_once("other");
    ASSERT_EQ(start(words("full", "other")).code, 0);
    EXPECT_FALSE(read("other/summary.json")["cost"].contains("resumed_at_s"));
    EXPECT_FALSE(fs::exists(here_ / "other/checkpoint.bin"));
}

TEST_F(Resume, AnIntervalOfZeroMakesNone) {
    Words none = words("full", "out");
    none.insert(none.end(), {"--set", "full.checkpoint_interval=0"});
    Process process(none, here_.path());
    ASSERT_TRUE(process.wait_until_handled(SIGINT));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    ::kill(process.id(), SIGINT);
    ASSERT_EQ(process.wait().code, 130);
    EXPECT_FALSE(fs::exists(here_ / "out/checkpoint.bin"));
}

}  // namespace
}  // namespace twinchute::test
