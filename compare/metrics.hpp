// Metrics that two records are compared in: one row each.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "lib/cli/list_command.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// Whether a metric stands in every table or only where a tolerance is asked for.
enum class Show { always, when_judged };

struct MetricRow {
    std::string_view name;  ///< as on the command line and in a scene, without unit
    std::string_view key;   ///< in a record, with unit
    std::string_view unit;  ///< SI; empty when dimensionless, "g" for standard gravities
    std::string_view title;
    std::optional<Tolerance> tolerance = {};  ///< where none is asked for; absent: not judged by default
    Show show = Show::always;
};

/// In the order of the report.
std::span<const MetricRow> metric_rows();

/// The row of a name without unit, or null.
const MetricRow* find_metric_row(std::string_view name);

/// For `twinchute list metrics`.
ListTopic metrics_topic();

/// "10 %" or "500 N".
std::string tolerance_text(const Tolerance& tolerance, std::string_view unit);

}  // namespace twinchute::compare
