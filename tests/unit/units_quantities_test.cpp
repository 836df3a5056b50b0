// Quantities with units. Factors: NIST SP 811 (2008), appendix B.8, where nothing else is said.
#include "lib/math/vec.hpp"
#include "lib/scene/units.hpp"

#include <gtest/gtest.h>

#include <locale>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace twinchute {
namespace {

constexpr double pound = 0.45359237, foot = 0.3048, gravity = 9.80665;  // exact by definition

struct Case {
    const char* text;
    const char* unit;
    double value;
};

/// Brackets mean nothing and are in no table: the database reads the same unit.
TEST(Units, CommonOnesAreTheDatabasesToTheBit) {
    for (const CommonUnit& row : common_units()) {
        for (const char* number : {"1", "3", "0.1", "152.4", "-7.3e5"}) {
            const std::string plain = std::string(number) + " " + std::string(row.name),
                              bracketed = std::string(number) + " (" + std::string(row.name) + ")";
            EXPECT_EQ(to_si(plain, row.si_unit), to_si(bracketed, row.si_unit)) << plain;
        }
        // For a quantity of another kind it is refused as any unit is, not taken for SI.
        EXPECT_THROW(to_si("1 " + std::string(row.name), "K"), UnitError) << row.name;
    }
    EXPECT_TRUE(units_loaded());
}

TEST(Units, Convert) {
    const Case cases[] = {
        {"152.4 kg", "kg", 152.4},
        {"152.4kg", "kg", 152.4},
        {"  152.4   kg ", "kg", 152.4},
        {"+5 m", "m", 5.0},
        {"-5 m", "m", -5.0},
        {".5 m", "m", 0.5},
        {"1.5e3 m", "m", 1500.0},
        {"1.225 kg/m^3", "kg/m^3", 1.225},
        {"1.225 kg/m3", "kg/m^3", 1.225},
        {"1.225 kg m-3", "kg/m^3", 1.225},
        {"1.225 g/l", "kg/m^3", 1.225},
        {"3 m²", "m^2", 3.0},
        {"200 Hz", "1/s", 200.0},
        {"200 1/s", "1/s", 200.0},
        {"200 s-1", "1/s", 200.0},
        {"60 arc_degree", "rad", pi / 3},
        {"60 °", "rad", pi / 3},
        {"1 rad", "rad", 1.0},
        {"10 %", "1", 0.1},
        {"10 percent", "1", 0.1},
        {"0.1", "1", 0.1},
        {"0.1 1", "1", 0.1},
        {"0.97 GPa", "Pa", 0.97e9},
        {"0.1 mm", "m", 1e-4},
        {"30 kt", "m/s", 30 * 1852.0 / 3600},
        {"30 knots", "m/s", 30 * 1852.0 / 3600},
        {"1 in", "m", 0.0254},
        {"28 ft", "m", 28 * foot},
        {"1 yd", "m", 3 * foot},
        {"1 mile", "m", 5280 * foot},
        {"1 lb", "kg", pound},
        {"400 lbf", "N", 400 * pound * gravity},
        {"1 kgf", "N", gravity},
        {"1 psi", "Pa", pound * gravity / (0.0254 * 0.0254)},
        {"1 ft/s", "m/s", foot},
        {"10 km/h", "m/s", 10 / 3.6},
        {"2 min", "s", 120.0},
        {"20 ms", "s", 0.02},
        {"5 K", "K", 5.0},
    };
    for (const Case& c : cases)
        EXPECT_NEAR(to_si(c.text, c.unit) / c.value, 1.0, 1e-12) << c.text;
}

TEST(Units, RoundNumbersStayRound) {
    EXPECT_EQ(to_si("8.53 m", "m"), 8.53);
    EXPECT_EQ(to_si("1.225 kg/m^3", "kg/m^3"), 1.225);
    EXPECT_EQ(to_si("9.80665 m/s^2", "m/s^2"), 9.80665);
    EXPECT_EQ(to_si("1.225 kg m-3", "kg/m^3"), 1.225);  // through UDUNITS-2
    EXPECT_LE(to_si("90 deg", "rad"), pi / 2);          // the end of a range
    EXPECT_GE(to_si("-90 deg", "rad"), -pi / 2);
}

TEST(Units, EveryAliasMeansWhatEngineersMean) {
    const std::map<std::string, Case> expected{
        {"deg", {"180 deg", "rad", pi}},
        {"oz", {"16 oz", "kg", pound}},
        {"lbm", {"1 lbm", "kg", pound}},
        {"lbs", {"1 lbs", "kg", pound}},
        {"mph", {"1 mph", "m/s", 0.44704}},
        {"kph", {"36 kph", "m/s", 10.0}},
        {"psf", {"1 psf", "Pa", pound * gravity / (foot * foot)}},
        {"fps", {"70 fps", "m/s", 70 * foot}},
        {"cfm", {"90 cfm/ft2", "m/s", 90 * foot / 60}},
        {"nmi", {"1 nmi", "m", 1852.0}},
        {"slug", {"1 slug", "kg", pound * gravity / foot}},
        {"g0", {"2 g0", "m/s^2", 2 * gravity}},
    };
    for (const UnitAlias& alias : unit_aliases()) {
        const auto found = expected.find(std::string(alias.name));
        ASSERT_NE(found, expected.end()) << "no expected value for the alias " << alias.name;
        const Case& c = found->second;
        EXPECT_NEAR(to_si(c.text, c.unit) / c.value, 1.0, 1e-14) << c.text;
    }
    EXPECT_EQ(expected.size(), unit_aliases().size());
}

TEST(Units, AliasesComposeAndTakePowers) {
    // 1.1 oz/yd^2, the areal mass of a ripstop fabric: 37.30 g/m^2 (MIL-C-7020H, Table I).
    EXPECT_NEAR(to_si("1.1 oz/yd2", "kg/m^2"), 37.30e-3, 5e-6);
    EXPECT_NEAR(to_si("1 lbs/ft^3", "kg/m^3") / (pound / (foot * foot * foot)), 1.0, 1e-12);
    EXPECT_NEAR(to_si("180 deg/s", "rad/s") / pi, 1.0, 1e-14);
    EXPECT_NEAR(to_si("1 g0^2", "m^2/s^4") / (gravity * gravity), 1.0, 1e-14);
    EXPECT_NEAR(to_si("3 fps2", "m^2/s^2") / (3 * foot * foot), 1.0, 1e-14);
}

struct Refused {
    const char* text;
    const char* unit;
    const char* says;
};

TEST(Units, RefuseWhatIsNotAQuantityOfThatKind) {
    const Refused cases[] = {
        {"", "m", "does not start with a number"},
        {"m", "m", "does not start with a number"},
        {"five m", "m", "does not start with a number"},
        {"5", "m", "has no unit"},
        {"5 kg", "m", "'kg' is the wrong kind of unit (it is kg, expected m)"},
        {"5 m2", "m", "wrong kind of unit"},
        {"5 lbf", "kg", "wrong kind of unit"},
        {"5 lb", "N", "wrong kind of unit"},
        {"5 furlongish", "m", "unknown unit 'furlongish'"},
        {"5 Kg", "kg", "unknown unit 'Kg'"},
        {"5 m/", "m", "unknown unit"},
        {"nan m", "m", "not a finite number"},
        {"inf m", "m", "not a finite number"},
        {"-inf m", "m", "not a finite number"},
        {"1e999 m", "m", "not a finite number"},
        {"1e308 km", "m", "not a finite number"},
        {"1,5 m", "m", "a number with a comma"},
        {"0x10 m", "m", "unknown unit"},
        {"1_000 m", "m", "unknown unit"},
        // Each of these UDUNITS-2 would read without a word:
        {"3 m 3", "m", "'3' is not part of a unit"},
        {"3 m*2", "m", "'2' is not part of a unit"},
        {"3 m @ 5", "m", "'@' is not part of a unit"},
        {"3 m from 5", "m", "'5' is not part of a unit"},
        {"3 m s -1", "m/s", "'-1' is not part of a unit"},
        {"3 m0", "1", "'0' is not part of a unit"},
        {"3 g^0", "1", "'0' is not part of a unit"},
        {"1 seconds since 2000-01-01", "s", "not part of a unit"},
        {"3 lg(re 1 mW)", "W", "not part of a unit"},
        {"5 \"", "rad", "not part of a unit"},
        {"15 degC", "K", "has an offset"},
        {"15 °F", "K", "has an offset"},
        // Angles and ratios are both dimensionless, but no one means one by the other:
        {"5 deg", "1", "wrong kind of unit"},
        {"5 %", "rad", "wrong kind of unit"},
        {"5 1", "rad", "wrong kind of unit"},
        {"60 rpm", "1/s", "wrong kind of unit"},
        {"1 sr", "rad", "wrong kind of unit"},
    };
    for (const Refused& c : cases) {
        try {
            ADD_FAILURE() << c.text << " was read as " << to_si(c.text, c.unit);
        } catch (const UnitError& error) {
            EXPECT_NE(std::string(error.what()).find(c.says), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(to_si("1 " + std::string(1000, '('), "m"), UnitError);
    EXPECT_THROW(to_si("1 m^99999999999", "m"), UnitError);
}

TEST(Units, MessageHasProblemReasonAndSuggestion) {
    try {
        to_si("152.4 m", "kg");
        FAIL() << "not refused";
    } catch (const UnitError& error) {
        EXPECT_STREQ(error.what(),
                     "'m' is the wrong kind of unit (it is m, expected kg), write e.g. \"152.4 kg\"");
    }
}

struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
};

TEST(Units, LocaleChangesNothing) {
    const double before = to_si("1.5 oz", "kg");
    const std::locale old = std::locale::global(std::locale(std::locale::classic(), new Comma));
    EXPECT_EQ(to_si("1.5 m", "m"), 1.5);
    EXPECT_EQ(to_si("1.5 oz", "kg"), before);
    EXPECT_THROW(to_si("1,5 m", "m"), UnitError);
    std::locale::global(old);
}

TEST(Units, ThreadsDoNotDisturbEachOther) {
    std::vector<int> wrong(4, 0);
    std::vector<std::thread> threads;
    for (int& count : wrong)
        threads.emplace_back([&count] {
            for (int i = 0; i < 200; ++i)
                count += to_si("1 mph", "m/s") != to_si("1 mile/hour", "m/s");
        });
    for (std::thread& thread : threads)
        thread.join();
    for (const int count : wrong)
        EXPECT_EQ(count, 0);
}

// In a process of its own: here, other tests have already met a unit.
void exit_with_loaded_state() {
    const double plain = to_si("5 m", "m") + to_si("10 %", "1");
    const bool before = units_loaded();
    const double converted = to_si("5 yd", "m");
    std::exit(plain == 5.1 && converted > 4.5 && !before && units_loaded() ? 7 : 1);
}

TEST(UnitsDeathTest, DatabaseIsLoadedOnlyForAnUncommonUnit) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(exit_with_loaded_state(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace twinchute
