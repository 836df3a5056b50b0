// `twinchute validate` as a script sees it.
#include <algorithm>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemValidate : public ProgramTest {
protected:
    Ended run(const Words& words) const { return ProgramTest::run(Words{"validate"} + words); }
    /// A suite of one closed form, sqrt(2 L/g) for 24.995 m, and of what cannot be run.
    void write_suite(const std::string& name, const std::string& expected) {
        here_.write(name,
                    "schema = 1\nname = \"mine\"\ntitle = \"Mine\"\nevidence = \"exact\"\n"
                    "[[case]]\nname = \"drop\"\nbase = \"paper/crane-drop.toml\"\nsource = \"free fall\"\n"
                    "set = { \"environment.atmosphere.density\" = 1e-9, \"stop.at\" = \"line-stretch\" }\n"
                    "row = [{ quantity = \"line_stretch_time\", tolerance = 1e-6, expected = " +
                        expected +
                        " }]\n"
                        "[[case]]\nname = \"elsewhere\"\nmissing = [\"mass of the payload\"]\n");
    }
};

TEST_F(SystemValidate, ExitCodeIsWhatTheTableSays) {
    // All shipped suites. Whether they hold is their business; that the exit code says so is this test's.
    const Ended ended = run({"--quick", "--json"});
    ASSERT_TRUE(ended.code == 0 || ended.code == 1) << ended.err;
    EXPECT_EQ(ended.out, content_of(here_ / "validate.out/validate.json"));
    const json result = json::parse(ended.out);
    int judged = 0, exceeded = 0, wrong = 0, listed = 0;
    for (const json& suite : result["suites"])
        for (const json& row : suite["rows"]) {
            const std::string verdict = row["verdict"];
            judged += verdict == "within" || verdict == "exceeded";
            exceeded += verdict == "exceeded";
            wrong += verdict == "exceeded" && suite["evidence"] == "exact";
            ++listed;
            if (verdict == "not run" || verdict == "by test") {
                EXPECT_NE(row["why"], "") << row;
            }
            if (verdict == "within") {
                EXPECT_TRUE(row.contains("predicted") && row.contains("expected")) << row;
            }
        }
    // Of what comes with the program exact answers alone decide, unless all are asked for.
    EXPECT_EQ(ended.code, wrong > 0 ? 1 : 0);
    EXPECT_EQ(result["within"], wrong == 0);
    EXPECT_EQ(result["decided_by"], "exact");
    EXPECT_GT(exceeded, wrong) << "or the check of --strict below shows nothing";
    EXPECT_GT(judged, 150);
    // Closed forms hold, whatever tests and papers say.
    for (const json& suite : result["suites"]) {
        if (suite["evidence"] != "exact") continue;
        for (const json& row : suite["rows"])
            EXPECT_NE(row["verdict"], "exceeded") << row;
    }
    const std::string csv = content_of(here_ / "validate.out/validate.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), listed + 2);  // names and units
    for (const std::string& name : tree_of(here_ / "validate.out"))
        EXPECT_TRUE(name == "report.md" || name == "validate.csv" || name == "validate.json" ||
                    ((name.starts_with("scatter-measured-") || name.starts_with("scatter-filling-")) &&
                     name.ends_with(".svg")))
            << name;
}

TEST_F(SystemValidate, SaysFirstWhetherTheProgramIsSound) {
    // The suite of printed numbers has rows that are not met; whoever names it asks about them.
    here_.write(
        "printed.toml",
        "schema = 1\nname = \"printed\"\ntitle = \"Printed\"\nevidence = \"printed\"\n[[case]]\nname = "
        "\"c\"\n"
        "base = \"c9-inflation.toml\"\nsource = \"s\"\nrow = [{ quantity = \"peak_force\", expected = 1, "
        "tolerance = \"5 %\" }]\n");
    const Ended named = run({"printed.toml", "--out", "n"});
    EXPECT_EQ(named.code, 1);
    EXPECT_TRUE(
        named.out.starts_with("outside   printed (printed): 1 of 1 judged rows\n          c, peak force"))
        << named.out;
    write_suite("right.toml", "2.257778");
    const Ended both = run({"right.toml", "printed.toml", "--out", "b"});
    EXPECT_EQ(both.code, 1);
    EXPECT_TRUE(both.out.starts_with("sound     1 of 1 rows with exact answers verified\noutside   printed"))
        << both.out;
    write_suite("wrong.toml", "2.257");
    EXPECT_TRUE(run({"wrong.toml", "--out", "w"}).out.starts_with("NOT SOUND 0 of 1 rows"));
}

// The truth of the synthetic drops is n = 5.5 and 39 m^2; the scene says 4 and 42.56 m^2, and its peak is a
// quarter too high.
TEST_F(SystemValidate, ADropIsJudgedByAnotherOfTheSameCanopy) {
    const Ended ended = run({"--suite", "example/blind-drop", "--json"});
    ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
    const json rows = json::parse(ended.out)["suites"][0]["rows"];
    EXPECT_EQ(rows[0]["verdict"], "within");
    EXPECT_LT(std::abs(rows[0]["relative_error"].get<double>()), 0.02);
    // What the calibration leaves open of the inputs is part of what is allowed.
    EXPECT_GT(rows[0]["sigma_inputs"].get<double>(), 1.0);
    EXPECT_GT(rows[2]["relative_error"].get<double>(), 0.2);
    EXPECT_NE(content_of(here_ / "validate.out/report.md").find("parachute.fill\\_time.n = 5.5"),
              std::string::npos);
}

TEST_F(SystemValidate, AWrongExpectedValueExitsWithOne) {
    write_suite("right.toml", "2.257778");
    const Ended right = run({"right.toml", "--out", "r"});
    EXPECT_EQ(right.code, 0) << right.out << right.err;
    EXPECT_NE(right.out.find("1 of 1 judged rows verified; 1 not run"), std::string::npos) << right.out;
    EXPECT_NE(right.out.find("elsewhere: missing: mass of the payload"), std::string::npos) << right.out;
    write_suite("wrong.toml", "2.257");
    const Ended wrong = run({"wrong.toml", "--out", "r"});
    EXPECT_EQ(wrong.code, 1) << wrong.err;
    EXPECT_NE(wrong.out.find("NO"), std::string::npos) << wrong.out;
    EXPECT_NE(content_of(here_ / "r/report.md").find("elsewhere: missing: mass of the payload"),
              std::string::npos);
}

TEST_F(SystemValidate, ATestOfOnesOwnIsASuite) {
    const Ended ended = run({"--suite", "example/own-test"});
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_NE(ended.out.find("2 of 2 judged rows met"), std::string::npos) << ended.out;
    EXPECT_EQ(ended.out.find("validated"), std::string::npos) << ended.out;
}

TEST_F(SystemValidate, TheAnswerIsTheSameOnAnyNumberOfThreads) {
    // Six full runs of a coarse mesh, at once and one after the other: the same bits.
    here_.write("s.toml", R"(schema = 1
name = "seeds"
title = "Seeds"
evidence = "synthetic"
[[case]]
name = "coarse"
base = "c9-inflation.toml"
set = { "full.mesh.gore_rows" = 5, "full.mesh.line_elements" = 4, "full.noise.amplitude" = 1e-3, "stop.time" = 0.3 }
fidelities = ["full"]
seeds = 6
source = "none"
row = [{ quantity = "largest_force", expected = 1, tolerance = 1 }]
)");
    const auto text = [&](const char* threads) {
        EXPECT_EQ(run({"s.toml", "--threads", threads, "--quiet"}).code, 1);
        return content_of(here_ / "validate.out/validate.csv");
    };
    const std::string one = text("1");
    EXPECT_NE(one.find("largest force"), std::string::npos);
    EXPECT_EQ(one, text("4"));
}

TEST_F(SystemValidate, ABadSuiteWritesNothing) {
    write_suite("bad.toml", "\"2 m\"");
    const Ended unit = run({"bad.toml"});
    EXPECT_EQ(unit.code, 2);
    EXPECT_TRUE(unit.err.starts_with("bad.toml:10:")) << unit.err;
    EXPECT_NE(unit.err.find("case.row.expected"), std::string::npos) << unit.err;
    EXPECT_EQ(run({"nowhere.toml"}).code, 2);
    const Ended name = run({"--suite", "closed-from"});
    EXPECT_EQ(name.code, 2);
    EXPECT_NE(name.err.find("did you mean 'closed-forms'?"), std::string::npos) << name.err;
    write_suite("a.toml", "1");
    EXPECT_EQ(run({"a.toml", "a.toml"}).code, 2);  // results are kept by name
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"a.toml", "bad.toml"}));
    here_.write("thesis/chapter.tex", "years of work");
    EXPECT_EQ(run({"a.toml", "--out", "thesis"}).code, 2);
}

}  // namespace
}  // namespace twinchute::test
