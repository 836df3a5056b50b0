// Meridians of constructed canopies against closed forms of pyramids, frustums and cylinders.
#include "lib/models/meridian.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

constexpr double area = 0.25 * pi * 8.53 * 8.53;
constexpr double degree = pi / 180.0;

/// Slant height over seam of a facet of a pyramid: cos^2 -> cos^2(delta) cos^2(phi) + sin^2(phi).
double slant(double angle, int gores) {
    return std::sqrt(1.0 - std::pow(std::sin(pi / gores) * std::cos(angle), 2));
}

TEST(Meridian, AConeIsAPyramidOfTheArea) {
    // n triangles of base 2 r sin(delta) and of the facet's height, r = s cos(phi).
    for (const int gores : {3, 8, 28, 200})
        for (const double angle : {0.0, 10.0 * degree, 25.0 * degree, 35.0 * degree}) {
            const Meridian meridian(std::vector<GorePanel>{{1.0, angle, angle}}, gores, area);
            const double seam =
                std::sqrt(area / (gores * std::sin(pi / gores) * std::cos(angle) * slant(angle, gores)));
            EXPECT_NEAR(meridian.length(), seam, 1e-13 * seam);
            EXPECT_NEAR(meridian.area(0.0, seam), area, 1e-12 * area);  // and of similar triangles a quarter
            EXPECT_NEAR(meridian.area(0.5 * seam, seam), 0.75 * area, 1e-12 * area);
            const MeridianPoint half = meridian.at(0.5 * seam);
            EXPECT_NEAR(half.radius, 0.5 * seam * std::cos(angle), 1e-13);
            EXPECT_NEAR(half.depth, 0.5 * seam * std::sin(angle), 1e-13);
            EXPECT_NEAR(half.centre, 0.5 * seam * slant(angle, gores), 1e-13);
            EXPECT_NEAR(meridian.seam_at(half.radius), 0.5 * seam, 1e-13);
            EXPECT_TRUE(std::isnan(meridian.seam_at(1.01 * seam * std::cos(angle))));
        }
}

TEST(Meridian, PanelsAreFrustums) {
    // By hand: trapezoids between chords at the panels' edges.
    const int gores = 28;
    const std::vector<GorePanel> panels{
        {0.5, 0.0, 0.0}, {0.3, 40.0 * degree, 40.0 * degree}, {0.2, 2.0, 2.0}};
    const Meridian meridian(panels, gores, area);
    double sum = 0.0, radius = 0.0, seam = 0.0, centre = 0.0;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double length = meridian.length() * panels[i].length;  // shares add up to one
        const double below = radius + length * std::cos(panels[i].top);
        const double height = length * slant(panels[i].top, gores);
        sum += gores * std::sin(pi / gores) * (radius + below) * height;
        radius = below;
        seam += length;
        centre += height;
        EXPECT_NEAR(meridian.edges()[i], seam, 1e-13);
        EXPECT_NEAR(meridian.at(seam).radius, radius, 1e-13);
        EXPECT_NEAR(meridian.at(seam).centre, centre, 1e-13);
    }
    EXPECT_NEAR(sum, area, 1e-12 * area);
}

TEST(Meridian, AHemisphereIsOfCylinders) {
    // A gore between seams on a sphere of radius R is part of an elliptic cylinder: its centre line is a
    // quarter of an ellipse, R E(sin delta), and all gores have n R^2 (delta + sin(delta) cos(delta)), for
    // many gores 2 pi R^2.
    for (const int gores : {3, 8, 28, 200}) {
        const Meridian meridian(std::vector<GorePanel>{{1.0, 0.0, 0.5 * pi}}, gores, area);
        const double delta = pi / gores;
        const double R = std::sqrt(area / (gores * (delta + std::sin(delta) * std::cos(delta))));
        EXPECT_NEAR(meridian.length(), 0.5 * pi * R, 1e-12 * R);
        const MeridianPoint skirt = meridian.at(meridian.length());
        EXPECT_NEAR(skirt.radius, R, 1e-12 * R);
        EXPECT_NEAR(skirt.depth, R, 1e-12 * R);
        EXPECT_NEAR(skirt.centre, R * std::comp_ellint_2(std::sin(delta)), 1e-12 * R);
        const MeridianPoint point = meridian.at(30.0 * degree * R);
        EXPECT_NEAR(point.radius, 0.5 * R, 1e-12 * R);
        EXPECT_NEAR(point.depth, (1.0 - std::sqrt(0.75)) * R, 1e-12 * R);
        EXPECT_NEAR(meridian.seam_at(0.5 * R), 30.0 * degree * R, 1e-12 * R);
        EXPECT_NEAR(meridian.area(0.0, meridian.length()), area, 1e-12 * area);
        EXPECT_NEAR(meridian.area(0.0, 0.3 * R) + meridian.area(0.3 * R, meridian.length()), area,
                    1e-12 * area);
    }
}

TEST(Meridian, APolygonHasTheAreaOfItsCircle) {
    for (const int sides : {3, 28}) {
        const double r = polygon_radius(2.0, sides);
        EXPECT_NEAR(0.5 * sides * r * r * std::sin(2.0 * pi / sides), pi, 1e-14 * pi);
    }
}

}  // namespace
}  // namespace twinchute
