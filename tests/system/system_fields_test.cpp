// Fields and meshes as VTK's own reader finds them. Expected values are the history of the same run, the
// circles that the canopy was cut from, and what the program promises of files and exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "tests/support/program_test.hpp"
#include "tests/support/vtk_python.hpp"

namespace twinchute::test {
namespace {

using Names = std::set<std::string>;

// The C-9 of data/parachutes/usaf-c9.toml.
constexpr double nominal_diameter = 8.53, vent_diameter = 0.853;  // [m]
constexpr double fabric_area =
    0.25 * std::numbers::pi * (nominal_diameter * nominal_diameter - vent_diameter * vent_diameter);

/// No fabric is strained or hidden in folds at the start of a uniform mesh of two columns a gore.
const Words uniform{"--set", "full.mesh.grading=uniform"};
/// A full run of a moment: few elements, short flight.
const Words few_elements =
    uniform + Words{"--set", "full.mesh.gore_columns=2", "--set", "full.mesh.gore_rows=4",
                    "--set", "full.mesh.line_elements=4"};
const Words half_a_second = few_elements + Words{"--set", "stop.time=0.5"};

class SystemFields : public ProgramTest {
protected:
    /// Reads a file with VTK.
    json read(const std::string& file) {
        const Ended ended =
            run_vtk_script("tests/support/read_fields.py", {(here_ / file).string()}, here_.path());
        EXPECT_EQ(ended.code, 0) << ended.err;
        return json::parse(ended.out);
    }
    Names names(const std::string& directory) const { return tree_of(here_ / directory); }
};

#define NEEDS_VTK() \
    if (vtk_python().empty()) GTEST_SKIP() << "no Python with VTK's modules (Debian: python3-vtk9)"

/// history.csv by time, exactly as printed.
std::map<double, std::map<std::string, double>> rows_of(const std::string& csv) {
    std::istringstream lines(csv);
    std::string line, field;
    std::vector<std::string> columns;
    std::getline(lines, line);
    for (std::istringstream names(line); std::getline(names, field, ',');)
        columns.push_back(field);
    std::getline(lines, line);  // units
    std::map<double, std::map<std::string, double>> rows;
    while (std::getline(lines, line)) {
        std::istringstream values(line);
        std::map<std::string, double> row;
        for (const std::string& column : columns)
            if (std::getline(values, field, ',') && !field.empty()) row[column] = std::stod(field);
        rows[row.at("time")] = row;
    }
    return rows;
}

TEST_F(SystemFields, VtkReadsBackWhatTheRunWrote) {
    NEEDS_VTK();
    const Ended ended = run(Words{"full", c9_inflation, "--out", "o", "--fields", "20"} + half_a_second);
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.out.find("o/fields.pvd (11 frames)"), std::string::npos) << ended.out;
    const auto history = rows_of(content_of(here_ / "o/history.csv"));
    const json counts = json::parse(run(Words{"mesh", c9_inflation, "--json"} + few_elements).out);

    const json frames = read("o/fields.pvd");
    ASSERT_EQ(frames.size(), 11u);  // 0, 0.05, ... 0.5 s
    double before = -1.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const json& frame = frames[i];
        SCOPED_TRACE(i);
        EXPECT_TRUE(frame["complaints"].empty()) << frame["complaints"];
        const double time = frame["timestep"];
        EXPECT_EQ(frame["time"], time);
        EXPECT_GT(time, before);
        EXPECT_GE(time, 0.05 * static_cast<double>(i) - 1e-9);
        EXPECT_LT(time, 0.05 * static_cast<double>(i) + 1e-3);  // the first step from then on
        before = time;

        EXPECT_EQ(frame["points"], counts["nodes"]);
        EXPECT_EQ(frame["cells"]["5"], counts["triangles"]);
        EXPECT_EQ(frame["cells"]["1"], 1);
        int cables = 0, kind = 0;
        for (const char* name : {"radial tape", "skirt band", "vent band", "line", "riser"}) {
            EXPECT_EQ(frame["kinds"][std::to_string(++kind)], counts["cables"][name]) << name;
            cables += counts["cables"][name].get<int>();
        }
        EXPECT_EQ(frame["cells"]["3"], cables);
        EXPECT_EQ(frame["kinds"]["0"], counts["triangles"]);

        // The row of the history at this very time.
        ASSERT_TRUE(history.contains(time));
        auto row = history.at(time);
        EXPECT_NEAR(frame["payload_position"][2], row["altitude"], 1e-9);
        EXPECT_NEAR(frame["payload_velocity"][2], row["vertical_speed"], 1e-5);
        EXPECT_NEAR(frame["ranges"]["0"]["pressure_Pa"][0], row["canopy_pressure"],
                    1e-6 * row["canopy_pressure"]);
        EXPECT_EQ(frame["ranges"]["0"]["pressure_Pa"][0], frame["ranges"]["0"]["pressure_Pa"][1]);
        // The risers' elastic tension; their viscosity is the difference.
        EXPECT_NEAR(frame["pull_on_payload"], row["force_raw"], 5e-3 * row["force_raw"]);
        EXPECT_GT(row["force_raw"], 100.0);
    }
    EXPECT_NEAR(frames[0]["fabric_area"], fabric_area, 1e-3 * fabric_area);
}

TEST_F(SystemFields, ArraysHaveTheirNamesUnitsAndRanges) {
    NEEDS_VTK();
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "o", "--fields", "2"} + half_a_second).code, 0);
    const json frame = read("o/fields.pvd").back();  // half a second in: fabric under tension
    const std::map<std::string, std::string> cell_types{
        {"kind", "signed char"},      {"stress_first_N_m", "float"}, {"stress_second_N_m", "float"},
        {"strain_first", "float"},    {"strain_second", "float"},    {"wrinkling_state", "signed char"},
        {"cable_tension_N", "float"}, {"cable_strain", "float"},     {"pressure_Pa", "float"}};
    EXPECT_EQ(frame["cell_data"].size(), cell_types.size()) << frame["cell_data"];
    for (const auto& [name, type] : cell_types) {
        ASSERT_TRUE(frame["cell_data"].contains(name)) << name;
        EXPECT_EQ(frame["cell_data"][name]["type"], type) << name;
        EXPECT_EQ(frame["cell_data"][name]["components"], 1) << name;
    }
    ASSERT_EQ(frame["point_data"].size(), 1u);
    EXPECT_EQ(frame["point_data"]["velocity_m_s"]["components"], 3);

    const auto low = [&](int kind, const char* name) {
        return frame["ranges"][std::to_string(kind)][name][0].get<double>();
    };
    const auto high = [&](int kind, const char* name) {
        return frame["ranges"][std::to_string(kind)][name][1].get<double>();
    };
    EXPECT_GT(high(0, "stress_first_N_m"), 1.0);
    EXPECT_GE(low(0, "stress_second_N_m"), -1e-6);  // fabric carries no compression
    EXPECT_GT(high(0, "strain_first"), 1e-5);
    EXPECT_LT(high(0, "strain_first"), 0.5);
    EXPECT_GE(low(0, "strain_second"), -0.5);  // Green: no length is below zero
    EXPECT_GE(low(0, "wrinkling_state"), 0.0);
    EXPECT_LE(high(0, "wrinkling_state"), 2.0);
    EXPECT_GE(high(0, "wrinkling_state"), 1.0);
    EXPECT_EQ(high(0, "cable_tension_N"), 0.0);
    for (int kind = 1; kind <= 6; ++kind) {
        SCOPED_TRACE(kind);
        EXPECT_EQ(low(kind, "wrinkling_state"), -1.0);
        EXPECT_EQ(high(kind, "wrinkling_state"), -1.0);
        for (const char* name :
             {"stress_first_N_m", "stress_second_N_m", "strain_first", "strain_second", "pressure_Pa"}) {
            EXPECT_EQ(low(kind, name), 0.0) << name;
            EXPECT_EQ(high(kind, name), 0.0) << name;
        }
        EXPECT_GE(low(kind, "cable_tension_N"), 0.0);
    }
    EXPECT_GT(high(4, "cable_tension_N"), 1.0);
    EXPECT_GT(high(5, "cable_strain"), 0.0);
    EXPECT_EQ(high(6, "cable_tension_N"), 0.0);
}

TEST_F(SystemFields, TheRunItselfIsTheSameWithThem) {
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "plain"} + half_a_second).code, 0);
    EXPECT_EQ(names("plain"), (Names{"summary.json", "history.csv", "events.csv", "run.html", "frames.bin"}));
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "seen", "--fields", "50"} + half_a_second).code, 0);
    EXPECT_EQ(content_of(here_ / "plain/history.csv"), content_of(here_ / "seen/history.csv"));
    EXPECT_EQ(names("seen").size(), 5u + 2u + 26u);

    const std::string first = content_of(here_ / "seen/fields/frame-000007.vtu");
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "seen", "--fields", "50"} + half_a_second).code, 0);
    EXPECT_EQ(content_of(here_ / "seen/fields/frame-000007.vtu"), first);  // the same bytes
}

TEST_F(SystemFields, ThoseOfAnEarlierRunDoNotSurvive) {
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "o", "--fields", "50"} + half_a_second).code, 0);
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "o", "--fields", "4"} + half_a_second).code, 0);
    EXPECT_EQ(names("o"), (Names{"summary.json", "history.csv", "events.csv", "run.html", "frames.bin",
                                 "fields.pvd", "fields", "fields/frame-000000.vtu", "fields/frame-000001.vtu",
                                 "fields/frame-000002.vtu"}));
    ASSERT_EQ(run({"rom", c9_inflation, "--out", "o", "--quiet"}).code, 0);
    EXPECT_EQ(names("o"), (Names{"summary.json", "history.csv", "events.csv", "run.html"}));
}

TEST_F(SystemFields, ASceneMayAskForThemAndTheOptionHasTheLastWord) {
    const Words asked{"--set", "full.fields_rate=4"};
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "a"} + half_a_second + asked).code, 0);
    EXPECT_EQ(names("a/fields").size(), 3u);
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "b", "--fields", "8"} + half_a_second + asked).code,
              0);
    EXPECT_EQ(names("b/fields").size(), 5u);
    EXPECT_EQ(json::parse(content_of(here_ / "b/summary.json"))["inputs"]["full.fields_rate"]["value"], 8);
}

TEST_F(SystemFields, CompareWritesThemBesideTheFullRecord) {
    const Ended ended = run(Words{"compare", c9_inflation, "--out", "o", "--fields", "4"} + half_a_second);
    ASSERT_LT(ended.code, 2) << ended.err;
    EXPECT_NE(ended.out.find("o/full/fields.pvd (3 frames)"), std::string::npos) << ended.out;
    EXPECT_TRUE(names("o/full").contains("fields/frame-000002.vtu"));
    EXPECT_FALSE(names("o/rom").contains("fields.pvd"));
    ASSERT_LT(run(Words{"compare", c9_inflation, "--out", "o"} + half_a_second).code, 2);
    EXPECT_FALSE(names("o/full").contains("fields"));
}

TEST_F(SystemFields, EveryCaseOfASeriesHasItsOwn) {
    here_.write("series.toml",
                "base = \"c9-inflation.toml\"\n[[case]]\nname = \"light\"\nset = { \"payload.mass\" = 80 }\n"
                "[[case]]\nname = \"heavy\"\nset = { \"payload.mass\" = 250 }\n");
    ASSERT_EQ(
        run(Words{"full", "series.toml", "--quiet", "--out", "o", "--fields", "4"} + half_a_second).code, 0);
    for (const std::string name : {"light", "heavy"})
        EXPECT_EQ(names("o/" + name + "/fields").size(), 3u) << name;
}

TEST_F(SystemFields, ARateIsAPositiveNumber) {
    for (const std::string rate : {"0", "-5", "nan", "inf", "50 Hz", "50x", "fast", "", "1e9"}) {
        const Ended ended = run({"full", c9_inflation, "--fields", rate});
        EXPECT_EQ(ended.code, 2) << rate;
        EXPECT_NE(ended.err.find("fields"), std::string::npos) << ended.err;
    }
    EXPECT_EQ(run({"rom", c9_inflation, "--fields", "50"}).code, 2);  // it has none
    EXPECT_EQ(run({"full", c9_inflation, "--fields", "4", "--fields", "5"}).code, 2);
    EXPECT_TRUE(names("").empty());
}

TEST_F(SystemFields, ThreadsAreAWholeNumberAndChangeNothing) {
    for (const std::string threads : {"0", "-1", "two", "1.5", "2x", "", "1e2", "257"}) {
        const Ended ended = run({"full", c9_inflation, "--threads", threads});
        EXPECT_EQ(ended.code, 2) << threads;
        EXPECT_NE(ended.err.find("--threads"), std::string::npos) << ended.err;
    }
    EXPECT_EQ(run({"rom", c9_inflation, "--threads", "2"}).code, 2);  // it has none
    EXPECT_TRUE(names("").empty());
    const Words fine{"--set", "full.mesh.gore_rows=17",    "--set", "full.mesh.gore_columns=2",
                     "--set", "full.mesh.line_elements=31"};  // enough for two
    for (const std::string threads : {"1", "2"})
        ASSERT_EQ(
            run(Words{"full", c9_inflation, "--out", threads, "--threads", threads} + half_a_second + fine)
                .code,
            0);
    EXPECT_EQ(content_of(here_ / "1/history.csv"), content_of(here_ / "2/history.csv"));
    EXPECT_EQ(json::parse(content_of(here_ / "2/summary.json"))["provenance"]["threads"], 2);
}

TEST_F(SystemFields, AFailedRunKeepsThoseUpToThere) {
    NEEDS_VTK();
    const Ended ended = run(Words{"full", c9_inflation, "--out", "o", "--fields", "1000", "--set",
                                  "full.output_rate=1000", "--set", "full.strain_limit=0.002"} +
                            half_a_second);
    ASSERT_EQ(ended.code, 3) << ended.err;
    const auto history = rows_of(content_of(here_ / "o/history.csv"));
    const auto frames = names("o/fields").size();
    ASSERT_GT(frames, 1u);
    EXPECT_EQ(frames, history.size());  // what was dropped of the one was dropped of the other
    const json last = read(fmt::format("o/fields/frame-{:06}.vtu", frames - 1));
    EXPECT_TRUE(history.contains(last[0]["time"].get<double>()));
    EXPECT_LT(last[0]["ranges"]["0"]["strain_first"][1], 0.01);
}

TEST_F(SystemFields, AnInterruptedRunKeepsThoseUpToThere) {
    NEEDS_VTK();
    Process process(
        program({"full", c9_inflation, "--out", "o", "--fields", "100", "--set", "stop.time=1000"}) +
            few_elements,
        here_.path());
    ASSERT_TRUE(process.wait_until_handled(SIGINT));
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    ::kill(process.id(), SIGINT);
    const Ended ended = process.wait();
    ASSERT_EQ(ended.code, 130) << ended.err;
    const auto history = rows_of(content_of(here_ / "o/history.csv"));
    const json frames = read("o/fields.pvd");
    ASSERT_GE(frames.size(), 1u);
    EXPECT_EQ(names("o/fields").size(), frames.size());
    for (const json& frame : frames)
        EXPECT_TRUE(history.contains(frame["timestep"].get<double>())) << frame["timestep"];
}

TEST_F(SystemFields, PicturesNeedNoDisplay) {
    NEEDS_VTK();
    ASSERT_EQ(run(Words{"full", c9_inflation, "--out", "o", "--fields", "4"} + half_a_second).code, 0);
    for (const std::string field : {"stress", "strain", "wrinkling"}) {
        const Ended ended = run_vtk_script(
            "docs/pictures/render_fields.py",
            {"o/fields.pvd", field + ".png", "--times", "0", "0.5", "--by", field, "--height", "200"},
            here_.path());
        EXPECT_EQ(ended.code, 0) << ended.err;
        EXPECT_TRUE(content_of(here_ / (field + ".png")).starts_with("\x89PNG\r\n")) << field;
    }
}

// --- the command mesh ---------------------------------------------------------------------------

TEST_F(SystemFields, AMeshIsOfTheParachuteThatIsNamed) {
    // Each is held against what the scene says of it, within a hundredth; of a cluster it is one canopy.
    const std::string drogue_and_main = shipped_scene("c9-drogue");
    const Ended unnamed = run({"mesh", drogue_and_main});
    EXPECT_EQ(unnamed.code, 2);
    EXPECT_TRUE(says(unnamed.err, "several parachutes (drogue, main), name one with --parachute"))
        << unnamed.err;
    for (const auto& [name, mass] : {std::pair{"drogue", 0.354}, {"main", 5.19}}) {
        const Ended ended = run({"mesh", drogue_and_main, "--parachute", name, "--json"});
        ASSERT_EQ(ended.code, 0) << ended.err;
        const json mesh = json::parse(ended.out);
        EXPECT_EQ(mesh["parachute"], name);
        EXPECT_NEAR(mesh["mass_kg"]["total"], mass, 0.01 * mass);
        EXPECT_TRUE(
            says(run({"mesh", drogue_and_main, "--parachute", name}).out, std::string(", ") + name + "\n"));
    }
    EXPECT_EQ(run({"mesh", drogue_and_main, "--parachute", "mine"}).code, 2);
    EXPECT_TRUE(says(run({"mesh", shipped_scene("c9-cluster")}).out, ", one of 3\n"));
}

TEST_F(SystemFields, AMeshWeighsAndMeasuresWhatItWasCutFrom) {
    const Ended ended = run({"mesh", c9_inflation, "--json"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json mesh = json::parse(ended.out);
    EXPECT_NEAR(mesh["fabric_area_m2"], fabric_area, 1e-9 * fabric_area);
    EXPECT_NEAR(mesh["nominal_area_m2"].get<double>() - mesh["vent_area_m2"].get<double>(), fabric_area,
                1e-9);
    // 28 gores of 4 columns and 9 rows, but one at the vent; 28 lines of 34 elements, 4 risers of 5; the
    // payload is a riser's end.
    EXPECT_EQ(mesh["grading"], "graded");
    EXPECT_EQ(mesh["triangles"], 28 * (2 * 9 * 4 - 3));
    EXPECT_EQ(mesh["nodes"], 28 * (4 * 9 + 1) + 28 * 33 + 4 * 5 + 1);
    EXPECT_EQ(mesh["cables"]["line"], 28 * 34);
    EXPECT_EQ(mesh["cables"]["riser"], 4 * 5);
    const json& mass = mesh["mass_kg"];
    double sum = 0.0;
    for (const char* part : {"fabric", "radial tape", "skirt band", "vent band", "line", "riser"})
        sum += mass[part].get<double>();
    EXPECT_NEAR(mass["total"], sum, 1e-12);
    EXPECT_EQ(mass["parachute.mass"], 5.19);
    EXPECT_NEAR(mass["total"], 5.19, 0.02 * 5.19);
    EXPECT_TRUE(names("").empty());  // without --out nothing is written
}

TEST_F(SystemFields, AMeshIsReadByVtk) {
    NEEDS_VTK();
    ASSERT_EQ(
        run(Words{"mesh", c9_inflation, "--out", "there/c9.vtu", "--set", "payload.mass=100"} + uniform).code,
        0);
    const json counts = json::parse(run(Words{"mesh", c9_inflation, "--json"} + uniform).out);
    EXPECT_EQ(counts["grading"], "uniform");
    const json mesh = read("there/c9.vtu")[0];
    EXPECT_TRUE(mesh["complaints"].empty());
    EXPECT_EQ(mesh["points"], counts["nodes"]);
    EXPECT_NEAR(mesh["fabric_area"], fabric_area, 1e-9 * fabric_area);  // drawn out without strain
    EXPECT_NEAR(mesh["cell_data"]["area_m2"]["sum"], fabric_area, 1e-6 * fabric_area);
    EXPECT_NEAR(mesh["point_data"]["mass_kg"]["sum"], 100.0 + counts["mass_kg"]["total"].get<double>(), 1e-9);
    EXPECT_EQ(names("there"), (Names{"c9.vtu"}));
}

TEST_F(SystemFields, APackedSceneHasItsPackBeside) {
    NEEDS_VTK();
    const Words packed{"--set", "parachute.deploy.by=static-line",  "--set", "parachute.deploy.length=12.2",
                       "--set", "parachute.deploy.pack_ratio=0.02", "--set", "full.contact=none"};
    ASSERT_EQ(run(Words{"mesh", c9_inflation, "--out", "c9.vtu"} + packed).code, 0);
    ASSERT_EQ(names(""), (Names{"c9.vtu", "c9-packed.vtu"}));
    const json open = read("c9.vtu")[0], pack = read("c9-packed.vtu")[0];
    EXPECT_EQ(open["cells"], pack["cells"]);
    for (int i = 0; i < 6; ++i)
        EXPECT_NEAR(pack["bounds"][i], 0.02 * open["bounds"][i].get<double>(), 1e-12) << i;
    EXPECT_NEAR(pack["cell_data"]["area_m2"]["sum"], fabric_area, 1e-6 * fabric_area);  // what it was cut
}

TEST_F(SystemFields, AMeshOfASeriesLiesInTheFolderOfItsCase) {
    const std::string series = shipped_scene("c9-inflation-speeds");
    ASSERT_EQ(run({"mesh", series, "--out", "o/c9.vtu", "--quiet"}).out, "");
    const Names found = names("o");
    EXPECT_EQ(std::ranges::count_if(found, [](const auto& name) { return name.ends_with("/c9.vtu"); }), 3);
    EXPECT_EQ(json::parse(run({"mesh", series, "--json"}).out).size(), 3u);
}

TEST_F(SystemFields, AMeshOverwritesNobodyElsesFile) {
    here_.write("thesis.vtu", "years of work");
    EXPECT_EQ(run({"mesh", c9_inflation, "--out", "thesis.vtu"}).code, 2);
    EXPECT_EQ(content_of(here_ / "thesis.vtu"), "years of work");
    for (const std::string name : {"c9.txt", "c9", "", ".vtu", "o/"})
        EXPECT_EQ(run({"mesh", c9_inflation, "--out", name}).code, 2) << name;
    EXPECT_EQ(run({"mesh", c9_inflation, "--out", "thesis.vtu/c9.vtu"}).code, 4);
    EXPECT_EQ(run({"mesh", "no-such.toml"}).code, 2);
    EXPECT_EQ(run({"mesh", c9_inflation, "--set", "payload.mass=-1"}).code, 2);
    EXPECT_EQ(run({"mesh", c9_inflation, "--check", "--out", "c9.vtu"}).code, 0);
    EXPECT_EQ(names(""), (Names{"thesis.vtu"}));
    ASSERT_EQ(run({"mesh", c9_inflation, "--out", "c9.vtu"}).code, 0);
    EXPECT_EQ(run({"mesh", c9_inflation, "--out", "c9.vtu"}).code, 0);  // our own may be written again
}

}  // namespace
}  // namespace twinchute::test
