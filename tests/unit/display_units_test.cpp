// The table of display units against UDUNITS, and what is shown with it.
#include <gtest/gtest.h>

#include <string>

#include "lib/record/display_units.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

/// Chooses units for a test, and SI after it.
struct Choose {
    explicit Choose(DisplayUnits units) { choose_display_units(units); }
    ~Choose() { choose_display_units(DisplayUnits::si); }
    Choose(const Choose&) = delete;
    Choose& operator=(const Choose&) = delete;
};

TEST(DisplayUnits, EveryPairIsWhatUdunitsMakesOfIt) {
    // The readers of scenes convert by UDUNITS-2; both have the exact definitions, so that only rounding is
    // left.
    for (const UnitPair& pair : unit_pairs()) {
        const double si = to_si("1 " + std::string(pair.us), pair.si);
        EXPECT_NEAR(pair.factor * si, 1.0, 1e-12) << pair.si << " " << pair.us;
    }
}

TEST(DisplayUnits, NumbersGoWithTheirUnits) {
    {
        const Choose us(DisplayUnits::us);
        // 1 ft = 0.3048 m exactly; a pound weighs 0.45359237 x 9.80665 N exactly.
        EXPECT_NEAR(shown(3.048, "m/s").value, 10.0, 1e-12);
        EXPECT_EQ(shown(3.048, "m/s").unit, "ft/s");
        EXPECT_NEAR(shown(4448.2216152605, "N").value, 1000.0, 1e-9);
        EXPECT_NEAR(shown(47.88025898033584, "Pa").value, 1.0, 1e-12);
        EXPECT_EQ(spaced_unit("kg"), " lb");
        // What has no US unit stays, with its number.
        for (const char* unit : {"s", "g", "", "Hz", "%"}) {
            EXPECT_EQ(shown(2.5, unit).value, 2.5) << unit;
            EXPECT_EQ(shown(2.5, unit).unit, unit);
        }
        EXPECT_EQ(spaced_unit(""), "");
        EXPECT_FALSE(units_remark().empty());
    }
    EXPECT_EQ(shown(3.048, "m/s").value, 3.048);
    EXPECT_EQ(shown(3.048, "m/s").unit, "m/s");
    EXPECT_TRUE(units_remark().empty());
}

}  // namespace
}  // namespace twinchute
