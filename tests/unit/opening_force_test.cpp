// Peak force by formula against its closed forms, its limits and the reasons why it does not hold.
#include "lib/models/opening_force.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/reference_rows.hpp"

namespace twinchute {
namespace {

const OpeningForceForm& form(std::string_view name) {
    for (const OpeningForceForm& row : opening_force_forms())
        if (row.name == name) return row;
    throw std::invalid_argument("no formula of that name");
}

/// A heavy, fast payload in thin air: every formula holds.
OpeningForceInputs fast_and_heavy() {
    OpeningForceInputs in;
    in.speed = 150.0;
    in.density = 0.9;
    in.altitude = 3000.0;
    in.gravity = 9.80665;
    in.mass = 2000.0;
    in.drag_area = 5.0;
    in.filling_time = 0.2;
    in.eta = 0.2;
    in.law = find_drag_area_law("ludtke");
    in.coefficient = 1.4;
    return in;
}

/// Inputs of a given ballistic parameter over the filling time.
OpeningForceInputs with_ballistic(double A) {
    OpeningForceInputs in = fast_and_heavy();
    in.mass = 0.5 * A * in.drag_area * in.density * in.speed * in.filling_time;
    return in;
}

TEST(OpeningForce, X1TableOfDragOnlyInflation) {
    // x1_closed_form.csv, exact and printed to eight digits: half a unit of the last, and as much of A, of
    // whose change X_1 takes less than the whole at the three A that are not round (thirds).
    const auto rows = test::reference_rows("x1_closed_form.csv");
    ASSERT_GE(rows.size(), 20u);
    for (const auto& row : rows) {
        const std::array<std::pair<const char*, std::size_t>, 5> columns{
            {{"power-0.5", 1}, {"power-1", 2}, {"power-2", 3}, {"power-3", 4}, {"power-6", 5}}};
        for (const auto& [law, column] : columns)
            EXPECT_NEAR(drag_only_peak(*find_drag_area_law(law), 0.0, row[0]), row[column], 1.01e-8)
                << law << ", A = " << row[0];
    }
}

TEST(OpeningForce, PeakOfAPowerLawInClosedForm) {
    // tau_m = [j (j + 1) A/(j + 2)]^(1/(j + 1)) while that is below 1, X_1 from it (the header of
    // x1_closed_form.csv). Tolerance: a maximum is flat, so its value is exact to round-off.
    for (const auto& [name, j] : {std::pair{"power-0.5", 0.5},
                                  {"power-1", 1.0},
                                  {"power-2", 2.0},
                                  {"power-3", 3.0},
                                  {"power-6", 6.0}})
        for (double A = 1e-4; A < 0.9 * (j + 2) / (j * (j + 1)); A *= 1.7) {
            const double expected =
                std::pow((j + 2) / (2 * (j + 1)), 2) * std::pow(j * (j + 1) * A / (j + 2), j / (j + 1));
            EXPECT_NEAR(drag_only_peak(*find_drag_area_law(name), 0.0, A) / expected, 1.0, 1e-12)
                << name << A;
        }
}

TEST(OpeningForce, PflanzLudtkeOvershootTable) {
    // pflanz_ludtke_overshoot.csv, exact and printed to six digits: half a unit of the last. The limit of A
    // below which the peak comes before the largest drag area has the closed form of the file's header.
    constexpr std::array ballistic{0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 20.0, 1000.0};
    const auto rows = test::reference_rows("pflanz_ludtke_overshoot.csv");
    ASSERT_EQ(rows.size(), 15u);
    for (const auto& row : rows) {
        const double j = row[0], C_x = row[1];
        const DragAreaLaw* law = find_drag_area_law("power-" + std::to_string(static_cast<int>(j)));
        ASSERT_NE(law, nullptr);
        const double last = std::pow(C_x, 1.0 / j);
        for (std::size_t i = 0; i < ballistic.size(); ++i)
            EXPECT_NEAR(drag_only_peak({law, 0.0}, ballistic[i], last), row[3 + i], 0.51e-6) << j << C_x;
        EXPECT_NEAR((j + 2) / (j * (j + 1)) * std::pow(C_x, (j + 1) / j), row[2], 0.51e-6);
        // A little above that limit the peak is the drag of the largest area, a little below more than it.
        const auto at_end = [&](double A) { return C_x / std::pow(1 + last * C_x / ((j + 1) * A), 2); };
        EXPECT_NEAR(drag_only_peak({law, 0.0}, 1.01 * row[2], last), at_end(1.01 * row[2]), 1e-12);
        EXPECT_GT(drag_only_peak({law, 0.0}, 0.9 * row[2], last), at_end(0.9 * row[2]) + 1e-6);
    }
}

TEST(OpeningForce, OvershootReachesTheFormula) {
    // A = 2, j = 2, C_x = 1.4: 0.859745 of the table above.
    const OpeningForceInputs in = with_ballistic(2.0);
    const double drag = 0.5 * in.density * in.speed * in.speed * in.drag_area;
    EXPECT_NEAR(form("pflanz-overshoot").force(in) / drag, 0.859745, 0.51e-6);
    OpeningForceInputs third = in;
    third.law = find_drag_area_law("power-1");
    EXPECT_NEAR(form("pflanz-overshoot").force(third) / drag, 0.649519, 0.51e-6);
    third.coefficient.reset();
    EXPECT_NE(form("pflanz-overshoot").outside(third), "");
}

TEST(OpeningForce, MomentumImpulseCurves) {
    // filling_time.csv, oscalc_Ck_upper and _lower at R_m = 1, 0.1 and 10, whose logarithms are 0, -1 and 1:
    // sums of coefficients, by hand. Tolerance: the coefficients are quoted to six digits.
    EXPECT_NEAR(momentum_impulse_coefficient(1.0, 2.0), 0.647104, 1e-6);
    EXPECT_NEAR(momentum_impulse_coefficient(0.1, 2.0), 0.977291, 2e-6);
    EXPECT_NEAR(momentum_impulse_coefficient(10.0, 2.0), 0.264208, 2e-6);
    EXPECT_NEAR(momentum_impulse_coefficient(1.0, 4.0), 0.125520, 1e-6);
    EXPECT_NEAR(momentum_impulse_coefficient(0.1, 8.0), 0.507861, 2e-6);
    EXPECT_NEAR(momentum_impulse_coefficient(10.0, 8.0), 0.035720, 2e-6);
    // R_m = 0.9 5^1.5/2000 = 0.005031 and n = 0.2 v t_f/sqrt((C_D S)_0) = 2.683: the curve for n below 4.
    const OpeningForceInputs in = fast_and_heavy();
    const double drag = 0.5 * in.density * in.speed * in.speed * in.drag_area;
    EXPECT_NEAR(form("momentum-impulse").force(in) / drag,
                momentum_impulse_coefficient(0.9 * std::pow(5.0, 1.5) / 2000.0, 3.0), 1e-12);
}

TEST(OpeningForce, LudtkeTable) {
    // ludtke_closed_form.csv: the peak to six digits.
    const auto rows = test::reference_rows("ludtke_closed_form.csv");
    ASSERT_GE(rows.size(), 15u);
    for (const auto& row : rows)
        EXPECT_NEAR(drag_only_peak(*find_drag_area_law("ludtke"), row[1], row[0]), row[2], 0.51e-6)
            << "M = " << row[0] << ", eta = " << row[1];
}

TEST(OpeningForce, KnackeFigure548) {
    // Our readings at the grid lines, to the digit; between them it rises; beyond them it is a share still.
    for (const auto& [psf, X1] :
         {std::pair{1.0, 0.100}, {2.0, 0.200}, {10.0, 0.505}, {20.0, 0.667}, {100.0, 0.977}})
        EXPECT_NEAR(force_reduction_by_loading(psf * 47.880258980), X1, 1e-12) << psf;
    double before = 0.0;
    for (double psf = 0.3; psf < 300.0; psf *= 1.1) {
        const double X1 = force_reduction_by_loading(psf * 47.880258980);
        EXPECT_GE(X1, before) << psf;
        EXPECT_LE(X1, 1.0);
        before = X1;
    }
}

TEST(OpeningForce, APayloadThatDoesNotSlowDownTakesTheFullDrag) {
    // A -> infinity: 1/(1 + 1/(3 A))^2 of C_x q (C_D S)_0 with j = 2, and of q (C_D S)_0 by Ludtke's law,
    // whose integral over filling is (1 - eta)^2/7 + (1 - eta) eta/2 + eta^2 = 0.211 at eta = 0.2.
    const OpeningForceInputs in = with_ballistic(1e4);
    const double drag = 0.5 * in.density * in.speed * in.speed * in.drag_area;
    EXPECT_NEAR(form("infinite-mass").force(in), 1.4 * drag, 1e-12 * drag);
    EXPECT_NEAR(form("pflanz").force(in) / (1.4 * drag), 1.0 - 2.0 / 3e4, 1e-8);
    const double share = 0.64 / 7.0 + 0.16 / 2.0 + 0.04;
    EXPECT_NEAR(form("ludtke").force(in) / drag, 1.0 - 2.0 * share / 1e4, 1e-8);
}

TEST(OpeningForce, AnOvershootIsPartOfTheScenesLaw) {
    // A payload that does not slow down takes the largest drag area there is, 1.6 of the steady one after the
    // canopy is full; 1e-4 of it by 2/A times the area under the table, below 1.
    OpeningForceInputs in = with_ballistic(1e5);
    const DragAreaTable table("t.csv", {0.0, 1.0, 1.2, 1.5}, {0.04, 1.0, 1.6, 1.0});
    in.table = &table;
    const double drag = 0.5 * in.density * in.speed * in.speed * in.drag_area;
    EXPECT_NEAR(form("ludtke").force(in) / drag, 1.6, 1.6 * 2e-5);
}

TEST(OpeningForce, ALightPayloadFeelsItsPeakAtSnatch) {
    // A -> 0: it has stopped before the canopy grows, so that the drag at snatch is the largest.
    const OpeningForceInputs in = with_ballistic(1e-4);
    const double drag = 0.5 * in.density * in.speed * in.speed * in.drag_area;
    EXPECT_NEAR(form("ludtke").force(in), 0.04 * drag, 1e-12 * drag);
}

TEST(OpeningForce, AnInitialPhaseBrakesFirst) {
    // With eta = 1 the drag area is constant from the start, however that is divided into phases.
    OpeningForceInputs in = with_ballistic(0.5);
    in.eta = 1.0;
    const double at_once = form("ludtke").force(in);
    in.initial_time = 0.15 * in.filling_time;
    EXPECT_DOUBLE_EQ(form("ludtke").force(in), at_once);
    // With eta = 0 nothing brakes in the initial phase: an opening over the rest of the time.
    in.eta = 0.0;
    const double later = form("ludtke").force(in);
    in.filling_time -= in.initial_time;
    in.initial_time = 0.0;
    EXPECT_NEAR(form("ludtke").force(in) / later, 1.0, 1e-14);
}

TEST(OpeningForce, EveryFormulaHoldsForAHeavyPayloadAtHighSpeed) {
    for (const OpeningForceForm& row : opening_force_forms()) {
        // A third hand's fit stands for orientation alone, whatever the inputs.
        const bool holds = row.name != "momentum-impulse";
        EXPECT_EQ(row.outside(fast_and_heavy()).substr(0, 15), holds ? "" : "for orientation") << row.name;
        EXPECT_GT(row.force(fast_and_heavy()), 0.0) << row.name;
    }
}

TEST(OpeningForce, SaysWhyItDoesNotHold) {
    const auto reason = [](std::string_view name, auto&& change) {
        OpeningForceInputs in = fast_and_heavy();
        change(in);
        return form(name).outside(in);
    };
    const auto has = [](const std::string& text, std::string_view part) {
        return text.find(part) != std::string::npos;
    };
    const auto slow = [](OpeningForceInputs& in) { in.filling_time = 3.0; };
    EXPECT_TRUE(has(reason("ludtke", slow), "gravity is worth 19.6 %"));  // 9.80665 * 3/150
    EXPECT_TRUE(has(reason("pflanz", slow), "gravity"));
    EXPECT_TRUE(has(reason("ludtke", [](auto& in) { in.added_mass = 300.0; }), "15 % of the mass in air"));
    EXPECT_TRUE(has(reason("infinite-mass", [](auto& in) { in.mass = 50.0; }), "slows down"));
    EXPECT_TRUE(has(reason("canopy-loading", [](auto& in) { in.drag_area = 500.0; }), "0.82 psf"));
    EXPECT_TRUE(has(reason("canopy-loading", [](auto& in) { in.altitude = 5000.0; }), "15 000 ft"));
    for (const char* name : {"infinite-mass", "canopy-loading", "pflanz"}) {
        const auto without = [](OpeningForceInputs& in) { in.coefficient.reset(); };
        EXPECT_TRUE(has(reason(name, without), "needs C_x")) << name;
    }
}

}  // namespace
}  // namespace twinchute
