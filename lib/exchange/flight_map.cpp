#include "lib/exchange/flight_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <vector>

#include "lib/exchange/imported_scene.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::exchange {
namespace {

constexpr const char* map_mark = "Exported by twinchute";

/// A point of the trajectory: its place, and the altitude [m] above sea level.
struct TrackPoint {
    GeographicPlace place;
    double altitude = 0.0;

    std::string coordinates() const {
        return fmt::format("{:.8f},{:.8f},{:.2f}", place.longitude, place.latitude, altitude);
    }
};

struct TrackEvent {
    std::string name, description;
    TrackPoint point;
};

struct Track {
    std::vector<TrackPoint> points;
    std::vector<TrackEvent> events;
};

Track track_of(const RunRecord& record, const LocalMap& map) {
    static const std::vector<double> none;
    const auto channel = [&](std::string_view name) -> const std::vector<double>& {
        const auto found = std::ranges::find(record.channels, name, &Channel::name);
        return found == record.channels.end() ? none : found->values;
    };
    // A fall straight down has neither.
    const std::vector<double>&time = channel("time"), &altitude = channel("altitude"),
          &east = channel("east"), &north = channel("north");
    const auto at = [](const std::vector<double>& values, std::size_t i) {
        return values.empty() ? 0.0 : values[i];
    };
    Track track;
    for (std::size_t i = 0; i < time.size(); ++i)
        track.points.push_back({map.at(at(east, i), at(north, i)), altitude[i]});
    for (const Event& event : record.events) {
        const auto after = std::ranges::lower_bound(time, event.time);
        if (after == time.end()) continue;
        const auto i = static_cast<std::size_t>(after - time.begin());
        const std::size_t before = i == 0 ? 0 : i - 1;
        const double share =
            time[i] > time[before] ? (event.time - time[before]) / (time[i] - time[before]) : 1.0;
        const auto mixed = [&](const std::vector<double>& values) {
            return at(values, before) + share * (at(values, i) - at(values, before));
        };
        track.events.push_back({event.name == "ground" ? "landing" : one_line(event.name),
                                fmt::format("{:.2f} s after release, {:.2f} m/s", event.time, event.speed),
                                {map.at(mixed(east), mixed(north)), event.altitude}});
    }
    return track;
}

}  // namespace

std::string flight_kml(const RunRecord& record, const LocalMap& map) {
    const Track track = track_of(record, map);
    pugi::xml_document document;
    pugi::xml_node head = document.append_child(pugi::node_declaration);
    head.append_attribute("version") = "1.0";
    head.append_attribute("encoding") = "UTF-8";
    document.append_child(pugi::node_comment).set_value(map_mark);
    pugi::xml_node kml = document.append_child("kml");
    kml.append_attribute("xmlns") = "http://www.opengis.net/kml/2.2";
    pugi::xml_node body = kml.append_child("Document");
    const auto text = [](pugi::xml_node parent, const char* name, const std::string& value) {
        parent.append_child(name).text().set(value.c_str());
    };
    text(body, "name", one_line(record.scene.name));
    const auto shape = [&](const std::string& name, const char* kind, const std::string& coordinates) {
        pugi::xml_node mark = body.append_child("Placemark");
        text(mark, "name", name);
        pugi::xml_node geometry = mark.append_child(kind);
        text(geometry, "altitudeMode", "absolute");
        text(geometry, "coordinates", coordinates);
        return mark;
    };
    std::string line;
    for (const TrackPoint& point : track.points)
        line += point.coordinates() + "\n";
    shape("trajectory", "LineString", line);
    for (const TrackEvent& event : track.events) {
        pugi::xml_node mark = shape(event.name, "Point", event.point.coordinates());
        mark.insert_child_after("description", mark.child("name")).text().set(event.description.c_str());
    }
    std::ostringstream out;
    document.save(out, "  ");
    return out.str();
}

std::string flight_geojson(const RunRecord& record, const LocalMap& map) {
    using nlohmann::ordered_json;
    const Track track = track_of(record, map);
    const auto position = [](const TrackPoint& point) {
        return ordered_json::array({point.place.longitude, point.place.latitude, point.altitude});
    };
    const auto feature = [](ordered_json properties, const char* kind, ordered_json coordinates) {
        return ordered_json{{"type", "Feature"},
                            {"properties", std::move(properties)},
                            {"geometry", {{"type", kind}, {"coordinates", std::move(coordinates)}}}};
    };
    ordered_json line = ordered_json::array();
    for (const TrackPoint& point : track.points)
        line.push_back(position(point));
    ordered_json features = ordered_json::array();
    features.push_back(feature({{"name", "trajectory"}}, "LineString", std::move(line)));
    for (const TrackEvent& event : track.events)
        features.push_back(feature({{"name", event.name}, {"description", event.description}}, "Point",
                                   position(event.point)));
    return json_text({{"generator", map_mark},
                      {"type", "FeatureCollection"},
                      {"name", one_line(record.scene.name)},
                      {"features", std::move(features)}});
}

}  // namespace twinchute::exchange
