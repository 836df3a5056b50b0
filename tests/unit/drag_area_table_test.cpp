// A drag area that grows by a table: the curve between its points, what is refused, and its phases.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lib/models/inflation.hpp"
#include "lib/scene/opening_tables.hpp"
#include "tests/support/difference.hpp"
#include "tests/support/scratch_dir.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using test::central_difference;
using test::edited;
using test::good_scene;

const std::vector<double> fraction{0.0, 0.4, 0.7, 1.0, 1.2, 1.5, 1.8};
const std::vector<double> ratio{0.05, 0.1, 0.4, 1.0, 1.4, 1.2, 1.0};

/// Over-inflates by 40 %, and is back at 1.8 filling times.
DragAreaTable overshooting() {
    return {"t.csv", fraction, ratio};
}

TEST(DragAreaTable, GoesThroughItsPointsAndNeverBeyondThem) {
    const DragAreaTable table = overshooting();
    for (std::size_t i = 0; i < fraction.size(); ++i)
        EXPECT_NEAR(table.at(fraction[i]).value, ratio[i], 1e-15) << fraction[i];
    for (std::size_t i = 0; i + 1 < fraction.size(); ++i)
        for (double share = 0.05; share < 1.0; share += 0.05) {
            const double value = table.at(fraction[i] + share * (fraction[i + 1] - fraction[i])).value;
            EXPECT_GE(value, std::min(ratio[i], ratio[i + 1])) << fraction[i];
            EXPECT_LE(value, std::max(ratio[i], ratio[i + 1])) << fraction[i];
        }
    EXPECT_EQ(table.at(-1e-16).value, 0.05);
    EXPECT_EQ(table.at(1.8 + 1e-15).value, 1.0);
}

TEST(DragAreaTable, HasTheRateAndTheIntegralOfItsValues) {
    const DragAreaTable table = overshooting();
    for (double x = 0.03; x < 1.8; x += 0.05) {
        // Cubics: a difference quotient leaves a sixth of h^2 times the third derivative, below 1e-10 of 40.
        EXPECT_NEAR(table.at(x).rate,
                    central_difference([&](double y) { return table.at(y).value; }, x, 1e-5), 1e-8)
            << x;
        EXPECT_NEAR(table.at(x).value,
                    central_difference([&](double y) { return table.integral(y); }, x, 1e-5), 1e-9)
            << x;
    }
    EXPECT_EQ(table.integral(0.0), 0.0);
}

TEST(DragAreaTable, OfALawIsThatLaw) {
    // x^2 at 201 points: a straight line between them would be off by an eighth of h^2 times 2.
    std::vector<double> x, square;
    for (int i = 0; i <= 200; ++i) {
        x.push_back(i / 200.0);
        square.push_back(x.back() * x.back());
    }
    const DragAreaTable table("t.csv", x, square);
    for (double y = 0.0; y <= 1.0; y += 0.0031)
        EXPECT_NEAR(table.at(y).value, y * y, 0.25 / (200.0 * 200.0)) << y;
}

/// t^2 up to 1.7 at 401 points, then straight down to 1: a closed form of an overshoot, sampled.
DragAreaTable with_a_kink() {
    std::vector<double> x, y;
    const double top = std::sqrt(1.7);
    for (int i = 0; i / 400.0 < top; ++i) {
        x.push_back(i / 400.0);
        y.push_back(x.back() * x.back());
    }
    for (int i = 0; i <= 200; ++i) {
        x.push_back(top + 0.5 * i / 200.0);
        y.push_back(i == 200 ? 1.0 : 1.7 - 0.7 * i / 200.0);
    }
    return {"t.csv", x, y};
}

TEST(DragAreaTable, KeepsAKinkSharpWhereItsSlopeJumps) {
    const DragAreaTable table = with_a_kink();
    const double top = std::sqrt(1.7);
    ASSERT_EQ(table.pieces(), 2u);
    EXPECT_EQ(table.kink_after(0), top);
    EXPECT_EQ(table.kink_after(1), std::numeric_limits<double>::infinity());
    // Right before it and right after it, too. The slope at an end of a piece is that from point to point,
    // off by h = 1/400 times half the second derivative: of the value 4/27 h^2.
    for (double x = top - 0.01; x < top; x += 1.7e-4)
        EXPECT_NEAR(table.at(x).value, x * x, 0.15 / 400 / 400) << x;
    for (double x = top; x < top + 0.01; x += 1.7e-4)
        EXPECT_NEAR(table.at(x).value, 1.7 - 1.4 * (x - top), 1e-12) << x;
    // On the kink either piece has its own rate, wherever rounding puts it.
    for (const double x : {top - 1e-13, top, top + 1e-13}) {
        EXPECT_NEAR(table.at(x, 0).rate, 2.0 * top, 1.1 / 400) << x;
        EXPECT_NEAR(table.at(x, 1).rate, -1.4, 1e-10) << x;
    }
    // Far from it the number of the piece says nothing.
    EXPECT_EQ(table.at(0.7, 1).value, table.at(0.7, 0).value);
    EXPECT_NEAR(table.integral(top + 0.5), top * 1.7 / 3.0 + 0.5 * (0.5 * 2.7), 1e-6);
}

TEST(DragAreaTable, IsSmoothWhereItsSlopeChangesByDegrees) {
    // A smooth top, coarse and fine, and steps that grow: no kink.
    for (const int points : {6, 20, 400}) {
        std::vector<double> x, y;
        for (int i = 0; i <= points; ++i) {
            x.push_back(2.0 * i / points);
            y.push_back(1.3 - 0.3 * std::pow(x.back() - 1.0, 2));
        }
        EXPECT_EQ(DragAreaTable("t.csv", x, y).pieces(), 1u) << points;
    }
    for (const double power : {0.5, 1.0, 2.0, 6.0}) {
        std::vector<double> x, y;
        for (int i = 0; i <= 50; ++i) {
            x.push_back(i / 50.0);
            y.push_back(std::pow(x.back(), power));
        }
        EXPECT_EQ(DragAreaTable("t.csv", x, y).pieces(), 1u) << power;
    }
}

TEST(DragAreaTable, HasAKinkWhereAPointStandsTwice) {
    // Straight from point to point.
    const DragAreaTable table("t.csv", {0.0, 0.5, 0.5, 1.0, 1.0, 1.5, 1.5, 2.0},
                              {0.1, 0.3, 0.3, 1.0, 1.0, 1.4, 1.4, 1.0});
    ASSERT_EQ(table.pieces(), 4u);
    EXPECT_EQ(table.kink_after(0), 0.5);
    EXPECT_EQ(table.kink_after(1), 1.0);
    EXPECT_EQ(table.kink_after(2), 1.5);
    for (double x = 0.0; x <= 2.0; x += 0.01) {
        const double expected = x < 0.5   ? 0.1 + 0.4 * x
                                : x < 1.0 ? 0.3 + 1.4 * (x - 0.5)
                                : x < 1.5 ? 1.0 + 0.8 * (x - 1.0)
                                          : 1.4 - 0.8 * (x - 1.5);
        EXPECT_NEAR(table.at(x).value, expected, 1e-12) << x;
    }
    EXPECT_NEAR(table.at(0.5, 0).rate, 0.4, 1e-12);
    EXPECT_NEAR(table.at(0.5, 1).rate, 1.4, 1e-12);
    EXPECT_NEAR(table.integral(2.0), 0.1 + 0.325 + 0.6 + 0.6, 1e-12);
    Inflation inflation;
    inflation.snatch = 2.0;
    inflation.initial_time = 0.5;
    inflation.filling_time = 1.5;
    inflation.table = &table;
    EXPECT_DOUBLE_EQ(inflation.next_kink(), 3.0);
    inflation.piece = 1;
    EXPECT_EQ(inflation.next_kink(), inflation.end_of(Phase::filling));  // to the bit
    inflation.piece = 3;
    EXPECT_EQ(inflation.next_kink(), std::numeric_limits<double>::infinity());
}

TEST(DragAreaTable, MakesAPhaseOfItsOvershoot) {
    const DragAreaTable table = overshooting();
    Inflation inflation;
    inflation.snatch = 2.0;
    inflation.initial_time = 0.5;
    inflation.filling_time = 1.5;
    inflation.law = find_drag_area_law("ludtke");
    EXPECT_EQ(inflation.after(Phase::filling), Phase::open);
    EXPECT_EQ(inflation.end_of(Phase::overshoot), 3.5);
    inflation.table = &table;
    inflation.eta = std::sqrt(0.05);
    EXPECT_EQ(inflation.after(Phase::initial), Phase::filling);
    EXPECT_EQ(inflation.after(Phase::filling), Phase::overshoot);
    EXPECT_EQ(inflation.after(Phase::overshoot), Phase::open);
    // t_s + t_i + 1.8 (t_f - t_i).
    EXPECT_DOUBLE_EQ(inflation.end_of(Phase::overshoot), 2.5 + 1.8);
    EXPECT_EQ(inflation.phase_at(2.2), Phase::initial);
    EXPECT_EQ(inflation.phase_at(3.0), Phase::filling);
    EXPECT_EQ(inflation.phase_at(3.5), Phase::overshoot);
    EXPECT_EQ(inflation.phase_at(4.4), Phase::open);
    EXPECT_NEAR(inflation.drag_area_ratio(Phase::initial, 2.5).value, 0.05, 1e-15);
    EXPECT_NEAR(inflation.drag_area_ratio(Phase::filling, 2.9).value, 0.1, 1e-15);
    EXPECT_NEAR(inflation.drag_area_ratio(Phase::overshoot, 3.7).value, 1.4, 1e-14);
    EXPECT_EQ(inflation.ramp(Phase::overshoot, 3.7).value, 1.0);
    // Continuous where phases meet.
    EXPECT_NEAR(inflation.drag_area_ratio(Phase::filling, 3.5).value, 1.0, 1e-14);
    EXPECT_NEAR(inflation.drag_area_ratio(Phase::overshoot, 4.3).value, 1.0, 1e-14);
}

std::string refusal(const std::string& lines) {
    try {
        read_drag_area_table("fill_fraction,drag_area_ratio\n1,1\n" + lines, "t.csv", "t.csv");
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

TEST(DragAreaTable, ThatIsNoGrowthIsRefusedAtItsLine) {
    const auto expect = [](const std::string& lines, const std::string& place, const std::string& why) {
        const std::string found = refusal(lines);
        EXPECT_EQ(found.find(place), 0u) << found;
        EXPECT_NE(found.find(why), std::string::npos) << found;
    };
    EXPECT_EQ(refusal("0,0.04\n0.5,0.3\n1,1\n"), "");
    expect("0,0.04\n1,1\n", "t.csv:4:1: ", "2 points");
    expect("0.1,0.04\n0.5,0.3\n1,1\n", "t.csv:3:1: ", "begins at 0.1");
    expect("0,0.04\n0.5,0.3\n0.9,1\n", "t.csv:5:1: ", "no fill_fraction of 1");
    expect("0,0.04\n0.5,0.3\n1,0.98\n", "t.csv:5:1: ", "is 0.98 at fill_fraction 1");
    expect("0,0.04\n0.5,0.3\n1,1\n1.2,1.3\n", "t.csv:6:1: ", "is 1.3 at the end");
    expect("0,0.04\n0.5,1.1\n1,1\n", "t.csv:4:1: ", "before fill_fraction 1");
    EXPECT_EQ(refusal("0,0.04\n0.5,0.3\n0.5,0.3\n1,1\n"), "");
    expect("0,0.04\n0.5,0.3\n0.5,0.4\n1,1\n", "t.csv:5:1: ", "jumps from 0.3 to 0.4");
    expect("0,0.04\n0.5,0.3\n0.5,0.3\n0.5,0.3\n1,1\n", "t.csv:6:1: ", "does not rise");
    expect("0,0.04\n0,0.04\n0.5,0.3\n1,1\n", "t.csv:4:1: ", "stands here twice");
    expect("0,0.04\n0.5,0.3\n1,1\n1,1\n", "t.csv:6:1: ", "stands here twice");
    expect("0,0.04\n0.5,-0.1\n1,1\n", "t.csv:4:5: ", "out of range");
}

TEST(DragAreaTable, IsReadWithASceneAndSetsWhereItStarts) {
    ScratchDir here;
    here.write("growth.csv", "fill_fraction,drag_area_ratio\n1,%\n0,9\n0.5,30\n1,100\n1.2,140\n1.5,100\n");
    const auto read = [&](const std::string& line) {
        return read_scene_text(edited(good_scene, "fill_time =", line + "\nfill_time ="), "test.toml",
                               here.path());
    };
    const Parachute p = read("drag_area_table = \"growth.csv\"").parachutes.front();
    ASSERT_TRUE(p.drag_area_table);
    EXPECT_EQ(p.initial_drag_area_ratio, 0.09);
    EXPECT_EQ(p.drag_area_table->end(), 1.5);
    // Keys that repeat the table are refused.
    for (const char* beside : {"drag_area_law = \"power-2\"", "initial_drag_area_ratio = 0.04"})
        EXPECT_THROW(read(std::string("drag_area_table = \"growth.csv\"\n") + beside), SceneError) << beside;
    EXPECT_THROW(read("drag_area_table = \"none.csv\""), SceneError);
}

}  // namespace
}  // namespace twinchute
