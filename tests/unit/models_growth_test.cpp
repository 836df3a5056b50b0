// Drag-area laws of the power family, the half-ellipsoid of added mass, and the wind.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/models/inflation.hpp"
#include "lib/models/wind.hpp"

namespace twinchute {
namespace {

TEST(PowerLaws, HaveTheValueAndRateOfTheirFormula) {
    struct Row {
        const char* name;
        double value, rate;
    };
    // eta^2 + (1 - eta^2) x^j at eta = 0.2, x = 1/2, by hand: 0.04 + 0.96 (1/2)^j and 0.96 j (1/2)^(j-1).
    constexpr Row rows[] = {{"power-0.5", 0.04 + 0.96 * 0.70710678118654752, 0.96 * 0.70710678118654752},
                            {"power-1", 0.52, 0.96},
                            {"power-2", 0.28, 0.96},
                            {"power-3", 0.16, 0.72},
                            {"power-6", 0.055, 0.18}};
    for (const Row& row : rows) {
        const DragAreaLaw* law = find_drag_area_law(row.name);
        ASSERT_NE(law, nullptr) << row.name;
        EXPECT_NEAR(law->at(0.5, 0.2).value, row.value, 1e-15) << row.name;
        EXPECT_NEAR(law->at(0.5, 0.2).rate, row.rate, 1e-15) << row.name;
    }
}

// An exponent of the scene is the row of that power, and between the rows what its formula says.
TEST(PowerLaws, TakeAnyExponent) {
    const DragAreaGrowth second{nullptr, 0.2, nullptr, 2.0}, any{nullptr, 0.2, nullptr, 4.3};
    const DragAreaLaw& row = *find_drag_area_law("power-2");
    for (double x = 0.0; x <= 1.0; x += 0.125) {
        EXPECT_NEAR(second.at(x).value, row.at(x, 0.2).value, 1e-15);
        EXPECT_NEAR(second.at(x).rate, row.at(x, 0.2).rate, 1e-15);
        EXPECT_NEAR(second.integral(x), row.integral(x, 0.2), 1e-15);
        EXPECT_NEAR(any.at(x).value, 0.04 + 0.96 * std::pow(x, 4.3), 1e-15);
        EXPECT_NEAR(any.integral(x), 0.04 * x + 0.96 * std::pow(x, 5.3) / 5.3, 1e-15);
    }
}

TEST(PowerLaws, OfTheSixthPowerIsLudtkesFromNothing) {
    const DragAreaLaw &power = *find_drag_area_law("power-6"), &ludtke = *find_drag_area_law("ludtke");
    for (double x = 0.0; x <= 1.0; x += 0.125) {
        EXPECT_NEAR(power.at(x, 0.0).value, ludtke.at(x, 0.0).value, 1e-15);
        EXPECT_NEAR(power.at(x, 0.0).rate, ludtke.at(x, 0.0).rate, 1e-14);
    }
}

TEST(PowerLaws, AreFiniteAtTheirStartAndARoundingErrorBelow) {
    for (const DragAreaLaw& law : drag_area_laws())
        for (const double x : {0.0, -1e-16}) {
            EXPECT_NEAR(law.at(x, 0.3).value, 0.09, 1e-14) << law.name;
            EXPECT_TRUE(std::isfinite(law.at(x, 0.3).rate)) << law.name;
        }
    EXPECT_EQ(find_drag_area_law("power-0.5")->at(0.0, 0.2).rate, 0.0);  // infinite from the right
    EXPECT_EQ(find_drag_area_law("power-1")->at(0.0, 0.0).rate, 1.0);
    // sqrt(x) has the slope 1/(2 sqrt(x)): 5e5 at 1e-12.
    EXPECT_NEAR(find_drag_area_law("power-0.5")->at(1e-12, 0.0).rate, 5e5, 1e-6);
}

TEST(HalfEllipsoid, IsTheVolumeOfItsDepth) {
    const double rho = 1.225, R = 2.77;
    AddedMassSpec spec{find_added_mass("half-ellipsoid")};
    ASSERT_NE(spec.model, nullptr);
    EXPECT_EQ(spec.depth_ratio, 0.41);
    // 2/3 pi R^2 h, h = 0.41 2 R, and 3/8 of it outside once the ramp has ended (paper, Eqs 16 and 18).
    const double included = rho * 2.0 / 3.0 * pi * R * R * (0.41 * 2.0 * R);
    EXPECT_NEAR(spec.mass(rho, {R, 0.0}, {0.0, 0.0}, 0.0).value, included, 1e-12);
    EXPECT_NEAR(spec.mass(rho, {R, 0.0}, {1.0, 0.0}, 0.0).value, 1.375 * included, 1e-12);
    spec.depth_ratio = 0.5;  // as deep as it is wide from the axis: half a sphere
    const AddedMassSpec sphere{find_added_mass("hemisphere")};
    EXPECT_DOUBLE_EQ(spec.mass(rho, {R, 0.3}, {0.4, 0.2}, 0.0).value,
                     sphere.mass(rho, {R, 0.3}, {0.4, 0.2}, 0.0).value);
    EXPECT_DOUBLE_EQ(spec.mass(rho, {R, 0.3}, {0.4, 0.2}, 0.0).rate,
                     sphere.mass(rho, {R, 0.3}, {0.4, 0.2}, 0.0).rate);
}

TEST(PorousAddedMass, FollowsItsCubic) {
    // k_a = 1.068 (1 - 1.465 p - 0.25975 p^2 + 1.2626 p^3) on 4/3 pi R^2 h, h = 0.41 2 R; by hand at p = 0.2:
    // 1 - 0.293 - 0.01039 + 0.0101008 = 0.7067108.
    const double R = 2.77, rho = 1.225;
    const AddedMassSpec spec{find_added_mass("porosity")};
    const double whole = rho * 4.0 / 3.0 * pi * R * R * (0.41 * 2.0 * R);
    EXPECT_NEAR(spec.mass(rho, {R, 0.0}, {0.3, 1.0}, 0.0).value, 1.068 * whole, 1e-12 * whole);
    EXPECT_NEAR(spec.mass(rho, {R, 0.0}, {0.3, 1.0}, 0.2).value, 1.068 * 0.7067108 * whole, 1e-7 * whole);
}

TEST(HalfEllipsoid, ReachesTheInflationWithItsDepth) {
    Inflation inflation;
    inflation.filling_time = 1.0;
    inflation.law = find_drag_area_law("power-2");
    AddedMassSpec shallow{find_added_mass("half-ellipsoid")}, deep = shallow;
    deep.depth_ratio = 2.0 * shallow.depth_ratio;
    const auto mass = [&](const AddedMassSpec& spec) {
        return inflation.added_mass(spec, Phase::filling, 0.5, 1.2, 2.77, 0.0).value;
    };
    EXPECT_DOUBLE_EQ(mass(deep), 2.0 * mass(shallow));
}

TEST(Wind, FromTheWestBlowsTowardTheEast) {
    const Vec3 west = wind_from(5.0, 270.0 / 180.0 * pi);
    EXPECT_NEAR((west - Vec3(5.0, 0.0, 0.0)).norm(), 0.0, 1e-14);
    const Vec3 north = wind_from(5.0, 0.0);
    EXPECT_NEAR((north - Vec3(0.0, -5.0, 0.0)).norm(), 0.0, 1e-14);
    const Vec3 northeast = wind_from(std::sqrt(8.0), 0.25 * pi);
    EXPECT_NEAR((northeast - Vec3(-2.0, -2.0, 0.0)).norm(), 0.0, 1e-14);
}

TEST(Wind, UniformIsTheSameEverywhere) {
    const Wind wind = uniform_wind({1.0, 2.0, 3.0});
    for (const double altitude : {-400.0, 0.0, 1.0, 30000.0})
        EXPECT_EQ(wind.at(altitude), Vec3(1.0, 2.0, 3.0));
    EXPECT_TRUE(wind.covers(-1e6, 1e6));
}

TEST(Wind, IsLinearBetweenLevelsAndKeepsItsEnds) {
    const Wind wind{{{100.0, {1.0, 0.0, 0.0}}, {200.0, {3.0, 4.0, -1.0}}, {400.0, {3.0, 0.0, 0.0}}}};
    EXPECT_EQ(wind.at(100.0), Vec3(1.0, 0.0, 0.0));
    EXPECT_EQ(wind.at(150.0), Vec3(2.0, 2.0, -0.5));
    EXPECT_EQ(wind.at(200.0), Vec3(3.0, 4.0, -1.0));
    EXPECT_EQ(wind.at(250.0), Vec3(3.0, 3.0, -0.75));
    EXPECT_EQ(wind.at(400.0), Vec3(3.0, 0.0, 0.0));
    EXPECT_EQ(wind.at(99.0), Vec3(1.0, 0.0, 0.0));
    EXPECT_EQ(wind.at(5000.0), Vec3(3.0, 0.0, 0.0));
    EXPECT_TRUE(wind.covers(100.0, 400.0));
    EXPECT_FALSE(wind.covers(99.0, 400.0));
    EXPECT_FALSE(wind.covers(100.0, 401.0));
}

}  // namespace
}  // namespace twinchute
