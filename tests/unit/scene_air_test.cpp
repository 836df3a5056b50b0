// Air and wind as a scene gives them: offsets, soundings, directions, airspeed.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/soundings.hpp"
#include "tests/support/difference.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

constexpr double gas_constant = 8314.32 / 28.9644;  // [J/(kg K)] US76

// --- temperature offset --------------------------------------------------------------------------

TEST(TemperatureOffset, OfZeroIsTheStandardToTheLastBit) {
    const Atmosphere standard{find_atmosphere("us76")};
    const Scene scene = read_text(good_scene, {"environment.atmosphere={temperature_offset=0}"});
    for (double z = -4000.0; z < 86000.0; z += 331.0) {
        const AirState a = standard.at(z), b = scene.environment.atmosphere.at(z);
        EXPECT_EQ(a.density, b.density) << z;
        EXPECT_EQ(a.pressure, b.pressure) << z;
        EXPECT_EQ(a.temperature, b.temperature) << z;
        EXPECT_EQ(a.viscosity, b.viscosity) << z;
    }
}

TEST(TemperatureOffset, WarmsAtTheStandardsPressure) {
    const Atmosphere standard{find_atmosphere("us76")};
    const Scene hot = read_text(good_scene, {"environment.atmosphere={temperature_offset='15 K'}"});
    for (const double z : {0.0, 3000.0, 12000.0, 40000.0}) {
        const AirState a = standard.at(z), b = hot.environment.atmosphere.at(z);
        EXPECT_EQ(b.temperature, a.temperature + 15.0);
        EXPECT_EQ(b.pressure, a.pressure);
        EXPECT_NEAR(b.density / a.density, a.temperature / (a.temperature + 15.0), 1e-14);
        // US76, Eq. 51 (Sutherland).
        EXPECT_NEAR(b.viscosity, 1.458e-6 * std::pow(b.temperature, 1.5) / (b.temperature + 110.4), 1e-18);
        // Hydrostatic in pressure altitude: dp/dz = -rho g (T + dT)/T, with the standard's spacing of levels.
        const double g = standard_gravity * std::pow(6356766.0 / (6356766.0 + z), 2);
        const double slope = central_difference(
            [&](double h) { return hot.environment.atmosphere.at(h).pressure; }, z + 1.0, 0.5);
        EXPECT_NEAR(
            slope / (-hot.environment.atmosphere.at(z + 1.0).density * g * b.temperature / a.temperature),
            1.0, 1e-5);
    }
    // 1.225 kg/m^3 at 288.15 K: ISA + 15 at sea level is 1.1644 kg/m^3, a common figure of performance
    // charts.
    EXPECT_NEAR(hot.environment.atmosphere.at(0.0).density, 1.1644, 5e-5);
}

// --- soundings -----------------------------------------------------------------------------------

std::string sounding_of_us76(double spacing) {
    std::string text = "altitude,temperature,pressure\nkm,K,hPa\n";
    const Atmosphere air{find_atmosphere("us76")};
    for (double z = -500.0; z <= 20000.0; z += spacing)
        text += fmt::format("{},{},{}\n", z / 1000.0, air.at(z).temperature, air.at(z).pressure / 100.0);
    return text;
}

TEST(Sounding, OfTheStandardIsTheStandard) {
    const Atmosphere standard{find_atmosphere("us76")};
    const auto worst_of = [&](double spacing) {
        Atmosphere air{find_atmosphere("table")};
        air.table = read_air_table(sounding_of_us76(spacing), "us76.csv", "us76.csv");
        double worst = 0.0;
        for (double z = -500.0; z <= 10900.0; z += 61.0)
            worst = std::max(worst, std::abs(air.at(z).density / standard.at(z).density - 1.0));
        EXPECT_EQ(air.lowest(), -500.0);
        EXPECT_EQ(air.highest(), 20000.0);
        EXPECT_NEAR(air.at(0.0).pressure, 101325.0, 1e-6);  // a level
        return worst;
    };
    // Between levels log p bends by g L/(R T^2), 4.7e-9 m^-2 at most below 11 km: 1/8 of that times 500^2.
    // The kink of the tropopause at 11019 m lies between levels, so that the comparison ends below it.
    EXPECT_LT(worst_of(500.0), 1.6e-4);
    EXPECT_NEAR(worst_of(500.0) / worst_of(250.0), 4.0, 0.6);  // second order
}

TEST(Sounding, IsHydrostaticAsTheLevelsAre) {
    Atmosphere air{find_atmosphere("table")};
    air.table = read_air_table(sounding_of_us76(100.0), "us76.csv", "us76.csv");
    // Middles of intervals, where the slope is second order, below the kink at 11 km.
    for (double z = 50.0; z < 10900.0; z += 500.0) {
        const double g = standard_gravity * std::pow(6356766.0 / (6356766.0 + z), 2);
        const double slope = central_difference([&](double h) { return air.at(h).pressure; }, z, 1.0);
        EXPECT_NEAR(slope / (-air.at(z).density * g), 1.0, 3e-5) << z;
    }
}

TEST(Sounding, WithDensityGivesPressureByTheGasLaw) {
    Atmosphere air{find_atmosphere("table")};
    air.table =
        read_air_table("density, altitude, temperature\r\nkg/m^3, ft, K\r\n1.2, 0, 290\r\n0.6, 20000, 250",
                       "d.csv", "d.csv");
    EXPECT_NEAR(air.at(0.0).density, 1.2, 1e-15);
    EXPECT_NEAR(air.at(0.0).pressure, 1.2 * gas_constant * 290.0, 1e-9);
    EXPECT_NEAR(air.highest(), 6096.0, 1e-9);
    EXPECT_NEAR(air.at(3048.0).density, std::sqrt(1.2 * 0.6), 1e-14);  // half way in log rho
    EXPECT_NEAR(air.at(3048.0).temperature, 270.0, 1e-12);
}

TEST(Sounding, AboveItsLevelsKeepsTheTemperatureOfTheLast) {
    Atmosphere air{find_atmosphere("table")};
    air.table =
        read_air_table("altitude,temperature,pressure\nm,K,hPa\n0,290,1000\n10000,250,250\n20000,200,50\n",
                       "a.csv", "a.csv");
    // The lapse of the last layer, 5 K/km, would reach 0 K at 60 km.
    for (const double z : {20000.0, 59000.0, 61000.0, 400e3}) {
        EXPECT_EQ(air.at(z).temperature, 200.0) << z;
        // A fifth of the pressure for each 10 km, as between the last two levels.
        EXPECT_NEAR(std::log(air.at(z).pressure / 5000.0), -std::log(5.0) * (z - 20e3) / 10e3, 1e-11) << z;
    }
    // Below the first nothing jumps: a step that is tried there sees the air of the layer above.
    EXPECT_NEAR(air.at(-100.0).temperature, 290.4, 1e-12);
}

TEST(Sounding, OfAnotherPlanetIsTakenForEarthsAir) {
    // R of carbon dioxide is 188.9 J/(kg K): densities from pressures are a third too low, and nothing else
    // in the scene knows the gas.
    ScratchDir here;
    here.write("p.csv", "altitude,temperature,pressure\nm,K,Pa\n-100,210,610\n10000,190,240\n");
    here.write("d.csv", "altitude,temperature,density\nm,K,kg/m3\n-100,210,0.0154\n10000,190,0.0067\n");
    const auto warning = [&](const char* table, const char* gravity) -> std::string {
        const Scene scene = read_scene_text(
            edited(good_scene, "{ density = \"1.225 kg/m^3\" }", fmt::format("{{ table = \"{}\" }}", table)),
            "test.toml", here.path(), {fmt::format("environment.gravity={}", gravity)});
        for (const Warning& one : scene.warnings)
            if (one.what.find("is taken for Earth's air") != std::string::npos) return one.why;
        return "";
    };
    EXPECT_NE(warning("p.csv", "3.71").find("densities from its pressures and Mach numbers"),
              std::string::npos);
    EXPECT_EQ(warning("d.csv", "3.71").find("densities"), std::string::npos);
    EXPECT_NE(warning("d.csv", "3.71"), "");
    EXPECT_EQ(warning("p.csv", "9.78"), "");  // the equator
}

TEST(Sounding, ReachesTheSceneWithItsRange) {
    ScratchDir here;
    here.write("sounding.csv", "altitude,temperature,pressure\nm,K,hPa\n100,288,1000\n900,283,910\n");
    const auto read = [&](const char* height, const char* ground) {
        return read_scene_text(
            edited(good_scene, "{ density = \"1.225 kg/m^3\" }", "{ table = \"sounding.csv\" }"), "test.toml",
            here.path(),
            {std::string("release.altitude=") + height, std::string("environment.ground=") + ground});
    };
    const Scene scene = read("500 m", "120 m");
    EXPECT_EQ(scene.environment.atmosphere.table.file, "sounding.csv");
    EXPECT_NEAR(scene.environment.atmosphere.at(500.0).pressure, 1e5 * std::sqrt(0.91), 1e-6);
    EXPECT_NEAR(scene.environment.atmosphere.at(500.0).temperature, 285.5, 1e-9);
    EXPECT_THROW(read("901 m", "120 m"), SceneError);
    EXPECT_THROW(read("500 m", "99 m"), SceneError);
}

struct BadTable {
    const char* name;
    const char* text;
    const char* begins;
    const char* says;
};

const BadTable bad_tables[] = {
    {"empty", "", "t.csv:1:1: ", "is not a table"},
    {"names_only", "altitude,temperature,pressure\n", "t.csv:2:1: ", "is not a table"},
    {"unknown_column", "altitude,temprature,pressure\nm,K,Pa\n",
     "t.csv:1:10: ", "did you mean 'temperature'?"},
    {"semicolons", "altitude;temperature\nm;K\n", "t.csv:1:1: ", "unknown column 'altitude;temperature'"},
    {"column_twice", "altitude,pressure,pressure\nm,Pa,Pa\n", "t.csv:1:19: ", "stands here twice"},
    {"no_altitude", "temperature,pressure\nK,Pa\n", "t.csv:1:1: ", "'altitude' is missing"},
    {"no_temperature", "altitude,pressure\nm,Pa\n0,1e5\n1,1e5\n", "t.csv:1:1: ", "'temperature' is missing"},
    {"over_determined", "altitude,temperature,pressure,density\nm,K,Pa,kg/m^3\n0,280,1e5,1\n1,280,1e5,1\n",
     "t.csv:1:1: ", "say the same"},
    {"neither", "altitude,temperature\nm,K\n0,280\n1,280\n", "t.csv:1:1: ", "neither pressure nor density"},
    {"wrong_unit", "altitude,temperature,pressure\nm,K,kg\n",
     "t.csv:2:5: ", "pressure: 'kg' is the wrong kind"},
    {"celsius", "altitude,temperature,pressure\nm,degC,Pa\n", "t.csv:2:3: ", "has an offset"},
    {"no_unit", "altitude,temperature,pressure\nm,,Pa\n", "t.csv:2:3: ", "has no unit"},
    {"units_short", "altitude,temperature,pressure\nm,K\n",
     "t.csv:2:3: ", "2 cells where the first line has 3"},
    {"line_short", "altitude,temperature,pressure\nm,K,Pa\n0,280,1e5\n1,280\n", "t.csv:4:3: ", "2 cells"},
    {"line_long", "altitude,temperature,pressure\nm,K,Pa\n0,280,1e5,7\n", "t.csv:3:11: ", "4 cells"},
    {"blank_line", "altitude,temperature,pressure\nm,K,Pa\n0,280,1e5\n\n1,280,9e4\n",
     "t.csv:4:1: ", "1 cells"},
    {"nan", "altitude,temperature,pressure\nm,K,Pa\n0,nan,1e5\n",
     "t.csv:3:3: ", "'nan' is not a finite number"},
    {"overflow", "altitude,temperature,pressure\nm,K,Pa\n0,1e999,1e5\n",
     "t.csv:3:3: ", "not a finite number"},
    {"word", "altitude,temperature,pressure\nm,K,Pa\n0, warm ,1e5\n",
     "t.csv:3:4: ", "'warm' is not a number"},
    {"number_with_unit", "altitude,temperature,pressure\nm,K,Pa\n0,280 K,1e5\n",
     "t.csv:3:3: ", "'280 K' is not a number"},
    {"empty_cell", "altitude,temperature,pressure\nm,K,Pa\n0,,1e5\n", "t.csv:3:3: ", "an empty cell"},
    {"out_of_range", "altitude,temperature,pressure\nm,K,Pa\n0,-3,1e5\n",
     "t.csv:3:3: ", "temperature: -3 K is out of range"},
    {"falls", "altitude,temperature,pressure\nm,K,Pa\n5,280,1e5\n4,280,1e5\n",
     "t.csv:4:1: ", "altitude does not rise (4 m after 5 m)"},
    {"twice", "altitude,temperature,pressure\nm,K,Pa\n5,280,1e5\n5,280,1e5\n",
     "t.csv:4:1: ", "does not rise"},
    {"one_level", "altitude,temperature,pressure\nm,K,Pa\n5,280,1e5\n", "t.csv:3:1: ", "too few lines"},
};

TEST(Sounding, MistakesHaveTheirPlace) {
    for (const BadTable& bad : bad_tables) {
        SCOPED_TRACE(bad.name);
        try {
            read_air_table(bad.text, "t.csv", "t.csv");
            ADD_FAILURE() << "was read";
        } catch (const SceneError& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with(bad.begins)) << what;
            EXPECT_NE(what.find(bad.says), std::string::npos) << what;
        }
    }
}

// --- wind ----------------------------------------------------------------------------------------

Vec3 wind_at(const Scene& scene, double altitude) {
    return scene.environment.wind->at(altitude);
}

TEST(SceneWind, IsLeftOutWhenItsTableIs) {
    EXPECT_FALSE(read_text(good_scene).environment.wind);
}

TEST(SceneWind, FromTheWestBlowsTowardTheEast) {
    const Scene scene = read_text(good_scene, {"environment.wind={speed='5 m/s', from='270 deg'}"});
    EXPECT_NEAR((wind_at(scene, 123.0) - Vec3(5.0, 0.0, 0.0)).norm(), 0.0, 1e-14);
    EXPECT_EQ(std::get<std::string>(find_input(scene, "environment.wind.model")->value), "uniform");
    const Scene parts = read_text(good_scene, {"environment.wind={east='5 m/s', north='-10 knot'}"});
    EXPECT_NEAR((wind_at(parts, 0.0) - Vec3(5.0, -10.0 * 1852.0 / 3600.0, 0.0)).norm(), 0.0, 1e-14);
    EXPECT_EQ(wind_at(read_text(good_scene, {"environment.wind={east=1, north=2, up=3}"}), 0.0),
              Vec3(1, 2, 3));
}

TEST(SceneWind, TablesInEitherForm) {
    const Wind polar =
        read_wind_table("altitude,speed,from\nft,knot,deg\n0,10,270\n1000,10,180\n", "w.csv", "w.csv");
    const double speed = 10.0 * 1852.0 / 3600.0;
    EXPECT_NEAR((polar.at(0.0) - Vec3(speed, 0.0, 0.0)).norm(), 0.0, 1e-14);
    EXPECT_NEAR((polar.at(304.8) - Vec3(0.0, speed, 0.0)).norm(), 0.0, 1e-14);
    // Component by component: half way the wind is weaker, not only turned.
    EXPECT_NEAR((polar.at(152.4) - Vec3(speed / 2, speed / 2, 0.0)).norm(), 0.0, 1e-14);
    const Wind parts =
        read_wind_table("north,altitude,east,up\nm/s,m,m/s,m/s\n1,0,2,3\n5,10,6,7\n", "w.csv", "w.csv");
    EXPECT_EQ(parts.at(5.0), Vec3(4.0, 3.0, 5.0));
    for (const char* columns : {"altitude,speed\nm,m/s\n0,1\n1,1\n", "altitude,east\nm,m/s\n0,1\n1,1\n",
                                "altitude,speed,from,up\nm,m/s,deg,m/s\n0,1,1,1\n1,1,1,1\n",
                                "altitude,speed,from,east,north\nm,m/s,deg,m/s,m/s\n0,1,1,1,1\n1,1,1,1,1\n"})
        EXPECT_THROW(read_wind_table(columns, "w.csv", "w.csv"), SceneError) << columns;
}

TEST(SceneWind, ThatEndsInsideTheFlightIsSaid) {
    ScratchDir here;
    here.write("wind.csv", "altitude,speed,from\nm,m/s,deg\n100,5,270\n250,10,270\n");
    const auto read = [&](const std::vector<std::string>& overrides) {
        std::vector<std::string> all{"environment.wind.table=wind.csv"};
        all.insert(all.end(), overrides.begin(), overrides.end());
        return read_scene_text(good_scene, "test.toml", here.path(), all);
    };
    const Scene scene = read({});
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].what, "the wind of wind.csv ends inside the flight");
    EXPECT_NE(scene.warnings[0].why.find("from 100 to 250 m, the flight from 0 to 300 m"), std::string::npos)
        << scene.warnings[0].why;
    EXPECT_NEAR(wind_at(scene, 0.0).x(), 5.0, 1e-14);
    EXPECT_NEAR(wind_at(scene, 300.0).x(), 10.0, 1e-14);
    EXPECT_TRUE(read({"environment.ground=100 m", "release.altitude=250 m"}).warnings.empty());
    EXPECT_TRUE(read_text(good_scene, {"environment.wind={speed=5, from=0}"}).warnings.empty());
}

// --- airspeed ------------------------------------------------------------------------------------

TEST(Airspeed, InStillAirIsTheSpeedOverGround) {
    const Scene scene = read_text(good_scene, {"release.airspeed=30"});
    EXPECT_EQ(scene.release.speed, 30.0);
    EXPECT_EQ(scene.release.path_angle, read_text(good_scene).release.path_angle);
}

TEST(Airspeed, IsCarriedByTheWind) {
    // 40 m/s due north and level through the air, in a wind of 30 m/s from the west: 50 m/s over ground.
    const Scene scene =
        read_text(good_scene, {"release.airspeed=40", "release.path_angle=0", "release.heading=0",
                               "environment.wind={speed=30, from='270 deg'}"});
    EXPECT_NEAR(scene.release.speed, 50.0, 1e-12);
    EXPECT_NEAR(scene.release.heading, std::atan2(30.0, 40.0), 1e-12);
    EXPECT_NEAR(scene.release.path_angle, 0.0, 1e-12);
    EXPECT_EQ(std::get<double>(find_input(scene, "release.airspeed")->value), 40.0);
    // Straight down through the air: carried to the east over ground.
    const Scene down = read_text(good_scene, {"release.airspeed=21", "environment.wind={east=20, north=0}"});
    EXPECT_NEAR(down.release.speed, 29.0, 1e-12);
    EXPECT_NEAR(down.release.path_angle, std::atan2(21.0, 20.0), 1e-12);
    EXPECT_NEAR(down.release.heading, 0.5 * pi, 1e-12);
    // Over ground the wind changes nothing.
    const Scene ground = read_text(good_scene, {"environment.wind={east=20, north=0}"});
    EXPECT_EQ(ground.release.speed, 21.0);
}

TEST(Airspeed, WithItsWindIsInTheRangeOfASpeed) {
    const std::vector<std::string> fast{"release.airspeed=900", "release.path_angle=0"};
    EXPECT_EQ(complaint(good_scene, fast), "");
    std::vector<std::string> carried = fast;
    carried.push_back("environment.wind={east=150, north=0}");  // heading 90 deg: from behind
    EXPECT_NE(complaint(good_scene, carried).find("1050 m/s over ground"), std::string::npos);
}

TEST(Airspeed, OfNothingCannotDrawOutLines) {
    EXPECT_NE(complaint(good_scene, {"release.path_angle=0", "environment.wind={east=21, north=0}"})
                  .find("a line-stretch start needs a speed"),
              std::string::npos);  // heading 90 deg: with the wind, as fast as the wind
    // At rest over ground in a wind: the air draws out the lines.
    EXPECT_EQ(complaint(good_scene, {"release.speed=0", "environment.wind={east=21, north=0}"}), "");
}

}  // namespace
}  // namespace twinchute::test
