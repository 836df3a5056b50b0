// Measurements of a test, to hold a ladder against. How far a level is from it is neither an error of numbers
// nor a gap between models: it has both in it, and the test's own scatter.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/record/metrics.hpp"

namespace twinchute::compare {

struct TestValue {
    const MetricRow* row = nullptr;
    double value = 0.0;  ///< in the row's unit
};

struct TestReference {
    std::string file;  ///< as given
    std::vector<TestValue> values;
};

/// Reads a CSV file whose first line names the columns and whose second their units, either
///   time,force       a history; its largest force is the peak force
///   peak_force,...   metrics by name (`twinchute list metrics`), with one line of values
/// Throws SceneError, with file and line, for everything else.
TestReference read_test_reference(std::string_view text, const std::string& file);

}  // namespace twinchute::compare
