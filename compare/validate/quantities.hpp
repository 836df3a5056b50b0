// Numbers that tests report and no metric holds, from the history of a run or of a recording.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// Inputs that some quantities depend on beside the history.
struct QuantityArguments {
    double window = 0.1;  ///< [s] of the moving mean
    double height = 0.0;  ///< [m] above the ground of the scene
    double from = 0.0;    ///< [m] likewise
    double to = 0.0;      ///< [m]

    bool operator==(const QuantityArguments&) const = default;
};

/// A row of the table of quantities.
struct Quantity {
    std::string_view name;
    std::string_view unit;  ///< SI; "1" for ratios
    std::string_view meaning;
    std::string_view takes;  ///< the arguments that it depends on, "from|to"
    /// Nothing where the history has no such channel or does not reach so far.
    std::optional<double> (*of)(const RunRecord&, const Scene&, const QuantityArguments&);
};

std::span<const Quantity> quantities();
const Quantity* find_quantity(std::string_view name);

/// The value of a quantity, or of the metric of that name; for a recording, which has no metrics, nothing
/// then.
std::optional<double> quantity_value(std::string_view name, const RunRecord& record, const Scene& scene,
                                     const QuantityArguments& arguments);

/// The unit in which a quantity or metric is written in a suite ("g0" for a deceleration); empty: no such
/// quantity.
std::string_view quantity_unit(std::string_view name);

/// "mean peak force, 100 ms", "fall time, 400 to 20 m".
std::string quantity_words(std::string_view name, const QuantityArguments& arguments);

/// Largest mean of a history over any window of that length: exact for straight lines between its points,
/// also where two points share a time. Nothing for a history that is shorter. time: does not fall [s];
/// window: > 0 [s].
std::optional<double> largest_mean(std::span<const double> time, std::span<const double> value,
                                   double window);

}  // namespace twinchute::compare
