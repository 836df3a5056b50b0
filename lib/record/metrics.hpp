// The one table of metrics: those of records, which two records are compared in, and which a scene may give a
// tolerance. A metric's key carries its unit as a suffix: "peak_force_N" is peak_force in newtons.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace twinchute {

/// How far two fidelities may be apart in one metric.
struct Tolerance {
    double value = 0.0;
    bool relative = true;  ///< of the reference; otherwise in the metric's own SI unit

    bool operator==(const Tolerance&) const = default;
};

/// "10 %" or "500 N".
std::string tolerance_text(const Tolerance& tolerance, std::string_view unit);

/// Whether a metric stands in every table or only where a tolerance is asked for.
enum class Show { always, when_judged };

/// A number of a record, or a quantity that it has over time: then the gap is the relative L2 norm of the
/// difference, and `unit` that of the quantity.
struct MetricRow {
    std::string_view name;  ///< as on the command line and in a scene, without unit, e.g. "peak_force"
    std::string_view key;   ///< in a record, with unit; of a history its channel
    std::string_view unit;  ///< SI; empty when dimensionless, "g" for standard gravities
    std::string_view title;
    std::optional<Tolerance> tolerance = {};  ///< where none is asked for; absent: not judged by default
    Show show = Show::always;

    /// Over time: "force_history".
    constexpr bool is_history() const { return name.ends_with("_history"); }
    /// The unit that a tolerance is written in, as units of a scene: "1" for ratios, "g0".
    std::string_view tolerance_unit() const;
};

/// Every row, numbers before histories, each in the order of the report.
std::span<const MetricRow> judgeable_rows();
std::span<const MetricRow> metric_rows();   ///< numbers alone
std::span<const MetricRow> history_rows();  ///< histories alone

/// The beginning of the keys of a parachute's own metrics, of its name: "Main-1" to "main_1_"; nothing of
/// none.
std::string metric_head(std::string name);

/// The row of a name without unit, or null. One with another name before it is the metric of one parachute of
/// several, or of one canopy of a cluster: "main_peak_force" has a row of its own, with the tolerance of
/// peak_force and the title "main: Peak opening force". Which names there are only a scene says.
const MetricRow* find_judgeable_row(std::string_view name);
/// Beginning of a name that has such a row, "main_"; empty of one that is in the table.
std::string_view head_of_judgeable(std::string_view name);
const MetricRow* find_metric_row(std::string_view name);  ///< row of a number, by the same names

/// Whether a metric is an extreme of the whole run, or a margin to one: of a run that broke off it is no more
/// than a bound. Those of its events are what they are.
bool is_extreme(std::string_view key);

struct MetricKey {
    std::string_view name;  ///< without the unit, e.g. "snatch_speed"
    std::string_view unit;  ///< e.g. "m/s"; empty when dimensionless
};

/// Takes a key apart, also one without a row: of a parachute, of a stage, of a formula. The name points into
/// `key`.
MetricKey split_metric_key(std::string_view key);

/// The name in words, e.g. "peak force".
std::string metric_words(std::string_view key);

}  // namespace twinchute
