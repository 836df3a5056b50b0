// Atmosphere, drag-area law, filling time, initial phase, added mass and cylinder drag against their
// definitions.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/models/added_mass.hpp"
#include "lib/models/atmosphere.hpp"
#include "lib/models/cylinder_drag.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/inflation.hpp"
#include "tests/support/difference.hpp"

namespace twinchute {
namespace {

using test::central_difference;

// --- atmosphere ---------------------------------------------------------------------------------

TEST(Atmosphere, Us76ReproducesItsTables) {
    struct Row {
        double altitude, temperature, pressure, density;
    };
    // US Standard Atmosphere 1976 (NOAA-S/T 76-1562), Table I, geometric altitude: printed with five
    // significant digits, hence the tolerance of 1e-4.
    constexpr Row rows[] = {{0.0, 288.150, 1.01325e5, 1.2250},       {1000.0, 281.651, 8.9876e4, 1.1117},
                            {5000.0, 255.676, 5.4048e4, 7.3643e-1},  {11000.0, 216.774, 2.2700e4, 3.6480e-1},
                            {20000.0, 216.650, 5.5293e3, 8.8910e-2}, {32000.0, 228.490, 8.8906e2, 1.3555e-2},
                            {50000.0, 270.650, 7.9779e1, 1.0269e-3}};
    const Atmosphere air{find_atmosphere("us76"), 0.0};
    for (const Row& row : rows) {
        const AirState at = air.at(row.altitude);
        EXPECT_NEAR(at.temperature, row.temperature, 1e-3) << row.altitude;
        EXPECT_NEAR(at.pressure / row.pressure, 1.0, 1e-4) << row.altitude;
        EXPECT_NEAR(at.density / row.density, 1.0, 1e-4) << row.altitude;
    }
    EXPECT_NEAR(air.at(0.0).viscosity / 1.7894e-5, 1.0, 1e-4);  // the same, Table III
}

TEST(Atmosphere, Us76IsHydrostaticAndContinuous) {
    // dp/dz = -rho g(z), g falling with the square of the distance from the centre (US76, Eq. 17).
    const Atmosphere air{find_atmosphere("us76"), 0.0};
    for (double z = -500.0; z < 84000.0; z += 737.0) {
        const double g = standard_gravity * std::pow(6356766.0 / (6356766.0 + z), 2);
        const double slope = central_difference([&](double h) { return air.at(h).pressure; }, z, 0.5);
        EXPECT_NEAR(slope / (-air.at(z).density * g), 1.0, 1e-5) << z;
    }
}

TEST(Atmosphere, ConstantIsConstant) {
    const Atmosphere air{find_atmosphere("constant"), 1.1};
    EXPECT_EQ(air.at(0.0).density, 1.1);
    EXPECT_EQ(air.at(9000.0).density, 1.1);
}

// --- drag area ----------------------------------------------------------------------------------

TEST(DragAreaLaws, LudtkeIsTheSquareOfACubic) {
    const DragAreaLaw* law = find_drag_area_law("ludtke");
    ASSERT_NE(law, nullptr);
    // Paper, Eq. 14, with eta = 0: (t/t_f)^6; with eta = 0.2 at half the time: (0.8/8 + 0.2)^2 = 0.09.
    EXPECT_DOUBLE_EQ(law->at(0.5, 0.0).value, std::pow(0.5, 6));
    EXPECT_DOUBLE_EQ(law->at(0.5, 0.2).value, 0.09);
    EXPECT_EQ(find_drag_area_law("ludke"), nullptr);
}

// --- filling time -------------------------------------------------------------------------------

TEST(FillTime, FillConstantIsADistance) {
    const FillTime model{find_fill_time("fill-constant"), 4.0, 0.0, 0.0};
    // n D0/v_s (paper, Eq. 13): the distance n D0 does not depend on the speed.
    EXPECT_DOUBLE_EQ(model.seconds({8.53, 21.0, 1.225}), 4.0 * 8.53 / 21.0);
    EXPECT_DOUBLE_EQ(model.seconds({8.53, 42.0, 1.225}) * 42.0, model.seconds({8.53, 21.0, 0.5}) * 21.0);
}

TEST(FillTime, DensityExponentShortensAtAltitude) {
    const FillTime plain{find_fill_time("fill-constant"), 8.0, 0.0, 0.0};
    const FillTime corrected{find_fill_time("fill-constant"), 8.0, 0.8, 0.0};
    const FillTimeInputs high{8.53, 100.0, 0.6};
    EXPECT_NEAR(corrected.seconds(high) / plain.seconds(high), std::pow(0.6 / 1.225, 0.8), 1e-14);
    const FillTimeInputs sea_level{8.53, 100.0, sea_level_density};
    EXPECT_DOUBLE_EQ(corrected.seconds(sea_level), plain.seconds(sea_level));
}

TEST(FillTime, KnackesPowerInFeetAndFeetPerSecond) {
    // A 28 ft canopy at 200 ft/s with n = 4: 4 * 28/200^0.85 = 1.23977 s; in metres the constant is 1.19508 n
    // (filling_time.csv), 0.3048^-0.15.
    const FillTime model{find_fill_time("knacke-0.85"), 4.0};
    const double seconds = model.seconds({28.0 * 0.3048, 200.0 * 0.3048, 1.0});
    EXPECT_NEAR(seconds, 4.0 * 28.0 / std::pow(200.0, 0.85), 1e-12);
    EXPECT_NEAR(seconds, 1.19508 * 4.0 * 8.5344 / std::pow(60.96, 0.85), 5e-6);
}

TEST(FillTime, RibbonByPorosityInPercent) {
    // 0.65 lambda_g D0/v with lambda_g = 20 %: 13 diameters.
    FillTimeInputs in{10.0, 65.0, 1.0};
    in.geometric_porosity = 0.2;
    EXPECT_NEAR(FillTime{find_fill_time("ribbon")}.seconds(in), 2.0, 1e-12);
}

TEST(FillTime, GivenIsGiven) {
    EXPECT_EQ((FillTime{find_fill_time("given"), 0.0, 0.0, 1.3}.seconds({8.53, 21.0, 1.0})), 1.3);
}

// --- inflation ----------------------------------------------------------------------------------

Inflation c9_inflation() {
    return {2.0, 0.2, 1.6, 42.56, 0.2, find_drag_area_law("ludtke")};
}

TEST(Inflation, RunsOnTheTimeAfterTheInitialPhase) {
    const Inflation inflation = c9_inflation();
    EXPECT_DOUBLE_EQ(inflation.end_of(Phase::initial), 2.2);
    EXPECT_DOUBLE_EQ(inflation.end_of(Phase::filling), 3.6);
    EXPECT_TRUE(std::isinf(inflation.end_of(Phase::open)));
    EXPECT_DOUBLE_EQ(inflation.drag_area_ratio(Phase::initial, 2.1).value, 0.04);
    // Half of what is left after t_i: x = 1/2, not (t - t_s)/t_f.
    EXPECT_DOUBLE_EQ(inflation.drag_area_ratio(Phase::filling, 2.9).value, 0.09);
    EXPECT_DOUBLE_EQ(inflation.drag_area_ratio(Phase::open, 9.0).value, 1.0);
}

TEST(Inflation, IsContinuousAcrossItsPhases) {
    const Inflation inflation = c9_inflation();
    for (const auto& [before, after] :
         {std::pair{Phase::initial, Phase::filling}, {Phase::filling, Phase::open}}) {
        const double t = inflation.end_of(before);
        EXPECT_NEAR(inflation.drag_area_ratio(before, t).value, inflation.drag_area_ratio(after, t).value,
                    1e-14);
        EXPECT_NEAR(inflation.ramp(before, t).value, inflation.ramp(after, t).value, 1e-14);
    }
    EXPECT_EQ(inflation.ramp(Phase::initial, 2.0).value, 0.0);
}

TEST(Inflation, RatesAreTheDerivativesOfValues) {
    const Inflation inflation = c9_inflation();
    const AddedMassSpec model{find_added_mass("hemisphere")};
    for (double t = 2.25; t < 3.55; t += 0.05) {
        const auto ratio = [&](double s) { return inflation.drag_area_ratio(Phase::filling, s).value; };
        const auto mass = [&](double s) {
            return inflation.added_mass(model, Phase::filling, s, 1.225, 2.77, 0.0).value;
        };
        EXPECT_NEAR(inflation.drag_area_ratio(Phase::filling, t).rate, central_difference(ratio, t, 1e-5),
                    1e-7);
        EXPECT_NEAR(inflation.added_mass(model, Phase::filling, t, 1.225, 2.77, 0.0).rate,
                    central_difference(mass, t, 1e-5), 1e-4);
    }
}

TEST(Inflation, FromNothingTheAddedMassHasNoRate) {
    Inflation inflation = c9_inflation();
    inflation.eta = 0.0;
    inflation.initial_time = 0.25;  // exact in binary, so that the fill fraction is zero
    const auto start =
        inflation.added_mass({find_added_mass("hemisphere")}, Phase::filling, 2.25, 1.2, 2.77, 0.0);
    EXPECT_EQ(start.value, 0.0);
    EXPECT_EQ(start.rate, 0.0);
}

// --- added mass ---------------------------------------------------------------------------------

TEST(AddedMass, HemisphereIsIncludedPlusApparentMass) {
    const AddedMassSpec model{find_added_mass("hemisphere")};
    const double R = 2.77, rho = 1.225;
    const double included = rho * 2.0 / 3.0 * pi * R * R * R;  // paper, Eq. 16
    EXPECT_NEAR(model.mass(rho, {R, 0.0}, {0.0, 0.0}, 0.0).value, included, 1e-12);
    // Eq. 18 at phi' = 1 is Eq. 17 with k' = 0.25: k' rho pi R^3.
    EXPECT_NEAR(model.mass(rho, {R, 0.0}, {1.0, 0.0}, 0.0).value, included + 0.25 * rho * pi * R * R * R,
                1e-12);
}

// --- cylinder drag ------------------------------------------------------------------------------

TEST(CylinderDrag, GoesThroughTheMeasurements) {
    // Wieselsberger 1922, three of the tabulated points.
    EXPECT_NEAR(cylinder_drag_coefficient(196.0), 1.27, 1e-12);
    EXPECT_NEAR(cylinder_drag_coefficient(9180.0), 1.06, 1e-12);
    EXPECT_NEAR(cylinder_drag_coefficient(503000.0), 0.302, 1e-12);
    // Between two points on a log-log line: the geometric mean at the geometric mean.
    EXPECT_NEAR(cylinder_drag_coefficient(std::sqrt(5150.0 * 9180.0)), std::sqrt(0.944 * 1.06), 1e-12);
}

TEST(CylinderDrag, TableFollowsTheFunction) {
    const CylinderDragTable table;
    double worst = 0.0, crisis = 0.0;
    for (double re = 0.0626; re < 1e6; re *= 1.0137) {
        double& group = re < 1e5 ? worst : crisis;
        group = std::max(group, std::abs(table(re) / cylinder_drag_coefficient(re) - 1.0));
    }
    EXPECT_LT(worst, 2e-3);   // where lines fly
    EXPECT_LT(crisis, 3e-2);  // kinks of the drag crisis, cut off by a cell of 1/16 octave
    EXPECT_EQ(table(5e6), cylinder_drag_coefficient(5e6));
}

TEST(CylinderDrag, ForceVanishesWithTheSpeed) {
    const CylinderDragTable table;
    EXPECT_TRUE(std::isfinite(table(0.0)));
    EXPECT_TRUE(std::isnan(table(std::nan(""))));               // handed on, to be caught, and no wild index
    EXPECT_NEAR(table(1e-4) * 1e-4, table(1e-6) * 1e-6, 1e-9);  // Stokes: C_d Re constant
}

}  // namespace
}  // namespace twinchute
