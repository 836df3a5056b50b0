// `twinchute campaign` as a script sees it: files, exit codes, what is refused, what survives a kill.
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <numbers>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "lib/math/sha256.hpp"
#include "tests/support/count.hpp"
#include "tests/support/killed_process.hpp"
#include "tests/support/permissions.hpp"
#include "tests/support/program_test.hpp"
#include "tests/support/python.hpp"
#include "tests/support/small_disk.hpp"

namespace twinchute::test {
namespace {

const std::string templates = TWINCHUTE_SOURCE_DIR "/data/campaigns/",
                  example = templates + "c9-overload.toml";

/// A campaign of the C-9 to its peak force, one input.
std::string campaign_text(const std::string& plan, const std::string& answers) {
    return "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\n" + plan +
           "\n[[vary]]\nkey = \"parachute.fill_time.n\"\ndist = { normal = { mean = 4, sd = 0.4 } }\n" +
           answers;
}
const std::string mean = "[[answer]]\nname = \"peak\"\nmean = \"peak_force\"\n";
/// A campaign in wind with gusts, down to where the scene is to stop.
std::string gusty_text(const std::string& plan, const std::string& answers, const std::string& stop) {
    std::string text = campaign_text(plan, answers);
    const std::string before = "stop.at=\"peak-force\"";
    text.replace(text.find(before), before.size(),
                 "stop.at=\"" + stop + "\"', 'environment.wind={speed=4, from=\"270 deg\"}");
    return text +
           "[[vary]]\nkey = \"wind.gusts\"\nsd = [\"2 m/s\", \"2 m/s\", 0.5]\n"
           "correlation_length = [\"60 m\", 60, 30]\n";
}

/// The C-9 on a coarse mesh, to its peak, whose fastest releases tear it.
std::string torn_text(const std::string& limit, const std::string& plan, const std::string& answers) {
    return "base = \"c9-inflation.toml\"\nset = ['full.contact=\"none\"', 'stop.at=\"peak-force\"', "
           "'full.mesh.gore_columns=1', 'full.mesh.gore_rows=6', 'full.strain_limit=" +
           limit + "']\n[campaign]\n" + plan +
           "\n[[vary]]\nkey = \"release.speed\"\ndist = { uniform = { low = 15, high = 45 } }\n" + answers;
}

class SystemCampaign : public ProgramTest {
protected:
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(here_ / name) << text;
    }
    /// A campaign file of so many runs: three chunks of 8192.
    void write_runs(int runs = 20'000) const {
        write("c.toml", campaign_text("runs = " + std::to_string(runs) + "\nseed = 3", mean));
    }
    Ended campaign(const Words& words) const { return run(Words{"campaign", "c.toml"} + words); }
    /// One digest over the names and bytes of all chunks.
    std::string digest(const std::string& directory) const {
        std::string all;
        for (const std::string& name : tree_of(here_ / directory))
            if (name.ends_with(".h5") && name.starts_with("runs/"))
                all += name + sha256_hex(text(directory + "/" + name));
        return sha256_hex(all);
    }
    std::string refusal(const std::string& file) {
        write("c.toml", file);
        const Ended ended = campaign({});
        EXPECT_EQ(ended.code, 2) << ended.out << ended.err;
        EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"c.toml"}));
        return ended.err;
    }
};

/// Cells of a line of a CSV file.
std::vector<std::string> cells(const std::string& text, int line) {
    std::istringstream lines(text);
    std::string found;
    for (int i = 0; i <= line; ++i)
        std::getline(lines, found);
    std::vector<std::string> all;
    std::istringstream parts(found);
    for (std::string cell; std::getline(parts, cell, ',');)
        all.push_back(cell);
    return all;
}

bool says(const std::string& text, std::string_view what) {
    return text.find(what) != std::string::npos;
}

// The points of its pictures fill the range of an input. Every 50th point of Sobol's sequence lay above the
// middle.
TEST_F(SystemCampaign, ShowsRunsFromEverywhere) {
    write("c.toml",
          "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns = 20000\n"
          "design = \"sobol\"\n"
          "seed = 42\n[[vary]]\nkey = \"parachute.fill_time.n\"\ndist = { uniform = { low = 3, high = 5 } }\n"
          "[[vary]]\nkey = \"payload.mass\"\ndist = { uniform = { low = 140, high = 160 } }\n" +
              mean);
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const std::string page = text("out/report.html");
    // Ticks of both halves of each input.
    for (const auto& [input, ticks] : {std::pair{"parachute.fill_time.n", std::array{">3.5<", ">4.5<"}},
                                       std::pair{"payload.mass", std::array{">145<", ">155<"}}}) {
        const std::size_t begin = page.find(std::string("peak force against ") + input);
        ASSERT_NE(begin, std::string::npos);
        const std::string picture = page.substr(begin, page.find("</svg>", begin) - begin);
        EXPECT_GT(count_of(picture, "<circle"), 230u);  // five deviations below 320
        for (const char* tick : ticks)
            EXPECT_TRUE(says(picture, tick)) << input << " " << tick;
    }
}

TEST_F(SystemCampaign, TheExampleAnswersItsQuestions) {
    const Ended ended = run({"campaign", example, "--out", "out", "--json", "--export", "csv"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.out, text("out/campaign.json"));
    const json found = read("out/campaign.json");
    EXPECT_EQ(found["runs"]["complete"], 20'000);
    EXPECT_EQ(found["status"], "complete");
    for (const json& answer : found["answers"]) {
        EXPECT_LT(answer["interval_95"][0], answer["estimate"]) << answer["name"];
        EXPECT_GT(answer["interval_95"][1], answer["estimate"]) << answer["name"];
    }
    EXPECT_EQ(found["answers"][0]["verdict"], "met");
    for (const char* file : {"report.html", "junit.xml", "campaign.h5", "store.json", "runs.csv"})
        EXPECT_TRUE(std::filesystem::exists(here_ / "out" / file)) << file;
    const std::string csv = text("out/runs.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), 20'002);
    EXPECT_TRUE(csv.starts_with("run,status,parachute.fill_time.n,parachute.drag_area,"));
}

// The file is opened by h5py, which knows nothing of this program.
TEST_F(SystemCampaign, OthersReadTheRuns) {
    write_runs(9000);
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const Ended ended = run_script("tests/system/read_campaign.py", {"out/campaign.h5"}, here_.path());
    if (lacks_python(ended)) GTEST_SKIP() << "no h5py (Debian: python3-h5py)";
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json found = json::parse(ended.out);
    EXPECT_EQ(found["runs"], 9000);
    EXPECT_NEAR(found["mean"]["parachute.fill_time.n"].get<double>(), 4.0, 0.02);  // five standard errors
    EXPECT_NEAR(found["mean"]["peak_force_N"].get<double>(),
                read("out/campaign.json")["answers"][0]["estimate"].get<double>(), 1e-6);
}

TEST_F(SystemCampaign, SameBytesForThreadsAndShards) {
    write_runs();
    ASSERT_EQ(campaign({"--out", "one", "--threads", "1", "--quiet"}).code, 0);
    ASSERT_EQ(campaign({"--out", "two", "--threads", "2", "--quiet"}).code, 0);
    for (const char* shard : {"3/3", "1/3", "2/3"})
        ASSERT_EQ(campaign({"--out", "parts", "--shard", shard, "--quiet"}).code, 0);
    ASSERT_EQ(campaign({"--out", "parts", "--resume", "--quiet"}).code, 0);
    EXPECT_EQ(digest("one"), digest("two"));
    EXPECT_EQ(digest("one"), digest("parts"));
    EXPECT_EQ(text("one/campaign.h5"), text("parts/campaign.h5"));
    EXPECT_EQ(read("one/campaign.json")["answers"], read("parts/campaign.json")["answers"]);
}

// The gusts of a run are a function of the seed and of its number, and of nothing that ran before it.
TEST_F(SystemCampaign, GustsAreTheSameForThreadsAndShards) {
    write("c.toml", gusty_text("runs = 8300\nseed = 3", mean, "peak-force"));
    ASSERT_EQ(campaign({"--out", "one", "--threads", "1", "--quiet"}).code, 0);
    for (const char* shard : {"2/2", "1/2"})
        ASSERT_EQ(campaign({"--out", "parts", "--shard", shard, "--threads", "2", "--quiet"}).code, 0);
    EXPECT_EQ(digest("one"), digest("parts"));
}

TEST_F(SystemCampaign, TwoWorkersAtOnceMakeTheSame) {
    write_runs();
    ASSERT_EQ(campaign({"--out", "one", "--quiet"}).code, 0);
    Process first(program({"campaign", "c.toml", "--out", "both", "--shard", "1/1", "--quiet"}),
                  here_.path());
    Process second(program({"campaign", "c.toml", "--out", "both", "--shard", "1/1", "--quiet"}),
                   here_.path());
    EXPECT_EQ(first.wait().code, 0);
    EXPECT_EQ(second.wait().code, 0);
    EXPECT_EQ(digest("one"), digest("both"));
}

TEST_F(SystemCampaign, AKillAtAnyMomentLosesNothing) {
    write_runs();
    ASSERT_EQ(campaign({"--out", "whole", "--quiet"}).code, 0);
    for (int n = 1;; n += 3) {
        const std::string out = "killed-" + std::to_string(n);
        const KilledAt at = kill_before_change(
            n, program({"campaign", "c.toml", "--out", out, "--quiet", "--threads", "1"}), here_.path());
        if (at == KilledAt::untraceable) GTEST_SKIP() << "no process may trace another here";
        if (at == KilledAt::never) break;
        const Ended ended = campaign({"--out", out, "--resume", "--quiet"});
        ASSERT_EQ(ended.code, 0) << n << ended.err;
        ASSERT_EQ(digest(out), digest("whole")) << n;
        std::filesystem::remove_all(here_ / out);
        ASSERT_LT(n, 300);
    }
}

TEST_F(SystemCampaign, AChunkThatIsDamagedIsMadeAgain) {
    write_runs();
    ASSERT_EQ(campaign({"--out", "whole", "--quiet"}).code, 0);
    ASSERT_EQ(campaign({"--out", "hurt", "--quiet"}).code, 0);
    const std::string chunk = text("hurt/runs/chunk-00000001.h5");
    write("hurt/runs/chunk-00000001.h5", chunk.substr(0, chunk.size() / 2));
    write("hurt/runs/chunk-00000002.h5", "no HDF5");
    ASSERT_EQ(campaign({"--out", "hurt", "--resume", "--quiet"}).code, 0);
    EXPECT_EQ(digest("hurt"), digest("whole"));
    // A sound chunk in the place of another, and one of whose numbers a byte has changed.
    write("hurt/runs/chunk-00000001.h5", text("whole/runs/chunk-00000000.h5"));
    std::string changed = text("whole/runs/chunk-00000000.h5");
    changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
    write("hurt/runs/chunk-00000000.h5", changed);
    ASSERT_EQ(campaign({"--out", "hurt", "--resume", "--quiet"}).code, 0);
    EXPECT_EQ(digest("hurt"), digest("whole"));
}

TEST_F(SystemCampaign, CtrlCEndsItCleanly) {
    write_runs(8192 * 400);
    Process process(program({"campaign", "c.toml", "--out", "out", "--quiet"}), here_.path());
    ASSERT_TRUE(process.wait_until_handled(SIGINT));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // some chunks are there
    ::kill(process.id(), SIGINT);
    const Ended ended = process.wait();
    EXPECT_EQ(ended.code, 130) << ended.err;
    const json found = read("out/campaign.json");
    EXPECT_EQ(found["status"], "interrupted");
    EXPECT_LT(found["runs"]["made"], found["runs"]["wanted"]);
}

TEST_F(SystemCampaign, GoesOnOnlyWhereItIsWanted) {
    write_runs(100);
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const Ended again = campaign({"--out", "out"});
    EXPECT_EQ(again.code, 2);
    EXPECT_TRUE(says(again.err, "--resume")) << again.err;
    write_runs(9000);  // more of the same
    ASSERT_EQ(campaign({"--out", "out", "--quiet", "--resume"}).code, 0);
    EXPECT_EQ(read("out/campaign.json")["runs"]["made"], 9000);
    write("c.toml", campaign_text("runs = 100\nseed = 4", mean));
    const Ended other = campaign({"--out", "out", "--resume"});
    EXPECT_EQ(other.code, 2);
    EXPECT_TRUE(says(other.err, "the seed")) << other.err;
    const Ended heavier = campaign({"--out", "out", "--resume", "--set", "payload.mass=80 kg"});
    EXPECT_EQ(heavier.code, 2);
}

TEST_F(SystemCampaign, LimitsDecideOnTheExitCode) {
    const auto code_with = [&](const std::string& limit) {
        write("c.toml", campaign_text("runs = 2000", mean + "limit = \"" + limit + "\"\n"));
        const Ended ended = campaign({"--out", "out-" + limit, "--quiet"});
        EXPECT_EQ(says(text("out-" + limit + "/junit.xml"), "<failure"), ended.code == 1);
        return ended.code;
    };
    EXPECT_EQ(code_with("20 kN"), 0);
    EXPECT_EQ(code_with("1 kN"), 1);
}

TEST_F(SystemCampaign, SaysWhatIsSetInVain) {
    write_runs(100);
    EXPECT_TRUE(says(campaign({"--set", "parachute.fill_time.n=4", "--out", "a"}).out,
                     "parachute.fill_time.n is set, and varies: no run has the value that is set"));
    EXPECT_FALSE(says(campaign({"--set", "payload.mass=150", "--out", "b"}).out, "is set, and varies"));
}

TEST_F(SystemCampaign, StopsWhereTheIntervalIsNarrow) {
    write("c.toml", campaign_text("until = { answer = \"peak\", halfwidth = \"0.1 %\" }", mean));
    ASSERT_EQ(campaign({"--out", "one", "--quiet", "--threads", "1"}).code, 0);
    ASSERT_EQ(campaign({"--out", "two", "--quiet", "--threads", "2"}).code, 0);
    const json found = read("one/campaign.json");
    const double half = 0.5 * (found["answers"][0]["interval_95"][1].get<double>() -
                               found["answers"][0]["interval_95"][0].get<double>());
    EXPECT_LE(half, 0.001 * found["answers"][0]["estimate"].get<double>());
    EXPECT_LT(found["runs"]["made"], 100'000);
    EXPECT_EQ(digest("one"), digest("two"));
}

TEST_F(SystemCampaign, OneRunCanBeLookedAt) {
    write_runs(100);
    ASSERT_EQ(campaign({"--out", "out", "--quiet", "--export", "csv"}).code, 0);
    ASSERT_EQ(campaign({"--out", "out", "--rerun", "42", "--quiet"}).code, 0);
    const std::vector<std::string> names = cells(text("out/runs.csv"), 0),
                                   row = cells(text("out/runs.csv"), 44);
    ASSERT_EQ(row[0], "42");
    const auto column = std::ranges::find(names, "peak_force_N") - names.begin();
    const double peak = read("out/rerun-42/summary.json")["metrics"]["peak_force_N"];
    EXPECT_NEAR(std::stod(row[static_cast<std::size_t>(column)]) / peak, 1.0, 5e-5);  // that of batches
    EXPECT_EQ(campaign({"--out", "out", "--rerun", "100"}).code, 2);
    // The runs there are another campaign's.
    write("c.toml", campaign_text("runs = 100\nseed = 4", mean));
    const Ended other = campaign({"--out", "out", "--rerun", "41", "--quiet"});
    EXPECT_EQ(other.code, 2) << other.err;
    EXPECT_FALSE(std::filesystem::exists(here_ / "out/rerun-41"));
}

// Still air, line stretch to the peak: as docs/guide/campaign.md has it.
TEST_F(SystemCampaign, RunsOfAnOpeningAreMadeInBatches) {
    write_runs(100);
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    EXPECT_EQ(read("out/campaign.json")["engine"], "in batches of 64");
    // Kept where it is asked for.
    write("c.toml", campaign_text("runs = 100", "[[answer]]\nname = \"top\"\nmean = \"max_altitude\"\n"));
    ASSERT_EQ(campaign({"--out", "other", "--quiet"}).code, 0);
    EXPECT_EQ(read("other/campaign.json")["answers"][0]["runs"], 100);
}

TEST_F(SystemCampaign, JsonFollowsItsSchema) {
    write_runs(200);
    here_.write("rom.json", campaign({"--out", "a", "--json"}).out);
    write("c.toml",
          campaign_text(
              "runs = 700\ndesign = \"saltelli\"",
              mean + "limit = 1\n[[answer]]\nname = \"q\"\nquantile = \"peak_force\"\nlevel = 0.999\n"));
    here_.write("saltelli.json", campaign({"--out", "b", "--json"}).out);
    write("c.toml",
          "base = \"c9-drift.toml\"\n[campaign]\nruns = 30\nrelease_point = { latitude = \"47 deg\", "
          "longitude = \"8 deg\" }\n"
          "[[vary]]\nkey = \"wind.turn\"\ndist = { normal = { mean = 0, sd = \"10 deg\" } }\n"
          "[[answer]]\nname = \"field\"\nellipse = \"landing\"\n");
    here_.write("landing.json", campaign({"--out", "c", "--json"}).out);
    write("c.toml", torn_text("0.02", "runs = 400\nfidelity = \"both\"\npilot = 8\nfull_runs = 8",
                              "[[answer]]\nname = \"high\"\nprobability = \"peak_force > 12 kN\"\n"));
    here_.write("both.json", campaign({"--out", "d", "--json"}).out);
    EXPECT_TRUE(says(text("c/landing.kml"), "<coordinates>"));
    const std::string schema = TWINCHUTE_SOURCE_DIR "/docs/schema/campaign.schema.json";
    const Ended ended =
        run_script("tests/support/check_schema.py",
                   {schema, "rom.json", "saltelli.json", "landing.json", "both.json"}, here_.path());
    if (lacks_python(ended)) GTEST_SKIP() << "no Python with jsonschema (Debian: python3-jsonschema)";
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
}

TEST_F(SystemCampaign, BothModelsTogetherSayWhatTheFullOneWould) {
    const std::string plan = "runs = 4000\nfidelity = \"both\"\npilot = 12\nfull_runs = 16";
    write("c.toml", campaign_text(plan, mean));
    ASSERT_EQ(campaign({"--out", "out", "--quiet", "--set", "full.mesh.gore_columns=1", "--set",
                        "full.mesh.gore_rows=6", "--set", "full.contact=\"none\""})
                  .code,
              0);
    const json both = read("out/campaign.json")["both"], answer = both["answers"][0];
    EXPECT_EQ(both["pairs"], 16);
    const auto width = [](const json& a) {
        return a["interval_95"][1].get<double>() - a["interval_95"][0].get<double>();
    };
    EXPECT_LT(10.0 * width(answer),
              width(answer["full_alone"]));  // found: 17, 4000 runs of the ROM leave most
    EXPECT_GT(answer["gain"]["estimate"], 50.0);
    EXPECT_TRUE(says(both["engine"].get<std::string>(), "one sector"));
    EXPECT_GT(both["cost_ratio"], 10.0);
    EXPECT_GT(answer["best_rom_runs"], 1.0);
    EXPECT_LE(answer["full_alone"]["interval_95"][0], answer["estimate"]);
    EXPECT_GE(answer["full_alone"]["interval_95"][1], answer["estimate"]);
}

// Only some of very many runs of the ROM are corrected. Those of Sobol's sequence must not be counted out:
// every fourth lies in one quarter of an input.
TEST_F(SystemCampaign, BothModelsTogetherTakeRunsFromEverywhere) {
    write("c.toml",
          campaign_text("runs = 80_000\ndesign = \"sobol\"\nfidelity = \"both\"\npilot = 12\nfull_runs = 12",
                        "[[answer]]\nname = \"high\"\nprobability = \"peak_force > 5200 N\"\n"));
    ASSERT_EQ(campaign({"--out", "out", "--quiet", "--set", "full.mesh.gore_columns=1", "--set",
                        "full.mesh.gore_rows=6", "--set", "full.contact=\"none\""})
                  .code,
              0);
    const json found = read("out/campaign.json");
    const double all = found["answers"][0]["estimate"], some = found["both"]["answers"][0]["rom_alone"];
    // 20 000 of them: the share of one in six is known to 0.3 %, 1 % are four of these. Every fourth one gave
    // 30 %.
    EXPECT_NEAR(some, all, 0.01);
    EXPECT_GT(all, 0.05);
}

// In a block of Saltelli's design four runs of six share the gusts of the first. Answers are from the two
// that are drawn.
TEST_F(SystemCampaign, AnswersOfSaltellisDesignAreFromIndependentRuns) {
    write("c.toml", gusty_text("runs = 400\ndesign = \"saltelli\"", mean, "peak-force"));
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const json found = read("out/campaign.json");
    EXPECT_EQ(found["runs"]["made"], 400);
    EXPECT_EQ(found["answers"][0]["runs"], 200);  // two inputs, blocks of four
}

TEST_F(SystemCampaign, RunsWithoutTheMetricCastDoubtOnALimit) {
    // The main of a rocket waits for a height from 1 to 300 ft; below some 60 ft it does not open in time.
    // All that did open falls slowly: no run has a fast descent rate, and those without one might.
    write(
        "c.toml",
        "base = \"rocket-dual-deploy.toml\"\n[campaign]\nruns = 200\n[[vary]]\nkey = "
        "\"parachute.main.deploy.when.height\"\ndist = { uniform = { low = \"1 ft\", high = \"300 ft\" } }\n"
        "[[answer]]\nname = \"fast\"\nprobability = \"descent_rate > 8 m/s\"\nlimit = \"5 %\"\n"
        "[[answer]]\nname = \"fails\"\nprobability = \"unopened_parachutes > 0\"\nlimit = \"90 %\"\n"
        "[[answer]]\nname = \"most\"\nquantile = \"descent_rate\"\nlevel = \"90 %\"\nlimit = \"8 m/s\"\n"
        "[[answer]]\nname = \"few\"\nquantile = \"descent_rate\"\nlevel = \"20 %\"\nlimit = \"8 m/s\"\n");
    const Ended ended = campaign({"--out", "out", "--quiet"});
    EXPECT_EQ(ended.code, 1) << ended.err;
    const json found = read("out/campaign.json"), &fast = found["answers"][0], &fails = found["answers"][1];
    EXPECT_EQ(fast["estimate"], 0.0);
    EXPECT_LT(fast["runs"], 200);
    EXPECT_EQ(fast["verdict"], "undecided");
    // A run in which all opened has no parachute that did not: 0, and counts.
    EXPECT_EQ(fails["runs"], 200);
    const int not_opened = found["failures"]["not_opened"]["runs"];
    EXPECT_GT(not_opened, 0);
    EXPECT_DOUBLE_EQ(fails["estimate"].get<double>(), not_opened / 200.0);
    EXPECT_EQ(fails["verdict"], "met");
    // Some 40 % are missing: were they the fastest, they would be among the upper 10 %, not the lower 20 %.
    const json &most = found["answers"][2], &few = found["answers"][3];
    EXPECT_LT(most["interval_95"][1], 8.0);
    EXPECT_EQ(most["verdict"], "undecided");
    EXPECT_EQ(few["verdict"], "met");
}

// The largest force of a canopy that tears is that up to the tear: no more than a bound.
TEST_F(SystemCampaign, RunsThatBrokeOffHaveNoExtremes) {
    write("c.toml",
          torn_text("0.02", "runs = 24\nfidelity = \"full\"\ndesign = \"sobol\"",
                    "[[answer]]\nname = \"force\"\nprobability = \"max_force > 9 kN\"\nlimit = \"30 %\"\n"
                    "[[answer]]\nname = \"mean\"\nmean = \"max_force\"\nlimit = \"5.5 kN\"\n"
                    "[[answer]]\nname = \"speed\"\nmean = \"snatch_speed\"\n"));
    const Ended ended = campaign({"--out", "out", "--quiet", "--export", "csv"});
    EXPECT_EQ(ended.code, 1) << ended.err;
    const json found = read("out/campaign.json");
    const int torn = found["failures"]["strain_limit"]["runs"];
    ASSERT_GT(torn, 6);
    ASSERT_LT(torn, 20);
    const json &force = found["answers"][0], &mean_force = found["answers"][1], &speed = found["answers"][2];
    EXPECT_EQ(force["runs"], 24 - torn);
    EXPECT_EQ(force["verdict"], "undecided");
    EXPECT_TRUE(says(force["note"].get<std::string>(), std::to_string(torn) + " of 24 runs"));
    // The others' mean is within the limit, and would not be with as many as bad as the worst of them.
    EXPECT_LT(mean_force["interval_95"][1], 5500.0);
    EXPECT_EQ(mean_force["verdict"], "undecided");
    EXPECT_EQ(speed["runs"], 24);  // it snatched before it tore
    EXPECT_FALSE(says(text("out/runs.csv"), ",nan"));
}

TEST_F(SystemCampaign, FullRunsThatFailCastDoubtOnBoth) {
    const std::string both = "runs = 400\nfidelity = \"both\"\npilot = 8\nfull_runs = 12",
                      high =
                          "[[answer]]\nname = \"high\"\nprobability = \"peak_force > 12 kN\"\n"
                          "limit = \"90 %\"\n",
                      most =
                          "[[answer]]\nname = \"most\"\nquantile = \"peak_force\"\nlevel = 0.2\n"
                          "limit = \"50 kN\"\n";
    write("c.toml", torn_text("0.02", both, high + most));
    const Ended ended = campaign({"--out", "out"});
    EXPECT_EQ(ended.code, 1) << ended.err;
    const json found = read("out/campaign.json")["both"];
    const int torn = found["failures"]["strain_limit"]["runs"];
    ASSERT_GT(torn, 3);
    ASSERT_LT(torn, 12);
    EXPECT_EQ(found["complete"], 12 - torn);
    EXPECT_TRUE(says(ended.out, "full model: strain_limit"));
    for (const json& answer : found["answers"]) {
        EXPECT_EQ(answer["verdict"], "undecided") << answer;
        EXPECT_TRUE(says(answer["note"].get<std::string>(),
                         "of the full model, " + std::to_string(torn) + " of 12 runs"));
    }
    // None that tears: nothing is missing, and both are met.
    write("c.toml", torn_text("0.9", both, high + most));
    EXPECT_EQ(campaign({"--out", "whole", "--quiet"}).code, 0);
    // All tear at once.
    write("c.toml",
          torn_text("0.001", both, "[[answer]]\nname = \"high\"\nprobability = \"max_force > 12 kN\"\n"));
    EXPECT_EQ(campaign({"--out", "none", "--quiet"}).code, 3);
}

// An ellipse is of the reduced-order model alone, and its limit counts.
TEST_F(SystemCampaign, BothModelsTogetherHoldAnEllipseAgainstItsLimit) {
    write(
        "c.toml",
        "base = \"c9-inflation.toml\"\nset = ['full.contact=\"none\"', 'stop.at=\"ground\"', "
        "'release.height=\"40 m\"', 'full.mesh.gore_columns=1', 'full.mesh.gore_rows=6']\n[campaign]\n"
        "runs = 100\nfidelity = \"both\"\npilot = 8\nfull_runs = 8\n"
        "[[vary]]\nkey = \"release.path_angle\"\ndist = { uniform = { low = \"60 deg\", high = \"89 deg\" } "
        "}\n[[answer]]\nname = \"land\"\nellipse = \"landing\"\nlimit = \"1 m\"\n");
    EXPECT_EQ(campaign({"--out", "out", "--quiet"}).code, 1);
    EXPECT_TRUE(says(text("out/junit.xml"), "tests=\"1\" failures=\"1\""));
}

// Levels lie at the middle of equal shares: of twenty none is beyond the 97.5 % quantile.
TEST_F(SystemCampaign, GridHasNoInterval) {
    write("c.toml", campaign_text("design = \"grid\"",
                                  "levels = 20\n[[answer]]\nname = \"far\"\n"
                                  "probability = \"fill_constant > 4.8\"\n"));
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const json answer = read("out/campaign.json")["answers"][0];
    EXPECT_EQ(answer["estimate"], 0.0);
    EXPECT_TRUE(answer["interval_95"][0].is_null() && answer["interval_95"][1].is_null()) << answer;
}

TEST_F(SystemCampaign, WhatASceneRefusesIsRefusedInEachRun) {
    // Counts below one, and a drag coefficient of more than 5 on the nominal area, which a key's range does
    // not know.
    write("c.toml",
          "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns = "
          "90\n[[vary]]\nkey = \"parachute.count\"\ndist = { uniform = { low = -3, high = 5 } }\n" +
              mean);
    ASSERT_EQ(campaign({"--out", "count", "--quiet"}).code, 0);
    EXPECT_GT(read("count/campaign.json")["failures"]["refused"]["runs"], 25);  // four of nine numbers
    write("c.toml",
          "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns = "
          "90\n[[vary]]\nkey "
          "= \"parachute.drag_area\"\ndist = { uniform = { low = 10, high = 500 } }\n" +
              mean);
    ASSERT_EQ(campaign({"--out", "area", "--quiet"}).code, 0);
    // Above 5 pi/4 D0^2 = 286 m^2: 44 % of the range.
    EXPECT_NEAR(read("area/campaign.json")["failures"]["refused"]["runs"].get<double>() / 90.0, 0.44, 0.2);
}

// Both models of a pair fly through the same gusts, or the one could not speak for the other.
TEST_F(SystemCampaign, BothModelsMeetTheSameGusts) {
    const std::string deviation = "[[answer]]\nname = \"landing\"\nmean = \"landing_east\"\n";
    write("c.toml",
          gusty_text("runs = 400\nfidelity = \"both\"\npilot = 12\nfull_runs = 12", deviation, "ground"));
    ASSERT_EQ(
        campaign({"--out", "out", "--quiet", "--set", "full.mesh.gore_columns=1", "--set",
                  "full.mesh.gore_rows=6", "--set", "full.contact=\"none\"", "--set", "release.height=60"})
            .code,
        0);
    const json both = read("out/campaign.json")["both"];
    EXPECT_EQ(both["pairs"], 12);
    EXPECT_FALSE(says(both["engine"].get<std::string>(), "one sector"));
    EXPECT_GT(both["answers"][0]["correlation"], 0.9);
}

TEST_F(SystemCampaign, FullRunsAreOfOneSectorWhereItStandsForTheWhole) {
    const Words coarse{"--quiet",
                       "--set",
                       "full.mesh.gore_columns=1",
                       "--set",
                       "full.mesh.gore_rows=6",
                       "--set",
                       "full.contact=\"none\"",
                       "--threads",
                       "1"};
    write("c.toml", campaign_text("runs = 3\nfidelity = \"full\"", mean));
    ASSERT_EQ(campaign(Words{"--out", "sector"} + coarse).code, 0);
    ASSERT_EQ(campaign(Words{"--out", "whole", "--set", "full.symmetry=\"none\""} + coarse).code, 0);
    const json sector = read("sector/campaign.json"), whole = read("whole/campaign.json");
    EXPECT_TRUE(says(sector["engine"].get<std::string>(), "one sector"));
    EXPECT_FALSE(says(whole["engine"].get<std::string>(), "one sector"));
    const double peak = whole["answers"][0]["estimate"];
    EXPECT_NEAR(sector["answers"][0]["estimate"], peak, 1e-4 * peak);  // found over the demo: 2e-6

    // A path that is not straight down at every value.
    write("c.toml",
          campaign_text("runs = 2\nfidelity = \"full\"",
                        mean + "[[vary]]\nkey = \"release.path_angle\"\ndist = { uniform = { low = \"80 "
                               "deg\", high = \"90 deg\" } }\n"));
    ASSERT_EQ(campaign(Words{"--out", "askew"} + coarse).code, 0);
    const json askew = read("askew/campaign.json");
    EXPECT_FALSE(says(askew["engine"].get<std::string>(), "one sector"));
    EXPECT_EQ(askew["runs"]["complete"], 2);
}

// A folder that nobody may write in, before the first run and once a chunk is missing.
TEST_F(SystemCampaign, AFolderWithoutPermissionIsAClearError) {
    namespace fs = std::filesystem;
    const auto make = [&](const Words& words) {
        return Process(program(Words{"campaign", "c.toml", "--quiet"} + words), here_.path(), {},
                       without_override)
            .wait();
    };
    write_runs();
    fs::create_directory(here_ / "closed");
    fs::permissions(here_ / "closed", fs::perms::owner_read | fs::perms::owner_exec);
    Ended ended = make({"--out", "closed/out"});
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_TRUE(says(ended.err, "Permission denied")) << ended.err;
    EXPECT_TRUE(tree_of(here_ / "closed").empty());

    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const std::string whole = digest("out");
    fs::remove(here_ / "out/runs/chunk-00000001.h5");
    const std::set<std::string> left = tree_of(here_ / "out");
    fs::permissions(here_ / "out/runs", fs::perms::owner_read | fs::perms::owner_exec);
    ended = make({"--out", "out", "--resume"});
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_TRUE(says(ended.err, "chunk-00000001.h5' (Permission denied)")) << ended.err;
    EXPECT_EQ(tree_of(here_ / "out"), left);
    fs::permissions(here_ / "out/runs", fs::perms::owner_all);
    ASSERT_EQ(make({"--out", "out", "--resume"}).code, 0);
    EXPECT_EQ(digest("out"), whole);
}

/// Whether a program is installed.
bool has_program(const std::string& name) {
    return Process({"/usr/bin/env", "which", name}, "/").wait().code == 0;
}

TEST_F(SystemCampaign, RanksOfMpiMakeTheSame) {
    if (!has_program("mpirun")) GTEST_SKIP() << "no mpirun (Debian: openmpi-bin)";
    write_runs();
    ASSERT_EQ(campaign({"--out", "one", "--quiet"}).code, 0);
    const Ended ended = Process({"/usr/bin/env", std::string("TWINCHUTE=") + TWINCHUTE_PROGRAM,
                                 "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1", "mpirun",
                                 "--oversubscribe", "-n", "3", templates + "mpi-rank.sh", "c.toml", "ranks"},
                                here_.path())
                            .wait();
    ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_EQ(digest("one"), digest("ranks"));
}

TEST_F(SystemCampaign, AnArrayOfSlurmMakesTheSame) {
    const Ended started = run_script(
        "tests/system/slurm_array.py",
        {TWINCHUTE_PROGRAM, templates + "slurm-array.sh", "4", "c.toml", "array", "--check"}, here_.path());
    if (started.code != 0) GTEST_SKIP() << started.err;
    write_runs();
    ASSERT_EQ(campaign({"--out", "one", "--quiet"}).code, 0);
    const Ended ended =
        run_script("tests/system/slurm_array.py",
                   {TWINCHUTE_PROGRAM, templates + "slurm-array.sh", "4", "c.toml", "array"}, here_.path());
    ASSERT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_EQ(digest("one"), digest("array"));
}

TEST_F(SystemCampaign, ValuesThatASceneMustNotHaveAreRowsWithAStatus) {
    write("c.toml",
          "base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns = 200\n[[vary]]\n"
          "key = \"parachute.fill_time.n\"\ndist = { uniform = { low = -1, high = 4 } }\n" +
              mean);
    ASSERT_EQ(campaign({"--out", "out", "--quiet"}).code, 0);
    const json found = read("out/campaign.json");
    const int refused = found["failures"]["refused"]["runs"];
    EXPECT_GT(refused, 15);  // a fifth and more of 200
    EXPECT_EQ(found["runs"]["complete"].get<int>() + refused, 200);
    EXPECT_EQ(found["answers"][0]["runs"], found["runs"]["complete"]);
}

// The peak force rises with the mass: the event is a mass four deviations above its mean.
TEST_F(SystemCampaign, ARareEventIsSimulatedInSubsets) {
    const Ended heavy = run({"rom", shipped_scene("c9-inflation"), "--set", "payload.mass=180", "--set",
                             "stop.at=\"peak-force\"", "--set", "rom.rtol=1e-9", "--json", "--out", "heavy"});
    ASSERT_EQ(heavy.code, 0) << heavy.err;
    const double force = json::parse(heavy.out)["metrics"]["peak_force_N"];
    write("c.toml",
          fmt::format("base = \"c9-inflation.toml\"\nset = ['stop.at=\"peak-force\"']\n[campaign]\nruns "
                      "= 60000\nseed = 5\nrare = \"subset\"\n[[vary]]\nkey = \"payload.mass\"\ndist = {{ "
                      "normal = {{ mean = 140, sd = 10 }} }}\n[[answer]]\nname = \"high\"\nprobability = "
                      "\"peak_force > {:.17g} N\"\nlimit = \"1e-4\"\n",
                      force));
    const Ended ended = campaign({"--out", "one", "--quiet", "--threads", "1"});
    if (ended.code == 2 && says(ended.err, "libopenturns-dev")) GTEST_SKIP() << ended.err;
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json high = read("one/campaign.json")["answers"][0];
    const double truth = 0.5 * std::erfc(4.0 / std::numbers::sqrt2);
    // Batches are within 5e-5 in force, 1 in 300 of a deviation of the mass: 1.4 % of this probability.
    const double halfwidth =
        0.5 * (high["interval_95"][1].get<double>() - high["interval_95"][0].get<double>());
    EXPECT_LT(halfwidth, 0.2 * truth);
    EXPECT_NEAR(high["estimate"], truth, 1.5 * halfwidth + 0.014 * truth);  // three standard errors
    EXPECT_EQ(high["verdict"], "met");
    EXPECT_EQ(high["rare"]["failed"], 0);
    // Beyond 4 a normal variable has the mean phi(4)/Q(4) = 4.2256 and the deviation 0.22; of its points here
    // a thousand at least are independent, three deviations of their mean are 0.02, in kg 0.2.
    EXPECT_NEAR(high["rare"]["inputs"]["payload.mass"], 182.26, 0.2);

    ASSERT_EQ(campaign({"--out", "two", "--quiet", "--threads", "2"}).code, 0);
    EXPECT_EQ(read("two/campaign.json")["answers"][0], high);
}

TEST_F(SystemCampaign, APointsTableIsRunAsItStands) {
    write("p.csv", "release.speed [m/s]\n20\n25\n");
    write(
        "c.toml",
        "base = \"c9-inflation.toml\"\n[campaign]\ndesign = \"p.csv\"\n[[vary]]\nkey = \"release.speed\"\n" +
            mean);
    ASSERT_EQ(campaign({"--out", "out", "--quiet", "--export", "csv"}).code, 0);
    EXPECT_TRUE(says(text("out/runs.csv"), "\n1,completed,25,"));
    // Units and columns that it cannot take are no failures of the program.
    for (const auto& [table, what] :
         {std::pair{"release.speed [m/ss]\n20\n25\n", "p.csv:1:"},
          {"release.speed [kg]\n20\n25\n", "p.csv:1:"},
          {"release.speed,payload.mass\n20,100\n25,100\n", "payload.mass: is not varied"}}) {
        write("p.csv", table);
        const Ended ended = campaign({"--out", "none", "--quiet"});
        EXPECT_EQ(ended.code, 2) << ended.err;
        EXPECT_TRUE(says(ended.err, what)) << ended.err;
    }
}

TEST_F(SystemCampaign, RefusesWhatItDoesNotUnderstand) {
    const std::string plan = "runs = 10";
    EXPECT_TRUE(says(refusal(campaign_text(plan + "\nrunz = 3", mean)), "runz"));
    EXPECT_TRUE(says(refusal(campaign_text("seed = 1", mean)), "runs"));
    const std::string rare = refusal(campaign_text(plan + "\nrare = \"subset\"", mean));
    EXPECT_TRUE(says(rare, "libopenturns-dev") || says(rare, "no [[answer]] is a probability"));
    EXPECT_TRUE(says(refusal(campaign_text(plan, "[[answer]]\nname = \"a\"\nmean = \"peak_farce\"\n")),
                     "peak_force"));
    EXPECT_TRUE(
        says(refusal(campaign_text(plan, "[[answer]]\nname = \"a\"\nprobability = \"peak_force > 3 m\"\n")),
             "answer"));
    EXPECT_TRUE(says(refusal(campaign_text(plan, "[[answer]]\nname = \"a\"\nellipse = \"landing\"\n")),
                     "landing east"));
    EXPECT_TRUE(says(refusal(campaign_text(plan, mean + mean)), "two answers"));
    EXPECT_TRUE(
        says(refusal(campaign_text(plan, mean + "[[vary]]\nkey = \"payload.mess\"\n")), "payload.mass"));
    EXPECT_TRUE(says(
        refusal(campaign_text(
            plan, mean + "[[vary]]\nkey = \"wind.scale\"\ndist = { uniform = { low = 0, high = 1 } }\n")),
        "no wind"));
    EXPECT_TRUE(says(
        refusal(campaign_text(
            plan,
            mean +
                "[[correlation]]\nbetween = [\"parachute.fill_time.n\", \"payload.mass\"]\nvalue = 0.5\n")),
        "does not vary"));
    EXPECT_TRUE(says(refusal(campaign_text(plan, mean + "[[vary]]\nkey = \"parachute.fill_time.n\"\n")),
                     "varies twice"));
    EXPECT_TRUE(says(refusal("base = \"none.toml\"\n[campaign]\nruns = 1\n[[vary]]\nkey = "
                             "\"payload.mass\"\ndist = { uniform = { low = 1, high = 2 } }\n"),
                     "none.toml"));
}

TEST_F(SystemCampaign, ADiskThatIsFullIsAClearError) {
    SmallDisk disk("size=1m");
    if (!disk.why().empty()) GTEST_SKIP() << disk.why();
    write_runs();
    const Ended ended = campaign({"--out", (disk.path() / "out").string(), "--quiet"});
    EXPECT_EQ(ended.code, 4) << ended.err;
    EXPECT_TRUE(says(ended.err, "cannot write")) << ended.err;
    for (const std::string& name : tree_of(disk.path()))
        EXPECT_FALSE(name.ends_with(".tmp")) << name;
}

}  // namespace
}  // namespace twinchute::test
