// `twinchute size` as a script sees it: exit codes, the sized scene, what is refused.
#include "tests/support/program_test.hpp"
#include "tests/support/python.hpp"

namespace twinchute::test {
namespace {

const std::string rocket = shipped_scene("sizing/rocket-main");
const std::string personnel = shipped_scene("sizing/personnel");

class SystemSize : public ProgramTest {
protected:
    static bool says(const std::string& text, std::string_view what) {
        return text.find(what) != std::string::npos;
    }
};

TEST_F(SystemSize, PrintsAndWritesNothing) {
    const Ended ended = run({"size", rocket});
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const char* what : {"meets the limits", "descent rate", "binds", "peak force by formula", "D0 = "})
        EXPECT_TRUE(says(ended.out, what)) << what << "\n" << ended.out;
    EXPECT_EQ(ended.err, "");
    EXPECT_TRUE(nothing_written());
    EXPECT_EQ(run({"size", rocket, "--quiet"}).out, "");
    EXPECT_TRUE(says(run({"size", rocket, "--check"}).out, "is valid; nothing was run"));
}

TEST_F(SystemSize, WritesASceneThatMeetsItsLimits) {
    EXPECT_EQ(run({"size", rocket, "--out", "there/sized.toml"}).code, 0);
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"there", "there/sized.toml"}));
    const Ended again = run({"rom", "there/sized.toml", "--json"});
    ASSERT_EQ(again.code, 0) << again.err;
    const json summary = json::parse(again.out);
    EXPECT_EQ(summary["scene"]["name"], "rocket main, sized");
    // 18 ft/s, to the 0.1 % that sizing promises; from below, since the edge is taken on its safe side.
    EXPECT_LE(summary["metrics"]["descent_rate_m_s"].get<double>(), 18 * 0.3048 * (1 + 1e-9));
    EXPECT_GE(summary["metrics"]["descent_rate_m_s"].get<double>(), 18 * 0.3048 * 0.999);
    EXPECT_EQ(run({"size", "there/sized.toml", "--out", "there/sized.toml"}).code, 0);  // its own, once more
}

TEST_F(SystemSize, WritesAPage) {
    const Ended ended = run({"size", rocket, "--report", "there/sized.html"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_TRUE(says(ended.out, "report    there/sized.html"));
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"there", "there/sized.html"}));
    const std::string page = text("there/sized.html");
    for (const char* words :
         {"Meets the limits", "<h1>rocket main</h1>", "Limits against the nominal diameter D0",
          ">flat-circular</th>", "found: 2.286 m", "Opening force"})
        EXPECT_TRUE(says(page, words)) << words;
    // A page says as well that there is nothing to find, and then there is no scene.
    const Ended missed = run({"size", rocket, "--set", "size.max_force=300 N", "--report", "there/sized.html",
                              "--out", "there/sized.toml"});
    EXPECT_EQ(missed.code, 1);
    EXPECT_TRUE(says(text("there/sized.html"), "No value meets the limits"));
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"there", "there/sized.html"}));
    here_.write("mine.html", "<p>mine</p>");
    const Ended refused = run({"size", rocket, "--report", "mine.html", "--out", "sized.toml"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(says(refused.err, "name another file with --report")) << refused.err;
    EXPECT_EQ(text("mine.html"), "<p>mine</p>");
    EXPECT_FALSE(tree_of(here_.path()).contains("sized.toml"));
}

TEST_F(SystemSize, ASizedCanopyWithAStructureIsReadyToCompare) {
    EXPECT_EQ(run({"size", personnel, "--quiet", "--out", "sized.toml"}).code, 0);
    const Ended ended = run({"compare", "sized.toml", "--check"});
    EXPECT_EQ(ended.code, 0) << ended.err;
}

TEST_F(SystemSize, SaysWhichLimitCannotBeMetAndByHowMuch) {
    const Ended ended = run({"size", rocket, "--set", "size.max_force=300 N", "--out", "sized.toml"});
    EXPECT_EQ(ended.code, 1);
    EXPECT_TRUE(says(ended.out, "no value was found that meets the limits")) << ended.out;
    EXPECT_TRUE(says(ended.out, "% too much")) << ended.out;
    EXPECT_TRUE(nothing_written());
    const json found = json::parse(run({"size", rocket, "--set", "size.max_force=300 N", "--json"}).out);
    EXPECT_FALSE(found["meets"].get<bool>());
    double used = 0.0;
    for (const json& limit : found["candidates"][0]["limits"])
        used = std::max(used, limit["used"].get<double>());
    EXPECT_GT(used, 1.0);
}

TEST_F(SystemSize, RefusesWhatItCannotSize) {
    const std::string opening = shipped_scene("c9-inflation");
    const auto refused = [&](const Words& words, std::string_view why) {
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << why;
        EXPECT_TRUE(says(ended.err, why)) << ended.err;
        EXPECT_EQ(ended.out, "");
    };
    refused({"size", opening}, "there is no [size]");
    refused({"size", rocket, "--set", "size.vary=[\"diameter\"]"}, "unknown word 'diameter'");
    refused({"size", rocket, "--set", "size.types=[\"crss\"]"}, "did you mean 'cross'?");
    refused({"size", rocket, "--set", "size.types=[\"cross\", \"cross\"]"}, "stands there twice");
    refused({"size", rocket, "--set", "stop.at=peak-force"}, "the run ends before the descent is steady");
    refused({"size", rocket, "--out", "sized"}, "the name of a .toml file is wanted");
    here_.write("mine.toml", "schema = 1\n");
    refused({"size", rocket, "--out", "mine.toml"}, "was not written by `twinchute size`");
    EXPECT_EQ(content_of(here_ / "mine.toml"), "schema = 1\n");
    here_.write("none.toml", "base = \"" + rocket + "\"\n[size]\n");
    EXPECT_EQ(run({"size", "none.toml"}).code, 0);  // the limits of its base
    here_.write("typed.toml",
                "schema = 1\nname = \"x\"\n[payload]\nmass = 5\n[release]\nheight = 200\nspeed = 20\n"
                "path_angle = 1\n[[parachute]]\ntype = \"cross\"\nnominal_diameter = 2\nmass = 1\n"
                "deploy.by = \"line-stretch\"\n[size]\n");
    refused({"size", "typed.toml"}, "no limit is given");
}

TEST_F(SystemSize, SeriesAreSizedCaseByCase) {
    here_.write("series.toml", "base = \"" + rocket +
                                   "\"\n[[case]]\nname = \"light\"\nset = { \"payload.mass\" = \"5 lb\" }\n"
                                   "[[case]]\nname = \"heavy\"\nset = { \"payload.mass\" = \"20 lb\" }\n");
    const Ended ended = run({"size", "series.toml", "--json", "--out", "sized.toml"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    const json all = json::parse(ended.out);
    ASSERT_EQ(all.size(), 2u);
    const auto diameter = [&](int i) {
        return all[i]["candidates"][0]["varied"]["nominal_diameter"]["value"].get<double>();
    };
    EXPECT_NEAR(diameter(1) / diameter(0), 2.0, 0.05);  // weight goes with D0^2, but for the canopy's own
    EXPECT_TRUE(tree_of(here_.path()).contains("heavy/sized.toml"));
}

TEST_F(SystemSize, IsWhatTheSchemaSays) {
    const std::string types = "size.types=[\"flat-circular\", \"ringslot\", \"hemisflo\"]";
    here_.write("met.json", run({"size", rocket, "--json", "--set", types}).out);
    here_.write("missed.json", run({"size", rocket, "--json", "--set", "size.max_force=300 N"}).out);
    const std::string schema = TWINCHUTE_SOURCE_DIR "/docs/schema/size.schema.json";
    const Ended ended =
        run_script("tests/support/check_schema.py", {schema, "met.json", "missed.json"}, here_.path());
    if (lacks_python(ended)) GTEST_SKIP() << "no Python with jsonschema (Debian: python3-jsonschema)";
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    json wrong = json::parse(content_of(here_ / "met.json"));
    wrong["candidates"][0]["unheard_of"] = 1;
    here_.write("wrong.json", wrong.dump());
    EXPECT_EQ(run_script("tests/support/check_schema.py", {schema, "wrong.json"}, here_.path()).code, 1);
}

TEST_F(SystemSize, ListsTheTypes) {
    const Ended ended = run({"list", "types"});
    EXPECT_EQ(ended.code, 0);
    for (const char* what : {"flat-circular", "0.75-0.8 (A)", "disk-gap-band", "0.52-0.58 (R)"})
        EXPECT_TRUE(says(ended.out, what)) << ended.out;
    EXPECT_EQ(json::parse(run({"list", "types", "--json"}).out).size(), 20u);
    EXPECT_FALSE(says(run({"list", "parachutes"}).out, "types/"));
}

TEST_F(SystemSize, TheFullModelSaysWhatAMinimalSceneLacks) {
    const Ended ended = run({"full", rocket});
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(says(ended.err, "it needs 'parachute.gores'")) << ended.err;
    EXPECT_TRUE(says(ended.err, "run it with `twinchute rom`")) << ended.err;
    const Ended mesh = run({"mesh", rocket});
    EXPECT_EQ(mesh.code, 2);
    EXPECT_TRUE(says(mesh.err, "the parachute has no structure to mesh (it needs 'parachute.gores'"))
        << mesh.err;
    EXPECT_TRUE(nothing_written());
}

}  // namespace
}  // namespace twinchute::test
