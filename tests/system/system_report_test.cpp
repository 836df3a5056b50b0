// `twinchute report`: what compare wrote, again from its records.
#include <fmt/format.h>

#include <map>

#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemReport : public ShortScene {
protected:
    SystemReport() {
        here_.write("scene.toml",
                    "base = \"c9-inflation.toml\"\n"
                    "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\n"
                    "stop.time = 1.7\n"
                    "[compare.tolerance]\n"
                    "peak_force = \"1000 %\"\n"  // of a moment on a coarse mesh
                    "descent_rate = \"12.5 ft/s\"\n"
                    "max_line_tension = \"3 kN\"\n"  // which one side lacks
                    "projected_diameter_ratio = \"0.5\"\n");
    }
    /// All but the records.
    void remove_report(const std::string& directory) const {
        for (const char* name :
             {"gap.json", "report.html", "report.md", "junit.xml", "force.svg", "speed.svg"})
            std::filesystem::remove(here_ / (directory + "/" + name));
    }
};

TEST_F(SystemReport, IsTheOneThatCompareWroteByteForByte) {
    const Ended compared =
        run({"compare", "scene.toml", "--json", "--out", "out", "--tolerance", "max_force=0%"});
    EXPECT_EQ(compared.code, 1) << compared.err;
    const auto before = files("out");
    ASSERT_EQ(before.size(), 13u);
    remove_report("out");
    const Ended again = run({"report", "out", "--json"});
    EXPECT_EQ(again.code, 1) << again.err;
    EXPECT_EQ(again.err, "");
    EXPECT_EQ(again.out, compared.out);
    EXPECT_EQ(files("out"), before);  // the records are as they were, too
    EXPECT_EQ(read("out/gap.json")["metrics"]["max_force_N"]["tolerance"]["value"], 0);
    EXPECT_EQ(read("out/gap.json")["metrics"]["max_line_tension_N"]["verdict"], "missing");

    EXPECT_EQ(run({"report", "out/", "--quiet"}).out, "");
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemReport, PrintsWhatComparePrints) {
    const Ended compared = run({"compare", "scene.toml", "--out", "out"});
    const Ended again = run({"report", "out"});
    EXPECT_EQ(again.out, compared.out);
    EXPECT_EQ(again.code, compared.code);
}

TEST_F(SystemReport, APredictedFillingStandsBesideItsBracket) {
    const Ended compared = run({"compare", "scene.toml", "--out", "out", "--set", "stop.time=2", "--set",
                                "parachute.filling={model='predicted',initial_mouth=0.02}"});
    EXPECT_LT(compared.code, 2) << compared.err;
    const auto before = files("out");
    for (const char* side : {"rom", "full"})
        for (const char* mouth : {"0.002", "0.04"})
            EXPECT_NE(compared.out.find(fmt::format("bracket   {}: initial mouth {}:", side, mouth)),
                      std::string::npos)
                << compared.out;
    for (const char* page : {"out/report.html", "out/report.md"})
        EXPECT_NE(before.at(std::string(page).substr(4)).find("Predicted filling"), std::string::npos);
    // It comes back from the records as it was.
    remove_report("out");
    EXPECT_EQ(run({"report", "out"}).out, compared.out);
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemReport, FramesThatWereCutOrAreGone) {
    ASSERT_LT(run({"compare", "scene.toml", "--quiet", "--out", "out"}).code, 2);
    const auto before = files("out");
    const std::string frames = before.at("full/frames.bin");
    here_.write("out/full/frames.bin", frames.substr(0, frames.size() - 1));
    const Ended cut = run({"report", "out"});
    EXPECT_EQ(cut.code, 2);
    EXPECT_EQ(
        cut.err,
        "twinchute: out/full/frames.bin: is not the file that this record was written with (its SHA-256 is "
        "not the one in summary.json: it was edited or cut short), run the scene again\n");
    EXPECT_EQ(content_of(here_ / "out/report.html"), before.at("report.html"));  // nothing was written
    std::filesystem::remove(here_ / "out/full/frames.bin");
    EXPECT_EQ(run({"report", "out", "--quiet"}).code, 2);  // its checksum is in the summary
    // A record of a version that had none says nothing of it.
    auto summary = nlohmann::json::parse(before.at("full/summary.json"));
    summary["files"].erase("frames.bin");
    write_without_checksum("out/full/summary.json", summary);
    EXPECT_LT(run({"report", "out", "--quiet"}).code, 2);
    const std::string page = content_of(here_ / "out/report.html");
    EXPECT_EQ(page.find("id=\"canopy-section\""), page.npos);
    EXPECT_NE(page.find("id=\"histories\""), page.npos);
}

TEST_F(SystemReport, AWholeOpeningIsRemadeAsItWas) {
    const std::string opening = shipped_scene("c9-inflation");
    const Ended compared = run({"compare", opening, "--quiet", "--set", "full.mesh.gore_columns=1", "--set",
                                "full.mesh.gore_rows=4", "--out", "out"});
    const auto before = files("out");
    remove_report("out");
    EXPECT_EQ(run({"report", "out", "--quiet"}).code, compared.code);
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemReport, ARunThatBrokeOffIsRemadeAsItWas) {
    const Ended compared = run({"compare", "scene.toml", "--out", "out", "--set", "full.strain_limit=1e-6"});
    EXPECT_EQ(compared.code, 3);
    const auto before = files("out");
    remove_report("out");
    EXPECT_EQ(run({"report", "out"}).code, 3);
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemReport, AnotherToleranceIsAnotherVerdictAndIsNotRemembered) {
    ASSERT_EQ(
        run({"compare", "scene.toml", "--quiet", "--out", "out", "--tolerance", "max_line_tension=1N"}).code,
        1);
    const auto before = files("out");
    const Ended narrow = run({"report", "out", "--json", "--tolerance", "max_force=0%"});
    EXPECT_EQ(narrow.code, 1) << narrow.err;
    EXPECT_EQ(json::parse(narrow.out)["metrics"]["max_force_N"]["verdict"], "exceeded");
    EXPECT_EQ(json::parse(narrow.out), printed("out/gap.json"));
    EXPECT_EQ(json::parse(narrow.out)["metrics"]["peak_force_N"]["tolerance"]["value"], 10);
    EXPECT_EQ(run({"report", "out", "--quiet"}).code, 1);
    EXPECT_EQ(files("out"), before);
    for (const Words& words : {Words{"report", "out", "--tolerance", "peak_force"},
                               Words{"report", "out", "--tolerance", "peak_force=5s"},
                               Words{"report", "out", "--tolerance", "peak_force=-5%"},
                               Words{"report", "out", "--tolerance", "payload.mass=5%"}}) {
        const Ended wrong = run(words);
        EXPECT_EQ(wrong.code, 2);
        EXPECT_NE(wrong.err, "");
    }
    EXPECT_EQ(files("out"), before);
}

TEST_F(SystemReport, OptionsThatWouldDoNothingAreRefused) {
    // A gate on the record of one model would never fail.
    run({"compare", "scene.toml", "--quiet", "--out", "both"});
    const Ended one = run({"report", "both/full", "--tolerance", "peak_force=1%"});
    EXPECT_EQ(one.code, 2);
    EXPECT_NE(one.err.find("is the record of one model"), std::string::npos) << one.err;
    EXPECT_EQ(run({"report", "both/full"}).code, 0);
}

TEST_F(SystemReport, SaysWhereEachToleranceIsFrom) {
    run({"compare", "scene.toml", "--quiet", "--out", "out", "--tolerance", "max_force=0%", "--tolerance",
         "force_history=0%", "--set", "compare.tolerance.speed_history=500%", "--set",
         "compare.tolerance={impulse=\"0 %\"}"});
    const auto from = [&](const std::string& metric) {
        return read("out/gap.json")["metrics"][metric]["tolerance"]["from"].get<std::string>();
    };
    const auto all = [&](const std::string& peak) {
        EXPECT_EQ(from("peak_force_N"), peak);
        EXPECT_EQ(from("projected_diameter_ratio"), "scene");
        EXPECT_EQ(from("max_force_N"), "command line");
        EXPECT_EQ(from("impulse_N_s"), "command line");
        const json histories = read("out/gap.json")["histories"];
        EXPECT_EQ(histories["force_history"]["tolerance_from"], "command line");
        EXPECT_EQ(histories["speed_history"]["tolerance_from"], "command line");
    };
    all("scene");
    const auto before = files("out");
    const std::string page = before.at("report.html"), markdown = before.at("report.md"),
                      junit = before.at("junit.xml");
    EXPECT_NE(page.find("tolerance \u00b11000 %, of the scene"), page.npos);
    EXPECT_NE(page.find("tolerance 0: any difference counts, from the command line"), page.npos);
    EXPECT_NE(markdown.find("| 1000 % (scene) |"), markdown.npos) << markdown;
    EXPECT_NE(markdown.find("| 0 % (command line) |"), markdown.npos) << markdown;  // of the history
    EXPECT_NE(junit.find("tolerance 0 % (from the command line)"), junit.npos) << junit;
    const std::size_t history = junit.find("Opening force over time");
    ASSERT_NE(history, junit.npos) << junit;
    EXPECT_NE(junit.find("tolerance 0 % (from the command line)", history), junit.npos) << junit;
    remove_report("out");
    run({"report", "out", "--quiet"});
    EXPECT_EQ(files("out"), before);  // the records know
    run({"report", "out", "--quiet", "--tolerance", "peak_force=0.1%"});
    all("command line");
    EXPECT_NE(content_of(here_ / "out/junit.xml").find("tolerance 0.1 % (from the command line)"),
              junit.npos);

    const std::string demo = shipped_scene("c9-inflation");
    run({"compare", demo, "--quiet", "--out", "out", "--set", "full.mesh={gore_columns=1, gore_rows=4}"});
    EXPECT_EQ(from("filling_time_s"), "default");
    EXPECT_EQ(from("peak_force_N"), "scene");  // the demo has one of its own
    EXPECT_NE(content_of(here_ / "out/report.html").find("tolerance \u00b110 %, by default"), page.npos);
}

TEST_F(SystemReport, TakesSeveralDirectoriesAndSeries) {
    here_.write(
        "series.toml",
        "base = \"scene.toml\"\n[[case]]\nname = \"b\"\nset = { compare.tolerance.max_force = \"0 %\" }\n"
        "[[case]]\nname = \"a\"\nset = { compare.tolerance.max_line_tension = \"1 N\" }\n");
    run({"compare", "series.toml", "--quiet", "--out", "s"});
    run({"rom", "scene.toml", "--quiet", "--out", "s/not-a-comparison"});
    run({"compare", "scene.toml", "--quiet", "--out", "one"});
    const auto series = files("s"), one = files("one");
    for (const char* place : {"s/a", "s/b", "one"})
        remove_report(place);
    const Ended all = run({"report", "one", "s", "one", "--json"});
    EXPECT_EQ(all.code, 1) << all.err;
    EXPECT_EQ(files("s"), series);
    EXPECT_EQ(files("one"), one);
    const json gaps = json::parse(all.out);
    ASSERT_EQ(gaps.size(), 3u);  // each once
    EXPECT_EQ(gaps[0], printed("one/gap.json"));
    EXPECT_EQ(gaps[1], printed("s/a/gap.json"));
    EXPECT_EQ(gaps[2], printed("s/b/gap.json"));
    EXPECT_EQ(run({"report", "one", "./one/", "--quiet"}).code, 1);  // the same under two names
    EXPECT_EQ(files("one"), one);
}

TEST_F(SystemReport, BadRecordsAreExitTwoAndChangeNothing) {
    run({"compare", "scene.toml", "--quiet", "--out", "good"});
    const auto breaking = [&](const std::string& what, const auto& change) {
        std::filesystem::remove_all(here_ / "bad");
        std::filesystem::copy(here_ / "good", here_ / "bad", std::filesystem::copy_options::recursive);
        change();
        remove_report("good");  // would come back if the good one were written before the bad one is read
        const auto before = files("bad");
        const Ended ended = run({"report", "good", "bad"});
        EXPECT_EQ(ended.code, 2) << what;
        EXPECT_EQ(ended.out, "") << what;
        EXPECT_NE(ended.err.find(what), std::string::npos) << what << "\n" << ended.err;
        EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
        EXPECT_EQ(files("bad"), before) << what;
        EXPECT_FALSE(std::filesystem::exists(here_ / "good/gap.json")) << what;
    };
    const std::string rom = "bad/rom/summary.json", full = "bad/full/summary.json";
    const auto with = [&](const std::string& file, const std::string& pointer, const json& value) {
        return [this, file, pointer, value] {
            json content = read(file);
            content[json::json_pointer(pointer)] = value;
            write_without_checksum(file, content);
        };
    };
    breaking("'bad' holds no comparison", [&] {
        std::filesystem::remove(here_ / rom);
        std::filesystem::remove(here_ / full);
    });
    breaking("bad/full: is not a record (there is no summary.json in it)",
             [&] { std::filesystem::remove(here_ / full); });
    breaking("bad/rom/history.csv:3:1: 'x' is not a number",
             [&] { here_.write("bad/rom/history.csv", "time\ns\nx\n"); });
    breaking("summary.json: fidelity", with(rom, "/fidelity", 3));
    breaking("is not a record of rom (it says that it is of 'full')", with(rom, "/fidelity", "full"));
    breaking("is not a record of rom", with(rom, "/fidelity", "../../x"));
    breaking("bad: its two records are not of one scene (the SHA-256", with(rom, "/scene/sha256", "ff"));
    breaking("they differ in payload.mass", with(rom, "/inputs/payload.mass/value", 3));
    breaking("schema: 2 is not known", with(full, "/schema", 2));
    breaking("status.code: 'splendid' is not known", with(full, "/status/code", "splendid"));
    const std::string tolerance = "/inputs/compare.tolerance.peak_force/value";
    const auto both = [&](const json& value) {
        return [&, value] {
            with(rom, tolerance, value)();
            with(full, tolerance, value)();
        };
    };
    breaking("bad/full/summary.json: inputs.compare.tolerance.peak_force: is not a tolerance", both("10 s"));
    breaking("is not a tolerance", both(10));
    breaking("is not a tolerance", both("10 %\" # \""));
    breaking("is not a tolerance", both("-1 %"));
    EXPECT_EQ(run({"report", "nowhere"}).code, 2);
    EXPECT_EQ(run({"report"}).code, 2);
    EXPECT_EQ(run({"report", "good", "--check"}).code, 2);
    EXPECT_EQ(run({"report", "good", "--quiet"}).code, 1);
}

TEST_F(SystemReport, ARecordOfALaterVersionIsRead) {
    run({"compare", "scene.toml", "--quiet", "--out", "out"});
    const auto before = files("out");
    for (const std::string file : {"out/rom/summary.json", "out/full/summary.json"}) {
        auto content = nlohmann::ordered_json::parse(content_of(here_ / file));
        content["later"] = {1, 2, 3};
        content["provenance"]["later"] = "words";
        write_without_checksum(file, content);
    }
    const Ended again = run({"report", "out", "--quiet"});
    EXPECT_EQ(again.err, "");
    for (const char* name : {"gap.json", "report.html", "report.md", "junit.xml", "force.svg", "speed.svg"})
        EXPECT_EQ(content_of(here_ / ("out/" + std::string(name))), before.at(name)) << name;
}

}  // namespace
}  // namespace twinchute::test
