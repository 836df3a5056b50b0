// Drag area by attitude: its table, as it is read and as it is between points.
#include "lib/models/attitude_drag.hpp"

#include <gtest/gtest.h>

#include <string>

#include "lib/math/vec.hpp"
#include "lib/scene/opening_tables.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {
namespace {

TEST(AttitudeDrag, IsLinearBetweenItsPointsAndMirroredBeyondASquareAngle) {
    const AttitudeDrag half =
        read_attitude_drag("angle,drag_area\ndeg,m^2\n0,1\n30,4\n90,2\n", "a.csv", "a.csv");
    const double degree = pi / 180.0;
    EXPECT_NEAR(half.drag_area(0.0), 1.0, 1e-15);
    EXPECT_NEAR(half.drag_area(15.0 * degree), 2.5, 1e-14);
    EXPECT_NEAR(half.drag_area(60.0 * degree), 3.0, 1e-14);
    EXPECT_NEAR(half.drag_area(90.0 * degree), 2.0, 1e-14);
    EXPECT_NEAR(half.drag_area(150.0 * degree), 4.0, 1e-13);
    EXPECT_NEAR(half.drag_area(pi), 1.0, 1e-14);
    // Another foot than head; square feet (0.09290304 m^2).
    const AttitudeDrag whole = read_attitude_drag(
        "drag_area,angle\nft^2,rad\n10,0\n30,1.5707963\n20,3.141592653589793\n", "b.csv", "b");
    EXPECT_NEAR(whole.drag_area(pi), 1.858061, 1e-6);
    EXPECT_NEAR(whole.drag_area(0.75 * pi), 2.322576, 1e-6);
}

TEST(AttitudeDrag, RefusesTablesThatLeaveAnAttitudeOut) {
    const auto refused = [](const std::string& text, int line, const char* says) {
        try {
            read_attitude_drag(text, "a.csv", "a.csv");
            ADD_FAILURE() << "accepted, wanted: " << says;
        } catch (const SceneError& error) {
            EXPECT_EQ(error.place().file, "a.csv");
            EXPECT_EQ(error.place().line, line) << error.what();
            EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
        }
    };
    refused("angle,drag_area\ndeg,m^2\n10,1\n90,2\n", 3, "angle begins at 10 deg");
    refused("angle,drag_area\ndeg,m^2\n0,1\n45,1\n120,2\n", 5, "angle ends at 120 deg");
    refused("angle,drag_area\ndeg,m^2\n0,1\n190,2\n", 4, "3.316");
    refused("angle,drag_area\ndeg,m^2\n0,1\n45,-1\n90,2\n", 4, "-1");
    refused("angle\ndeg\n0\n90\n", 1, "the column 'drag_area' is missing");
}

}  // namespace
}  // namespace twinchute
