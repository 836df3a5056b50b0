// `twinchute import` and `export` as a script sees them. The examples are written by hand, see data/import/.
#include <fmt/format.h>

#include <cmath>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

const std::string rocket_design = TWINCHUTE_SOURCE_DIR "/data/import/rocket-dual-deploy.ork";
const std::string rocketpy_flight = TWINCHUTE_SOURCE_DIR "/data/import/rocketpy-flight.rpy";

class SystemImport : public ProgramTest {
protected:
    static bool says(const std::string& text, std::string_view what) {
        return text.find(what) != std::string::npos;
    }
};

TEST_F(SystemImport, AnImportedSceneRunsAtOnceAndLandsAtItsSteadyRate) {
    const Ended ended = run({"import", rocket_design, "--out", "there/rocket.toml"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const char* what : {"taken over", "assumed", "not taken over", "landing", "'Spare'"})
        EXPECT_TRUE(says(ended.out, what)) << what << "\n" << ended.out;
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"there", "there/rocket.toml"}));
    EXPECT_TRUE(says(text("there/rocket.toml"), "#   - parachute 'Spare'"));
    const json made = json::parse(run({"import", rocket_design, "--json"}).out);
    // sqrt(2 m g/(rho (C_D S of both))) at sea level: 1.5 kg, 9.79 m/s^2, 1.225 kg/m^3, drogue and main. Six
    // digits are written and the integrator takes 1e-6; the last 0.05 % are that the air above is thinner.
    const double drag_area = 0.25 * M_PI * (0.8 * 1.2 * 1.2 + 0.75 * 0.45 * 0.45);
    const double steady = std::sqrt(2.0 * 1.5 * 9.79 / (1.225 * drag_area));
    EXPECT_NEAR(made["descent_rate_m_s"].get<double>(), steady, 5e-4 * steady);
    const Ended again = run({"rom", "there/rocket.toml", "--json"});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["status"]["code"], "completed");
    EXPECT_EQ(run({"import", rocket_design, "--out", "there/rocket.toml"}).code, 0);  // its own, once more
}

TEST_F(SystemImport, WithoutOutItPrintsTheSceneAlone) {
    const Ended ended = run({"import", rocketpy_flight});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    here_.write("scene.toml", ended.out);
    EXPECT_EQ(run({"rom", "scene.toml", "--quiet"}).code, 0);
    std::filesystem::remove(here_ / "scene.toml");
    EXPECT_EQ(run({"import", rocketpy_flight, "--quiet"}).out, "");
    EXPECT_TRUE(
        says(run({"import", rocketpy_flight, "--check", "--out", "a.toml"}).out, "nothing was written"));
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemImport, RefusesAndWritesNothing) {
    here_.write("mine.toml", "schema = 1\n");
    here_.write("p.json", R"([{"name": "M", "cd_s": 1, "trigger": "apogee"}])");
    here_.write("what.txt", "hello\n");
    here_.write("s.txt", "   PRES   HGHT   TEMP   DWPT\n    hPa      m      C      C\n");
    for (const auto& [words, message] : {
             std::pair<Words, std::string>{{"p.json"}, "payload.mass (the file keeps parachutes alone"},
             // 1 m2 over C_D0 = 0.75, 60 g a square metre
             {{"p.json"}, "its dry mass less the 0.08 kg that the parachutes are assumed to weigh"},
             {{"p.json", "--set", "payload.mass=1 kg", "--set", "release.height=x"}, "release.height"},
             {{"p.json", "--set", "payload.mass=1 kg", "--set", "release.height=1 km", "--set",
               "payload.colour=3"},
              "colour"},
             {{"p.json", "--set", "payload.mass=1 kg", "--set", "release.height=1 km", "--set",
               "parachute.fill_time.n=1"},
              "the scene made from it does not run"},
             {{"what.txt"}, "neither XML"},
             {{"s.txt"}, "is a sounding"},
             {{"none.ork"}, "no such file"},
             {{rocket_design, "--out", "mine.toml"}, "was not written by `twinchute import`"},
             {{rocket_design, "--out", "a.txt"}, "a .toml file is wanted"},
             {{rocket_design, "--device", "drogu"}, "'Drogue'"},
         }) {
        const Ended ended = run(Words{"import"} + words);
        EXPECT_EQ(ended.code, 2) << message;
        EXPECT_TRUE(says(ended.err, message)) << message << "\n" << ended.err;
    }
    EXPECT_EQ(tree_of(here_.path()), (std::set<std::string>{"mine.toml", "p.json", "s.txt", "what.txt"}));
    EXPECT_EQ(text("mine.toml"), "schema = 1\n");
}

TEST_F(SystemImport, WindByAltitudeIsAFileBesideTheScene) {
    std::string design = content_of(rocket_design);
    const std::string speed = "<windmodeltype>Average</windmodeltype>";
    design.replace(design.find(speed), speed.size(),
                   "<wind model=\"multilevel\" altituderef=\"agl\"><windlevel altitude=\"0\" speed=\"2\" "
                   "direction=\"0\"/>"
                   "<windlevel altitude=\"400\" speed=\"6\" "
                   "direction=\"0\"/></wind><windmodeltype>Multilevel</windmodeltype>");
    here_.write("r.ork", design);
    EXPECT_EQ(run({"import", "r.ork", "--out", "r.toml"}).code, 0);
    EXPECT_EQ(text("r-wind.csv"), "altitude,speed,from\nm,m/s,deg\n0,2,0\n400,6,0\n");
    EXPECT_LT(json::parse(run({"rom", "r.toml", "--json"}).out)["metrics"]["landing_north_m"].get<double>(),
              -50.0);
    EXPECT_TRUE(says(run({"import", "r.ork"}).out, "wind by altitude: it is a file beside the scene"));
}

/// Fall under a drogue, the larger main and a reserve, which all stay.
const std::string three_parachutes = R"(schema = 1
name = "three"
[environment]
atmosphere = { density = 1.2 }
[payload]
mass = 10
drag_area = 0.05
[release]
height = 1000
speed = 10
path_angle = "90 deg"
[[parachute]]
name = "class"
nominal_diameter = 0.6
drag_area = 0.2
mass = 0.1
deploy = { by = "line-stretch", when = { at = "release", delay = 1 } }
fill_time.n = 2
[[parachute]]
name = "main-1"
nominal_diameter = 2.4
drag_area = 3
mass = 0.4
deploy = { by = "line-stretch", when = { height = 400 } }
fill_time.n = 2
[[parachute]]
name = "reserve"
nominal_diameter = 1.4
drag_area = 1
mass = 0.2
deploy = { by = "line-stretch", when = { height = 200 } }
fill_time.n = 2
[stop]
at = "ground"
)";

TEST_F(SystemImport, ExportPrintsPythonOrWritesIt) {
    const Ended ended = run({"export", shipped_scene("rocket-dual-deploy"), "--to", "rocketpy"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_TRUE(says(ended.out, "main = Parachute(\n")) << ended.out;
    EXPECT_TRUE(nothing_written());
    EXPECT_EQ(run({"export", shipped_scene("rocket-dual-deploy"), "--to", "rocketpy", "--out", "p.py"}).code,
              0);
    EXPECT_EQ(text("p.py"), ended.out);
    EXPECT_EQ(run({"export", c9_inflation}).code, 2);
    EXPECT_EQ(run({"export", c9_inflation, "--to", "openrocket"}).code, 2);
    EXPECT_EQ(run({"export", c9_inflation, "--to", "rocketpy", "--position=1,2"}).code, 2);
    EXPECT_EQ(run({"export", shipped_scene("rocket-dual-deploy"), "--to", "rocketpy", "--out", "p.kml"}).code,
              2);
    // Three hemispheres of air have the added mass of one with 3^(1/3) times their radius, 0.325 D0 with D0
    // of 8.53 m.
    EXPECT_TRUE(says(run({"export", shipped_scene("c9-cluster"), "--to", "rocketpy"}).out,
                     fmt::format("radius={:.6g},", 0.5 * 0.65 * 8.53 * std::cbrt(3.0))));
    // No keywords of Python; what RocketPy drops is what opens before another, however large.
    here_.write("three.toml", three_parachutes);
    const std::string three = run({"export", "three.toml", "--to", "rocketpy"}).out;
    for (const char* variable : {"parachute_class = ", "main_1 = ", "reserve = "})
        EXPECT_TRUE(says(three, variable)) << variable << three;
    const auto dropped = [&](const char* variable) {
        const std::size_t end = three.find(variable), begin = three.rfind("\n\n", end);
        return three.substr(begin, end - begin).find("once the next parachute is open") != std::string::npos;
    };
    EXPECT_TRUE(dropped("parachute_class = "));
    EXPECT_TRUE(dropped("main_1 = "));
    EXPECT_FALSE(dropped("reserve = "));
    // A name as a metric has it, and the filling time of its last stage alone: RocketPy has no drag before.
    const auto lag = [&](const Words& words) {
        const std::string out = run(words).out;
        return std::stod(out.substr(out.find("lag=") + 4));
    };
    std::string named = content_of(shipped_scene("rocket-dual-deploy"));
    for (std::size_t at = 0; (at = named.find("drogue\"", at)) != std::string::npos; at += 10)
        named.replace(at, 6, "The-Drogue");
    here_.write("named.toml", named);
    EXPECT_EQ(lag({"export", "named.toml", "--to", "rocketpy"}),
              lag({"export", shipped_scene("rocket-dual-deploy"), "--to", "rocketpy"}));
    const Words reefed{"rom", shipped_scene("capsule-reefed"), "--json"};
    EXPECT_NEAR(lag({"export", shipped_scene("capsule-reefed"), "--to", "rocketpy"}),
                json::parse(run(reefed).out)["metrics"]["stage_3_filling_time_s"].get<double>(), 1e-4);
    // A map shows all of a flight that is handed over, to the ground.
    EXPECT_TRUE(says(run({"export", shipped_scene("c9-drift"), "--to", "geojson", "--position=47,8", "--set",
                          "stop={at='full-open',then='rom'}"})
                         .out,
                     "landing"));
    const Ended sonde = run({"export", shipped_scene("sonde"), "--to", "rocketpy"});
    EXPECT_EQ(sonde.code, 2);
    EXPECT_TRUE(says(sonde.err, "a condition that RocketPy does not have")) << sonde.err;
}

TEST_F(SystemImport, AFlightOnAMapLandsWhereItsMetricsSay) {
    const Words rocket{"export", shipped_scene("rocket-dual-deploy"), "--to", "geojson"};
    const json map = json::parse(run(rocket + Words{"--position", "-33.9,18.4"}).out);
    const json landing = map["features"].back()["geometry"]["coordinates"];
    const json metrics =
        json::parse(run({"rom", shipped_scene("rocket-dual-deploy"), "--json"}).out)["metrics"];
    // A sphere of 6371 km is within 0.4 % of WGS 84 here.
    const double degree = 6371000.0 * M_PI / 180.0;
    const double east = (landing[0].get<double>() - 18.4) * degree * std::cos(33.9 * M_PI / 180.0);
    EXPECT_NEAR(east, metrics["landing_east_m"].get<double>(), 0.004 * east);
    EXPECT_GT(east, 100.0);
    EXPECT_NEAR(landing[1].get<double>(), -33.9, 1e-9);
    EXPECT_EQ(run(rocket).code, 2);  // where is it?
    for (const char* place : {"91,0", "a,b", "47.3", "47.3,", ",8", "1,2,3", "nan,0"})
        EXPECT_EQ(run(rocket + Words{"--position", place}).code, 2) << place;
    EXPECT_EQ(run(rocket + Words{"--position", "-33.9,18.4", "--out", "f.geojson"}).code, 0);
    EXPECT_EQ(run(rocket + Words{"--position", "-33.9,18.4", "--out", "f.geojson"}).code,
              0);  // its own, once more
    here_.write("mine.geojson", "{}");
    EXPECT_EQ(run(rocket + Words{"--position", "-33.9,18.4", "--out", "mine.geojson"}).code, 2);
}

}  // namespace
}  // namespace twinchute::test
