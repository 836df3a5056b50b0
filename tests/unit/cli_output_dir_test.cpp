// What may be overwritten: our own results and nothing else.
#include <gtest/gtest.h>

#include "lib/cli/output_dir.hpp"
#include "lib/cli/verb.hpp"
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

TEST(CliOutputDir, AFileInTheWayIsFoundBeforeAnythingRuns) {
    const ScratchDir scratch;
    scratch.write("file", "text");
    EXPECT_THROW(check_output_dir(scratch / "file"), WriteError);
    EXPECT_THROW(check_output_dir(scratch / "file/below"), WriteError);
}

}  // namespace
}  // namespace twinchute
