// The trajectory of a run on a map.
#pragma once

#include <string>

#include "lib/math/geodesy.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::exchange {

/// KML 2.2 with the trajectory, its events and the landing point. `map`: about the release.
std::string flight_kml(const RunRecord& record, const LocalMap& map);

/// GeoJSON (RFC 7946) with the same.
std::string flight_geojson(const RunRecord& record, const LocalMap& map);

}  // namespace twinchute::exchange
