// `twinchute stability` as a script sees it.
#include <algorithm>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemStability : public ProgramTest {
protected:
    Ended run(const Words& words) const { return ProgramTest::run(Words{"stability"} + words); }
};

TEST_F(SystemStability, WritesItsMatrixAndWritesItAgain) {
    const Ended ended = run({"--quick"});
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_NE(ended.out.find("0 silently wrong"), std::string::npos);
    const std::set<std::string> files{"stability.out", "stability.out/stability.csv",
                                      "stability.out/stability.json", "stability.out/stability.md"};
    EXPECT_EQ(tree_of(here_.path()), files);

    const Ended again = run({"--quick", "--json"});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(tree_of(here_.path()), files);
    const json matrix = json::parse(again.out);
    EXPECT_EQ(again.out, content_of(here_ / "stability.out/stability.json"));
    const std::string csv = content_of(here_ / "stability.out/stability.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), matrix["cells"].size() + 2);  // names and units
    for (const json& cell : matrix["cells"]) {
        const std::string verdict = cell["verdict"];
        EXPECT_TRUE(verdict == "stable" || verdict == "refused" || verdict == "stopped") << cell;
        EXPECT_NE(cell["reason"], "") << cell;
    }
}

TEST_F(SystemStability, TakesNoOperandAndNobodyElsesDirectory) {
    const Ended operand = run({"scene.toml"});
    EXPECT_EQ(operand.code, 2);
    EXPECT_NE(operand.err.find("scene.toml"), std::string::npos) << operand.err;
    here_.write("thesis/chapter.tex", "years of work");
    EXPECT_EQ(run({"--quick", "--out", "thesis"}).code, 2);
    EXPECT_EQ(tree_of(here_ / "thesis"), (std::set<std::string>{"chapter.tex"}));
}

}  // namespace
}  // namespace twinchute::test
