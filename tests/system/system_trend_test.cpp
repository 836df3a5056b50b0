// `twinchute compare --baseline`: this run against an earlier one.
#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemTrend : public ShortScene {
protected:
    SystemTrend() { run({"compare", "scene.toml", "--quiet", "--out", "old"}); }

    /// The exit code of the comparison alone: just past full open there is no descent rate, whose tolerance
    /// is then missing.
    static constexpr int comparison_code = 1;
    nlohmann::json trend(const Words& more) {
        Words words{"compare", "scene.toml", "--quiet", "--out", "new", "--baseline", "old"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = run(words);
        EXPECT_EQ(ended.err, "");
        return read("new/trend.json");
    }
    static const nlohmann::json* find(const nlohmann::json& trend, const std::string& fidelity,
                                      const std::string& key) {
        for (const auto& change : trend["changes"])
            if (change["fidelity"] == fidelity && change["metric"] == key) return &change;
        return nullptr;
    }
};

TEST_F(SystemTrend, TheSameSceneAndProgramHaveNotMoved) {
    const auto same = trend({});
    EXPECT_EQ(same["verdict"], "within") << same.dump(1);
    EXPECT_EQ(same["changes"].size(), 0u) << same["changes"].dump(1);
    EXPECT_EQ(same["judged"],
              5);  // the peak force and its time, of both, and the filling time that rom is told
    EXPECT_GT(same["compared"], 20);
    for (const char* what : {"inputs", "model", "machine"})
        EXPECT_EQ(same[what].size(), 0u) << same.dump(1);
}

TEST_F(SystemTrend, ABaselineIsNotWhereTheResultsGo) {
    // A run that fails against it would be the baseline of the next.
    for (const Words& more : {Words{"--out", "old"}, Words{"--out", "./new/../old/"}}) {
        Words words{"compare", "scene.toml", "--baseline", "old"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2);
        EXPECT_NE(ended.err.find("is where the results go"), std::string::npos) << ended.err;
    }
    EXPECT_FALSE(std::filesystem::exists(here_ / "old/trend.json"));
}

TEST_F(SystemTrend, AChangedInputIsNamedAndItsEffectJudged) {
    // A larger drag area at snatch slows the fall while the canopy fills: the peak is lower.
    const auto moved = trend({"--set", "parachute.initial_drag_area_ratio=0.0416"});
    ASSERT_EQ(moved["inputs"].size(), 1u) << moved["inputs"].dump(1);
    EXPECT_EQ(moved["inputs"][0]["what"], "parachute.initial_drag_area_ratio");
    EXPECT_EQ(moved["inputs"][0]["baseline"], "0.04");
    EXPECT_EQ(moved["inputs"][0]["now"], "0.0416");
    EXPECT_EQ(moved["verdict"], "exceeded");
    for (const char* fidelity : {"rom", "full"}) {
        const nlohmann::json* peak = find(moved, fidelity, "peak_force_N");
        ASSERT_NE(peak, nullptr) << fidelity;
        const std::string before = std::string("old/") + fidelity + "/summary.json",
                          now = std::string("new/") + fidelity + "/summary.json";
        const double was = read(before)["metrics"]["peak_force_N"], is = read(now)["metrics"]["peak_force_N"];
        EXPECT_EQ((*peak)["difference"], is - was);
        EXPECT_EQ((*peak)["relative"], (is - was) / was);
        EXPECT_LT((is - was) / was, -0.005) << fidelity;
        EXPECT_EQ((*peak)["verdict"], "exceeded");
        EXPECT_EQ((*peak)["tolerance"]["value"], 1e-3);
    }
    double before = std::numeric_limits<double>::infinity();  // most changed first
    for (const auto& change : moved["changes"]) {
        const double size = change.contains("relative") ? std::abs(change["relative"].get<double>()) : before;
        EXPECT_LE(size, before);
        before = size;
    }
    const std::string report = text("new/trend.md");
    EXPECT_NE(report.find("- input: parachute.initial\\_drag\\_area\\_ratio: 0.04 -&gt; 0.0416"),
              std::string::npos)
        << report;
    EXPECT_NE(report.find("**moved too far from the baseline: "), std::string::npos) << report;
}

TEST_F(SystemTrend, ATrendAloneMakesTheGateRed) {
    here_.write("gate.toml", scene("").substr(0, scene("").find("compare.")) +
                                 "compare.tolerance.peak_force = \"1000 %\"\n"
                                 "compare.tolerance.time_to_peak_force = \"1000 %\"\n");
    EXPECT_EQ(run({"compare", "gate.toml", "--quiet", "--out", "a"}).code, 0);
    const Words heavier{"compare", "gate.toml",           "--out",      "b",
                        "--set",   "payload.mass=150 kg", "--baseline", "a"};
    const auto with = [&](const std::string& tolerance) {
        Words words = heavier;
        for (const std::string& each : {tolerance, std::string("time_to_peak_force=100%")}) {
            words.push_back("--baseline-tolerance");
            words.push_back(each);
        }
        return run(words);
    };
    const Ended red = run(heavier);
    EXPECT_EQ(red.code, 1) << red.out;
    EXPECT_NE(red.out.find("within tolerance: 2 of 2"), std::string::npos) << red.out;  // of the gap
    EXPECT_NE(red.out.find("input     payload.mass: 152.4 kg -> 150 kg\n"), std::string::npos) << red.out;
    EXPECT_NE(red.out.find("trend     moved too far from the baseline: "), std::string::npos) << red.out;
    const Ended green = with("peak_force=5%");
    EXPECT_EQ(green.code, 0) << green.out;
    EXPECT_NE(green.out.find("trend     no judged metric moved beyond its tolerance (5 judged"),
              std::string::npos)
        << green.out;
    EXPECT_EQ(with("mass_ratio=1%").code, 1);  // judged because it is asked for
    EXPECT_EQ(run({"compare", "gate.toml", "--json", "--out", "b", "--baseline", "a"}).code, 0);
}

TEST_F(SystemTrend, OfAnotherProgramOnAnotherMachineSaysSo) {
    for (const char* side : {"rom", "full"}) {
        const std::string file = std::string("old/") + side + "/summary.json";
        auto summary = nlohmann::ordered_json::parse(text(file));
        summary["provenance"]["commit"] = "0123456789ab";
        summary["provenance"]["host_cpu"] = "another | processor";
        summary["metrics"].erase("load_factor");
        summary["metrics"]["gone_m"] = 1.0;
        summary["standing"]["gone_m"] = {{"input_or_result", "result"}};
        write_without_checksum(file, summary);
    }
    const auto other = trend({});
    EXPECT_EQ(other["model"][0]["what"], "commit");
    EXPECT_EQ(other["model"][0]["baseline"], "0123456789ab");
    EXPECT_EQ(other["machine"][0]["what"], "processor");
    EXPECT_EQ(other["verdict"], "within");  // neither metric that came and went is judged
    ASSERT_NE(find(other, "full", "gone_m"), nullptr);
    EXPECT_FALSE(find(other, "full", "gone_m")->contains("now"));
    ASSERT_NE(find(other, "rom", "load_factor"), nullptr);
    EXPECT_NE(text("new/trend.md").find("another \\| processor"), std::string::npos);
    // A judged metric that was there and is gone is as bad as one that moved.
    const Ended gone = run({"compare", "scene.toml", "--json", "--out", "new", "--baseline", "old",
                            "--tolerance", "load_factor=500%", "--baseline-tolerance", "load_factor=1%"});
    EXPECT_EQ(nlohmann::json::parse(gone.out)["trend"]["verdict"], "exceeded")
        << gone.out;  // asked for by name
    for (const char* side : {"rom", "full"}) {
        const std::string file = std::string("old/") + side + "/summary.json";
        auto summary = nlohmann::ordered_json::parse(text(file));
        summary["metrics"]["descent_rate_m_s"] = 7.0;
        summary["standing"]["descent_rate_m_s"] = {{"input_or_result", "result"}};
        write_without_checksum(file, summary);
    }
    EXPECT_EQ(trend({})["verdict"], "exceeded");
}

TEST_F(SystemTrend, WhatCannotBeHeldAgainstIsRefusedBeforeAnythingRuns) {
    const auto refused = [&](Words more, const std::string& why) {
        Words words{"compare", "scene.toml", "--out", "fresh"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << why;
        EXPECT_NE(ended.err.find(why), std::string::npos) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_FALSE(std::filesystem::exists(here_ / "fresh")) << why;
    };
    refused({"--baseline", "nowhere"}, "nowhere/rom: no such directory");
    refused({"--baseline-tolerance", "peak_force=1%"}, "--baseline-tolerance without --baseline");
    refused({"--baseline", "old", "--baseline-tolerance", "peak_force"},
            "'--baseline-tolerance peak_force' is not");
    refused({"--baseline", "old", "--baseline-tolerance", "peak=1%"}, "peak");
    here_.write("old/full/history.csv", text("old/full/history.csv") + "\n");
    refused({"--baseline", "old"}, "old/full/history.csv");
}

TEST_F(SystemTrend, WhatNobodyAskedForAndTheStopComesBeforeIsNotReached) {
    here_.write("plain.toml",
                "base = \"c9-inflation.toml\"\nstop.time = 1.7\n"
                "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\n"
                "compare.tolerance.peak_force = \"1000 %\"\n"
                "compare.tolerance.time_to_peak_force = \"1000 %\"\n");
    const Ended first = run({"compare", "plain.toml", "--out", "p"});
    EXPECT_EQ(first.code, 0) << first.out;
    EXPECT_NE(
        first.out.find("within tolerance: 2 of 2 judged metrics, 2 not reached (filling_time, descent_rate)"),
        std::string::npos)
        << first.out;
    EXPECT_EQ(read("p/gap.json")["metrics"]["descent_rate_m_s"]["verdict"], "not reached");
    EXPECT_EQ(read("p/rom/summary.json")["missing"][0]["not_reached"], true);
    for (const char* side : {"rom", "full"}) {
        const std::string file = std::string("p/") + side + "/summary.json";
        auto summary = nlohmann::ordered_json::parse(text(file));
        summary["metrics"]["descent_rate_m_s"] = 7.0;
        summary["standing"]["descent_rate_m_s"] = {{"input_or_result", "result"}};
        write_without_checksum(file, summary);
    }
    EXPECT_EQ(run({"compare", "plain.toml", "--quiet", "--out", "q", "--baseline", "p"}).code, 0);
    EXPECT_EQ(read("q/trend.json")["verdict"], "within");
    EXPECT_EQ(read("q/trend.json")["changes"][0]["verdict"], "not reached");
    // Without that stop's excuse it is gone: the payload is on the ground long before the canopy is full.
    const Ended low = run(
        {"compare", "plain.toml", "--out", "low", "--set", "release.height=0.5 m", "--set", "stop.time=5 s"});
    EXPECT_EQ(low.code, 1) << low.out;
    EXPECT_NE(low.out.find("4 missing (filling_time, peak_force, time_to_peak_force, descent_rate)"),
              std::string::npos)
        << low.out;
    EXPECT_NE(text("low/junit.xml")
                  .find("<failure type=\"missing\" message=\"Descent rate: neither side has it, "
                        "rom: the payload was on the ground before"),
              std::string::npos)
        << text("low/junit.xml");
}

TEST_F(SystemTrend, JunitIsRedWhenTheBaselineIsNotHeld) {
    run({"compare", "scene.toml", "--quiet", "--out", "new", "--baseline", "old", "--set",
         "payload.mass=160 kg", "--baseline-tolerance", "load_factor=0.01%"});
    EXPECT_EQ(read("new/trend.json")["verdict"], "exceeded");
    EXPECT_NE(text("new/junit.xml").find("name=\"baseline rom load_factor\""), std::string::npos);
    EXPECT_NE(
        text("new/junit.xml").find("<failure type=\"exceeded\" message=\"load_factor of rom: baseline "),
        std::string::npos);
}

TEST_F(SystemTrend, OfAnEarlierRunGoesWithIt) {
    trend({});
    EXPECT_TRUE(std::filesystem::exists(here_ / "new/trend.md"));
    const auto gap = text("new/gap.json");
    EXPECT_EQ(gap.find("trend"), std::string::npos);  // a report is made of records alone
    EXPECT_EQ(run({"report", "new", "--quiet"}).code, comparison_code);
    EXPECT_EQ(text("new/gap.json"), gap);
    EXPECT_TRUE(std::filesystem::exists(here_ / "new/trend.md"));  // its records are the same
    run({"compare", "scene.toml", "--quiet", "--out", "new"});
    for (const char* file : {"new/trend.md", "new/trend.json"})
        EXPECT_FALSE(std::filesystem::exists(here_ / file)) << file;
}

TEST_F(SystemTrend, OfASeriesIsThatOfEachCase) {
    here_.write("series.toml",
                "base = \"scene.toml\"\n[[case]]\nname = \"a\"\nset = {}\n[[case]]\nname = \"b\"\n"
                "set = { \"payload.mass\" = \"160 kg\" }\n");
    run({"compare", "series.toml", "--quiet", "--out", "s"});
    run({"compare", "series.toml", "--quiet", "--out", "t", "--baseline", "s"});
    for (const char* file : {"t/a/trend.json", "t/b/trend.json"})
        EXPECT_EQ(read(file)["changes"].size(), 0u) << file;
    std::filesystem::remove_all(here_ / "s/b");
    EXPECT_EQ(run({"compare", "series.toml", "--out", "t", "--baseline", "s"}).code, 2);
}

}  // namespace
}  // namespace twinchute::test
