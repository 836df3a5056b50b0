// `twinchute calibrate` as a script sees it: files, exit codes, what is refused.
#include <sys/resource.h>

#include "tests/support/program_test.hpp"
#include "tests/support/python.hpp"

namespace twinchute::test {
namespace {

const std::string data = TWINCHUTE_SOURCE_DIR "/data/calibration/";
const std::string c9_drop = data + "c9-drop.toml", drop_a = data + "c9-drop-a.toml",
                  drop_b = data + "c9-drop-b.toml";
const std::set<std::string> calibration_files{"out", "out/calibrated.toml", "out/calibration.json",
                                              "out/report.html"};

class SystemCalibrate : public ProgramTest {
protected:
    static bool says(const std::string& text, std::string_view what) {
        return text.find(what) != std::string::npos;
    }
    /// The complaint of a run that is refused and writes nothing.
    std::string refusal(const Words& words) {
        const Ended ended = run(Words{"calibrate"} + words);
        EXPECT_EQ(ended.code, 2) << ended.out << ended.err;
        EXPECT_EQ(ended.out, "");
        return ended.err;
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(here_ / name) << text;
    }
};

TEST_F(SystemCalibrate, GivesTheTruthOfTheWorkedExample) {
    const Ended ended = run({"calibrate", c9_drop, "--to", drop_a, "--out", "out", "--json"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(tree_of(here_.path()), calibration_files);
    EXPECT_EQ(ended.out, text("out/calibration.json"));
    const json found = read("out/calibration.json");
    const std::pair<const char*, double> truths[] = {{"parachute.fill_time.n", 5.5},
                                                     {"parachute.drag_area", 39.0},
                                                     {"parachute.initial_drag_area_ratio", 0.06}};
    for (const auto& [key, truth] : truths) {
        const json& p = found["parameters"][key];
        EXPECT_TRUE(p["identified"].get<bool>()) << key;
        EXPECT_NEAR(p["estimate"].get<double>() / truth, 1.0, 0.04) << key;  // three standard deviations
        EXPECT_LT(p["interval_95"][0], p["estimate"]) << key;
        EXPECT_GT(p["interval_95"][1], p["estimate"]) << key;
    }
    EXPECT_TRUE(found["consistent"].get<bool>());
    EXPECT_GT(found["cost"]["runs"].get<int>(), 100);
}

TEST_F(SystemCalibrate, RunsKeepTheMemoryOfTheLast) {
    // Pages that the system hands out, of all children so far: 84 a run when each run gave its buffers back.
    const auto pages = [] {
        rusage usage{};
        getrusage(RUSAGE_CHILDREN, &usage);
        return usage.ru_minflt;
    };
    const long before = pages();
    ASSERT_EQ(run({"calibrate", c9_drop, "--to", drop_a, "--out", "out", "--quiet"}).code, 0);
    const long taken = pages() - before, runs = read("out/calibration.json")["cost"]["runs"].get<long>();
    EXPECT_GT(taken, 0);
    EXPECT_LT(taken, 10 * runs);
}

TEST_F(SystemCalibrate, WritesASceneThatRuns) {
    ASSERT_EQ(run({"calibrate", c9_drop, "--to", drop_a, "--out", "out", "--quiet", "--set",
                   "payload.mass=152.4 kg"})
                  .code,
              0);
    const Ended again = run({"rom", "out/calibrated.toml", "--json"});
    ASSERT_EQ(again.code, 0) << again.err;
    const json summary = json::parse(again.out), found = read("out/calibration.json");
    const json& n = summary["inputs"]["parachute.fill_time.n"];
    EXPECT_EQ(n["value"], found["parameters"]["parachute.fill_time.n"]["estimate"]);
    EXPECT_TRUE(says(n["source"].get<std::string>(), "c9-drop-a.toml"));
    EXPECT_TRUE(says(n["source"].get<std::string>(), "[grade measured]"));
    EXPECT_EQ(summary["metrics"]["peak_force_N"], found["predictive"]["peak_force_N"]["estimate"]);
    EXPECT_EQ(run({"calibrate", c9_drop, "--to", drop_a, "--out", "out", "--quiet"}).code,
              0);  // over its own
}

TEST_F(SystemCalibrate, TakesSeveralTestsOnClocksOfTheirOwn) {
    const Ended ended = run({"calibrate", c9_drop, "--to", drop_a, "--to", drop_b, "--out", "out"});
    ASSERT_EQ(ended.code, 0) << ended.err << ended.out;
    EXPECT_TRUE(says(ended.out, "calibrated to 2 tests")) << ended.out;
    EXPECT_TRUE(says(ended.out, "test to test")) << ended.out;
    const json clock = read("out/calibration.json")["parameters"]["clock_offset.2"];
    EXPECT_NEAR(clock["estimate"].get<double>(), 0.4, 0.02);  // that the file was made with
}

TEST_F(SystemCalibrate, SaysWhatDoesNotGoTogether) {
    std::string csv = "time,force\ns,N\n", line;
    std::ifstream lines(data + "c9-drop-a.csv");
    for (int i = 0; std::getline(lines, line); ++i) {
        if (i < 3) continue;
        const std::size_t comma = line.find(',');
        csv += line.substr(0, comma) + "," + std::to_string(1.1 * std::stod(line.substr(comma + 1))) + "\n";
    }
    write("scaled.csv", csv);
    write("scaled.toml",
          "file = \"scaled.csv\"\nclock = \"known\"\n[force]\nsigma = \"3 %\"\nbandwidth = \"50 Hz\"\n");
    const Ended ended = run({"calibrate", c9_drop, "--to", "scaled.toml", "--out", "out"});
    EXPECT_EQ(ended.code, 1) << ended.out;
    EXPECT_TRUE(says(ended.out, "scale of the force sensor looks wrong")) << ended.out;
    EXPECT_TRUE(says(ended.out, "inconsistent")) << ended.out;
    EXPECT_FALSE(read("out/calibration.json")["consistent"].get<bool>());
    EXPECT_TRUE(says(text("out/report.html"), "scale of the force sensor"));
}

TEST_F(SystemCalibrate, RefusesBadInputAndWritesNothing) {
    write("early.csv", "time,force\ns,N\n-2,1\n-1,2\n");
    write("bad.csv", "time,force\ns,N\n0,1\n1,x\n");
    write("set.toml",
          "set = { \"payload.mas\" = \"80 kg\" }\n[peak_force]\nvalue = \"5 kN\"\nsigma = \"3 %\"\n");
    write("prior.toml",
          "[peak_force]\nvalue = \"5 kN\"\nsigma = \"3 %\"\n[[prior]]\nkey = \"payload.mass\"\nmean = "
          "1\nsigma = 1\n");
    for (const auto& [file, mean] : {std::pair{"n4.toml", "4"}, {"n5.toml", "5"}})
        write(file, std::string("[peak_force]\nvalue = \"5 kN\"\nsigma = \"3 %\"\n[[prior]]\nkey = "
                                "\"parachute.fill_time.n\"\nmean = ") +
                        mean + "\nsigma = 1\n");
    const auto before = tree_of(here_.path());
    const std::pair<Words, const char*> cases[] = {
        {{c9_drop}, "--to is missing"},
        {{c9_drop, "--to", "n4.toml", "--to", "n5.toml"},
         "another prior on 'parachute.fill_time.n' than an earlier test has (5 +- 1 here, 4 +- 1 there)"},
        {{c9_drop, "--to", "early.csv"}, "early.csv:4:1: the history lies wholly before the release"},
        {{c9_drop, "--to", "bad.csv"}, "bad.csv:4:3: 'x' is not a number"},
        {{c9_drop, "--to", "none.csv"}, "none.csv"},
        {{c9_drop, "--to", "set.toml"}, "--to: payload.mas: unknown key"},
        {{c9_drop, "--to", "prior.toml"}, "a prior on 'payload.mass', which is not fitted"},
        {{c9_drop, "--to", drop_a, "--vary", "payload.mas"},
         "--vary payload.mas: unknown key, did you mean 'payload.mass'?"},
        {{c9_drop, "--to", drop_a, "--vary", "drag_area"},
         "unknown key, did you mean 'payload.drag_area' or 'parachute.drag_area'?\n"},
        {{c9_drop, "--to", drop_a, "--vary", "zzz.qqqqqq"},
         "unknown key, `twinchute list keys` shows all of them\n"},
        {{c9_drop, "--to", drop_a, "--vary", "parachute.fill_time.n=9..2"}, "the lower bound comes first"},
        {{c9_drop, "--to", drop_a, "--vary", "parachute.fill_time.n=2"}, "bounds are written LO..HI"},
        {{c9_drop, "--to", drop_a, "--vary", "payload.mass=20..200 lb"},
         "one bound has a unit and the other has none"},
        {{c9_drop, "--to", drop_a, "--vary", "payload.mass=200..300"}, "lies outside 200..300"},
        {{c9_drop, "--to", drop_a, "--vary", "parachute.fill_time.n=-1..2"}, "out of its range"},
        {{c9_drop, "--to", drop_a, "--vary", "environment.ground"}, "it is 0 in the scene"},
        {{c9_drop, "--to", drop_a, "--vary", "full.beta"}, "the reduced-order model does not use it"},
        {{shipped_scene("c9-inflation-speeds"), "--to", drop_a}, "a series of"},
    };
    for (const auto& [words, expected] : cases) {
        const std::string complaint = refusal(words);
        EXPECT_TRUE(says(complaint, expected)) << complaint;
        EXPECT_FALSE(says(complaint, "--set")) << complaint;
    }
    EXPECT_EQ(tree_of(here_.path()), before);
}

// Defaults of a record are part of how it was dropped: here the standard atmosphere at 4 km, where the scene
// has the air of sea level.
TEST_F(SystemCalibrate, ARecordBringsItsAirWhetherItWasGivenOrNot) {
    const auto scene = [](const char* air, const char* more = "") {
        return std::string("schema = 1\nname = \"b\"\n") + air + "[payload]\nmass = 100\n" + more +
               "[release]\naltitude = 4000\nspeed = 20\npath_angle = \"90 deg\"\n[[parachute]]\n"
               "nominal_diameter = 8\ndrag_area = 40\nprojected_diameter_ratio = 0.7\nmass = 5\n"
               "deploy = { by = \"line-stretch\" }\nfill_time.n = 8\n[stop]\nat = \"steady-descent\"\n";
    };
    here_.write("standard.toml", scene(""));
    here_.write("sea-level.toml", scene("[environment]\natmosphere = { density = 1.225 }\n"));
    here_.write("drag.toml", scene("", "drag_area = 0.5\n"));
    ASSERT_EQ(run({"rom", "standard.toml", "--quiet", "--out", "record", "--set", "parachute.drag_area=42",
                   "--set", "parachute.fill_time.n=6"})
                  .code,
              0);
    const json found =
        json::parse(run({"calibrate", "sea-level.toml", "--to", "record", "--out", "out", "--json"}).out);
    EXPECT_NEAR(found["parameters"]["parachute.drag_area"]["estimate"].get<double>(), 42.0, 0.05);
    const Ended other = run({"calibrate", "drag.toml", "--to", "record", "--out", "none"});
    EXPECT_EQ(other.code, 2) << other.out;
    EXPECT_TRUE(says(other.err, "the scene gives payload.drag_area")) << other.err;
}

// A record says itself how it was dropped; the model that made it gives its inputs back.
TEST_F(SystemCalibrate, TakesARecord) {
    ASSERT_EQ(run({"rom", c9_drop, "--quiet", "--out", "record", "--set", "payload.mass=120 kg", "--set",
                   "parachute.fill_time.n=5", "--set", "parachute.drag_area=45 m^2"})
                  .code,
              0);
    const Ended ended = run({"calibrate", c9_drop, "--to", "record", "--out", "out", "--json"});
    ASSERT_EQ(ended.code, 0) << ended.err << ended.out;
    const json found = json::parse(ended.out);
    EXPECT_EQ(found["tests"][0]["kind"], "record");
    EXPECT_EQ(found["tests"][0]["conditions"], json({"payload.mass=120"}));
    // To what the record's own tolerance, 1e-6, leaves.
    EXPECT_NEAR(found["parameters"]["parachute.fill_time.n"]["estimate"].get<double>(), 5.0, 1e-3);
    EXPECT_NEAR(found["parameters"]["parachute.drag_area"]["estimate"].get<double>(), 45.0, 1e-2);
    EXPECT_NEAR(found["parameters"]["parachute.initial_drag_area_ratio"]["estimate"].get<double>(), 0.04,
                1e-4);
}

// To runs of another model it is a table of the reduced-order model's own, which the full one does not see.
TEST_F(SystemCalibrate, MakesATableOfAFamilyOfRecords) {
    const std::string coarse = shipped_scene("c9-inflation");
    const Words mesh{"--set", "full.mesh.gore_columns=1", "--set", "full.mesh.gore_rows=4"};
    Words to{"calibrate", coarse};
    for (const std::string mass : {"120", "152.4", "190"}) {
        ASSERT_EQ(
            run(Words{"full", coarse, "--quiet", "--out", mass, "--set", "payload.mass=" + mass} + mesh).code,
            0);
        to = to + Words{"--to", mass};
    }
    const Ended ended = run(to + Words{"--out", "out"});
    ASSERT_EQ(ended.code, 0) << ended.err << ended.out;
    EXPECT_TRUE(text("out/calibration.csv")
                    .starts_with("run,payload_mass,airspeed,air_density,fill_time.n,drag_area,"
                                 "initial_drag_area_ratio\n1,kg,m/s,kg/m^3,1,1,1\n1,120,21,1.225,"));
    EXPECT_TRUE(says(text("out/calibrated.toml"), "calibration = { value = \"calibration.csv\""));
    EXPECT_FALSE(says(text("out/calibrated.toml"), "drag_area ="));
    const Words compare{"compare", "out/calibrated.toml", "--out", "gap", "--json",
                        "--set",   "payload.mass=135"};
    const json gap = json::parse(run(compare + mesh).out);
    const json peak = gap["calibration"]["metrics"]["peak_force_N"];
    EXPECT_EQ(peak["relative_after"], gap["metrics"]["peak_force_N"]["relative"]);
    // The table is made to meet this number: to 1 % between its runs, of which each has 0.2 % for its own.
    EXPECT_LT(std::abs(peak["relative_after"].get<double>()), 0.01);
    EXPECT_NE(peak["relative_before"], peak["relative_after"]);
    EXPECT_EQ(read("gap/full/summary.json")["inputs"]["parachute.drag_area"]["value"], 42.56);
    EXPECT_EQ(read("gap/rom/summary.json")["inputs"]["parachute.drag_area"]["origin"], "calibrated");
    EXPECT_EQ(run({"report", "gap", "--quiet"}).code, run(compare + mesh).code);
    const Ended outside = run({"rom", "out/calibrated.toml", "--set", "payload.mass=300"});
    EXPECT_TRUE(says(outside.out + outside.err, "payload mass 300 kg is outside of its calibration"));
    EXPECT_TRUE(says(refusal({"out/calibrated.toml", "--to", "120"}), "is calibrated already"));
    const std::string schema = TWINCHUTE_SOURCE_DIR "/docs/schema/";
    const Ended checked = run_script("tests/support/check_schema.py",
                                     {schema + "gap.schema.json", "gap/gap.json"}, here_.path());
    if (lacks_python(checked)) GTEST_SKIP() << "no Python with jsonschema (Debian: python3-jsonschema)";
    EXPECT_EQ(checked.code, 0) << checked.out;
    EXPECT_EQ(run_script("tests/support/check_schema.py",
                         {schema + "summary.schema.json", "gap/rom/summary.json"}, here_.path())
                  .code,
              0);
}

// A reefed stage cannot begin with more than the line lets through: half of the default bounds gives no drop.
TEST_F(SystemCalibrate, GoesAroundValuesThatDoNotFitTogether) {
    const std::string reefed = shipped_scene("c9-reefed");
    ASSERT_EQ(run({"rom", reefed, "--quiet", "--out", "record"}).code, 0);
    const Ended ended = run({"calibrate", reefed, "--to", "record", "--out", "out", "--json"});
    ASSERT_EQ(ended.code, 0) << ended.err << ended.out;
    const json ratio = json::parse(ended.out)["parameters"]["parachute.initial_drag_area_ratio"];
    EXPECT_NEAR(ratio["estimate"].get<double>(), 0.04, 1e-4);  // the scene's own
}

TEST_F(SystemCalibrate, ItsJsonKeepsItsSchema) {
    here_.write("speed.toml",
                "[descent_rate]\nvalue = \"8 m/s\"\nsigma = \"2 %\"\n"
                "[[prior]]\nkey = \"parachute.fill_time.n\"\nmean = 4\nsigma = 0.5\n");
    here_.write("two.json",
                run({"calibrate", c9_drop, "--to", drop_a, "--to", drop_b, "--out", "a", "--json"}).out);
    here_.write("held.json", run({"calibrate", c9_drop, "--to", "speed.toml", "--out", "b", "--json"}).out);
    EXPECT_TRUE(read("held.json")["parameters"]["parachute.initial_drag_area_ratio"]["held"].get<bool>());
    const std::string schema = TWINCHUTE_SOURCE_DIR "/docs/schema/calibration.schema.json";
    const Ended ended =
        run_script("tests/support/check_schema.py", {schema, "two.json", "held.json"}, here_.path());
    if (lacks_python(ended)) GTEST_SKIP() << "no Python with jsonschema (Debian: python3-jsonschema)";
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    json wrong = read("two.json");
    wrong["parameters"]["parachute.fill_time.n"]["unheard_of"] = 1;
    here_.write("wrong.json", wrong.dump());
    EXPECT_EQ(run_script("tests/support/check_schema.py", {schema, "wrong.json"}, here_.path()).code, 1);
}

TEST_F(SystemCalibrate, ChecksWithoutFitting) {
    EXPECT_TRUE(
        says(run({"calibrate", c9_drop, "--to", drop_a, "--check"}).out, "is valid; nothing was run"));
    EXPECT_TRUE(nothing_written());
}

}  // namespace
}  // namespace twinchute::test
