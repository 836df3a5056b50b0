// Every row of every table of models: values and rates by difference quotients, limits, monotonicity,
// dimensions, and the range that the row states.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "lib/math/vec.hpp"
#include "lib/models/added_mass.hpp"
#include "lib/models/atmosphere.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/drag_correction.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/opening_force.hpp"
#include "tests/support/difference.hpp"

namespace twinchute {
namespace {

using test::central_difference;

template <class Rows>
void expect_named_and_sourced(const Rows& rows) {
    std::set<std::string> names;
    for (const auto& row : rows) {
        EXPECT_FALSE(row.name.empty());
        EXPECT_FALSE(row.source.empty()) << row.name;
        EXPECT_TRUE(names.insert(std::string(row.name)).second) << row.name << " stands twice";
    }
}

TEST(ModelTables, HaveNamesOnceAndSources) {
    expect_named_and_sourced(atmosphere_models());
    expect_named_and_sourced(drag_area_laws());
    expect_named_and_sourced(fill_time_models());
    expect_named_and_sourced(added_mass_models());
    expect_named_and_sourced(opening_force_forms());
    expect_named_and_sourced(line_ratio_models());
    expect_named_and_sourced(forebody_wake_models());
}

TEST(ModelTables, FindTheirRowsAndNothingElse) {
    for (const auto& row : drag_area_laws())
        EXPECT_EQ(find_drag_area_law(row.name), &row);
    for (const auto& row : fill_time_models())
        EXPECT_EQ(find_fill_time(row.name), &row);
    for (const auto& row : added_mass_models())
        EXPECT_EQ(find_added_mass(row.name), &row);
    for (const auto& row : atmosphere_models())
        EXPECT_EQ(find_atmosphere(row.name), &row);
    EXPECT_EQ(find_drag_area_law("no such law"), nullptr);
    EXPECT_EQ(find_atmosphere(""), nullptr);
}

TEST(DragAreaContract, StartsAtEtaSquaredEndsAtOneAndGrows) {
    for (const DragAreaLaw& law : drag_area_laws())
        for (const double eta : {0.0, 0.1, 0.2, 0.5, 1.0}) {
            EXPECT_NEAR(law.at(0.0, eta).value, eta * eta, 1e-15) << law.name;
            EXPECT_NEAR(law.at(1.0, eta).value, 1.0, 1e-15) << law.name;
            for (double x = 0.0; x < 0.995; x += 0.01) {
                EXPECT_LE(law.at(x, eta).value, law.at(x + 0.01, eta).value) << law.name << x;
                EXPECT_GE(law.at(x, eta).rate, 0.0) << law.name << x;
            }
        }
}

TEST(DragAreaContract, RatesAreTheDerivativesOfValues) {
    for (const DragAreaLaw& law : drag_area_laws())
        for (const double eta : {0.0, 0.2, 0.7})
            for (double x = 0.05; x < 1.0; x += 0.05) {
                const double slope =
                    central_difference([&](double y) { return law.at(y, eta).value; }, x, 1e-5);
                // h^2 f'''/6 is largest for the square root at x = 0.05: 1e-10 * 0.375 * 0.05^-2.5/6 = 1e-8.
                EXPECT_NEAR(law.at(x, eta).rate, slope, 1e-7) << law.name << x;
            }
}

TEST(DragAreaContract, IntegralsAreThoseOfValues) {
    for (const DragAreaLaw& law : drag_area_laws())
        for (const double eta : {0.0, 0.2, 0.7}) {
            EXPECT_EQ(law.integral(0.0, eta), 0.0) << law.name;
            for (double x = 0.05; x < 1.0; x += 0.05) {
                const double slope =
                    central_difference([&](double y) { return law.integral(y, eta); }, x, 1e-5);
                // h^2 f''/6, f'' <= 0.25 x^-1.5 of the square root at 0.05: 4e-10; round-off 1e-11.
                EXPECT_NEAR(law.at(x, eta).value, slope, 2e-9) << law.name << x;
            }
        }
}

TEST(AddedMassContract, ScalesAsAirTimesVolume) {
    for (const AddedMassModel& model : added_mass_models()) {
        const double one = AddedMassSpec{&model}.mass(1.0, {1.0, 0.0}, {0.5, 0.0}, 0.1).value;
        EXPECT_GT(one, 0.0) << model.name;
        EXPECT_NEAR(AddedMassSpec{&model}.mass(3.0, {1.0, 0.0}, {0.5, 0.0}, 0.1).value, 3.0 * one, 1e-12)
            << model.name;
        EXPECT_NEAR(AddedMassSpec{&model}.mass(1.0, {2.0, 0.0}, {0.5, 0.0}, 0.1).value, 8.0 * one, 1e-12)
            << model.name;
        EXPECT_EQ(AddedMassSpec{&model}.mass(1.0, {0.0, 5.0}, {0.5, 1.0}, 0.1).value, 0.0) << model.name;
    }
}

TEST(AddedMassContract, GrowsWithRadiusAndRampAndRatesFollow) {
    for (const AddedMassModel& model : added_mass_models()) {
        const auto mass = [&](double t) {
            return AddedMassSpec{&model}.mass(1.1, {1.0 + 0.5 * t, 0.5}, {0.3 * t, 0.3}, 0.1);
        };
        for (double t = 0.1; t < 3.0; t += 0.3) {
            const double slope = central_difference([&](double s) { return mass(s).value; }, t, 1e-5);
            EXPECT_NEAR(mass(t).rate, slope, 1e-7 * (1.0 + slope)) << model.name;
            EXPECT_GT(mass(t).rate, 0.0) << model.name;
        }
    }
}

/// Every parameter that a row may ask for.
FillTime fill_time_of(const FillTimeModel& model) {
    FillTime choice{&model, 8.0, 0.0, 1.4};
    choice.table = FillTable{"a table", FillTable::By::froude_number, {10.0, 100.0}, {12.0, 6.0}};
    choice.balance.emplace();
    return choice;
}

constexpr FillTimeInputs snatch{8.5, 60.0, 1.0, 150.0, 155.0, 9.8, 42.0, 2.8, 0.0, 0.2};

/// A snatch in units of length and time that are so many metres and seconds.
FillTimeInputs in_units(const FillTimeInputs& in, double length, double time) {
    return {in.nominal_diameter / length,
            in.snatch_speed * time / length,
            in.density * length * length * length,
            in.payload_mass,
            in.mass,
            in.gravity * time * time / length,
            in.drag_area / (length * length),
            in.steady_radius / length,
            in.permeability * time / length,
            in.geometric_porosity};
}

TEST(FillTimeContract, IsATime) {
    // Seconds do not depend on the unit of length; in units of time twice as large they are half as many (a
    // given time is told in the same units).
    for (const FillTimeModel& model : fill_time_models()) {
        const FillTime choice = fill_time_of(model);
        const double seconds = choice.seconds(snatch);
        EXPECT_GT(seconds, 0.0) << model.name;
        EXPECT_FALSE(model.range.empty());
        if (model.dimensional) continue;
        EXPECT_NEAR(choice.seconds(in_units(snatch, 2.0, 1.0)), seconds, 1e-13) << model.name;
        FillTime halved = choice;
        halved.given *= 0.5;
        EXPECT_NEAR(halved.seconds(in_units(snatch, 1.0, 2.0)), 0.5 * seconds, 1e-13) << model.name;
    }
}

TEST(FillTimeContract, IsNeverLongerForFasterAirOrAThinnerOne) {
    FillTimeInputs fast = snatch, thin = snatch;
    fast.snatch_speed = 90.0;
    thin.density = 0.5;
    for (const FillTimeModel& model : fill_time_models()) {
        FillTime choice = fill_time_of(model);
        choice.density_exponent = 0.5;
        EXPECT_LE(choice.seconds(fast), choice.seconds(snatch)) << model.name;
        EXPECT_LE(choice.seconds(thin), choice.seconds(snatch)) << model.name;
    }
}

TEST(FillTimeContract, GoesByDiametersWhereItSaysSo) {
    FillTimeInputs fast = snatch;
    fast.snatch_speed *= 1.5;
    for (const FillTimeModel& model : fill_time_models()) {
        const FillTime choice = fill_time_of(model);
        const double ratio = choice.seconds(snatch) / choice.seconds(fast);
        if (model.by_diameters) {
            EXPECT_NEAR(ratio, 1.5, 1e-14) << model.name;
        }
        if (model.dimensional || model.name == "given") {
            EXPECT_GT(std::abs(ratio - 1.5), 0.01) << model.name;
        }
    }
}

TEST(AtmosphereContract, ObeysTheGasLawAndThinsUpward) {
    for (const AtmosphereModel& model : atmosphere_models()) {
        Atmosphere air;
        air.model = &model;
        air.constant_density = 1.1;
        if (model.name == "table") {
            air.table.altitude = {0.0, 5000.0, 20000.0};
            air.table.temperature = {290.0, 255.0, 216.0};
            air.table.logarithm = {std::log(101000.0), std::log(54000.0), std::log(5500.0)};
        }
        const double low = std::max(air.lowest(), -2000.0), high = std::min(air.highest(), 80000.0);
        double before = 1e9;
        for (double z = low; z <= high; z += (high - low) / 200.0) {
            const AirState at = air.at(z);
            EXPECT_NEAR(at.pressure / (at.density * 287.053 * at.temperature), 1.0, 1e-5) << model.name << z;
            EXPECT_GT(at.viscosity, 1e-5) << model.name << z;
            EXPECT_LE(at.density, before) << model.name << z;
            before = at.density;
        }
    }
}

}  // namespace
}  // namespace twinchute
