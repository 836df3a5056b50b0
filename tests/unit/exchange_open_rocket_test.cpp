// OpenRocket designs: what is taken over, from which packing, and what is refused. The designs here and in
// data/import/ are written by hand after OpenRocket's file specification.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <minizip/zip.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "lib/cli/command.hpp"
#include "lib/exchange/packed_file.hpp"
#include "lib/exchange/read_design.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {
namespace {

using namespace twinchute::exchange;

const std::string example_design = TWINCHUTE_SOURCE_DIR "/data/import/rocket-dual-deploy.ork";

ImportedScene imported(const std::string& xml, const ImportChoice& choice = {}) {
    return read_open_rocket(xml, "t.ork", choice);
}

/// The scene that a design leads to, as a run would read it.
Scene scene_of(const ImportedScene& made) {
    EXPECT_EQ(missing_values(made), std::vector<std::string>{});
    return read_scene_text(scene_text(made, "t.ork", ""), "t.toml", ".");
}

bool mentions(const std::vector<std::string>& lines, std::string_view what) {
    return std::ranges::any_of(lines,
                               [&](const std::string& line) { return line.find(what) != std::string::npos; });
}

/// A design of one stage with these components and simulations.
std::string design(const std::string& components, const std::string& simulations = "",
                   const std::string& stage = "") {
    return "<?xml version='1.0'?>\n<openrocket version=\"1.8\" creator=\"OpenRocket "
           "22.02\">\n<rocket><name>r</name>\n"
           "<subcomponents><stage><name>S</name>" +
           stage + "<subcomponents>\n" + components +
           "\n</subcomponents></stage></subcomponents></rocket>\n<simulations>" + simulations +
           "</simulations></openrocket>\n";
}

const std::string chute =
    "<parachute><name>C</name><overridemass>0.1</overridemass><cd>0.75</cd><deployevent>apogee</deployevent>"
    "<diameter>1</diameter></parachute>";
const std::string stage_mass =
    "<overridemass>2</overridemass><overridesubcomponentsmass>true</overridesubcomponentsmass>";

std::string summary_simulation(const std::string& conditions = "") {
    return "<simulation status=\"outdated\"><name>one</name><conditions>" + conditions +
           "</conditions><flightdata maxaltitude=\"300\" timetoapogee=\"8\" "
           "groundhitvelocity=\"7.4\"/></simulation>";
}

TEST(OpenRocket, TakesDrogueMainAndFlightOfTheStageThatIsFlown) {
    const ImportedScene made = imported(read_text_file(example_design));
    const Scene scene = scene_of(made);
    ASSERT_EQ(scene.parachutes.size(), 2u);
    const Parachute &main = scene.parachutes[0], &drogue = scene.parachutes[1];
    EXPECT_EQ(main.name, "main-48");
    // "auto" of a parachute is 0.8 on pi/4 D^2 in OpenRocket; six digits are written.
    EXPECT_NEAR(main.drag_area, 0.8 * 0.25 * pi * 1.2 * 1.2, 1e-6);
    EXPECT_NEAR(drogue.drag_area, 0.75 * 0.25 * pi * 0.45 * 0.45, 1e-6);
    EXPECT_NEAR(main.mass, 0.06, 1e-9);
    // Fabric and lines by their densities.
    const double drogue_mass = 0.25 * pi * 0.45 * 0.45 * 0.067 + 8 * 0.5 * 0.0018;
    EXPECT_NEAR(drogue.mass, drogue_mass, 1e-7);
    EXPECT_NEAR(scene.payload.mass + main.mass + drogue.mass, 1.5, 1e-5);  // that of the stored flight's end
    ASSERT_TRUE(main.deploy_when && drogue.deploy_when);
    EXPECT_EQ(main.deploy_when->kind, Trigger::Kind::altitude);
    EXPECT_NEAR(main.deploy_when->value, 150.0, 1e-9);  // of the flown configuration, not the design's 200 m
    EXPECT_EQ(drogue.deploy_when->kind, Trigger::Kind::apogee);
    EXPECT_NEAR(drogue.deploy_when->delay, 0.5, 1e-9);
    EXPECT_NEAR(scene.release.altitude, 400.0, 1e-9);
    EXPECT_NEAR(scene.release.speed, 12.0, 1e-9);
    EXPECT_NEAR(scene.release.path_angle, 0.0, 1e-9);
    EXPECT_NEAR(scene.release.heading, 0.5 * pi, 1e-9);
    EXPECT_NEAR(scene.environment.gravity, 9.79, 1e-9);
    EXPECT_FALSE(scene.environment.wind);
    for (const char* what : {"'Spare': it never deploys", "'Booster streamer': it is of the stage 'Booster'",
                             "shock cord 'Shock cord'", "'Not flown'", "latitude 28.61, longitude -80.6"})
        EXPECT_TRUE(mentions(made.left_out, what)) << what;
    EXPECT_NEAR(made.stated_landing_speed.value(), 4.839, 0.001);
}

TEST(OpenRocket, ADeviceOfAnotherStageIsTakenByItsName) {
    const ImportedScene made = imported(read_text_file(example_design), {{"Booster streamer"}, ""});
    const Scene scene = scene_of(made);
    ASSERT_EQ(scene.parachutes.size(), 1u);
    // OpenRocket's automatic C_D of a streamer, 0.034 (m + 0.025)/0.105 (l + 1)/l, on its area.
    EXPECT_NEAR(scene.parachutes[0].drag_area, 0.034 * (0.065 / 0.105) * (1.5 / 0.5) * 0.5 * 0.05, 1e-8);
    EXPECT_NEAR(scene.payload.mass, 0.2 - 0.5 * 0.05 * 0.04, 1e-6);
    // It deploys 1.5 s after apogee: the scene begins there.
    EXPECT_FALSE(scene.parachutes[0].deploy_when);
    EXPECT_NEAR(scene.release.altitude, 292.0, 1e-9);
    EXPECT_NEAR(scene.release.speed * std::sin(scene.release.path_angle), 14.7, 1e-4);
    EXPECT_TRUE(mentions(made.assumptions, "1.5 s after apogee"));
    EXPECT_THROW(imported(read_text_file(example_design), {{"drouge"}, ""}), SceneError);
    EXPECT_THROW(imported(read_text_file(example_design), {{"Spare"}, ""}), SceneError);
    EXPECT_THROW(imported(read_text_file(example_design), {{}, "Simulation 9"}), SceneError);
}

TEST(OpenRocket, WithoutAFlightItAsksForWhatCannotBeKnown) {
    EXPECT_EQ(missing_values(imported(design(chute))).size(), 2u);  // payload.mass and release.height
    const ImportedScene made = imported(design(chute, summary_simulation(), stage_mass));
    const Scene scene = scene_of(made);
    EXPECT_NEAR(scene.payload.mass, 1.9, 1e-9);
    EXPECT_NEAR(scene.release.altitude, 300.0, 1e-9);
    EXPECT_TRUE(mentions(made.assumptions, "burnt-out motor"));
    EXPECT_TRUE(mentions(made.assumptions, "outdated"));
    // Up to file format 1.9 the ground-hit velocity is that through the air.
    EXPECT_EQ(made.stated_landing_speed.value(), 7.4);
    EXPECT_FALSE(made.stated_over_ground);
}

TEST(OpenRocket, ALongFallWithoutAnyDragIsNotAssumed) {
    std::string low = chute;
    low.replace(low.find("apogee"), 6, "altitude");
    const auto missing = missing_values(imported(design(low, summary_simulation(), stage_mass)));
    ASSERT_EQ(missing.size(), 1u);
    EXPECT_EQ(missing.front().substr(0, 17), "payload.drag_area");
}

TEST(OpenRocket, SetGivesAndReplacesKeys) {
    ImportedScene made = imported(design(chute, summary_simulation()));
    set_keys(made, {"payload.mass=1200 g", "release.altitude='450 m'", "parachute.drag_coefficient=0.6"});
    const Scene scene = scene_of(made);
    EXPECT_NEAR(scene.payload.mass, 1.2, 1e-12);
    EXPECT_NEAR(scene.release.altitude, 450.0, 1e-12);  // in place of the height
    EXPECT_NEAR(scene.parachutes[0].drag_area, 0.6 * 0.25 * pi, 1e-12);
    EXPECT_THROW(set_keys(made, {"parachute.deploy.when.delay='1 s'"}), UsageError);  // half a trigger
    EXPECT_THROW(set_keys(made, {"payload.mass"}), UsageError);
    EXPECT_THROW(set_keys(made, {"= 3"}), UsageError);
}

TEST(OpenRocket, MeasuredAirHasItsDensityAtTheLaunchSite) {
    const Scene scene = scene_of(imported(design(
        chute,
        summary_simulation("<launchaltitude>1400</launchaltitude><atmosphere model=\"extendedisa\">"
                           "<basetemperature>303.15</basetemperature><basepressure>86500</basepressure>"
                           "</atmosphere>"),
        stage_mass)));
    EXPECT_NEAR(scene.environment.ground, 1400.0, 1e-9);
    // Gas law with R = 287.053 J/(kg K); six digits of an offset of some 20 K are written.
    EXPECT_NEAR(scene.environment.atmosphere.at(1400.0).density, 86500.0 / (287.053 * 303.15), 1e-5);
}

TEST(OpenRocket, WindComesFromItsDirectionAtItsLevels) {
    const std::string two =
        "<launchaltitude>100</launchaltitude><wind model=\"multilevel\" altituderef=\"agl\">"
        "<windlevel altitude=\"1000\" speed=\"9\" direction=\"3.14159265\" standarddeviation=\"1\"/>"
        "<windlevel altitude=\"0\" speed=\"4\" direction=\"1.57079633\" standarddeviation=\"1\"/></wind>"
        "<windmodeltype>Multilevel</windmodeltype>";
    const ImportedScene made = imported(design(chute, summary_simulation(two), stage_mass));
    ASSERT_EQ(made.wind.size(), 2u);
    EXPECT_NEAR(made.wind[0].altitude, 100.0, 1e-12);  // above sea level, sorted
    EXPECT_NEAR(made.wind[1].altitude, 1100.0, 1e-12);
    EXPECT_EQ(wind_table_text(made.wind), "altitude,speed,from\nm,m/s,deg\n100,4,90\n1100,9,180\n");
    const Scene blown = scene_of(imported(
        design(chute, summary_simulation("<windaverage>3</windaverage><winddirection>0</winddirection>"),
               stage_mass)));
    ASSERT_TRUE(blown.environment.wind);
    EXPECT_NEAR(blown.environment.wind->levels.front().velocity.y(), -3.0, 1e-9);  // from the north
}

TEST(OpenRocket, OpeningAtRestFillsWithinOneDiameterOfFall) {
    const Scene scene = scene_of(imported(design(chute, summary_simulation(), stage_mass)));
    // sqrt(2 D0/g) with D0 = 1 m
    EXPECT_NEAR(scene.parachutes[0].fill_time.given, std::sqrt(2.0 / 9.80665), 1e-6);
}

TEST(OpenRocket, InstancesOfPodsAndTubesAreACluster) {
    const std::string pods =
        "<podset><name>P</name><instancecount>2</instancecount><subcomponents><innertube>"
        "<clusterconfiguration>3-ring</clusterconfiguration><subcomponents>" +
        chute + "</subcomponents></innertube></subcomponents></podset>";
    EXPECT_EQ(scene_of(imported(design(pods, summary_simulation(), stage_mass))).parachutes[0].count, 6);
}

TEST(OpenRocket, RefusesWhatItCannotRead) {
    struct Bad {
        std::string xml, message;
        int line;
    };
    std::string nested;
    for (int i = 0; i < 80; ++i)
        nested += "<bodytube><subcomponents>";
    nested += chute;
    for (int i = 0; i < 80; ++i)
        nested += "</subcomponents></bodytube>";
    const auto with = [](std::string text, std::string_view what, std::string_view by) {
        return design(text.replace(text.find(what), what.size(), by), summary_simulation(), stage_mass);
    };
    for (const Bad& bad :
         {Bad{"<openrocket><rocket>", "not XML", 1}, Bad{"<html/>", "without <rocket>", 1},
          Bad{design("<nosecone/>"), "has no recovery device", 0}, Bad{design(nested), "lies too deep", 5},
          Bad{with(chute, "<diameter>1<", "<diameter>-1<"), "diameter: '-1' is not taken", 5},
          Bad{with(chute, "<diameter>1<", "<diameter>nan<"), "diameter: 'nan' is not taken", 5},
          Bad{with(chute, "<diameter>1</diameter>", ""), "<diameter> is missing", 5},
          Bad{with(chute, "<cd>0.75<", "<cd>x<"), "cd: 'x' is not taken", 5},
          Bad{with(chute, "apogee", "never"), "has no recovery device that deploys", 0}}) {
        try {
            imported(bad.xml);
            ADD_FAILURE() << bad.message;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(bad.message), std::string::npos) << error.what();
            EXPECT_EQ(error.place().line, bad.line) << error.what();
            EXPECT_EQ(error.place().file, "t.ork");
        }
    }
}

TEST(OpenRocket, NamesAreHarmlessWhateverTheyHold) {
    std::string evil = chute;
    evil.replace(evil.find(">C<"), 3, ">&lt;\"]]\\ \n[payload]\nmass = 1 &#27;[2J<");
    const ImportedScene made = imported(design(evil, summary_simulation(), stage_mass));
    const Scene scene = scene_of(made);  // the text is one scene, with the mass of the stage
    EXPECT_NEAR(scene.payload.mass, 1.9, 1e-9);
    EXPECT_EQ(scene_text(made, "t\n[x]", "").find("\n[x]"), std::string::npos);
    EXPECT_EQ(parachute_name("1", {}), "parachute-1");  // a number would be a place in the scene
    EXPECT_EQ(parachute_name("Main", {"main"}), "main-2");
    EXPECT_EQ(one_line("a\xff\xc3\xa9\x1b"), "a?\xc3\xa9?");
}

TEST(OpenRocket, ExternalEntitiesStayNames) {
    std::string xml = design(chute, summary_simulation(), stage_mass);
    xml.replace(xml.find("<openrocket"), 0,
                "<!DOCTYPE r [<!ENTITY e SYSTEM \"file:///etc/passwd\"><!ENTITY a \"&b;&b;\"><!ENTITY b "
                "\"bbbb\">]>\n");
    xml.replace(xml.find("<name>r<"), 8, "<name>&e;&a;<");
    EXPECT_EQ(scene_of(imported(xml)).name, "&e;&a;");
}

// --- packing -----------------------------------------------------------------------------------------

std::string zipped(const ScratchDir& here, const std::string& member, const std::string& content) {
    const std::string name = (here / "z.ork").string();
    zipFile zip = zipOpen64(name.c_str(), APPEND_STATUS_CREATE);
    const zip_fileinfo info{};
    for (const auto& [path, text] :
         {std::pair<std::string, std::string>{"decals/a.png", "x"}, {member, content}}) {
        zipOpenNewFileInZip64(zip, path.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 6, 0);
        zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size()));
        zipCloseFileInZip(zip);
    }
    zipClose(zip, nullptr);
    return name;
}

std::string gzipped(const ScratchDir& here, const std::string& content) {
    const std::string name = (here / "g.ork").string();
    gzFile file = gzopen(name.c_str(), "wb");
    gzwrite(file, content.data(), static_cast<unsigned>(content.size()));
    gzclose(file);
    return name;
}

TEST(PackedFile, ZipGzipAndPlainHoldTheSameText) {
    const ScratchDir here;
    const std::string text = read_text_file(example_design);
    EXPECT_EQ(read_packed_file(zipped(here, "rocket.ork", text), ".ork"), text);
    EXPECT_EQ(read_packed_file(gzipped(here, text), ".ork"), text);
    EXPECT_EQ(read_packed_file(example_design, ".ork"), text);
}

TEST(PackedFile, DamageAndBombsAreRefused) {
    const ScratchDir here;
    const std::string text = read_text_file(example_design);
    const auto refused = [&](const std::string& file, std::string_view why) {
        try {
            read_packed_file(file, ".ork");
            ADD_FAILURE() << why;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
    };
    const auto cut = [&](const std::string& file, std::size_t less) {
        const std::string all = read_text_file(file);
        here.write("cut.ork", all.substr(0, all.size() - less));
        return (here / "cut.ork").string();
    };
    refused(cut(gzipped(here, text), 100), "end early");
    refused(cut(zipped(here, "rocket.ork", text), 100), "no directory");
    refused(zipped(here, "rocket.xml", text), "has no '*.ork'");
    std::string flipped = read_text_file(zipped(here, "rocket.ork", text));
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x55);
    here.write("flipped.ork", flipped);
    refused((here / "flipped.ork").string(), "check sum");
    const std::string zeros(largest_unpacked + 1, '\0');  // 64 KiB once packed
    refused(gzipped(here, zeros), "holds too much");
    refused(zipped(here, "rocket.ork", zeros), "holds too much");
    refused((here / "none.ork").string(), "no such file");
}

}  // namespace
}  // namespace twinchute::test
