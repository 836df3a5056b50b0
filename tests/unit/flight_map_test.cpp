// Trajectories as KML and GeoJSON.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "lib/exchange/flight_map.hpp"
#include "lib/math/vec.hpp"

namespace twinchute::test {
namespace {

using namespace twinchute::exchange;

const LocalMap alpine_map(45.0 * pi / 180.0, 8.0 * pi / 180.0);

/// A fall of 20 s toward north-east, with an event halfway between two rows.
RunRecord mapped_fall() {
    RunRecord record;
    record.scene.name = "fall & <wind>";
    record.channels = {{"time", "s", {0.0, 10.0, 20.0}},
                       {"altitude", "m", {1000.0, 500.0, 100.0}},
                       {"east", "m", {0.0, 400.0, 788.46835}},
                       {"north", "m", {0.0, 600.0, 1111.31745}}};
    record.events = {{"main.full-open", 5.0, 750.0, 30.0}, {"ground", 20.0, 100.0, 6.0}};
    return record;
}

TEST(FlightMap, ADegreeIsAsLongAsOnWgs84) {
    // Lengths of a degree at 45 deg of latitude on WGS 84: 111131.745 m along the meridian, 78846.835 m along
    // the parallel. A hundredth of it is taken, over which the meridian's radius changes by 1e-6 of itself.
    EXPECT_NEAR(alpine_map.at(0.0, 1111.31745).latitude, 45.01, 1e-7);
    EXPECT_NEAR(alpine_map.at(788.46835, 0.0).longitude, 8.01, 1e-7);
}

TEST(FlightMap, LongWaysFollowTheParallelsThatTheyCross) {
    // 70 km north and 70 km east at 65 deg of latitude, in steps of 10 m by the radii at each. The radii at
    // the release alone would be 1.7 km off.
    double latitude = 65.0 * pi / 180.0, longitude = 25.0 * pi / 180.0;
    for (int i = 0; i < 7000; ++i) {
        const double w = 1.0 - 6.69437999014e-3 * std::pow(std::sin(latitude), 2);
        longitude += 10.0 * std::sqrt(w) / (6378137.0 * std::cos(latitude));
        latitude += 10.0 * std::pow(w, 1.5) / (6378137.0 * (1.0 - 6.69437999014e-3));
    }
    const GeographicPlace place = LocalMap(65.0 * pi / 180.0, 25.0 * pi / 180.0).at(7e4, 7e4);
    EXPECT_NEAR(place.latitude, latitude * 180.0 / pi, 1e-5);    // 1 m
    EXPECT_NEAR(place.longitude, longitude * 180.0 / pi, 2e-5);  // 1 m
}

TEST(FlightMap, LongitudesStayWithinHalfATurn) {
    const LocalMap at_the_date_line(0.0, 179.9999 * pi / 180.0);
    EXPECT_NEAR(at_the_date_line.at(1e3, 0.0).longitude, -179.9911, 1e-3);
    EXPECT_NEAR(LocalMap(0.0, 200.0 * pi / 180.0).at(0.0, 0.0).longitude, -160.0, 1e-9);
}

TEST(FlightMap, GeoJsonHasTrajectoryEventsAndLanding) {
    const auto json = nlohmann::json::parse(flight_geojson(mapped_fall(), alpine_map));
    EXPECT_EQ(json["type"], "FeatureCollection");
    EXPECT_EQ(json["name"], "fall & <wind>");
    ASSERT_EQ(json["features"].size(), 3u);
    const auto& line = json["features"][0]["geometry"];
    EXPECT_EQ(line["type"], "LineString");
    ASSERT_EQ(line["coordinates"].size(), 3u);
    EXPECT_EQ(line["coordinates"][0], nlohmann::json::array({8.0, 45.0, 1000.0}));  // longitude comes first
    const auto& event = json["features"][1];
    EXPECT_EQ(event["properties"]["name"], "main.full-open");
    const GeographicPlace there = alpine_map.at(200.0, 300.0);
    EXPECT_NEAR(event["geometry"]["coordinates"][0].get<double>(), there.longitude, 1e-12);
    EXPECT_NEAR(event["geometry"]["coordinates"][1].get<double>(), there.latitude, 1e-12);
    EXPECT_EQ(event["geometry"]["coordinates"][2], 750.0);
    EXPECT_EQ(json["features"][2]["properties"]["name"], "landing");
    EXPECT_NEAR(json["features"][2]["geometry"]["coordinates"][1].get<double>(), 45.01, 1e-7);
}

TEST(FlightMap, KmlHasTheSame) {
    const std::string text = flight_kml(mapped_fall(), alpine_map);
    pugi::xml_document kml;
    ASSERT_TRUE(kml.load_string(text.c_str())) << text;
    const pugi::xml_node body = kml.child("kml").child("Document");
    EXPECT_STREQ(body.child_value("name"), "fall & <wind>");
    const pugi::xml_node line = body.child("Placemark");
    EXPECT_STREQ(line.child("LineString").child_value("altitudeMode"), "absolute");
    EXPECT_EQ(std::string(line.child("LineString").child_value("coordinates")).substr(0, 31),
              "8.00000000,45.00000000,1000.00\n");
    const pugi::xml_node landing = line.next_sibling().next_sibling();
    EXPECT_STREQ(landing.child_value("name"), "landing");
    // A hundredth of a degree of 45 deg; parallels half way there are 8.7e-5 shorter.
    EXPECT_STREQ(landing.child("Point").child_value("coordinates"), "8.01000087,45.00999999,100.00");
}

TEST(FlightMap, AFallStraightDownStaysOverItsPoint) {
    RunRecord record = mapped_fall();
    record.channels.resize(2);
    const auto json = nlohmann::json::parse(flight_geojson(record, alpine_map));
    EXPECT_EQ(json["features"][2]["geometry"]["coordinates"], nlohmann::json::array({8.0, 45.0, 100.0}));
}

}  // namespace
}  // namespace twinchute::test
