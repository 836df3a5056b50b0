// Sound in each atmosphere, drag areas by Mach number, and what is said of a flight beyond its correlations.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lib/scene/opening_tables.hpp"
#include "lib/solve/validity.hpp"
#include "rom/run_rom.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

TEST(SpeedOfSound, IsThatOfTheStandardAtmosphere) {
    // US Standard Atmosphere 1976, Table III, at geometric altitudes; printed to 0.001 m/s.
    const Atmosphere us76{find_atmosphere("us76")};
    const double table[][2] = {
        {0, 340.294}, {5e3, 320.545}, {10e3, 299.532}, {20e3, 295.069}, {50e3, 329.799}};
    for (const auto& [altitude, speed] : table)
        EXPECT_NEAR(*us76.speed_of_sound(altitude), speed, 0.002) << altitude;
}

TEST(SpeedOfSound, GoesByTheTemperatureOfTheAir) {
    // sqrt(1.4 R T) with R = 8314.32/28.9644 (US76).
    const auto of = [](double temperature) { return std::sqrt(1.4 * 8314.32 / 28.9644 * temperature); };
    Atmosphere hot{find_atmosphere("us76")};
    hot.temperature_offset = 20.0;
    EXPECT_NEAR(*hot.speed_of_sound(0.0), of(308.15), 1e-10);
    Atmosphere sounding{find_atmosphere("table")};
    sounding.table = {"a.csv", {0.0, 1000.0}, {300.0, 280.0}, {std::log(1e5), std::log(9e4)}};
    EXPECT_NEAR(*sounding.speed_of_sound(500.0), of(290.0), 1e-10);
    const Atmosphere constant{find_atmosphere("constant"), 1.0};
    EXPECT_FALSE(constant.speed_of_sound(0.0));
}

TEST(MachDrag, IsLinearBetweenItsPointsAndHeldBeyond) {
    const MachDrag drag =
        read_mach_drag("drag_area_factor,mach_number\n%,1\n100,0.5\n120,1\n60,2\n", "m.csv", "m.csv");
    EXPECT_EQ(drag.factor(0.0), 1.0);
    EXPECT_NEAR(drag.factor(0.75), 1.1, 1e-15);
    EXPECT_NEAR(drag.factor(1.5), 0.9, 1e-15);
    EXPECT_EQ(drag.factor(3.0), 0.6);
}

TEST(MachDrag, RefusesWhatIsNoTable) {
    const auto refused = [](const std::string& text, int line, const char* says) {
        try {
            read_mach_drag(text, "m.csv", "m.csv");
            ADD_FAILURE() << "accepted, wanted: " << says;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.place().line, line) << error.what();
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    };
    refused("mach_number,drag_area_factor\n1,1\n0,1\n0,2\n", 4, "0");
    refused("mach_number,drag_area_factor\n1,1\n1,1\n0.5,2\n", 4, "0.5");
    refused("mach_number,drag_area_factor\n1,1\n-1,1\n0.5,2\n", 3, "-1");
    refused("mach_number,drag_area_factor\n1,1\n0,1\n0.5,0\n", 4, "0");
    refused("mach_number\n1\n0\n1\n", 1, "the column 'drag_area_factor' is missing");
    ScratchDir here;
    here.write("m.csv", "mach_number,drag_area_factor\n1,1\n0,1\n1,1.2\n");
    const std::string text =
        edited(good_scene, "design = \"usaf-c9\"", "design = \"usaf-c9\"\ndrag_area_mach_table = \"m.csv\"");
    try {
        read_scene_text(text, "test.toml", here.path());
        ADD_FAILURE() << "accepted a Mach number in air without a temperature";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("the atmosphere 'constant' has no Mach number"),
                  std::string::npos)
            << error.what();
    }
}

RunRecord run_of(const std::string& text, const std::vector<std::string>& overrides) {
    twinchute::Run run;
    return rom::run_rom(read_text(text, overrides), run);
}

bool warns(const RunRecord& record, const std::string& of) {
    for (const Warning& warning : record.warnings)
        if ((warning.what + ": " + warning.why).find(of) != std::string::npos) return true;
    return false;
}

TEST(Validity, RowsSayWhatHoldsWhereAndWhoSaysSo) {
    for (const CorrelationRow& row : correlation_rows()) {
        EXPECT_FALSE(row.name.empty() || row.source.empty());
        EXPECT_NE(row.used, nullptr) << row.name;
        if (row.range == nullptr) {
            EXPECT_LT(row.low, row.high) << row.name;
        }
    }
}

TEST(Validity, AReleaseAtMachTwoIsSaid) {
    // 600 m/s at 9 km, where sound goes at 303.848 m/s (US76).
    const std::vector<std::string> fast{"environment.atmosphere=us76", "release.speed=600",
                                        "release.height=9000"};
    const RunRecord record = run_of(good_scene, fast);
    ASSERT_TRUE(record.metric("snatch_mach_number") && record.metric("max_mach_number"));
    EXPECT_NEAR(*record.metric("snatch_mach_number"), 600.0 / 303.848, 1e-5);
    // The rows begin at the snatch, and the drag only slows it down from there.
    EXPECT_NEAR(*record.metric("max_mach_number"), 600.0 / 303.848, 1e-5);
    EXPECT_NEAR(*record.metric("max_altitude_m"), 9000.0, 1e-9);
    EXPECT_TRUE(
        warns(record, "Mach 1.97: beyond where these hold: one drag area at all speeds from 0 to 0.5"));
    EXPECT_TRUE(warns(record, "added mass from 0 to 0.5"));
    EXPECT_TRUE(warns(record, "Mach 1.97 at snatch: beyond where these hold: filling time by snatch speed"));
    EXPECT_FALSE(warns(record, "atmosphere from"));
    EXPECT_FALSE(record.metric("max_line_reynolds_number"));  // this model has no lines
    // 160 m/s is Mach 0.527 up there, 140 m/s 0.461: past the limit of filling times alone, 120 past none.
    EXPECT_TRUE(warns(run_of(good_scene, {fast[0], fast[2], "release.speed=160"}), "one drag area"));
    const RunRecord slower = run_of(good_scene, {fast[0], fast[2], "release.speed=140"});
    EXPECT_TRUE(warns(slower, "Mach 0.461 at snatch"));
    EXPECT_FALSE(warns(slower, "one drag area"));
    EXPECT_FALSE(warns(run_of(good_scene, {fast[0], fast[2], "release.speed=120"}), "beyond where"));
}

TEST(Validity, AirOfOneDensityHasNoMachNumberAndIsWarnedOfAllTheSame) {
    const RunRecord record = run_of(good_scene, {"release.speed=600", "release.height=9000"});
    EXPECT_FALSE(record.metric("snatch_mach_number") || record.metric("max_mach_number"));
    // 600 over 340.294 m/s.
    EXPECT_TRUE(warns(record, "Mach 1.76: beyond where these hold: one drag area at all speeds"));
    EXPECT_TRUE(warns(record, "the air has no temperature, the sound is that of 288.15 K"));
    bool said = false;
    for (const LeftOut& out : record.left_out)
        said = said || out.what.find("Mach number") != std::string::npos;
    EXPECT_TRUE(said);
}

TEST(Validity, AFlightOutOfTheAtmosphereIsSaid) {
    const RunRecord record =
        run_of(good_scene, {"environment.atmosphere=us76", "release.speed=900", "release.height=85000",
                            "release.path_angle='-90 deg'", "stop.time=60"});
    // Without drag 85 km + v t - g t^2/2 = 121.3 km at 60 s; the little air there takes a few km of that.
    ASSERT_TRUE(record.metric("max_altitude_m"));
    EXPECT_GT(*record.metric("max_altitude_m"), 1.1e5);
    EXPECT_LT(*record.metric("max_altitude_m"), 121.4e3);
    EXPECT_TRUE(warns(record, "atmosphere from -5000 to 86000"));
    // At 900 m/s nothing is slow: there is no air. The weight is 1545 N on 42.56 m^2.
    EXPECT_FALSE(warns(record, "too slow to inflate"));
    EXPECT_TRUE(warns(record, "thin air: a dynamic pressure of"));
    EXPECT_TRUE(warns(record, "carries its payload at 36.3 Pa"));
}

TEST(Validity, ASceneInsideItsRangesSaysNothing) {
    EXPECT_FALSE(warns(run_of(good_scene, {"environment.atmosphere=us76"}), "beyond where"));
}

TEST(MachDrag, ActsOnTheDragAreaOfTheReducedOrderModel) {
    ScratchDir here;
    const auto record_with = [&](const char* rows, const std::vector<std::string>& more = {}) {
        std::string text =
            edited(edited(good_scene, "atmosphere = { density = \"1.225 kg/m^3\" }", "atmosphere = \"us76\""),
                   "speed = \"21 m/s\"", "speed = \"300 m/s\"");
        text = edited(text, "height = \"300 m\"", "height = \"3 km\"");
        if (rows != nullptr) {
            here.write("m.csv", std::string("mach_number,drag_area_factor\n1,1\n") + rows);
            text = edited(text, "design =", "drag_area_mach_table = \"m.csv\"\ndesign =");
        }
        twinchute::Run run;
        return rom::run_rom(read_scene_text(text, "test.toml", here.path(), more), run);
    };
    const auto force = [](const RunRecord& record) { return record.find_channel("force")->values; };
    const RunRecord without = record_with(nullptr);
    EXPECT_EQ(force(record_with("0,1\n2,1\n")), force(without));
    // Half the drag area is half the drag area, whichever way it is said: 0.5 changes no digit.
    EXPECT_EQ(force(record_with("0,0.5\n2,0.5\n")),
              force(record_with(nullptr, {"parachute.drag_area=21.28"})));
    // Open, the channel is the steady area times the factor at the Mach number of the row.
    const RunRecord by_mach = record_with("0,1\n0.02,1.2\n2,0.5\n");
    const auto& area = by_mach.find_channel("drag_area")->values;
    const auto& pressure = by_mach.find_channel("dynamic_pressure")->values;
    const auto& altitude = by_mach.find_channel("altitude")->values;
    const Atmosphere air{find_atmosphere("us76")};
    const double speed = std::sqrt(2.0 * pressure.back() / air.at(altitude.back()).density);
    const double mach = speed / *air.speed_of_sound(altitude.back());
    const double expected = mach < 0.02 ? 1.0 + 10.0 * mach : 1.2 - 0.7 * (mach - 0.02) / 1.98;
    EXPECT_NEAR(area.back() / (42.56 * expected), 1.0, 1e-12);
    EXPECT_TRUE(warns(record_with("0.1,1\n0.5,1.2\n"), "parachute.drag_area_mach_table from 0.1 to 0.5"));
    EXPECT_FALSE(warns(record_with("0,1\n2,1\n"), "one drag area"));
}

}  // namespace
}  // namespace twinchute::test
