// Series of cases as a script sees them: a directory for each, one exit code for all.
#include "lib/cli/text.hpp"
#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemSeries : public ProgramTest {
protected:
    SystemSeries() {
        here_.write("series.toml",
                    "base = \"c9-inflation.toml\"\n"
                    "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\n"
                    "stop.time = 1.7\n"
                    "compare.tolerance.peak_force = \"1000 %\"\n"  // of a moment on a coarse mesh
                    "[[case]]\nname = \"light\"\nset = { \"payload.mass\" = \"80 kg\" }\n"
                    "[[case]]\nname = \"heavy\"\nset = { \"payload.mass\" = \"250 kg\" }\n");
    }
};

TEST_F(SystemSeries, EveryCaseHasItsDirectory) {
    const Ended rom = run({"rom", "series.toml", "--out", "r"});
    EXPECT_EQ(rom.code, 0) << rom.err;
    EXPECT_EQ(read("r/light/summary.json")["inputs"]["payload.mass"]["value"], 80);
    EXPECT_EQ(read("r/heavy/summary.json")["inputs"]["payload.mass"]["value"], 250);
    EXPECT_FALSE(std::filesystem::exists(here_ / "r/summary.json"));
    EXPECT_NE(rom.out.find(", light"), std::string::npos) << rom.out;
    EXPECT_NE(rom.out.find(", heavy"), std::string::npos) << rom.out;

    const Ended full = run({"full", "series.toml", "--quiet"});
    EXPECT_EQ(full.code, 0) << full.err;
    EXPECT_EQ(read("series.out/light/summary.json")["fidelity"], "full");
    EXPECT_EQ(read("series.out/heavy/summary.json")["fidelity"], "full");
    EXPECT_EQ(run({"full", "series.toml", "--quiet"}).code, 0);  // our own results may be written again
}

TEST_F(SystemSeries, CompareReportsEachAndEndsWithTheGravest) {
    const Ended ended = run({"compare", "series.toml", "--json", "--out", "c", "--tolerance",
                             "max_force=1000%", "--tolerance", "time_to_peak_force=1000%"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    const json gaps = json::parse(ended.out);
    ASSERT_TRUE(gaps.is_array());
    EXPECT_EQ(gaps.size(), 2u);
    for (const auto& [place, gap] : {std::pair{"light", gaps[0]}, {"heavy", gaps[1]}}) {
        json file = read(std::string("c/") + place + "/gap.json");
        EXPECT_EQ(file.erase("sha256"), 1u);  // which only files have
        EXPECT_EQ(file, gap) << place;
    }

    here_.write("one-fails.toml",
                "base = \"series.toml\"\ncompare.tolerance.time_to_peak_force = \"1000 %\"\n"
                "[[case]]\nname = \"wide\"\nset = { compare.tolerance.max_force = "
                "\"1000 %\" }\n"
                "[[case]]\nname = \"narrow\"\nset = { compare.tolerance.max_force = \"0 %\" }\n"
                "[[case]]\nname = \"last\"\nset = { compare.tolerance.max_force = \"1000 %\" }\n");
    const Ended verdict = run({"compare", "one-fails.toml", "--quiet", "--out", "v"});
    EXPECT_EQ(verdict.code, 1) << verdict.err;
    EXPECT_EQ(read("v/wide/gap.json")["exit_code"], 0);
    EXPECT_EQ(read("v/narrow/gap.json")["exit_code"], 1);
    EXPECT_EQ(read("v/last/gap.json")["exit_code"], 0);  // the series goes on

    // Reported again from its records, by whatever name; not without the one that failed.
    EXPECT_EQ(run({"report", "v", "--quiet"}).code, 1);
    const json one = json::parse(run({"report", "v/last", "v/last/", "v/../v/last", "--json"}).out);
    EXPECT_TRUE(one.is_object());  // of one comparison, not a list of three
    std::filesystem::remove_all(here_ / "v/narrow");
    const Ended without = run({"report", "v"});
    EXPECT_EQ(without.code, 2) << without.out;
    EXPECT_NE(without.err.find("holds 2 of the 3 comparisons"), std::string::npos) << without.err;
}

TEST_F(SystemSeries, EndsWithATableOfItsCases) {
    for (const std::string command : {"rom", "full"}) {
        const std::string out = run({command, "series.toml", "--out", command}).out;
        const auto table = out.rfind("\ncase ");
        ASSERT_NE(table, std::string::npos) << out;
        const std::string rows = out.substr(table);
        for (const char* name : {"\nlight  completed ", "\nheavy  completed "})
            EXPECT_NE(rows.find(name), std::string::npos) << rows;
        EXPECT_NE(rows.find("Peak opening force [N]"), std::string::npos) << rows;
        // Its files, beside the cases' own.
        const std::set<std::string> tree = tree_of(here_ / command);
        for (const std::string name : {"csv", "svg", "md", "html"})
            EXPECT_TRUE(tree.contains("series-" + command + "." + name)) << name;
        for (const std::string name : {"light", "heavy"}) {
            EXPECT_TRUE(tree.contains(name + "/run.html")) << name;
            EXPECT_NE(text(command + "/series-" + command + ".html").find("href=\"" + name + "/run.html\""),
                      std::string::npos);
        }
        EXPECT_EQ(run({command, "series.toml", "--out", command, "--quiet"}).code, 0);  // its own, once more
        // As each case says it.
        for (const std::string name : {"light", "heavy"}) {
            const double force = read(command + "/" + name + "/summary.json")["metrics"]["peak_force_N"];
            EXPECT_NE(rows.find("  " + readable(force)), std::string::npos) << force << " in " << rows;
        }
    }
    const std::string out = run({"compare", "series.toml", "--out", "c"}).out;
    const auto table = out.rfind("\ncase ");
    ASSERT_NE(table, std::string::npos) << out;
    const std::string rows = out.substr(table);
    EXPECT_NE(rows.find("verdict"), std::string::npos) << rows;
    for (const char* name : {"\nlight ", "\nheavy ", "\nseries    c/series.html"})
        EXPECT_NE(rows.find(name), std::string::npos) << rows;
    // A single scene has no such table, and nobody who wants JSON or silence gets one.
    here_.write("one.toml", "base = \"c9-inflation.toml\"\n");
    EXPECT_EQ(run({"rom", "one.toml"}).out.find("\ncase "), std::string::npos);
    EXPECT_EQ(run({"rom", "series.toml", "--quiet"}).out, "");
    EXPECT_TRUE(json::parse(run({"rom", "series.toml", "--json"}).out).is_array());
}

TEST_F(SystemSeries, AMistakeInOneCaseRunsNone) {
    const Ended ended = run({"rom", "series.toml", "--out", "r", "--set", "payload.mass=-1"});
    EXPECT_EQ(ended.code, 2);
    here_.write("bad.toml",
                "base = \"series.toml\"\n[[case]]\nname = \"good\"\n"
                "[[case]]\nname = \"bad\"\nset = { \"payload.mass\" = \"80 m\" }\n");
    const Ended bad = run({"rom", "bad.toml", "--out", "r"});
    EXPECT_EQ(bad.code, 2);
    EXPECT_TRUE(bad.err.starts_with("bad.toml:6:26: case 'bad': payload.mass: ")) << bad.err;
    EXPECT_EQ(bad.out, "");
    EXPECT_FALSE(std::filesystem::exists(here_ / "r"));
}

TEST_F(SystemSeries, CheckSpeaksOfEveryCase) {
    const Ended ended = run({"full", "series.toml", "--check"});
    EXPECT_EQ(ended.code, 0);
    EXPECT_NE(ended.out.find("light' is valid"), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find("heavy' is valid"), std::string::npos) << ended.out;
    const json checked = json::parse(run({"rom", "series.toml", "--check", "--json"}).out);
    EXPECT_EQ(checked.size(), 2u);
    EXPECT_EQ(checked[1]["valid"], true);
}

}  // namespace
}  // namespace twinchute::test
