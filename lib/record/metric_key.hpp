// A metric's key carries its unit as a suffix: "peak_force_N" is the metric peak_force in newtons.
#pragma once

#include <string>
#include <string_view>

namespace twinchute {

struct MetricKey {
    std::string_view name;  ///< without the unit, e.g. "snatch_speed"; what the command line uses
    std::string_view unit;  ///< e.g. "m/s"; empty when dimensionless
};

/// Takes a key apart. The name points into `key`.
MetricKey split_metric_key(std::string_view key);

/// The name in words, e.g. "peak force".
std::string metric_words(std::string_view key);

}  // namespace twinchute
