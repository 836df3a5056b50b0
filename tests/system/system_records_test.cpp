// Many records in one table; names that mean something to a format; the files that describe and publish
// results.
#include <chrono>
#include <regex>
#include <sstream>

#include "tests/support/python.hpp"
#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemRecords : public ShortScene {
protected:
    static std::size_t lines(const std::string& text) {
        return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    }
};

TEST_F(SystemRecords, ManyAreARowEach) {
    run({"compare", "scene.toml", "--quiet", "--out", "a"});
    run({"compare", "scene.toml", "--quiet", "--out", "b", "--set", "payload.mass=160 kg"});
    run({"rom", "scene.toml", "--quiet", "--out", "one"});
    const auto before = files(".");
    const Ended table = run({"report", "a", "b", "one", "--out", "table"});
    EXPECT_EQ(table.err, "");
    EXPECT_EQ(table.code, 1);  // of the comparisons
    const auto all = read("table/records.json");
    ASSERT_EQ(all["records"].size(), 5u);
    EXPECT_EQ(all["records"][0]["record"], "a");
    EXPECT_EQ(all["records"][0]["fidelity"], "rom");
    EXPECT_EQ(all["records"][1]["fidelity"], "full");
    EXPECT_EQ(all["records"][4]["record"], "one");
    EXPECT_EQ(all["records"][3]["metrics"], read("b/full/summary.json")["metrics"]);

    const std::string csv = text("table/records.csv");
    EXPECT_EQ(lines(csv), 7u);  // names, units, rows
    EXPECT_TRUE(csv.starts_with("record,scene,fidelity,status,")) << csv;
    const std::string names = csv.substr(0, csv.find('\n'));
    const auto commas =
        [](std::string line) {  // that divide fields: the name of the scene has one of its own
            line = std::regex_replace(line, std::regex("\"[^\"]*\""), "");
            return std::count(line.begin(), line.end(), ',');
        };
    std::istringstream rows(csv);
    for (std::string row; std::getline(rows, row);)
        EXPECT_EQ(commas(row), commas(names)) << row;
    EXPECT_NE(names.find(",peak_force,"), std::string::npos);

    const std::string report = text("table/report.md");
    EXPECT_NE(report.find("peak force \\[N\\]"), std::string::npos) << report;
    EXPECT_NE(table.out.find("peak force [N]"), std::string::npos) << table.out;
    EXPECT_EQ(table.out.find('\x1b'), std::string::npos);  // no colour where nobody sees it
    EXPECT_NE(table.out.find("verdict   a: "), std::string::npos);
    for (const auto& [name, content] : before)
        EXPECT_EQ(text(name), content) << name;  // with --out nothing else is written

    const Ended again = run({"report", "a", "b", "one", "--quiet", "--out", "table"});  // over its own
    EXPECT_EQ(again.code, 1) << again.err;
    EXPECT_EQ(run({"report", "a", "b", "one", "--out", "table", "--json"}).code, 1);
    here_.write("foreign/file", "");
    EXPECT_EQ(run({"report", "a", "--out", "foreign"}).code, 2);
}

TEST_F(SystemRecords, AHundredTakeNoLongerThanPromised) {
    run({"compare", "scene.toml", "--quiet", "--out", "r/0"});
    for (int i = 1; i < 100; ++i)
        std::filesystem::copy(here_ / "r/0", here_ / ("r/" + std::to_string(i)),
                              std::filesystem::copy_options::recursive);
    // A hundred reports in 20 s is the promise. Small records: a gate against what grows with their number
    // squared.
    const auto start = std::chrono::steady_clock::now();
    const Ended all = run({"report", "r"});
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    EXPECT_EQ(all.err, "");
    EXPECT_EQ(lines(all.out), 1 + 200 + 1 + 100u) << all.out.substr(0, 2000);
}

TEST_F(SystemRecords, HostileNamesOfScenesAreEscapedInEveryFile) {
    const std::string name =
        "</script><script>alert(1)</script>\\\"'&]]>|`a`[x](y)*_#<!--\\u001b[31m\\u202e\xF0\x9F\xAA\x82";
    here_.write("a&b<c>'|`.toml", scene("name = \"" + name + "\"\n"));
    const Ended ended = run({"compare", "a&b<c>'|`.toml", "--out", "out"});
    EXPECT_EQ(ended.err, "");
    EXPECT_EQ(ended.out.find('\x1b'), std::string::npos);
    run({"compare", "a&b<c>'|`.toml", "--quiet", "--out", "old"});
    run({"compare", "a&b<c>'|`.toml", "--quiet", "--out", "out", "--baseline", "old"});
    run({"report", "out", "--quiet", "--out", "table"});
    for (const char* file : {"out/report.md", "out/trend.md", "out/junit.xml", "out/force.svg",
                             "out/speed.svg", "table/report.md"}) {
        const std::string content = text(file);
        EXPECT_EQ(content.find("<script"), std::string::npos) << file;
        EXPECT_EQ(content.find("<!--\x1b"), std::string::npos) << file;
        const bool is_markdown = std::string(file).ends_with(".md");
        EXPECT_EQ(is_markdown && content.find("[x](y)") != std::string::npos, false) << file;
        EXPECT_EQ(content.find('\x1b'), std::string::npos) << file;
        EXPECT_NE(content.find("alert(1)"), std::string::npos) << file;  // escaped and not lost
    }
    // As it was given, in the formats that carry any text.
    EXPECT_EQ(read("out/gap.json")["scene"]["name"], read("table/records.json")["records"][0]["scene"]);
    EXPECT_TRUE(read("out/gap.json")["scene"]["name"].get<std::string>().starts_with("</script><script>"));
    EXPECT_EQ(read("out/gap.json")["scene"]["file"], "a&b<c>'|`.toml");
}

TEST_F(SystemRecords, NamesThatLookLikePathsLeadNowhere) {
    const auto before = tree_of(here_.path());
    for (const char* name : {"../../escape", "/tmp/twinchute-escape", "a/../../b", "..", "~"}) {
        here_.write("scene.toml", scene(std::string("name = \"") + name + "\"\n"));
        EXPECT_EQ(run({"compare", "scene.toml", "--quiet"}).err, "") << name;
        std::set<std::string> outside;
        for (const std::string& file : tree_of(here_.path()))
            if (!file.starts_with("scene.out") && !before.contains(file)) outside.insert(file);
        EXPECT_EQ(outside, std::set<std::string>{}) << name;
        EXPECT_EQ(read("scene.out/gap.json")["scene"]["name"], name);
    }
    EXPECT_FALSE(std::filesystem::exists("/tmp/twinchute-escape"));
    for (const char* name : {"../x", "a/b", "..", "", "/tmp/twinchute-escape", ".hidden"}) {
        here_.write("series.toml",
                    "base = \"scene.toml\"\n[[case]]\nname = \"" + std::string(name) + "\"\nset = {}\n");
        EXPECT_EQ(run({"compare", "series.toml", "--out", "s"}).code, 2) << name;
        EXPECT_FALSE(std::filesystem::exists(here_ / "s")) << name;
    }
}

TEST_F(SystemRecords, NamesThatAreNoTextAreRefusedAndLongOnesAreKept) {
    for (const std::string bytes : {"\xff", "\xc0\xaf", "\xed\xa0\x80",
                                    "a\x01"
                                    "b"}) {
        here_.write("bad.toml", scene("name = \"x" + bytes + "\"\n"));
        const Ended ended = run({"compare", "bad.toml", "--out", "bad"});
        EXPECT_EQ(ended.code, 2) << ended.out;
        EXPECT_NE(ended.err.find("bad.toml:2:"), std::string::npos) << ended.err;
        EXPECT_FALSE(std::filesystem::exists(here_ / "bad"));
    }
    const std::string longest(100'000, 'n');
    here_.write("long.toml", scene("name = \"" + longest + "\"\n"));
    run({"compare", "long.toml", "--quiet", "--out", "long"});
    EXPECT_EQ(read("long/gap.json")["scene"]["name"], longest);
    EXPECT_EQ(run({"report", "long", "--quiet"}).err, "");
}

TEST_F(SystemRecords, AnEditedOrTruncatedRecordIsRefusedByName) {
    run({"compare", "scene.toml", "--quiet", "--out", "good"});
    const auto refused = [&](const std::string& file, const std::string& content) {
        std::filesystem::remove_all(here_ / "bad");
        std::filesystem::copy(here_ / "good", here_ / "bad", std::filesystem::copy_options::recursive);
        here_.write("bad/" + file, content);
        const Ended ended = run({"report", "bad"});
        EXPECT_EQ(ended.code, 2) << file;
        EXPECT_NE(ended.err.find("bad/" + file), std::string::npos) << ended.err;
        return ended.err;
    };
    for (const std::string file :
         {"rom/history.csv", "full/history.csv", "rom/events.csv", "full/events.csv"}) {
        const std::string whole = text("good/" + file);
        const std::string last_line = whole.substr(whole.rfind('\n', whole.size() - 2) + 1);
        // Still a table, one row shorter: only the sum tells.
        EXPECT_NE(refused(file, whole.substr(0, whole.size() - last_line.size()))
                      .find("it was edited or cut short"),
                  std::string::npos);
        EXPECT_NE(refused(file, whole + last_line).find(file), std::string::npos);
    }
    const std::string summary = text("good/rom/summary.json");
    refused("rom/summary.json", summary.substr(0, summary.size() / 2));
    // A record of an earlier version has no checksum and is read.
    auto old = nlohmann::ordered_json::parse(summary);
    old.erase("files");
    refused("rom/summary.json", old.dump(2));  // the checksum is still there
    std::filesystem::remove_all(here_ / "bad");
    std::filesystem::copy(here_ / "good", here_ / "bad", std::filesystem::copy_options::recursive);
    write_without_checksum("bad/rom/summary.json", old);
    EXPECT_EQ(run({"report", "bad", "--quiet"}).err, "");
}

TEST_F(SystemRecords, ATestIsDrawnBesideBothOrRefusedBeforeAnythingRuns) {
    here_.write("good.csv", "time,force\ns,lbf\n0,0\n0.5,100\n1,90\n");
    here_.write("bad.csv", "time,force\ns,kg\n0,0\n1,1\n");
    const Ended bad = run({"compare", "scene.toml", "--out", "out", "--test", "bad.csv"});
    EXPECT_EQ(bad.code, 2);
    EXPECT_NE(bad.err.find("bad.csv:2:3"), std::string::npos) << bad.err;
    EXPECT_EQ(run({"compare", "scene.toml", "--check", "--test", "bad.csv"}).code, 2);
    EXPECT_FALSE(std::filesystem::exists(here_ / "out"));
    here_.write("early.csv", "time,force\n-3,1\n-2,1\n");
    const Ended early = run({"compare", "scene.toml", "--out", "out", "--test", "early.csv"});
    EXPECT_EQ(early.code, 2);
    EXPECT_NE(early.err.find("early.csv:3:1: the history lies wholly before the release"), std::string::npos)
        << early.err;
    const Ended clock = run({"compare", "scene.toml", "--test", "good.csv", "--test-clock", "soon"});
    EXPECT_EQ(clock.code, 2);
    EXPECT_NE(clock.err.find("--test-clock soon: "), std::string::npos) << clock.err;
    EXPECT_EQ(run({"compare", "scene.toml", "--test-clock", "1 s"}).code, 2);
    EXPECT_FALSE(std::filesystem::exists(here_ / "out"));
    const Ended good = run({"compare", "scene.toml", "--out", "out", "--test", "good.csv"});
    EXPECT_NE(good.out.find("444.8 N"), std::string::npos) << good.out;
    EXPECT_NE(text("out/report.md").find("## Test"), std::string::npos);
    // Made again without it the reports know nothing of it, and of another one what that says.
    run({"report", "out", "--quiet"});
    EXPECT_EQ(text("out/report.md").find("## Test"), std::string::npos);
    run({"report", "out", "--quiet", "--test", "good.csv"});
    EXPECT_NE(text("out/gap.json").find("\"good.csv\""), std::string::npos);
}

TEST_F(SystemRecords, AnEditedSummaryIsRefusedWhereverItIsRead) {
    run({"compare", "scene.toml", "--quiet", "--out", "out"});
    std::string summary = text("out/full/summary.json");
    const std::string mass = "\"value\": 152.4";
    ASSERT_NE(summary.find(mass), std::string::npos);
    here_.write("out/full/summary.json",
                summary.replace(summary.find(mass), mass.size(), "\"value\": 152.5"));
    const auto before = files("out");
    for (const Words& words : {Words{"report", "out"},
                               {"report", "out/full"},
                               {"report", "out", "--out", "new"},
                               {"compare", "scene.toml", "--out", "new", "--baseline", "out"}}) {
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << testing::PrintToString(words);
        EXPECT_TRUE(ended.err.starts_with(
            "twinchute: out/full/summary.json: is not the file that was written (its SHA-256 without"))
            << ended.err;
        EXPECT_FALSE(std::filesystem::exists(here_ / "new"));
    }
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemRecords, PythonVerifiesAChecksumInThreeLines) {
    run({"compare", "scene.toml", "--quiet", "--out", "out"});
    // As docs/guide/ci.md has them.
    const std::string guide = content_of(TWINCHUTE_SOURCE_DIR "/docs/guide/ci.md");
    const std::string begin = "```python\n";
    const std::size_t from = guide.find(begin) + begin.size();
    const std::string lines_of_guide = guide.substr(from, guide.find("```", from) - from);
    EXPECT_EQ(lines(lines_of_guide), 4u) << lines_of_guide;  // an import, and three
    for (const std::string file : {"out/rom/summary.json", "out/full/summary.json", "out/gap.json"}) {
        const auto check = [&](const std::string& content) {
            here_.write("summary.json", content);
            return Process({"/usr/bin/env", "python3", "-c", lines_of_guide}, here_.path()).wait();
        };
        const Ended good = check(text(file));
        if (lacks_python(good)) GTEST_SKIP() << "no Python";
        EXPECT_EQ(good.code, 0) << good.err;
        std::string edited = text(file);
        EXPECT_EQ(check(edited.replace(edited.find("twinchute"), 1, "T")).code, 1);
    }
}

TEST_F(SystemRecords, AreWhatTheSchemasSay) {
    run({"compare", "scene.toml", "--quiet", "--out", "out", "--tolerance", "force_history=5%"});
    const std::string opening = shipped_scene("c9-inflation");
    run({"compare", opening, "--quiet", "--out", "whole", "--set", "full.mesh.gore_columns=1", "--set",
         "full.mesh.gore_rows=4"});
    here_.write("trend.json", run({"compare", "scene.toml", "--json", "--out", "new", "--set",
                                   "payload.mass=160 kg", "--baseline", "out"})
                                  .out);
    run({"compare", "scene.toml", "--quiet", "--out", "broken", "--set", "full.strain_limit=1e-6"});
    here_.write("drop.csv", "time,force,oops\n0,0,1\n0.5,100,2\n");
    run({"compare", "scene.toml", "--quiet", "--out", "tested", "--test", "drop.csv"});
    here_.write("printed.json", run({"full", "scene.toml", "--json", "--out", "f"}).out);
    const auto check = [&](const char* schema, Words names) {
        names.insert(names.begin(), std::string(TWINCHUTE_SOURCE_DIR "/docs/schema/") + schema);
        return run_script("tests/support/check_schema.py", names, here_.path());
    };
    const Ended gaps = check("gap.schema.json", {"out/gap.json", "whole/gap.json", "broken/gap.json",
                                                 "trend.json", "tested/gap.json"});
    if (lacks_python(gaps)) GTEST_SKIP() << "no Python with jsonschema (Debian: python3-jsonschema)";
    EXPECT_EQ(gaps.code, 0) << gaps.out << gaps.err;
    const Ended summaries = check("summary.schema.json",
                                  {"out/rom/summary.json", "out/full/summary.json", "whole/rom/summary.json",
                                   "whole/full/summary.json", "broken/full/summary.json", "printed.json"});
    EXPECT_EQ(summaries.code, 0) << summaries.out << summaries.err;
    // The check itself finds what is wrong.
    auto gap = read("out/gap.json");
    gap["metrics"]["peak_force_N"]["verdict"] = "splendid";
    here_.write("wrong.json", gap.dump());
    EXPECT_EQ(check("gap.schema.json", {"wrong.json"}).code, 1);
    auto summary = read("out/rom/summary.json");
    summary["unheard_of"] = 1;
    here_.write("wrong.json", summary.dump());
    EXPECT_EQ(check("summary.schema.json", {"wrong.json"}).code, 1);
}

class SystemCi : public ShortScene {
protected:
    const std::string ci_ = TWINCHUTE_SOURCE_DIR "/docs/guide/ci/";
    Ended gate(Words words) {
        words.insert(words.begin(),
                     {"/usr/bin/env", "TWINCHUTE=" TWINCHUTE_PROGRAM, "bash", ci_ + "compare-scenes"});
        return Process(words, here_.path()).wait();
    }
};

TEST_F(SystemCi, ShippedFilesAreWhatTheirServicesAskFor) {
    for (const std::string kind : {"github", "gitlab"}) {
        const auto check = [&](const std::string& file) {
            return run_script("tests/support/check_ci.py", {kind, file}, here_.path());
        };
        const std::string good = content_of(ci_ + kind + ".yml");
        const Ended ended = check(ci_ + kind + ".yml");
        if (lacks_python(ended)) GTEST_SKIP() << "no Python with yaml (Debian: python3-yaml)";
        EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
        // The check itself finds what is wrong.
        const auto broken = [&](const std::string& from, const std::string& to) {
            std::string text = good;
            const auto at = text.find(from);
            ASSERT_NE(at, std::string::npos) << kind << ": " << from;
            here_.write("broken.yml", text.replace(at, from.size(), to));
            EXPECT_EQ(check("broken.yml").code, 1) << kind << ": " << from << " -> " << to;
        };
        broken("compare-scenes \"$SCENES\"", "compare-scenes \"$SCENES");
        broken("results \"$BASELINES\"", "results \"$BASELINES\" || true");
        broken(kind == "github" ? "if: always()" : "when: always", "  : [");
        broken(kind == "github" ? "actions/upload-artifact@v4" : "results/*/junit.xml",
               kind == "github" ? "actions/upload-artifact" : "results/*/gap.json");
    }
}

TEST_F(SystemCi, TheGateRunsEveryScenePublishesAndFailsWithTheGravest) {
    const std::string top = scene("").substr(0, scene("").find("compare."));
    here_.write("scenes/good.toml", top +
                                        "compare.tolerance.peak_force = \"1000 %\"\n"
                                        "compare.tolerance.time_to_peak_force = \"1000 %\"\n");
    const Ended green = gate({"scenes", "results", "baselines"});  // no such baselines yet
    EXPECT_EQ(green.code, 0) << green.out << green.err;
    EXPECT_NE(text("results/summary.md")
                  .find("**within tolerance: 2 of 2 judged metrics, 2 not reached (filling\\_time, "
                        "descent\\_rate)**"),
              std::string::npos)
        << text("results/summary.md");
    EXPECT_EQ(text("results/summary.md").find("!["), std::string::npos);  // pictures would be broken there
    EXPECT_TRUE(std::filesystem::exists(here_ / "results/good/junit.xml"));

    std::filesystem::rename(here_ / "results", here_ / "baselines");
    here_.write("scenes/tight.toml", top + "compare.tolerance.peak_force = \"0 %\"\n");
    const Ended red = gate({"scenes", "results", "baselines"});
    EXPECT_EQ(red.code, 1) << red.out << red.err;
    const std::string summary = text("results/summary.md");
    EXPECT_NE(summary.find("tolerance not met"), std::string::npos) << summary;
    EXPECT_NE(summary.find("against a baseline"), std::string::npos) << summary;  // of the one that has one

    // A comparison that would replace its own baseline is refused before anything is deleted.
    std::filesystem::create_directory_symlink(here_ / "baselines", here_ / "link");
    const auto kept = files("baselines");
    for (const std::string same : {"baselines", "./scenes/../baselines/", "link"}) {
        const Ended refused = gate({"scenes", same, "baselines"});
        EXPECT_EQ(refused.code, 2) << same << refused.out;
        EXPECT_NE(refused.err.find("would replace the baselines"), std::string::npos) << refused.err;
        EXPECT_EQ(files("baselines"), kept) << same;
    }
    std::filesystem::create_directories(here_ / "good");
    std::filesystem::rename(here_ / "scenes", here_ / "good/scenes");
    const Ended inside = gate({"good/scenes", "."});  // ./good is deleted first
    EXPECT_EQ(inside.code, 2);
    EXPECT_NE(inside.err.find("holds the scenes"), std::string::npos) << inside.err;
    std::filesystem::rename(here_ / "good/scenes", here_ / "scenes");

    here_.write("scenes/broken.toml", "schema = 1\n");
    EXPECT_EQ(gate({"scenes", "results"}).code, 2);
    EXPECT_NE(text("results/summary.md").find("No report, exit code 2"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(here_ / "results/tight/junit.xml"));  // the others run all the same
    EXPECT_EQ(gate({"nowhere", "results"}).code, 2);  // a gate without scenes would pass for ever
    EXPECT_EQ(gate({}).code, 2);
}

}  // namespace
}  // namespace twinchute::test
