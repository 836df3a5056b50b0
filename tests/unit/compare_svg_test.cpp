// Plots: axes, thinning, lines, markers, labels and what is not drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "compare/render/plot.hpp"
#include "compare/render/ticks.hpp"
#include "compare/report/plots.hpp"
#include "tests/support/compare_records.hpp"
#include "tests/support/count.hpp"

namespace twinchute::compare {
namespace {

TEST(CompareTicks, AreRoundNumbersThatEncloseTheData) {
    const Ticks ticks = nice_ticks(0, 4671, 6);
    EXPECT_EQ(ticks.values, (std::vector<double>{0, 1000, 2000, 3000, 4000, 5000}));
    EXPECT_EQ(ticks.decimals, 0);
    EXPECT_EQ(nice_ticks(0, 3.2, 8).values.at(1), 0.5);
    EXPECT_EQ(nice_ticks(0, 3.2, 8).decimals, 1);
}

TEST(CompareTicks, SurviveEveryScale) {
    for (const double size : {1e-12, 3e-5, 1.0, 7e3, 2e9}) {
        for (const double low : {-0.3 * size, 0.0, 0.9 * size, size}) {
            const Ticks ticks = nice_ticks(low, size, 6);
            EXPECT_LE(ticks.values.front(), low + 1e-6 * size) << size;
            EXPECT_GE(ticks.values.back(), size * (1 - 1e-6)) << size;
            EXPECT_GE(ticks.values.size(), 2u);
            EXPECT_LE(ticks.values.size(), 14u);
        }
    }
}

TEST(CompareTicks, SurviveWhatOnlyAForeignRecordHolds) {
    // Steps below the last bit, beyond the largest number, below the smallest one.
    for (const auto& [low, high] :
         std::initializer_list<std::pair<double, double>>{{1e20, std::nextafter(1e20, 1e21)},
                                                          {-1e100, 1e100},
                                                          {0, 5e-324},
                                                          {-5e-324, 5e-324},
                                                          {7e99, 7e99}}) {
        const Ticks ticks = nice_ticks(low, high, 6);
        EXPECT_LE(ticks.values.front(), low);
        EXPECT_GE(ticks.values.back(), high);
        EXPECT_GE(ticks.values.size(), 2u);
        EXPECT_LE(ticks.values.size(), 14u);
    }
}

TEST(CompareThinning, KeepsEveryExtreme) {
    std::vector<Point> points;
    for (int i = 0; i < 100000; ++i)
        points.push_back({i * 1e-3, std::sin(i * 1e-4)});
    points[54321].y = 17;  // a spike of one sample is what a force plot is for
    points[77777].y = -9;
    const std::vector<Point> kept = thinned(points, 600);
    EXPECT_LE(kept.size(), 2400u);
    const auto [low, high] = std::ranges::minmax(kept, {}, &Point::y);
    EXPECT_EQ(low.y, -9);
    EXPECT_EQ(high.y, 17);
    EXPECT_TRUE(std::ranges::is_sorted(kept, {}, &Point::x));
    EXPECT_EQ(kept.front().x, points.front().x);
    EXPECT_EQ(kept.back().x, points.back().x);
}

TEST(CompareThinning, EndsWhereTimeRunsBackwards) {
    std::vector<Point> points;
    for (int i = 0; i < 10000; ++i)
        points.push_back({i % 3 == 0 ? -1e100 : 1e-3 * i, 1.0});
    EXPECT_LE(thinned(points, 600).size(), points.size());
}

TEST(CompareThinning, LeavesShortSeriesAlone) {
    const std::vector<Point> points{{0, 1}, {1, 2}, {1, 3}};
    EXPECT_EQ(thinned(points, 600).size(), 3u);
    EXPECT_TRUE(thinned({}, 600).empty());
}

TEST(CompareSvg, DrawsBothSidesWithLegendAndMarkers) {
    const std::string svg = force_svg(page_sides(synthetic_comparison()));
    EXPECT_EQ(test::count_of(svg, "<path "), 2u);
    EXPECT_NE(svg.find("full: peak 5000 N at 1.50 s"), std::string::npos);
    EXPECT_NE(svg.find("rom: peak 4800 N at 1.45 s"), std::string::npos);
    EXPECT_EQ(test::count_of(svg, "full open, "), 2u);
    EXPECT_NE(svg.find("opening force [N]"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), svg.find("inflation"));  // the scene's name and nothing else
}

TEST(CompareSvg, LargeForcesAreInKilonewtons) {
    Comparison comparison = synthetic_comparison();
    for (double& force : comparison.reference.channels[1].values)
        force *= 10;
    EXPECT_NE(force_svg(page_sides(comparison)).find("opening force [kN]"), std::string::npos);
}

TEST(CompareSvg, AGapInTheDataIsAGapInTheLine) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    Plot plot;
    plot.series = {{.label = "a", .x = {0, 1, 2, 3, 4}, .y = {0, 1, nan, 1, 2}}};
    const std::string svg = svg_plot(plot);
    const auto begin = svg.find(" d=\"") + 4;
    EXPECT_EQ(test::count_of(svg.substr(begin, svg.find('"', begin) - begin), "M"), 2u);
}

TEST(CompareSvg, AJumpIsDrawnUpright) {
    // 24 kN and 2 kN at 1 s, among points so many that they are thinned: below and above one another.
    Plot plot;
    plot.series = {{.label = "rom"}};
    for (int i = 0; i <= 20000; ++i) {
        const double t = 1e-4 * i;
        plot.series[0].x.push_back(t);
        plot.series[0].y.push_back(t <= 1.0 ? 24.0 * t : 2.0);
        if (i == 10000) plot.series[0].x.push_back(t), plot.series[0].y.push_back(2.0);
    }
    const std::string svg = svg_plot(plot);
    // The path goes down by 22 kN, most of the frame of 270 px, at one place, 1 s being the middle of 78 and
    // 700 px, and nowhere else.
    std::istringstream path(svg.substr(svg.find("<path d=\"M") + 9));
    double x = 0.0, y = 0.0, last_x = 0.0, last_y = 0.0;
    int drops = 0;
    for (char command = 0; path >> command && (command == 'M' || command == 'L') && path >> x >> y;) {
        if (command == 'L' && y > last_y + 200.0) {
            ++drops;
            EXPECT_EQ(x, last_x);
            EXPECT_EQ(x, 389.0);
        }
        last_x = x;
        last_y = y;
    }
    EXPECT_EQ(drops, 1);
}

/// Heights [px] that the only line of a plot reaches, the smallest first: up is less.
double highest_of(const std::string& svg) {
    const std::size_t begin = svg.find("<path d=\"M") + 10, end = svg.find('"', begin);
    std::istringstream path(svg.substr(begin, end - begin));
    double x = 0.0, y = 0.0, highest = 1e9;
    for (char letter; path >> x >> y; path >> letter)
        highest = std::min(highest, y);
    return highest;
}

TEST(CompareSvg, ASpikeDoesNotFlattenTheRest) {
    // 5 ms of 20 kN before a peak of 5 kN: four times as high, in 0.1 % of the time.
    Comparison comparison = synthetic_comparison();
    const double plain = highest_of(force_svg(page_sides(comparison)));
    for (RunRecord* record : {&comparison.reference, &comparison.candidate})
        for (Channel& channel : record->channels)
            if (channel.name == "force") std::fill_n(channel.values.begin() + 100, 5, 20e3);
    const std::string svg = force_svg(page_sides(comparison));
    EXPECT_NE(svg.find("; a spike of 20000 N is cut off"), std::string::npos);
    EXPECT_EQ(svg.find("kN"), std::string::npos) << "what is not drawn does not choose the unit";
    // The peak is never cut, and still takes most of the height: 1/1.25 of it.
    EXPECT_EQ(svg.find(">20000<"), std::string::npos);
    EXPECT_NEAR(highest_of(svg), 112.0, 2.0);  // the edge, of the spike
    EXPECT_EQ(force_svg(page_sides(synthetic_comparison())).find("spike"), std::string::npos);
    EXPECT_GT(plain, 112.0);
}

TEST(CompareSvg, WithoutDataItSaysSo) {
    Comparison comparison = synthetic_comparison();
    comparison.reference.channels.clear();
    EXPECT_EQ(test::count_of(force_svg(page_sides(comparison)), "<path "),
              1u);  // one side is enough for a picture
    comparison.candidate.channels.clear();
    EXPECT_NE(force_svg(page_sides(comparison)).find("no data"), std::string::npos);
}

TEST(CompareSvg, WordsOfMarkersDoNotCoverEachOther) {
    // Two words whose lines lie 0.2 mm apart on paper, in the middle and at the right end; a letter takes 6
    // px at most.
    for (const double at : {50.0, 97.0}) {
        Plot plot;
        plot.series.emplace_back();
        plot.series.front().x = {0.0, 100.0};
        plot.series.front().y = {0.0, 1.0};
        plot.markers = {{"mean", ink, 20.0}, {"design load", ink, at}, {"overload", ink, at + 0.1}};
        const std::string svg = svg_plot(plot);
        struct Words {
            double from, to, y;
        };
        std::vector<Words> all;
        for (const auto& [label, colour, place] : plot.markers) {
            const std::size_t end = svg.find(">" + label + "<"), begin = svg.rfind("<text", end);
            ASSERT_NE(end, std::string::npos) << label;
            const std::string tag = svg.substr(begin, end - begin);
            const auto number = [&](const char* name) { return std::stod(tag.substr(tag.find(name) + 4)); };
            const double x = number(" x=\""), length = 6.0 * static_cast<double>(label.size());
            const bool ends = tag.find("text-anchor=\"end\"") != std::string::npos;
            all.push_back({ends ? x - length : x, ends ? x : x + length, number(" y=\"")});
        }
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t k = 0; k < i; ++k)
                EXPECT_TRUE(std::abs(all[i].y - all[k].y) >= 12.0 || all[i].to < all[k].from ||
                            all[k].to < all[i].from)
                    << plot.markers[i].label << " over " << plot.markers[k].label << " at " << at;
    }
}

TEST(CompareSvg, EscapesWhatItIsGiven) {
    Comparison comparison = synthetic_comparison();
    comparison.reference.scene.name = "<script>&\"";
    EXPECT_EQ(speed_svg(page_sides(comparison)).find("<script>"), std::string::npos);
}

}  // namespace
}  // namespace twinchute::compare
