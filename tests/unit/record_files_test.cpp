// Results appear whole or not at all.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <limits>

#include "lib/record/record_csv.hpp"
#include "lib/record/write_record.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

RunRecord record_of_one_row() {
    RunRecord record;
    record.fidelity = "rom";
    record.channels = {{"time", "s", {0, 0.1}},
                       {"share", "", {1.0 / 3, std::numeric_limits<double>::quiet_NaN()}}};
    record.events = {{"full, open \"main\"", 1.5, 270, 18}};
    return record;
}

/// write() of more than `bytes` fails with EFBIG, as a full disk does with ENOSPC.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    void (*handler_)(int);
};

TEST(RecordCsv, FirstLineNamesSecondLineUnitsThenRows) {
    // 1/3 in the shortest digits that read back; the NaN is an empty field.
    EXPECT_EQ(history_csv(record_of_one_row()), "time,share\ns,1\n0,0.3333333333333333\n0.1,\n");
    EXPECT_EQ(events_csv(record_of_one_row()),
              "name,time,altitude,speed\n-,s,m,m/s\n\"full, open \"\"main\"\"\",1.5,270,18\n");
}

TEST(RecordFiles, WritesThreeFilesAndLeavesNoTemporaryOnes) {
    const ScratchDir scratch;
    write_record(record_of_one_row(), scratch / "a/b");
    EXPECT_EQ(tree_of(scratch.path()),
              (std::set<std::string>{"a", "a/b", "a/b/history.csv", "a/b/events.csv", "a/b/summary.json"}));
}

TEST(RecordFiles, ReplacesAnEarlierRecord) {
    const ScratchDir scratch;
    scratch.write("summary.json", "old");
    write_record(record_of_one_row(), scratch.path());
    EXPECT_EQ(content_of(scratch / "summary.json").substr(0, 1), "{");
}

TEST(RecordFiles, AFileInTheWayIsAWriteError) {
    const ScratchDir scratch;
    scratch.write("file", "not a directory");
    EXPECT_THROW(write_record(record_of_one_row(), scratch / "file/out"), WriteError);
    EXPECT_EQ(tree_of(scratch.path()), (std::set<std::string>{"file"}));
}

TEST(RecordFiles, AFullDeviceLeavesEarlierResultsUntouched) {
    const ScratchDir scratch;
    write_record(record_of_one_row(), scratch.path());
    const std::string before = content_of(scratch / "summary.json");
    const auto names = tree_of(scratch.path());

    RunRecord larger = record_of_one_row();
    larger.scene.name = std::string(5000, 'x');  // history and events fit, the summary does not
    {
        const FileSizeLimit limit(4000);
        EXPECT_THROW(write_record(larger, scratch.path()), WriteError);
        EXPECT_THROW(write_record(larger, scratch / "new/place"), WriteError);
    }
    EXPECT_EQ(content_of(scratch / "summary.json"), before);
    EXPECT_EQ(tree_of(scratch.path()), names);  // no temporary file, no new directory
}

TEST(RecordFiles, TheMessageNamesPlaceAndReason) {
    const WriteError error("some/where", ENOSPC);
    EXPECT_NE(std::string(error.what()).find("'some/where' (No space left on device)"), std::string::npos);
}

TEST(RecordFiles, ABatchThatIsNotCommittedLeavesNothing) {
    const ScratchDir scratch;
    {
        FileBatch batch;
        batch.add(scratch / "deep/down/a.txt", "text");
        EXPECT_FALSE(fs::exists(scratch / "deep/down/a.txt"));  // not under its name before commit()
    }
    EXPECT_TRUE(tree_of(scratch.path()).empty());
}

TEST(RecordFiles, ACommitThatFailsPutsBackWhatStoodThere) {
    const ScratchDir scratch;
    for (const char* name : {"a.csv", "b.csv", "summary.json"})
        scratch.write(name, "old");
    FileBatch batch;
    for (const char* name : {"new.csv", "a.csv", "b.csv"})
        batch.add(scratch / name, "new");
    batch.add(scratch / "summary.json", "new", FileBatch::Kind::marker);
    fs::remove(scratch / "b.csv");  // somebody else's hand, between add() and commit()
    scratch.write("b.csv/chapter.tex", "years of work");
    EXPECT_THROW(batch.commit(), WriteError);
    EXPECT_EQ(content_of(scratch / "a.csv"), "old");
    EXPECT_EQ(content_of(scratch / "b.csv/chapter.tex"), "years of work");
    EXPECT_EQ(content_of(scratch / "summary.json"), "old");
    EXPECT_FALSE(fs::exists(scratch / "new.csv"));
}

TEST(RecordFiles, ADirectoryUnderTheNameOfAFileIsFoundBeforeAnythingChanges) {
    const ScratchDir scratch;
    scratch.write("history.csv", "old");
    fs::create_directory(scratch / "summary.json");
    EXPECT_THROW(write_record(record_of_one_row(), scratch.path()), WriteError);
    EXPECT_EQ(content_of(scratch / "history.csv"), "old");

    const ScratchDir other;
    other.write("summary.json", "old");
    fs::create_directory(other / "history.csv");
    EXPECT_THROW(write_record(record_of_one_row(), other.path()), WriteError);
    EXPECT_EQ(content_of(other / "summary.json"), "old");
}

}  // namespace
}  // namespace twinchute
