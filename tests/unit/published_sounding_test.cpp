// Soundings as they are published. The lists here are written by hand: the standard atmosphere in the columns
// of each format, so that what is read can be held to the standard.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/published_sounding.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/soundings.hpp"

namespace twinchute::test {
namespace {

constexpr double earth_radius = 6356766.0;  // [m] US Standard Atmosphere 1976

/// The standard at a geopotential height [m].
AirState standard_at(double geopotential) {
    return Atmosphere{find_atmosphere("us76")}.at(earth_radius * geopotential /
                                                  (earth_radius - geopotential));
}

const std::string wyoming_head =
    "10393 Lindenberg Observations at 12Z 28 Jul 2018\n\n"
    "-----------------------------------------------------------------------------\n"
    "   PRES   HGHT   TEMP   DWPT   RELH   MIXR   DRCT   SKNT   THTA   THTE   THTV\n"
    "    hPa     m      C      C      %    g/kg    deg   knot     K      K      K \n"
    "-----------------------------------------------------------------------------\n";

std::string wyoming_row(double height, const std::string& wind = "    270     10") {
    const AirState air = standard_at(height);
    return fmt::format("{:7.1f}{:7.0f}{:7.1f}{:7}{:7}{:7}{:14}  288.0  288.0  288.0\n", air.pressure / 100.0,
                       height, air.temperature - 273.15, "", "", "", wind);
}

std::string wyoming_list() {
    std::string text =
        wyoming_head + " 1030.0   -140                                                               \n";
    for (double h = 100.0; h < 12000.0; h += 400.0)
        text += wyoming_row(h);
    text += wyoming_row(12500.0, "");  // no wind up there
    return text + "</PRE><H3>Station information and sounding indices</H3><PRE>\n  Station number: 10393\n";
}

const std::string fsl_head =
    "RAOB sounding valid at:\n"
    "   254     12     28      JUL    2018\n"
    "      1  99999  10393  52.22  14.12    100  99999\n"
    "      2    100   1680   1230     34  99999      3\n"
    "      3           LIND                99999     kt\n";

std::string fsl_row(int kind, double height) {
    const AirState air = standard_at(height);
    return fmt::format("{:7}{:7.0f}{:7.0f}{:7.0f}  99999    270     10\n", kind, air.pressure / 10.0, height,
                       (air.temperature - 273.15) * 10.0);
}

std::string fsl_list() {
    std::string text = fsl_head + "      4  10300    -140  99999  99999  99999  99999\n" + fsl_row(9, 100.0);
    for (double h = 500.0; h < 12000.0; h += 400.0)
        text += fsl_row(5, h);
    return text + "      6  99999  12500  99999  99999    280     40\n";
}

/// Largest departure of the density from the standard's between 100 m and 10 km.
double worst_density(const AirTable& table) {
    Atmosphere air{find_atmosphere("table")};
    air.table = table;
    double worst = 0.0;
    for (double z = 110.0; z < 10000.0; z += 37.0)
        worst = std::max(
            worst, std::abs(air.at(z).density / Atmosphere{find_atmosphere("us76")}.at(z).density - 1.0));
    return worst;
}

TEST(PublishedSounding, AWyomingListIsTheAirItWasMadeFrom) {
    const AirTable air = read_air_table(wyoming_list(), "w.txt", "w.txt");
    EXPECT_EQ(air.altitude.size(), 31u);  // the level below ground has no temperature
    // Tenths of 1 hPa of 270 hPa or more and of 1 K of 220 K or more are published: half a tenth each is
    // 0.02 % and 0.023 %.
    EXPECT_LT(worst_density(air), 5e-4);
    // 11700 m of geopotential are 21.6 m less than the geometric altitude.
    EXPECT_NEAR(air.altitude[29], earth_radius * 11700.0 / (earth_radius - 11700.0), 1e-6);
    EXPECT_NEAR(air.altitude[29] - 11700.0, 21.57, 0.01);
    const Wind wind = read_wind_table(wyoming_list(), "w.txt", "w.txt");
    EXPECT_EQ(wind.levels.size(), 30u);
    EXPECT_NEAR(wind.levels[0].velocity.x(), 10.0 * 1852.0 / 3600.0, 1e-12);  // from the west
    EXPECT_NEAR(wind.levels[0].velocity.y(), 0.0, 1e-12);
}

TEST(PublishedSounding, AnFslListIsTheAirItWasMadeFrom) {
    const AirTable air = read_air_table(fsl_list(), "r.txt", "r.txt");
    EXPECT_EQ(air.altitude.size(), 30u);
    EXPECT_LT(worst_density(air), 5e-4);
    const Wind wind = read_wind_table(fsl_list(), "r.txt", "r.txt");
    EXPECT_EQ(wind.levels.size(), 31u);  // one level has wind alone
    EXPECT_NEAR(wind.levels.back().velocity.norm(), 40.0 * 1852.0 / 3600.0, 1e-12);
    std::string tenths = fsl_list();  // of a metre per second
    tenths.replace(tenths.find("     kt"), 7, "     ms");
    EXPECT_NEAR(read_wind_table(tenths, "r.txt", "r.txt").levels[0].velocity.x(), 1.0, 1e-12);
}

TEST(PublishedSounding, OldFslFilesHaveWholeMillibars) {
    const auto levels = read_published_sounding(fsl_head +
                                                    "      4   1000    111    150  32767    270     10\n     "
                                                    " 4    850   1457     55  32767  32767  32767\n",
                                                "r.txt");
    ASSERT_EQ(levels.size(), 2u);
    EXPECT_NEAR(*levels[0].pressure, 100000.0, 1e-9);
    EXPECT_NEAR(*levels[0].temperature, 288.15, 1e-9);
    EXPECT_FALSE(levels[1].speed);
}

TEST(PublishedSounding, IsKnownByItsContent) {
    EXPECT_TRUE(is_published_sounding(wyoming_list()));
    EXPECT_TRUE(is_published_sounding("<HTML>\n<PRE>\n" + wyoming_list()));
    EXPECT_TRUE(is_published_sounding(fsl_list()));
    EXPECT_FALSE(is_published_sounding("altitude,temperature,pressure\nm,K,hPa\n0,288,1013\n"));
    EXPECT_FALSE(is_published_sounding(""));
}

TEST(PublishedSounding, RefusesMalformedLinesByTheirNumber) {
    struct Bad {
        std::string text, message;
        int line;
    };
    const std::string good = wyoming_row(100.0) + wyoming_row(500.0);
    std::string units = wyoming_head;
    units.replace(units.find("hPa"), 3, "kPa");
    std::string shifted = wyoming_row(900.0).substr(2);  // blanks lost on the way
    for (const Bad& bad :
         {Bad{wyoming_head + good + " 1000.0   abc9   15.0\n", "is not a number", 9},
          Bad{wyoming_head + good + shifted, "do not end below their names", 9},
          Bad{wyoming_head + good + " 1000.0\t  900\t 15.0\n", "do not end below their names", 9},
          Bad{wyoming_head + good + wyoming_row(400.0), "height does not rise", 9},
          Bad{wyoming_head + good + wyoming_row(900.0, "            10"), "half a wind", 9},
          Bad{wyoming_head + good + wyoming_row(900.0, "    270    999"), "wind [m/s]", 9},
          Bad{wyoming_head + good + " 1000.0          15.0\n", "no height", 9},
          Bad{wyoming_head + wyoming_row(100.0), "1 levels with", 7}, Bad{wyoming_head, "no levels", 6},
          Bad{units + good, "not the units", 5},
          Bad{wyoming_list() + wyoming_list(), "a second sounding", 44},
          Bad{fsl_head + fsl_row(9, 100.0) + "      4  10000    111\n", "where a level has 7", 7},
          Bad{fsl_head + fsl_row(9, 100.0) + "      x      1      2\n", "no kind of line", 7},
          Bad{fsl_head + "      9  10000    1x1    150  99999    270     10\n", "is not a number", 6},
          Bad{fsl_list() + fsl_list(), "a second sounding", 38}}) {
        try {
            read_air_table(bad.text, "s.txt", "s.txt");
            read_wind_table(bad.text, "s.txt", "s.txt");
            ADD_FAILURE() << bad.message;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(bad.message), std::string::npos) << error.what();
            EXPECT_EQ(error.place().line, bad.line) << error.what();
        }
    }
}

}  // namespace
}  // namespace twinchute::test
