// `twinchute compare --why`: in the files, on the terminal, and back again by `twinchute report`.
#include <map>

#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemWhy : public ShortScene {
protected:
    SystemWhy() {
        here_.write("scene.toml",
                    "base = \"c9-inflation.toml\"\n"
                    "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\n"
                    "full.noise = { amplitude = \"0.1 mm\", seed = 5 }\n"
                    "stop.time = 1.7\n"
                    "[compare.tolerance]\n"
                    "peak_force = \"1000 %\"\n"  // of a coarse mesh
                    "time_to_peak_force = \"1000 %\"\n");
    }
};

TEST_F(SystemWhy, AddsUpInTheFilesAndIsMadeAgainFromThemByteForByte) {
    const Ended compared = run({"compare", "scene.toml", "--why", "--seeds", "3", "--out", "out"});
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_NE(compared.out.find("+ Added mass"), std::string::npos) << compared.out;
    const json gap = json::parse(content_of(here_ / "out/gap.json"));
    const json& why = gap["attribution"];
    EXPECT_EQ(why["seeds"], (json{5, 6, 7}));
    const json& peak = why["metrics"]["peak_force_N"];
    double sum = peak["candidate"].get<double>() + peak["interaction"].get<double>();
    for (const json& term : peak["terms"])
        sum += term["effect"].get<double>();
    EXPECT_NEAR(sum, peak["reference"].get<double>(), 1e-6 * sum);
    EXPECT_EQ(peak["reference"], gap["metrics"]["peak_force_N"]["reference"]);
    EXPECT_GT(peak["scatter"].get<double>(), 0.0);
    const auto before = files("out");
    EXPECT_NE(before.at("report.md").find("## Why"), std::string::npos);

    for (const char* name : {"report.md", "junit.xml", "force.svg", "speed.svg"})
        std::filesystem::remove(here_ / ("out/" + std::string(name)));
    const Ended again = run({"report", "out"});
    EXPECT_EQ(again.err, "");
    EXPECT_EQ(again.out, compared.out);
    EXPECT_EQ(files("out"), before);
    // Any number of threads gives the same.
    run({"compare", "scene.toml", "--why", "--seeds", "3", "--threads", "1", "--quiet", "--out", "one"});
    EXPECT_EQ(json::parse(content_of(here_ / "one/gap.json"))["attribution"], why);
}

TEST_F(SystemWhy, IsAskedForAndOnlyThen) {
    ASSERT_EQ(run({"compare", "scene.toml", "--quiet", "--out", "out"}).code, 0);
    EXPECT_FALSE(json::parse(content_of(here_ / "out/gap.json")).contains("attribution"));
    const Ended lonely = run({"compare", "scene.toml", "--seeds", "3", "--out", "no"});
    EXPECT_EQ(lonely.code, 2);
    EXPECT_NE(lonely.err.find("--seeds is for the runs of --why"), std::string::npos) << lonely.err;
    EXPECT_EQ(run({"compare", "scene.toml", "--why", "--seeds", "0", "--out", "no"}).code, 2);
    EXPECT_FALSE(std::filesystem::exists(here_ / "no"));
}

TEST_F(SystemWhy, AnEditedGapIsRefusedAndNothingIsChanged) {
    ASSERT_EQ(run({"compare", "scene.toml", "--why", "--seeds", "1", "--quiet", "--out", "out"}).code, 0);
    const json good = json::parse(content_of(here_ / "out/gap.json"));
    const auto refused = [&](const std::string& text, const std::string& what) {
        here_.write("out/gap.json", text);
        const auto before = files("out");
        const Ended ended = run({"report", "out"});
        EXPECT_EQ(ended.code, 2) << what;
        EXPECT_NE(ended.err.find(what), std::string::npos) << ended.err;
        EXPECT_NE(ended.err.find("out/gap.json"), std::string::npos) << ended.err;
        EXPECT_EQ(files("out"), before);
    };
    const auto with = [&](const char* pointer, const json& value) {
        json changed = good;
        changed[json::json_pointer(pointer)] = value;
        return changed.dump();
    };
    const std::string peak = "/attribution/metrics/peak_force_N";
    refused(with((peak + "/reference").c_str(), 1.0), "is not what the record says (peak_force_N of full)");
    refused(with((peak + "/candidate").c_str(), 1.0), "is not what the record says (peak_force_N of rom)");
    refused(with((peak + "/interaction").c_str(), 1e9), "does not add up");
    refused(with((peak + "/terms/0/effect").c_str(), "much"), "is text where a number belongs");
    refused(with("/attribution/notes", 3), "is a number where an array belongs");
    refused(with((peak + "/terms/0/title").c_str(), "Nothing"), "it was edited");
    refused(good.dump().substr(0, 200), "is not JSON");
    // Without the file there is nothing to say why, and nothing else is lost.
    std::filesystem::remove(here_ / "out/gap.json");
    EXPECT_EQ(run({"report", "out", "--quiet"}).code, 0);
    EXPECT_FALSE(json::parse(content_of(here_ / "out/gap.json")).contains("attribution"));
}

}  // namespace
}  // namespace twinchute::test
